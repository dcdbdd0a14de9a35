/* marches.c: see marches.h. */
#include "lab/study/marches.h"

#include "measure/shade.h"
#include "clock.h"
#include "image.h"
#include "metric/image.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const masu_bench_names[MASU_BENCH_VARIANTS] = {[MASU_BENCH_PLAIN] = "plain",
                                                           [MASU_BENCH_SEED] = "seed",
                                                           [MASU_BENCH_MASU] = "masu",
                                                           [MASU_BENCH_CHECKERBOARD] =
                                                               "checkerboard"};

static const masu_march marches[MASU_BENCH_VARIANTS] = {
    [MASU_BENCH_PLAIN] = MASU_MARCH_PLAIN,
    [MASU_BENCH_SEED] = MASU_MARCH_SEED,
    [MASU_BENCH_MASU] = MASU_MARCH_AUTO,
    [MASU_BENCH_CHECKERBOARD] = MASU_MARCH_CHECKERBOARD};

/* Names of the passes whose time is the SDF's: prefixes. */
static const char *const sdf_passes[] = {"update", "classify", "cone", "march"};

enum { REST = MASU_BENCH_VARIANTS, RENDERERS };
enum { READBACK = MASU_READBACK_DEPTH | MASU_READBACK_ALBEDO | MASU_READBACK_NORMAL };

typedef struct renderer {
    masu_renderer *m;
    void *block;
} renderer;

typedef struct bench {
    const masu_bench_desc *d;
    masu_bench *out;
    masu_session s;
    renderer timed[RENDERERS];
    masu_truth truth;
    masu_view view;
    masu_truth_sample *samples;
    masu_march_sample *compared;
    uint8_t *true_image, *shaded, *shown; /* stride-th pixels */
    double *walls;                        /* of every variant, every run */
    void (*progress)(const char *text);
    char *error;
    size_t error_size;
} bench;

static bool failed(bench *b, const char *text) {
    if (text != b->error) snprintf(b->error, b->error_size, "%s: %s", b->d->scene_path, text);
    return false;
}

static void say(bench *b, const char *what, const char *name) {
    char text[256];
    snprintf(text, sizeof text, "%s: %s %s", b->out->scene, what, name);
    if (b->progress) b->progress(text);
}

/* ---- Renderers ------------------------------------------------------------------------------- */

static void close_renderer(renderer *r) {
    masu_destroy(r->m);
    free(r->block);
    r->m = NULL;
    r->block = NULL;
}

static masu_result load(bench *b, renderer *r, masu_detail *detail) {
    masu_commands commands;
    masu_result result;
    char error[512];
    while ((result = masu_load(r->m, &commands, NULL)) == MASU_INCOMPLETE) {
        if (!masu_headless_run(&b->s.host, commands.buffer, error, sizeof error)) {
            snprintf(detail->text, sizeof detail->text, "%.190s", error);
            return MASU_ERROR_VULKAN;
        }
    }
    return result;
}

/* 1: made; 0: the scene has no such march; -1: failed. */
static int open_renderer(bench *b, masu_march march, uint32_t steps, bool counting, renderer *r) {
    masu_desc desc = b->s.desc;
    masu_memory need;
    masu_detail detail = {.text = "no memory"};
    desc.rung_count = 1;
    desc.rungs[0] = (masu_rung){.scale = 1.0f,
                                .upscale = MASU_OFF,
                                .sharpen = MASU_OFF,
                                .march_steps = steps,
                                .march = march};
    desc.debug = (masu_debug){.counters = counting, .timestamps = !counting};
    desc.readback = counting ? READBACK : 0;
    *r = (renderer){NULL, NULL};
    masu_result result = masu_memory_query(&desc, &need, &detail);
    if (!result) {
        uint64_t a = need.host_alignment;
        r->block = aligned_alloc((size_t)a, (size_t)((need.host_bytes + a - 1) / a * a));
        result = r->block ? masu_init(&desc, r->block, need.host_bytes, &r->m, &detail)
                          : MASU_ERROR_MEMORY;
    }
    if (!result) result = load(b, r, &detail);
    if (!result) return 1;
    close_renderer(r);
    if (result == MASU_ERROR_SCENE) return 0;
    failed(b, detail.text);
    return -1;
}

