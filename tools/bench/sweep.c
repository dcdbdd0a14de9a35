/* sweep.c: see sweep.h. */
#include "bench/sweep.h"

#include "bench/against.h"
#include "bench/depth.h"
#include "bench/machine.h"
#include "measure/motion.h"
#include "measure/picture.h"
#include "bench/radiance.h"
#include "bench/sweep_files.h"
#include "scene/blob.h"
#include "clock.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* SETTLE: static frames before flicker is measured over FLICKER differences; FAST: frames of fast
 * motion; WARM: untimed frames before samples. */
enum {
    SETTLE_FRAMES = 24,
    FLICKER_FRAMES = 8,
    FAST_FRAMES = 8,
    WARM_FRAMES = 2,
    BATCH = MASU_MAX_RUNGS - 1
};

typedef struct sweep {
    const masu_sweep_desc *d;
    masu_sweep_result *out;
    masu_session s;
    masu_motion motion;
    masu_depth_bench *depth; /* NULL: the scene has no surfaces */
    masu_radiance_bench *radiance;
    bool opened, surfaces, depth_truth;
    masu_setting settings[MASU_SETTINGS_MOST];
    uint64_t bytes[MASU_SETTINGS_MOST];
    uint32_t setting_count, pixels;
    uint8_t *truth, *before;
    float *map, *true_radiance; /* of the ground truth, 3 floats per pixel */
    masu_samples samples[MASU_MAX_RUNGS];
    uint64_t hash, start;
    uint32_t pending; /* still to be measured when the run began */
    char driver[1024], build[17];
    int lock; /* of the folder, an open file; -1: none */
    char *error;
    size_t error_size;
} sweep;

static bool failed(sweep *w, const char *text) {
    snprintf(w->error, w->error_size, "%s: %s", w->d->scene_path, text);
    return false;
}

static masu_session_desc session_of(const sweep *w) {
    return masu_picture_session(w->d->scene_path, w->d->size, &w->d->host);
}

static void close_session(sweep *w) {
    if (!w->opened) return;
    masu_session_close(&w->s);
    w->out->messages += w->s.host.messages;
    w->opened = false;
}

/* ---- Settings -------------------------------------------------------------------------------- */

static bool plan_of(sweep *w, const masu_rung *rung, masu_plan_info *plan) {
    masu_desc d = w->s.desc;
    d.rung_count = 1;
    d.rungs[0] = *rung;
    return masu_plan(&d, plan, &w->s.detail) == MASU_OK;
}

/* Plans are kept for comparison with parents: 160 of a few kilobytes. */
static bool fit_settings(sweep *w, masu_plan_info *plans) {
    if (!plan_of(w, &w->settings[0].rung, &plans[0])) return failed(w, w->s.detail.text);
    masu_settings_fit(w->settings, w->setting_count, &w->s.scene, &plans[0]);
    for (uint32_t i = 0; i < w->setting_count; i++) {
        masu_setting *s = &w->settings[i];
        if (s->dropped[0]) continue;
        if (!plan_of(w, &s->rung, &plans[i])) {
            snprintf(s->dropped, sizeof s->dropped, "%.150s", w->s.detail.text);
            continue;
        }
        w->bytes[i] = plans[i].memory.device_bytes;
        for (uint32_t k = 0; k < i && s->structural; k++) {
            if (!strcmp(w->settings[k].id, s->parent) && !w->settings[k].dropped[0] &&
                masu_settings_same_plan(&plans[k], &plans[i])) {
                snprintf(s->dropped, sizeof s->dropped, "same passes and bytes as its parent");
            }
        }
        w->settings[i].structural = 0; /* resolved */
    }
    return true;
}

