/* viewer.h: the state of masu-view, one struct, and what changes it as a whole. Each file beside this one
 * is one thing that is done with it:
 *
 *   main.c     options              input.c   events to actions    frame.c       one frame to the window
 *   loop.c     turn after turn      keys.c    what each key does   difference.c  FLIP of A and B
 *   script.c   events by number     hud.c     the text on top      bake.c        files: opened, baked, watched
 *   stage.c    a renderer           panels.c  panels, messages     gallery.c     the start page
 *   compose.c  the host's own pass  panel_*.c one panel each       look.c        what panels change in the scene
 *   pick.c     what a click is on   ui.cpp    Dear ImGui           capture.c     camera paths, images, video
 *
 * A is what is looked at; B is what it is compared with, and exists while it is shown. Both draw the same
 * scene from the same blob, which stays in memory: a changed knob makes the renderer anew. Without a scene
 * there is neither, and the window has the start page, or what is being baked. */
#ifndef MASU_VIEW_VIEWER_H
#define MASU_VIEW_VIEWER_H

#include "view/compose.h"
#include "view/fly.h"
#include "view/stage.h"
#include "view/ui.h"
#include "view/window.h"

#include "command/video.h"
#include "settings/setting.h"

#define MASU_VIEWER_STEP (1.0 / 60.0) /* seconds a frame, where a script says what happens when */
#define MASU_VIEWER_FILM_STEP (1.0 / 30.0) /* while a video is recorded, however long a frame takes */

typedef struct masu_viewer_options {
    const char *scene;   /* any file that can be opened; NULL: baked from `json`, or the start page */
    const char *json;    /* the description of `scene`; NULL: none */
    const char *bake;    /* a command that bakes it; NULL: masu-bake beside this program */
    const char *gallery; /* folder of the start page's scenes; NULL: none */
    const char *cache;   /* folder of its pictures; NULL: beside other temporary files, and removed */
    const char *script, *screenshot, *setting, *ladder;
    VkExtent2D size;
    masu_headless_desc host;
    uint32_t rays; /* masu_ray_ways */
    uint32_t rung;
    uint32_t frames; /* stop, or take the screenshot, after so many; 0: never */
    double time, target_ms;
    bool quit;          /* after `frames` */
    bool rung_given;    /* else the governor chooses */
    bool no_vsync, no_timestamps, counters;
} masu_viewer_options;

enum { MASU_HUD_OFF, MASU_HUD_SHORT, MASU_HUD_FULL, MASU_HUD_LEVELS };
enum { MASU_SHOW_A, MASU_SHOW_SPLIT, MASU_SHOW_MAP };

/* A file that is watched. */
typedef struct masu_watch {
    char path[1024];
    int64_t seconds, nanoseconds, bytes; /* of its last change; all 0: it is not there */
} masu_watch;

#define MASU_WATCHES_MAX 64u
#define MASU_VARIANTS_MAX 32u

typedef struct masu_baker {
    char folder[1024];           /* of what is made here; empty: there is none yet */
    char output[1100], log[1100];
    char source[1024];           /* that is baked when it changes; empty: `blob` itself is watched */
    char blob[1100];             /* that was loaded last */
    masu_watch watches[MASU_WATCHES_MAX];
    uint32_t count;
    long child;                  /* the process that bakes; 0: none */
    uint64_t looked_ns, begun_ns;
    bool again;                  /* something has changed since it began */
    bool opens;                  /* another file than what is shown: camera and time begin anew */
    float turn;                  /* degrees that the environment map is turned by */
    char variant[128];           /* of the model's materials; empty: the file's */
    char variants[MASU_VARIANTS_MAX][128]; /* that the file has */
    uint32_t variant_count;
} masu_baker;

/* How the clips of a model play. */
typedef struct masu_playback {
    uint32_t clip, other;        /* `other` is blended in by `blend`, 0..1 */
    float blend, speed;
    double time;
    bool plays, loops;
} masu_playback;

#define MASU_LOOK_ITEMS 64u      /* models and lights that panels list */

/* What panels have changed in the scene, until another one is opened. */
typedef struct masu_view_look {
    masu_light light, from;      /* of frames; of the scene */
    bool has_light;
    float azimuth, elevation, sun, stops; /* of `light`: degrees; factor on the scene's sun; exposure, powers of two */
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
    double time;                 /* since it began */
    bool films, clean;           /* writes a video; without panels and text */
    masu_video video;
    uint64_t filmed;             /* frames */
    char name[64];
} masu_capture;

typedef struct masu_panels {
    bool open, focus;            /* focus: the keyboard goes there in the next frame */
    uint32_t tab;                /* MASU_TAB_* */
    bool select;                 /* show `tab` in the next frame */
} masu_panels;
enum { MASU_TAB_SCENE, MASU_TAB_LIGHT, MASU_TAB_QUALITY, MASU_TAB_CAMERA, MASU_TAB_CAPTURE, MASU_TABS };

