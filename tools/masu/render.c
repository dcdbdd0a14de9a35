/* render.c: `masu render`: frames of a baked scene to PNG, headless, with measured times,
 * counts and memory. */
#include "masu/cmd.h"

#include "alloc_count.h"
#include "bench/measure/picture.h"
#include "bench/sweep/knobs.h"
#include "bench/sweep/settings.h"
#include "clock.h"
#include "image.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_OUTPUT = 1,
    OPTION_SIZE,
    OPTION_FRAMES,
    OPTION_RUNG,
    OPTION_TIME,
    OPTION_TIME_STEP,
    OPTION_STATS,
    OPTION_POISON,
    OPTION_SUN,
    OPTION_TURBIDITY,
    OPTION_EXPOSURE,
    OPTION_TONE,
    OPTION_DITHER,
    OPTION_SPLIT,
    OPTION_FLIGHT,
    OPTION_MARCH,
    OPTION_CULL,
    OPTION_CASTERS,
    OPTION_ANISOTROPY,
    OPTION_LOD_ERROR,
    OPTION_REFERENCE,
    OPTION_TRUTH,
    OPTION_RAYS,
    OPTION_AA,
    OPTION_SETTING,
    OPTION_TARGET,
    OPTION_LADDER,
    OPTION_TIMES
};

#define PI 3.14159265358979323846
#define FRAMES_MAX 100000u
#define REFERENCE_RAYS 1024u /* per pixel: below it the truth's own noise is seen */

typedef struct render_options {
    const char *output, *stats, *times;
    double target_ms; /* of the governor; 0: there is none */
    uint32_t frames, rung;
    uint32_t rays; /* per pixel of the reference, a frame each; 0: no reference */
    uint32_t positions; /* of each pixel in the truth; 0: no truth */
    double time, time_step;
    double sun[2], turbidity; /* azimuth and elevation, degrees */
    double exposure;          /* 0: the scene's */
    bool own_sun;
} render_options;

/* One measured frame. */
typedef struct sample {
    double wall_ms, gpu_ms;
    uint32_t rung;
    const char *reason; /* of the governor */
    double pass_ms[MASU_MAX_PASSES];
    uint64_t library_allocs, driver_allocs, driver_callbacks;
} sample;

/* ---- Numbers --------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Nearest-rank percentile of one field over the samples. */
static double percentile(const sample *samples, uint32_t n, size_t field, double p,
                         double *scratch) {
    for (uint32_t i = 0; i < n; i++)
        memcpy(&scratch[i], (const char *)&samples[i] + field, sizeof(double));
    qsort(scratch, n, sizeof *scratch, compare);
    uint32_t rank = (uint32_t)(p * (double)(n - 1) + 0.5);
    return scratch[rank];
}

static json_t *times_json(const sample *samples, uint32_t n, size_t field, double *scratch) {
    return json_pack("{s:f, s:f, s:f}", "min", percentile(samples, n, field, 0.0, scratch),
                     "median", percentile(samples, n, field, 0.5, scratch), "p95",
                     percentile(samples, n, field, 0.95, scratch));
}

/* Mesa 22.3's lavapipe reports 0.1 ms for what takes 100 ms once graphics work has run in the
 * process. Times are quoted only where they fit the wall clock. */
static bool plausible(const sample *samples, uint32_t n) {
    uint32_t good = 0;
    for (uint32_t i = 0; i < n; i++) {
        good += samples[i].gpu_ms >= 0.5 * samples[i].wall_ms &&
                samples[i].gpu_ms <= 1.05 * samples[i].wall_ms;
    }
    return 2 * good > n;
}

static json_t *governor_json(const masu_governor_info *g) {
    static const char *const sources[] = {"none", "timestamps", "wall"};
    json_t *predicted = json_array();
    for (uint32_t r = 0; r < g->rung_count; r++)
        json_array_append_new(predicted, json_real((double)g->predicted_ms[r]));
    return json_pack("{s:f, s:I, s:I, s:I, s:I, s:i, s:s, s:i, s:s, s:f, s:f, s:f, s:f, s:o}",
                     "target_ms", (double)g->target_ms, "samples", (json_int_t)g->samples, "rejected",
                     (json_int_t)g->rejected, "missed", (json_int_t)g->missed, "changes",
                     (json_int_t)g->changes, "rung", (int)g->rung, "reason", g->reason_text, "locked",
                     (int)g->locked, "source", sources[g->source], "fixed_ms", (double)g->fixed_ms,
                     "load_ms", (double)g->load_ms, "noise", (double)g->noise, "start_delay_ms",
                     (double)g->start_delay_ms, "predicted_ms", predicted);
}

