/* api_stats.h: what a renderer reports: statistics of a frame, peaks, the memory report, images
 * read back. The public functions are in masu.h. */
#ifndef MASU_API_STATS_H
#define MASU_API_STATS_H

#include "renderer.h"

/* The slot is handed out again: what is known of it is of an older frame from now on. */
void masu_slot_begin(masu_renderer *m, uint32_t slot);

/* What is known of the frame that a slot has held, for the governor. 0: it has held none, or one that was never
 * submitted. */
int masu_slot_sample(const masu_renderer *m, uint32_t slot, masu_governor_sample *out);

#endif