static bool plan_settings(sweep *w) {
    masu_session_desc d = session_of(w);
    d.no_renderer = true;
    if (!masu_session_open(&d, &w->s, w->error, w->error_size)) return false;
    w->opened = true;
    masu_blob_header header;
    memcpy(&header, w->s.blob, sizeof header);
    w->hash = header.hash;
    w->motion =
        (masu_motion){w->d->time, MASU_MOTION_STEP, w->d->frames,
                      (masu_scene_features(&w->s.scene) & MASU_SCENE_HAS_REFLECTIONS) ||
                          (masu_scene_features(&w->s.scene) & MASU_SCENE_HAS_METERED_EXPOSURE)};
    w->surfaces = (masu_scene_features(&w->s.scene) & MASU_SCENE_HAS_SDF) ||
                  masu_scene_count(&w->s.scene, MASU_SCENE_INSTANCE);
    w->depth_truth = masu_depth_has_truth(w->d->scene_path, &w->s.scene);
    snprintf(w->driver, sizeof w->driver, "%s", w->s.host.driver);
    w->setting_count = masu_settings_make(w->d->quick, w->settings);
    masu_plan_info *plans = calloc(w->setting_count, sizeof *plans);
    bool good = plans ? fit_settings(w, plans) : failed(w, "out of memory");
    free(plans);
    close_session(w);
    for (uint32_t i = 0; i < w->setting_count; i++) {
        w->out->dropped += w->settings[i].dropped[0] != 0;
        w->out->settings += !w->settings[i].dropped[0];
    }
    return good;
}

/* ---- Ground truth ---------------------------------------------------------------------------- */

static bool draw_truth(sweep *w, uint8_t *rgba) {
    masu_session_desc d = session_of(w);
    if (!masu_picture_open(&d, w->d->positions, &w->s, w->error, w->error_size)) return false;
    w->opened = true;
    masu_frame_desc frame = {.time = w->d->time};
    const masu_picture_means means = {.linear = w->true_radiance, .display = rgba};
    bool good = masu_picture_truth(&w->s, &frame, w->d->positions, w->d->rays, &means,
                                   w->d->progress, w->error, w->error_size);
    close_session(w);
    return good;
}

/* Files of the ground truth: TRUTH.png, TRUTH.pfm, TRUTH.specular.pfm. */
static bool beside(const char *picture, const char *suffix, char out[4096]) {
    size_t n = strlen(picture);
    if (n > 4 && !strcmp(picture + n - 4, ".png")) n -= 4;
    return snprintf(out, 4096, "%.*s%s", (int)n, picture, suffix) < 4096;
}

static bool load_radiance(sweep *w, const char *path) {
    struct masu_image image;
    VkExtent2D size = w->d->size;
    if (!masu_image_load_pfm(path, &image, w->error, w->error_size)) return false;
    bool fits = image.width == size.width && image.height == size.height && image.channels == 3;
    if (fits) memcpy(w->true_radiance, image.values, 3 * sizeof(float) * w->pixels);
    masu_image_free(&image);
    return fits || failed(w, "the ground truth's radiance has another size");
}

/* Reads both files, or renders both. An existing image is never overwritten. */
static bool read_or_draw(sweep *w, const char *picture, const char *radiance) {
    VkExtent2D size = w->d->size;
    bool there = masu_file_exists(picture);
    if (there && masu_file_exists(radiance)) {
        return masu_picture_load(picture, size, w->truth, w->error, w->error_size) &&
               load_radiance(w, radiance);
    }
    return draw_truth(w, w->truth) &&
           (there ? masu_picture_load(picture, size, w->truth, w->error, w->error_size)
                  : masu_image_save_png(picture, w->truth, size.width, size.height, 0, w->error,
                                        w->error_size)) &&
           masu_image_save_pfm(radiance, w->true_radiance, size.width, size.height, 3, w->error,
                               w->error_size);
}

/* The report needs a copy of the ground truth in the folder. */
static bool find_truth(sweep *w) {
    char own[4096], radiance[4096];
    VkExtent2D size = w->d->size;
    if (!masu_sweep_path(w->d->folder, "truth.png", own)) return failed(w, "the path is too long");
    const char *from = w->d->truth_path ? w->d->truth_path : own;
    if (!beside(from, ".pfm", radiance)) return failed(w, "the path is too long");
    return read_or_draw(w, from, radiance) &&
           (from == own || masu_image_save_png(own, w->truth, size.width, size.height, 0, w->error,
                                               w->error_size));
}

/* ---- Images ---------------------------------------------------------------------------------- */

static bool draw(sweep *w, uint32_t rung, bool cut, masu_commands *commands) {
    return masu_motion_frame(&w->s, rung, w->d->time, MASU_MOTION_STEP, cut, commands, w->error,
                             w->error_size);
}

static bool read_back(sweep *w) {
    return masu_headless_target_read(&w->s.host, &w->s.targets[0], w->error, w->error_size);
}

