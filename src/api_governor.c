/* api_governor.c: the public functions of the governor (measured times, settings, state), and its
 * use by masu_frame (api_governor.h). */
#include "api_governor.h"

#include "base/error.h"
#include "quality/governor_desc.h"
#include "quality/governor_state.h"
#include "api_stats.h"

#include <string.h>

/* ---- Frames ---------------------------------------------------------------------------------- */

VkExtent2D masu_governed_output(const masu_renderer *m) {
    const masu_viewport *first = &m->plan.desc.viewports[0];
    return m->plan.desc.viewport_count ? (VkExtent2D){first->width, first->height} : m->plan.whole;
}

/* Rungs of a source image have no scale, so there is no cost prior; costs are measured. */
void masu_governed_start(masu_renderer *m) {
    const masu_desc *d = &m->plan.desc;
    masu_governor_rung rungs[MASU_MAX_RUNGS];
    for (uint32_t r = 0; r < d->rung_count; r++) {
        rungs[r].scale = d->source.view ? 1.0 : (double)d->rungs[r].scale;
        rungs[r].cost = (double)d->governor.costs[r];
    }
    masu_governor_init(m->governor, &d->governor, rungs, d->rung_count);
}

void masu_governed_pick(masu_renderer *m, masu_frame_data *f) {
    masu_governor_sample sample;
    double wall = masu_timeline_wall(&m->timeline, f->slot, m->plan.desc.frames_in_flight);
    if (masu_slot_sample(m, f->slot, &sample)) {
        sample.wall_ms = wall;
        masu_governor_sample_in(m->governor, &sample);
    }
    if (f->desc.rung != MASU_RUNG_AUTO) return;
    f->desc.rung = f->desc.exclude_from_timing ? masu_governor_hold(m->governor, f->number)
                                               : masu_governor_pick(m->governor, f->number);
}

void masu_governed_begin(masu_renderer *m, const masu_frame_data *f, uint32_t given) {
    if (given != MASU_RUNG_AUTO && !f->desc.viewport)
        masu_governor_override(m->governor, f->number, given, f->desc.exclude_from_timing != 0);
    if (f->cut && f->number) masu_governor_cut(m->governor, f->number);
}

/* ---- Times ----------------------------------------------------------------------------------- */

static masu_slot *slot_of(masu_renderer *m, uint32_t slot) {
    return m && slot < m->plan.desc.frames_in_flight ? &m->timeline.slots[slot] : NULL;
}

void masu_frame_wall(masu_renderer *m, uint32_t slot, double wall_ms) {
    masu_slot *s = slot_of(m, slot);
    if (s) s->wall_ms = wall_ms;
}

void masu_frame_times(masu_renderer *m, uint32_t slot, uint64_t submit_ns, uint64_t done_ns,
                      double cpu_ms) {
    masu_slot *s = slot_of(m, slot);
    if (!s) return;
    if (masu_is_time(cpu_ms)) s->cpu_ms = cpu_ms;
    if (done_ns <= submit_ns) return;
    s->submit_ns = submit_ns;
    s->done_ns = done_ns;
}

void masu_frame_presented(masu_renderer *m, uint64_t frame, uint64_t present_ns,
                          uint64_t refresh_ns) {
    if (!m || !m->governor || frame >= m->timeline.frame) return;
    masu_governor_shown(m->governor, frame, present_ns, refresh_ns);
}

/* ---- Settings -------------------------------------------------------------------------------- */

static masu_result check(masu_renderer *m, const void *given, const char *what,
                         masu_detail *detail) {
    if (!m || !given) return masu_finish_null(m, what, detail);
    if (m->governor) return MASU_OK;
    return masu_finish(m,
                       masu_fail(&m->error, MASU_ERROR_STATE, "governor.mode", MASU_GOVERNOR_ON,
                                 MASU_GOVERNOR_OFF,
                                 "there is no governor: governor.mode was OFF in masu_init"),
                       detail);
}

masu_result masu_governor_set(masu_renderer *m, const masu_governor_setting *setting,
                              masu_detail *detail) {
    masu_result result = check(m, setting, "setting", detail);
    if (result) return result;
    masu_governor_desc d = {.mode = setting->mode,
                            .target_ms = setting->target_ms,
                            .headroom = setting->headroom,
                            .best_rung = setting->best_rung,
                            .worst_rung = setting->worst_rung,
                            .rung = setting->rung,
                            .dwell = setting->dwell};
    if (d.mode == MASU_GOVERNOR_OFF) {
        return masu_finish(m,
                           masu_fail(&m->error, MASU_ERROR_ARGUMENT, "governor.mode",
                                     MASU_GOVERNOR_ON, MASU_GOVERNOR_OFF,
                                     "governor.mode is 0 (OFF), allowed are 1 (ON) and 2 (FIXED)"),
                           detail);
    }
    result = masu_finish(m, masu_governor_check(&d, m->plan.desc.rung_count, &m->error), detail);
    if (!result) masu_governor_adjust(m->governor, &d);
    return result;
}

masu_result masu_governor_save(masu_renderer *m, masu_governor_state *out, masu_detail *detail) {
    masu_result result = check(m, out, "out", detail);
    if (!result) masu_governor_export_state(m->governor, masu_governed_output(m), out);
    return result;
}

masu_result masu_governor_restore(masu_renderer *m, const masu_governor_state *state,
                                  masu_detail *detail) {
    masu_result result = check(m, state, "state", detail);
    if (!result) result = masu_finish(m, masu_governor_state_check(state, &m->error), detail);
    if (!result)
        masu_governor_import_state(m->governor, state, masu_governed_output(m), m->timeline.frame);
    return result;
}
