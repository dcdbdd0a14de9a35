/* descriptors.h: the descriptor pool and its sets. */
#ifndef MASU_DESCRIPTORS_H
#define MASU_DESCRIPTORS_H

#include "device/device.h"

/* Set 0 is a scene's, but for what SMAA has in it. */
int masu_has_global_sets(const masu_frame_plan *plan);
/* The pool, set 0 of each frame in flight, and the sets of textures. */
masu_result masu_create_sets(masu_device *m, masu_detail *detail);
/* Allocates and writes the sets of all passes, in the order (rung, pass, target). A pass that
 * writes the target has a set for each of plan->targets_max targets; other passes have one for
 * all. */
masu_result masu_create_pass_sets(masu_device *m, masu_detail *detail);
/* Writes the sets again for the targets of the description. No frame may be pending. */
void masu_write_pass_sets(masu_device *m);
/* Fills sets[pass] of a rung that draws to a target. */
void masu_find_pass_sets(const masu_device *m, uint32_t rung, uint32_t target,
                         VkDescriptorSet sets[MASU_PASS_COUNT]);

#endif
