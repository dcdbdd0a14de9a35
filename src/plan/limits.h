/* limits.h: what a scene needs of each thing that masu_limits limits, and whether it may have it. The
 * rows are MASU_LIMITS (masu_knobs.h).
 *
 * All take a resolved description. Pure functions: no Vulkan call, no allocation, nothing kept. */
#ifndef MASU_LIMITS_H
#define MASU_LIMITS_H

#include "masu.h"

/* All 0 without a scene. */
masu_limits masu_limits_needed(const masu_desc *d);

/* MASU_ERROR_LIMIT: the scene needs more of something than the description or the library allows. */
masu_result masu_limits_check(const masu_desc *d, masu_detail *detail);

/* What is wished for where it is less than what there is; a wish of 0 is for all of it. */
static inline uint32_t masu_at_most(uint32_t wish, uint32_t has) {
    return wish && wish < has ? wish : has;
}

/* Cascades of the rung that has most of them, and the edge of the largest, texels. */
void masu_shadow_peak(const masu_desc *d, uint32_t *cascades, uint32_t *size);

/* Whether textures stay compressed blocks on the device, and bytes of the scene's texels then. */
int masu_keeps_blocks(const masu_desc *d);
uint64_t masu_desc_texture_bytes(const masu_desc *d);

#endif
