/* governor_state.h: what a governor has learnt, kept over the end of a renderer, and taken over by one of
 * another output size or with other rungs. Pure; a state of any bytes may be given. */
#ifndef MASU_GOVERNOR_STATE_H
#define MASU_GOVERNOR_STATE_H

#include "quality/governor.h"

void masu_governor_export_state(const masu_governor *g, VkExtent2D output,
                                masu_governor_state *out);
/* MASU_ERROR_VERSION: of another version or size. MASU_ERROR_ARGUMENT: a number that no governor has; the
 * detail names it. */
masu_result masu_governor_state_check(const masu_governor_state *s, masu_detail *detail);
/* Of a state that was checked: from frame `frame` on, which is the next. One that had measured nothing
 * changes nothing. */
void masu_governor_import_state(masu_governor *g, const masu_governor_state *s, VkExtent2D output,
                                uint64_t frame);
/* From this frame on the output has so many times the pixels: all of the load is taken to follow them, and
 * half of the fixed part, with all and none as its deviation. */
void masu_governor_scale(masu_governor *g, double pixels, uint64_t frame);

#endif
