/* mask.h: mips of masks: alpha that covers from afar what it covers near by, measured as the
 * device will see it: after compression, filtered, against the cut-off. Pure functions on arrays of
 * the caller's. */
#ifndef MASU_BAKE_MASK_H
#define MASU_BAKE_MASK_H

#include "scene/blob.h"

#include <stdbool.h>
#include <stddef.h>

/* Whether a picture with so many texels of each alpha is a mask at this cut-off, where nothing
 * else says what its alpha is for: something is clear, something solid, and little is in
 * between. What is mostly in between is a gloss, a height or a smoke. */
bool masu_mask_is_meant(const uint64_t histogram[256], uint8_t cutoff);

/* The part of a repeated picture of these alphas that is there: filtered between texels,
 * compared with the cut-off at 16 places around each. Wrong turn: to count texels (Castano's
 * first form, 2010). A texel that reaches the cut-off alone is there only at its centre; needles
 * rendered from afar then cover half of what they should, and dots a quarter. */
double masu_mask_coverage(const uint8_t *alpha, uint32_t width, uint32_t height, uint8_t cutoff);

/* The alpha halves of BC3 blocks (16 bytes each, the rest is left alone; NULL: none wanted) of a
 * level of four floats per texel, its alpha times `scale`; and that alpha as the blocks have it.
 * No texel is on another side of the cut-off than before compression. */
void masu_mask_encode(const float *level, uint32_t width, uint32_t height, uint8_t cutoff,
                      float scale, uint8_t *alpha, unsigned char *blocks);

/* By what to multiply a level's alpha so that its coverage comes as near to `wanted` as it can.
 * `alpha`: a byte per texel, scratch. */
float masu_mask_scale(const float *level, uint32_t width, uint32_t height, uint8_t cutoff,
                      double wanted, uint8_t *alpha);

#endif
