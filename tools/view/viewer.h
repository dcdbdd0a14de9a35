/* viewer.h: the state of masu-view, one struct, and the functions that change it. Files of this
 * folder:
 *
 *   main.c     options              input.c   events to actions    frame.c       one frame to the
 *   window
 *   loop.c     the main loop        keys.c    actions of keys      difference.c  FLIP of A and B
 *   script.c   events by number     hud.c     statistics           bake.c        opens, bakes,
 *   watches files
 *   stage.c    a renderer           panels.c  panels, messages     gallery.c     the start page
 *   compose.c  the viewer's pass    panel_*.c one panel each       look.c        changes without a
 *   bake
 *   pick.c     mouse picking        ui.cpp    Dear ImGui           capture.c     camera paths,
 *   images, video
 *
 * A is the current setting; B is the stored one that it is compared with, and exists while it is
 * shown. Both render the same scene from the same blob, which remains in memory: a changed knob
 * recreates the renderer. Without a scene neither exists, and the window shows the start page or
 * the progress of a bake. */
#ifndef MASU_VIEW_VIEWER_H
#define MASU_VIEW_VIEWER_H

#include "view/compose.h"
#include "view/fly.h"
#include "view/stage.h"
#include "view/ui.h"
#include "view/window.h"

#include "command/video.h"
#include "settings/setting.h"

#define MASU_VIEWER_STEP (1.0 / 60.0) /* seconds per frame of a script */
#define MASU_VIEWER_FILM_STEP (1.0 / 30.0) /* while a video is recorded, for any duration of a
                                            * frame */

typedef struct masu_viewer_options {
    const char *scene;   /* any supported file; NULL: baked from `json`, or the start page */
    const char *json;    /* the description of `scene`; NULL: none */
    const char *bake;    /* baker command; NULL: masu-bake in the folder of this program */
    const char *gallery; /* folder of the start page's scenes; NULL: none */
    const char *cache;   /* folder of its thumbnails; NULL: one in TMPDIR */
    const char *script, *screenshot, *setting, *ladder;
    VkExtent2D size;
    masu_headless_desc host;
    uint32_t rays; /* masu_ray_ways */
    uint32_t rung;
    uint32_t frames; /* number of frames before the exit or the screenshot; 0: no limit */
    double time, target_ms;
    bool quit;          /* exit after `frames` */
    bool rung_given;    /* false: the governor chooses */
    bool no_vsync, no_timestamps, counters;
} masu_viewer_options;

enum { MASU_HUD_OFF, MASU_HUD_SHORT, MASU_HUD_FULL, MASU_HUD_LEVELS };
enum { MASU_SHOW_A, MASU_SHOW_SPLIT, MASU_SHOW_MAP };

/* A watched file. */
typedef struct masu_watch {
    char path[1024];
    int64_t seconds, nanoseconds, bytes; /* of its last change; all 0: missing */
} masu_watch;

#define MASU_WATCHES_MAX 64u
#define MASU_VARIANTS_MAX 32u

typedef struct masu_baker {
    char folder[1024];           /* temporary folder; empty: not created yet */
    char output[1100], log[1100];
    char source[1024];           /* baked when it changes; empty: `blob` itself is watched */
    char blob[1100];             /* loaded last */
    masu_watch watches[MASU_WATCHES_MAX];
    uint32_t count;
    long child;                  /* the baker's process; 0: none */
    uint64_t looked_ns, begun_ns;
    bool again;                  /* a file has changed since the bake began */
    bool opens;                  /* a new file: reset camera and time */
    float turn;                  /* rotation of the environment map, degrees */
    char variant[128];           /* material variant; empty: the file's default */
    char variants[MASU_VARIANTS_MAX][128]; /* variants in the file */
    uint32_t variant_count;
} masu_baker;

/* Playback of the clips of a model. */
typedef struct masu_playback {
    uint32_t clip, other;        /* `other` is blended in by `blend`, 0..1 */
    float blend, speed;
    double time;
    bool plays, loops;
} masu_playback;

#define MASU_LOOK_ITEMS 64u      /* models and lights that panels list */

