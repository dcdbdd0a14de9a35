/* run.c: see run.h. */
#include "conform/run.h"
#include "conform/golden.h"

#include "alloc_count.h"
#include "measure/picture.h"
#include "cli/cli.h"
#include "clock.h"
#include "image.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The calibration: FSR1 on a synthetic image. Large enough to hide the cost of a submit, small
 * enough to run many times. */
enum { FROM_WIDTH = 320, FROM_HEIGHT = 180, TO_WIDTH = 640, TO_HEIGHT = 360 };
#define ROUNDS_MOST 4u
#define TURN_MOST 64.0 /* largest number of its frames per iteration */

/* ---- Findings -------------------------------------------------------------------------------- */

/* Keeps the worst verdict; lists all findings of that verdict, if there is space. */
static void find(masu_conform_result *r, masu_verdict verdict, const char *format, ...) {
    if (verdict < r->verdict || verdict == MASU_VERDICT_PASS) return;
    size_t n = verdict > r->verdict ? 0 : strlen(r->why);
    r->verdict = verdict;
    if (n && n + 3 < sizeof r->why) n += (size_t)snprintf(r->why + n, sizeof r->why - n, "; ");
    va_list arguments;
    va_start(arguments, format);
    if (n < sizeof r->why && vsnprintf(r->why + n, sizeof r->why - n, format, arguments) < 0)
        r->why[n] = '\0';
    va_end(arguments);
}

static void note(masu_conform_result *r, const char *text) {
    size_t n = strlen(r->note);
    snprintf(r->note + n, sizeof r->note - n, "%s%s", n ? "; " : "", text);
}

static void judge(masu_conform_result *r, masu_measure m, bool least) {
    const masu_bound *bound = least ? &r->of->least[m] : &r->of->bounds[m];
    bool more = least || masu_measure_more(m);
    masu_verdict verdict = masu_bound_judge(bound, r->values[m], more);
    if (verdict == MASU_VERDICT_PASS) return;
    double limit = verdict == MASU_VERDICT_FAIL ? bound->fail : bound->warn;
    if (isnan(r->values[m])) {
        find(r, verdict, "%s was not measured, expected at %s %.10g", masu_measure_name(m),
             more ? "least" : "most", limit);
        return;
    }
    find(r, verdict, "%s is %.10g, expected at %s %.10g", masu_measure_name(m), r->values[m],
         more ? "least" : "most", limit);
}

void masu_conform_judge(masu_conform_result *r, bool validated) {
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
        bool blind = isnan(r->values[m]) &&
                     ((m == MASU_MEASURE_ALLOCATIONS && (validated || !masu_alloc_counting())) ||
                      (m == MASU_MEASURE_MESSAGES && !validated));
        if (!blind) judge(r, (masu_measure)m, false);
        judge(r, (masu_measure)m, true);
    }
}

/* The verdict of a failed masu_session_start. */
static masu_verdict verdict_of(const masu_detail *d) {
    if (d->vulkan == VK_ERROR_OUT_OF_HOST_MEMORY || d->vulkan == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        return MASU_VERDICT_RESOURCE;
    switch (d->result) {
    case MASU_OK: return MASU_VERDICT_RESOURCE; /* the host block could not be allocated */
    case MASU_ERROR_MEMORY:
    case MASU_ERROR_LIMIT: return MASU_VERDICT_RESOURCE;
    case MASU_ERROR_DEVICE: return MASU_VERDICT_UNSUPPORTED;
    default: return MASU_VERDICT_FAIL;
    }
}

/* ---- Sessions -------------------------------------------------------------------------------- */

typedef struct way {
    uint32_t poison, flight;
    bool split, unculled;
    bool first; /* the case itself: budgets apply only to it */
} way;

static bool counts(const masu_case *of) {
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) {
        if (masu_measure_counted((masu_measure)m) &&
            (masu_bound_is_set(&of->bounds[m]) || masu_bound_is_set(&of->least[m]))) {
            return true;
        }
    }
    return false;
}

static uint64_t budget(const masu_bound *bound) {
    return isnan(bound->fail) ? 0 : bound->fail < 1.0 ? 1 : (uint64_t)bound->fail;
}

static void scene_path(const masu_conform *c, const masu_case *of, char *path, size_t size) {
    snprintf(path, size, "%s/%s.masu", c->scenes, of->scene);
}

