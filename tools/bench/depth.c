/* depth.c: see depth.h. */
#include "bench/depth.h"

#include "measure/motion.h"
#include "bench/settings.h"
#include "measure/truth.h"
#include "image.h"
#include "metric/march.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JOBS_MOST = 2 * MASU_SETTINGS_MOST };

typedef struct result {
    masu_rung key;
    masu_depth_error error;
} result;

/* Distances along the rays; below 0: no hit; NaN: unknown. */
typedef struct reference {
    float scale;
    uint32_t width, height;
    double *t;
} reference;

struct masu_depth_bench {
    masu_session_desc d;
    double time;
    bool exact; /* use `truth` as reference */
    masu_truth truth;
    uint8_t *blob; /* sessions free theirs, but a view needs it */
    masu_scene scene;
    masu_session s;
    uint32_t messages, result_count, reference_count;
    result results[MASU_SETTINGS_MOST];
    reference references[MASU_SETTINGS_MOST];
    char *error;
    size_t error_size;
};

typedef struct job {
    masu_rung rung;
    bool is_reference;
} job;

static bool failed(masu_depth_bench *b, const char *text) {
    snprintf(b->error, b->error_size, "%s: %s", b->d.scene_path, text);
    return false;
}

/* Keeps the knobs that affect surfaces and sets the others to their cheapest value. All fields have
 * four bytes: a rung has no padding and can be compared by memcmp. */
static masu_rung key_of(const masu_rung *rung) {
    return (masu_rung){.scale = rung->scale,
                       .easu = MASU_EASU_BILINEAR,
                       .sharpen = MASU_OFF,
                       .ao = MASU_OFF,
                       .specular = MASU_OFF,
                       .shadow_cascades = 1,
                       .shadow_resolution = 64,
#ifdef MASU_LAB
                       .march = rung->march,
#endif
                       .march_steps = rung->march_steps,
                       .frustum = rung->frustum,
                       .occlusion = rung->occlusion,
                       .lod_error = rung->lod_error};
}

static masu_rung exact_of(float scale) {
    const masu_rung exact = {.scale = scale,
                             .march_steps = MASU_MARCH_STEPS_MAX,
                             .frustum = MASU_OFF,
                             .occlusion = MASU_OFF,
                             .lod_error = -1.0f};
    return key_of(&exact);
}

static const result *find_result(const masu_depth_bench *b, const masu_rung *key) {
    for (uint32_t i = 0; i < b->result_count; i++) {
        if (!memcmp(&b->results[i].key, key, sizeof *key)) return &b->results[i];
    }
    return NULL;
}

static const reference *find_reference(const masu_depth_bench *b, float scale) {
    for (uint32_t i = 0; i < b->reference_count; i++) {
        const reference *r = &b->references[i];
        if (!(r->scale < scale) && !(r->scale > scale)) return r;
    }
    return NULL;
}

/* ---- One frame ------------------------------------------------------------------------------- */

/* The view has the proportions of the output, independent of the rounding of the render size. */
static bool see(masu_depth_bench *b, uint32_t width, uint32_t height, masu_view *view) {
    VkExtent2D size = b->s.desc.output;
    masu_camera camera;
    if (masu_camera_at(b->s.m, b->time, &camera, NULL)) return failed(b, "the scene has no camera");
    bool good = b->exact ? masu_view_of(&b->scene, &camera, b->time, size.width, size.height, view,
                                        b->error, b->error_size)
                         : masu_view_seen(&b->scene, &camera, size.width, size.height, view,
                                          b->error, b->error_size);
    view->width = width;
    view->height = height;
    return good;
}

static reference *new_reference(masu_depth_bench *b, float scale, uint32_t width, uint32_t height) {
    double *t = malloc(sizeof *t * width * height);
    if (b->reference_count == MASU_SETTINGS_MOST || !t) {
        free(t);
        failed(b, "out of memory");
        return NULL;
    }
    reference *r = &b->references[b->reference_count++];
    *r = (reference){scale, width, height, t};
    return r;
}

