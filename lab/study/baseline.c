/* baseline.c: see baseline.h. */
#include "lab/study/baseline.h"

#include "measure/motion.h"
#include "measure/picture.h"
#include "clock.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* With a still camera, timing starts after SETTLE_FRAMES frames, when temporal accumulation costs
 * least. Counters are of the last of COUNT_FRAMES frames in motion. */
enum { SETTLE_FRAMES = 4, COUNT_FRAMES = 3 };

typedef struct timing {
    masu_samples of[MASU_BASELINE_PHASES];
    uint64_t frame; /* frames drawn in motion since the image */
} timing;

typedef struct bench {
    const masu_baseline_desc *d;
    masu_baseline *out;
    masu_session sessions[MASU_BASELINE_ENTRIES], other; /* must not move, and are large */
    bool opened[MASU_BASELINE_ENTRIES];
    timing timings[MASU_BASELINE_ENTRIES];
    masu_rung rungs[MASU_BASELINE_ENTRIES];
    uint32_t plain_for; /* samples of the plain session in `other`; 0: it is not open */
    masu_march plain_march;
    bool textured, remembers;
    uint32_t pixels;
    uint8_t *truth, *picture;
    char *error;
    size_t error_size;
} bench;

static bool failed(bench *w, const char *text) {
    snprintf(w->error, w->error_size, "%s: %s", w->d->scene_path, text);
    return false;
}

static void say(const bench *w, const char *what, const char *name) {
    char text[MASU_SETTING_ID + 64];
    if (!w->d->progress) return;
    snprintf(text, sizeof text, "%s%s%s", what, name[0] ? ": " : "", name);
    w->d->progress(text);
}

/* ---- Sessions -------------------------------------------------------------------------------- */

masu_rung masu_baseline_rung(const masu_scene *scene, const char **march) {
    masu_rung rung = {.scale = 1.0f,
                      .upscale = MASU_OFF,
                      .sharpen = MASU_OFF,
                      .aa = MASU_AA_OFF,
                      .frustum = MASU_OFF,
                      .occlusion = MASU_OFF,
                      .lod_error = -1.0f,
                      .light_tiles = MASU_OFF};
    *march = masu_scene_data_of(scene)->sdf ? "auto" : "none";
    if (!masu_scene_data_of(scene)->sdf) return rung;
    if (masu_scene_data_of(scene)->sdf_march >> MASU_MARCH_PLAIN & 1u) {
        rung.march = MASU_MARCH_PLAIN;
        *march = "plain";
    }
    return rung;
}

static masu_session_desc session_of(const bench *w) {
    return masu_picture_session(w->d->scene_path, w->d->size, &w->d->host);
}

/* samples: of a plain session, for its mips. */
static masu_session_desc entry_desc(const bench *w, uint32_t e, uint32_t samples) {
    masu_session_desc d = session_of(w);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = w->rungs[e];
    if (w->out->entries[e].plain) {
        d.desc.debug.reference = 1;
        d.desc.debug.ao_full = e == 0;
        d.desc.debug.mip_bias = -0.5f * log2f((float)samples);
    }
    return d;
}

static void close_session(bench *w, masu_session *s) {
    masu_session_close(s);
    w->out->messages += s->host.messages;
}

static void close_entries(bench *w) {
    for (uint32_t e = 0; e < MASU_BASELINE_ENTRIES; e++) {
        if (w->opened[e]) close_session(w, &w->sessions[e]);
        w->opened[e] = false;
    }
}

static bool open_entries(bench *w) {
    for (uint32_t e = 0; e < w->out->entry_count; e++) {
        masu_session_desc d = entry_desc(w, e, 1);
        masu_plan_info plan;
        d.desc.debug.timestamps = 1;
        say(w, "building pipelines", w->out->entries[e].name);
        if (!masu_session_open(&d, &w->sessions[e], w->error, w->error_size)) return false;
        w->opened[e] = true;
        masu_plan_of(w->sessions[e].m, &plan);
        w->out->entries[e].render =
            (VkExtent2D){plan.rungs[0].render_width, plan.rungs[0].render_height};
    }
    return true;
}