static masu_session_desc describe(const masu_conform *c, const masu_case *of, const way *w) {
    masu_session_desc d = {.host = c->host, .no_renderer = true};
    d.host.ray_query = c->ray_query != MASU_OFF;
    d.host.validate = d.host.validate || (of->validate && !d.host.gpu_av);
    d.desc.output = (VkExtent2D){of->width, of->height};
    d.desc.targets.storage = 1;
    d.desc.frames_in_flight = w->flight ? w->flight : of->flight;
    d.desc.ray_query = c->ray_query;
    d.desc.ladder = of->measured ? MASU_ON : MASU_OFF;
    d.desc.rung_count = of->rung_count;
    memcpy(d.desc.rungs, of->rungs, sizeof d.desc.rungs);
    for (uint32_t r = 0; r < of->rung_count && w->unculled; r++)
        d.desc.rungs[r].frustum = d.desc.rungs[r].occlusion = MASU_OFF;
    d.desc.deny.unified_memory = w->split;
    d.desc.debug.poison = w->poison;
    d.desc.debug.counters = counts(of);
    masu_extreme_describe(of, &d.desc);
    if (masu_case_linear(of)) d.desc.readback |= MASU_READBACK_HDR;
    if (w->first) {
        d.desc.host_budget = budget(&of->bounds[MASU_MEASURE_HOST_BYTES]);
        d.desc.device_budget = budget(&of->bounds[MASU_MEASURE_DEVICE_BYTES]);
    }
    if (of->governed.on) {
        d.desc.governor = (masu_governor_desc){.mode = MASU_GOVERNOR_ON,
                                               .target_ms = (float)of->governed.target_ms,
                                               .best_rung = of->governed.best,
                                               .worst_rung = of->governed.worst,
                                               .wall_only = of->governed.told};
    }
    return d;
}

/* Checks that a query and an init with one byte less than required fail by name, and that the exact
 * budgets are accepted. */
static void check_memory(masu_session *s, masu_conform_result *r) {
    masu_desc q = s->desc;
    masu_memory need;
    masu_detail detail;
    masu_renderer *m = NULL;
    q.host_budget = q.device_budget = 0;
    if (masu_memory_query(&q, &need, &detail)) return; /* the start below reports the error */
    q.host_budget = need.host_bytes;
    q.device_budget = need.device_bytes;
    if (masu_memory_query(&q, &need, &detail))
        find(r, MASU_VERDICT_FAIL, "a budget of exactly the required size is rejected: %s",
             detail.text);
    q.host_budget--;
    if (masu_memory_query(&q, &need, &detail) != MASU_ERROR_LIMIT ||
        strcmp(detail.what, "host_budget"))
        find(r, MASU_VERDICT_FAIL, "a host budget of one byte less than required is accepted");
    q.host_budget++;
    q.device_budget--;
    if (masu_memory_query(&q, &need, &detail) != MASU_ERROR_LIMIT ||
        strcmp(detail.what, "device_budget")) {
        find(r, MASU_VERDICT_FAIL, "a device budget of one byte less than required is accepted");
    }
    q.device_budget++;
    size_t bytes = (size_t)need.host_bytes;
    void *block = aligned_alloc((size_t)need.host_alignment, (bytes + need.host_alignment - 1) /
                                                                 need.host_alignment *
                                                                 (size_t)need.host_alignment);
    if (block && masu_init(&q, block, bytes - 1, &m, &detail) != MASU_ERROR_MEMORY)
        find(r, MASU_VERDICT_FAIL, "a host block of one byte less than required is accepted");
    masu_destroy(m);
    free(block);
}

/* On false the verdict is set and the session is closed. */
static bool open_session(masu_conform *c, const masu_case *of, const way *w,
                         masu_conform_result *r) {
    char path[4096], error[1024];
    masu_session *s = &c->session;
    masu_session_desc d = describe(c, of, w);
    scene_path(c, of, path, sizeof path);
    d.scene_path = path;
    if (!masu_session_open(&d, s, error, sizeof error)) {
        find(r, MASU_VERDICT_FAIL, "%s", error);
        return false;
    }
    if (w->first && of->exact_memory) check_memory(s, r);
    if (w->first && masu_case_field(of) && !masu_field_look(s, of, &c->view, error, sizeof error)) {
        find(r, MASU_VERDICT_FAIL, "%s", error);
        masu_session_close(s);
        return false;
    }
    if (masu_session_start(s, error, sizeof error)) {
        masu_peak_info peaks;
        masu_peaks(s->m, &peaks);
        if (peaks.host_bytes == s->need.host_bytes && peaks.device_bytes == s->need.device_bytes)
            return true;
        find(r, MASU_VERDICT_FAIL, "the memory used differs from the memory required");
    } else {
        find(r, verdict_of(&s->detail), "%s", error);
    }
    masu_session_close(s);
    return false;
}

