/* render.c: `masu render`: renders frames of a baked scene to image files, without a window, with
 * measured times, counts and memory. */
#include "command/options.h"
#include "masu/render.h"
#include "command/video.h"

#include "alloc_count.h"
#include "measure/linear.h"
#include "measure/picture.h"
#include "settings/knobs.h"
#include "clock.h"
#include "image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define FRAMES_MAX 100000u
#define STILL_FRAMES_MIN 16u /* temporal anti-aliasing has sampled every part of a pixel */
#define STILL_FRAMES_MAX 64u
#define STILL_FRAMES_SETTLING 256u /* maximum while shadows and live light converge */
#define STILL_CHANGE 0.25
#define REFERENCE_RAYS 1024u /* per pixel: with fewer, the ground truth has visible noise */

/* ---- Frames ---------------------------------------------------------------------------------- */

/* "frame_####.png" names one file per frame; a name without '#' is for the last frame. Returns
 * false if the name is too long. */
static bool output_name(const char *pattern, uint32_t frame, char *out, size_t size) {
    const char *first = strchr(pattern, '#');
    if (!first) return (size_t)snprintf(out, size, "%s", pattern) < size;
    size_t digits = strspn(first, "#");
    int n = snprintf(out, size, "%.*s%0*u%s", (int)(first - pattern), pattern, (int)digits, frame,
                     first + digits);
    return n > 0 && (size_t)n < size;
}

/* Writes the format that the file's name selects. linear: three floats per pixel, of `size`; rgba:
 * of the output size. */
static int write_image(const masu_session *s, const char *path, const uint8_t *rgba,
                       const float *linear, VkExtent2D size) {
    char error[1024];
    VkExtent2D out = s->desc.output;
    bool good =
        masu_image_is_linear(path)
            ? masu_image_save_linear(path, linear, size.width, size.height, error, sizeof error)
            : masu_image_save_png(path, rgba, out.width, out.height, 0, error, sizeof error);
    return good ? MASU_CLI_OK : masu_cli_error("%s", error);
}

static VkExtent2D render_size(const masu_session *s, uint32_t rung) {
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    return (VkExtent2D){plan.rungs[rung].render_width, plan.rungs[rung].render_height};
}

/* Linear light is read before upscaling. */
static int save_linear(masu_session *s, const char *name, const masu_commands *commands) {
    VkExtent2D size = render_size(s, commands->rung);
    float *linear = malloc(3 * sizeof *linear * size.width * size.height);
    int code = linear && masu_linear_read(s->m, commands->slot, size, linear)
                   ? write_image(s, name, NULL, linear, size)
                   : masu_cli_error("%s: no linear light to read back", name);
    free(linear);
    return code;
}

/* Writes image number `frame` if requested: every frame into a video or a numbered file, otherwise
 * only the last. */
static int save(masu_session *s, const masu_render_options *o, masu_video *video, uint32_t frame,
                const masu_commands *commands) {
    char error[1024], name[4096];
    bool each = o->output && strchr(o->output, '#') != NULL,
         file = o->output && (each || frame + 1 == o->frames);
    if (!file && !o->video) return MASU_CLI_OK;
    if (file && !output_name(o->output, frame, name, sizeof name))
        return masu_cli_error("--output: the file name is too long");
    if (file && masu_image_is_linear(name)) {
        int code = save_linear(s, name, commands);
        if (code || !o->video) return code;
        file = false;
    }
    if (!masu_headless_target_read(&s->host, &s->targets[0], error, sizeof error))
        return masu_cli_error("%s", error);
    if (o->video && !masu_video_frame(video, s->targets[0].mapped, error, sizeof error))
        return masu_cli_error("%s", error);
    return file ? write_image(s, name, s->targets[0].mapped, NULL, s->desc.output) : MASU_CLI_OK;
}