/* Reads the scene's properties, which decide the entries. */
static bool find_entries(bench *w) {
    masu_session_desc d = session_of(w);
    masu_baseline *out = w->out;
    d.no_renderer = true;
    if (!masu_session_open(&d, &w->other, w->error, w->error_size)) return false;
    const masu_scene *scene = &w->other.scene;
    snprintf(out->driver, sizeof out->driver, "%s", w->other.host.driver);
    w->textured = masu_scene_data_of(scene)->textures != 0;
    w->remembers = masu_scene_data_of(scene)->reflections || masu_scene_data_of(scene)->metered;
    out->plain_count = masu_scene_data_of(scene)->occlusion_radius > 0.0f ? 2 : 1;
    for (uint32_t e = 0; e < out->plain_count; e++) {
        w->rungs[e] = masu_baseline_rung(scene, &out->march);
        out->entries[e].plain = true;
        snprintf(out->entries[e].name, MASU_SETTING_ID, "%s", e ? "plain, ao as ours" : "plain");
    }
    for (uint32_t r = 0; r < w->d->rung_count; r++) {
        uint32_t e = out->plain_count + r;
        w->rungs[e] = w->d->rungs[r];
        masu_setting_name(&w->rungs[e], out->entries[e].name);
    }
    out->entry_count = out->plain_count + w->d->rung_count;
    close_session(w, &w->other);
    return true;
}

/* ---- Images ---------------------------------------------------------------------------------- */

static bool draw(bench *w, masu_session *s, double time, bool cut, masu_commands *commands) {
    return masu_motion_frame(s, 0, time, MASU_MOTION_STEP, cut, commands, w->error, w->error_size);
}

static bool save(bench *w, const char *name, const uint8_t *rgba) {
    char path[4096];
    if (!w->d->image_dir) return true;
    snprintf(path, sizeof path, "%s/%s.%s.png", w->d->image_dir, w->out->scene, name);
    return masu_image_save_png(path, rgba, w->d->size.width, w->d->size.height, 0, w->error,
                               w->error_size);
}

static bool compare(bench *w, const uint8_t *shown, masu_baseline_errors *out) {
    VkExtent2D size = w->d->size;
    masu_flip flip;
    if (!masu_metric_flip(w->truth, shown, size.width, size.height, 0, NULL, &flip))
        return failed(w, "out of memory");
    out->of[MASU_BASELINE_FLIP] = flip.mean;
    out->of[MASU_BASELINE_RMSE] = masu_metric_rmse(w->truth, shown, size.width, size.height);
    out->of[MASU_BASELINE_SSIM] = 1.0 - masu_metric_ssim(w->truth, shown, size.width, size.height);
    return true;
}

static bool draw_setting(bench *w, uint32_t e) {
    masu_session *s = &w->sessions[e];
    const masu_motion motion = {w->d->time, w->d->step, w->d->frames, w->remembers};
    uint64_t next = 0;
    say(w, "in motion", w->out->entries[e].name);
    if (!masu_motion_draw(s, &motion, 0, &w->rungs[e], &next, w->error, w->error_size) ||
        !masu_headless_target_read(&s->host, &s->targets[0], w->error, w->error_size)) {
        return false;
    }
    return compare(w, s->targets[0].mapped, &w->out->entries[e].errors) &&
           save(w, w->out->entries[e].name, s->targets[0].mapped);
}

/* A renderer has one set of mips: with textures, a new one is made for each k. Culling and light
 * tiles do not change the image (tests/gpu/test_culling.c, test_lights.c), and save most of the
 * time in a large world. */
static bool open_plain(bench *w, uint32_t k, masu_march march) {
    bool kept = w->plain_for == k || (w->plain_for && !w->textured);
    if (kept && w->plain_march == march) return true;
    masu_session_desc d = entry_desc(w, 0, k);
    d.desc.rungs[0].frustum = d.desc.rungs[0].occlusion = MASU_AUTO;
    d.desc.rungs[0].light_tiles = MASU_AUTO;
    d.desc.rungs[0].march = march;
    d.desc.readback = MASU_READBACK_HDR;
    if (w->plain_for) close_session(w, &w->other);
    w->plain_for = 0;
    if (!masu_session_open(&d, &w->other, w->error, w->error_size)) return false;
    w->plain_for = k;
    w->plain_march = march;
    return true;
}