static void close_session(masu_conform *c, masu_conform_result *r) {
    masu_session *s = &c->session;
    bool validating = s->host.validating;
    masu_session_close(s); /* its calls are validated, too */
    if (!validating) return;
    double *all = &r->values[MASU_MEASURE_MESSAGES];
    *all = (isnan(*all) ? 0.0 : *all) + s->host.messages;
    if (s->host.messages && !masu_bound_is_set(&r->of->bounds[MASU_MEASURE_MESSAGES]))
        find(r, MASU_VERDICT_FAIL, "validation layer: %.300s", s->host.first_message);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* Records a frame and submits it. */
static bool submit(masu_session *s, const masu_frame_desc *frame, masu_conform_result *r,
                   masu_commands *commands) {
    char error[1024];
    if (!masu_headless_wait(&s->host, s->next_slot, error, sizeof error)) {
        find(r, MASU_VERDICT_FAIL, "%s", error);
        return false;
    }
    uint64_t before = masu_allocs_of_thread();
    masu_result result = masu_frame(s->m, frame, commands, &s->detail);
    uint64_t allocations = masu_allocs_of_thread() - before;
    /* The validation layer allocates inside the wrapped calls. */
    if (masu_alloc_counting() && !s->host.validating) {
        double *all = &r->values[MASU_MEASURE_ALLOCATIONS];
        *all = (isnan(*all) ? 0.0 : *all) + (double)allocations;
    }
    if (result) {
        find(r, MASU_VERDICT_FAIL, "masu_frame: %s", s->detail.text);
        return false;
    }
    s->next_slot = (commands->slot + 1) % masu_session_resolved(&s->desc).frames_in_flight;
    if (masu_headless_submit(&s->host, commands->buffer, commands->slot, error, sizeof error))
        return true;
    find(r, MASU_VERDICT_FAIL, "%s", error);
    return false;
}

static bool wait(masu_session *s, uint32_t slot, masu_conform_result *r) {
    char error[1024];
    if (masu_headless_wait(&s->host, slot, error, sizeof error)) return true;
    find(r, MASU_VERDICT_FAIL, "%s", error);
    return false;
}

static masu_frame_desc frame_at(const masu_case *of, uint32_t number) {
    return (masu_frame_desc){MASU_FRAME_DESC, .time = of->time + of->move * number,
                             .time_step = 1.0f / 60.0f};
}

static void take_counts(const masu_stats_info *s, masu_conform_result *r) {
#define MASU_TAKE(key) (double)s->key
    const struct {
        masu_measure m;
        double value;
    } taken[] = {
        {MASU_MEASURE_SDF_EVALS, MASU_TAKE(sdf_evals)},
        {MASU_MEASURE_SDF_HITS, MASU_TAKE(sdf_hits)},
        {MASU_MEASURE_SDF_UNCONVERGED, MASU_TAKE(sdf_unconverged)},
        {MASU_MEASURE_SHADOW_EVALS, MASU_TAKE(shadow_evals)},
        {MASU_MEASURE_OCCLUSION_EVALS, MASU_TAKE(occlusion_evals)},
        {MASU_MEASURE_SHADOW_UNCONVERGED, MASU_TAKE(shadow_unconverged)},
        {MASU_MEASURE_REPLACED, MASU_TAKE(replaced)},
        {MASU_MEASURE_DRAWS, MASU_TAKE(draws)},
        {MASU_MEASURE_TRIANGLES, MASU_TAKE(triangles)},
        {MASU_MEASURE_TRANSPARENTS, MASU_TAKE(transparents)},
        {MASU_MEASURE_OCCLUSION_TESTS, MASU_TAKE(occlusion_tests)},
        {MASU_MEASURE_LIGHT_TESTS, MASU_TAKE(light_tests)},
        {MASU_MEASURE_LIGHT_SHADED, MASU_TAKE(light_shaded)},
        {MASU_MEASURE_SPECULAR_TILES, MASU_TAKE(specular_tiles)},
        {MASU_MEASURE_SPECULAR_RAYS, MASU_TAKE(specular_rays)},
        {MASU_MEASURE_SPECULAR_HITS, MASU_TAKE(specular_hits)},
        {MASU_MEASURE_SPECULAR_SDF_HITS, MASU_TAKE(specular_sdf_hits)},
        {MASU_MEASURE_SPECULAR_NODES, MASU_TAKE(specular_nodes)},
        {MASU_MEASURE_SPECULAR_EVALS, MASU_TAKE(specular_evals)},
        {MASU_MEASURE_SMAA_TILES, MASU_TAKE(smaa_tiles)},
    };
#undef MASU_TAKE
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        r->values[taken[i].m] = taken[i].value;
}

/* Measurements after each frame. */
static bool look(masu_conform *c, const masu_case *of, uint32_t slot, masu_conform_result *r) {
    char error[1024];
    double *count = &r->values[MASU_MEASURE_NON_FINITE];
    if (!masu_bound_is_set(&of->bounds[MASU_MEASURE_NON_FINITE])) return true;
    if (isnan(*count)) *count = 0.0;
    if (!wait(&c->session, slot, r)) return false;
    if (masu_extreme_non_finite(&c->session, slot, count, error, sizeof error)) return true;
    find(r, MASU_VERDICT_FAIL, "%s", error);
    return false;
}

static bool look_at_field(masu_conform *c, const masu_case *of, uint32_t slot,
                          masu_conform_result *r) {
    char path[4096], error[1024];
    masu_field_figures f;
    if (!masu_case_field(of)) return true;
    scene_path(c, of, path, sizeof path);
    if (!masu_field_compare(&c->session, slot, path, &c->view, &f, error, sizeof error)) {
        find(r, MASU_VERDICT_FAIL, "%s", error);
        return false;
    }
    r->values[MASU_MEASURE_HITMISS_PCT] = f.hitmiss_pct;
    r->values[MASU_MEASURE_LOST_PCT] = f.lost_pct;
    r->values[MASU_MEASURE_DEPTH_P50] = f.depth_p50;
    r->values[MASU_MEASURE_DEPTH_P99] = f.depth_p99;
    return true;
}

/* Renders all frames and returns the last image; NULL after a failure. */
static uint8_t *draw_frames(masu_conform *c, const masu_case *of, masu_conform_result *r,
                            bool keep_counts) {
    masu_session *s = &c->session;
    masu_commands commands = {0};
    masu_stats_info stats;
    char error[1024];
    for (uint32_t i = 0; i < of->frames; i++) {
        masu_frame_desc frame = frame_at(of, i);
        if (!masu_extreme_frame(s, of, i, &frame, error, sizeof error)) {
            find(r, MASU_VERDICT_FAIL, "%s", error);
            return NULL;
        }
        if (!submit(s, &frame, r, &commands)) return NULL;
        if (keep_counts && !look(c, of, commands.slot, r)) return NULL;
    }
    if (!wait(s, commands.slot, r)) return NULL;
    if (keep_counts && counts(of) && !masu_stats(s->m, commands.slot, &stats, NULL))
        take_counts(&stats, r);
    if (keep_counts && !look_at_field(c, of, commands.slot, r)) return NULL;
    size_t bytes = 4 * (size_t)of->width * of->height;
    uint8_t *rgba = malloc(bytes);
    if (!rgba) {
        find(r, MASU_VERDICT_RESOURCE, "out of memory for an image of %zu bytes", bytes);
        return NULL;
    }
    if (masu_headless_target_read(&s->host, &s->targets[0], error, sizeof error)) {
        memcpy(rgba, s->targets[0].mapped, bytes);
        return rgba;
    }
    find(r, MASU_VERDICT_FAIL, "%s", error);
    free(rgba);
    return NULL;
}

static void run_governed(masu_conform *c, const masu_case *of, masu_conform_result *r) {
    masu_session *s = &c->session;
    const masu_governed *g = &of->governed;
    masu_stats_info stats;
    masu_commands commands;
    uint32_t last = 0;
    const masu_desc is = masu_session_resolved(&s->desc); /* resolved, with the rungs of a measured
                                                           * ladder */
    uint32_t worst = of->measured && !g->worst ? is.rung_count - 1 : g->worst;
    memset(&stats, 0, sizeof stats);
    for (uint32_t i = 0; i < g->frames; i++) {
        masu_frame_desc frame = frame_at(of, i);
        frame.rung = MASU_RUNG_AUTO;
        uint64_t start = masu_clock_ns(NULL);
        if (!submit(s, &frame, r, &commands) || !wait(s, commands.slot, r)) return;
        double wall = (double)(masu_clock_ns(NULL) - start) / 1e6;
        last = commands.rung;
        if (last < g->best || last > worst) {
            find(r, MASU_VERDICT_FAIL, "frame %u: found rung %u, expected %u to %u", i, last,
                 g->best, worst);
            return;
        }
        double scale = (double)is.rungs[last].scale, ratio = (double)is.governor.costs[last];
        double cost = of->measured && ratio > 0.0 ? ratio : scale * scale;
        masu_frame_wall(s->m, commands.slot, g->told ? g->fixed_ms + g->load_ms * cost : wall);
        if (masu_stats(s->m, commands.slot, &stats, NULL)) {
            find(r, MASU_VERDICT_FAIL, "frame %u: no statistics", i);
            return;
        }
    }
    r->values[MASU_MEASURE_CHANGES] = (double)stats.governor.changes;
    if (counts(of)) take_counts(&stats, r);
    if (g->settles[0] >= 0 && ((int32_t)last < g->settles[0] || (int32_t)last > g->settles[1])) {
        find(r, MASU_VERDICT_FAIL, "after %u frames the rung is %u (%s), expected %d to %d",
             g->frames, last, stats.governor.reason_text, g->settles[0], g->settles[1]);
    }
}

/* ---- Times ----------------------------------------------------------------------------------- */

static bool calibrate(masu_conform *c, masu_conform_result *r) {
    static uint8_t rgba[4 * FROM_WIDTH * FROM_HEIGHT];
    char error[1024];
    masu_session *s = &c->calibration;
    masu_session_desc d = {.host = c->host, .no_renderer = true};
    if (c->calibrated) return true;
    for (uint32_t i = 0; i < FROM_WIDTH * FROM_HEIGHT;
         i++) { /* discs of several sizes: edges everywhere */
        uint32_t x = i % FROM_WIDTH, y = i / FROM_WIDTH, cell = 8 + 8 * (x / 64 % 3);
        uint32_t u = x % cell, v = y % cell, half = cell / 2;
        uint32_t away = (u - half) * (u - half) + (v - half) * (v - half);
        memset(rgba + 4 * i, away < half * half / 2 ? 220 : 30, 3);
        rgba[4 * i + (i % 3)] ^= 64;
        rgba[4 * i + 3] = 255;
    }
    d.host.validate = d.host.gpu_av = false;
    d.desc.output = (VkExtent2D){TO_WIDTH, TO_HEIGHT};
    d.desc.targets.storage = 1;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.upscale = MASU_ON, .sharpen = MASU_ON, .sharpness = 0.2f};
    bool good = masu_session_open(&d, s, error, sizeof error);
    if (good && masu_headless_source_create(&s->host, rgba, FROM_WIDTH, FROM_HEIGHT, FROM_WIDTH,
                                            FROM_HEIGHT, 0, &c->source, error, sizeof error)) {
        s->desc.source =
            (masu_source){c->source.view, FROM_WIDTH, FROM_HEIGHT, VK_FORMAT_R8G8B8A8_UNORM};
        c->calibrated = masu_session_start(s, error, sizeof error);
        if (!c->calibrated) masu_headless_source_destroy(&s->host, &c->source);
    }
    if (good && !c->calibrated) masu_session_close(s);
    if (!c->calibrated) find(r, MASU_VERDICT_FAIL, "calibration: %s", error);
    return c->calibrated;
}

