/* temporal.c: see temporal.h. */
#include "lab/study/temporal.h"

#include "measure/motion.h"
#include "measure/picture.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"
#include "plan/desc.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const masu_past_ways[MASU_PAST_WAYS] = {"without", "temporal"};
const char *const masu_past_motions[MASU_PAST_MOTIONS] = {"rest", "slow", "fast"};

static const double steps[MASU_PAST_MOTIONS] = {0.0, MASU_MOTION_STEP, 1.0 / 8.0};

typedef struct study {
    const masu_past_desc *d;
    masu_past *out;
    char *error;
    size_t error_size;
    uint8_t *memory;
    uint8_t *truth, *truth_before;  /* of the last frame, and of the one before in slow motion */
    uint8_t *shown, *shown_before;
    uint32_t start; /* the start of the motion: 0, 1, ... */
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
    if (snprintf(file, sizeof file, "%s/%.*s.%s.png", w->d->image_dir, (int)strcspn(last, "."),
                 last, name) >= (int)sizeof file)
        return failed(w, "the path is too long");
    return masu_image_save_png(file, rgba, w->d->size.width, w->d->size.height, 0, w->error,
                               w->error_size);
}

/* ---- The ground truth ------------------------------------------------------------------------ */

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

/* ---- Images ---------------------------------------------------------------------------------- */

/* 5 frames per start: no multiple of the jitter sequence's bases, 2 and 3. */
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
        if (!masu_motion_frame(&w->s, 0, time_of(w, motion, k), steps[motion], k == 0, &commands,
                               w->error, w->error_size))
            return false;
        if (k + 2 < frames) continue;
        if (!masu_headless_target_read(&w->s.host, &w->s.targets[0], w->error, w->error_size))
            return false;
        memcpy(w->shown, w->s.targets[0].mapped, bytes_of(w->d->size));
    }
    return true;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static uint32_t starts_of(const study *w) { return w->d->starts ? w->d->starts : 1; }

/* Adds an image's errors to the means. */
static bool compare(study *w, masu_past_row *row, masu_past_motion motion) {
    const uint32_t width = w->d->size.width, height = w->d->size.height;
    char name[96];
    masu_flip flip;
    snprintf(name, sizeof name, "%g.%s.%s", row->scale, masu_past_ways[row->way],
             masu_past_motions[motion]);
    if (!masu_metric_flip(w->truth, w->shown, width, height, 0, NULL, &flip))
        return failed(w, "out of memory");
    const double share = 1.0 / starts_of(w);
    row->flip[motion] += share * flip.mean;
    if (motion < MASU_PAST_FAST) {
        row->flicker[motion] +=
            share * masu_metric_difference(w->shown, w->shown_before, width, height);
        if (motion == MASU_PAST_SLOW)
            row->flicker[motion] -=
                share * masu_metric_difference(w->truth, w->truth_before, width, height);
    }
    return w->start || save(w, name, w->shown);
}

static void find_size(const study *w, masu_past_row *row) {
    static const masu_scene any; /* any scene: a rung needs one for its size */
    const masu_desc d = {.scene = &any,
                         .output = w->d->size,
                         .rung_count = 1,
                         .rungs = {{.scale = (float)row->scale}}};
    const VkExtent2D size = masu_render_size(&d, 0);
    row->render_width = size.width;
    row->render_height = size.height;
}

static masu_session_desc session_of_way(const study *w, const masu_past_row *row) {
    masu_session_desc d = session_of(w, w->d->size);
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = (float)row->scale;
    d.desc.rungs[0].temporal = row->way == MASU_PAST_OWN ? MASU_ON : MASU_OFF;
    return d;
}

static bool measure(study *w, masu_past_row *row) {
    char text[96];
    for (int m = 0; m < MASU_PAST_MOTIONS; m++) {
        const masu_past_motion motion = (masu_past_motion)m;
        const masu_session_desc d = session_of_way(w, row);
        snprintf(text, sizeof text, "size %g, %s, %s", row->scale, masu_past_ways[row->way],
                 masu_past_motions[m]);
        if (w->d->progress) w->d->progress(text);
        if (!masu_session_open(&d, &w->s, w->error, w->error_size)) return false;
        snprintf(w->out->driver, sizeof w->out->driver, "%s", w->s.host.driver);
        bool good = true;
        for (w->start = 0; w->start < starts_of(w) && good; w->start++)
            good = draw_own(w, motion) && compare(w, row, motion);
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
    static study w; /* a session must not move, and is large */
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
