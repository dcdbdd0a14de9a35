/* desc.h: the description that a host gives: its defaults, its ranges, and whether the scene keeps
 * its limits. masu_desc_resolved (masu.h) turns zeros into defaults; all below take what it returns.
 *
 * Pure functions: no Vulkan call, no allocation, nothing kept. */
#ifndef MASU_DESC_H
#define MASU_DESC_H

#include "masu.h"

/* MASU_ERROR_ARGUMENT: a field is missing or out of its range, and the detail names it. */
masu_result masu_desc_check(const masu_desc *d, masu_detail *detail);

/* MASU_ERROR_LIMIT: the scene needs more of something than a limit of the description, or of the
 * library, allows. */
masu_result masu_limits_check(const masu_desc *d, masu_detail *detail);

/* What is wished for where it is less than what there is; a wish of 0 is for all of it. */
static inline uint32_t masu_at_most(uint32_t wish, uint32_t has) {
    return wish && wish < has ? wish : has;
}

/* Cascades of the rung that has most of them, and the edge of the largest, texels. */
void masu_shadow_peak(const masu_desc *d, uint32_t *cascades, uint32_t *size);

/* Whether textures stay compressed blocks on the device, and bytes of the scene's texels then. */
int masu_takes_blocks(const masu_desc *d);
uint64_t masu_scene_texture_bytes(const masu_desc *d);

#endif
