/* image_error.c: `masu image-error`: how far each chain of the finished picture
 * (anti-aliasing, upscaling, sharpening, at some render sizes) is from the picture without
 * shortcuts, and what it costs.
 *
 * The truth is that of `masu render --truth`. A chain is a row of the table below, and a rung of
 * a renderer; as many as a renderer takes are drawn in turns. The picture is that of a scene at
 * rest, after as many frames as the filters of reflections need; times are the least of frames in
 * turns. Nothing is judged. */
#include "masu/cmd.h"

#include "bench/measure/picture.h"
#include "clock.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_FRAMES = 1,
    OPTION_RUNS,
    OPTION_SCALES,
    OPTION_ONLY,
    OPTION_IMAGES,
    OPTION_CSV,
    OPTION_PPD,
    OPTION_ANISOTROPY,
    OPTION_RAYS
};

/* coarse: mips of the render size instead of the output's, as an upscaler would have them that
 * nobody told. */
typedef struct chain {
    const char *name;
    masu_rung rung; /* but for its scale */
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

/* Below it. */
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
    const char *path, *csv, *truth, *images, *only;
    VkExtent2D size;
    uint32_t positions, rays, frames, runs;
    double time, ppd, anisotropy, scales[SCALES_MOST];
    uint32_t scale_count;
    masu_headless_desc host;
    masu_switch ray_query;
} options;

typedef struct row {
    const chain *of;
    double scale;
    VkExtent2D render;
    masu_flip flip;
    double rmse, ssim;
    double chain_ms, gpu_ms, wall_ms; /* 0: not timed */
} row;

typedef struct bench {
    const options *o;
    uint8_t *truth;
    float *map;
    uint32_t pixels, row_count;
    row rows[ROWS_MOST];
    char scene[128], driver[1024], error[1024];
    uint32_t messages; /* of the validation layer */
} bench;

static bool failed(bench *b, const char *text) {
    snprintf(b->error, sizeof b->error, "%s: %s", b->o->path, text);
    return false;
}

/* ---- The truth ------------------------------------------------------------------------------- */

static masu_session_desc session_of(const options *o) {
    masu_session_desc d = masu_picture_session(o->path, o->size, &o->host);
    d.desc.ray_query = o->ray_query;
    d.desc.vulkan.max_anisotropy = (float)o->anisotropy; /* of the chains: the truth takes none */
    return d;
}

static void close_session(bench *b, masu_session *s) {
    b->messages += s->host.messages;
    snprintf(b->driver, sizeof b->driver, "%s", s->host.driver);
    masu_session_close(s);
}

static bool find_truth(bench *b) {
    const options *o = b->o;
    masu_session_desc d = session_of(o);
    masu_picture_want truth = {.path = o->truth,
                               .time = o->time,
                               .positions = o->positions,
                               .rays = o->rays,
                               .progress = masu_cli_progress_text};
    bool good = masu_picture_find(&d, &truth, b->truth, b->error, sizeof b->error);
    b->messages += truth.messages;
    return good;
}

/* ---- Chains ---------------------------------------------------------------------------------- */

static void plan_rows(bench *b) {
    const options *o = b->o;
    for (uint32_t i = 0; i < o->scale_count; i++) {
        bool whole = o->scales[i] >= 1.0;
        const chain *chains = whole ? native : upscaled;
        size_t count = whole ? COUNT(native) : COUNT(upscaled);
        for (size_t k = 0; k < count; k++) {
            if (o->only && !strstr(chains[k].name, o->only)) continue;
            b->rows[b->row_count++] = (row){.of = &chains[k], .scale = o->scales[i]};
        }
    }
}

/* How many rows from `first` on a renderer can have: debug.mip_bias is one for all of its rungs. */
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
    if (masu_camera_at(s->m, b->o->time, &camera)) return failed(b, "the scene has no camera");
    masu_frame_desc frame = {
        .camera = &camera, .time = b->o->time, .time_step = 1.0f / 60.0f, .rung = rung, .cut = cut};
    return masu_session_frame(s, &frame, true, commands, b->error, sizeof b->error);
}