static bool march_reference(masu_depth_bench *b, const masu_view *view, float scale) {
    size_t pixels = (size_t)view->width * view->height;
    reference *r = new_reference(b, scale, view->width, view->height);
    masu_truth_sample *samples = r ? malloc(pixels * sizeof *samples) : NULL;
    if (!samples) return failed(b, "out of memory");
    masu_truth_image(&b->truth, view, 1, samples);
    for (size_t i = 0; i < pixels; i++) {
        r->t[i] = samples[i].kind == MASU_TRUTH_HIT    ? samples[i].t
                  : samples[i].kind == MASU_TRUTH_MISS ? -1.0
                                                       : (double)NAN;
    }
    free(samples);
    return true;
}

/* Depth is near / view z. */
static double distance_at(const masu_readback_image *image, const masu_view *view,
                          const masu_view_ray *ray, uint32_t x, uint32_t y) {
    float depth;
    memcpy(&depth, (const uint8_t *)image->pixels + y * image->row_bytes + 4 * (size_t)x, 4);
    return depth > 0.0f ? view->near_distance * ray->z_scale / (double)depth : -1.0;
}

static bool keep(masu_depth_bench *b, const masu_readback_image *image, const masu_view *view,
                 float scale) {
    reference *r = new_reference(b, scale, image->width, image->height);
    if (!r) return false;
    for (uint32_t y = 0; y < r->height; y++) {
        for (uint32_t x = 0; x < r->width; x++) {
            masu_view_ray ray = masu_view_ray_at(view, x, y);
            r->t[(size_t)y * r->width + x] = distance_at(image, view, &ray, x, y);
        }
    }
    return true;
}

static bool compare(masu_depth_bench *b, const masu_readback_image *image, const masu_view *view,
                    const masu_rung *key) {
    masu_march_errors errors;
    uint64_t count = 0;
    if (b->exact && !find_reference(b, key->scale) && !march_reference(b, view, key->scale))
        return false;
    const reference *r = find_reference(b, key->scale);
    if (!r || r->width != image->width || r->height != image->height)
        return failed(b, "the reference has another size");
    masu_march_sample *samples = malloc(sizeof *samples * r->width * r->height);
    if (!samples) return failed(b, "out of memory");
    for (uint32_t y = 0; y < r->height; y++) {
        for (uint32_t x = 0; x < r->width; x++) {
            masu_view_ray ray = masu_view_ray_at(view, x, y);
            double truth = r->t[(size_t)y * r->width + x];
            if (isnan(truth)) continue;
            samples[count++] = (masu_march_sample){
                x, y, distance_at(image, view, &ray, x, y), truth, ray.pixel, 0.0};
        }
    }
    bool good = masu_march_errors_of(samples, count, &errors) || failed(b, "out of memory");
    free(samples);
    if (!good || b->result_count == MASU_SETTINGS_MOST) return good;
    b->results[b->result_count++] =
        (result){*key, {errors.hitmiss_pct, errors.depth_mean_px, errors.depth_p99_px}};
    return true;
}

/* ---- All settings ---------------------------------------------------------------------------- */

static bool draw_job(masu_depth_bench *b, const job *j, uint32_t rung) {
    masu_commands commands;
    masu_readback_image image;
    masu_view view;
    if (!masu_motion_frame(&b->s, rung, b->time, MASU_MOTION_STEP, true, &commands, b->error,
                           b->error_size))
        return false;
    if (masu_readback(b->s.m, commands.slot, MASU_READBACK_DEPTH, &image, NULL))
        return failed(b, "no depth to read back");
    return see(b, image.width, image.height, &view) &&
           (j->is_reference ? keep(b, &image, &view, j->rung.scale)
                            : compare(b, &image, &view, &j->rung));
}