/* Changes by the panels, kept until another scene is opened. */
typedef struct masu_view_look {
    masu_light light, from;      /* of frames; of the scene */
    bool has_light;
    float azimuth, elevation, sun, stops; /* of `light`: degrees; factor on the scene's sun;
                                           * exposure, powers of two */
    float params[MASU_MAX_SDF_PARAMS];
    uint32_t param_count;
    float lamps[MASU_LOOK_ITEMS]; /* factors on the colours of lights */
    bool hidden[MASU_LOOK_ITEMS]; /* models */
    masu_playback clips[MASU_LOOK_ITEMS];
} masu_view_look;

#define MASU_PATH_KEYS 512u

typedef struct masu_capture {
    masu_camera keys[MASU_PATH_KEYS];
    double times[MASU_PATH_KEYS];
    uint32_t count;
    bool records, plays;         /* a camera path */
    double time;                 /* seconds since it began */
    bool films, clean;           /* writes a video; without panels and text */
    masu_video video;
    uint64_t filmed;             /* frames */
    char name[64];
} masu_capture;

typedef struct masu_panels {
    bool open, focus;            /* focus: give it the keyboard focus in the next frame */
    uint32_t tab;                /* MASU_TAB_* */
    bool select;                 /* show `tab` in the next frame */
} masu_panels;
enum {
    MASU_TAB_SCENE,
    MASU_TAB_LIGHT,
    MASU_TAB_QUALITY,
    MASU_TAB_CAMERA,
    MASU_TAB_CAPTURE,
    MASU_TABS
};

#define MASU_GALLERY_MAX 64u

typedef struct masu_gallery {
    bool open;
    char paths[MASU_GALLERY_MAX][512];
    uint8_t *pictures[MASU_GALLERY_MAX];
    uint32_t count, made;        /* thumbnails below `made` exist or have failed */
    long child;                  /* the process that renders one; 0: none */
    char picture[1100], folder[1024];
    bool stale;                  /* a thumbnail is not attached to the interface yet */
} masu_gallery;

typedef struct masu_difference {
    SDL_Thread *thread;          /* NULL: not running */
    SDL_atomic_t done;           /* set by the thread */
    uint8_t *a, *b;              /* copies of both images; RGBA8 */
    float *errors;
    uint32_t width, height;
    double mean, p99, max;
    bool failed, known;          /* out of memory; the numbers above are valid */
    uint64_t taken;              /* frame of the images */
    bool paused;                 /* time was paused in that frame: once is enough */
} masu_difference;

typedef struct masu_picked {
    bool asked;                  /* the next frame requests this pixel: */
    uint32_t x, y;
    bool of_slot[MASU_WINDOW_FLIGHT]; /* the slot's last frame has requested it */
    double near_distance;        /* of that frame */
    char text[256];              /* result of the last click; "": none */
    int at[2];
    uint64_t turn;
} masu_picked;

typedef struct masu_viewer {
    const masu_viewer_options *o;
    bool scripted;               /* fixed step: each frame is MASU_VIEWER_STEP long */

    masu_window window;
    masu_headless host;
    VkPipelineCache cache;
    masu_pipelines pools[2];     /* pipelines of A and B, from one start to the next */
    VkFence fences[MASU_WINDOW_FLIGHT];
    bool pending[MASU_WINDOW_FLIGHT];
    bool lost;                   /* the device is lost: recreate everything */
    bool lose;                   /* a script simulates a lost device */
    uint32_t losses;             /* since a frame was last finished */

    void *blob;
    masu_scene scene;
    masu_detail detail;          /* of the masu_* call that failed */
    masu_desc want;              /* the description of A: rungs, governor, ... */
    masu_desc given;             /* from the command line, before defaults are filled in */
    masu_rung reference;         /* the setting of B */
    masu_stage a, b;
    masu_compose compose;
    masu_plan_info plan;         /* of A */

    masu_fly fly;
    bool on_path, paused, cut;
    double time, path_end;
    float time_step;
    uint32_t rung;
    bool governed;

    bool shoot;                  /* take a screenshot of the next frame */
    bool changed;                /* v->want has changed: restart at the end of the iteration */
    char change[128];            /* and show this text */

    uint32_t show;               /* MASU_SHOW_*; SPLIT and MAP need B */
    double split;                /* position of the dividing line, 0..1 */
    uint32_t hud;
    masu_panels panels;
    masu_view_look look;
    masu_capture recorder;
    masu_gallery gallery;
    masu_picked picked;
    masu_difference difference;
    masu_baker baker;
    bool quit;
    int mouse[2];                /* position set by a script */
    bool hidden;                 /* minimised: nothing is drawn */
    uint64_t moved;              /* frame in which camera or time were last set by hand */
    double turn_seconds;         /* duration of the last iteration */

    uint64_t turns, frames;      /* of the loop; presented */
    uint64_t submitted_ns[MASU_WINDOW_FLIGHT];
    uint64_t finished_ns;        /* end of the newest frame, as observed */
    bool slot_known[MASU_WINDOW_FLIGHT]; /* its last frame was rendered by the current A */
    uint32_t slot_of_a[MASU_WINDOW_FLIGHT];
    masu_stats_info stats;
    double wall_ms;              /* between frames, smoothed */

    char note[256];              /* last action, shown for a while */
    uint64_t note_turn;
    char trouble[1024];          /* failure of the last reload, shown until one succeeds */
    char error[1024];            /* of the call that returned false */
} masu_viewer;