static int write_stats(const masu_session *s, const render_options *o, const char *scene,
                       const sample *samples, uint32_t n, const masu_stats_info *last, bool timed) {
    double *scratch = malloc(n * sizeof *scratch);
    if (!scratch) return masu_cli_error("no memory for %u samples", n);
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    uint32_t rung = last->rung;
    json_t *passes = json_array();
    for (uint32_t p = 0; p < last->pass_count; p++) {
        if (!(plan.passes[p].active & 1u << rung)) continue;
        json_t *row = json_pack("{s:s, s:f}", "name", last->pass_names[p], "pipeline_ms",
                                (double)plan.passes[p].pipeline_ns / 1e6);
        if (timed) {
            size_t field = offsetof(sample, pass_ms) + p * sizeof(double);
            json_object_set_new(row, "gpu_ms", times_json(samples, n, field, scratch));
        }
        json_array_append_new(passes, row);
    }
    uint64_t library = 0, driver = 0, callbacks = 0;
    for (uint32_t i = 0; i < n; i++) {
        library += samples[i].library_allocs;
        driver += samples[i].driver_allocs;
        callbacks += samples[i].driver_callbacks;
    }
    json_t *root = json_pack("{s:s, s:o, s:{s:i, s:i}, s:{s:i, s:i}, s:i, s:i, s:o}", "scene",
                             scene, "device", masu_json_device(&s->host), "output", "width",
                             (int)s->desc.output.width, "height", (int)s->desc.output.height,
                             "render", "width", (int)plan.rungs[rung].render_width, "height",
                             (int)plan.rungs[rung].render_height, "rung", (int)rung,
                             "frames_measured", (int)n, "memory", masu_json_memory(&plan.memory));
    json_object_set_new(root, "wall_ms",
                        times_json(samples, n, offsetof(sample, wall_ms), scratch));
    if (timed) {
        json_object_set_new(root, "gpu_ms",
                            times_json(samples, n, offsetof(sample, gpu_ms), scratch));
        json_object_set_new(root, "timestamps_plausible", json_boolean(plausible(samples, n)));
    }
    json_object_set_new(root, "passes", passes);
    if (last->exposure > 0.0f) json_object_set_new(root, "exposure", json_real((double)last->exposure));
    double pixels =
        (double)plan.rungs[rung].render_width * (double)plan.rungs[rung].render_height;
    if (o->target_ms > 0.0) json_object_set_new(root, "governor", governor_json(&last->governor));
    json_object_set_new(
        root, "counts",
        json_pack("{s:I, s:I, s:I, s:I, s:I, s:f, s:I, s:I, s:I, s:f, s:f, s:I, s:I, s:I, s:I, s:I, s:I, s:I}",
                  "smaa_tiles", (json_int_t)last->smaa_tiles, "draws", (json_int_t)last->draws,
                  "triangles", (json_int_t)last->triangles, "sdf_evals",
                  (json_int_t)last->sdf_evals, "sdf_hits", (json_int_t)last->sdf_hits,
                  "sdf_evals_per_pixel", (double)last->sdf_evals / pixels, "sdf_unconverged",
                  (json_int_t)last->sdf_unconverged, "replaced", (json_int_t)last->replaced,
                  "easu_tiles_early", (json_int_t)last->easu_tiles_early,
                  "shadow_evals_per_pixel", (double)last->shadow_evals / pixels,
                  "occlusion_evals_per_pixel", (double)last->occlusion_evals / pixels,
                  "shadow_unconverged", (json_int_t)last->shadow_unconverged, "specular_tiles",
                  (json_int_t)last->specular_tiles, "specular_rays", (json_int_t)last->specular_rays,
                  "specular_hits", (json_int_t)last->specular_hits, "specular_sdf_hits",
                  (json_int_t)last->specular_sdf_hits, "specular_nodes",
                  (json_int_t)last->specular_nodes, "specular_evals",
                  (json_int_t)last->specular_evals));
    json_t *views = json_array();
    for (uint32_t v = 0; v < last->view_count; v++) {
        const masu_view_stats *view = &last->views[v];
        char name[16] = "camera";
        if (v) snprintf(name, sizeof name, "sun %u", v - 1);
        json_array_append_new(
            views, json_pack("{s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "view",
                             name, "groups", (json_int_t)view->groups,
                             "plane_tests", (json_int_t)view->plane_tests, "instances_in_view",
                             (json_int_t)view->instances, "triangles_in_view",
                             (json_int_t)view->triangles, "occluders",
                             (json_int_t)view->occluders, "visible_instances",
                             (json_int_t)view->visible_instances, "visible_triangles",
                             (json_int_t)view->visible_triangles));
    }
    json_object_set_new(root, "views", views);
    if (masu_alloc_counting()) {
        json_object_set_new(root, "allocations_per_frame",
                            json_pack("{s:f, s:f, s:f}", "library", (double)library / (double)n,
                                      "driver_heap", (double)driver / (double)n,
                                      "driver_vulkan_callbacks", (double)callbacks / (double)n));
    }
    free(scratch);
    return masu_json_write(root, o->stats);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* "frame_####.png" names one file per frame; a name without '#' gets the last frame. Returns false
 * if it is too long. */
static bool output_name(const char *pattern, uint32_t frame, char *out, size_t size) {
    const char *first = strchr(pattern, '#');
    if (!first) return (size_t)snprintf(out, size, "%s", pattern) < size;
    size_t digits = strspn(first, "#");
    int n = snprintf(out, size, "%.*s%0*u%s", (int)(first - pattern), pattern, (int)digits, frame,
                     first + digits);
    return n > 0 && (size_t)n < size;
}

static int save(masu_session *s, const render_options *o, uint32_t frame) {
    char error[1024], name[4096];
    bool each = strchr(o->output, '#') != NULL;
    if (!each && frame + 1 < o->frames) return MASU_CLI_OK;
    if (!output_name(o->output, frame, name, sizeof name))
        return masu_cli_error("output name is too long");
    if (!masu_headless_target_read(&s->host, &s->targets[0], error, sizeof error))
        return masu_cli_error("%s", error);
    if (!masu_image_save_png(name, s->targets[0].mapped, s->targets[0].width, s->targets[0].height,
                             0, error, sizeof error)) {
        return masu_cli_error("%s", error);
    }
    return MASU_CLI_OK;
}

/* The sun's place by angles as in scenes; a sky that follows from it. */
static void set_light(const render_options *o, masu_light *light) {
    double azimuth = o->sun[0] * (PI / 180.0), elevation = o->sun[1] * (PI / 180.0);
    if (o->own_sun) {
        light->sun_direction[0] = (float)(cos(elevation) * sin(azimuth));
        light->sun_direction[1] = (float)sin(elevation);
        light->sun_direction[2] = (float)(cos(elevation) * cos(azimuth));
    }
    if (o->exposure > 0.0) light->exposure = (float)o->exposure;
    if (!(o->turbidity > 0.0)) return;
    if (light->turbidity == 0.0f)
        for (int c = 0; c < 3; c++) light->ground[c] = 0.2f, light->sun_color[c] = 0.0f;
    light->turbidity = (float)o->turbidity;
}

static bool measure(masu_session *s, const render_options *o, uint32_t frame,
                    masu_vk_alloc_counts *counts, sample *out, masu_stats_info *stats, char *error,
                    size_t size) {
    masu_light light;
    bool own_light = o->own_sun || o->turbidity > 0.0 || o->exposure > 0.0;
    if (own_light && masu_light_of(s->m, &light)) {
        snprintf(error, size, "the scene has no light");
        return false;
    }
    if (own_light) set_light(o, &light);
    masu_frame_desc f = {.light = own_light ? &light : NULL,
                         .time = o->time + (double)frame * o->time_step,
                         .time_step = o->rays ? MASU_PICTURE_STEP : (float)o->time_step,
                         .rung = o->target_ms > 0.0 ? MASU_RUNG_AUTO : o->rung,
                         .cut = o->rays && !frame}; /* the sum begins with the first one that counts */
    masu_commands commands;
    uint64_t callbacks = counts->allocations + counts->reallocations;
    uint64_t thread = masu_allocs_of_thread();
    uint64_t start = masu_clock_ns(NULL);
    if (masu_frame(s->m, &f, &commands)) {
        snprintf(error, size, "%s", masu_last_error(s->m)->text);
        return false;
    }
    out->library_allocs = masu_allocs_of_thread() - thread;
    uint64_t process = masu_allocs_of_process(), submitted = masu_clock_ns(NULL);
    if (!masu_headless_submit(&s->host, commands.buffer, commands.slot, error, size) ||
        !masu_headless_wait(&s->host, commands.slot, error, size)) {
        return false;
    }
    uint64_t end = masu_clock_ns(NULL);
    out->wall_ms = (double)(end - start) / 1e6;
    masu_frame_wall(s->m, commands.slot, (double)(end - submitted) / 1e6);
    out->driver_allocs = masu_allocs_of_process() - process;
    out->driver_callbacks = counts->allocations + counts->reallocations - callbacks;
    (void)masu_stats(s->m, commands.slot, stats);
    out->gpu_ms = (double)stats->gpu_ns / 1e6;
    out->rung = commands.rung;
    out->reason = stats->governor.reason_text;
    for (uint32_t p = 0; p < stats->pass_count; p++)
        out->pass_ms[p] = (double)stats->pass_ns[p] / 1e6;
    return true;
}

/* What the reference is made of; a scene that traces nothing has none, and its picture is the truth. */
static void report_rays(const masu_session *s, const render_options *o, const masu_stats_info *stats) {
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    const masu_plan_rung *r = &plan.rungs[o->rung];
    double pixels = (double)r->render_width * (double)r->render_height;
    if (!stats->specular_rays) masu_cli_warn("nothing in the picture traces reflections");
    if (masu_cli_quiet()) return;
    masu_cli_progress_clear();
    fprintf(stderr, "masu: reference: %u rays per pixel that mirrors, %.1f %% of the picture\n", o->rays,
            100.0 * (double)stats->specular_rays / pixels);
}

/* The picture without shortcuts. */
static int render_truth(masu_session *s, const render_options *o) {
    masu_light light;
    char error[1024];
    bool own_light = o->own_sun || o->turbidity > 0.0 || o->exposure > 0.0;
    if (own_light && masu_light_of(s->m, &light)) return masu_cli_error("the scene has no light");
    if (own_light) set_light(o, &light);
    VkExtent2D size = s->desc.output;
    uint8_t *rgba = malloc(4 * (size_t)size.width * size.height);
    if (!rgba) return masu_cli_error("no memory for a picture of %ux%u", size.width, size.height);
    masu_frame_desc frame = {.light = own_light ? &light : NULL, .time = o->time};
    uint32_t rays = o->rays ? o->rays : MASU_PICTURE_RAYS;
    bool good = masu_picture_truth(s, &frame, o->positions, rays, rgba, masu_cli_progress_text, error,
                                   sizeof error) &&
                masu_image_save_png(o->output, rgba, size.width, size.height, 0, error, sizeof error);
    free(rgba);
    if (!good) return masu_cli_error("%s", error);
    if (masu_cli_quiet()) return MASU_CLI_OK;
    masu_cli_progress_clear();
    fprintf(stderr, "masu: truth: %u positions of each pixel, %u frame%s each\n", o->positions,
            masu_picture_frames(s, o->positions, rays),
            masu_picture_frames(s, o->positions, rays) == 1 ? "" : "s");
    return MASU_CLI_OK;
}

static int write_times(const masu_session *s, const render_options *o, const sample *samples) {
    FILE *f = fopen(o->times, "w");
    if (!f) return masu_cli_error("%s: cannot be written", o->times);
    fprintf(f, "frame,time,rung,scale,gpu_ms,wall_ms,reason\n");
    for (uint32_t i = 0; i < o->frames; i++) {
        fprintf(f, "%" PRIu32 ",%.4f,%" PRIu32 ",%.4f,%.4f,%.4f,\"%s\"\n", i,
                o->time + i * o->time_step, samples[i].rung,
                (double)s->desc.rungs[samples[i].rung].scale, samples[i].gpu_ms, samples[i].wall_ms,
                samples[i].reason);
    }
    return fclose(f) ? masu_cli_error("%s: cannot be written", o->times) : MASU_CLI_OK;
}

static void report_governor(const masu_session *s, const render_options *o, const sample *samples,
                            const masu_governor_info *g) {
    static const char *const sources[] = {"nothing", "timestamps", "the wall clock"};
    double scale = 0.0;
    uint32_t over = 0;
    for (uint32_t i = 0; i < o->frames; i++) {
        scale += (double)s->desc.rungs[samples[i].rung].scale / o->frames;
        over += samples[i].wall_ms > o->target_ms;
    }
    if (masu_cli_quiet()) return;
    masu_cli_progress_clear();
    printf("governor: target %.2f ms, %" PRIu32 " of %" PRIu32 " frames over it by the wall, %" PRIu64
           " changes, mean scale %.3f\n",
           o->target_ms, over, o->frames, g->changes, scale);
    printf("  times from %s; model: %.2f ms fixed, %.2f ms that follow the rung, noise %.1f %%\n",
           sources[g->source], (double)g->fixed_ms, (double)g->load_ms, 100.0 * (double)g->noise);
    for (uint32_t r = 0; r < g->rung_count; r++) {
        uint32_t frames = 0;
        for (uint32_t i = 0; i < o->frames; i++) frames += samples[i].rung == r;
        printf("  rung %" PRIu32 ", scale %.3f: %5" PRIu32 " frames, now predicted %.2f ms%s\n", r,
               (double)s->desc.rungs[r].scale, frames, (double)g->predicted_ms[r],
               r == g->rung ? " <" : "");
    }
    printf("  last: rung %" PRIu32 ": %s%s\n", g->rung, g->reason_text,
           g->locked ? " (it cannot move to where it should be)" : "");
}

/* With statistics a first frame is drawn and not counted: drivers compile at the first use of a
 * pipeline. */
static int render_frames(masu_session *s, const render_options *o, const char *scene,
                         masu_vk_alloc_counts *counts) {
    sample *samples = calloc(o->frames, sizeof *samples);
    masu_stats_info stats;
    char error[1024];
    int code = samples ? MASU_CLI_OK : masu_cli_error("no memory for %u frames", o->frames);
    memset(&stats, 0, sizeof stats);
    sample warm_up;
    if (!code && o->stats && !measure(s, o, 0, counts, &warm_up, &stats, error, sizeof error)) {
        code = masu_cli_error("%s", error);
    }
    for (uint32_t i = 0; i < o->frames && !code; i++) {
        masu_cli_progress(o->rays ? "ray %u of %u of each pixel" : "frame %u of %u", i + 1, o->frames);
        if (!measure(s, o, i, counts, &samples[i], &stats, error, sizeof error)) {
            code = masu_cli_error("%s", error);
        } else if (o->output) {
            code = save(s, o, i);
        }
    }
    if (!code && o->stats)
        code = write_stats(s, o, scene, samples, o->frames, &stats, stats.timed != 0);
    if (!code && o->rays) report_rays(s, o, &stats);
    if (!code && o->times) code = write_times(s, o, samples);
    if (!code && o->target_ms > 0.0) report_governor(s, o, samples, &stats.governor);
    free(samples);
    return code;
}

static int check(const masu_session_desc *d, const render_options *o) {
    if (!d->scene_path) return masu_cli_usage_error("no scene is given");
    if (!o->output && !o->stats && !o->times && !(o->target_ms > 0.0))
        return masu_cli_usage_error("none of --output, --stats, --times, --target-ms is given");
    if (o->target_ms > 0.0 && o->rays)
        return masu_cli_usage_error("--target-ms and --reference do not go together");
    if ((o->rays || o->positions) && strchr(o->output ? o->output : "", '#')) {
        return masu_cli_usage_error("%s makes one picture: --output %s names many",
                                    o->positions ? "--truth" : "--reference", o->output);
    }
    if (o->positions && !o->output) return masu_cli_usage_error("--truth needs --output");
    return MASU_CLI_OK;
}

/* "auto": metered; "fixed": the scene's factor; a number: that factor. */
static bool read_exposure(masu_cli *cli, masu_desc *desc, render_options *o) {
    int metered = !strcmp(cli->value, "auto");
    desc->exposure.metered = metered ? MASU_ON : MASU_OFF;
    o->exposure = 0;
    return metered || !strcmp(cli->value, "fixed") || masu_cli_double(cli, 1e-6, 1e6, &o->exposure);
}

/* Options that turn one knob of every rung; those that are not given leave it as the ladder has it. */
typedef struct turned {
    bool march_given, cull_given, lod_given, aa_given;
    uint32_t cull;
    masu_rung to;
} turned;

/* Eight rungs from the full size to 0.4 of it, each 13 % smaller than the one before. */
static void make_ladder(masu_desc *d) {
    d->rung_count = MASU_MAX_RUNGS;
    for (uint32_t r = 0; r < d->rung_count; r++) {
        double scale = pow(0.4, r / (double)(d->rung_count - 1));
        d->rungs[r] = (masu_rung){.scale = (float)scale, .sharpness = r ? 0.2f : 0.0f};
    }
}

/* The scene is known by now, and with it its ladder. */
static void turn(masu_desc *d, const turned *t) {
    *d = masu_desc_resolved(d);
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_rung *rung = &d->rungs[r];
        if (t->march_given) rung->march = t->to.march;
        if (t->cull_given) rung->frustum = t->cull < 2 ? MASU_ON : MASU_OFF;
        if (t->cull_given) rung->occlusion = t->cull % 2 ? MASU_OFF : MASU_ON;
        if (t->lod_given) rung->lod_error = t->to.lod_error;
        if (t->aa_given) rung->aa = t->to.aa;
    }
}