static bool draw(bench *b, renderer *r, masu_stats_info *stats, double *wall_ms) {
    masu_frame_desc frame = {MASU_FRAME_DESC, .time = b->d->time};
    masu_commands commands;
    char error[512];
    uint64_t start = masu_clock_ns(NULL);
    if (masu_frame(r->m, &frame, &commands, &b->s.detail)) return failed(b, b->s.detail.text);
    if (!masu_headless_submit(&b->s.host, commands.buffer, commands.slot, error, sizeof error) ||
        !masu_headless_wait(&b->s.host, commands.slot, error, sizeof error)) {
        return failed(b, error);
    }
    *wall_ms = (double)(masu_clock_ns(NULL) - start) / 1e6;
    (void)masu_stats(r->m, commands.slot, stats, NULL);
    return true;
}

/* ---- Ground truth ---------------------------------------------------------------------------- */

static size_t grid_pixels(const bench *b) {
    return (size_t)masu_truth_columns(b->d->width, b->d->stride) *
           masu_truth_columns(b->d->height, b->d->stride);
}

static bool save(bench *b, const char *name, const uint8_t *rgba, uint32_t width, uint32_t height) {
    char path[4096], error[512];
    if (!b->d->image_dir) return true;
    snprintf(path, sizeof path, "%s/%s.%s.png", b->d->image_dir, b->out->scene, name);
    return masu_image_save_png(path, rgba, width, height, 0, error, sizeof error) ||
           failed(b, error);
}

/* A ground truth that was not named may be missing: then nothing is compared. */
static bool find_truth(bench *b, bool *there) {
    char path[4096], error[512];
    const char *wanted = b->d->truth_path;
    if (!wanted) {
        FILE *f = masu_truth_path(b->d->scene_path, path, sizeof path) ? fopen(path, "rb") : NULL;
        *there = f != NULL;
        if (!f) return true;
        fclose(f);
        wanted = path;
    }
    *there = masu_truth_open(wanted, &b->truth, error, sizeof error);
    return *there || failed(b, error);
}

/* Uses the frame's camera, which only a renderer has. */
static bool make_truth(bench *b, const renderer *r) {
    masu_camera camera;
    char error[512];
    if (b->samples) return true;
    if (masu_camera_at(r->m, b->d->time, &camera, NULL) != MASU_OK)
        return failed(b, "the scene has no camera");
    if (!masu_view_of(&b->s.scene, &camera, b->d->time, b->d->width, b->d->height, &b->view, error,
                      sizeof error)) {
        return failed(b, error);
    }
    size_t n = grid_pixels(b);
    b->samples = malloc(n * sizeof *b->samples);
    b->compared = malloc(n * sizeof *b->compared);
    b->true_image = malloc(4 * n);
    b->shaded = malloc(4 * n);
    b->shown = malloc(4 * n);
    if (!b->samples || !b->compared || !b->true_image || !b->shaded || !b->shown)
        return failed(b, "out of memory for the ground truth");
    say(b, "marching", "the ground truth");
    uint64_t start = masu_clock_ns(NULL);
    masu_truth_image(&b->truth, &b->view, b->d->stride, b->samples);
    b->out->truth_seconds = (double)(masu_clock_ns(NULL) - start) / 1e9;
    masu_shade_image(&b->truth, &b->view, b->d->stride, b->samples, b->true_image);
    for (size_t i = 0; i < n; i++) {
        b->out->truth_unsure += b->samples[i].kind == MASU_TRUTH_UNSURE;
        b->out->truth_evals += b->samples[i].evals / (double)n;
    }
    b->out->truth_samples = n;
    return save(b, "truth", b->true_image, masu_truth_columns(b->d->width, b->d->stride),
                masu_truth_columns(b->d->height, b->d->stride));
}