static bool save(bench *b, const row *r, const uint8_t *rgba) {
    char path[4096], name[64];
    snprintf(name, sizeof name, "%s", r->of->name);
    for (char *c = name; *c; c++) *c = *c == ' ' ? '-' : *c;
    snprintf(path, sizeof path, "%s/%s.%.2f.%s.png", b->o->images, b->scene, r->scale, name);
    if (!masu_image_save_png(path, rgba, b->o->size.width, b->o->size.height, 0, b->error,
                             sizeof b->error)) {
        return false;
    }
    uint8_t *grey = malloc(4 * (size_t)b->pixels);
    if (!grey) return failed(b, "out of memory");
    for (uint32_t i = 0; i < b->pixels; i++) {
        memset(grey + 4 * (size_t)i, (int)(255.0f * fminf(b->map[i], 1.0f) + 0.5f), 3);
        grey[4 * (size_t)i + 3] = 255;
    }
    snprintf(path, sizeof path, "%s/%s.%.2f.%s.flip.png", b->o->images, b->scene, r->scale, name);
    bool good = masu_image_save_png(path, grey, b->o->size.width, b->o->size.height, 0, b->error,
                                    sizeof b->error);
    free(grey);
    return good;
}

/* A scene that traces no reflections looks the same in every frame. */
static bool compare(bench *b, masu_session *s, uint32_t rung, row *r) {
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    r->render = (VkExtent2D){plan.rungs[rung].render_width, plan.rungs[rung].render_height};
    uint32_t frames = s->scene.reflections ? b->o->frames : 1;
    masu_commands commands;
    masu_cli_progress("%s at %.2f", r->of->name, r->scale);
    for (uint32_t k = 0; k < frames; k++) {
        if (!frame_of(b, s, rung, k == 0, &commands)) return false;
    }
    if (!masu_headless_target_read(&s->host, &s->targets[0], b->error, sizeof b->error))
        return false;
    const uint8_t *shown = s->targets[0].mapped;
    VkExtent2D size = b->o->size;
    if (!masu_metric_flip(b->truth, shown, size.width, size.height, b->o->ppd, b->map, &r->flip))
        return failed(b, "out of memory");
    r->rmse = masu_metric_rmse(b->truth, shown, size.width, size.height);
    r->ssim = masu_metric_ssim(b->truth, shown, size.width, size.height);
    return !b->o->images || save(b, r, shown);
}

/* The passes behind the tone curve. */
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

/* One more run than asked for: the first after another rung's is dropped with the warm-up. */
static bool measure(bench *b, masu_session *s, uint32_t first, uint32_t count) {
    for (uint32_t run = 0; run <= b->o->runs && b->o->runs; run++) {
        masu_cli_progress("timing, run %u of %u", run, b->o->runs);
        for (uint32_t k = 0; k < count; k++) {
            masu_commands commands;
            masu_stats_info stats;
            uint64_t start = masu_clock_ns(NULL);
            if (!frame_of(b, s, k, true, &commands)) return false;
            double wall = (double)(masu_clock_ns(NULL) - start) / 1e6;
            if (!run || masu_stats(s->m, commands.slot, &stats)) continue;
            least(&b->rows[first + k].wall_ms, wall);
            least(&b->rows[first + k].gpu_ms, (double)stats.gpu_ns / 1e6);
            least(&b->rows[first + k].chain_ms, chain_ns(&stats) / 1e6);
        }
    }
    return true;
}