#define MASU_GALLERY_MAX 64u

typedef struct masu_gallery {
    bool open;
    char paths[MASU_GALLERY_MAX][512];
    uint8_t *pictures[MASU_GALLERY_MAX];
    uint32_t count, made;        /* pictures below `made` are there, or cannot be */
    long child;                  /* the process that makes one */
    char picture[1100], folder[1024];
    bool stale;                  /* there is a picture that the interface does not have yet */
} masu_gallery;

typedef struct masu_difference {
    SDL_Thread *thread;          /* NULL: none runs */
    SDL_atomic_t done;           /* set by it */
    uint8_t *a, *b;              /* copies of both pictures; RGBA8 */
    float *errors;
    uint32_t width, height;
    double mean, p99, max;
    bool failed, known;          /* no memory; the numbers above are of something */
    uint64_t taken;              /* frame that the pictures were taken at */
    bool paused;                 /* and whether time stood still then: once is enough */
} masu_difference;

typedef struct masu_picked {
    bool asked;                  /* by the next frame, for that pixel: */
    uint32_t x, y;
    bool of_slot[MASU_WINDOW_FLIGHT]; /* its last frame has asked */
    double near_distance;        /* of the frame that has */
    char text[256];              /* what the last click was on; "": there was none */
    int at[2];
    uint64_t turn;
} masu_picked;

typedef struct masu_viewer {
    const masu_viewer_options *o;
    bool scripted;               /* no clock: each frame is MASU_VIEWER_STEP long */

    masu_window window;
    masu_headless host;
    VkPipelineCache cache;
    masu_pipelines pools[2];     /* pipelines of A and B, from one start to the next */
    VkFence fences[MASU_WINDOW_FLIGHT];
    bool pending[MASU_WINDOW_FLIGHT];
    bool lost;                   /* the device is: all is to be made anew */
    bool lose;                   /* a script asks for that */
    uint32_t losses;             /* since a frame was last finished */

    void *blob;
    masu_scene scene;
    masu_detail detail;          /* of the masu_* call that failed */
    masu_desc want;              /* rungs, governor and all else that is asked of A */
    masu_desc given;             /* as the command line has it, before defaults are filled in */
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

    bool shoot;                  /* a screenshot of the next frame */
    bool changed;                /* v->want has been: restart at the end of the turn, */
    char change[128];            /* and say that it was this */

    uint32_t show;               /* MASU_SHOW_*; SPLIT and MAP have B */
    double split;                /* where the line is, 0..1 */
    uint32_t hud;
    masu_panels panels;
    masu_view_look look;
    masu_capture recorder;
    masu_gallery gallery;
    masu_picked picked;
    masu_difference difference;
    masu_baker baker;
    bool quit;
    int mouse[2];                /* where a script has put it */
    bool hidden;                 /* minimised: nothing is drawn */
    uint64_t moved;              /* frame at which camera or time were last set by hand */
    double turn_seconds;         /* that the last turn took */

    uint64_t turns, frames;      /* of the loop; that reached the window */
    uint64_t submitted_ns[MASU_WINDOW_FLIGHT];
    uint64_t finished_ns;        /* of the newest frame that was seen to finish */
    bool slot_known[MASU_WINDOW_FLIGHT]; /* its last frame was drawn by the present A */
    uint32_t slot_of_a[MASU_WINDOW_FLIGHT];
    masu_stats_info stats;
    double wall_ms;              /* between frames, smoothed */

    char note[256];              /* what was done last: shown for a while */
    uint64_t note_turn;
    char trouble[1024];          /* why the last reload failed: shown until one succeeds */
    char error[1024];            /* of the call that returned false */
} masu_viewer;

/* Window, device, scene, renderer. On false v->error says why; close it all the same. */
bool masu_viewer_open(masu_viewer *v);
void masu_viewer_close(masu_viewer *v);

/* Waits until nothing is drawn. */
void masu_viewer_settle(masu_viewer *v);
/* Ends the program: a frame exceeded the time limit of a wait. */
_Noreturn void masu_viewer_give_up(const masu_viewer *v);

/* Makes A anew from v->want, and B where it is shown. True with v->trouble set: refused, and v->want is
 * as it was. */
bool masu_viewer_restart(masu_viewer *v);
/* B begins or ends to be, as v->show says. */
bool masu_viewer_show(masu_viewer *v, uint32_t show);
/* Swapchain, stages and overlay in the size that the window has now. */
bool masu_viewer_resize(masu_viewer *v);
/* Another blob; fresh: of another scene, whose camera and time begin anew. True with v->trouble set: it is of
 * no use, and the scene is as it was. */
bool masu_viewer_load(masu_viewer *v, const char *path, bool fresh);
/* The user interface anew, with the pictures that there are. */
bool masu_viewer_attach_ui(masu_viewer *v);
/* After v->lost: tears all down and makes it anew. */
bool masu_viewer_recover(masu_viewer *v);

