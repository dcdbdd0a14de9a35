/* governor_state.c: see governor_state.h. */
#include "quality/governor_state.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

#define HELD_MOST 4096u
#define COST_MOST 4e6
#define LOAD_MOST 1e13
#define OUTPUT_MOST (1u << 20)

/* ---- Export ---------------------------------------------------------------------------------- */

void masu_governor_export_state(const masu_governor *g, VkExtent2D output,
                                masu_governor_state *out) {
    memset(out, 0, sizeof *out);
    out->bytes = (uint32_t)sizeof *out;
    out->version = MASU_GOVERNOR_STATE_VERSION;
    if (!g->known || g->mode == MASU_GOVERNOR_OFF) return;
    uint64_t held = g->frame - g->changed + g->held_before;
    out->known = 1;
    out->width = output.width;
    out->height = output.height;
    out->rung_count = g->count < MASU_MAX_RUNGS ? g->count : MASU_MAX_RUNGS;
    out->rung = g->rung < out->rung_count ? g->rung : out->rung_count - 1;
    out->held = held < HELD_MOST ? (uint32_t)held : HELD_MOST;
    out->patience = g->patience;
    out->wall_only = g->trust.wall_only != 0;
    out->follows = g->follows != 0;
    out->trials = g->trials;
    out->fixed_ms = g->fixed;
    out->load_ms = g->load;
    out->fixed_variance = g->p[0][0];
    out->load_variance = g->p[1][1];
    out->covariance = g->p[0][1];
    out->noise = g->noise;
    out->overhead_ms = g->trust.overhead_known ? g->trust.overhead : 0.0;
    out->unit = g->trust.unit;
    out->settled_ms = g->settled_load > 0.0 ? g->settled_load : 0.0;
    out->mistake_ms = g->mistake_load;
    for (uint32_t r = 0; r < out->rung_count; r++) {
        out->rungs[r].scale = g->scale[r];
        out->rungs[r].prior = g->prior[r];
        out->rungs[r].cost = g->cost[r];
        out->rungs[r].variance = g->cost_variance[r];
        out->rungs[r].penalty = g->penalty[r];
    }
}

/* ---- Validation ------------------------------------------------------------------------------ */

static masu_result in_range(double x, double low, double high, const char *what,
                            masu_detail *detail) {
    if (x >= low && x <= high) return MASU_OK; /* false for NaN */
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s is %g, allowed are %g to %g",
                     what, x, low, high);
}