/* Opens window, device, scene and renderer. On false v->error has the reason; call close even
 * then. */
bool masu_viewer_open(masu_viewer *v);
void masu_viewer_close(masu_viewer *v);

/* Waits until the GPU is idle. */
void masu_viewer_settle(masu_viewer *v);
/* Ends the program: a frame exceeded the time limit of a wait. */
_Noreturn void masu_viewer_give_up(const masu_viewer *v);

/* Recreates A from v->want, and B if it is shown. True with v->trouble set: v->want was rejected
 * and restored. */
bool masu_viewer_restart(masu_viewer *v);
/* Changes v->show; creates or destroys B. */
bool masu_viewer_show(masu_viewer *v, uint32_t show);
/* Resizes swapchain, stages and overlay to the window's current size. */
bool masu_viewer_resize(masu_viewer *v);
/* Loads another blob. fresh: it is a new scene, so reset camera and time. True with v->trouble set:
 * the blob is unusable and the scene is unchanged. */
bool masu_viewer_load(masu_viewer *v, const char *path, bool fresh);
/* Attaches the user interface with the existing thumbnails. */
bool masu_viewer_attach_ui(masu_viewer *v);
/* After v->lost: destroys and recreates everything of the device. */
bool masu_viewer_recover(masu_viewer *v);

