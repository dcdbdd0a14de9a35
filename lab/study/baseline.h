/* baseline.h: whole frames of some settings beside those of a baseline renderer: at their own
 * errors, and at equal error, the plain one having as many samples a pixel as that takes.
 *
 * THE BASELINE draws all that the scene asks for by the shortest way: the output's size,
 * each pixel's march by itself, every instance in its finest form and unculled, every light asked
 * at every pixel, ambient occlusion and one unfiltered specular ray at each pixel, no
 * anti-aliasing, nothing kept from frame to frame. It is a renderer with debug.reference and
 * debug.ao_full whose frames are all cuts; what it does beyond what such a renderer would need is
 * told by `spare`.
 *
 * PICTURES. A setting's is the last of some frames in which the camera follows its path up to the
 * time of the truth, in steps of `step`. The plain one's with k samples is the mean of k frames, each with another
 * place in the pixel and other rays, as the truth's is (measure/picture.h); textures then have the
 * mips that k times the pixels would take. Equal error is looked for with Masu's own march in those
 * pictures, which finds surfaces to 0.002 of a pixel: the plain one stops at 0.1, which no number of
 * samples mends and a smaller tolerance would. Times are the plain march's. So is the error of the
 * plain renderer itself.
 *
 * TIMES. Each has a renderer of its own, so that its history stays as warm as a game's. They take
 * turns: first in motion, all going on along the path, then at rest. The first round of both is
 * dropped. Ratios are medians over rounds (measure/samples.h). A frame of k samples is taken for k
 * times one of one, but for what a moment needs once, the shadow maps; taking their mean is free. */
#ifndef MASU_BENCH_BASELINE_H
#define MASU_BENCH_BASELINE_H

#include "measure/samples.h"
#include "settings/setting.h"
#include "session.h"

#define MASU_BASELINE_SETTINGS 8u
#define MASU_BASELINE_ENTRIES (2 + MASU_BASELINE_SETTINGS) /* the plain ones come first */
#define MASU_BASELINE_SAMPLES 1024u
#define MASU_BASELINE_POINTS 128u

enum { MASU_BASELINE_FLIP, MASU_BASELINE_RMSE, MASU_BASELINE_SSIM, MASU_BASELINE_METRICS };
enum { MASU_BASELINE_MOTION, MASU_BASELINE_REST, MASU_BASELINE_PHASES };

typedef struct masu_baseline_desc {
    const char *scene_path;
    const char *truth_path; /* NULL: drawn, and not kept */
    const char *image_dir;  /* NULL: none; else SCENE.NAME.png of all that is compared */
    VkExtent2D size;
    double time;
    uint32_t positions, rays; /* of the truth */
    uint32_t frames;          /* before a picture is taken, */
    double step;              /* that many seconds apart along the camera's path; 0: at rest */
    uint32_t runs;            /* timed ones of each phase; 0: none */
    uint32_t most;            /* samples of the baseline, at most MASU_BASELINE_SAMPLES */
    bool own_march;           /* equal error with its own march all the same */
    bool curve;               /* its error at each power of two up to there as well */
    const masu_rung *rungs;
    uint32_t rung_count; /* 1 to MASU_BASELINE_SETTINGS */
    masu_headless_desc host;
    void (*progress)(const char *text); /* or NULL */
} masu_baseline_desc;

/* Less is better in all: SSIM's is 1 - SSIM. RMSE is of 1. */
typedef struct masu_baseline_errors {
    double of[MASU_BASELINE_METRICS];
} masu_baseline_errors;

typedef struct masu_baseline_time {
    double wall_ms, gpu_ms;  /* least */
    double ratio, gpu_ratio; /* of the plain one's time by this */
    double least_ratio;      /* of the least wall times: far from the ratio, it was busy */
    double plausible;        /* share of the samples */
} masu_baseline_time;

typedef struct masu_baseline_entry {
    char name[MASU_SETTING_ID]; /* a setting's; "plain"; "plain, ao as ours" */
    bool plain;
    VkExtent2D render;
    masu_baseline_errors errors;
    masu_baseline_time times[MASU_BASELINE_PHASES];
    uint32_t pass_count;
    const char *pass_names[MASU_MAX_PASSES];
    double pass_ms[MASU_MAX_PASSES]; /* least, in motion; 0: it does not run */
    /* Of one frame. */
    uint64_t evals, occlusion_evals, specular_rays, specular_nodes, specular_evals, light_tests;
    uint64_t draws, triangles;
    /* Of a setting: the least samples found with which the plain one's error is at most this; 0: not
     * with `most`. */
    uint32_t samples[MASU_BASELINE_METRICS];
} masu_baseline_entry;

/* The baseline's error by samples, as far as it was needed. */
typedef struct masu_baseline_point {
    uint32_t samples;
    masu_baseline_errors errors;
} masu_baseline_point;

typedef struct masu_baseline {
    char scene[128], driver[1024];
    const char *march; /* the baseline's: "plain", "auto" (the blob has no other),
                        * "none" (no SDF) */
    uint32_t entry_count, plain_count, point_count, messages;
    masu_baseline_entry entries[MASU_BASELINE_ENTRIES];
    masu_baseline_point points[MASU_BASELINE_POINTS];
} masu_baseline;

/* False: `error` holds one line. */
bool masu_baseline_run(const masu_baseline_desc *desc, masu_baseline *out, char *error, size_t error_size);

/* The baseline's rung for a scene, and the name of its march. */
masu_rung masu_baseline_rung(const masu_scene *scene, const char **march);

/* Part of a plain frame's time in passes that only this renderer needs and no plain one: velocities
 * of what nobody asks the past for, the sum of rays. 0..1 */
double masu_baseline_spare(const masu_baseline_entry *plain);

/* Part of it that k samples of a moment need only once: shadow maps, the SDF's slots. By timestamps. */
double masu_baseline_once(const masu_baseline_entry *plain);

/* How many times as long as a setting the baseline takes with k samples, in motion. */
double masu_baseline_equal(const masu_baseline *b, const masu_baseline_entry *setting, uint32_t k);

/* The least k up to `most` for which enough(user, k) is 1: doubled from 1, then bisected until what is
 * left to find is within an eighth of k. enough: 1, 0, or -1: failed. Returns 0: there is none;
 * UINT32_MAX: failed. */
uint32_t masu_baseline_least(uint32_t most, int (*enough)(void *user, uint32_t k), void *user);

#endif
