/* limits.h: compares the requirements of a scene with the limits (masu_limits). The rows are
 * MASU_LIMITS (masu_knobs.h).
 *
 * All functions take a resolved description. Pure functions: no Vulkan calls, no allocation, no
 * state. */
#ifndef MASU_LIMITS_H
#define MASU_LIMITS_H

#include "masu.h"

/* All 0 without a scene. */
masu_limits masu_limits_needed(const masu_desc *d);

/* MASU_ERROR_LIMIT: the scene needs more than the description or the library allows. */
masu_result masu_limits_check(const masu_desc *d, masu_detail *detail);

/* The smaller of `wish` and `has`; a wish of 0 means all. */
static inline uint32_t masu_at_most(uint32_t wish, uint32_t has) {
    return wish && wish < has ? wish : has;
}

/* The largest number of cascades of any rung, and the largest size of a cascade in texels. */
void masu_shadow_peak(const masu_desc *d, uint32_t *cascades, uint32_t *size);

/* Whether textures remain block-compressed on the device, and the bytes of the scene's textures
 * there. */
int masu_keeps_blocks(const masu_desc *d);
uint64_t masu_desc_texture_bytes(const masu_desc *d);

#endif