/* One line for the overlay, which goes by itself. */
void masu_viewer_note(masu_viewer *v, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The name of a setting. */
void masu_viewer_setting(const masu_viewer *v, const masu_rung *rung, char out[MASU_SETTING_ID]);
/* Where the camera is now. */
void masu_viewer_camera(const masu_viewer *v, masu_camera *out);

/* frame.c: one frame. True: drawn, or there was nothing to draw to. */
bool masu_viewer_frame(masu_viewer *v);
/* The picture that was shown last, as PNG; clean: without panels and text. */
bool masu_viewer_screenshot(masu_viewer *v, const char *path, bool clean);

/* input.c, keys.c */
typedef struct masu_hands {
    bool held[8]; /* forward, back, left, right, up, down, fast, look */
    bool dragging;
    double yaw, pitch; /* of the mouse since the last turn */
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
void masu_panels_show(masu_viewer *v, uint32_t tab); /* opens it with the keyboard on it; closes it if it is open */
void masu_panel_scene(masu_viewer *v);
void masu_panel_light(masu_viewer *v);
void masu_panel_quality(masu_viewer *v);
void masu_panel_camera(masu_viewer *v);
void masu_panel_capture(masu_viewer *v);

/* look.c */
void masu_look_reset(masu_viewer *v); /* of the scene that was just loaded */
void masu_look_keep(masu_viewer *v);  /* the same scene, baked again: what still fits */
void masu_look_light(masu_viewer *v); /* the sun and exposure from angles and factors */
/* Before a frame: lights, models and clips of both renderers, and the frame's members. */
bool masu_look_apply(masu_viewer *v, masu_renderer *m, masu_frame_desc *frame);
void masu_look_advance(masu_viewer *v, double seconds);

/* capture.c*/
void masu_capture_path(masu_viewer *v, bool on);
void masu_capture_play(masu_viewer *v, bool on);
void masu_capture_step(masu_viewer *v, double seconds);      /* a key of the path, once in a while */
bool masu_capture_camera(const masu_viewer *v, masu_camera *out); /* of a path that plays */
void masu_capture_save(masu_viewer *v);                      /* the path, as a scene description */
void masu_capture_film(masu_viewer *v, bool on);
bool masu_capture_frame(masu_viewer *v);                     /* after a frame: into the video */
bool masu_capture_still(masu_viewer *v);                     /* a screenshot under a new name */
void masu_capture_close(masu_viewer *v);

/* gallery.c */
void masu_gallery_open(masu_viewer *v);
bool masu_gallery_poll(masu_viewer *v);
void masu_gallery_draw(masu_viewer *v);
void masu_gallery_close(masu_gallery *g);

/* pick.c: a click at a point of the window; the frame that asks, and that it was handed out; when its slot has ended;
 * the answer on the picture */
void masu_pick_click(masu_viewer *v, int x, int y);
void masu_pick_ask(masu_viewer *v, masu_frame_desc *frame);
void masu_pick_asked(masu_viewer *v, uint32_t slot);
void masu_pick_take(masu_viewer *v, uint32_t slot);
void masu_pick_draw(masu_viewer *v);

/* difference.c */
bool masu_difference_step(masu_viewer *v); /* after a frame: takes pictures, shows what is done */
/* RGBA8 of an error of 0 to 1: black, violet, orange, yellow, white. */
uint32_t masu_difference_color(float error);
void masu_difference_close(masu_difference *d);

/* bake.c */
bool masu_baker_start(masu_viewer *v);  /* with what the command line has; a script waits for it */
/* A file of any kind: baked first if it is none. What is wrong with it is v->trouble. */
void masu_baker_open(masu_viewer *v, const char *path);
bool masu_baker_poll(masu_viewer *v);   /* true; loads what has changed */
bool masu_baker_wait(masu_viewer *v);   /* until nothing is baked */
void masu_baker_again(masu_viewer *v);  /* with another turn or variant */
void masu_baker_progress(const masu_viewer *v, float *fraction, char *text, size_t size);
void masu_baker_close(masu_baker *b);
void masu_baker_read_variants(masu_viewer *v); /* variants.c: of the source */
/* A process: `words` by sh with these arguments as "$@", and what it says in `log`; 0: v->error. */
long masu_child_start(masu_viewer *v, const char *words, const char *log, char *const arguments[]);
bool masu_child_ended(long child, bool wait, int *status);
void masu_child_end(long child);
void masu_program_beside(char *out, size_t size, const char *name);

/* loop.c: an exit code */
struct masu_script;
/* SIGINT, SIGTERM and SIGHUP end masu_viewer_run as closing the window does; a second one ends the
 * process. */
void masu_viewer_catch_signals(void);
int masu_viewer_run(masu_viewer *v, struct masu_script *script);

#endif