static bool run_batch(bench *b, uint32_t first, uint32_t count) {
    static masu_session s;
    masu_session_desc d = session_of(b->o);
    const row *r = &b->rows[first];
    d.desc.debug.timestamps = b->o->runs != 0;
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

static void print_table(const bench *b) {
    printf("%s at %ux%u, %.3g s, truth of %u positions, %.1f pixels per degree; %s\n", b->scene,
           b->o->size.width, b->o->size.height, b->o->time, b->o->positions, b->o->ppd, b->driver);
    printf("%-6s %-24s %9s %8s %8s %8s %7s %7s %9s %9s\n", "scale", "chain", "render", "flip",
           "flip p99", "rmse/255", "psnr", "ssim", "chain ms", "frame ms");
    for (uint32_t i = 0; i < b->row_count; i++) {
        const row *r = &b->rows[i];
        char size[32];
        snprintf(size, sizeof size, "%ux%u", r->render.width, r->render.height);
        printf("%-6.2f %-24s %9s %8.4f %8.4f %8.2f %7.2f %7.4f %9.2f %9.2f\n", r->scale,
               r->of->name, size, r->flip.mean, r->flip.p99, 255.0 * r->rmse,
               masu_metric_psnr(r->rmse), r->ssim, r->chain_ms, r->wall_ms);
    }
}

static bool write_csv(bench *b) {
    FILE *f = fopen(b->o->csv, "w");
    if (!f) return failed(b, "the CSV file cannot be written");
    fprintf(
        f, "scene,scale,chain,render_width,render_height,flip,flip_p99,flip_max,rmse,psnr_db,ssim,"
           "chain_gpu_ms,gpu_ms,wall_ms,positions,rays,frames,runs,width,height,time,ppd,driver\n");
    for (uint32_t i = 0; i < b->row_count; i++) {
        const row *r = &b->rows[i];
        fprintf(f,
                "%s,%g,%s,%u,%u,%.6f,%.6f,%.6f,%.6f,%.4f,%.6f,%.4f,%.4f,%.4f,%u,%u,%u,%u,%u,%u,%g,%"
                ".2f,\"%s\"\n",
                b->scene, r->scale, r->of->name, r->render.width, r->render.height, r->flip.mean,
                r->flip.p99, r->flip.max, r->rmse, masu_metric_psnr(r->rmse), r->ssim, r->chain_ms,
                r->gpu_ms, r->wall_ms, b->o->positions, b->o->rays, b->o->frames, b->o->runs,
                b->o->size.width, b->o->size.height, b->o->time, b->o->ppd, b->driver);
    }
    return !fclose(f) || failed(b, "the CSV file cannot be written");
}

static int image_error(const options *o) {
    static bench b;
    memset(&b, 0, sizeof b);
    b.o = o;
    b.pixels = o->size.width * o->size.height;
    const char *last = strrchr(o->path, '/');
    const char *name = last ? last + 1 : o->path;
    snprintf(b.scene, sizeof b.scene, "%.*s", (int)strcspn(name, "."), name);
    plan_rows(&b);
    if (!b.row_count) return masu_cli_usage_error("no chain's name contains '%s'", o->only);
    b.truth = malloc(4 * (size_t)b.pixels);
    b.map = malloc(sizeof *b.map * b.pixels);
    bool good = (b.truth && b.map) || failed(&b, "out of memory");
    good = good && find_truth(&b);
    for (uint32_t i = 0; i < b.row_count && good; i += batch_of(&b, i))
        good = run_batch(&b, i, batch_of(&b, i));
    masu_cli_progress_clear();
    if (good) print_table(&b);
    good = good && (!o->csv || write_csv(&b));
    free(b.truth);
    free(b.map);
    if (!good) return masu_cli_error("%s", b.error);
    return b.messages ? masu_cli_error("the validation layer has reported %u messages", b.messages)
                      : MASU_CLI_OK;
}

/* ---- Command line ---------------------------------------------------------------------------- */

/* "1,0.8,0.4" */
static bool read_scales(const masu_cli *cli, options *o) {
    const char *at = cli->value;
    for (o->scale_count = 0; o->scale_count < SCALES_MOST; at++) {
        char *end;
        double scale = strtod(at, &end);
        if (end == at || !(scale > 0.0 && scale <= 1.0)) break;
        o->scales[o->scale_count++] = scale;
        if (!*end) return true;
        if (*end != ',') break;
        at = end;
    }
    masu_cli_usage_error("%s %s: needed are 1 to %u numbers above 0 and at most 1, as in 1,0.8,0.4",
                         cli->option, cli->value, SCALES_MOST);
    return false;
}

static int run(masu_cli *cli) {
    static masu_session_desc rays;
    options o = {.size = {640, 360},
                 .positions = MASU_PICTURE_POSITIONS,
                 .rays = MASU_PICTURE_RAYS,
                 .frames = 32,
                 .ppd = MASU_FLIP_PPD,
                 .runs = 9,
                 .scales = {1.0, 0.8, 0.5, 0.4},
                 .scale_count = 4,
                 .host = {.message = masu_print_message, .ray_query = true}};
    const masu_truth_places truth = {&o.size, &o.time, &o.truth, &o.positions, &o.rays};
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &o.host)) continue;
        int read = masu_truth_option(cli, id, &truth);
        if (read < 0) return MASU_CLI_USAGE;
        if (read) continue;
        switch (id) {
        case OPTION_FRAMES:
            if (!masu_cli_uint(cli, 1, 10000, &o.frames)) return MASU_CLI_USAGE;
            continue;
        case OPTION_ANISOTROPY:
            if (!masu_cli_double(cli, 1.0, 64.0, &o.anisotropy)) return MASU_CLI_USAGE;
            continue;
        case OPTION_PPD:
            if (!masu_cli_double(cli, 1.0, 1000.0, &o.ppd)) return MASU_CLI_USAGE;
            continue;
        case OPTION_RUNS:
            if (!masu_cli_uint(cli, 0, 999, &o.runs)) return MASU_CLI_USAGE;
            continue;
        case OPTION_SCALES:
            if (!read_scales(cli, &o)) return MASU_CLI_USAGE;
            continue;
        case OPTION_ONLY: o.only = cli->value; continue;
        case OPTION_IMAGES: o.images = cli->value; continue;
        case OPTION_CSV:
            if (!masu_output_file(cli, &o.csv)) return cli->exit_code;
            continue;
        case OPTION_RAYS:
            if (!masu_rays_option(cli, &rays)) return MASU_CLI_USAGE;
            o.ray_query = rays.desc.ray_query;
            o.host.ray_query = rays.host.ray_query;
            continue;
        case MASU_CLI_ARGUMENT:
            if (o.path) return masu_cli_usage_error("one scene at a time: '%s'", cli->value);
            o.path = cli->value;
            continue;
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (!o.path) return masu_cli_usage_error("no scene is given");
    return image_error(&o);
}

