/* governor_state.h: exports the state of a governor at the end of a renderer, and imports it
 * into one with another output size or other rungs. Pure functions; any bytes are accepted as a
 * state. */
#ifndef MASU_GOVERNOR_STATE_H
#define MASU_GOVERNOR_STATE_H

#include "quality/governor.h"

void masu_governor_export_state(const masu_governor *g, VkExtent2D output,
                                masu_governor_state *out);
/* MASU_ERROR_VERSION: another version or size. MASU_ERROR_ARGUMENT: a number out of range; `detail`
 * names it. */
masu_result masu_governor_state_check(const masu_governor_state *s, masu_detail *detail);
/* Imports a validated state; `frame` is the next frame. A state without measurements changes
 * nothing. */
void masu_governor_import_state(masu_governor *g, const masu_governor_state *s, VkExtent2D output,
                                uint64_t frame);
/* From this frame on, the output has `pixels` times as many pixels. Assumes that all of the load
 * and half of the fixed cost scale with the pixels; the deviation of the latter covers all and
 * none. */
void masu_governor_scale(masu_governor *g, double pixels, uint64_t frame);

#endif
