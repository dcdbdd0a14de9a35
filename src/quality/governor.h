/* governor.h: frame times in, a rung of the ladder out. A pure function of its own state: no clock,
 * no Vulkan, no allocation; sqrt and arithmetic of doubles alone, so that every machine decides
 * alike.
 *
 *   masu_governor_init(&g, &desc, rungs, count);
 *   for each frame:
 *       masu_governor_sample_in(&g, &sample);   what is known by then, of frames long submitted
 *       rung = masu_governor_pick(&g, frame);
 *
 * The model is   ms = fixed + cost[rung] * load   with the load moving by `slope` each frame. Fixed
 * part, load and slope are the state of a Kalman filter; costs begin at the prior (scale^2) and are
 * corrected by what each rung has measured. docs/design/19-governor.md has laws and measurements.
 *
 * Any sample may be given: what cannot be a frame's time is left out, and the rung handed out is
 * one of best .. worst whatever comes in. */
#ifndef MASU_GOVERNOR_H
#define MASU_GOVERNOR_H

#include "quality/governor_model.h"

/* Out-of-range fields of `desc` count as 0; a count of 0 or above MASU_GOVERNOR_RUNGS is
 * clamped. */
void masu_governor_init(masu_governor *g, const masu_governor_desc *desc,
                        const masu_governor_rung *rungs, uint32_t count);
/* The rung for a frame; asked for again, the same one. */
uint32_t masu_governor_pick(masu_governor *g, uint64_t frame);
/* The host draws this frame at a rung of its own choice. */
void masu_governor_override(masu_governor *g, uint64_t frame, uint32_t rung, int excluded);
/* The same as masu_governor_pick for a frame whose times will say nothing: the rung stays. */
uint32_t masu_governor_hold(masu_governor *g, uint64_t frame);
/* From this frame on the picture has nothing to do with the one before: so may its cost. */
void masu_governor_cut(masu_governor *g, uint64_t frame);
/* When the display showed a frame: see masu_pacing_shown. */
void masu_governor_shown(masu_governor *g, uint64_t frame, uint64_t ns, uint64_t refresh_ns);
/* Mode, target, headroom, range, dwell and fixed rung from the next frame on; costs stay. What was learnt
 * of times stays. Fields out of range as of masu_governor_init. */
void masu_governor_adjust(masu_governor *g, const masu_governor_desc *desc);
/* Before the first frame, with a load that is known: to the best rung that keeps the target. */
void masu_governor_settle_at_best(masu_governor *g);
/* Which rises were taken back. */
void masu_governor_forget_mistakes(masu_governor *g);
void masu_governor_report(const masu_governor *g, masu_governor_info *out);

#endif
