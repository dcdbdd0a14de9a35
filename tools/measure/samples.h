/* samples.h: frame times of alternating candidates, and their statistics.
 *
 * Sample k of all candidates is from the same round: a disturbance of the machine affects all of
 * them. Ratios are therefore computed per round, and their median is used. There are two clocks:
 * the wall clock, from masu_frame to the fence, and the GPU timestamps. Owns nothing, allocates
 * nothing. */
#ifndef MASU_MEASURE_SAMPLES_H
#define MASU_MEASURE_SAMPLES_H

#include <stdint.h>

#define MASU_SAMPLES_MAX 999u

typedef struct masu_samples {
    double wall[MASU_SAMPLES_MAX], gpu[MASU_SAMPLES_MAX]; /* ms */
    uint32_t count, plausible;
} masu_samples;

/* Adds one sample: the times of `frames` frames on both clocks. It is plausible if the timestamps
 * are 0.5 to 1.05 of the wall-clock time (Mesa 22.3's lavapipe fails this). */
void masu_samples_add(masu_samples *s, double wall_ms, double gpu_ms, uint32_t frames);

/* Median over rounds of own[k] / base[k]; NAN if a base is not above 0. Call it before
 * masu_samples_sort. */
double masu_samples_ratio(const double *base, const double *own, uint32_t n);

/* Sorts each clock separately, which loses the rounds. */
void masu_samples_sort(masu_samples *s);

/* The nearest of n sorted samples; share 0 is the minimum, 0.5 the median. */
double masu_samples_at(const double *sorted, uint32_t n, double share);

#endif