/* Sets the sun from angles as in scene descriptions, and the analytic sky. */
static void set_light(const masu_render_options *o, masu_light *light) {
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

static bool measure(masu_session *s, const masu_render_options *o, uint32_t frame,
                    masu_vk_alloc_counts *counts, masu_sample *out, masu_stats_info *stats,
                    masu_commands *drawn, char *error, size_t size) {
    masu_light light;
    bool own_light = o->own_sun || o->turbidity > 0.0 || o->exposure > 0.0;
    if (own_light && masu_light_of(s->m, &light, NULL)) {
        snprintf(error, size, "--sun, --turbidity and --exposure: the scene has no light");
        return false;
    }
    if (own_light) set_light(o, &light);
    const uint32_t rays = o->rays ? o->rays : 1, image = o->still ? 0 : frame / rays;
    masu_frame_desc f = {MASU_FRAME_DESC, .light = own_light ? &light : NULL,
                         .sdf_params = o->sdf_param_count ? o->sdf_params : NULL,
                         .sdf_param_count = o->sdf_param_count,
                         .time = o->time + (double)(o->first + image) * o->time_step,
                         .time_step = o->rays ? MASU_PICTURE_STEP : (float)o->time_step,
                         .post = o->post,
                         .rung = o->target_ms > 0.0 ? MASU_RUNG_AUTO : o->rung,
                         /* The sum starts with the first counted frame. */
                         .cut = o->rays && frame % rays == 0};
    if (!o->at_rest && !masu_render_animate(s, o, f.time, error, size)) return false;
    masu_commands commands;
    uint64_t callbacks = counts->allocations + counts->reallocations;
    uint64_t thread = masu_allocs_of_thread();
    uint64_t start = masu_clock_ns(NULL);
    if (masu_frame(s->m, &f, &commands, &s->detail)) {
        snprintf(error, size, "%s", s->detail.text);
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
    (void)masu_stats(s->m, commands.slot, stats, NULL);
    out->gpu_ms = (double)stats->gpu_ns / 1e6;
    *drawn = commands;
    out->rung = commands.rung;
    out->reason = stats->governor.reason_text;
    for (uint32_t p = 0; p < stats->pass_count; p++)
        out->pass_ms[p] = (double)stats->pass_ns[p] / 1e6;
    return true;
}

/* Reports the reference's rays. In a scene without traced reflections the image itself is the
 * ground truth. */
static void report_rays(const masu_session *s, const masu_render_options *o,
                        const masu_stats_info *stats) {
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    const masu_plan_rung *r = &plan.rungs[o->rung];
    double pixels = (double)r->render_width * (double)r->render_height;
    if (!stats->specular_rays)
        masu_cli_warn("--reference: no pixel of the image traces reflections");
    if (masu_cli_quiet()) return;
    masu_cli_progress_clear();
    fprintf(stderr, "masu: reference: %u rays per reflecting pixel, %.1f %% of the image\n",
            o->rays, 100.0 * (double)stats->specular_rays / pixels);
}

/* Renders one ground truth image and writes the requested files. */
static int truth_frame(masu_session *s, const masu_render_options *o, const masu_light *light,
                       uint32_t frame, masu_video *video, uint8_t *rgba, float *linear) {
    char error[1024], name[4096] = "";
    const bool file = o->output && (strchr(o->output, '#') || frame + 1 == o->frames);
    masu_frame_desc f = {MASU_FRAME_DESC, .light = light,
                         .sdf_params = o->sdf_param_count ? o->sdf_params : NULL,
                         .sdf_param_count = o->sdf_param_count,
                         .post = o->post,
                         .time = o->time + (double)(o->first + frame) * o->time_step};
    if (file && !output_name(o->output, frame, name, sizeof name))
        return masu_cli_error("--output: the file name is too long");
    if (!file && !o->video) return MASU_CLI_OK;
    if (!o->at_rest && !masu_render_animate(s, o, f.time, error, sizeof error))
        return masu_cli_error("%s", error);
    if (!masu_picture_truth(s, &f, o->positions, o->rays ? o->rays : MASU_PICTURE_RAYS,
                            &(masu_picture_means){.linear = linear, .display = rgba},
                            masu_cli_progress_text, error, sizeof error) ||
        (o->video && !masu_video_frame(video, rgba, error, sizeof error))) {
        return masu_cli_error("%s", error);
    }
    return file ? write_image(s, name, rgba, linear, s->desc.output) : MASU_CLI_OK;
}

/* Renders the ground truth. */
static int render_truth(masu_session *s, const masu_render_options *o, masu_video *video) {
    masu_light light;
    bool own_light = o->own_sun || o->turbidity > 0.0 || o->exposure > 0.0;
    if (own_light && masu_light_of(s->m, &light, NULL))
        return masu_cli_error("--sun, --turbidity and --exposure: the scene has no light");
    if (own_light) set_light(o, &light);
    VkExtent2D size = s->desc.output;
    size_t pixels = (size_t)size.width * size.height;
    uint8_t *rgba = malloc(4 * pixels);
    float *linear = malloc(3 * sizeof *linear * pixels);
    int code = rgba && linear
                   ? MASU_CLI_OK
                   : masu_cli_error("out of memory for an image of %ux%u", size.width, size.height);
    for (uint32_t i = 0; i < o->frames && !code; i++)
        code = truth_frame(s, o, own_light ? &light : NULL, i, video, rgba, linear);
    free(rgba);
    free(linear);
    if (code || masu_cli_quiet()) return code;
    const uint32_t frames =
        masu_picture_frames(s, o->positions, o->rays ? o->rays : MASU_PICTURE_RAYS);
    masu_cli_progress_clear();
    fprintf(stderr, "masu: ground truth: %u samples per pixel, %u frame%s each\n", o->positions,
            frames, frames == 1 ? "" : "s");
    return MASU_CLI_OK;
}

/* ---- The settled still ----------------------------------------------------------------------- */

/* Mean difference of two images, of 255, over blocks of 4x4 pixels, which average out the noise of
 * dithering. */
static double change(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height) {
    double sum = 0.0;
    uint64_t blocks = 0;
    for (uint32_t y = 0; y < height; y += 4) {
        for (uint32_t x = 0; x < width; x += 4, blocks++) {
            int off[3] = {0}, count = 0;
            for (uint32_t v = y; v < y + 4 && v < height; v++) {
                for (uint32_t u = x; u < x + 4 && u < width; u++, count++) {
                    const size_t at = 4 * ((size_t)v * width + u);
                    for (size_t c = 0; c < 3; c++) off[c] += a[at + c] - b[at + c];
                }
            }
            for (int c = 0; c < 3; c++) sum += abs(off[c]) / (3.0 * count);
        }
    }
    return sum / (double)blocks;
}

/* Renders frames of one moment until they change by less than a quarter of a step; linear light is
 * their mean. */
static int render_still(masu_session *s, const masu_render_options *o,
                        masu_vk_alloc_counts *counts) {
    const uint32_t width = s->desc.output.width, height = s->desc.output.height;
    const size_t bytes = 4 * (size_t)width * height;
    const bool is_linear = masu_image_is_linear(o->output);
    const VkExtent2D size = render_size(s, o->rung);
    const size_t values = 3 * (size_t)size.width * size.height;
    uint8_t *before = malloc(bytes);
    float *linear = is_linear ? calloc(2 * values, sizeof *linear) : NULL;
    masu_sample sample;
    masu_commands commands;
    masu_stats_info stats;
    char error[1024];
    int code = before && (linear || !is_linear)
                   ? MASU_CLI_OK
                   : masu_cli_error("out of memory for an image of %ux%u", width, height);
    double moved = HUGE_VAL;
    uint32_t n = 0, summed = 0, settling = 0;
    while (!code && n - settling < STILL_FRAMES_MAX && settling < STILL_FRAMES_SETTLING &&
           (n < STILL_FRAMES_MIN || moved >= STILL_CHANGE)) {
        masu_cli_progress("frame %u of at most %u", n + 1, settling + STILL_FRAMES_MAX);
        if (!measure(s, o, n, counts, &sample, &stats, &commands, error, sizeof error) ||
            !masu_headless_target_read(&s->host, &s->targets[0], error, sizeof error)) {
            code = masu_cli_error("%s", error);
        } else if (linear && !masu_linear_read(s->m, commands.slot, size, linear + values)) {
            code = masu_cli_error("%s: no linear light to read back", o->output);
        } else {
            if (n) moved = change(before, s->targets[0].mapped, width, height);
            memcpy(before, s->targets[0].mapped, bytes);
            if (masu_picture_settles(&stats)) {
                settling++;
                summed = 0;
                moved = HUGE_VAL;
            }
            for (size_t i = 0; linear && i < values; i++)
                linear[i] = (summed ? linear[i] : 0.0f) + linear[values + i];
            n++, summed++;
        }
    }
    for (size_t i = 0; linear && i < values; i++) linear[i] /= (float)(summed ? summed : 1);
    if (!code) code = write_image(s, o->output, before, linear, size);
    free(before);
    free(linear);
    if (code || masu_cli_quiet()) return code;
    masu_cli_progress_clear();
    fprintf(stderr, "masu: still: %u frames, the last changed by %.2f of 255\n", n, moved);
    return MASU_CLI_OK;
}

/* ---- A sequence ------------------------------------------------------------------------------ */

/* With statistics an extra first frame is rendered and not counted: drivers compile pipelines at
 * their first use. */
static int render_frames(masu_session *s, const masu_render_options *o, masu_video *video,
                         masu_vk_alloc_counts *counts) {
    const uint32_t rays = o->rays ? o->rays : 1;
    masu_sample *samples = calloc(o->frames, sizeof *samples), other;
    masu_stats_info stats;
    char error[1024];
    int code = samples ? MASU_CLI_OK : masu_cli_error("out of memory for %u frames", o->frames);
    memset(&stats, 0, sizeof stats);
    masu_sample warm_up;
    masu_commands commands;
    if (!code && o->stats &&
        !measure(s, o, 0, counts, &warm_up, &stats, &commands, error, sizeof error)) {
        code = masu_cli_error("%s", error);
    }
    for (uint64_t i = 0; i < (uint64_t)o->frames * rays && !code; i++) {
        const uint32_t image = (uint32_t)(i / rays), ray = (uint32_t)(i % rays);
        if (o->rays)
            masu_cli_progress("image %u of %u: ray %u of %u per pixel", image + 1, o->frames,
                              ray + 1, rays);
        else masu_cli_progress("frame %u of %u", image + 1, o->frames);
        if (!measure(s, o, (uint32_t)i, counts, ray ? &other : &samples[image], &stats, &commands,
                     error, sizeof error))
            code = masu_cli_error("%s", error);
        else if (ray + 1 == rays)
            code = save(s, o, video, image, &commands);
    }
    if (!code && o->stats)
        code = masu_render_stats(s, o, samples, o->frames, &stats);
    if (!code && o->rays) report_rays(s, o, &stats);
    if (!code && o->times) code = masu_render_times(s, o, samples);
    if (!code && o->target_ms > 0.0) masu_render_governor(s, o, samples, &stats.governor);
    free(samples);
    return code;
}

/* ---- Rungs ----------------------------------------------------------------------------------- */

/* Eight rungs from full size to 0.4, each 13 % smaller than the previous one. */
static void make_ladder(masu_desc *d) {
    d->rung_count = 8;
    for (uint32_t r = 0; r < d->rung_count; r++) {
        double scale = pow(0.4, r / (double)(d->rung_count - 1));
        d->rungs[r] = (masu_rung){.scale = (float)scale, .sharpness = r ? 0.2f : 0.0f};
    }
}

/* Called when the scene, and therefore its ladder, is known. */
static void turn(masu_desc *d, const masu_turned *t) {
    *d = masu_session_resolved(d);
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_rung *rung = &d->rungs[r];
        if (t->cull_given) rung->frustum = t->cull < 2 ? MASU_ON : MASU_OFF;
        if (t->cull_given) rung->occlusion = t->cull % 2 ? MASU_OFF : MASU_ON;
        if (t->lod_given) rung->lod_error = t->to.lod_error;
        if (t->aa_given) {
            rung->aa = t->to.aa;
            /* --aa replaces temporal upscaling, so the defaults that depend on it are reset. */
            if (rung->temporal == MASU_ON) {
                rung->sharpen = rung->specular_reuse = rung->specular_taa = MASU_AUTO;
                rung->specular_frames = 0;
            }
            rung->temporal = MASU_OFF;
        }
    }
}

/* Opens the session with the rungs of the command line. Returns true on success. */
static bool open_rungs(const masu_render_options *o, masu_session *s, int *code) {
    masu_session_desc d = o->d;
    char error[1024];
    *code = MASU_CLI_FAILURE;
    d.no_renderer = true;
    if (!masu_session_open(&d, s, error, sizeof error)) {
        *code = masu_cli_error("%s", error);
        return false;
    }
    turn(&s->desc, &o->turned);
    if (o->rung >= s->desc.rung_count) {
        *code = masu_cli_usage_error("--rung: expected 0 to %u, found %u", s->desc.rung_count - 1,
                                     o->rung);
    } else if (masu_session_start(s, error, sizeof error)) {
        return true;
    } else {
        *code = masu_cli_error("%s", error);
    }
    masu_session_close(s);
    return false;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static bool read_reference(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    o->rays = REFERENCE_RAYS;
    return !cli->value || masu_cli_uint(cli, 1, FRAMES_MAX, &o->rays);
}

static bool read_param(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    if (o->param_count == MASU_RENDER_PARAMS_MAX) {
        masu_cli_usage_error("--param: expected at most %u of them", MASU_RENDER_PARAMS_MAX);
        return false;
    }
    o->params[o->param_count++] = cli->value;
    return true;
}

static bool read_animate(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    o->at_rest = cli->value && !strcmp(cli->value, "off");
    if (cli->value && !o->at_rest) {
        masu_cli_usage_error("--animate: expected off, found \"%s\"", cli->value);
        return false;
    }
    return true;
}

static bool read_first(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    return !cli->value || masu_cli_uint(cli, 0, FRAMES_MAX, &o->first);
}

static bool read_truth(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    o->positions = MASU_PICTURE_POSITIONS;
    return !cli->value || masu_cli_uint(cli, 1, MASU_PICTURE_POSITIONS_MAX, &o->positions);
}

/* Reads the only rung; `help` prints the knobs. */
static bool read_setting(masu_cli *cli, void *to) {
    if (!strcmp(cli->value, "help")) {
        masu_knobs_print(stdout);
        cli->exit_code = MASU_CLI_OK;
        return false;
    }
    return masu_read_setting(cli, &((masu_render_options *)to)->d.desc);
}

static bool read_sun(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    o->own_sun = true;
    return masu_cli_sun(cli, o->sun);
}

/* "auto": metered; "fixed": the scene's factor; a number: that factor. */
static bool read_exposure(masu_cli *cli, void *to) {
    masu_render_options *o = to;
    int metered = !strcmp(cli->value, "auto");
    o->d.desc.exposure.metered = metered ? MASU_ON : MASU_OFF;
    o->exposure = 0;
    return metered || !strcmp(cli->value, "fixed") || masu_cli_double(cli, 1e-6, 1e6, &o->exposure);
}

static const char *const tones[] = {"auto", "none", "aces", "neutral", NULL};
static const char *const stages[] = {"both", "frustum", "occlusion", "none", NULL};

static const masu_option rows[] = {
    MASU_HEADING("Output"),
    {MASU_ROW(masu_render_options, output, MASU_TAKE_IMAGE, "output", "FILE",
              "write the settled still; with --frames the last frame, or with '####' in the\n"
              "name every frame, numbered. FILE.png: 8 bits of sRGB; FILE.pfm, FILE.exr:\n"
              "scene-linear RGB before exposure and tone curve, at the render size"),
     .letter = 'o'},
    MASU_OUTPUT(masu_render_options, video, "video", "FILE.y4m",
                "write every frame as uncompressed video (YUV4MPEG2); '-' is stdout"),
    MASU_OUTPUT_SIZE_ROW(masu_render_options, d.desc.output),
    MASU_OUTPUT(masu_render_options, stats, "stats", "FILE.json",
                "write times, counts, memory and allocations; '-' is stdout"),
    MASU_OUTPUT(masu_render_options, times, "times", "FILE.csv",
                "write time, rung and governor reason of every frame; '-' is stdout"),
    MASU_HEADING("Frames"),
    MASU_OWN("frame", "[=N]", read_first,
             "render one raw frame, number N of the camera path (default 0), instead of the\n"
             "settled still"),
    MASU_UINT(masu_render_options, frames, "frames", 1, FRAMES_MAX,
              "render this number of raw frames along the scene's camera path"),
    MASU_REAL(masu_render_options, time, "time", "SECONDS", -1e9, 1e9,
              "time of the first frame (default 0)"),
    MASU_REAL(masu_render_options, time_step, "time-step", "SECONDS", 0.0, 1e6,
              "time between frames"),
    MASU_OWN("animate", "[=off]", read_animate,
             "loop the first animation clip of every model (default); off: keep the rest pose"),
    MASU_TEXT(masu_render_options, clip, "clip", "NAME|N",
              "clip that models play, by name or number; models without it play their first"),
    MASU_OWN("param", "NAME=VALUE", read_param,
             "parameter of the scene's SDF; may be given several times"),
    MASU_HEADING("Reference images"),
    MASU_OWN("truth", "[=N]", read_truth,
             "ground truth: average N full-size samples per pixel (default 64), with the\n"
             "most exact settings and 1024 reflection rays in all"),
    MASU_OWN("reference", "[=N]", read_reference,
             "trace N unfiltered reflection rays per pixel (default 1024), weighted by\n"
             "the exact lobe; with --truth: its number of reflection rays"),
    MASU_HEADING("Quality"),
    MASU_UINT(masu_render_options, rung, "rung", 0, MASU_MAX_RUNGS - 1,
              "rung of the ladder, 0 is the best (default 0)"),
    MASU_REAL(masu_render_options, target_ms, "target-ms", "MS", 1.0, 1000.0,
              "let the governor choose the rung for this frame time and print a report;\n"
              "with --rung it keeps that rung and only models the times"),
    MASU_LADDER_ROW(masu_render_options, ladder,
                    "scales 1, 0.8, 0.4; with --target-ms eight scales from 1 to 0.4\n"
                    "(default: auto with --target-ms, else off)"),
    MASU_OWN("setting", "NAME|help", read_setting,
             "render one rung with these knobs, named as by `masu bench`, for example\n"
             "scale=0.5+aa=fxaa; help: print all knobs, their values and cost, and exit"),
    MASU_KNOB(masu_render_options, turned.to, "aa", "MODE", "aa",
              "anti-aliasing; disables temporal upscaling (default off). MODE is one of\n"
              " " MASU_AA_WORDS(MASU_WORD_LIST)),
    MASU_CHOICE(masu_render_options, turned.cull, "cull", "STAGES", stages,
                "culling stages: both, frustum, occlusion or none; the image is the same\n"),
    MASU_KNOB(masu_render_options, turned.to, "lod-error", "PIXELS", "lod_error",
              "largest screen-space error of a mesh LOD; below 0: no LODs (default 1)"),
    MASU_REAL(masu_render_options, anisotropy, "anisotropy", "N", 1.0, 64.0,
              "anisotropic texture samples, if the device supports them (default 8 on a GPU, 1 on a CPU)"),
    MASU_HEADING("Light and tone"),
    MASU_OWN("sun", "AZIMUTH,ELEVATION", read_sun,
             "sun position in degrees (default: the scene's)"),
    MASU_REAL(masu_render_options, turbidity, "turbidity", "T", 1.5, 10.0,
              "use the analytic sky: 1.5 (very clear) to 10 (hazy)"),
    MASU_OWN("exposure", "E", read_exposure,
             "factor before the tone curve, or auto for auto-exposure, or fixed for the\n"
             "scene's factor without auto-exposure (default: the scene's)"),
    MASU_CHOICE(masu_render_options, tone, "tone", "CURVE", tones,
                "tone curve: none, aces (filmic), neutral; auto is aces"),
    MASU_REAL(masu_render_options, bloom, "bloom", "SHARE", 0.0, 1.0,
              "fraction of the light that the lens scatters; 0.03 to 0.15 are usual (default 0)"),
    MASU_REAL(masu_render_options, aperture, "aperture", "METRES", 0.0, 1e6,
              "diameter of the lens, for depth of field (default 0: everything is sharp)"),
    MASU_REAL(masu_render_options, focus, "focus", "METRES", 1e-6, 1e9,
              "distance of the sharp plane, with --aperture"),
    MASU_REAL(masu_render_options, vignette, "vignette", "SHARE", 0.0, 1.0,
              "darken the corners by this fraction (default 0)"),
    MASU_REAL(masu_render_options, brightness, "brightness", "STOPS", -8.0, 8.0,
              "double the displayed light per stop, after the tone curve (default 0)"),
    MASU_REAL(masu_render_options, gamma, "gamma", "G", 0.1, 10.0,
              "exponent 1/G of the displayed values (default 1)"),
    MASU_FILE(masu_render_options, lut_path, "lut", "FILE.cube",
              "colour table of up to 33 points per axis, after all of these"),
    MASU_FLAG(masu_render_options, dither, "dither", "dither to 8 bits to avoid banding"),
    MASU_HEADING("Debugging"),
    MASU_FLAG(masu_render_options, poison, "poison",
              "fill transient images with NaN before each frame; the output must not\n"
              "change"),
    MASU_FLAG(masu_render_options, split, "split-memory",
              "use one memory block per role, even on unified memory"),
    MASU_FLAG(masu_render_options, casters, "casters",
              "also cull for the sun, for the counts of --stats"),
    MASU_HEADING("Device"),
    MASU_RAYS_ROW(masu_render_options, ray_way),
    MASU_UINT(masu_render_options, d.desc.frames_in_flight, "frames-in-flight", 1, MASU_MAX_FLIGHT,
              "frames recorded ahead of the GPU: 1 to 3 (default 2)"),
    MASU_DEVICE_ROWS(masu_render_options, d.host),
    {.name = NULL}};

/* Checks combinations and missing options; returns an exit code. */
static int check(const masu_render_options *o, const masu_given *given) {
    /* Options that conflict with --truth, which sets them itself. */
    static const char *const decided[] = {"stats", "rung",       "setting", "aa",
                                          "cull",  "lod-error",  "ladder",  "target-ms",
                                          "times", "anisotropy", NULL};
    static const char *const choosing[] = {"ladder", "target-ms", NULL};
    const char *own = masu_first_given(given, rows, decided);
    if (o->positions && own)
        return masu_cli_usage_error(
            "--truth cannot be combined with --%s: it uses the most exact settings", own);
    if (masu_is_given(given, rows, "frame") && masu_is_given(given, rows, "frames"))
        return masu_cli_usage_error(
            "--frame cannot be combined with --frames: it renders one frame");
    if (o->video && !masu_is_given(given, rows, "frames"))
        return masu_cli_usage_error("--video needs --frames");
    if (o->video && !(o->time_step > 0.0))
        return masu_cli_usage_error("--video needs a --time-step above 0");
    const char *choice = masu_first_given(given, rows, choosing);
    if (masu_is_given(given, rows, "setting") && choice)
        return masu_cli_usage_error("--setting cannot be combined with --%s: it renders one rung",
                                    choice);
    if (!given->count) return masu_cli_usage_error("no scene given: expected SCENE.masu");
    if (!o->output && !o->video && !o->stats && !o->times && !(o->target_ms > 0.0))
        return masu_cli_usage_error(
            "expected at least one of --output, --video, --stats, --times, --target-ms");
    if (o->target_ms > 0.0 && o->rays)
        return masu_cli_usage_error("--target-ms and --reference cannot be combined");
    if (o->positions && !o->output && !o->video)
        return masu_cli_usage_error("--truth needs --output or --video");
    return MASU_CLI_OK;
}

/* Builds the renderer's description from the options; returns an exit code. */
static int describe(masu_render_options *o, const masu_given *given) {
    masu_desc *d = &o->d.desc;
    o->d.scene_path = given->arguments[0];
    o->turned.cull_given = masu_is_given(given, rows, "cull");
    o->turned.aa_given = masu_is_given(given, rows, "aa");
    o->turned.lod_given = masu_is_given(given, rows, "lod-error");
    static const char *const raw[] = {"frame",     "frames",    "stats", "times",
                                      "target-ms", "reference", "truth", NULL};
    static const char *const own_rung[] = {"setting", "rung",      "ladder", "target-ms",
                                           "aa",      "reference", "truth",  NULL};
    o->still = o->output && !masu_first_given(given, rows, raw);
    if ((o->still || o->video) && !masu_first_given(given, rows, own_rung)) {
        d->rung_count = 1;
        d->rungs[0].temporal = MASU_ON;
    }
    d->tone = (masu_tone)o->tone;
    d->analytic_sky = o->turbidity > 0.0;
    d->vulkan.max_anisotropy = o->anisotropy > 0.0 ? (float)o->anisotropy : -1.0f;
    if (o->dither || o->still || o->video) d->dither = MASU_ON;
    if (o->output && masu_image_is_linear(o->output)) d->readback = MASU_READBACK_HDR;
    if (o->split) d->deny.unified_memory = 1;
    d->debug = (masu_debug){.timestamps = o->stats != NULL,
                            .counters = o->stats != NULL || o->rays,
                            .poison = o->poison,
                            .casters = o->casters,
                            .reference = o->rays != 0};
    masu_use_rays(o->ray_way, &d->ray_query, &o->d.host);
    if (o->target_ms > 0.0) {
        bool fixed = masu_is_given(given, rows, "rung");
        d->governor = (masu_governor_desc){.mode = fixed ? MASU_GOVERNOR_FIXED : MASU_GOVERNOR_ON,
                                           .target_ms = (float)o->target_ms,
                                           .rung = o->rung};
    }
    int code = masu_use_ladder(o->ladder, d);
    if (!code && d->ladder == MASU_OFF && o->target_ms > 0.0 && !d->rung_count) make_ladder(d);
    return code;
}

static int run(masu_cli *cli) {
    static masu_session s;
    masu_render_options o = {
        .d = {.desc = {.output = {1920, 1080}, .targets = {.storage = 1}},
              .host = {.message = masu_print_message}},
        .frames = 1,
        .focus = 10.0,
        .time_step = 1.0 / 60.0};
    masu_given given = {.most = 1, .excess = "expected one scene"};
    masu_vk_alloc_counts counts;
    VkAllocationCallbacks allocator = masu_vk_alloc_callbacks(&counts);
    char error[1024];
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    code = check(&o, &given);
    if (!code) code = describe(&o, &given);
    if (code) return code;
    if ((o.stats || o.times || o.target_ms > 0.0) && !masu_clock_advances())
        return masu_cli_error("%s", MASU_CLOCK_STOPPED);
    if (!masu_render_read_scene(&o, error, sizeof error) ||
        !masu_render_read_post(&o, error, sizeof error))
        return masu_cli_error("%s", error);
    o.d.host.allocator = o.stats ? &allocator : NULL;
    masu_cli_progress("building pipelines");
    if (o.positions && !masu_picture_open(&o.d, o.positions, &s, error, sizeof error))
        return masu_cli_error("%s", error);
    if (!o.positions && !open_rungs(&o, &s, &code)) return code;
    if (!masu_cli_quiet()) {
        masu_cli_progress_clear();
        fprintf(stderr, "masu: %s\n", s.host.driver);
    }
    bool set = masu_render_set_lut(&s, &o, error, sizeof error);
    free(o.lut);
    masu_video video = {0};
    code = set ? MASU_CLI_OK : masu_cli_error("%s", error);
    if (!code && o.video &&
        !masu_video_open(&video, o.video, o.d.desc.output.width, o.d.desc.output.height,
                         o.time_step, error, sizeof error))
        code = masu_cli_error("%s", error);
    if (!code)
        code = o.positions ? render_truth(&s, &o, &video)
               : o.still   ? render_still(&s, &o, &counts)
                           : render_frames(&s, &o, &video, &counts);
    if (!masu_video_close(&video, error, sizeof error) && !code) code = masu_cli_error("%s", error);
    code = masu_finish_validation(&s.host, code);
    masu_session_close(&s);
    return code;
}

const masu_cli_command masu_cmd_render = {
    .name = "render",
    .arguments = "SCENE.masu -o OUT.png|OUT.pfm|OUT.exr [options]",
    .summary = "render a baked scene to an image",
    .details =
        "Without --frame, --frames, --truth, --reference, --stats, --times or --target-ms the image is the\n"
        "settled still: frames of one moment, with temporal anti-aliasing if no rung is chosen, until an\n"
        "image of 16 frames or more changes by less than 0.25 of 255, or 64 frames. It is dithered.\n\n"
        "With --stats, an extra first frame is rendered and not counted. Wall time is measured from\n"
        "masu_frame to the fence. GPU times are timestamps with a full barrier around each pass;\n"
        "\"timestamps_plausible\" reports whether they agree with the wall time.\n\n"
        "Exit codes:\n"
        "  0  success\n"
        "  1  rendering failed, a file could not be read or written, or --validate reported a message\n"
        "  2  the command line is wrong\n\n"
        "Examples:\n"
        "  masu render engine.masu -o still.png --size 1280x720\n"
        "  masu render engine.masu -o frame.exr --frame=30\n"
        "  masu render engine.masu --frames 300 --video - | ffmpeg -i - engine.mp4\n"
        "  masu render engine.masu -o frame.png --setting scale=0.5+aa=fxaa\n"
        "  masu render engine.masu --target-ms 33 --frames 300 --size 640x360\n",
    .run = run};