/* Times n sequential frames; *least becomes the minimum of the means so far. */
static bool timed(masu_session *s, const masu_frame_desc *frame, uint32_t n, masu_conform_result *r,
                  double *least) {
    masu_commands commands;
    uint64_t start = masu_clock_ns(NULL);
    for (uint32_t i = 0; i < n; i++) {
        if (!submit(s, frame, r, &commands) || !wait(s, commands.slot, r)) return false;
    }
    double ms = (double)(masu_clock_ns(NULL) - start) / 1e6 / n;
    if (!(*least <= ms)) *least = ms;
    return true;
}

/* Case and calibration alternate, and the minimum of each is used: other work of the machine only
 * lengthens frames. One iteration of the calibration has as many frames as take about the time of
 * one frame of the case: shorter work more easily finds a quiet moment, which makes the ratio too
 * large on a loaded machine. If the ratio exceeds its limit, more rounds may correct it. */
static void time_case(masu_conform *c, const masu_case *of, masu_conform_result *r) {
    double own = MASU_UNKNOWN, other = MASU_UNKNOWN;
    if (!calibrate(c, r)) return;
    masu_frame_desc frame = frame_at(of, of->frames - 1), none = {MASU_FRAME_DESC};
    masu_conform_result unused = {.of = of};
    masu_session *s = &c->calibration;
    bool good =
        timed(s, &none, 1, &unused, &(double){MASU_UNKNOWN}) && timed(s, &none, 1, &unused, &other);
    if (good && !timed(&c->session, &frame, 1, r, &own)) return;
    uint32_t n = good && own > other ? (uint32_t)fmin(own / other + 0.5, TURN_MOST) : 1;
    for (uint32_t round = 0; round < ROUNDS_MOST && good; round++) {
        other = round ? other : MASU_UNKNOWN; /* the measurement above was shorter than an
                                               * iteration */
        for (uint32_t i = 0; i < c->runs && good; i++) {
            good = timed(s, &none, n, &unused, &other);
            if (good && !timed(&c->session, &frame, 1, r, &own)) return;
        }
        r->values[MASU_MEASURE_MS_RATIO] = own / other;
        if (!masu_bound_judge(&of->bounds[MASU_MEASURE_MS_RATIO], own / other, false)) break;
    }
    if (!good) find(r, MASU_VERDICT_FAIL, "calibration: %s", unused.why);
}

