/* temporal.c: see temporal.h. */
#include "bench/study/temporal.h"

#include "bench/measure/motion.h"
#include "bench/measure/picture.h"
#include "bench/study/gsr2.h"
#include "bench/study/specular.h"
#include "bench/study/texel.h"
#include "frame/temporal.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"
#include "plan/desc.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const masu_past_ways[MASU_PAST_WAYS] = {"without", "temporal", "gsr2"};
const char *const masu_past_motions[MASU_PAST_MOTIONS] = {"rest", "slow", "fast"};

static const double steps[MASU_PAST_MOTIONS] = {0.0, MASU_MOTION_STEP, 1.0 / 8.0};

typedef struct study {
    const masu_past_desc *d;
    masu_past *out;
    char *error;
    size_t error_size;
    uint8_t *memory;
    uint8_t *truth, *truth_before;  /* of the last frame and of the one before in slow motion */
    uint8_t *shown, *shown_before;
    uint32_t start; /* of the motion: the first, the second... */
    masu_session s;
} study;

static bool failed(study *w, const char *text) {
    snprintf(w->error, w->error_size, "%s", text);
    return false;
}

static size_t bytes_of(VkExtent2D size) { return 4 * (size_t)size.width * size.height; }

static bool save(study *w, const char *name, const uint8_t *rgba) {
    const char *path = w->d->scene_path, *last = strrchr(path, '/');
    char file[4096];
    last = last ? last + 1 : path;
    if (!w->d->image_dir) return true;
    if (snprintf(file, sizeof file, "%s/%.*s.%s.png", w->d->image_dir, (int)strcspn(last, "."), last, name) >=
        (int)sizeof file)
        return failed(w, "the path is too long");
    return masu_image_save_png(file, rgba, w->d->size.width, w->d->size.height, 0, w->error, w->error_size);
}

/* ---- The truth --------------------------------------------------------------------------------- */

static masu_session_desc session_of(const study *w, VkExtent2D size) {
    return masu_picture_session(w->d->scene_path, size, &w->d->host);
}

static bool find_truth(study *w, double time, const char *path, uint8_t *rgba) {
    const masu_session_desc d = session_of(w, w->d->size);
    masu_picture_want want = {path, time, w->d->positions, w->d->rays, w->d->progress, 0};
    bool good = masu_picture_find(&d, &want, rgba, w->error, w->error_size);
    w->out->messages += want.messages;
    return good;
}

static bool find_truths(study *w) {
    char before[4096];
    const char *path = w->d->truth_path;
    if (path && snprintf(before, sizeof before, "%s.before.png", path) >= (int)sizeof before)
        return failed(w, "the path is too long");
    return find_truth(w, w->d->time, path, w->truth) &&
           find_truth(w, w->d->time - MASU_MOTION_STEP, path ? before : NULL, w->truth_before) &&
           save(w, "truth", w->truth);
}

/* ---- The library's own pictures ---------------------------------------------------------------- */

/* 5: the sequence's bases are 2 and 3. */
static uint32_t frames_of(const study *w, masu_past_motion motion) {
    return (motion == MASU_PAST_FAST ? w->d->fast_frames : w->d->frames) + 5 * w->start;
}

static double time_of(const study *w, masu_past_motion motion, uint32_t frame) {
    return w->d->time - (double)(frames_of(w, motion) - 1 - frame) * steps[motion];
}

static bool draw_own(study *w, masu_past_motion motion) {
    const uint32_t frames = frames_of(w, motion);
    for (uint32_t k = 0; k < frames; k++) {
        masu_commands commands;
        memcpy(w->shown_before, w->shown, bytes_of(w->d->size));
        if (!masu_motion_frame(&w->s, 0, time_of(w, motion, k), steps[motion], k == 0, &commands, w->error,
                               w->error_size))
            return false;
        if (k + 2 < frames) continue;
        if (!masu_headless_target_read(&w->s.host, &w->s.targets[0], w->error, w->error_size)) return false;
        memcpy(w->shown, w->s.targets[0].mapped, bytes_of(w->d->size));
    }
    return true;
}

/* ---- Another's ---------------------------------------------------------------------------------- */

typedef struct other {
    masu_gsr2 g;
    float *depth, *motion;
    masu_camera camera; /* of the frame before */
} other;