static void close_plain(bench *w) {
    if (w->plain_for) close_session(w, &w->other);
    w->plain_for = 0;
}

/* The mean of k plain frames, in w->picture. */
static bool draw_plain(bench *w, uint32_t k, masu_march march, masu_baseline_errors *out) {
    masu_frame_desc frame = {.time = w->d->time};
    char text[64];
    snprintf(text, sizeof text, "%u samples", k);
    say(w, "plain", text);
    return open_plain(w, k, march) &&
           masu_picture_truth(&w->other, &frame, k, k, &(masu_picture_means){.display = w->picture},
                              NULL, w->error, w->error_size) &&
           compare(w, w->picture, out);
}

/* ---- Equal error ----------------------------------------------------------------------------- */

uint32_t masu_baseline_least(uint32_t most, int (*enough)(void *user, uint32_t k), void *user) {
    uint32_t low = 0, high = 1; /* low: not enough */
    for (;;) {
        int answer = enough(user, high);
        if (answer < 0) return UINT32_MAX;
        if (answer) break;
        if (high >= most) return 0;
        low = high;
        high = high > most / 2 ? most : 2 * high;
    }
    while (high - low > 1 && 8 * (high - low) > high) {
        uint32_t middle = low + (high - low) / 2;
        int answer = enough(user, middle);
        if (answer < 0) return UINT32_MAX;
        if (answer)
            high = middle;
        else
            low = middle;
    }
    return high;
}

typedef struct search {
    bench *w;
    int metric;
    double wanted;
} search;

static const masu_baseline_point *find_point(const masu_baseline *out, uint32_t k) {
    for (uint32_t i = 0; i < out->point_count; i++) {
        if (out->points[i].samples == k) return &out->points[i];
    }
    return NULL;
}

/* The march of the images for which samples are counted. */
static masu_march counted_march(const bench *w) {
    return w->d->own_march ? w->rungs[0].march : MASU_MARCH_AUTO;
}

static const masu_baseline_point *plain_point(bench *w, uint32_t k) {
    const masu_baseline_point *known = find_point(w->out, k);
    char name[64];
    if (known) return known;
    if (w->out->point_count == MASU_BASELINE_POINTS) {
        failed(w, "too many counts of samples");
        return NULL;
    }
    masu_baseline_point *p = &w->out->points[w->out->point_count];
    snprintf(name, sizeof name, "plain.%u", k);
    p->samples = k;
    if (!draw_plain(w, k, counted_march(w), &p->errors) || !save(w, name, w->picture)) return NULL;
    w->out->point_count++;
    return p;
}

static int is_enough(void *user, uint32_t k) {
    const search *s = user;
    const masu_baseline_point *p = plain_point(s->w, k);
    return p ? p->errors.of[s->metric] <= s->wanted : -1;
}

static bool find_equals(bench *w) {
    masu_baseline *out = w->out;
    for (uint32_t e = out->plain_count; e < out->entry_count; e++) {
        for (int m = 0; m < MASU_BASELINE_METRICS; m++) {
            search s = {w, m, out->entries[e].errors.of[m]};
            out->entries[e].samples[m] = masu_baseline_least(w->d->most, is_enough, &s);
            if (out->entries[e].samples[m] == UINT32_MAX) return false;
        }
    }
    return true;
}

/* ---- Times ----------------------------------------------------------------------------------- */

static void keep_passes(masu_baseline_entry *e, const masu_stats_info *stats) {
    e->pass_count = stats->pass_count;
    for (uint32_t p = 0; p < stats->pass_count; p++) {
        double ms = (double)stats->pass_ns[p] / 1e6;
        e->pass_names[p] = stats->pass_names[p];
        if (!(e->pass_ms[p] > 0.0) || ms < e->pass_ms[p]) e->pass_ms[p] = ms;
    }
}

