/* capture.c: records a camera path while flying, plays it and saves it as a scene description;
 * writes screenshots and videos, named by date, to the current folder. */
#include "view/viewer.h"

#include "cli/cli.h"
#include "image.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define KEY_SECONDS 0.25

/* "masu-20260102-030405.png"; scripts use the frame number instead of the date. */
static void new_name(const masu_viewer *v, const char *end, char *out, size_t size) {
    char date[32];
    time_t now = time(NULL);
    struct tm local;
    if (!localtime_r(&now, &local) || !strftime(date, sizeof date, "%Y%m%d-%H%M%S", &local))
        snprintf(date, sizeof date, "image");
    if (v->scripted) snprintf(date, sizeof date, "%06llu", (unsigned long long)v->turns);
    snprintf(out, size, "masu-%s%s", date, end);
}

static void fail(masu_viewer *v) { snprintf(v->trouble, sizeof v->trouble, "%s", v->error); }

/* ---- Images and videos ----------------------------------------------------------------------- */

bool masu_capture_still(masu_viewer *v) {
    char name[64];
    new_name(v, ".png", name, sizeof name);
    if (masu_viewer_screenshot(v, name, v->recorder.clean))
        return masu_viewer_note(v, "wrote %s", name), true;
    fail(v); /* a full disk does not end the program */
    return !v->lost;
}

void masu_capture_film(masu_viewer *v, bool on) {
    masu_capture *r = &v->recorder;
    if (on == r->films || !v->a.m) return;
    if (on) {
        new_name(v, ".y4m", r->name, sizeof r->name);
        r->filmed = 0;
        r->films = masu_video_open(&r->video, r->name, v->a.target.width, v->a.target.height,
                                   MASU_VIEWER_FILM_STEP, v->error, sizeof v->error);
        if (!r->films) fail(v);
        return;
    }
    r->films = false;
    if (masu_video_close(&r->video, v->error, sizeof v->error))
        masu_viewer_note(v, "wrote %s: %llu frames", r->name, (unsigned long long)r->filmed);
    else
        fail(v);
}

/* A change of the window's size ends the video. */
bool masu_capture_frame(masu_viewer *v) {
    masu_capture *r = &v->recorder;
    masu_headless_target *t = r->clean ? &v->a.target : &v->compose.shown;
    if (!r->films) return true;
    if (!v->a.m || r->video.width != t->width || r->video.height != t->height)
        return masu_capture_film(v, false), true;
    if (!masu_headless_target_read(&v->host, t, v->error, sizeof v->error)) {
        v->lost = v->lost || v->host.lost;
        return false;
    }
    if (masu_video_frame(&r->video, t->mapped, v->error, sizeof v->error)) return r->filmed++, true;
    fail(v);
    char other[256];
    (void)masu_video_close(&r->video, other, sizeof other);
    r->films = false;
    return true;
}

/* ---- Camera paths ---------------------------------------------------------------------------- */

void masu_capture_path(masu_viewer *v, bool on) {
    masu_capture *r = &v->recorder;
    if (on) r->count = 0, r->time = 0.0, r->plays = false;
    r->records = on;
    if (!on)
        masu_viewer_note(v, "camera path: %u keys, %.1f s", r->count,
                         r->count ? r->times[r->count - 1] : 0.0);
}

void masu_capture_play(masu_viewer *v, bool on) {
    masu_capture *r = &v->recorder;
    r->plays = on && r->count > 1;
    if (r->plays) r->time = 0.0, r->records = false, v->cut = true;
}

void masu_capture_step(masu_viewer *v, double seconds) {
    masu_capture *r = &v->recorder;
    if (r->plays) {
        r->time += seconds;
        if (r->time > r->times[r->count - 1]) r->time = 0.0, v->cut = true;
        v->moved = v->frames;
    }
    if (!r->records) return;
    bool due = !r->count || r->time >= r->times[r->count - 1] + KEY_SECONDS;
    if (due && r->count < MASU_PATH_KEYS) {
        masu_viewer_camera(v, &r->keys[r->count]);
        r->times[r->count++] = r->time;
    }
    r->time += seconds;
    if (r->count == MASU_PATH_KEYS) masu_capture_path(v, false);
}