/* Whether the image of a setting depends on previous frames. */
static bool remembers(const sweep *w, const masu_rung *rung) {
    return w->motion.remembers || masu_setting_remembers(rung);
}

/* With cascades that are not rendered in every frame, static and moving images differ too. */
static bool depends_on_motion(const sweep *w, const masu_rung *rung) {
    return remembers(w, rung) || masu_setting_period(rung) > 1;
}

/* Mean absolute difference of successive static frames, of 255. */
static bool flicker(sweep *w, uint32_t rung, const masu_setting *s, uint64_t *next, double *out) {
    const bool depends = depends_on_motion(w, &s->rung);
    uint32_t settle = depends ? SETTLE_FRAMES : 1, frames = depends ? FLICKER_FRAMES : 1;
    size_t bytes = 4 * (size_t)w->pixels;
    masu_commands commands;
    double sum = 0.0;
    for (uint32_t k = 0; k < settle; k++) {
        if (!draw(w, rung, false, &commands)) return false;
    }
    if (!read_back(w)) return false;
    memcpy(w->before, w->s.targets[0].mapped, bytes);
    for (uint32_t k = 0; k < frames; k++) {
        if (!draw(w, rung, false, &commands) || !read_back(w)) return false;
        const uint8_t *shown = w->s.targets[0].mapped;
        sum += masu_metric_difference(shown, w->before, w->d->size.width, w->d->size.height);
        memcpy(w->before, shown, bytes);
    }
    *next = commands.frame + 1;
    *out = sum / frames;
    return true;
}

static bool find_flip(sweep *w, const uint8_t *shown, masu_flip *flip) {
    return masu_metric_flip(w->truth, shown, w->d->size.width, w->d->size.height, 0, w->map,
                            flip) ||
           failed(w, "out of memory");
}

static bool compare(sweep *w, uint32_t rung, const masu_setting *s, uint64_t *next, masu_row *row) {
    VkExtent2D size = w->d->size;
    masu_flip flip;
    char path[4096];
    if (!masu_motion_draw(&w->s, &w->motion, rung, &s->rung, next, w->error, w->error_size) ||
        !read_back(w)) {
        return false;
    }
    const uint8_t *shown = w->s.targets[0].mapped;
    if (!find_flip(w, shown, &flip)) return false;
    double rmse = masu_metric_rmse(w->truth, shown, size.width, size.height);
    row->rmse = 255.0 * rmse;
    row->psnr_db = masu_metric_psnr(rmse);
    row->ssim = masu_metric_ssim(w->truth, shown, size.width, size.height);
    row->flip = flip.mean;
    row->flip_p99 = flip.p99;
    row->rest_flip = row->fast_flip = flip.mean;
    if (!masu_sweep_picture(w->d->folder, s->id, "", path))
        return failed(w, "the path is too long");
    if (!masu_image_save_png(path, shown, size.width, size.height, 0, w->error, w->error_size) ||
        !flicker(w, rung, s, next, &row->flicker))
        return false;
    if (!depends_on_motion(w, &s->rung)) return true;
    if (!find_flip(w, w->before, &flip)) return false;
    row->rest_flip = flip.mean;
    if (!masu_sweep_picture(w->d->folder, s->id, MASU_SWEEP_REST, path) ||
        !masu_image_save_png(path, w->before, size.width, size.height, 0, w->error, w->error_size))
        return false;
    const masu_motion fast = {w->d->time, 1.0 / 8.0, FAST_FRAMES, w->motion.remembers};
    if (!masu_motion_draw(&w->s, &fast, rung, &s->rung, next, w->error, w->error_size) ||
        !read_back(w) || !find_flip(w, shown, &flip))
        return false;
    row->fast_flip = flip.mean;
    return true;
}

/* ---- Times ----------------------------------------------------------------------------------- */

static bool sample(sweep *w, uint32_t rung, const masu_rung *knobs, bool kept) {
    uint32_t period = masu_setting_period(knobs);
    uint32_t warm = remembers(w, knobs) ? WARM_FRAMES : period > 1 ? 1 : 0;
    double wall = 0.0, gpu = 0.0;
    masu_commands commands;
    masu_stats_info stats;
    for (uint32_t k = 0; k < warm; k++) {
        if (!draw(w, rung, k == 0, &commands)) return false;
    }
    for (uint32_t k = 0; k < period; k++) {
        uint64_t start = masu_clock_ns(NULL);
        if (!draw(w, rung, !warm, &commands)) return false;
        wall += (double)(masu_clock_ns(NULL) - start) / 1e6;
        if (!masu_stats(w->s.m, commands.slot, &stats, NULL) && stats.timed)
            gpu += (double)stats.gpu_ns / 1e6;
    }
    if (kept) masu_samples_add(&w->samples[rung], wall, gpu, period);
    return true;
}