/* ---- Images ---------------------------------------------------------------------------------- */

static void draw_ways(masu_conform *c, const masu_case *of, const uint8_t *picture,
                      masu_conform_result *r) {
    static const char *const names[] = MASU_SAME_NAMES;
    static const struct {
        uint32_t of, name;
        way way;
    } ways[] = {
        {MASU_SAME_AGAIN, 0, {0}},
        {MASU_SAME_POISON, 1, {.poison = 1}},
        {MASU_SAME_INFINITIES, 2, {.poison = 2}},
        {MASU_SAME_SPLIT, 3, {.split = true}},
        {MASU_SAME_UNCULLED, 4, {.unculled = true}},
        {MASU_SAME_FLIGHT, 5, {.flight = 1}},
        {MASU_SAME_FLIGHT, 5, {.flight = 3}},
    };
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        if (!(of->same & ways[i].of)) continue;
        uint32_t steps = 0;
        masu_cli_progress("%s: %s", of->name, names[ways[i].name]);
        if (!open_session(c, of, &ways[i].way, r)) return;
        uint8_t *own = draw_frames(c, of, r, false);
        close_session(c, r);
        if (!own) return;
        uint32_t pixels = masu_golden_differing(picture, own, of, &steps);
        free(own);
        if (!pixels) continue;
        find(r, MASU_VERDICT_FAIL, "same: %s: %u of %u pixels differ, by at most %u of 255",
             names[ways[i].name], pixels, of->width * of->height, steps);
    }
}