/* Shows a line in the overlay for a while. */
void masu_viewer_note(masu_viewer *v, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void masu_viewer_setting(const masu_viewer *v, const masu_rung *rung, char out[MASU_SETTING_ID]);
/* The current camera. */
void masu_viewer_camera(const masu_viewer *v, masu_camera *out);

/* frame.c: renders one frame. Returns true if it was drawn, or if there was nothing to draw to. */
bool masu_viewer_frame(masu_viewer *v);
/* Writes the last frame as PNG; clean: without panels and text. */
bool masu_viewer_screenshot(masu_viewer *v, const char *path, bool clean);

/* input.c, keys.c */
typedef struct masu_hands {
    bool held[8]; /* forward, back, left, right, up, down, fast, look */
    bool dragging;
    double yaw, pitch; /* of the mouse since the last iteration */
    SDL_GameController *pad;
} masu_hands;
bool masu_hands_event(masu_hands *h, masu_viewer *v, const SDL_Event *event);
void masu_hands_move(masu_hands *h, masu_viewer *v, double seconds);
void masu_hands_close(masu_hands *h);
bool masu_key_pressed(masu_viewer *v, SDL_Keycode key, uint16_t modifiers);
void masu_pad_pressed(masu_viewer *v, uint8_t button);

/* hud.c, panels.c, panel_*.c: items of the user interface, between masu_ui_begin and masu_ui_end */
void masu_hud_draw(masu_viewer *v);
void masu_panels_draw(masu_viewer *v);
void masu_panels_show(masu_viewer *v, uint32_t tab); /* opens it with keyboard focus; closes it if
                                                      * it is open */
void masu_panel_scene(masu_viewer *v);
void masu_panel_light(masu_viewer *v);
void masu_panel_quality(masu_viewer *v);
void masu_panel_camera(masu_viewer *v);
void masu_panel_capture(masu_viewer *v);

/* look.c */
void masu_look_reset(masu_viewer *v); /* from the scene that was just loaded */
void masu_look_keep(masu_viewer *v);  /* after a rebake of the same scene: keeps changes that still
                                       * fit */
void masu_look_light(masu_viewer *v); /* sets sun and exposure from angles and factors */
/* Before a frame: sets lights, models and clips of a renderer, and the frame's members. */
bool masu_look_apply(masu_viewer *v, masu_renderer *m, masu_frame_desc *frame);
void masu_look_advance(masu_viewer *v, double seconds);

/* capture.c */
void masu_capture_path(masu_viewer *v, bool on);
void masu_capture_play(masu_viewer *v, bool on);
void masu_capture_step(masu_viewer *v, double seconds);      /* records a key of the path when
                                                              * due */
bool masu_capture_camera(const masu_viewer *v, masu_camera *out); /* of a path that plays */
void masu_capture_save(masu_viewer *v);                      /* the path, as a scene description */
void masu_capture_film(masu_viewer *v, bool on);
bool masu_capture_frame(masu_viewer *v);                     /* after a frame: appends it to the
                                                              * video */
bool masu_capture_still(masu_viewer *v);                     /* a screenshot under a new name */
void masu_capture_close(masu_viewer *v);

/* gallery.c */
void masu_gallery_open(masu_viewer *v);
bool masu_gallery_poll(masu_viewer *v);
void masu_gallery_draw(masu_viewer *v);
void masu_gallery_close(masu_gallery *g);

/* pick.c: masu_pick_click takes window coordinates. masu_pick_ask requests the pixel in a frame,
 * and masu_pick_asked notes the slot of that frame. masu_pick_take reads the result after the slot
 * has finished; masu_pick_draw shows it. */
void masu_pick_click(masu_viewer *v, int x, int y);
void masu_pick_ask(masu_viewer *v, masu_frame_desc *frame);
void masu_pick_asked(masu_viewer *v, uint32_t slot);
void masu_pick_take(masu_viewer *v, uint32_t slot);
void masu_pick_draw(masu_viewer *v);

/* difference.c */
bool masu_difference_step(masu_viewer *v); /* after a frame: copies images, shows finished maps */
/* RGBA8 colour of an error of 0 to 1: black, violet, orange, yellow, white. */
uint32_t masu_difference_color(float error);
void masu_difference_close(masu_difference *d);

/* bake.c */
bool masu_baker_start(masu_viewer *v);  /* opens the file of the command line; a script waits for
                                         * it */
/* Opens a file of any kind; anything but a blob is baked first. Errors are in v->trouble. */
void masu_baker_open(masu_viewer *v, const char *path);
bool masu_baker_poll(masu_viewer *v);   /* loads changed files; false: device lost */
bool masu_baker_wait(masu_viewer *v);   /* until no bake runs */
void masu_baker_again(masu_viewer *v);  /* with another rotation or variant */
void masu_baker_progress(const masu_viewer *v, float *fraction, char *text, size_t size);
void masu_baker_close(masu_baker *b);
void masu_baker_read_variants(masu_viewer *v); /* variants.c: of the source */
/* Starts `words` in sh with these arguments as "$@" and stderr in `log`. Returns 0 on failure, with
 * v->error set. */
long masu_child_start(masu_viewer *v, const char *words, const char *log, char *const arguments[]);
bool masu_child_ended(long child, bool wait, int *status);
void masu_child_end(long child);
void masu_program_beside(char *out, size_t size, const char *name);

/* loop.c: returns an exit code */
struct masu_script;
/* SIGINT, SIGTERM and SIGHUP end masu_viewer_run as closing the window does; a second one ends the
 * process. */
void masu_viewer_catch_signals(void);
int masu_viewer_run(masu_viewer *v, struct masu_script *script);

#endif
