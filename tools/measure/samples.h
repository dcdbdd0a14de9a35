/* samples.h: times of frames of things that take turns, and what is made of them.
 *
 * Sample k of all things is of the same round: what the machine did meanwhile hit all of them, so
 * ratios are made round by round and their median is taken. Both clocks are kept: the wall's, from
 * masu_frame to the fence, and the device's timestamps. Owns nothing, allocates nothing. */
#ifndef MASU_MEASURE_SAMPLES_H
#define MASU_MEASURE_SAMPLES_H

#include <stdint.h>

#define MASU_SAMPLES_MAX 999u

typedef struct masu_samples {
    double wall[MASU_SAMPLES_MAX], gpu[MASU_SAMPLES_MAX]; /* ms */
    uint32_t count, plausible;
} masu_samples;

/* One more, of so many frames: what both clocks showed in all of them. It is plausible if the
 * timestamps are 0.5 to 1.05 of the wall (Mesa 22.3's lavapipe gets them wrong). */
void masu_samples_add(masu_samples *s, double wall_ms, double gpu_ms, uint32_t frames);

/* Median over rounds of own[k] / base[k]; NAN if a base is not above 0. Before they are sorted. */
double masu_samples_ratio(const double *base, const double *own, uint32_t n);

/* Each clock by itself; rounds are lost. */
void masu_samples_sort(masu_samples *s);

/* The nearest one that is there, of n sorted ones; share 0 is the least, 0.5 the median. */
double masu_samples_at(const double *sorted, uint32_t n, double share);

#endif
