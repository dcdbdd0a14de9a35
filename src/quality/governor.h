/* governor.h: selects a rung of the ladder from frame times. A pure function of its state: no
 * clock, no Vulkan, no allocation. It uses only sqrt and double arithmetic, so that all machines
 * decide alike.
 *
 *   masu_governor_init(&g, &desc, rungs, count);
 *   for each frame:
 *       masu_governor_sample_in(&g, &sample);   times of finished frames, some frames late
 *       rung = masu_governor_pick(&g, frame);
 *
 * The model is   ms = fixed + cost[rung] * load   in which the load changes by `slope` per frame.
 * Fixed cost, load and slope are the state of a Kalman filter. Costs start at the prior (scale^2)
 * and are corrected by the times of each rung. docs/design/19-governor.md has the rules and
 * measurements.
 *
 * Any sample is accepted: implausible times are ignored, and the rung is always one of best ..
 * worst. */
#ifndef MASU_GOVERNOR_H
#define MASU_GOVERNOR_H

#include "quality/governor_model.h"

/* Out-of-range fields of `desc` are treated as 0; a count of 0 or above MASU_GOVERNOR_RUNGS is
 * clamped. */
void masu_governor_init(masu_governor *g, const masu_governor_desc *desc,
                        const masu_governor_rung *rungs, uint32_t count);
/* The rung for a frame. Repeated calls for a frame return the same rung. */
uint32_t masu_governor_pick(masu_governor *g, uint64_t frame);
/* The host renders this frame at a rung that it chooses. */
void masu_governor_override(masu_governor *g, uint64_t frame, uint32_t rung, int excluded);
/* Like masu_governor_pick for a frame whose times will be ignored: keeps the rung. */
uint32_t masu_governor_hold(masu_governor *g, uint64_t frame);
/* Camera cut: from this frame on, the load may be different. */
void masu_governor_cut(masu_governor *g, uint64_t frame);
/* Time at which the display showed a frame: see masu_pacing_shown. */
void masu_governor_shown(masu_governor *g, uint64_t frame, uint64_t ns, uint64_t refresh_ns);
/* Changes mode, target, headroom, range, dwell and fixed rung from the next frame on. Measured
 * costs and times are kept. Out-of-range fields are treated as in masu_governor_init. */
void masu_governor_adjust(masu_governor *g, const masu_governor_desc *desc);
/* Before the first frame, if an earlier renderer has measured the load: selects the best rung
 * within the target. */
void masu_governor_settle_at_best(masu_governor *g);
/* Forgets failed rises. */
void masu_governor_forget_mistakes(masu_governor *g);
void masu_governor_report(const masu_governor *g, masu_governor_info *out);

#endif