/* If a cascade is drawn only in every n-th frame: the mean of n frames. */
static bool sample(bench *w, uint32_t e, int phase, bool kept) {
    masu_session *s = &w->sessions[e];
    timing *t = &w->timings[e];
    bool plain = w->out->entries[e].plain;
    uint32_t period = masu_setting_period(&w->rungs[e]);
    double wall = 0.0, gpu = 0.0;
    for (uint32_t k = 0; k < period; k++) {
        masu_commands commands;
        masu_stats_info stats;
        if (phase == MASU_BASELINE_MOTION) t->frame++;
        uint64_t start = masu_clock_ns(NULL);
        if (!draw(w, s, w->d->time + (double)t->frame / 60.0, plain, &commands)) return false;
        wall += (double)(masu_clock_ns(NULL) - start) / 1e6;
        if (masu_stats(s->m, commands.slot, &stats, NULL) || !stats.timed) continue;
        gpu += (double)stats.gpu_ns / 1e6;
        if (kept && phase == MASU_BASELINE_MOTION) keep_passes(&w->out->entries[e], &stats);
    }
    if (kept) masu_samples_add(&t->of[phase], wall, gpu, period);
    return true;
}

static bool time_phase(bench *w, int phase) {
    uint32_t settle = phase == MASU_BASELINE_REST ? SETTLE_FRAMES : 0;
    for (uint32_t run = 0; run <= w->d->runs; run++) {
        char text[64];
        snprintf(text, sizeof text, "round %u of %u", run, w->d->runs);
        say(w, phase == MASU_BASELINE_REST ? "timing with still camera" : "timing in motion", text);
        for (uint32_t e = 0; e < w->out->entry_count; e++) {
            for (uint32_t k = 0; run == 0 && k < settle && !w->out->entries[e].plain; k++) {
                if (!sample(w, e, phase, false)) return false;
            }
            if (!sample(w, e, phase, run > 0)) return false;
        }
    }
    return true;
}

static void sum_up(bench *w, int phase) {
    uint32_t n = w->d->runs;
    for (uint32_t e = w->out->entry_count;
         e-- > 0;) { /* the plain one last: ratios use its rounds */
        const masu_samples *plain = &w->timings[0].of[phase];
        masu_samples *own = &w->timings[e].of[phase];
        masu_baseline_time *t = &w->out->entries[e].times[phase];
        t->ratio = masu_samples_ratio(own->wall, plain->wall, n);
        t->gpu_ratio = masu_samples_ratio(own->gpu, plain->gpu, n);
        t->plausible = (double)own->plausible / own->count;
    }
    for (uint32_t e = 0; e < w->out->entry_count; e++) {
        masu_samples *own = &w->timings[e].of[phase];
        masu_baseline_time *t = &w->out->entries[e].times[phase];
        masu_samples_sort(own);
        t->wall_ms = own->wall[0];
        t->gpu_ms = own->gpu[0];
        t->least_ratio = w->out->entries[0].times[phase].wall_ms / t->wall_ms;
    }
}

static bool time_all(bench *w) {
    for (int phase = 0; phase < MASU_BASELINE_PHASES && w->d->runs; phase++) {
        if (!time_phase(w, phase)) return false;
        sum_up(w, phase);
    }
    return true;
}

/* The share of passes whose name starts with one of `names`. */
static double share_of(const masu_baseline_entry *e, const char *const *names, size_t count) {
    double all = 0.0, sum = 0.0;
    for (uint32_t p = 0; p < e->pass_count; p++) {
        bool named = false;
        for (size_t i = 0; i < count; i++)
            named = named || !strncmp(e->pass_names[p], names[i], strlen(names[i]));
        all += e->pass_ms[p];
        sum += named ? e->pass_ms[p] : 0.0;
    }
    return all > 0.0 ? sum / all : 0.0;
}

double masu_baseline_spare(const masu_baseline_entry *plain) {
    static const char *const names[] = {"update_previous", "velocity", "sdf_velocity",
                                        "specular_accumulate"};
    return share_of(plain, names, sizeof names / sizeof *names);
}

double masu_baseline_once(const masu_baseline_entry *plain) {
    static const char *const names[] = {"update", "cascade_"};
    return share_of(plain, names, sizeof names / sizeof *names);
}

double masu_baseline_equal(const masu_baseline *b, const masu_baseline_entry *setting, uint32_t k) {
    double again = k ? (double)(k - 1) * (1.0 - masu_baseline_once(&b->entries[0])) : 0.0;
    return setting->times[MASU_BASELINE_MOTION].ratio * (1.0 + again);
}

/* ---- Counts ---------------------------------------------------------------------------------- */

