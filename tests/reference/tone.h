/* tone.h: tone curves, encodings, metering and dither in double precision, from their definitions:
 * the reference for shaders/shared/tone.glsl and output.glsl. */
#ifndef MASU_REF_TONE_H
#define MASU_REF_TONE_H

#include <stddef.h>
#include <stdint.h>

enum { MASU_REF_TONE_NONE = 1, MASU_REF_TONE_ACES = 2, MASU_REF_TONE_NEUTRAL = 3 };

/* Radiance times exposure to display colour, 1 is white; `most`: the maximum of the neutral
 * curve. */
void masu_ref_tone(int curve, double most, const double in[3], double out[3]);

double masu_ref_srgb_encode(double x); /* clamped to 0..1 */
double masu_ref_srgb_decode(double x);
double masu_ref_pq_encode(double nits);
double masu_ref_pq_decode(double code);
void masu_ref_bt2020(const double in[3], double out[3]);

/* log2 of the mean luminance (rgb, `stride` doubles apart) without the fractions `low` and `high`,
 * from bins of an eighth of an octave. Returns the number of contributing values: finite, and at
 * least 2^-16. */
uint32_t masu_ref_meter(const double *rgb, size_t count, size_t stride, double low, double high,
                        double *mean);

/* The dithered step for v of 0..1 at a pixel, channel 0..2. */
uint32_t masu_ref_dither(double v, uint32_t steps, uint32_t x, uint32_t y, uint32_t frame,
                         uint32_t channel);

#endif
