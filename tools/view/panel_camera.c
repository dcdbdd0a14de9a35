/* panel_camera.c: the panels "Camera" (field of view, near plane, speed, path) and "Capture"
 * (images, video). */
#include "view/viewer.h"

#include <math.h>

#define DEGREES 57.29577951308232

static void take_hold(masu_viewer *v) {
    masu_camera camera;
    masu_viewer_camera(v, &camera);
    masu_fly_from(&v->fly, &camera);
    v->on_path = v->recorder.plays = false;
}

void masu_panel_camera(masu_viewer *v) {
    masu_capture *r = &v->recorder;
    masu_camera camera;
    masu_viewer_camera(v, &camera);
    float fov = (float)((double)camera.fov_y * DEGREES), near = camera.near_distance,
          speed = (float)v->fly.speed;
    bool path = v->on_path;
    if (!(near > 0.0f)) near = 0.1f;
    masu_ui_text(MASU_INK, "position %.3f %.3f %.3f", camera.position[0], camera.position[1],
                 camera.position[2]);
    const double f[3] = {(double)camera.forward[0], (double)camera.forward[1],
                         (double)camera.forward[2]};
    const double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    masu_ui_text(MASU_INK, "direction %.3f %.3f %.3f", f[0] / length, f[1] / length, f[2] / length);
    if (masu_ui_slider("Field of view", &fov, 1.0f, 170.0f, "%.1f degrees", false))
        take_hold(v), v->fly.fov_y = (float)((double)fov / DEGREES);
    if (masu_ui_slider("Near plane", &near, 0.001f, 10.0f, "%.3f m", true))
        take_hold(v), v->fly.near_distance = near;
    if (masu_ui_slider("Speed", &speed, 0.01f, 1000.0f, "%.2f m/s", true))
        v->fly.speed = (double)speed;
    if (masu_scene_count(&v->scene, MASU_SCENE_CAMERA_KEY) &&
        masu_ui_check("Path of the scene", &path)) {
        take_hold(v);
        v->on_path = path;
        v->cut = true;
    }
    if (v->on_path && v->path_end > 0.0) {
        float time = (float)v->time;
        if (masu_ui_slider("Path time", &time, 0.0f, (float)v->path_end, "%.2f s", false))
            v->time = (double)time, v->cut = true;
    }
    if (!masu_ui_section("Recorded path", true)) return;
    masu_ui_text(MASU_INK_DIM, "%u keys, %.1f s", r->count,
                 r->count ? r->times[r->count - 1] : 0.0);
    if (masu_ui_button(r->records ? "Stop##record" : "Record")) masu_capture_path(v, !r->records);
    masu_ui_help("Keeps the camera four times a second while you fly.");
    if (r->records || r->count < 2) return;
    masu_ui_same_line();
    if (masu_ui_button(r->plays ? "Stop##play" : "Play")) masu_capture_play(v, !r->plays);
    masu_ui_same_line();
    if (masu_ui_button("Save")) masu_capture_save(v);
    masu_ui_help(
        "Writes the scene description with this camera path under another name, NAME-path.json.");
}

void masu_panel_capture(masu_viewer *v) {
    masu_capture *r = &v->recorder;
    masu_ui_check("Without panels and text", &r->clean);
    if (masu_ui_button("Screenshot (F12)")) v->shoot = true;
    masu_ui_same_line();
    if (masu_ui_button(r->films ? "Stop video (F9)" : "Record video (F9)"))
        masu_capture_film(v, !r->films);
    masu_ui_text(MASU_INK_DIM, "Images are .png, videos are .y4m (uncompressed, 30 frames per "
                               "second of scene time, however "
                               "long a frame takes), in the current folder.");
}
