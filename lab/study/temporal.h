/* temporal.h: compares images with and without temporal upscaling, with a still and a moving
 * camera, with ground truth: the gain from `rung.temporal` over single frames.
 *
 * All variants end at the same moment. Flicker is the mean absolute difference, of 255, of the last
 * two frames; in slow motion the difference of the two ground truths is subtracted. The error of an
 * image of few samples varies by 4 % with the position of the last samples, so figures are means
 * over several starts of the jitter sequence. */
#ifndef LAB_TEMPORAL_H
#define LAB_TEMPORAL_H

#include "session.h"

typedef enum masu_past_way { MASU_PAST_NONE, MASU_PAST_OWN, MASU_PAST_WAYS } masu_past_way;
typedef enum masu_past_motion {
    MASU_PAST_REST,
    MASU_PAST_SLOW,
    MASU_PAST_FAST,
    MASU_PAST_MOTIONS
} masu_past_motion;

/* "without", "temporal"; "rest", "slow", "fast" */
extern const char *const masu_past_ways[MASU_PAST_WAYS];
extern const char *const masu_past_motions[MASU_PAST_MOTIONS];

enum { MASU_PAST_SCALES = 8 };

typedef struct masu_past_desc {
    const char *scene_path;
    const char *truth_path; /* PNG, read or written, and FILE.before.png next to it; NULL:
                             * neither */
    const char *image_dir;  /* NULL: none; else SCENE.SCALE.WAY.MOTION.png and SCENE.truth.png */
    VkExtent2D size;
    double time;               /* of the last frame */
    uint32_t positions, rays;  /* of the ground truth */
    uint32_t frames;           /* with still camera and in slow motion, 1/60 s apart */
    uint32_t fast_frames;      /* 1/8 s apart */
    uint32_t starts;           /* means are over this many images, each 5 frames longer than the
                                * last; 0: one */
    uint32_t only;             /* bits 1 << MASU_PAST_...: the ways to draw; 0: all */
    double scales[MASU_PAST_SCALES];
    uint32_t scale_count;
    masu_headless_desc host;
    void (*progress)(const char *text); /* or NULL */
} masu_past_desc;

typedef struct masu_past_row {
    masu_past_way way;
    double scale;
    uint32_t render_width, render_height;
    double flip[MASU_PAST_MOTIONS];
    double flicker[MASU_PAST_FAST]; /* of a still camera and of slow motion */
} masu_past_row;

typedef struct masu_past {
    char driver[1024];
    masu_past_row rows[MASU_PAST_SCALES * MASU_PAST_WAYS];
    uint32_t row_count;
    uint32_t messages; /* of the validation layer */
} masu_past;

/* On false `error` holds one line. */
bool masu_past_run(const masu_past_desc *desc, masu_past *out, char *error, size_t error_size);

#endif