static bool same_truth(const masu_case *a, const masu_case *b) {
    return !strcmp(a->scene, b->scene) && a->width == b->width && a->height == b->height &&
           a->positions == b->positions && a->rays == b->rays &&
           !memcmp(&a->extreme.camera, &b->extreme.camera, sizeof a->extreme.camera) &&
           !memcmp(&a->extreme.light, &b->extreme.light, sizeof a->extreme.light) &&
           a->time + a->move * (a->frames - 1) == b->time + b->move * (b->frames - 1);
}

/* The ground truth of a case, cached for cases with the same inputs. */
static const uint8_t *truth_of(masu_conform *c, const masu_case *of, masu_conform_result *r) {
    char path[4096], error[1024];
    for (uint32_t i = 0; i < c->truth_count; i++) {
        if (same_truth(c->truths[i].of, of)) return c->truths[i].rgba;
    }
    masu_session *s = &c->session;
    masu_session_desc d = describe(c, of, &(way){0});
    scene_path(c, of, path, sizeof path);
    d.scene_path = path;
    d.no_renderer = false;
    uint8_t *rgba = malloc(4 * (size_t)of->width * of->height);
    if (!rgba || !masu_picture_open(&d, of->positions, s, error, sizeof error)) {
        find(r, rgba ? MASU_VERDICT_FAIL : MASU_VERDICT_RESOURCE, "ground truth: %s",
             rgba ? error : "out of memory");
        free(rgba);
        return NULL;
    }
    masu_frame_desc frame = frame_at(of, of->frames - 1);
    frame.camera = of->extreme.has_camera ? &of->extreme.camera : NULL;
    frame.light = of->extreme.has_light ? &of->extreme.light : NULL;
    bool good = masu_picture_truth(s, &frame, of->positions, of->rays,
                                   &(masu_picture_means){.display = rgba}, masu_cli_progress_text,
                                   error, sizeof error);
    close_session(c, r);
    masu_truth_picture *more =
        good ? realloc(c->truths, (c->truth_count + 1) * sizeof *more) : NULL;
    if (!more) {
        find(r, good ? MASU_VERDICT_RESOURCE : MASU_VERDICT_FAIL, "ground truth: %s",
             good ? "out of memory" : error);
        free(rgba);
        return NULL;
    }
    c->truths = more;
    c->truths[c->truth_count++] = (masu_truth_picture){of, rgba};
    return rgba;
}