static void times(const masu_samples *base, const masu_samples *s, masu_row *row) {
    row->wall_min = s->wall[0];
    row->wall_p50 = masu_samples_at(s->wall, s->count, 0.5);
    row->wall_p95 = masu_samples_at(s->wall, s->count, 0.95);
    row->wall_p99 = masu_samples_at(s->wall, s->count, 0.99);
    row->gpu_min = s->gpu[0];
    row->gpu_p50 = masu_samples_at(s->gpu, s->count, 0.5);
    row->plausible = (double)s->plausible / s->count;
    row->base_wall_min = base->wall[0];
    row->base_gpu_min = base->gpu[0];
    row->least_ratio = s->wall[0] / base->wall[0];
    row->gpu_least_ratio = base->gpu[0] > 0.0 ? s->gpu[0] / base->gpu[0] : (double)NAN;
}

/* ---- Batches --------------------------------------------------------------------------------- */

/* Rung 0 is the base; it only gets a row if it is one of the requested settings. */
typedef struct batch {
    uint32_t of[MASU_MAX_RUNGS]; /* settings; [0] is 0 */
    uint32_t count;
    bool base_too;
    masu_row rows[MASU_MAX_RUNGS];
} batch;

static void say(sweep *w, const char *what) {
    uint32_t done = w->out->measured, left = w->pending - done;
    double seconds = (double)(masu_clock_ns(NULL) - w->start) / 1e9;
    char text[MASU_SETTING_ID + 128];
    if (!w->d->progress) return;
    if (done) {
        snprintf(text, sizeof text, "%u of %u settings measured, about %.0f s left; %s", done,
                 w->pending, seconds / done * left, what);
    } else {
        snprintf(text, sizeof text, "%u settings to measure; %s", left, what);
    }
    w->d->progress(text);
}

static bool open_batch(sweep *w, const batch *b) {
    masu_session_desc d = session_of(w);
    d.desc.debug.timestamps = 1;
    d.desc.rung_count = b->count;
    for (uint32_t k = 0; k < b->count; k++) d.desc.rungs[k] = w->settings[b->of[k]].rung;
    say(w, "building pipelines");
    w->opened = masu_session_open(&d, &w->s, w->error, w->error_size);
    return w->opened;
}

static bool draw_batch(sweep *w, batch *b) {
    masu_plan_info plan;
    uint64_t next = 0;
    masu_plan_of(w->s.m, &plan);
    for (uint32_t k = 0; k < b->count; k++) {
        const masu_setting *s = &w->settings[b->of[k]];
        masu_row *row = &b->rows[k];
        memset(row, 0, sizeof *row);
        snprintf(row->setting, sizeof row->setting, "%s", s->id);
        snprintf(row->parent, sizeof row->parent, "%s", s->parent);
        snprintf(row->technique, sizeof row->technique, "%s", s->technique);
        row->render_width = plan.rungs[k].render_width;
        row->render_height = plan.rungs[k].render_height;
        row->passes = plan.rungs[k].dispatches;
        row->device_bytes = (double)w->bytes[b->of[k]];
        if ((!k && !b->base_too) || remembers(w, &s->rung)) continue;
        say(w, s->id);
        if (!compare(w, k, s, &next, row)) return false;
    }
    return true;
}

/* The noise of reflections and the jitter of rung.temporal depend on the frame number. So each
 * image gets a separate renderer: settings then differ only by their knobs, and a row does not
 * depend on its batch, shard or resumed run. */
static bool draw_alone(sweep *w, batch *b) {
    for (uint32_t k = b->base_too ? 0 : 1; k < b->count; k++) {
        const batch one = {.of = {b->of[k]}, .count = 1};
        const masu_setting *s = &w->settings[b->of[k]];
        if (!remembers(w, &s->rung)) continue;
        uint64_t next = 0;
        bool good = open_batch(w, &one);
        if (good) say(w, s->id);
        good = good && compare(w, 0, s, &next, &b->rows[k]);
        close_session(w);
        if (!good) return false;
    }
    return true;
}