static double angle_between(const float a[3], const double b[3]) {
    double u[3] = {(double)a[0], (double)a[1], (double)a[2]}, sine[3];
    for (int i = 0; i < 3; i++)
        sine[i] = u[(i + 1) % 3] * b[(i + 2) % 3] - u[(i + 2) % 3] * b[(i + 1) % 3];
    double cosine = u[0] * b[0] + u[1] * b[1] + u[2] * b[2];
    return atan2(hypot(hypot(sine[0], sine[1]), sine[2]), cosine) * (180 / 3.14159265358979324);
}

typedef struct gbuffer {
    masu_readback_image depth, albedo, normal;
} gbuffer;

static const void *texel_at(const masu_readback_image *image, uint32_t x, uint32_t y) {
    return (const uint8_t *)image->pixels + y * image->row_bytes + 4 * (size_t)x;
}

/* Pairs each true sample with the frame's pixel, and shades the pixel. UNSURE samples are skipped
 * here, and have the ground truth's colour in the images. */
static uint64_t pair(bench *b, const gbuffer *g) {
    uint32_t columns = masu_truth_columns(b->d->width, b->d->stride);
    uint64_t count = 0;
    for (size_t i = 0; i < grid_pixels(b); i++) {
        const masu_truth_sample *truth = &b->samples[i];
        uint32_t x = (uint32_t)(i % columns) * b->d->stride, texel;
        uint32_t y = (uint32_t)(i / columns) * b->d->stride;
        uint8_t *shaded = &b->shaded[4 * i], *shown = &b->shown[4 * i];
        memcpy(shaded, &b->true_image[4 * i], 4);
        memcpy(shown, &b->true_image[4 * i], 4);
        if (truth->kind == MASU_TRUTH_UNSURE) continue;
        memcpy(shown, &b->s.targets[0].mapped[4 * ((size_t)y * b->d->width + x)], 4);
        float depth, n[3];
        memcpy(&depth, texel_at(&g->depth, x, y), sizeof depth);
        memcpy(&texel, texel_at(&g->normal, x, y), sizeof texel);
        masu_view_ray ray = masu_view_ray_at(&b->view, x, y);
        masu_march_sample *s = &b->compared[count++];
        bool hit = depth > 0.0f, truly = truth->kind == MASU_TRUTH_HIT;
        double near_t = b->view.near_distance * ray.z_scale, radiance[3];
        *s = (masu_march_sample){
            x, y, hit ? near_t / (double)depth : -1.0, truly ? truth->t : -1.0, ray.pixel, 0.0};
        masu_unpack_normal(texel, n);
        if (hit && truly) s->normal_angle = angle_between(n, truth->normal);
        if (hit) {
            /* The emission of the true part: hdr contains the lighting already. */
            double material[8] = {0};
            if (truly && texel >> 30 & MASU_SURFACE_EMISSIVE)
                b->truth.material(truth->part, material);
            masu_shade_texel(&b->view, ray.direction, texel_at(&g->albedo, x, y), texel,
                             material + 4, radiance);
        } else {
            masu_shade_sky(&b->view, ray.direction, radiance);
        }
        masu_shade_encode(&b->view, radiance, shaded);
    }
    return count;
}

static bool compare(bench *b, const renderer *r, masu_bench_row *row) {
    gbuffer g;
    uint32_t w = masu_truth_columns(b->d->width, b->d->stride);
    uint32_t h = masu_truth_columns(b->d->height, b->d->stride);
    if (masu_readback(r->m, 0, MASU_READBACK_DEPTH, &g.depth, NULL) ||
        masu_readback(r->m, 0, MASU_READBACK_ALBEDO, &g.albedo, NULL) ||
        masu_readback(r->m, 0, MASU_READBACK_NORMAL, &g.normal, NULL)) {
        return failed(b, "no readback");
    }
    uint64_t count = pair(b, &g);
    row->rmse = masu_metric_rmse(b->true_image, b->shaded, w, h);
    row->ssim = masu_metric_ssim(b->true_image, b->shaded, w, h);
    return (masu_march_errors_of(b->compared, count, &row->errors) &&
            masu_metric_flip(b->true_image, b->shaded, w, h, 0.0, NULL, &row->flip) &&
            masu_metric_flip(b->true_image, b->shown, w, h, 0.0, NULL, &row->shown)) ||
           failed(b, "out of memory for the errors");
}