static bool draw_jobs(masu_depth_bench *b, const job *jobs, uint32_t count) {
    masu_session_desc d = b->d;
    d.desc.readback = MASU_READBACK_DEPTH;
    d.desc.rung_count = count;
    for (uint32_t k = 0; k < count; k++) d.desc.rungs[k] = jobs[k].rung;
    if (!masu_session_open(&d, &b->s, b->error, b->error_size)) return false;
    bool good = true;
    for (uint32_t k = 0; k < count && good; k++) good = draw_job(b, &jobs[k], k);
    masu_session_close(&b->s);
    b->messages += b->s.host.messages;
    return good;
}

static bool among(const job *jobs, uint32_t count, const masu_rung *rung, bool is_reference) {
    for (uint32_t i = 0; i < count; i++) {
        if (jobs[i].is_reference == is_reference && !memcmp(&jobs[i].rung, rung, sizeof *rung))
            return true;
    }
    return false;
}

static uint32_t make_jobs(const masu_depth_bench *b, const masu_rung *rungs, uint32_t count,
                          job jobs[JOBS_MOST]) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < count && n + 2 <= JOBS_MOST; i++) {
        const masu_rung key = key_of(&rungs[i]), exact = exact_of(key.scale);
        if (find_result(b, &key) || among(jobs, n, &key, false)) continue;
        if (!b->exact && !find_reference(b, key.scale) && !among(jobs, n, &exact, true))
            jobs[n++] = (job){exact, true};
        jobs[n++] = (job){key, false};
    }
    return n;
}

bool masu_depth_measure(masu_depth_bench *b, const masu_rung *rungs, uint32_t count,
                        masu_depth_error *out, char *error, size_t error_size) {
    job jobs[JOBS_MOST];
    b->error = error;
    b->error_size = error_size;
    uint32_t n = make_jobs(b, rungs, count, jobs);
    for (uint32_t i = 0; i < n; i += MASU_MAX_RUNGS) {
        if (!draw_jobs(b, jobs + i, n - i < MASU_MAX_RUNGS ? n - i : MASU_MAX_RUNGS)) return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        const masu_rung key = key_of(&rungs[i]);
        const result *r = find_result(b, &key);
        if (!r) return failed(b, "too many settings");
        out[i] = r->error;
    }
    return true;
}

static bool truth_file(const char *scene_path, char path[4096]) {
    return masu_truth_path(scene_path, path, 4096) && masu_file_exists(path);
}

bool masu_depth_has_truth(const char *scene_path, const masu_scene *scene) {
    char path[4096];
    return (masu_scene_features(scene) & MASU_SCENE_HAS_SDF) &&
           !masu_scene_view_of(scene).sdf->has_raster && truth_file(scene_path, path);
}

static bool read_scene(masu_depth_bench *b) {
    size_t bytes = 0;
    masu_detail detail;
    if (!masu_file_read(b->d.scene_path, (size_t)2 << 30, &b->blob, &bytes, b->error,
                        b->error_size))
        return false;
    return !masu_scene_bind(b->blob, bytes, &b->scene, &detail) || failed(b, detail.text);
}

masu_depth_bench *masu_depth_open(const masu_session_desc *d, double time, bool truth, char *error,
                                  size_t error_size) {
    char path[4096];
    masu_depth_bench *b = calloc(1, sizeof *b);
    if (!b) {
        snprintf(error, error_size, "%s: out of memory", d->scene_path);
        return NULL;
    }
    b->d = *d;
    b->time = time;
    b->error = error;
    b->error_size = error_size;
    b->exact = truth && truth_file(d->scene_path, path) &&
               masu_truth_open(path, &b->truth, error, error_size);
    if ((truth && !b->exact) || !read_scene(b)) {
        masu_depth_close(b);
        return NULL;
    }
    return b;
}

uint32_t masu_depth_messages(const masu_depth_bench *b) { return b->messages; }

void masu_depth_close(masu_depth_bench *b) {
    if (!b) return;
    if (b->exact) masu_truth_close(&b->truth);
    for (uint32_t i = 0; i < b->reference_count; i++) free(b->references[i].t);
    free(b->blob);
    free(b);
}
