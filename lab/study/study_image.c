/* study_image.c: `masu-lab study image`: how far each chain of anti-aliasing, upscaling and
 * sharpening, at some render sizes, is from the ground truth, and its cost.
 *
 * The ground truth is drawn as by `masu render --truth`. A chain is a row of the table below, and a
 * rung of a renderer; a renderer holds several, which alternate. The image shows the scene
 * with a still camera, after as many frames as the filters of reflections need; times are the least
 * over frames. The study only reports. */
#include "lab/study/study.h"

#include "measure/picture.h"
#include "clock.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* coarse: mips of the render size instead of the output's, as with an upscaler that ignores
 * this. */
typedef struct chain {
    const char *name;
    masu_rung rung; /* without its scale */
    uint32_t coarse;
} chain;

#define SHARP .sharpen = MASU_ON, .sharpness = 0.2f
#define BLUNT .sharpen = MASU_OFF

/* At the output's size. */
static const chain native[] = {
    {"none", {BLUNT}, 0},
    {"rcas", {SHARP}, 0},
    {"fxaa", {BLUNT, .aa = MASU_AA_FXAA}, 0},
    {"smaa low", {BLUNT, .aa = MASU_AA_SMAA_LOW}, 0},
    {"smaa medium", {BLUNT, .aa = MASU_AA_SMAA_MEDIUM}, 0},
    {"smaa high", {BLUNT, .aa = MASU_AA_SMAA_HIGH}, 0},
    {"smaa ultra", {BLUNT, .aa = MASU_AA_SMAA_ULTRA}, 0},
    {"smaa high+rcas", {SHARP, .aa = MASU_AA_SMAA_HIGH}, 0},
};

/* Below the output's size. */
static const chain upscaled[] = {
    {"bilinear", {BLUNT, .easu = MASU_EASU_BILINEAR}, 0},
    {"easu", {BLUNT}, 0},
    {"easu+rcas", {SHARP}, 0},
    {"easu+rcas 1 stop", {.sharpen = MASU_ON, .sharpness = 1.0f}, 0},
    {"easu+rcas 2 stops", {.sharpen = MASU_ON, .sharpness = 2.0f}, 0},
    {"easu-fast+rcas", {SHARP, .easu = MASU_EASU_FAST}, 0},
    {"fxaa+easu", {BLUNT, .aa = MASU_AA_FXAA}, 0},
    {"fxaa+easu+rcas", {SHARP, .aa = MASU_AA_FXAA}, 0},
    {"smaa high+bilinear", {BLUNT, .aa = MASU_AA_SMAA_HIGH, .easu = MASU_EASU_BILINEAR}, 0},
    {"smaa low+easu+rcas", {SHARP, .aa = MASU_AA_SMAA_LOW}, 0},
    {"smaa high+easu", {BLUNT, .aa = MASU_AA_SMAA_HIGH}, 0},
    {"smaa high+easu+rcas", {SHARP, .aa = MASU_AA_SMAA_HIGH}, 0},
    {"smaa ultra+easu+rcas", {SHARP, .aa = MASU_AA_SMAA_ULTRA}, 0},
    {"easu+rcas coarse mips", {SHARP}, 1},
};

#define COUNT(array) (sizeof(array) / sizeof *(array))
enum { SCALES_MOST = 8, ROWS_MOST = SCALES_MOST * COUNT(upscaled) };

typedef struct options {
    masu_study_options study;
    double ppd, anisotropy, scales[SCALES_MOST];
    uint32_t scale_count, rays;
    masu_headless_desc host; /* with the extension for --rays */
    masu_switch ray_query;
} options;

static options given = {.study = {.size = {640, 360},
                                  .frames = 32,
                                  .runs = 9,
                                  .truth = {NULL, MASU_PICTURE_POSITIONS, MASU_PICTURE_RAYS}},
                        .ppd = MASU_FLIP_PPD,
                        .scales = {1.0, 0.8, 0.5, 0.4},
                        .scale_count = 4};
static const masu_study_options *const o = &given.study;

typedef struct row {
    const chain *of;
    double scale;
    VkExtent2D render;
    masu_flip flip;
    double rmse, ssim;
    double chain_ms, gpu_ms, wall_ms; /* 0: not timed */
} row;