/* At least the requested number of rounds, and more until `seconds` have passed. */
static bool time_batch(sweep *w, batch *b, double seconds) {
    uint64_t start = masu_clock_ns(NULL);
    double gone = 0.0;
    for (uint32_t k = 0; k < b->count; k++) w->samples[k].count = w->samples[k].plausible = 0;
    for (uint32_t run = 0; run <= w->d->runs || (gone < seconds && run <= MASU_SWEEP_RUNS_MAX);
         run++) {
        char text[64];
        snprintf(text, sizeof text, "timing, run %u of %s%u", run, seconds > 0.0 ? "at least " : "",
                 w->d->runs);
        say(w, text);
        for (uint32_t k = 0; k < b->count; k++) {
            if (!sample(w, k, &w->settings[b->of[k]].rung, run > 0)) return false;
        }
        gone = (double)(masu_clock_ns(NULL) - start) / 1e9;
    }
    for (uint32_t k = 0; k < b->count; k++) {
        const masu_samples *base = &w->samples[0], *own = &w->samples[k];
        b->rows[k].ratio = masu_samples_ratio(base->wall, own->wall, own->count);
        b->rows[k].gpu_ratio = masu_samples_ratio(base->gpu, own->gpu, own->count);
    }
    for (uint32_t k = 0; k < b->count; k++) masu_samples_sort(&w->samples[k]);
    for (uint32_t k = 0; k < b->count; k++) times(&w->samples[0], &w->samples[k], &b->rows[k]);
    return true;
}

/* Separate sessions: timed renderers have no images for readback. */
static bool look_behind(sweep *w, batch *b) {
    masu_rung rungs[MASU_MAX_RUNGS];
    masu_depth_error depth[MASU_MAX_RUNGS];
    masu_radiance_error radiance[MASU_MAX_RUNGS];
    for (uint32_t k = 0; k < b->count; k++) {
        rungs[k] = w->settings[b->of[k]].rung;
        depth[k] = (masu_depth_error){(double)NAN, (double)NAN, (double)NAN};
    }
    say(w, "surfaces");
    if (w->depth &&
        !masu_depth_measure(w->depth, rungs, b->count, depth, w->error, w->error_size)) {
        return false;
    }
    say(w, "radiance");
    if (!masu_radiance_measure(w->radiance, rungs, b->count, radiance, w->error, w->error_size))
        return false;
    for (uint32_t k = 0; k < b->count; k++) {
        b->rows[k].hitmiss_pct = depth[k].hitmiss_pct;
        b->rows[k].depth_mean_px = depth[k].mean_px;
        b->rows[k].depth_p99_px = depth[k].p99_px;
        b->rows[k].hdr_flip = radiance[k].hdr_flip;
        b->rows[k].specular_relmse = radiance[k].specular_relmse;
    }
    return true;
}

/* Written once, by runs that add rows. */
static bool note_machine(sweep *w) {
    masu_machine machine;
    if (w->out->measured) return true;
    masu_machine_here(w->driver, &machine);
    return masu_machine_append(w->d->folder, &machine, w->error, w->error_size);
}

static bool run_batch(sweep *w, batch *b) {
    bool good = open_batch(w, b) && draw_batch(w, b) && time_batch(w, b, 0.0);
    close_session(w);
    good = good && draw_alone(w, b) && look_behind(w, b);
    good = good && note_machine(w);
    for (uint32_t k = b->base_too ? 0 : 1; k < b->count && good; k++) {
        memcpy(b->rows[k].build, w->build, sizeof w->build);
        good = masu_sweep_append(w->d->folder, MASU_SWEEP_RESULTS, &b->rows[k], w->error,
                                 w->error_size);
        w->out->measured += good;
    }
    return good;
}

static bool listed(const masu_setting_list *list, const char *id) {
    for (uint32_t i = 0; i < list->count; i++) {
        if (!strcmp(list->id[i], id)) return true;
    }
    return false;
}

/* The base is always measured: the flicker of other settings is compared with it. */
static bool asked_for(const masu_setting_list *only, uint32_t number, const char *id) {
    return !only || !only->count || !number || listed(only, id);
}

