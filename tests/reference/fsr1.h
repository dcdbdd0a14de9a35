/* fsr1.h: slow scalar FSR1 (EASU upscale, RCAS sharpen), the reference for shaders/easu.comp and
 * shaders/rcas.comp.
 *
 * Float32, one pixel at a time, one statement per rounding, in the order of AMD's published
 * ffx_fsr1 v1.0.2 fp32 path. The approximate reciprocals of that path are part of its result and so
 * part of this reference; MASU_REF_EXACT replaces them by exact ones, only to show their effect.
 *
 * Images are interleaved RGB floats, top row first, perceptually encoded in [0,1]. Values outside
 * that range are clamped on read and non-finite ones read as 0, as on the GPU. The caller owns all
 * memory; nothing here allocates or fails. Sizes are 1..65535 texels a side. */
#ifndef MASU_TESTS_REFERENCE_FSR1_H
#define MASU_TESTS_REFERENCE_FSR1_H

#include <stddef.h>
#include <stdint.h>

enum masu_ref_math {
    MASU_REF_BIT_TRICK, /* AMD's result: reciprocals from integer subtraction of float bits */
    MASU_REF_EXACT,     /* the same formulas with real divisions: NOT the result of the GPU */
    MASU_REF_FAST       /* bit tricks, less work: shaders/upscale/easu_fast.glsl */
};

/* A readable rectangle of a possibly larger image: texel (x,y) is rgb[(y * stride + x) * 3]. Reads
 * outside width x height return the nearest texel inside, never one outside the rectangle. */
struct masu_ref_image {
    const float *rgb;
    uint32_t width, height; /* of the rectangle, texels */
    uint32_t stride;        /* of the image, texels; 0 = width */
};

/* One output pixel of EASU, for an output of out_width x out_height pixels. */
void masu_ref_easu_pixel(const struct masu_ref_image *in, uint32_t out_width, uint32_t out_height,
                         uint32_t x, uint32_t y, enum masu_ref_math math, float rgb[3]);

/* Whether MASU_REF_FAST uses the bilinear mean for this pixel. */
int masu_ref_easu_leaves_early(const struct masu_ref_image *in, uint32_t out_width,
                               uint32_t out_height, uint32_t x, uint32_t y);

/* All pixels; out holds out_width * out_height * 3 floats, tightly packed. */
void masu_ref_easu(const struct masu_ref_image *in, uint32_t out_width, uint32_t out_height,
                   enum masu_ref_math math, float *out);

/* Bilinear filtering with the four nearest texels. Same output. */
void masu_ref_bilinear(const struct masu_ref_image *in, uint32_t out_width, uint32_t out_height,
                       float *out);

/* RCAS at unchanged size. strength = exp2(-stops): 1 is the sharpest, 0 copies. The result is
 * clamped to [0,1], as a UNORM target does. out holds in->width * in->height * 3 floats. */
void masu_ref_rcas_pixel(const struct masu_ref_image *in, uint32_t x, uint32_t y, float strength,
                         float rgb[3]);
void masu_ref_rcas(const struct masu_ref_image *in, float strength, float *out);

/* 8-bit RGBA to RGB floats (alpha ignored) and back (alpha 255, round to nearest even). stride is
 * the row length of the 8-bit image in texels, 0 = width. */
void masu_ref_from_rgba8(const uint8_t *rgba, uint32_t width, uint32_t height, uint32_t stride,
                         float *rgb);
void masu_ref_to_rgba8(const float *rgb, uint32_t width, uint32_t height, uint8_t *rgba);

/* Rounds `count` numbers to the nearest step of 10 bits, as in the images between the passes. */
void masu_ref_to_ten(float *values, size_t count);

/* Largest absolute difference; the 8-bit version compares all four channels. */
float masu_ref_max_difference(const float *a, const float *b, size_t count);
uint32_t masu_ref_max_difference_rgba8(const uint8_t *a, const uint8_t *b, size_t texels);

#endif
