/* governor_report.c: what a governor knows, as the host sees it. See governor.h. */
#include "quality/governor.h"

#include <string.h>

const char *masu_governor_reason_string(masu_governor_reason reason) {
    switch (reason) {
#define REASON_CASE(name, value, text)                                                             \
    case name: return text;
        MASU_GOVERNOR_REASONS(REASON_CASE)
#undef REASON_CASE
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
        interval - masu_governor_upper(g, g->rung, masu_governor_lead(g, g->frame), 0, MASU_GOVERNOR_MARGIN), 0.0);
}
