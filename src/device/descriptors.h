/* descriptors.h: the descriptor pool and its sets. */
#ifndef MASU_DESCRIPTORS_H
#define MASU_DESCRIPTORS_H

#include "device/device.h"

/* Whether the plan has sets of buffers: with a scene, or with SMAA. */
int masu_has_global_sets(const masu_frame_plan *plan);
/* Creates the pool, set 0 of each frame in flight, and the texture sets. */
masu_result masu_create_sets(masu_device *m, masu_detail *detail);
/* Allocates and writes the sets of all passes, in the order (rung, pass, target). A pass that
 * writes the target has one set for each of plan->targets_max targets; other passes have one
 * set. */
masu_result masu_create_pass_sets(masu_device *m, masu_detail *detail);
/* Writes the sets again for the current targets of the description. No frame may be pending. */
void masu_write_pass_sets(masu_device *m);
/* Fills sets[pass] for a rung and a target. */
void masu_find_pass_sets(const masu_device *m, uint32_t rung, uint32_t target,
                         VkDescriptorSet sets[MASU_PASS_COUNT]);

#endif
