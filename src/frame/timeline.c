/* timeline.c: see timeline.h. */
#include "frame/timeline.h"

void masu_timeline_start(masu_timeline *t) {
    for (uint32_t s = 0; s < MASU_MAX_FLIGHT; s++) t->slots[s].frame = UINT64_MAX;
    t->ended = UINT64_MAX;
}

void masu_timeline_begin(masu_timeline *t, uint32_t slot, const masu_slot *frame) {
    t->cut = 0;
    t->viewport = frame->viewport;
    t->slots[slot] = *frame;
    t->slots[slot].frame = t->frame++;
}

double masu_timeline_wall(masu_timeline *t, uint32_t slot, uint32_t flight) {
    masu_slot *s = &t->slots[slot];
    uint64_t submit = s->submit_ns, done = s->done_ns, from = submit;
    double wall = s->wall_ms;
    s->wall_ms = 0.0;
    s->submit_ns = s->done_ns = 0;
    if (!done) return wall;
    /* With one frame in flight none can overlap; else the previous frame's end is required. */
    int known = flight == 1 || s->frame == 0 || t->ended + 1 == s->frame;
    if (t->ended + 1 == s->frame && s->frame && t->end_ns > from) from = t->end_ns;
    t->ended = s->frame;
    t->end_ns = done;
    return known && done > from ? (double)(done - from) * 1e-6 : 0.0;
}
