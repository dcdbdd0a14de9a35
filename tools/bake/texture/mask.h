/* mask.h: mips of alpha masks that keep their coverage at every distance. Coverage is measured as
 * the device samples it: compressed, filtered and compared with the cut-off. Pure functions on
 * arrays of the caller. */
#ifndef MASU_BAKE_MASK_H
#define MASU_BAKE_MASK_H

#include "scene/blob.h"

#include <stdbool.h>
#include <stddef.h>

/* True if a texture with this histogram of alpha is a mask at this cut-off; used if nothing else
 * specifies the meaning of alpha. A mask has transparent and solid texels and few in between. A
 * texture with mostly intermediate values is gloss, height or smoke. */
bool masu_mask_is_meant(const uint64_t histogram[256], uint8_t cutoff);

/* The share of a repeated texture that passes the alpha test: bilinearly filtered and compared with
 * the cut-off at 16 positions around each texel. Rejected: counting texels (the first form of
 * Castano, 2010). An isolated texel that reaches the cut-off passes only at its centre; with
 * counts, distant needles cover half of the correct area, and dots a quarter. */
double masu_mask_coverage(const uint8_t *alpha, uint32_t width, uint32_t height, uint8_t cutoff);

/* Encodes the alpha halves of BC3 blocks (16 bytes each; the other half is not written; NULL: no
 * blocks) from a level of four floats per texel, with alpha times `scale`. Also writes the decoded
 * alpha. Compression moves no texel to the other side of the cut-off. */
void masu_mask_encode(const float *level, uint32_t width, uint32_t height, uint8_t cutoff,
                      float scale, uint8_t *alpha, unsigned char *blocks);

/* The factor for a level's alpha that brings its coverage as close to `wanted` as possible.
 * `alpha`: a byte per texel, scratch. */
float masu_mask_scale(const float *level, uint32_t width, uint32_t height, uint8_t cutoff,
                      double wanted, uint8_t *alpha);

#endif
