/* gsr2.h: another's way from samples of many frames to one picture, written anew to be measured beside
 * `temporal`: Snapdragon Game Super Resolution 2, the variant of two passes (Qualcomm, 2024; README.md and
 * shaders of sgsr/v2 in its repository). On the CPU, in floats: error is what it is for, not time.
 *
 * What each frame gives is of the render size: a picture of display light, depth as MASU_READBACK_DEPTH, motion.
 * Its history is of the output's size. Where it differs from the original, it is for the better: the history
 * is of floats, not halves; colours of 11, 11 and 10 bits are rounded, not cut off, which tints by 1 or 2 of 255;
 * the curve of bright things is undone exactly, not to 2 %; the motion of what is nearest among 3x3 pixels is that
 * pixel's own, not found from its depth by matrices, so that things which move need no mark; what comes in is display light,
 * as what `temporal` takes the mean of is, and not radiance. For the worse: that comes in 8 bits of sRGB, `temporal`'s in
 * 10 of roots. Neither sharpened nor dithered, as the original.
 *
 * Owns its images. masu_gsr2_open fails for want of memory alone. */
#ifndef MASU_BENCH_GSR2_H
#define MASU_BENCH_GSR2_H

#include <stdbool.h>
#include <stdint.h>

typedef struct masu_gsr2 {
    uint32_t from[2], to[2]; /* render size, output: width, height */
    float *history[2];       /* 3 floats a pixel of the output: luma, two chromas around 0 */
    float *color;            /* the same of the render size */
    float *moves;            /* 3 of the render size: motion as below; how much depth breaks there, 0..1 */
    uint32_t frames;
} masu_gsr2;

typedef struct masu_gsr2_frame {
    const uint8_t *rgba; /* sRGB */
    const float *depth;  /* near / view z; 0: nothing */
    const float *motion; /* 2 floats a pixel: where it was minus where it is, pixels, without the jitter's change */
    float jitter[2];     /* as masu_camera.jitter */
    float tan_x;         /* tangent of half the horizontal field of view */
    bool cut;            /* nothing of before counts */
    bool still;          /* the camera has not moved: nine samples count, not five */
    float rest;          /* how much of the past stays as it is where nothing moves, 0..1 (MinLerpContribution) */
} masu_gsr2_frame;

bool masu_gsr2_open(masu_gsr2 *g, const uint32_t from[2], const uint32_t to[2]);
void masu_gsr2_close(masu_gsr2 *g);

/* rgba: of the output. */
void masu_gsr2_add(masu_gsr2 *g, const masu_gsr2_frame *frame, uint8_t *rgba);

#endif