static bool read_surfaces(study *w, other *o, const float before[2], const float now[2]) {
    masu_readback_image depth, velocity;
    const uint32_t slot = masu_specular_slot(&w->s);
    if (masu_readback(w->s.m, slot, MASU_READBACK_DEPTH, &depth) ||
        masu_readback(w->s.m, slot, MASU_READBACK_VELOCITY, &velocity))
        return failed(w, "no depth or velocity is read back");
    for (uint32_t y = 0; y < depth.height; y++) {
        const uint8_t *row = (const uint8_t *)velocity.pixels + (size_t)y * velocity.row_bytes;
        memcpy(o->depth + (size_t)y * depth.width, (const uint8_t *)depth.pixels + (size_t)y * depth.row_bytes,
               sizeof(float) * depth.width);
        for (uint32_t x = 0; x < depth.width; x++, row += 8) {
            uint16_t texel[4];
            memcpy(texel, row, sizeof texel);
            const bool known = masu_texel_half(texel[3]) > 0.5f;
            for (int k = 0; k < 2; k++) {
                /* A pixel looks beside its middle by the jitter: the picture moves the other way. What the half has been
                 * rounded by is no motion: what rests is told to rest, as matrices without jitter would. */
                float moved = masu_texel_half(texel[k]) + before[k] - now[k];
                bool moves = known && fabsf(moved) > ldexpf(fabsf(before[k] - now[k]), -11) + 1e-4f;
                o->motion[2 * ((size_t)y * depth.width + x) + (size_t)k] = moves ? moved : 0.0f;
            }
        }
    }
    return true;
}

static bool draw_other_frame(study *w, other *o, masu_past_motion motion, uint32_t k) {
    const masu_gsr2 *g = &o->g;
    masu_camera camera, plain;
    masu_commands commands;
    const double time = time_of(w, motion, k);
    if (masu_camera_at(w->s.m, time, &camera)) return failed(w, "the scene has no camera");
    plain = camera;
    masu_temporal_place(w->s.desc.output, w->d->size, k, camera.jitter);
    const masu_frame_desc frame = {.camera = &camera, .time = time, .time_step = (float)steps[motion], .cut = k == 0};
    if (!masu_session_frame(&w->s, &frame, true, &commands, w->error, w->error_size) ||
        !read_surfaces(w, o, k ? o->camera.jitter : camera.jitter, camera.jitter) ||
        !masu_headless_target_read(&w->s.host, &w->s.targets[0], w->error, w->error_size))
        return false;
    masu_camera was = o->camera;
    memcpy(was.jitter, plain.jitter, sizeof was.jitter);
    masu_gsr2_frame given = {.rgba = w->s.targets[0].mapped,
                             .depth = o->depth,
                             .motion = o->motion,
                             .tan_x = tanf(0.5f * camera.fov_y) * (float)g->to[0] / (float)g->to[1],
                             .cut = k == 0,
                             .still = k && !memcmp(&was, &plain, sizeof plain),
                             .rest = 1.0f};
    memcpy(given.jitter, camera.jitter, sizeof given.jitter);
    memcpy(w->shown_before, w->shown, bytes_of(w->d->size));
    masu_gsr2_add(&o->g, &given, w->shown);
    o->camera = camera;
    return true;
}

static bool draw_other(study *w, masu_past_motion motion) {
    const uint32_t to[2] = {w->d->size.width, w->d->size.height};
    const uint32_t from[2] = {w->s.desc.output.width, w->s.desc.output.height};
    const size_t pixels = (size_t)from[0] * from[1];
    other o = {.depth = malloc(3 * pixels * sizeof(float))};
    bool good = o.depth && masu_gsr2_open(&o.g, from, to);
    if (good) o.motion = o.depth + pixels;
    if (!good) failed(w, "out of memory");
    for (uint32_t k = 0; k < frames_of(w, motion) && good; k++) good = draw_other_frame(w, &o, motion, k);
    masu_gsr2_close(&o.g);
    free(o.depth);
    return good;
}

/* ---- Rows --------------------------------------------------------------------------------------- */

static uint32_t starts_of(const study *w) { return w->d->starts ? w->d->starts : 1; }

