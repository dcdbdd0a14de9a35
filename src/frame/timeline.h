/* timeline.h: frames and the slots that they take turns in: one slot for each frame in flight, whose part
 * of every buffer the host may write again once the GPU has finished the frame that had it before. */
#ifndef MASU_TIMELINE_H
#define MASU_TIMELINE_H

#include "masu.h"

typedef struct masu_slot {
    uint64_t frame; /* that it holds; UINT64_MAX: not used yet */
    uint32_t rung, viewport;
    VkExtent2D render; /* size of it */
    int exclude_from_timing; /* its times say nothing of other frames' */
    /* What the host has said; 0: nothing. */
    double wall_ms, cpu_ms;
    uint64_t submit_ns, done_ns;
} masu_slot;

typedef struct masu_timeline {
    uint64_t frame; /* number of the next one */
    uint32_t viewport; /* of the one before */
    int cut;        /* it has nothing to do with the one before, whatever the host says */
    uint64_t ended, end_ns; /* the newest frame whose wall was asked for and its end; UINT64_MAX: none */
    masu_slot slots[MASU_MAX_FLIGHT];
} masu_timeline;

void masu_timeline_start(masu_timeline *t);
/* The next frame is handed out, in this slot; its number is filled in. */
void masu_timeline_begin(masu_timeline *t, uint32_t slot, const masu_slot *frame);
/* How long the slot's frame took by the host's clock, ms; 0: that is not known. To be asked once, for
 * frames in their order: of two times in flight the later begins where the earlier ends, whichever the host
 * told first. */
double masu_timeline_wall(masu_timeline *t, uint32_t slot, uint32_t flight);

#endif
