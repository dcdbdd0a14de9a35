/* stats.h: what a renderer tells of itself: statistics of a frame, peaks, the memory report, images read
 * back. The public functions are in masu.h; nothing here changes anything. */
#ifndef MASU_STATS_H
#define MASU_STATS_H

#include "renderer.h"

/* What is known of the frame that a slot has held, for the governor. 0: it has held none. */
int masu_slot_sample(const masu_renderer *m, uint32_t slot, masu_governor_sample *out);

#endif