/* True: s is open, and its rungs are as the command line has them. */
static bool open_rungs(masu_session_desc *d, const render_options *o, const turned *t,
                       masu_session *s, int *code) {
    char error[1024];
    *code = MASU_CLI_FAILURE;
    d->no_renderer = true;
    if (!masu_session_open(d, s, error, sizeof error)) {
        *code = masu_cli_error("%s", error);
        return false;
    }
    turn(&s->desc, t);
    if (o->rung >= s->desc.rung_count) {
        *code = masu_cli_usage_error("--rung %u does not exist, there are 0 to %u", o->rung,
                                     s->desc.rung_count - 1);
    } else if (masu_session_start(s, error, sizeof error)) {
        return true;
    } else {
        *code = masu_cli_error("%s", error);
    }
    masu_session_close(s);
    return false;
}

static bool read_setting(const masu_cli *cli, masu_desc *desc) {
    char error[600];
    desc->rung_count = 1;
    if (masu_setting_parse(cli->value, &desc->rungs[0], error, sizeof error)) return true;
    masu_cli_usage_error("%s", error);
    return false;
}

static int run(masu_cli *cli) {
    masu_session_desc d = {.desc = {.output = {1920, 1080}, .targets = {.storage = 1}},
                           .host = {.ray_query = true}};
    render_options o = {.frames = 1, .time_step = 1.0 / 60.0};
    static const char *const tones[] = {"auto", "none", "aces", "neutral", NULL};
    static const char *const stages[] = {"both", "frustum", "occlusion", "none", NULL};
    uint32_t poison = 0, tone = 0, casters = 0;
    turned knobs = {0};
    const char *ladder = NULL;
    bool frames = false, step = false, fixed = false, setting = false;
    const char *own = NULL; /* an option about what --truth has its own mind of */
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &d.host)) continue;
        switch (id) {
        case OPTION_OUTPUT: o.output = cli->value; continue;
        case OPTION_STATS:
            o.stats = cli->value;
            own = "--stats";
            continue;
        case OPTION_SIZE:
            if (!masu_output_size(cli, &d.desc.output)) return MASU_CLI_USAGE;
            continue;
        case OPTION_FRAMES:
            if (!masu_cli_uint(cli, 1, FRAMES_MAX, &o.frames)) return MASU_CLI_USAGE;
            frames = true;
            continue;
        case OPTION_REFERENCE:
            o.rays = REFERENCE_RAYS;
            if (cli->value && !masu_cli_uint(cli, 1, FRAMES_MAX, &o.rays)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TRUTH:
            o.positions = MASU_PICTURE_POSITIONS;
            if (cli->value && !masu_cli_uint(cli, 1, MASU_PICTURE_POSITIONS_MAX, &o.positions))
                return MASU_CLI_USAGE;
            continue;
        case OPTION_RUNG:
            own = "--rung";
            if (!masu_cli_uint(cli, 0, MASU_MAX_RUNGS - 1, &o.rung)) return MASU_CLI_USAGE;
            fixed = true;
            continue;
        case OPTION_TIME:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.time)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TIME_STEP:
            if (!masu_cli_double(cli, 0.0, 1e6, &o.time_step)) return MASU_CLI_USAGE;
            step = true;
            continue;
        case OPTION_FLIGHT:
            if (!masu_cli_uint(cli, 1, MASU_MAX_FLIGHT, &d.desc.frames_in_flight))
                return MASU_CLI_USAGE;
            continue;
        case OPTION_MARCH:
            own = "--march";
            if (!masu_knob_option(cli, "march", &knobs.to)) return MASU_CLI_USAGE;
            knobs.march_given = true;
            continue;
        case OPTION_CULL:
            own = "--cull";
            if (!masu_cli_choice(cli, stages, &knobs.cull)) return MASU_CLI_USAGE;
            knobs.cull_given = true;
            continue;
        case OPTION_CASTERS: casters = 1; continue;
        case OPTION_ANISOTROPY: {
            double most = 0;
            own = "--anisotropy";
            if (!masu_cli_double(cli, 1.0, 64.0, &most)) return MASU_CLI_USAGE;
            d.desc.vulkan.max_anisotropy = (float)most;
            continue;
        }
        case OPTION_LOD_ERROR:
            own = "--lod-error";
            if (!masu_knob_option(cli, "lod_error", &knobs.to)) return MASU_CLI_USAGE;
            knobs.lod_given = true;
            continue;
        case OPTION_SUN:
            if (!masu_cli_sun(cli, o.sun)) return MASU_CLI_USAGE;
            o.own_sun = true;
            continue;
        case OPTION_TURBIDITY:
            if (!masu_cli_double(cli, 1.5, 10.0, &o.turbidity)) return MASU_CLI_USAGE;
            d.desc.analytic_sky = 1;
            continue;
        case OPTION_EXPOSURE:
            if (!read_exposure(cli, &d.desc, &o)) return MASU_CLI_USAGE;
            continue;
        case OPTION_AA:
            own = "--aa";
            if (!masu_knob_option(cli, "aa", &knobs.to)) return MASU_CLI_USAGE;
            knobs.aa_given = true;
            continue;
        case OPTION_SETTING:
            own = "--setting";
            if (!strcmp(cli->value, "help")) {
                masu_knobs_print(stdout);
                return MASU_CLI_OK;
            }
            if (!read_setting(cli, &d.desc)) return MASU_CLI_USAGE;
            setting = true;
            continue;
        case OPTION_TONE:
            if (!masu_cli_choice(cli, tones, &tone)) return MASU_CLI_USAGE;
            d.desc.tone = (masu_tone)tone;
            continue;
        case OPTION_DITHER: d.desc.dither = MASU_ON; continue;
        case OPTION_TIMES:
            o.times = cli->value;
            own = "--times";
            continue;
        case OPTION_TARGET:
            own = "--target-ms";
            if (!masu_cli_double(cli, 1.0, 1000.0, &o.target_ms)) return MASU_CLI_USAGE;
            continue;
        case OPTION_LADDER:
            own = "--ladder";
            ladder = cli->value;
            continue;
        case OPTION_POISON: poison = 1; continue;
        case OPTION_SPLIT: d.desc.deny.unified_memory = 1; continue;
        case OPTION_RAYS:
            if (!masu_rays_option(cli, &d)) return MASU_CLI_USAGE;
            continue;
        case MASU_CLI_ARGUMENT:
            if (d.scene_path) return masu_cli_usage_error("one scene at a time: '%s'", cli->value);
            d.scene_path = cli->value;
            continue;
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (o.target_ms > 0.0) {
        d.desc.governor =
            (masu_governor_desc){.mode = fixed ? MASU_GOVERNOR_FIXED : MASU_GOVERNOR_ON,
                                 .target_ms = (float)o.target_ms,
                                 .rung = o.rung};
    }
    if (o.positions && own)
        return masu_cli_usage_error("--truth takes everything at its most exact: no %s", own);
    if ((o.rays || o.positions) && (frames || step)) {
        return masu_cli_usage_error("%s draws one moment: no %s",
                                    o.positions ? "--truth" : "--reference, a frame for each ray,",
                                    frames ? "--frames" : "--time-step");
    }
    if (setting && (ladder || o.target_ms > 0.0)) {
        return masu_cli_usage_error("--setting draws one rung: no %s",
                                    ladder ? "--ladder" : "--target-ms");
    }
    if (o.rays) o.frames = o.rays, o.time_step = 0.0;
    int code = check(&d, &o);
    if (!code) code = masu_ladder_option(ladder, &d.desc);
    if (code) return code;
    if (d.desc.ladder == MASU_OFF && o.target_ms > 0.0 && !d.desc.rung_count) make_ladder(&d.desc);
    masu_vk_alloc_counts counts;
    VkAllocationCallbacks allocator = masu_vk_alloc_callbacks(&counts);
    d.desc.debug =
        (masu_debug){.timestamps = o.stats != NULL, .counters = o.stats != NULL || o.rays,
                     .poison = poison, .casters = casters, .reference = o.rays != 0};
    d.host.allocator = o.stats ? &allocator : NULL;
    d.host.message = masu_print_message;
    static masu_session s;
    char error[1024];
    masu_cli_progress("building pipelines");
    if (o.positions && !masu_picture_open(&d, o.positions, &s, error, sizeof error))
        return masu_cli_error("%s", error);
    if (!o.positions && !open_rungs(&d, &o, &knobs, &s, &code)) return code;
    if (!masu_cli_quiet()) {
        masu_cli_progress_clear();
        fprintf(stderr, "masu: %s\n", s.host.driver);
    }
    code = o.positions ? render_truth(&s, &o) : render_frames(&s, &o, d.scene_path, &counts);
    code = masu_finish_validation(&s.host, code);
    masu_session_close(&s);
    return code;
}