typedef struct bench {
    uint8_t *truth;
    float *map;
    uint32_t pixels, row_count;
    row rows[ROWS_MOST];
    char scene[128], driver[1024], error[1024];
    uint32_t messages; /* of the validation layer */
} bench;

static bool failed(bench *b, const char *text) {
    snprintf(b->error, sizeof b->error, "%s: %s", o->scene, text);
    return false;
}

/* ---- The ground truth ------------------------------------------------------------------------ */

static masu_session_desc session_of(void) {
    masu_session_desc d = masu_picture_session(o->scene, o->size, &given.host);
    d.desc.ray_query = given.ray_query;
    d.desc.vulkan.max_anisotropy = (float)given.anisotropy; /* only for the chains */
    return d;
}

static void close_session(bench *b, masu_session *s) {
    b->messages += s->host.messages;
    snprintf(b->driver, sizeof b->driver, "%s", s->host.driver);
    masu_session_close(s);
}

static bool find_truth(bench *b) {
    masu_session_desc d = session_of();
    masu_picture_want truth = {.path = o->truth.path,
                               .time = o->time,
                               .positions = o->truth.positions,
                               .rays = o->truth.rays,
                               .progress = masu_cli_progress_text};
    bool good = masu_picture_find(&d, &truth, b->truth, b->error, sizeof b->error);
    b->messages += truth.messages;
    return good;
}

/* ---- Chains ---------------------------------------------------------------------------------- */

static void plan_rows(bench *b) {
    for (uint32_t i = 0; i < given.scale_count; i++) {
        bool whole = given.scales[i] >= 1.0;
        const chain *chains = whole ? native : upscaled;
        size_t count = whole ? COUNT(native) : COUNT(upscaled);
        for (size_t k = 0; k < count; k++) {
            if (o->only && !strstr(chains[k].name, o->only)) continue;
            b->rows[b->row_count++] = (row){.of = &chains[k], .scale = given.scales[i]};
        }
    }
}

/* How many rows from `first` one renderer can hold: debug.mip_bias is the same for all its
 * rungs. */
static uint32_t batch_of(const bench *b, uint32_t first) {
    uint32_t n = 1;
    while (n < MASU_MAX_RUNGS && first + n < b->row_count &&
           b->rows[first].of->coarse == b->rows[first + n].of->coarse &&
           (!b->rows[first].of->coarse || b->rows[first].scale == b->rows[first + n].scale)) {
        n++;
    }
    return n;
}

static bool frame_of(bench *b, masu_session *s, uint32_t rung, bool cut, masu_commands *commands) {
    masu_camera camera;
    if (masu_camera_at(s->m, o->time, &camera, NULL)) return failed(b, "the scene has no camera");
    masu_frame_desc frame = {
        .camera = &camera, .time = o->time, .time_step = 1.0f / 60.0f, .rung = rung, .cut = cut};
    return masu_session_frame(s, &frame, true, commands, b->error, sizeof b->error);
}

static bool save(bench *b, const row *r, const uint8_t *rgba) {
    char path[4096], name[64];
    snprintf(name, sizeof name, "%s", r->of->name);
    for (char *c = name; *c; c++) *c = *c == ' ' ? '-' : *c;
    snprintf(path, sizeof path, "%s/%s.%.2f.%s.png", o->images, b->scene, r->scale, name);
    if (!masu_image_save_png(path, rgba, o->size.width, o->size.height, 0, b->error,
                             sizeof b->error)) {
        return false;
    }
    snprintf(path, sizeof path, "%s/%s.%.2f.%s.flip.png", o->images, b->scene, r->scale, name);
    return masu_study_save_grey(path, b->map, o->size, b->error, sizeof b->error);
}