/* Shards divide the measured settings by number; the base belongs to the first shard. */
static uint32_t mine(const sweep *w, const masu_row *rows, uint32_t count, uint32_t *list) {
    uint32_t n = 0, number = 0;
    for (uint32_t i = 0; i < w->setting_count; i++) {
        if (w->settings[i].dropped[0] || !asked_for(w->d->only, i, w->settings[i].id)) continue;
        if (number++ % w->d->shards != w->d->shard) continue;
        if (masu_rows_find(rows, count, w->settings[i].id)) {
            w->out->there++;
        } else {
            list[n++] = i;
        }
    }
    return n;
}

static bool open_behind(sweep *w) {
    const masu_session_desc d = session_of(w);
    char own[4096], reflections[4096];
    const char *from = w->d->truth_path ? w->d->truth_path : own;
    if (!masu_sweep_path(w->d->folder, "truth.png", own) ||
        !beside(from, ".specular.pfm", reflections)) {
        return failed(w, "the path is too long");
    }
    const masu_radiance_desc radiance = {.session = d,
                                         .motion = w->motion,
                                         .truth = w->true_radiance,
                                         .reflections = reflections,
                                         .rays = w->d->rays,
                                         .progress = w->d->progress};
    w->radiance = masu_radiance_open(&radiance, w->error, w->error_size);
    if (w->radiance && w->surfaces)
        w->depth = masu_depth_open(&d, w->d->time, w->depth_truth, w->error, w->error_size);
    return w->radiance && (!w->surfaces || w->depth);
}

static void close_behind(sweep *w) {
    if (w->depth) w->out->messages += masu_depth_messages(w->depth);
    if (w->radiance) w->out->messages += masu_radiance_messages(w->radiance);
    masu_depth_close(w->depth);
    masu_radiance_close(w->radiance);
}

static bool known(sweep *w) {
    const masu_setting_list *only = w->d->only;
    char text[MASU_SETTING_ID + 256];
    for (uint32_t i = 0; only && i < only->count; i++) {
        const char *why = "unknown setting, or omitted by --quick";
        bool there = false;
        for (uint32_t k = 0; k < w->setting_count && !there; k++) {
            if (strcmp(w->settings[k].id, only->id[i]) != 0) continue;
            there = !w->settings[k].dropped[0];
            why = w->settings[k].dropped;
        }
        snprintf(text, sizeof text, "%s is not a setting of this sweep: %.200s", only->id[i], why);
        if (!there) return failed(w, text);
    }
    return true;
}

/* Checked before the work, which takes minutes. */
static bool alike(sweep *w) {
    return !w->d->like ||
           masu_against_same(w->d->like, w->d->folder, w->error, w->error_size);
}

static bool measure(sweep *w) {
    static batch b;
    uint32_t list[MASU_SETTINGS_MOST], count = 0;
    masu_row *rows = masu_sweep_resume(w->d->folder, &count, w->error, w->error_size);
    if (!rows) return false;
    if (!count) masu_machine_forget(w->d->folder);
    w->pending = mine(w, rows, count, list);
    bool alone = !w->pending ||
                 masu_sweep_one_build(rows, count, w->build, w->d->folder, w->error, w->error_size);
    free(rows);
    if (!w->pending || !alone) return alone;
    if (!find_truth(w) || !open_behind(w)) return false;
    w->start = masu_clock_ns(NULL);
    for (uint32_t i = 0; i < w->pending;) {
        b.base_too = list[i] == 0;
        i += b.base_too;
        b.of[0] = 0;
        for (b.count = 1; b.count <= BATCH && i < w->pending; i++) b.of[b.count++] = list[i];
        if (!run_batch(w, &b)) return false;
    }
    return true;
}

/* ---- Rungs again ----------------------------------------------------------------------------- */

/* Settings of the list that have a row but none in steady.csv, by number. */
static uint32_t unsteady(const sweep *w, const masu_setting_list *list, const masu_row *rows,
                         uint32_t count, const masu_row *there, uint32_t there_count,
                         uint32_t *out) {
    uint32_t n = 0;
    for (uint32_t i = 1; i < w->setting_count; i++) {
        const char *id = w->settings[i].id;
        if (w->settings[i].dropped[0]) continue; /* another setting may have its name */
        if (listed(list, id) && masu_rows_find(rows, count, id) &&
            !masu_rows_find(there, there_count, id)) {
            out[n++] = i;
        }
    }
    return n;
}

