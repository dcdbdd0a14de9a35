/* hdr_flip.h: HDR-FLIP: FLIP of two images of linear radiance with unknown exposure.
 *
 * P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller: "Visualizing Errors in Rendered High
 * Dynamic Range Images", Eurographics 2021 (short papers). Both images are tone-mapped at a range
 * of exposures with one curve (a fit of ACES by K. Narkowicz, 2016, its input times 0.6). The
 * result is the largest FLIP error of each pixel over all exposures. The first exposure maps the
 * reference's brightest pixel to 0.85, the last its median. There is one exposure per stop between
 * them, rounded up, at least two.
 *
 * One difference from the paper: there are at most 20 stops between first and last. A reference
 * that is more than half black has a median of 0, which gives no last exposure; the authors' code
 * uses the smallest step of its arithmetic instead, which gives about fifty exposures.
 *
 * tests/unit/test_metrics.c compares it with a second, slow implementation, and the exposures with
 * values computed by hand. It has not been run side by side with the authors' code. */
#ifndef MASU_METRIC_HDR_FLIP_H
#define MASU_METRIC_HDR_FLIP_H

#include "metric/flip.h"

#define MASU_HDR_FLIP_STOPS_MAX 20.0

typedef struct masu_exposures {
    double first, last; /* stops: the image is multiplied by 2^stop */
    uint32_t count;     /* evenly spaced, 2 to 20 */
} masu_exposures;

/* 3 floats per pixel, linear sRGB. Negative values and NaN become 0. Returns false if there is no
 * memory. */
bool masu_hdr_flip_exposures(const float *rgb, uint32_t pixels, masu_exposures *out);

/* The tone curve: 0..1 for inputs from 0. */
double masu_hdr_flip_tone(double radiance);

/* 3 floats per pixel, linear sRGB. ppd, map and out: see masu_metric_flip. Returns false if there
 * is no memory. */
bool masu_metric_hdr_flip(const float *reference, const float *test, uint32_t width,
                          uint32_t height, double ppd, float *map, masu_flip *out);

#endif
