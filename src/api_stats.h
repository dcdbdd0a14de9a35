/* api_stats.h: statistics of a frame, peaks, the memory report, and image readback. The public
 * functions are in masu.h. */
#ifndef MASU_API_STATS_H
#define MASU_API_STATS_H

#include "renderer.h"

/* Call when a slot is used again: its old measurements are of an earlier frame from now on. */
void masu_slot_begin(masu_renderer *m, uint32_t slot);

/* The times of the frame that last used a slot, for the governor. Returns 0 if there is none, or if
 * that frame was never submitted. */
int masu_slot_sample(const masu_renderer *m, uint32_t slot, masu_governor_sample *out);

#endif
