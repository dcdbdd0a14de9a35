/* recordings.h: creates and records all command buffers of a renderer. */
#ifndef MASU_RECORDINGS_H
#define MASU_RECORDINGS_H

#include "device/device.h"

/* Identifies a recording. Its variants are consecutive. */
typedef struct masu_recording_id {
    uint32_t flight, viewport, rung, target;
} masu_recording_id;

/* Index of the first variant, counted over all frames in flight. */
static inline uint32_t masu_recording_of(const masu_frame_plan *plan, masu_recording_id id) {
    const masu_rung_plan *rp = &plan->rungs[id.rung];
    return id.flight * plan->recordings + id.viewport * plan->viewport_recordings +
           rp->first_recording + id.target * rp->variants;
}

/* Creates descriptor sets, queries and command buffers, and records the loading. Layouts must
 * exist. */
masu_result masu_record_begin(masu_device *m, masu_detail *detail);

/* Records the frames of one rung for the first time. Its pipelines must exist. */
masu_result masu_record_rung(masu_device *m, const masu_draws *draws, uint32_t rung,
                             masu_detail *detail);

/* Discards all frame recordings, of which none may be pending, and records those of one rung, if
 * it is ready, for the current plan and targets. masu_record_missing records the others, also
 * those missing after a failure. */
masu_result masu_record_again(masu_device *m, const masu_draws *draws, uint32_t rung,
                              masu_detail *detail);

/* Records the variants of a frame that are not recorded yet. Selects the recording's viewport in
 * the plan. */
masu_result masu_record_missing(masu_device *m, const masu_draws *draws, masu_recording_id id,
                                masu_detail *detail);

#endif
