/* render.h: Masu in this game: its memory, which is static, and the frames. */
#ifndef DRIVE_RENDER_H
#define DRIVE_RENDER_H

#include "car.h"
#include "masu.h"
#include "window.h"

typedef struct render {
    window *window;
    masu_scene scene;
    masu_device_block blocks[MASU_ROLE_COUNT]; /* allocated once, for every size of the window */
    masu_renderer *masu;
    float target_ms;   /* of the governor */
    int fixed_rung;    /* instead of it; -1 */
    uint64_t frame;    /* since the renderer was made, as the library counts */
    Uint64 submitted[WINDOW_SLOTS]; /* when, by SDL's clock */
    masu_model bodies[TRACK_CARS], wheels[TRACK_CARS][TRACK_WHEELS];
    masu_punctual_light lamps[2]; /* "head0" and "head1", which the player's car carries */
    /* What has happened, for the line at the end: */
    uint64_t frames, missed, missed_now; /* the latter by this renderer */
    uint32_t rungs; /* bit per rung that a frame was drawn at */
} render;

typedef struct render_view {
    masu_camera camera;
    double time;
    float step;    /* seconds since the frame before */
    bool cut, dusk, lamps, paused;
    const char *photo; /* file for a picture of this frame, or NULL */
} render_view;

/* Reads the scene: the only memory that is asked for, besides the device's. All say what went wrong. */
bool render_open(render *r, window *w, const char *scene_path);
/* A renderer for the window as large as it is, in the blocks. */
bool render_build(render *r, const track *t);
/* After window_swapchain, before window_drop: the renderer for the size and images that the window has now. */
bool render_resize(render *r, const track *t);
bool render_frame(render *r, const race *race, const render_view *view, bool *outdated);
void render_close(render *r);

#endif
