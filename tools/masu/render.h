/* render.h: the options and measurements of `masu render`. render.c renders, render_scene.c changes
 * the scene, render_stats.c reports. */
#ifndef MASU_CMD_RENDER_H
#define MASU_CMD_RENDER_H

#include "masu/cmd.h"

/* Options that set one knob of every rung; without them the ladder's value remains. */
typedef struct masu_turned {
    bool cull_given, lod_given, aa_given;
    uint32_t cull;
    masu_rung to;
} masu_turned;

#define MASU_RENDER_PARAMS_MAX 64u

typedef struct masu_render_options {
    masu_session_desc d;
    masu_turned turned;
    const char *output, *video, *stats, *times, *ladder;
    double target_ms; /* of the governor; 0: no governor */
    uint32_t frames, rung, ray_way, tone;
    uint32_t first;     /* number of the first frame */
    bool still;         /* static frames until the image has settled */
    uint32_t rays;      /* reflection rays per pixel, one per frame; 0: no reference */
    uint32_t positions; /* samples per pixel of the ground truth; 0: none */
    double time, time_step;
    double sun[2], turbidity; /* azimuth and elevation, degrees */
    double exposure;          /* 0: the scene's */
    double anisotropy;
    double bloom, aperture, focus, vignette, brightness, gamma;
    const char *lut_path;
    float *lut;        /* colours of that file, */
    uint32_t lut_size; /* points per axis; 0: there is none */
    masu_post post;    /* of every frame */
    bool own_sun, casters, poison, split, dither;
    const char *clip;         /* animation clip of models; NULL: the first */
    const char *params[MASU_RENDER_PARAMS_MAX]; /* "NAME=VALUE" */
    uint32_t param_count;
    float sdf_params[MASU_MAX_SDF_PARAMS]; /* for every frame, if --param is given */
    uint32_t sdf_param_count;
    bool at_rest; /* models with clips do not play them */
} masu_render_options;

/* render_scene.c: resolves --param and --clip in the scene. On false `error` is one line. */
bool masu_render_read_scene(masu_render_options *o, char *error, size_t size);
/* Plays a clip on every model that has clips. */
bool masu_render_animate(masu_session *s, const masu_render_options *o, double time, char *error,
                         size_t size);

/* render_post.c: the effects on the image, and the colour table's file. On false `error` is one
 * line. */
bool masu_render_read_post(masu_render_options *o, char *error, size_t size);
bool masu_render_set_lut(masu_session *s, const masu_render_options *o, char *error, size_t size);

/* One measured frame. */
typedef struct masu_sample {
    double wall_ms, gpu_ms;
    uint32_t rung;
    const char *reason; /* of the governor */
    double pass_ms[MASU_MAX_PASSES];
    uint64_t library_allocs, driver_allocs, driver_callbacks;
} masu_sample;

/* --stats: JSON of `n` samples and the last frame's counts. Returns an exit code. */
int masu_render_stats(const masu_session *s, const masu_render_options *o,
                      const masu_sample *samples, uint32_t n, const masu_stats_info *last);

/* --times: a CSV row for each frame. Returns an exit code. */
int masu_render_times(const masu_session *s, const masu_render_options *o,
                      const masu_sample *samples);

/* Prints the governor's measurements and decisions to stdout. */
void masu_render_governor(const masu_session *s, const masu_render_options *o,
                          const masu_sample *samples, const masu_governor_info *g);

#endif