masu_result masu_governor_state_check(const masu_governor_state *s, masu_detail *detail) {
    if (s->bytes != sizeof *s) {
        return masu_fail(detail, MASU_ERROR_VERSION, "state.bytes", sizeof *s, s->bytes,
                         "state.bytes is %u, needed are %u", s->bytes, (unsigned)sizeof *s);
    }
    if (s->version != MASU_GOVERNOR_STATE_VERSION) {
        return masu_fail(detail, MASU_ERROR_VERSION, "state.version", MASU_GOVERNOR_STATE_VERSION,
                         s->version, "state.version is %u, needed is %u", s->version,
                         MASU_GOVERNOR_STATE_VERSION);
    }
    masu_result bad = in_range(s->known, 0, 1, "state.known", detail);
    if (bad || !s->known) return bad;
#define RANGE(field, low, high)                                                                    \
    if (!bad) bad = in_range(s->field, low, high, "state." #field, detail)
    RANGE(width, 1, OUTPUT_MOST);
    RANGE(height, 1, OUTPUT_MOST);
    RANGE(rung_count, 1, MASU_MAX_RUNGS);
    RANGE(rung, 0, s->rung_count - 1.0);
    RANGE(held, 0, HELD_MOST);
    RANGE(patience, 1, 1u << MASU_GOVERNOR_DOUBLINGS);
    RANGE(wall_only, 0, 1);
    RANGE(follows, 0, 1);
    RANGE(trials, 0, MASU_GOVERNOR_DOUBLINGS);
    RANGE(fixed_ms, 0, 1e4);
    RANGE(load_ms, 1e-9, LOAD_MOST);
    RANGE(fixed_variance, 0, 1e8);
    RANGE(load_variance, 0, LOAD_MOST * LOAD_MOST);
    double most = bad ? 0.0 : sqrt(s->fixed_variance * s->load_variance) * (1.0 + 1e-6);
    RANGE(covariance, -most, most);
    RANGE(noise, MASU_GOVERNOR_NOISE_LEAST, MASU_GOVERNOR_NOISE_MOST);
    RANGE(overhead_ms, 0, 1e4);
    RANGE(unit, 1e-9, 1e9);
    RANGE(settled_ms, 0, LOAD_MOST);
    RANGE(mistake_ms, 0, LOAD_MOST);
    for (uint32_t r = 0; !bad && r < s->rung_count; r++) {
        RANGE(rungs[r].scale, 0.01, 1);
        RANGE(rungs[r].prior, 1e-6, 1e6);
        RANGE(rungs[r].cost, 1e-7, COST_MOST);
        RANGE(rungs[r].variance, 0, 1);
        RANGE(rungs[r].penalty, 1, 2);
    }
#undef RANGE
    return bad;
}

/* ---- Import ---------------------------------------------------------------------------------- */

static int same(double a, double b) { return fabs(a - b) <= 1e-6 * fabs(b); }

/* Imports measured costs for rungs that have the same description. Rungs have the same order on
 * both sides, and each is used once. Returns whether all rungs are the same. */
static int import_costs(masu_governor *g, const masu_governor_state *s) {
    uint32_t from = 0, found = 0;
    for (uint32_t r = 0; r < g->count; r++) {
        for (uint32_t o = from; o < s->rung_count; o++) {
            if (!same(s->rungs[o].scale, g->scale[r]) || !same(s->rungs[o].prior, g->prior[r]))
                continue;
            g->cost[r] = s->rungs[o].cost;
            g->cost_variance[r] = s->rungs[o].variance;
            g->penalty[r] = s->rungs[o].penalty;
            from = o + 1;
            found++;
            break;
        }
    }
    return found == g->count && g->count == s->rung_count;
}

void masu_governor_import_state(masu_governor *g, const masu_governor_state *s, VkExtent2D output,
                                uint64_t frame) {
    if (!s->known || g->mode == MASU_GOVERNOR_OFF) return;
    double pixels = (double)output.width * output.height / ((double)s->width * s->height);
    int all = import_costs(g, s) && same(pixels, 1.0);
    g->fixed = s->fixed_ms;
    g->load = masu_within(s->load_ms, 1e-6 * g->target, 1e9 * g->target);
    g->slope = g->trend = 0.0;
    memset(g->p, 0, sizeof g->p);
    g->p[0][0] = s->fixed_variance;
    g->p[1][1] = s->load_variance;
    g->p[0][1] = g->p[1][0] = s->covariance;
    g->p[2][2] = 1e-4 * g->load * g->load;
    g->noise = s->noise;
    g->trust.unit = s->unit;
    g->trust.wall_only = s->wall_only != 0;
    g->trust.overhead = s->overhead_ms;
    g->trust.overhead_known = s->overhead_ms > 0.0;
    g->odd_count = g->misses = 0;
    g->newest = g->since = frame;
    g->known = 1;
    memset(&g->survey, 0, sizeof g->survey);
    memset(&g->spikes, 0, sizeof g->spikes);
    g->follows = s->follows != 0;
    g->trials = s->trials;
    g->trial_ended = frame;
    g->trial = 0;
    if (all) {
        g->patience = s->patience;
        g->mistake_load = s->mistake_ms;
        g->settled_load = s->settled_ms > 0.0 ? s->settled_ms : -1.0;
    } else {
        masu_governor_scale(g, pixels, frame);
    }
    if (g->mode != MASU_GOVERNOR_ON || g->started) return;
    if (all && s->rung >= g->best && s->rung <= g->worst) {
        g->rung = s->rung;
        g->held_before = s->held;
    } else {
        masu_governor_settle_at_best(g);
    }
    g->reason = MASU_GOVERNOR_REASON_HOLD;
}

void masu_governor_scale(masu_governor *g, double pixels, uint64_t frame) {
    if (!(pixels > 0.0) || pixels > 1e12 || !g->known) return;
    double(*p)[3] = g->p, fixed = 0.5 * (1.0 + pixels), d = 0.5 * (pixels - 1.0) * g->fixed;
    g->fixed *= fixed;
    g->load = masu_within(g->load * pixels, 1e-6 * g->target, 1e9 * g->target);
    g->slope = g->trend = 0.0;
    p[0][0] = p[0][0] * fixed * fixed + d * d;
    p[0][1] = p[1][0] = p[0][1] * fixed * pixels;
    p[1][1] *= pixels * pixels;
    p[0][2] = p[2][0] = p[1][2] = p[2][1] = 0.0;
    p[2][2] = 1e-4 * g->load * g->load;
    masu_governor_forget_mistakes(g);
    memset(&g->survey, 0, sizeof g->survey);
    memset(&g->spikes, 0, sizeof g->spikes);
    g->settled_load = -1.0;
    g->odd_count = 0;
    g->misses = 0;
    g->trial = 0;
    g->newest = g->since = frame;
    g->urged = 2;
}

