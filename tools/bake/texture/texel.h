/* texel.h: conversion, filtering and block compression of texels in memory. Pure functions on
 * arrays of the caller.
 *
 * A texture level is four floats per texel, row by row. Colour is filtered as linear light: a black
 * and a white texel have a mean of 188 in sRGB, as they appear from a distance, not 128. */
#ifndef MASU_BAKE_TEXEL_H
#define MASU_BAKE_TEXEL_H

#include "scene/blob.h"

#include <stdbool.h>
#include <stddef.h>

float masu_texel_from_srgb(uint8_t c);
uint8_t masu_texel_to_srgb(float linear); /* nearest; clamps */
uint8_t masu_texel_to_unorm(float v);

/* The next mip: max(1, w / 2) by max(1, h / 2). Each texel is the mean of exactly the area that it
 * covers, which includes fractions of texels if a size is odd. by_alpha: colour is weighted by
 * alpha, so that the colour of invisible texels does not bleed in. */
void masu_texel_halve(const float *from, uint32_t width, uint32_t height, bool by_alpha, float *to);

/* The roughness of a surface of perceptual roughness `roughness` whose normals are filtered to a
 * mean of this length. alpha^2 grows by twice the variance of the slopes, which is (1 - length) /
 * length for normals of small variance (Toksvig, "Mipmapping normal maps", 2005). */
float masu_texel_rougher(float roughness, float mean_length);

/* Compresses texels of 4 bytes; BC4 uses the first byte and BC5 the first two. Returns bytes
 * written. Texels beyond the edge repeat the last one. In a block of one colour, the error is at
 * most 4/3 of 255; a grey block has a tint of at most 1. */
size_t masu_texel_blocks(uint32_t format, const uint8_t *rgba, uint32_t width, uint32_t height,
                         unsigned char *out);

/* One block of BC4, which is also the first half of a BC3 block. */
void masu_texel_alpha_block(const uint8_t alpha[16], unsigned char out[8]);

#endif