/* Without reflections every frame of the scene is the same. */
static bool compare(bench *b, masu_session *s, uint32_t rung, row *r) {
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    r->render = (VkExtent2D){plan.rungs[rung].render_width, plan.rungs[rung].render_height};
    uint32_t frames = (masu_scene_features(&s->scene) & MASU_SCENE_HAS_REFLECTIONS) ? o->frames : 1;
    masu_commands commands;
    masu_cli_progress("%s at %.2f", r->of->name, r->scale);
    for (uint32_t k = 0; k < frames; k++) {
        if (!frame_of(b, s, rung, k == 0, &commands)) return false;
    }
    if (!masu_headless_target_read(&s->host, &s->targets[0], b->error, sizeof b->error))
        return false;
    const uint8_t *shown = s->targets[0].mapped;
    VkExtent2D size = o->size;
    if (!masu_metric_flip(b->truth, shown, size.width, size.height, given.ppd, b->map, &r->flip))
        return failed(b, "out of memory");
    r->rmse = masu_metric_rmse(b->truth, shown, size.width, size.height);
    r->ssim = masu_metric_ssim(b->truth, shown, size.width, size.height);
    return !o->images || save(b, r, shown);
}

/* The time of the passes after the tone curve. */
static double chain_ns(const masu_stats_info *stats) {
    uint64_t sum = 0;
    bool behind = false;
    for (uint32_t p = 0; p < stats->pass_count; p++) {
        if (behind) sum += stats->pass_ns[p];
        behind = behind || !strcmp(stats->pass_names[p], "tonemap");
    }
    return (double)sum;
}

static void least(double *value, double candidate) {
    if (*value == 0.0 || candidate < *value) *value = candidate;
}

/* One run more than requested: the first after a change of rung is dropped with the warm-up. */
static bool measure(bench *b, masu_session *s, uint32_t first, uint32_t count) {
    for (uint32_t run = 0; run <= o->runs && o->runs; run++) {
        masu_cli_progress("timing, run %u of %u", run, o->runs);
        for (uint32_t k = 0; k < count; k++) {
            masu_commands commands;
            masu_stats_info stats;
            uint64_t start = masu_clock_ns(NULL);
            if (!frame_of(b, s, k, true, &commands)) return false;
            double wall = (double)(masu_clock_ns(NULL) - start) / 1e6;
            if (!run || masu_stats(s->m, commands.slot, &stats, NULL)) continue;
            least(&b->rows[first + k].wall_ms, wall);
            least(&b->rows[first + k].gpu_ms, (double)stats.gpu_ns / 1e6);
            least(&b->rows[first + k].chain_ms, chain_ns(&stats) / 1e6);
        }
    }
    return true;
}

static bool run_batch(bench *b, uint32_t first, uint32_t count) {
    static masu_session s;
    masu_session_desc d = session_of();
    const row *r = &b->rows[first];
    d.desc.debug.timestamps = o->runs != 0;
    d.desc.debug.mip_bias = r->of->coarse ? -log2f((float)r->scale) : 0.0f;
    d.desc.rung_count = count;
    for (uint32_t k = 0; k < count; k++) {
        d.desc.rungs[k] = r[k].of->rung;
        d.desc.rungs[k].scale = (float)r[k].scale;
    }
    masu_cli_progress("building pipelines");
    if (!masu_session_open(&d, &s, b->error, sizeof b->error)) return false;
    bool good = true;
    for (uint32_t k = 0; k < count && good; k++) good = compare(b, &s, k, &b->rows[first + k]);
    good = good && measure(b, &s, first, count);
    close_session(b, &s);
    return good;
}

/* ---- Out ------------------------------------------------------------------------------------- */

