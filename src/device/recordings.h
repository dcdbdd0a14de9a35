/* recordings.h: all command buffers of a renderer. */
#ifndef MASU_RECORDINGS_H
#define MASU_RECORDINGS_H

#include "device/device.h"

/* Which recording: its variants are one behind the other. */
typedef struct masu_recording_id {
    uint32_t flight, viewport, rung, target;
} masu_recording_id;

/* Index of the first variant among those of all frames in flight. */
static inline uint32_t masu_recording_of(const masu_frame_plan *plan, masu_recording_id id) {
    const masu_rung_plan *rp = &plan->rungs[id.rung];
    return id.flight * plan->recordings + id.viewport * plan->viewport_recordings +
           rp->first_recording + id.target * rp->variants;
}

/* Descriptor sets, queries, recordings of frames and of loading; pipelines come before. */
masu_result masu_record(masu_device *m, const masu_draws *draws, masu_detail *detail);

/* Discards the recordings of frames, of which none may be pending, and records those of a rung
 * for plan and targets as they now are. masu_record_missing records the others, also what a
 * failure leaves out. */
masu_result masu_record_again(masu_device *m, const masu_draws *draws, uint32_t rung,
                              masu_detail *detail);

/* Records the variants of a frame, unless they are recorded. Selects its viewport in the plan. */
masu_result masu_record_missing(masu_device *m, const masu_draws *draws, masu_recording_id id,
                                masu_detail *detail);

#endif
