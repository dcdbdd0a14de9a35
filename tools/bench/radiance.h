/* radiance.h: a setting's image before exposure and tone curve: HDR-FLIP against the ground truth,
 * and the error of its reflections.
 *
 * Renders the same frames in motion as for the image, in a separate session with radiance readback,
 * because timed sessions have no readback. Only for the output size: pixels of a smaller image do
 * not match the ground truth. Steps after the tone curve (anti-aliasing, sharpening) are not
 * included: such settings have no HDR-FLIP, but do have the error of reflections.
 *
 * REFLECTIONS. relMSE (measure/specular.h) of pixels that trace. The reference has as many rays per
 * pixel as the ground truth in total, all through the pixel's centre. Radiance is that of the whole
 * pixel, so it includes the effect of other knobs.
 *
 * masu_radiance_open allocates a masu_radiance_bench. Functions that fail write one line to
 * `error`. */
#ifndef MASU_BENCH_RADIANCE_H
#define MASU_BENCH_RADIANCE_H

#include "measure/motion.h"

typedef struct masu_radiance_desc {
    masu_session_desc session; /* scene, host, output and targets */
    masu_motion motion;
    const float *truth;      /* 3 floats per pixel; outlives the bench */
    const char *reflections; /* the reference as PFM: read if it exists, otherwise written */
    uint32_t rays;           /* of the reference */
    void (*progress)(const char *text); /* may be NULL */
} masu_radiance_desc;

typedef struct masu_radiance_bench masu_radiance_bench;

typedef struct masu_radiance_error {
    double hdr_flip, specular_relmse; /* NaN: none */
} masu_radiance_error;

/* Reads or renders the reference, if the scene traces reflections. NULL: failed. */
masu_radiance_bench *masu_radiance_open(const masu_radiance_desc *d, char *error,
                                        size_t error_size);

bool masu_radiance_measure(masu_radiance_bench *b, const masu_rung *rungs, uint32_t count,
                           masu_radiance_error *out, char *error, size_t error_size);

/* Messages of the validation layer in all sessions so far. */
uint32_t masu_radiance_messages(const masu_radiance_bench *b);
void masu_radiance_close(masu_radiance_bench *b); /* ignores NULL */

#endif
