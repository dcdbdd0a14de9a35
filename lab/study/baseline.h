/* baseline.h: compares whole frames of some settings with a baseline renderer: at their own errors,
 * and at equal error, with as many samples per pixel of the baseline as needed.
 *
 * THE BASELINE draws everything in the scene without shortcuts: at the output's size, with a
 * separate march per pixel, every instance unculled in its finest form, every light at every pixel,
 * ambient occlusion and one unfiltered specular ray at each pixel, no anti-aliasing, and nothing
 * kept between frames. It is a renderer with debug.reference and debug.ao_full whose frames are all
 * cuts; masu_baseline_spare() returns the work in it that such a renderer would not need.
 *
 * IMAGES. A setting's image is the last of several frames in which the camera follows its path up
 * to the time of the ground truth, in steps of `step`. The baseline's image with k samples is the
 * mean of k frames, each with another position in the pixel and other rays, like the ground truth
 * (measure/picture.h); textures then have the mips for k times the pixels. Equal error is searched
 * with Masu's own march in the baseline's images, which finds surfaces to 0.002 of a pixel: the
 * plain march stops at 0.1, an error that more samples do not reduce. Times, and the error of the
 * plain renderer itself, use the plain march.
 *
 * TIMES. Each entry has its own renderer, so that its history is kept as in a game. They take
 * turns: first in motion along the path, then still. The first round of both is dropped. Ratios
 * are medians over rounds (measure/samples.h). A frame of k samples is assumed to take k times as
 * long as one of one sample, except for the shadow maps, which a moment needs once; computing the
 * mean is free. */
#ifndef MASU_BENCH_BASELINE_H
#define MASU_BENCH_BASELINE_H

#include "measure/samples.h"
#include "settings/setting.h"
#include "session.h"

#define MASU_BASELINE_SETTINGS 8u
#define MASU_BASELINE_ENTRIES (2 + MASU_BASELINE_SETTINGS) /* the plain ones first */
#define MASU_BASELINE_SAMPLES 1024u
#define MASU_BASELINE_POINTS 128u

enum { MASU_BASELINE_FLIP, MASU_BASELINE_RMSE, MASU_BASELINE_SSIM, MASU_BASELINE_METRICS };
enum { MASU_BASELINE_MOTION, MASU_BASELINE_REST, MASU_BASELINE_PHASES };

typedef struct masu_baseline_desc {
    const char *scene_path;
    const char *truth_path; /* NULL: drawn, and not kept */
    const char *image_dir;  /* NULL: none; else SCENE.NAME.png of all compared images */
    VkExtent2D size;
    double time;
    uint32_t positions, rays; /* of the ground truth */
    uint32_t frames;          /* before an image is taken, */
    double step;              /* this many seconds apart along the camera's path; 0: still */
    uint32_t runs;            /* timed ones of each phase; 0: none */
    uint32_t most;            /* samples of the baseline, at most MASU_BASELINE_SAMPLES */
    bool own_march;           /* for equal error use the scene's own march */
    bool curve;               /* also its error at each power of two up to `most` */
    const masu_rung *rungs;
    uint32_t rung_count; /* 1 to MASU_BASELINE_SETTINGS */
    masu_headless_desc host;
    void (*progress)(const char *text); /* or NULL */
} masu_baseline_desc;

/* Lower is better in all: SSIM's is 1 - SSIM. RMSE is of 1. */
typedef struct masu_baseline_errors {
    double of[MASU_BASELINE_METRICS];
} masu_baseline_errors;

typedef struct masu_baseline_time {
    double wall_ms, gpu_ms;  /* least */
    double ratio, gpu_ratio; /* the plain one's time / this time */
    double least_ratio;      /* of the least wall times; far from `ratio`: the machine was busy */
    double plausible;        /* share of the samples with plausible timestamps */
} masu_baseline_time;

typedef struct masu_baseline_entry {
    char name[MASU_SETTING_ID]; /* of a setting; "plain"; "plain, ao as ours" */
    bool plain;
    VkExtent2D render;
    masu_baseline_errors errors;
    masu_baseline_time times[MASU_BASELINE_PHASES];
    uint32_t pass_count;
    const char *pass_names[MASU_MAX_PASSES];
    double pass_ms[MASU_MAX_PASSES]; /* least, in motion; 0: does not run */
    /* Counts of one frame. */
    uint64_t evals, occlusion_evals, specular_rays, specular_nodes, specular_evals, light_tests;
    uint64_t draws, triangles;
    /* The lowest sample count found at which the baseline's error is at most this setting's; 0: not
     * with `most`. */
    uint32_t samples[MASU_BASELINE_METRICS];
} masu_baseline_entry;

/* The baseline's error by samples, for those that were needed. */
typedef struct masu_baseline_point {
    uint32_t samples;
    masu_baseline_errors errors;
} masu_baseline_point;

typedef struct masu_baseline {
    char scene[128], driver[1024];
    const char *march; /* of the baseline: "plain", "auto" (the blob has no other), "none" (no
                        * SDF) */
    uint32_t entry_count, plain_count, point_count, messages;
    masu_baseline_entry entries[MASU_BASELINE_ENTRIES];
    masu_baseline_point points[MASU_BASELINE_POINTS];
} masu_baseline;

/* On false `error` holds one line. */
bool masu_baseline_run(const masu_baseline_desc *desc, masu_baseline *out, char *error,
                       size_t error_size);

/* The baseline's rung for a scene, and the name of its march. */
masu_rung masu_baseline_rung(const masu_scene *scene, const char **march);

/* The share (0..1) of a plain frame's time in passes that only this renderer needs: velocities that
 * nothing uses, the sum of rays. */
double masu_baseline_spare(const masu_baseline_entry *plain);

/* The share that k samples of a moment need only once: shadow maps, the SDF's slots. By
 * timestamps. */
double masu_baseline_once(const masu_baseline_entry *plain);

/* The baseline's time with k samples divided by the setting's time, in motion. */
double masu_baseline_equal(const masu_baseline *b, const masu_baseline_entry *setting, uint32_t k);

/* The least k up to `most` for which enough(user, k) is 1: doubled from 1, then bisected until the
 * remaining range is within an eighth of k. enough: 1, 0, or -1: failed. Returns 0: there is none;
 * UINT32_MAX: failed. */
uint32_t masu_baseline_least(uint32_t most, int (*enough)(void *user, uint32_t k), void *user);

#endif
