/* timeline.h: frames and their slots: one slot for each frame in flight. The host may write the
 * slot's part of every buffer again once the GPU has finished the slot's previous frame. */
#ifndef MASU_TIMELINE_H
#define MASU_TIMELINE_H

#include "masu.h"

typedef struct masu_slot {
    uint64_t frame; /* that it holds; UINT64_MAX: not used yet */
    uint32_t rung, viewport;
    VkExtent2D render; /* its render size */
    int exclude_from_timing; /* its times are not representative */
    /* Times from the host; 0: none. */
    double wall_ms, cpu_ms;
    uint64_t submit_ns, done_ns;
} masu_slot;

typedef struct masu_timeline {
    uint64_t frame; /* number of the next one */
    uint32_t viewport; /* of the one before */
    int cut;        /* the frame has no history, even if the host did not request a cut */
    /* the newest frame whose wall-clock time was computed, and its end; UINT64_MAX: none */
    uint64_t ended, end_ns;
    masu_slot slots[MASU_MAX_FLIGHT];
} masu_timeline;

void masu_timeline_start(masu_timeline *t);
/* The next frame is handed out, in this slot; its number is filled in. */
void masu_timeline_begin(masu_timeline *t, uint32_t slot, const masu_slot *frame);
/* The wall-clock time of the slot's frame, ms; 0: unavailable. Call once for each frame, in
 * order: of two overlapping frames the later begins where the earlier ends, in whichever order
 * the host reported them. */
double masu_timeline_wall(masu_timeline *t, uint32_t slot, uint32_t flight);

#endif