/* ---- Measuring ------------------------------------------------------------------------------- */

/* Draws one frame with counters and readback. */
static bool look_at(bench *b, int variant) {
    masu_bench_row *row = &b->out->rows[variant];
    masu_stats_info stats;
    renderer r;
    double wall;
    char error[512];
    say(b, "drawing", masu_bench_names[variant]);
    int made = open_renderer(b, marches[variant], 0, true, &r);
    if (made <= 0) return made == 0;
    row->there = true;
    bool good = draw(b, &r, &stats, &wall);
    if (good && !masu_headless_target_read(&b->s.host, &b->s.targets[0], error, sizeof error))
        good = failed(b, error);
    if (good) {
        row->evals = stats.sdf_evals;
        row->hits = stats.sdf_hits;
        row->unconverged = stats.sdf_unconverged;
        good =
            save(b, masu_bench_names[variant], b->s.targets[0].mapped, b->d->width, b->d->height);
    }
    if (good && b->out->compared) good = make_truth(b, &r) && compare(b, &r, row);
    close_renderer(&r);
    return good;
}

static double sdf_ms(const masu_stats_info *stats) {
    uint64_t ns = 0;
    for (uint32_t p = 0; p < stats->pass_count; p++) {
        bool counts = false;
        for (size_t i = 0; i < sizeof sdf_passes / sizeof *sdf_passes; i++)
            counts = counts || !strncmp(stats->pass_names[p], sdf_passes[i], strlen(sdf_passes[i]));
        if (counts) ns += stats->pass_ns[p];
    }
    return (double)ns / 1e6;
}

/* Mesa 22.3's lavapipe reports 0.1 ms for work of 100 ms, once the process has done graphics
 * work. */
static bool plausible(const masu_stats_info *stats, double wall_ms) {
    double gpu = (double)stats->gpu_ns / 1e6;
    return stats->timed && gpu >= 0.5 * wall_ms && gpu <= 1.05 * wall_ms;
}

/* Times one frame of each variant per round, starting with another variant in each round, so that
 * other load on the machine affects all equally. Round 0 is not counted: drivers compile at first
 * use. */
static bool time_all(bench *b) {
    masu_bench *o = b->out;
    for (uint32_t round = 0; round <= b->d->runs; round++) {
        char text[32];
        snprintf(text, sizeof text, "%u of %u", round, b->d->runs);
        say(b, "timing, round", text);
        for (uint32_t i = 0; i < RENDERERS; i++) {
            uint32_t k = (i + round) % RENDERERS;
            masu_stats_info stats;
            double wall;
            if (!b->timed[k].m) continue;
            if (!draw(b, &b->timed[k], &stats, &wall)) return false;
            if (!round) continue;
            if (k == REST) {
                if (round == 1 || wall < o->rest_wall_ms) o->rest_wall_ms = wall;
                continue;
            }
            masu_bench_row *row = &o->rows[k];
            b->walls[(size_t)k * b->d->runs + round - 1] = wall;
            double gpu = stats.timed ? sdf_ms(&stats) : 0.0;
            if (round == 1 || wall < row->wall_ms) row->wall_ms = wall;
            if (round == 1 || gpu < row->gpu_ms) row->gpu_ms = gpu;
            row->plausible += plausible(&stats, wall);
        }
    }
    return true;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Timestamps must fit the wall clock in most frames, and the SDF passes must not take much less
 * than the difference to a frame without them: a driver may write timestamps before the work is
 * done. All variants use the same clock: otherwise their ratios mean nothing. */
static bool trust_timestamps(const bench *b) {
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++) {
        const masu_bench_row *row = &b->out->rows[v];
        double by_wall = row->wall_ms - b->out->rest_wall_ms;
        if (!row->there) continue;
        if (2 * row->plausible <= b->d->runs || !(row->gpu_ms > 0)) return false;
        if (row->gpu_ms < 0.5 * by_wall - 2.0) return false;
    }
    return true;
}

