/* descriptors.h: the descriptor pool and its sets. */
#ifndef MASU_DESCRIPTORS_H
#define MASU_DESCRIPTORS_H

#include "device/device.h"

/* Set 0 is a scene's, but for what SMAA has in it. */
int masu_has_global_sets(const masu_frame_plan *plan);
/* The pool, set 0 of each frame in flight, and the sets of textures. */
masu_result masu_create_sets(masu_device *m, masu_detail *detail);
/* Sets of all rungs, in the order (rung, pass, target); a pass that does not write the target has
 * one for all targets. `next` walks the device's array in that order. Fills sets[target][pass] of
 * one rung. */
masu_result masu_create_pass_sets(masu_device *m, const masu_rung_plan *rp, uint32_t *next,
                                  VkDescriptorSet sets[MASU_MAX_TARGETS][MASU_PASS_COUNT],
                                  masu_detail *detail);

#endif
