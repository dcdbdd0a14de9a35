/* render.h: Masu in this game: its memory, which is static, and the frames, with a HUD. */
#ifndef DRIVE_RENDER_H
#define DRIVE_RENDER_H

#include "effects.h"
#include "overlay.h"

typedef struct render {
    window *window;
    masu_scene scene;
    void *blob;                                /* of the scene */
    masu_device_block blocks[MASU_ROLE_COUNT]; /* allocated once, for every size of the window */
    masu_renderer *masu;
    masu_detail detail; /* of the masu_* call that failed */
    float target_ms; /* of the governor */
    int fixed_rung;  /* fixed rung instead of the governor; -1: none */
    uint64_t frame;  /* since the renderer was made, as the library counts */
    overlay overlay;
    masu_model bodies[TRACK_CARS], wheels[TRACK_CARS][TRACK_WHEELS];
    masu_model brakes[TRACK_CARS][2]; /* "CAR/brake0" and "CAR/brake1" */
    vec brake_at[TRACK_CARS][2];      /* from the body: ahead, up, right */
    effects effects;
    bool stepping; /* masu_init_step has not finished */
    masu_punctual_light lamps[2]; /* "head0" and "head1", which your car carries */
    /* For the summary at the end: */
    uint32_t frames, over; /* the latter took longer than the target */
    uint32_t rungs, rung, changes; /* a bit per rung that was drawn; the last; how often another */
    uint32_t shown_ms;   /* when the loading bar was drawn last */
    uint32_t bars, late; /* images of the loading bar; steps of masu_init_step in frames */
} render;

typedef struct render_view {
    double time;
    float step; /* seconds since the frame before */
    bool cut, dusk, rain, bloom, lamps, paused;
    char photo[256]; /* file for an image of this frame, or "" */
} render_view;

/* Allocates all memory: there are no later allocations. These functions report their errors. */
bool render_open(render *r, window *w, const char *scene_path);
/* Loads the scene and creates pipelines, with a loading bar, until frames can be drawn. */
bool render_load(render *r, const track *t);
/* After window_swapchain, before window_drop: for the size and images that the window has now. */
bool render_resize(render *r, const track *t);
bool render_frame(render *r, const race *race, const render_view *view, bool *outdated);
void render_close(render *r);

#endif