/* Linear interpolation between keys, as for the library's paths. */
bool masu_capture_camera(const masu_viewer *v, masu_camera *out) {
    const masu_capture *r = &v->recorder;
    uint32_t i = 1;
    if (!r->plays) return false;
    while (i + 1 < r->count && r->times[i] < r->time) i++;
    const masu_camera *a = &r->keys[i - 1], *b = &r->keys[i];
    double span = r->times[i] - r->times[i - 1],
           t = span > 0.0 ? (r->time - r->times[i - 1]) / span : 1.0;
    t = fmin(fmax(t, 0.0), 1.0);
    *out = *b;
    for (int k = 0; k < 3; k++) {
        out->position[k] = a->position[k] + t * (b->position[k] - a->position[k]);
        out->forward[k] = (float)((1.0 - t) * (double)a->forward[k] + t * (double)b->forward[k]);
    }
    out->fov_y = (float)((1.0 - t) * (double)a->fov_y + t * (double)b->fov_y);
    return true;
}

static json_t *vector(const double at[3], const float forward[3], double distance) {
    json_t *out = json_array();
    for (int k = 0; k < 3; k++)
        json_array_append_new(
            out, json_real(round(1e6 * (at[k] + distance * (double)(forward ? forward[k] : 0.0f))) /
                           1e6));
    return out;
}

/* Writes a copy of the opened description under another name in the same folder, or only the camera
 * if no description is open. */
void masu_capture_save(masu_viewer *v) {
    const masu_capture *r = &v->recorder;
    const char *source = v->baker.source, *dot = strrchr(source, '.');
    bool has_source = dot && !strcmp(dot, ".json") && masu_file_is_regular(source);
    json_t *root = has_source ? json_load_file(source, 0, NULL) : NULL, *camera,
           *keys = json_array();
    char name[1200];
    if (!root) root = json_object();
    camera = json_incref(json_object_get(root, "camera")); /* keeps the near plane and the field of
                                                            * view */
    if (!json_is_object(camera)) json_decref(camera), camera = json_object();
    json_object_del(camera, "from");
    for (uint32_t i = 0; i < r->count; i++) {
        const masu_camera *c = &r->keys[i];
        json_t *key = json_object();
        json_object_set_new(key, "time", json_real(round(1e4 * r->times[i]) / 1e4));
        json_object_set_new(key, "position", vector(c->position, NULL, 0.0));
        json_object_set_new(key, "target", vector(c->position, c->forward, 1.0));
        json_object_set_new(key, "fov_y",
                            json_real(round(1e4 * (double)c->fov_y * 57.29577951308232) / 1e4));
        json_array_append_new(keys, key);
    }
    if (r->count && r->keys[0].near_distance > 0.0f)
        json_object_set_new(camera, "near", json_real((double)r->keys[0].near_distance));
    json_object_set_new(camera, "keys", keys);
    json_object_set_new(root, "camera", camera);
    if (has_source)
        snprintf(name, sizeof name, "%.*s-path.json", (int)(dot - source), source);
    else
        new_name(v, ".json", name, sizeof name);
    if (json_dump_file(root, name, JSON_INDENT(2) | JSON_REAL_PRECISION(9)))
        snprintf(v->trouble, sizeof v->trouble, "%.900s: cannot be written", name);
    else
        masu_viewer_note(v, "wrote %.200s", name);
    json_decref(root);
}

void masu_capture_close(masu_viewer *v) {
    char error[256];
    if (v->recorder.films) (void)masu_video_close(&v->recorder.video, error, sizeof error);
    v->recorder.films = false;
}
