/* march.h: how far rendered surfaces are from true ones, and whether the error follows the
 * march's own pattern: its checkerboard, its tiles.
 *
 * Works on a list of samples, one per compared pixel; owns nothing but a scratch array for
 * percentiles during masu_march_errors_of, whose lack of memory is the only failure. */
#ifndef MASU_METRIC_MARCH_H
#define MASU_METRIC_MARCH_H

#include <stdbool.h>
#include <stdint.h>

/* One pixel, rendered and true. Distances along the ray; below 0: nothing hit. */
typedef struct masu_march_sample {
    uint32_t x, y;
    double t, truth;
    double pixel;        /* width of the pixel's cone at distance 1 */
    double normal_angle; /* degrees between the normals, where both hit */
} masu_march_sample;

/* Error rates of two classes of pixels, and how far apart chance would put them. */
typedef struct masu_class_test {
    uint64_t count[2], wrong[2];
    double rate[2]; /* wrong / count */
    double z;       /* two proportions, pooled, with continuity correction: class 0 minus class 1 */
    double chi2;    /* z squared: one degree of freedom; above 10.8 chance is 1 in 1000 */
    double p;       /* exact two-sided binomial: the chance of a split at least as uneven */
    double error[2]; /* mean depth error where both hit, in pixels, each at most 4 */
    double error_z;  /* Welch's z of that mean: class 0 minus class 1 */
} masu_class_test;

typedef struct masu_march_errors {
    uint64_t samples, hits; /* hits: rendered and true */
    double hitmiss_pct;     /* of all samples: one hits, the other does not */
    double depth_off_pct;   /* of hits: distance off by more than 1 % */
    double depth_mean_px, depth_p99_px, depth_max_px; /* |t - truth|, widths of the pixel there */
    double normal_mean, normal_p99, normal_max;       /* degrees */
    masu_class_test checker;                          /* class 0: x + y even (phase 1) */
    masu_class_test border;                           /* class 0: the rim of a 16x16 tile */
} masu_march_errors;

/* A sample is wrong if hit and miss differ or the distance is off by more than 1 %. False: no
 * memory. */
bool masu_march_errors_of(const masu_march_sample *samples, uint64_t count, masu_march_errors *out);

/* z, chi2, p and the rates out of count and wrong. */
void masu_class_test_finish(masu_class_test *test);

#endif