static const masu_cli_option list[] = {
    MASU_TRUTH_OPTIONS("0"),
    {"frames", "N", "at rest, before a picture with reflections is taken (default 32)",
     OPTION_FRAMES, 0},
    {"ppd", "N",
     "pixels per degree of sight, for FLIP: 67 at 0.7 m before 3840 on 0.7 m (default 67)",
     OPTION_PPD, 0},
    {"runs", "N", "timed frames of each chain; 0: none (default 9)", OPTION_RUNS, 0},
    {"scales", "S,...", "of the render size (default 1,0.8,0.5,0.4)", OPTION_SCALES, 0},
    {"only", "TEXT", "chains with that in their name", OPTION_ONLY, 0},
    {"anisotropy", "N", "samples of the chains' textures along the longer axis (default 1)",
     OPTION_ANISOTROPY, 0},
    {"images", "DIR", "the pictures, and the maps of FLIP, as PNG", OPTION_IMAGES, 0},
    {"csv", "FILE", "the rows as CSV", OPTION_CSV, 0},
    MASU_RAYS_OPTION(OPTION_RAYS),
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_image_error = {
    .name = "image-error",
    .arguments = "SCENE.masu [options]",
    .summary =
        "measure anti-aliasing, upscaling and sharpening against the picture without shortcuts",
    .options = list,
    .details = "The truth is that of masu render --truth. RMSE, PSNR and SSIM are of the shown\n"
               "8 bits. Chain ms: GPU time of all behind the tone curve; frame ms: wall time from\n"
               "masu_frame to the fence, with a full barrier around each pass; both the least of "
               "the runs, in\n"
               "which all chains of a renderer take turns.\n",
    .run = run};