/* Adds what a picture is off by to the means. */
static bool compare(study *w, masu_past_row *row, masu_past_motion motion) {
    const uint32_t width = w->d->size.width, height = w->d->size.height;
    char name[96];
    masu_flip flip;
    snprintf(name, sizeof name, "%g.%s.%s", row->scale, masu_past_ways[row->way], masu_past_motions[motion]);
    if (!masu_metric_flip(w->truth, w->shown, width, height, 0, NULL, &flip))
        return failed(w, "out of memory");
    const double share = 1.0 / starts_of(w);
    row->flip[motion] += share * flip.mean;
    if (motion < MASU_PAST_FAST) {
        row->flicker[motion] += share * masu_metric_difference(w->shown, w->shown_before, width, height);
        if (motion == MASU_PAST_SLOW)
            row->flicker[motion] -= share * masu_metric_difference(w->truth, w->truth_before, width, height);
    }
    return w->start || save(w, name, w->shown);
}

static void find_size(const study *w, masu_past_row *row) {
    static const masu_scene any; /* without a scene a rung has no size of its own */
    const masu_desc d = {.scene = &any, .output = w->d->size, .rung_count = 1, .rungs = {{.scale = (float)row->scale}}};
    const VkExtent2D size = masu_render_size(&d, 0);
    row->render_width = size.width;
    row->render_height = size.height;
}

/* The other way gets mips as fine as rung.temporal has them (src/plan/push.c), and the means of reflections that AUTO has
 * there; their filter over neighbours is that of pictures without a past. */
static masu_session_desc session_of_way(const study *w, const masu_past_row *row) {
    const bool other = row->way == MASU_PAST_GSR2;
    masu_session_desc d = session_of(w, other ? (VkExtent2D){row->render_width, row->render_height} : w->d->size);
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = other ? 1.0f : (float)row->scale;
    d.desc.rungs[0].temporal = row->way == MASU_PAST_OWN ? MASU_ON : MASU_OFF;
    if (!other) return d;
    d.desc.rungs[0].sharpen = MASU_OFF;
    masu_desc own = {.rung_count = 1, .rungs = {{.temporal = MASU_ON}}};
    own = masu_desc_resolved(&own);
    d.desc.rungs[0].specular_frames = own.rungs[0].specular_frames;
    d.desc.rungs[0].specular_reuse = own.rungs[0].specular_reuse;
    d.desc.rungs[0].specular_taa = own.rungs[0].specular_taa;
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_VELOCITY;
    d.desc.debug.mip_bias = log2f((float)row->scale) - 2.0f;
    return d;
}

static bool measure(study *w, masu_past_row *row) {
    char text[96];
    for (int m = 0; m < MASU_PAST_MOTIONS; m++) {
        const masu_past_motion motion = (masu_past_motion)m;
        const masu_session_desc d = session_of_way(w, row);
        snprintf(text, sizeof text, "size %g, %s, %s", row->scale, masu_past_ways[row->way], masu_past_motions[m]);
        if (w->d->progress) w->d->progress(text);
        if (!masu_session_open(&d, &w->s, w->error, w->error_size)) return false;
        snprintf(w->out->driver, sizeof w->out->driver, "%s", w->s.host.driver);
        bool good = true;
        for (w->start = 0; w->start < starts_of(w) && good; w->start++)
            good = (row->way == MASU_PAST_GSR2 ? draw_other(w, motion) : draw_own(w, motion)) && compare(w, row, motion);
        masu_session_close(&w->s);
        w->out->messages += w->s.host.messages;
        if (!good) return false;
    }
    return true;
}

static bool run(study *w) {
    if (!find_truths(w)) return false;
    for (uint32_t i = 0; i < w->d->scale_count; i++) {
        masu_past_row size = {.scale = w->d->scales[i]};
        find_size(w, &size);
        for (int way = 0; way < MASU_PAST_WAYS; way++) {
            if (w->d->only && !(w->d->only >> way & 1u)) continue;
            masu_past_row *row = &w->out->rows[w->out->row_count];
            *row = size;
            row->way = (masu_past_way)way;
            if (!measure(w, row)) return false;
            w->out->row_count++;
        }
    }
    return true;
}

bool masu_past_run(const masu_past_desc *desc, masu_past *out, char *error, size_t error_size) {
    static study w; /* a session may not move, and is large */
    const size_t bytes = bytes_of(desc->size);
    memset(&w, 0, sizeof w);
    memset(out, 0, sizeof *out);
    w.d = desc;
    w.out = out;
    w.error = error;
    w.error_size = error_size;
    w.memory = calloc(4, bytes);
    if (!w.memory) return failed(&w, "out of memory");
    w.truth = w.memory;
    w.truth_before = w.memory + bytes;
    w.shown = w.memory + 2 * bytes;
    w.shown_before = w.memory + 3 * bytes;
    bool good = run(&w);
    free(w.memory);
    return good;
}
