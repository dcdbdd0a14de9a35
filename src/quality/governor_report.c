/* governor_report.c: the state of a governor in the public struct. See governor.h. */
#include "quality/governor.h"

#include <string.h>

const char *masu_governor_reason_string(masu_governor_reason reason) {
    switch (reason) {
    case MASU_GOVERNOR_REASON_NONE: return "there is no governor";
    case MASU_GOVERNOR_REASON_START: return "no frame has been measured yet";
    case MASU_GOVERNOR_REASON_HOLD: return "the rung meets the target, and no better rung would";
    case MASU_GOVERNOR_REASON_BEST: return "the best rung meets the target";
    case MASU_GOVERNOR_REASON_WAIT: return "a better rung fits, but the last change is too recent";
    case MASU_GOVERNOR_REASON_DOWN: return "the previous rung was predicted to miss the target";
    case MASU_GOVERNOR_REASON_JUMP: return "the load has jumped: the previous rung is too slow";
    case MASU_GOVERNOR_REASON_EMERGENCY: return "two frames in a row have missed the target";
    case MASU_GOVERNOR_REASON_UP: return "this better rung is predicted to meet the target";
    case MASU_GOVERNOR_REASON_WORST: return "no rung meets the target: the cheapest one is used";
    case MASU_GOVERNOR_REASON_NO_GAIN: return "cheaper rungs save no time, or a survey measures it";
    case MASU_GOVERNOR_REASON_STALE: return "no recent measurements: the rung is kept";
    case MASU_GOVERNOR_REASON_FIXED: return "the rung is fixed";
    case MASU_GOVERNOR_REASON_HOST: return "the host has selected the rung";
    case MASU_GOVERNOR_REASON_EXCLUDED:
        return "the frame is excluded from timing: the rung is kept";
    case MASU_GOVERNOR_REASON_TRIAL:
        return "trial of a better rung: does the clock follow the load?";
    default: return "unknown reason";
    }
}

void masu_governor_report(const masu_governor *g, masu_governor_info *out) {
    memset(out, 0, sizeof *out);
    out->mode = g->mode;
    out->rung = g->rung;
    out->reason = g->reason;
    out->reason_text = masu_governor_reason_string(g->reason);
    out->locked = g->lock;
    out->source = g->trust.source;
    out->rung_count = g->count;
    out->target_ms = (float)g->asked;
    out->cpu_ms = (float)g->trust.cpu;
    out->refresh_ms = (float)g->pacing.refresh;
    out->refreshes = g->pacing.refreshes;
    out->vsync_ms = (float)g->trust.vsync;
    out->noise = (float)g->noise;
    out->overhead_ms = (float)g->trust.overhead;
    out->unit = (float)g->trust.unit;
    out->samples = g->samples;
    out->rejected = g->rejected;
    out->missed = g->missed;
    out->changes = g->changes;
    if (!g->known) return;
    for (uint32_t r = 0; r < g->count && r < MASU_MAX_RUNGS; r++)
        out->predicted_ms[r] = (float)masu_governor_predict(g, r);
    out->fixed_ms = (float)g->fixed;
    out->load_ms = (float)g->load;
    out->slope_ms = (float)g->slope;
    double interval = out->refreshes ? out->refreshes * g->pacing.refresh : g->target;
    out->start_delay_ms = (float)masu_largest(
        interval - masu_governor_upper(g, g->rung, masu_governor_lead(g, g->frame), 0,
                                       MASU_GOVERNOR_MARGIN),
        0.0);
}