static bool count_entry(bench *w, uint32_t e) {
    masu_session_desc d = entry_desc(w, e, 1);
    masu_baseline_entry *entry = &w->out->entries[e];
    masu_commands commands;
    masu_stats_info stats;
    d.desc.debug.counters = 1;
    say(w, "counting", entry->name);
    if (!masu_session_open(&d, &w->other, w->error, w->error_size)) return false;
    bool good = true;
    uint32_t frames = entry->plain ? 1 : COUNT_FRAMES;
    for (uint32_t k = 0; k < frames && good; k++) {
        double time = w->d->time - (double)(frames - 1 - k) / 60.0;
        good = draw(w, &w->other, time, k == 0, &commands);
    }
    if (good && masu_stats(w->other.m, commands.slot, &stats, NULL)) good = failed(w, "no counts");
    if (good) {
        entry->evals = stats.sdf_evals;
        entry->occlusion_evals = stats.shadow_evals + stats.occlusion_evals;
        entry->specular_rays = stats.specular_rays;
        entry->specular_nodes = stats.specular_nodes;
        entry->specular_evals = stats.specular_evals;
        entry->light_tests = stats.light_tests;
        entry->draws = stats.draws;
        entry->triangles = stats.triangles;
    }
    close_session(w, &w->other);
    return good;
}

static bool count_all(bench *w) {
    for (uint32_t e = 0; e < w->out->entry_count; e++) {
        if (!count_entry(w, e)) return false;
    }
    return true;
}

/* ---- All ------------------------------------------------------------------------------------- */

static bool find_truth(bench *w) {
    masu_session_desc d = session_of(w);
    masu_picture_want want = {.path = w->d->truth_path,
                              .time = w->d->time,
                              .positions = w->d->positions,
                              .rays = w->d->rays,
                              .progress = w->d->progress};
    bool good = masu_picture_find(&d, &want, w->truth, w->error, w->error_size);
    w->out->messages += want.messages;
    return good && save(w, "truth", w->truth);
}

static bool draw_settings(bench *w) {
    for (uint32_t e = w->out->plain_count; e < w->out->entry_count; e++) {
        if (!draw_setting(w, e)) return false;
    }
    return true;
}

/* The second plain entry is only for times. */
static bool find_errors(bench *w) {
    const masu_baseline_point *first = plain_point(w, 1);
    bool good = first != NULL;
    if (good) w->out->entries[0].errors = first->errors;
    if (good && w->rungs[0].march != counted_march(w)) {
        good = draw_plain(w, 1, w->rungs[0].march, &w->out->entries[0].errors) &&
               save(w, "plain", w->picture);
    }
    for (uint32_t k = 1; good && w->d->curve && k <= w->d->most; k *= 2)
        good = plain_point(w, k) != NULL;
    return good && find_equals(w);
}

static bool run(bench *w) {
    bool good = find_entries(w) && find_truth(w) && count_all(w) && open_entries(w) &&
                draw_settings(w) && time_all(w);
    close_entries(w);
    good = good && find_errors(w);
    close_plain(w);
    return good;
}

bool masu_baseline_run(const masu_baseline_desc *desc, masu_baseline *out, char *error,
                       size_t error_size) {
    static bench w;
    memset(&w, 0, sizeof w);
    memset(out, 0, sizeof *out);
    w.d = desc;
    w.out = out;
    w.error = error;
    w.error_size = error_size;
    w.pixels = desc->size.width * desc->size.height;
    const char *slash = strrchr(desc->scene_path, '/');
    const char *name = slash ? slash + 1 : desc->scene_path;
    snprintf(out->scene, sizeof out->scene, "%.*s", (int)strcspn(name, "."), name);
    if (!desc->rung_count || desc->rung_count > MASU_BASELINE_SETTINGS || !desc->most ||
        desc->most > MASU_BASELINE_SAMPLES || desc->runs > MASU_SAMPLES_MAX || !desc->frames) {
        return failed(&w, "settings, samples, frames or runs out of range");
    }
    w.truth = malloc(4 * (size_t)w.pixels);
    w.picture = malloc(4 * (size_t)w.pixels);
    bool good = ((w.truth && w.picture) || failed(&w, "out of memory")) && run(&w);
    free(w.truth);
    free(w.picture);
    return good;
}
