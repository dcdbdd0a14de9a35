/* timeline.h: frames and the slots that they take turns in: one slot for each frame in flight, whose part
 * of every buffer the host may write again once the GPU has finished the frame that had it before. */
#ifndef MASU_TIMELINE_H
#define MASU_TIMELINE_H

#include "masu.h"

typedef struct masu_slot {
    uint64_t frame; /* that it holds; UINT64_MAX: not used yet */
    uint32_t rung, viewport;
    VkExtent2D render; /* size of it */
    double wall_ms; /* 0: the host has not said */
} masu_slot;

typedef struct masu_timeline {
    uint64_t frame; /* number of the next one */
    uint32_t viewport; /* of the one before */
    int cut;        /* it has nothing to do with the one before, whatever the host says */
    masu_slot slots[MASU_MAX_FLIGHT];
} masu_timeline;

static inline void masu_timeline_start(masu_timeline *t) {
    for (uint32_t s = 0; s < MASU_MAX_FLIGHT; s++) t->slots[s].frame = UINT64_MAX;
}

#endif
