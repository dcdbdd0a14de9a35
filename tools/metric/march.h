/* march.h: errors of rendered surfaces against the ground truth, and whether they correlate with
 * the march's patterns: its checkerboard, its tiles.
 *
 * Works on a list of samples, one per compared pixel. masu_march_errors_of allocates a scratch
 * array for percentiles; lack of memory is its only failure. */
#ifndef MASU_METRIC_MARCH_H
#define MASU_METRIC_MARCH_H

#include <stdbool.h>
#include <stdint.h>

/* One pixel, rendered and true. Distances along the ray; below 0: no hit. */
typedef struct masu_march_sample {
    uint32_t x, y;
    double t, truth;
    double pixel;        /* width of the pixel's cone at distance 1 */
    double normal_angle; /* degrees between the normals, if both hit */
} masu_march_sample;

/* Error rates of two classes of pixels, and the significance of their difference. */
typedef struct masu_class_test {
    uint64_t count[2], wrong[2];
    double rate[2]; /* wrong / count */
    double z;       /* two proportions, pooled, with continuity correction: class 0 minus class 1 */
    double chi2;    /* z squared: one degree of freedom; above 10.8 the probability is 1 in 1000 */
    double p;       /* exact two-sided binomial: probability of a split at least as uneven */
    double error[2]; /* mean depth error if both hit, in pixels, each at most 4 */
    double error_z;  /* Welch's z of that mean: class 0 minus class 1 */
} masu_class_test;

typedef struct masu_march_errors {
    uint64_t samples, hits; /* hits: in both */
    double hitmiss_pct;     /* of all samples: only one hits */
    double depth_off_pct;   /* of hits: the distance error exceeds 1 % */
    double depth_mean_px, depth_p99_px, depth_max_px; /* |t - truth|, in pixel widths there */
    double normal_mean, normal_p99, normal_max;       /* degrees */
    masu_class_test checker;                          /* class 0: x + y even (phase 1) */
    masu_class_test border;                           /* class 0: the rim of a 16x16 tile */
} masu_march_errors;

/* A sample is wrong if hit and miss differ or the distance error exceeds 1 %. Returns false if
 * there is no memory. */
bool masu_march_errors_of(const masu_march_sample *samples, uint64_t count, masu_march_errors *out);

/* Computes z, chi2, p and the rates from count and wrong. */
void masu_class_test_finish(masu_class_test *test);

#endif