static const masu_cli_option options[] = {
    {"output", "FILE.png", "the last frame; with '####' in the name every frame, numbered",
     OPTION_OUTPUT, 'o'},
    {"size", "WxH",
     "output size in pixels, at most 16384 a side and 64 Mi in all\n(default 1920x1080)",
     OPTION_SIZE, 0},
    {"frames", "N", "frames to draw along the scene's camera path (default 1)", OPTION_FRAMES, 0},
    {"reference", "[=N]",
     "the truth of reflections, at one moment: N unfiltered rays from each pixel\n"
     "(default 1024; 64 for what 64 rays look like), each weighted by the exact lobe", OPTION_REFERENCE,
     0},
    {"truth", "[=N]",
     "what the picture would be with no shortcut: the mean of N places in each pixel (default\n"
     "64), each at full size and at the most exact; reflections by 1024 rays in all, or --reference=N",
     OPTION_TRUTH, 0},
    {"rung", "R", "quality: a rung of the ladder, 0 the best (default 0)",
     OPTION_RUNG, 0},
    {"setting", "NAME|help",
     "instead of a ladder one rung, by the name that masu bench gives it: scale=0.5+aa=fxaa;\n"
     "help: all knobs, their values and what they cost", OPTION_SETTING, 0},
    {"aa", "WAY", "anti-aliasing:" MASU_AA_WORDS(MASU_WORD_LIST) " (default off)", OPTION_AA, 0},
    {"target-ms", "MS",
     "let the governor choose among the rungs of the ladder, for frames of so long, or follow\n"
     "--rung of these; prints what it has seen and done", OPTION_TARGET, 0},
    {"ladder", "FILE|auto|off",
     "the rungs: those of a ladder.json of masu bench; auto, those measured for scenes of this\n"
     "class; off, sizes alone: 1, 0.8 and 0.4, with --target-ms eight from 1 to 0.4\n"
     "(default: auto with --target-ms, else off)", OPTION_LADDER, 0},
    {"times", "FILE.csv", "time, rung and reason of every frame", OPTION_TIMES, 0},
    {"time", "SECONDS", "time of the first frame (default 0)", OPTION_TIME, 0},
    {"time-step", "SECONDS", "between frames (default 1/60)", OPTION_TIME_STEP, 0},
    {"stats", "FILE.json", "times, counts, memory, allocations of the frames; - for stdout",
     OPTION_STATS, 0},
    {"march", "WAY",
     "how the SDF is marched:" MASU_MARCH_WORDS(MASU_WORD_LIST) ";\n"
     "plain, fragment, seed, checkerboard need a blob baked with --variants (default auto)",
     OPTION_MARCH, 0},
    {"cull", "STAGES", "both, frustum, occlusion or none: the picture stays the same (default both)",
     OPTION_CULL, 0},
    {"lod-error", "PIXELS",
     "how wrong a surface may be drawn by a coarser form of its mesh; below 0: none (default 1)",
     OPTION_LOD_ERROR, 0},
    {"casters", NULL, "cull for the sun too, for the numbers of --stats", OPTION_CASTERS, 0},
    {"sun", "AZIMUTH,ELEVATION", "where the sun stands, degrees, instead of the scene's", OPTION_SUN,
     0},
    {"turbidity", "T", "a sky that follows from the sun: 1.5 (very clear) to 10 (hazy)",
     OPTION_TURBIDITY, 0},
    {"exposure", "E",
     "factor before the tone curve, instead of the scene's; auto: metered; fixed: the scene's factor,\n"
     "not metered even where the scene asks for it", OPTION_EXPOSURE, 0},
    {"tone", "CURVE", "none, aces (filmic) or neutral (default aces)", OPTION_TONE, 0},
    {"dither", NULL, "round to 8 bits with a pattern instead of bands", OPTION_DITHER, 0},
    {"anisotropy", "N",
     "samples of textures along the longer axis, where the device offers it (default 1)",
     OPTION_ANISOTROPY, 0},
    {"frames-in-flight", "N", "1 to 3 (default 2)", OPTION_FLIGHT, 0},
    {"poison", NULL,
     "fill all transient images with NaN before each frame (the picture must not change)",
     OPTION_POISON, 0},
    {"split-memory", NULL, "one block per memory role, even on unified memory", OPTION_SPLIT, 0},
    MASU_RAYS_OPTION(OPTION_RAYS),
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_render = {
    .name = "render",
    .arguments = "SCENE.masu -o OUT.png [options]",
    .summary = "render a baked scene to PNG",
    .options = options,
    .details = "Scenes are made by masu-bake. Frames are drawn one after another; with --stats a "
               "first one is\n"
               "drawn and not counted. Wall time is from masu_frame to the fence. GPU times come "
               "from timestamps with\n"
               "a full barrier around each pass; \"timestamps_plausible\" says whether they fit "
               "the wall clock.\n",
    .run = run};