/* Compares linear light, after the case's frames in the same session. */
static void compare_with_golden(masu_conform *c, const masu_case *of, masu_conform_result *r) {
    char path[4096], error[1024];
    masu_frame_desc frame = frame_at(of, of->frames - 1);
    if (!masu_extreme_frame(&c->session, of, of->frames - 1, &frame, error, sizeof error) ||
        !masu_golden_judge(masu_golden_path(c->suite, of, path), of, &c->session, &frame, r->values,
                           error, sizeof error))
        find(r, MASU_VERDICT_FAIL, "reference: %s", error);
}

static void compare_with_picture(masu_conform *c, const masu_case *of, const uint8_t *picture,
                                 masu_conform_result *r) {
    char path[4096], error[1024];
    uint8_t *golden = malloc(4 * (size_t)of->width * of->height);
    if (golden &&
        masu_picture_load(masu_golden_path(c->suite, of, path), (VkExtent2D){of->width, of->height},
                          golden, error, sizeof error))
        masu_golden_compare(golden, picture, of, r->values);
    else find(r, MASU_VERDICT_FAIL, "reference: %s", golden ? error : "out of memory");
    free(golden);
}

static void compare_with_other(masu_conform *c, const masu_case *of, const uint8_t *picture,
                               masu_conform_result *r) {
    const masu_case *other = &c->suite->cases[of->other];
    masu_cli_progress("%s: against %s", of->name, other->name);
    if (!open_session(c, other, &(way){0}, r)) return;
    uint8_t *rgba = draw_frames(c, other, r, false);
    close_session(c, r);
    if (rgba) masu_golden_compare(rgba, picture, of, r->values);
    free(rgba);
}

static void save(const masu_conform *c, const masu_case *of, const uint8_t *rgba,
                 masu_conform_result *r) {
    char path[4096], name[200], error[1024];
    snprintf(name, sizeof name, "%s", of->name);
    for (char *p = name; *p; p++) *p = strchr("/\\ ", *p) ? '-' : *p;
    snprintf(path, sizeof path, "%s/%s.%ux%u.png", c->images, name, of->width, of->height);
    if (!masu_image_save_png(path, rgba, of->width, of->height, 0, error, sizeof error))
        find(r, MASU_VERDICT_FAIL, "%s", error);
}

/* ---- Cases ----------------------------------------------------------------------------------- */

static bool supported(const masu_conform *c, const masu_case *of, masu_conform_result *r) {
    static const char *const names[] = MASU_NEEDS_NAMES;
    for (uint32_t i = 0; names[i]; i++) {
        if (of->needs & ~c->offers & 1u << i)
            find(r, MASU_VERDICT_UNSUPPORTED, "the device has no %s", names[i]);
    }
    if (of->width > c->most_pixels || of->height > c->most_pixels) {
        find(r, MASU_VERDICT_UNSUPPORTED,
             "size: found %ux%u, expected at most %u per side on this device", of->width,
             of->height, c->most_pixels);
    }
    return r->verdict == MASU_VERDICT_PASS;
}