static bool measure(bench *b) {
    masu_bench *o = b->out;
    b->walls = calloc((size_t)MASU_BENCH_VARIANTS * b->d->runs, sizeof *b->walls);
    if (!b->walls) return failed(b, "out of memory for the times");
    say(b, "building", "pipelines");
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++) {
        if (o->rows[v].there && open_renderer(b, marches[v], 0, false, &b->timed[v]) <= 0)
            return false;
    }
    /* The cost of the rest of a frame: of one whose march takes a single step. If a scene has no
     * plain march, its own is used. */
    masu_march least = o->rows[MASU_BENCH_PLAIN].there ? MASU_MARCH_PLAIN : MASU_MARCH_AUTO;
    if (open_renderer(b, least, 1, false, &b->timed[REST]) <= 0) return false;
    if (!time_all(b)) return false;
    o->by_timestamps = trust_timestamps(b);
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++) {
        masu_bench_row *row = &o->rows[v];
        double *walls = b->walls + (size_t)v * b->d->runs;
        if (!row->there) continue;
        qsort(walls, b->d->runs, sizeof *walls, by_size);
        row->spread = walls[b->d->runs / 2] / walls[0];
        double by_wall = row->wall_ms - o->rest_wall_ms;
        if (by_wall < 0.05 * o->rest_wall_ms) by_wall = nan(""); /* lost in the rest */
        row->ms = o->by_timestamps ? row->gpu_ms : by_wall;
    }
    return true;
}

/* ---- All ------------------------------------------------------------------------------------- */

static void name_scene(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    size_t n = strlen(name);
    if (n > 5 && !strcmp(name + n - 5, ".masu")) n -= 5;
    snprintf(out, size, "%.*s", (int)n, name);
}

static void close_all(bench *b) {
    if (b->s.host.device) vkDeviceWaitIdle(b->s.host.device);
    for (int i = 0; i < RENDERERS; i++) close_renderer(&b->timed[i]);
    masu_truth_close(&b->truth);
    free(b->walls);
    free(b->samples);
    free(b->compared);
    free(b->true_image);
    free(b->shaded);
    free(b->shown);
    masu_session_close(&b->s);
}

bool masu_bench_run(const masu_bench_desc *desc, masu_bench *out,
                    void (*progress)(const char *text), char *error, size_t error_size) {
    static bench b; /* a session must not move, and is large */
    memset(&b, 0, sizeof b);
    memset(out, 0, sizeof *out);
    b.d = desc;
    b.out = out;
    b.progress = progress;
    b.error = error;
    b.error_size = error_size;
    name_scene(desc->scene_path, out->scene, sizeof out->scene);
    masu_session_desc d = {.scene_path = desc->scene_path,
                           .desc = {.output = {desc->width, desc->height},
                                    .targets = {.storage = 1},
                                    .frames_in_flight = 1},
                           .host = desc->host,
                           .no_renderer = true};
    if (!masu_session_open(&d, &b.s, error, error_size)) return false;
    snprintf(out->driver, sizeof out->driver, "%s", b.s.host.driver);
    bool good = (masu_scene_features(&b.s.scene) & MASU_SCENE_HAS_SDF)
                    ? find_truth(&b, &out->compared)
                    : failed(&b, "has no SDF");
    for (int v = 0; v < MASU_BENCH_VARIANTS && good; v++) {
        if (!desc->only || (desc->only >> v & 1)) good = look_at(&b, v);
    }
    if (desc->runs) good = good && measure(&b);
    if (good && b.s.host.messages) good = failed(&b, "the validation layer reported messages");
    close_all(&b);
    return good;
}
