/* governor_desc.c: see governor_desc.h. */
#include "quality/governor_desc.h"

#include "base/error.h"

void masu_governor_defaults(masu_governor_desc *d, uint32_t rungs) {
    if (d->mode == MASU_GOVERNOR_OFF) return;
    if (d->target_ms == 0.0f) d->target_ms = (float)MASU_GOVERNOR_TARGET_MS;
    if (d->headroom == 0.0f) d->headroom = (float)MASU_GOVERNOR_HEADROOM;
    if (d->worst_rung == 0 && rungs) d->worst_rung = rungs - 1;
    if (d->dwell == 0) d->dwell = MASU_GOVERNOR_DWELL;
}

static masu_result bad(masu_detail *detail, const char *what, double given, double low,
                       double high) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s is %g, allowed are %g to %g",
                     what, given, low, high);
}

masu_result masu_governor_check(const masu_governor_desc *g, uint32_t rungs, masu_detail *detail) {
    if ((unsigned)g->mode > MASU_GOVERNOR_FIXED)
        return bad(detail, "governor.mode", (unsigned)g->mode, 0, MASU_GOVERNOR_FIXED);
    for (uint32_t r = 0; r < rungs; r++) { /* the plan reports these even without a governor */
        if (!(g->costs[r] >= 0.0f && g->costs[r] <= 1e6f))
            return bad(detail, "governor.costs", (double)g->costs[r], 0, 1e6);
    }
    if (g->target_ms != 0.0f && !(g->target_ms >= 1.0f && g->target_ms <= 1000.0f))
        return bad(detail, "governor.target_ms", (double)g->target_ms, 1, 1000);
    if (!(g->headroom <= 0.5f && g->headroom >= -1.0f))
        return bad(detail, "governor.headroom", (double)g->headroom, -1, 0.5);
    if (g->dwell > 600) return bad(detail, "governor.dwell", g->dwell, 0, 600);
    /* the rungs may have been selected by another program */
    if (g->mode == MASU_GOVERNOR_OFF) return MASU_OK;
    if (g->worst_rung >= rungs)
        return bad(detail, "governor.worst_rung", g->worst_rung, 0, rungs - 1);
    if (g->best_rung > (g->worst_rung ? g->worst_rung : rungs - 1))
        return bad(detail, "governor.best_rung", g->best_rung, 0,
                   g->worst_rung ? g->worst_rung : rungs - 1);
    if (g->rung >= rungs) return bad(detail, "governor.rung", g->rung, 0, rungs - 1);
    return MASU_OK;
}