static void run(masu_conform *c, const masu_case *of, masu_conform_result *r) {
    bool timed = (of->governed.on && !of->governed.told) ||
                 masu_bound_is_set(&of->bounds[MASU_MEASURE_MS_RATIO]);
    if (timed && c->clock_stopped) {
        find(r, MASU_VERDICT_FAIL, "%s", MASU_CLOCK_STOPPED);
        return;
    }
    if (!supported(c, of, r) || !open_session(c, of, &(way){.first = true}, r)) return;
    masu_session *s = &c->session;
    uint8_t *picture = NULL;
    r->values[MASU_MEASURE_HOST_BYTES] = (double)s->need.host_bytes;
    r->values[MASU_MEASURE_DEVICE_BYTES] = (double)s->need.device_bytes;
    bool validated = s->host.validating;
    if (s->host.desc.validate && !validated) note(r, "the validation layer is not installed");
    if (!masu_alloc_counting()) note(r, "allocations are not counted in this build");
    if (of->governed.on) {
        run_governed(c, of, r);
    } else {
        picture = draw_frames(c, of, r, true);
        if (picture && masu_bound_is_set(&of->bounds[MASU_MEASURE_MS_RATIO])) time_case(c, of, r);
    }
    if (picture && masu_case_linear(of)) compare_with_golden(c, of, r);
    close_session(c, r);
    if (!picture && !of->governed.on) return;
    if (picture && c->images) save(c, of, picture, r);
    if (picture && of->same) draw_ways(c, of, picture, r);
    if (picture && of->other >= 0) compare_with_other(c, of, picture, r);
    if (picture && of->golden && !masu_case_linear(of)) compare_with_picture(c, of, picture, r);
    if (picture && of->against && of->other < 0 && !of->golden) {
        const uint8_t *truth = truth_of(c, of, r);
        if (truth) masu_golden_compare(truth, picture, of, r->values);
    }
    free(picture);
    masu_conform_judge(r, validated);
}

void masu_conform_not_run(const masu_case *of, const char *why, masu_conform_result *out) {
    memset(out, 0, sizeof *out);
    out->of = of;
    out->verdict = MASU_VERDICT_NOT_RUN;
    for (int m = 0; m < MASU_MEASURE_COUNT; m++) out->values[m] = MASU_UNKNOWN;
    snprintf(out->why, sizeof out->why, "%s", why);
    for (char *p = out->why; *p; p++) *p = (unsigned char)*p < ' ' ? ' ' : *p;
}

void masu_conform_run(masu_conform *c, const masu_case *of, masu_conform_result *out) {
    uint64_t start = masu_clock_ns(NULL);
    masu_conform_not_run(of, "", out);
    out->verdict = MASU_VERDICT_PASS;
    run(c, of, out);
    for (char *p = out->why; *p; p++) *p = (unsigned char)*p < ' ' ? ' ' : *p;
    out->seconds = (double)(masu_clock_ns(NULL) - start) / 1e9;
}

bool masu_conform_open(masu_conform *c, char *error, size_t error_size) {
    masu_headless_desc d = c->host;
    masu_headless *host = &c->kept;
    d.ray_query = c->ray_query != MASU_OFF;
    d.validate = d.gpu_av = false;
    if (!masu_headless_open(&d, host, error, error_size)) return false;
    c->clock_stopped = !masu_clock_advances();
    snprintf(c->driver, sizeof c->driver, "%s", host->driver);
    c->most_pixels = host->properties.limits.maxImageDimension2D;
    c->offers = (host->ray_query ? MASU_NEEDS_RAY_QUERY : 0) |
                (host->compressed ? MASU_NEEDS_BC : 0) | (host->float16 ? MASU_NEEDS_FLOAT16 : 0) |
                (host->most_anisotropy > 1.0f ? MASU_NEEDS_ANISO : 0);
    return true;
}

void masu_conform_close(masu_conform *c) {
    if (c->calibrated) {
        masu_headless_settle(&c->calibration.host);
        if (c->calibration.host.device) masu_destroy(c->calibration.m);
        c->calibration.m = NULL;
        masu_headless_source_destroy(&c->calibration.host, &c->source);
        masu_session_close(&c->calibration);
    }
    c->calibrated = false;
    masu_headless_close(&c->kept);
    for (uint32_t i = 0; i < c->truth_count; i++) free(c->truths[i].rgba);
    free(c->truths);
    c->truths = NULL;
    c->truth_count = 0;
}
