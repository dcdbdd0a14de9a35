/* descriptors.h: the descriptor pool and its sets. */
#ifndef MASU_DESCRIPTORS_H
#define MASU_DESCRIPTORS_H

#include "renderer.h"

/* Set 0 is a scene's, but for what SMAA has in it. */
int masu_has_global_sets(const masu_frame_plan *plan);
/* The pool, set 0 of each frame in flight, and the sets of textures. */
masu_result masu_make_sets(masu_renderer *m, masu_detail *detail);
/* Sets of all rungs, in the order (rung, pass, target); a pass that does not write the target has
 * one for all targets. `next` walks the renderer's array in that order. Fills sets[target][pass] of
 * one rung. */
masu_result masu_make_pass_sets(masu_renderer *m, const masu_rung_plan *rp, uint32_t *next,
                                VkDescriptorSet sets[MASU_MAX_TARGETS][MASU_PASS_COUNT],
                                masu_detail *detail);

#endif
