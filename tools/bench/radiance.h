/* radiance.h: a setting's image before exposure and tone curve: HDR-FLIP against the truth's,
 * and the error of its reflections.
 *
 * The same frames in motion as the picture's, of a session of its own that reads radiance back:
 * what is timed reads nothing back. Only at the output's size: below it the image has other pixels
 * than the truth. What is done after the tone curve (anti-aliasing, sharpening) is not in it: such
 * settings have no HDR-FLIP, but the error of reflections that all others have.
 *
 * REFLECTIONS. relMSE (measure/specular.h) of pixels that trace, against as many rays a pixel as
 * the truth has in all, through its middle. It is radiance of the whole pixel: what other knobs
 * change there is in it, too.
 *
 * A masu_radiance_bench is allocated by masu_radiance_open. Functions that fail write one line to
 * `error`. */
#ifndef MASU_BENCH_RADIANCE_H
#define MASU_BENCH_RADIANCE_H

#include "measure/motion.h"

typedef struct masu_radiance_desc {
    masu_session_desc session; /* scene, host, output and targets */
    masu_motion motion;
    const float *truth;      /* 3 floats a pixel; outlives the bench */
    const char *reflections; /* the reference as PFM: read if it is there, else written */
    uint32_t rays;           /* of it */
    void (*progress)(const char *text); /* or NULL */
} masu_radiance_desc;

typedef struct masu_radiance_bench masu_radiance_bench;

typedef struct masu_radiance_error {
    double hdr_flip, specular_relmse; /* NaN: there is none */
} masu_radiance_error;

/* Reads or draws the reference, if the scene traces reflections. NULL: failed. */
masu_radiance_bench *masu_radiance_open(const masu_radiance_desc *d, char *error,
                                        size_t error_size);

bool masu_radiance_measure(masu_radiance_bench *b, const masu_rung *rungs, uint32_t count,
                           masu_radiance_error *out, char *error, size_t error_size);

/* Of the validation layer, in all sessions so far. */
uint32_t masu_radiance_messages(const masu_radiance_bench *b);
void masu_radiance_close(masu_radiance_bench *b); /* NULL is nothing */

#endif
