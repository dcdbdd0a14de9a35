/* texel.h: texels without files: from bytes to light and back, smaller pictures, blocks. Pure
 * functions on arrays of the caller's.
 *
 * A picture is four floats per texel, row by row. Colour is linear light while it is filtered: the
 * mean of a black and a white texel is what the eye sees from afar, 188 on a screen, not 128. */
#ifndef MASU_BAKE_TEXEL_H
#define MASU_BAKE_TEXEL_H

#include "scene/blob.h"

#include <stdbool.h>
#include <stddef.h>

float masu_texel_from_srgb(uint8_t c);
uint8_t masu_texel_to_srgb(float linear); /* nearest; clamps */
uint8_t masu_texel_to_unorm(float v);

/* The next mip: max(1, w / 2) by max(1, h / 2), each the mean of just the area that it covers: with
 * an odd size its texels cover fractions of others. by_alpha: colour counts by alpha, so that what
 * cannot be seen does not bleed in. */
void masu_texel_halve(const float *from, uint32_t width, uint32_t height, bool by_alpha, float *to);

/* How rough a surface of perceptual roughness `roughness` looks when its normals, whose mean has
 * this length, are no longer told apart: alpha^2 grows by twice the variance of the slopes,
 * which is (1 - length) / length for normals that scatter little (Toksvig, "Mipmapping normal
 * maps", 2005). */
float masu_texel_rougher(float roughness, float mean_length);

/* Blocks of bytes: 4 per texel, of which BC4 takes the first and BC5 the first two. Returns bytes
 * written. Texels beyond the edge repeat the last. A block of one colour is off by 4/3 of 255 at
 * most, a grey one without a tint of more than 1. */
size_t masu_texel_blocks(uint32_t format, const uint8_t *rgba, uint32_t width, uint32_t height,
                         unsigned char *out);

/* One block of BC4, which is also the first half of one of BC3. */
void masu_texel_alpha_block(const uint8_t alpha[16], unsigned char out[8]);

#endif
