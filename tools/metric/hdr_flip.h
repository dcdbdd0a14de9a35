/* hdr_flip.h: HDR-FLIP: FLIP of two pictures of linear radiance, of which nobody knows how
 * they will be exposed.
 *
 * P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller: "Visualizing Errors in Rendered High
 * Dynamic Range Images", Eurographics 2021 (short papers). Both pictures are shown at a range of
 * exposures through one tone curve (a fit of ACES by K. Narkowicz, 2016, its input times 0.6);
 * FLIP of each pair; of each pixel the worst. The first exposure shows the reference's brightest
 * pixel at 0.85, the last its median; there are as many as stops between them, rounded up, at least
 * two.
 *
 * One thing is not as in the paper: between first and last are at most 20 stops. A reference that
 * is black in more than half has a median of 0, from which there would be no last exposure; its
 * authors' code takes the least step of its arithmetic instead, and half a hundred exposures.
 *
 * tests/unit/test_metrics.c compares it with a second, slow form, and the exposures with values
 * worked out by hand. It has not been run side by side with the authors' code. */
#ifndef MASU_METRIC_HDR_FLIP_H
#define MASU_METRIC_HDR_FLIP_H

#include "metric/flip.h"

#define MASU_HDR_FLIP_STOPS_MAX 20.0

typedef struct masu_exposures {
    double first, last; /* stops: the picture times 2^stop */
    uint32_t count;     /* evenly apart, 2 to 20 */
} masu_exposures;

/* 3 floats a pixel, linear sRGB. What is below 0 or no number counts as 0. False: no memory. */
bool masu_hdr_flip_exposures(const float *rgb, uint32_t pixels, masu_exposures *out);

/* The curve: 0..1 for 0 and more. */
double masu_hdr_flip_tone(double radiance);

/* 3 floats a pixel, linear sRGB. ppd, map and out: see masu_metric_flip. False: no memory. */
bool masu_metric_hdr_flip(const float *reference, const float *test, uint32_t width,
                          uint32_t height, double ppd, float *map, masu_flip *out);

#endif