static bool steady_batch(sweep *w, batch *b, const masu_row *rows, uint32_t count) {
    for (uint32_t k = 0; k < b->count; k++) {
        const masu_row *row = masu_rows_find(rows, count, w->settings[b->of[k]].id);
        if (row) b->rows[k] = *row;
    }
    bool good = open_batch(w, b) && time_batch(w, b, w->d->steady);
    close_session(w);
    good = good && note_machine(w);
    for (uint32_t k = 1; k < b->count && good; k++) {
        good = masu_sweep_append(w->d->folder, MASU_SWEEP_STEADY, &b->rows[k], w->error,
                                 w->error_size);
        w->out->measured += good;
    }
    return good;
}

static bool steady(sweep *w, const masu_setting_list *list) {
    static batch b;
    uint32_t of[MASU_SETTINGS_MOST], count = 0, there_count = 0;
    masu_row *rows = masu_sweep_rows(w->d->folder, &count, w->error, w->error_size);
    masu_row *there =
        masu_sweep_steady_rows(w->d->folder, &there_count, w->error, w->error_size);
    bool good = rows && there;
    w->pending = good ? unsteady(w, list, rows, count, there, there_count, of) : 0;
    good = good && (!w->pending || masu_sweep_one_build(rows, count, w->build, w->d->folder,
                                                        w->error, w->error_size));
    w->start = masu_clock_ns(NULL);
    for (uint32_t i = 0; i < w->pending && good;) {
        b.of[0] = 0;
        for (b.count = 1; b.count <= BATCH && i < w->pending; i++) b.of[b.count++] = of[i];
        good = steady_batch(w, &b, rows, count);
    }
    free(rows);
    free(there);
    return good;
}

/* ---- Whole ----------------------------------------------------------------------------------- */

static void begin(sweep *w, const masu_sweep_desc *desc, masu_sweep_result *out, char *error,
                  size_t error_size) {
    memset(w, 0, sizeof *w);
    memset(out, 0, sizeof *out);
    w->d = desc;
    w->out = out;
    w->error = error;
    w->error_size = error_size;
    w->pixels = desc->size.width * desc->size.height;
    w->lock = -1;
    masu_machine_build(w->build);
}

static bool end(sweep *w, bool good) {
    if (w->lock >= 0) (void)close(w->lock);
    w->lock = -1;
    return good;
}

static bool begin_folder(sweep *w) {
    w->lock = masu_sweep_lock(w->d->folder, w->error, w->error_size);
    if (w->lock < 0) return false;
    const masu_sweep_about about = {.driver = w->driver,
                                    .depth = !w->surfaces     ? "nothing (no surfaces)"
                                             : w->depth_truth ? "the field in double precision"
                                                              : "the most exact rung",
                                    .hash = w->hash,
                                    .settings = w->settings,
                                    .count = w->setting_count};
    return masu_sweep_begin(w->d, &about, w->error, w->error_size);
}

bool masu_sweep_steady(const masu_sweep_desc *desc, const masu_setting_list *list,
                       masu_sweep_result *out, char *error, size_t error_size) {
    static sweep w;
    begin(&w, desc, out, error, error_size);
    bool good = plan_settings(&w) && begin_folder(&w) && steady(&w, list);
    close_session(&w);
    return end(&w, good);
}

bool masu_sweep_run(const masu_sweep_desc *desc, masu_sweep_result *out, char *error,
                    size_t error_size) {
    static sweep w;
    begin(&w, desc, out, error, error_size);
    w.truth = malloc(4 * (size_t)w.pixels);
    w.before = malloc(4 * (size_t)w.pixels);
    w.map = malloc(sizeof *w.map * w.pixels);
    w.true_radiance = malloc(3 * sizeof *w.true_radiance * w.pixels);
    bool good = (w.truth && w.before && w.map && w.true_radiance) || failed(&w, "out of memory");
    good = good && plan_settings(&w);
    good = good && known(&w) && begin_folder(&w) && alike(&w) && measure(&w);
    close_behind(&w);
    close_session(&w);
    free(w.truth);
    free(w.before);
    free(w.map);
    free(w.true_radiance);
    return end(&w, good);
}