static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"scale", "%g", "scale", "%.2f"},
    {"chain", NULL, "chain", NULL},
    {NULL, NULL, "render", NULL},
    {"render_width", "%.0f", NULL, NULL},
    {"render_height", "%.0f", NULL, NULL},
    {"flip", "%.6f", "flip", "%.4f"},
    {"flip_p99", "%.6f", "flip p99", "%.4f"},
    {"flip_max", "%.6f", NULL, NULL},
    {"rmse", "%.6f", NULL, NULL},
    {NULL, NULL, "rmse/255", "%.2f"},
    {"psnr_db", "%.4f", "psnr", "%.2f"},
    {"ssim", "%.6f", "ssim", "%.4f"},
    {"chain_gpu_ms", "%.4f", "chain ms", "%.2f"},
    {"gpu_ms", "%.4f", NULL, NULL},
    {"wall_ms", "%.4f", "frame ms", "%.2f"},
    {"positions", "%.0f", NULL, NULL},
    {"rays", "%.0f", NULL, NULL},
    {"frames", "%.0f", NULL, NULL},
    {"runs", "%.0f", NULL, NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {"time", "%g", NULL, NULL},
    {"ppd", "%.2f", NULL, NULL},
    {"driver", "\"", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, const bench *b, const row *r) {
    char size[32];
    snprintf(size, sizeof size, "%ux%u", r->render.width, r->render.height);
    const double numbers[] = {
        r->render.width,    r->render.height, r->flip.mean,   r->flip.p99,  r->flip.max, r->rmse,
        255.0 * r->rmse,    masu_metric_psnr(r->rmse),        r->ssim,      r->chain_ms, r->gpu_ms,
        r->wall_ms,         o->truth.positions, o->truth.rays, o->frames,   o->runs,
        o->size.width,      o->size.height,   o->time,        given.ppd};
    masu_table_text(t, b->scene);
    masu_table_number(t, r->scale);
    masu_table_text(t, r->of->name);
    masu_table_text(t, size);
    masu_table_numbers(t, numbers, COUNT(numbers));
    masu_table_text(t, b->driver);
}

static int print(const bench *b) {
    masu_table t;
    masu_table_open(&t, columns, "n/a");
    for (uint32_t i = 0; i < b->row_count; i++) add_row(&t, b, &b->rows[i]);
    fprintf(
        o->text, "%s at %ux%u, %.3g s, ground truth of %u positions, %.1f pixels per degree; %s\n",
        b->scene, o->size.width, o->size.height, o->time, o->truth.positions, given.ppd, b->driver);
    masu_table_print(&t, o->text);
    return masu_table_close(&t, o->csv);
}

static int run(void) {
    static bench b;
    given.host = o->host;
    masu_use_rays(given.rays, &given.ray_query, &given.host);
    b.pixels = o->size.width * o->size.height;
    masu_study_scene_name(o->scene, b.scene, sizeof b.scene);
    plan_rows(&b);
    if (!b.row_count) return masu_cli_usage_error("no chain's name contains '%s'", o->only);
    b.truth = malloc(4 * (size_t)b.pixels);
    b.map = malloc(sizeof *b.map * b.pixels);
    bool good = (b.truth && b.map) || failed(&b, "out of memory");
    good = good && find_truth(&b);
    for (uint32_t i = 0; i < b.row_count && good; i += batch_of(&b, i))
        good = run_batch(&b, i, batch_of(&b, i));
    masu_cli_progress_clear();
    int code = good ? print(&b) : masu_cli_error("%s", b.error);
    free(b.truth);
    free(b.map);
    if (!code && b.messages)
        code = masu_cli_error("the validation layer has reported %u messages", b.messages);
    return code;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static bool read_scales(masu_cli *cli, void *options_) {
    options *to = options_;
    return masu_study_read_scales(cli, SCALES_MOST, to->scales, &to->scale_count);
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_TIME,
    MASU_STUDY_TRUTH,
    MASU_STUDY_FRAMES(10000, "with a still camera, before an image with reflections is measured"),
    MASU_REAL(options, ppd, "ppd", "N", 1.0, 1000.0,
              "pixels per degree of sight, for FLIP: 67 at 0.7 m before 3840 on 0.7 m"),
    MASU_STUDY_RUNS(0, 999),
    MASU_OWN("scales", "S,...", read_scales, "of the render size (default 1,0.8,0.5,0.4)"),
    MASU_TEXT(options, study.only, "only", "TEXT", "chains whose names contain this"),
    MASU_REAL(options, anisotropy, "anisotropy", "N", 1.0, 64.0,
              "samples of the chains' textures along the longer axis (default 1)"),
    MASU_STUDY_IMAGES("the images, and the maps of FLIP, as PNG"),
    MASU_STUDY_CSV,
    MASU_RAYS_ROW(options, rays),
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_image = {
    .name = "image",
    .purpose = "anti-aliasing, upscaling and sharpening, compared with the ground truth",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details =
        "The ground truth is drawn as by masu render --truth. RMSE, PSNR and SSIM are of the "
        "shown\n"
        "8 bits. Chain ms: GPU time of the passes after the tone curve; frame ms: wall time from\n"
        "masu_frame to the fence, with a full barrier around each pass; both the least of "
        "the runs, in\n"
        "which the chains of a renderer alternate.\n"};
