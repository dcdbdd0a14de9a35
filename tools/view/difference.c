/* difference.c: the FLIP map of A against B, computed on the CPU (tools/metric/flip.h).
 *
 * FLIP takes longer than a frame, so a thread works on copies of the images of one frame, and the
 * map appears when it is done. While time runs, a new map starts every EVERY frames; while time is
 * paused, once, and again after each change. A script waits for the thread, so that its result
 * depends only on frame numbers. */
#include "view/viewer.h"

#include "metric/flip.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EVERY 60u

static int work(void *user) {
    masu_difference *d = user;
    masu_flip flip;
    d->failed = !masu_metric_flip(d->b, d->a, d->width, d->height, 0.0, d->errors, &flip);
    if (!d->failed) d->mean = flip.mean, d->p99 = flip.p99, d->max = flip.max;
    SDL_AtomicSet(&d->done, 1);
    return 0;
}

static void drop(masu_difference *d) {
    if (d->thread) SDL_WaitThread(d->thread, NULL);
    free(d->a);
    free(d->b);
    free(d->errors);
    d->thread = NULL;
    d->a = d->b = NULL;
    d->errors = NULL;
}

void masu_difference_close(masu_difference *d) { drop(d); }

uint32_t masu_difference_color(float error) {
    static const float stops[][3] = {
        {2, 2, 8}, {75, 18, 105}, {180, 50, 100}, {240, 120, 50}, {250, 200, 90}, {255, 255, 220}};
    const int last = sizeof stops / sizeof *stops - 1;
    float x = error < 0.0f ? 0.0f : error > 1.0f ? (float)last : error * (float)last;
    int i = (int)x < last ? (int)x : last - 1;
    uint32_t out = 255u << 24;
    for (int c = 0; c < 3; c++) {
        float v = stops[i][c] + (x - (float)i) * (stops[i + 1][c] - stops[i][c]);
        out |= (uint32_t)(v + 0.5f) << 8 * c;
    }
    return out;
}

static bool take(masu_viewer *v) {
    masu_difference *d = &v->difference;
    const masu_stage *stages[2] = {&v->a, &v->b};
    uint8_t **copies[2] = {&d->a, &d->b};
    size_t bytes = (size_t)4 * v->a.target.width * v->a.target.height;
    d->width = v->a.target.width;
    d->height = v->a.target.height;
    d->taken = v->frames;
    d->paused = v->paused;
    d->errors = malloc(bytes / 4 * sizeof *d->errors);
    d->failed = !d->errors;
    for (int i = 0; i < 2 && !d->failed; i++) {
        masu_headless_target *t = (masu_headless_target *)&stages[i]->target;
        if (!masu_headless_target_read(&v->host, t, v->error, sizeof v->error)) {
            v->lost = v->lost || v->host.lost;
            return false;
        }
        *copies[i] = malloc(bytes);
        d->failed = !*copies[i];
        if (!d->failed) memcpy(*copies[i], t->mapped, bytes);
    }
    SDL_AtomicSet(&d->done, 0);
    if (!d->failed) d->thread = SDL_CreateThread(work, "flip", d);
    if (!d->thread && !d->failed) (void)work(d); /* without a thread, compute the map here */
    return true;
}

/* Waits until the device is idle: no command may read the map while it is written. */
static void show(masu_viewer *v) {
    masu_difference *d = &v->difference;
    uint32_t *to = v->compose.map.mapped;
    bool fits = d->width == v->compose.shown.width && d->height == v->compose.shown.height;
    if (!d->failed && fits) {
        masu_viewer_settle(v);
        for (size_t i = 0; i < (size_t)d->width * d->height; i++)
            to[i] = masu_difference_color(d->errors[i]);
        d->known = true;
    }
    drop(d);
}

bool masu_difference_step(masu_viewer *v) {
    masu_difference *d = &v->difference;
    if (d->a || d->b || d->errors) {
        if (!v->scripted && d->thread && !SDL_AtomicGet(&d->done)) return true;
        if (d->thread) SDL_WaitThread(d->thread, NULL), d->thread = NULL;
        show(v);
        return true;
    }
    if (v->show != MASU_SHOW_MAP || !v->b.m || !v->frames) return true;
    bool rests = v->paused && d->paused && d->taken > v->moved;
    bool due = !d->known || (v->paused ? !rests : v->frames >= d->taken + EVERY);
    if (d->failed || !due) return true;
    if (!take(v)) return false;
    if (v->scripted) {
        if (d->thread) SDL_WaitThread(d->thread, NULL), d->thread = NULL;
        show(v);
    }
    return true;
}
