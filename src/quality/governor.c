/* governor.c: frame times in, a rung of the ladder out. See governor.h.
 *
 * Two parts: the filter that follows fixed part, load and slope; the laws by which a rung is left.
 * What is believed of a sample is in trust.c. Nothing is summed up over time but variances, which are
 * bounded, so there is nothing that could wind up at the end of the ladder. */
#include "quality/governor.h"

#include "shared/floats.h"
#include "quality/governor_desc.h"

#include <math.h>
#include <string.h>

/* ---- Constants: all are times in frames, deviations, or parts
 * ------------------------------------ */

#define PAUSE 1e3 /* ms: longer is rather a pause than a frame */
#define NOISE_FIRST 0.02
#define NOISE_LEAST 0.003 /* timers are no better */
#define NOISE_MOST 0.5
#define NOISE_WINDOW 64u
#define FIXED_PRIOR 0.1   /* of the first time, as is its deviation */
#define LOAD_DRIFT 0.0025 /* relative deviation of what a load changes by from frame to frame, */
#define SLOPE_DRIFT 0.009 /* and of what its slope does, while it moves */
#define REST 0.04         /* of both, while it does not */
#define TREND_WEIGHT 0.2  /* of the last innovation in their mean */
#define TREND_REST 0.7    /* deviations: below it a mean of white noise is at rest, */
#define TREND_MOVES 1.1   /* and from here on the load moves for certain; */
#define TREND_MOST 6.0    /* the faster, the looser the filter, up to this factor */
#define SLOPE_MOST 0.5    /* of the load in a frame: more is a jump and no slope */
/* Of a prior cost, relative. Not more: costs would take from a moving load what is the load's. */
#define COST_DEVIATION 0.005
#define COST_KNOWN 0.0015 /* of one that has been measured before */
#define COST_RANGE 4.0    /* how far a cost may come from its prior, as a factor */
#define GATE 3.0          /* deviations: what is farther is odd, */
#define GATE_LEAST 0.2    /* unless it is nearer than this part of what is expected */
#define ODD_AGREE 1.5     /* factor within which odd samples say the same */
#define ODD_FAR 4.0       /* factor: without a wall to confirm it, odd samples of so much */
#define ODD_FAR_COUNT 3u  /* more need as many that agree, */
#define ODD_NEAR_COUNT 8u /* of so much less, as many; */
#define ODD_LIE_COUNT 90u /* and less than a frame can take: a timer that has stopped is likelier */
#define LEAST_TIME 0.02   /* of the target, and half of the fixed part: what a frame can take */
#define ODD_PAUSE_COUNT 8u

#define MARGIN MASU_GOVERNOR_MARGIN
#define MARGIN_REST 1.25 /* and those with which it is kept, at rest */
#define MARGIN_MOVES 3.5 /* and while the load rises, where the prediction is late: */
#define RISES_LEAST 0.05 /* by this part in a dwell it does not yet, */
#define RISES_MOST 0.15  /* by this one it does */
#define FALL_AHEAD 0.75  /* of the dwell: so far ahead a slope is followed to choose a lower rung */
#define LEAD_MOST 8.0    /* frames: farther than this no slope is followed to reach the present */
#define STALE_FRAMES 30u
#define STEP_UP 1.5        /* a rise to less than this factor of cost is worth waiting for, */
#define STEP_WAIT 5u       /* so many halves of the dwell */
#define SETTLE_WAIT 8u     /* halves of the dwell: then the rung has settled */
#define SETTLE_BAND 0.05   /* a load within it of where it settled has not moved */
#define MISTAKE_LOAD 1.1   /* factor within which the load is where it was at the last rise, */
#define MISTAKE_RANGE 1.25 /* and this one since */
#define FORGET_LOAD 1.3    /* a load that has changed by this factor is new: mistakes are past */
/* Of rungs that were risen to by mistake: factor on what they are expected to take. */
#define PENALTY_LEAST 1.02
#define PENALTY_MOST 1.15
#define PATIENCE_MOST 64u
/* A clock that follows its own load makes a low rung as slow as a better one. Whether it does is tried: */
#define TRIAL_BUSY 0.92    /* of the target: a rung that takes less at rest may be so because of it, */
#define TRIAL_MOST 1.25    /* and one is tried that is expected to take at most so much of it, */
#define TRIAL_FRAMES 12u   /* for so long; */
#define TRIAL_WAIT 1800u   /* frames at rest until then where nothing is known of the clock, */
#define TRIAL_AGAIN 300u   /* or after one that failed where clocks have followed: both double, */
#define TRIAL_FOLLOWS 0.96 /* of what was expected: a time that is less shows a clock that followed */
#define RISE_FOLLOWS 0.8   /* the same of one that was over the target just after a rise */
#define TRIALS_MOST 6u     /* so often */
#define TRIALS_DOUBT 3u    /* failures in a row, and nothing is known of the clock any more */
#define HOLD 8u /* frames: the least that a rung is kept for while the target is */
#define NO_GAIN 1.05 /* rungs within this factor of the least time save nothing */

#define NEVER UINT64_MAX

/* ---- Init ------------------------------------------------------------------------------------ */

/* What can be changed later of a description; what is out of range counts as 0. */
static void apply_desc(masu_governor *g, const masu_governor_desc *desc) {
    g->mode = desc->mode;
    g->asked =
        desc->target_ms >= 1.0f && desc->target_ms <= 1000.0f ? (double)desc->target_ms : MASU_GOVERNOR_TARGET_MS;
    g->target = masu_pacing_target(&g->pacing, g->asked);
    g->headroom = desc->headroom < 0.0f                             ? 0.0
                  : desc->headroom > 0.0f && desc->headroom <= 0.5f ? (double)desc->headroom
                                                                    : MASU_GOVERNOR_HEADROOM;
    g->dwell = desc->dwell >= 1 && desc->dwell <= 600 ? desc->dwell : MASU_GOVERNOR_DWELL;
    g->worst =
        desc->worst_rung >= 1 && desc->worst_rung < g->count ? desc->worst_rung : g->count - 1;
    g->best = desc->best_rung <= g->worst ? desc->best_rung : 0;
    g->fixed_rung = desc->rung < g->count ? desc->rung : g->count - 1;
}

void masu_governor_init(masu_governor *g, const masu_governor_desc *desc,
                        const masu_governor_rung *rungs, uint32_t count) {
    memset(g, 0, sizeof *g);
    g->count = count < 1 ? 1 : count > MASU_GOVERNOR_RUNGS ? MASU_GOVERNOR_RUNGS : count;
    apply_desc(g, desc);
    for (uint32_t r = 0; r < g->count; r++) {
        double s = masu_within(rungs[r].scale, 0.01, 1.0);
        double cost = rungs[r].cost;
        g->scale[r] = s;
        g->prior[r] = cost > 0.0 && cost <= 1e6 ? masu_largest(cost, 1e-6) : s * s;
        g->cost[r] = g->prior[r];
        g->cost_variance[r] = COST_DEVIATION * COST_DEVIATION;
        g->penalty[r] = 1.0;
    }
    g->noise = NOISE_FIRST;
    g->steady_clock = desc->steady_clock != 0;
    masu_trust_start(&g->trust);
    g->cut = NEVER;
    g->patience = 1;
    g->settled_load = -1.0;
    g->rung = g->mode == MASU_GOVERNOR_FIXED ? g->fixed_rung : g->best;
    g->reason = g->mode == MASU_GOVERNOR_FIXED ? MASU_GOVERNOR_REASON_FIXED
                : g->mode == MASU_GOVERNOR_ON  ? MASU_GOVERNOR_REASON_START
                                               : MASU_GOVERNOR_REASON_NONE;
}

/* ---- The filter ------------------------------------------------------------------------------ */

/* 0: at rest; 1: the load moves; more: the filter is late. */
static double late(const masu_governor *g) {
    return masu_within((fabs(g->trend) - TREND_REST) / (TREND_MOVES - TREND_REST), 0.0, TREND_MOST);
}

static double moves(const masu_governor *g) { return masu_within(late(g), 0.0, 1.0); }

/* Timers that count in coarse steps give the same time again and again; real ones never do. The
 * step is the least difference that is seen; a time is then off by a variance of a twelfth of
 * its square. */
static void follow_grain(masu_governor *g, double raw) {
    double d = fabs(raw - g->raw);
    if (d > 0.0 && (g->grain == 0.0 || d < g->grain)) g->grain = d;
    g->repeats += ((d > 0.0 ? 0.0 : 1.0) - g->repeats) / 32.0;
    if (g->repeats < 0.05) g->grain = 0.0;
    g->raw = raw;
}

/* Variance of one sample of this time. */
static double sample_variance(const masu_governor *g, double ms) {
    double r = g->noise * ms;
    return r * r + g->grain * g->grain / 12.0;
}

/* The load is where this time says; how it moves is forgotten, the fixed part is kept. */
static void restart(masu_governor *g, uint32_t rung, double ms) {
    double c = g->cost[rung], variance = g->p[0][0];
    g->fixed = masu_within(g->fixed, 0.0, 0.5 * ms);
    g->load = (ms - g->fixed) / c;
    g->slope = 0.0;
    memset(g->p, 0, sizeof g->p);
    g->p[0][0] = variance;
    g->p[0][1] = g->p[1][0] = -variance / c;
    g->p[1][1] = (variance + sample_variance(g, ms)) / (c * c);
    g->p[2][2] = 1e-4 * g->load * g->load;
    g->trend = 0.0;
    g->odd_count = 0;
    g->settled_load = -1.0;
}

/* Samples of a rung that was just changed to contradict the model: with the load as it was, two
 * rungs and their times give both parts. Returns 0 if they do not, because the load has moved as
 * well. */
static int refit(masu_governor *g, uint32_t rung, double ms) {
    uint32_t other = g->fitted;
    double c = g->cost[rung], step = g->cost[other] - c;
    if (other == rung || fabs(step) < 0.05 * (g->cost[other] + c)) return 0;
    double load = (g->fixed + g->cost[other] * g->load - ms) / step;
    double noise = 3.0 * sqrt(2.0 * sample_variance(g, ms)) / fabs(step);
    if (!(load >= -noise)) return 0;
    load = masu_largest(load, 0.01 * g->target);
    double fixed = ms - c * load;
    if (!(fixed >= 0.0)) return 0;
    restart(g, rung, ms);
    g->fixed = fixed;
    g->load = load;
    double d = 2.0 * sqrt(sample_variance(g, ms)) * (g->cost[other] + c) / fabs(step);
    g->p[0][0] = d * d;
    g->p[0][1] = g->p[1][0] = -g->p[0][0] / c;
    g->p[1][1] = (g->p[0][0] + sample_variance(g, ms)) / (c * c);
    return 1;
}

static void start(masu_governor *g, uint32_t rung, double ms) {
    g->fixed = FIXED_PRIOR * ms;
    g->p[0][0] = g->fixed * g->fixed;
    restart(g, rung, ms);
    g->known = 1;
}

/* Second differences of three samples in a row at one rung know nothing of level and slope, and
 * have 6 times the variance of one. Their mean size, not the root of a mean square: outliers
 * count less. */
static void follow_noise(masu_governor *g, uint32_t rung, double ms) {
    if (g->before_count && g->before_rung != rung) g->before_count = 0;
    /* The steps of a coarse timer are no noise, nor is it at rest while it stands still. */
    if (g->grain > 0.0 || (g->before_count && g->before[0] == ms)) return;
    if (g->before_count >= 2) {
        double d = fabs(ms - 2.0 * g->before[0] + g->before[1]) / ms * (1.2533 / 2.4495);
        g->noise_samples += g->noise_samples < NOISE_WINDOW;
        uint32_t n = g->noise_samples + 8 < NOISE_WINDOW ? g->noise_samples + 8 : NOISE_WINDOW;
        g->noise += (masu_within(d, 0.0, 3.0 * g->noise) - g->noise) / (double)n;
        g->noise = masu_within(g->noise, NOISE_LEAST, NOISE_MOST);
    }
    g->before[1] = g->before[0];
    g->before[0] = ms;
    g->before_rung = rung;
    if (g->before_count < 2) g->before_count++;
}

/* Time update: constant slope, and what it and the load may drift by. */
static void advance(masu_governor *g, double frames) {
    double(*p)[3] = g->p;
    double q = REST + (1.0 - REST) * late(g);
    double size = masu_largest(g->load, 0.02 * g->target);
    g->load += g->slope * frames;
    p[1][1] += 2.0 * frames * p[1][2] + frames * frames * p[2][2];
    p[0][1] += frames * p[0][2];
    p[1][2] += frames * p[2][2];
    double load = LOAD_DRIFT * size * q, slope = SLOPE_DRIFT * size * q;
    p[1][1] += frames * load * load;
    p[2][2] += frames * slope * slope;
    p[1][0] = p[0][1];
    p[2][1] = p[1][2];
}

/* Measurement update with value = h . state + noise of this variance. */
static void correct(masu_governor *g, const double h[3], double innovation, double variance) {
    double ph[3], k[3], s = variance;
    for (int i = 0; i < 3; i++) {
        ph[i] = g->p[i][0] * h[0] + g->p[i][1] * h[1] + g->p[i][2] * h[2];
        s += h[i] * ph[i];
    }
    if (!(s > 1e-30)) return;
    for (int i = 0; i < 3; i++) k[i] = ph[i] / s;
    g->fixed += k[0] * innovation;
    g->load += k[1] * innovation;
    g->slope += k[2] * innovation;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) g->p[i][j] -= k[i] * ph[j];
    }
}

/* A sample that nothing explains. Returns 1 once enough of them have said the same. */
static int is_certain(masu_governor *g, const masu_governor_sample *s, double ms, double expected,
                      int sure) {
    int sign = ms > expected ? 1 : -1;
    double load = ms / g->cost[s->rung];
    uint32_t needed = 2;
    if (!sure && ms > ODD_FAR * expected) needed = ODD_FAR_COUNT;
    if (!sure && ms * ODD_FAR < expected) {
        int can_be = ms >= masu_largest(0.5 * g->fixed, LEAST_TIME * g->target);
        needed = can_be ? ODD_NEAR_COUNT : ODD_LIE_COUNT;
    }
    if (ms > PAUSE && ms > ODD_FAR * expected) needed = ODD_PAUSE_COUNT;
    int same = g->odd_count && g->odd_sign == sign && load < ODD_AGREE * g->odd_load &&
               load * ODD_AGREE > g->odd_load;
    g->odd_count = same ? g->odd_count + 1 : 1;
    g->odd_sign = sign;
    g->odd_load = load;
    return g->odd_count >= needed;
}

/* What passes at output size have taken says what the fixed part is, roughly: they are not all
 * of it, and not all of them are fixed. */
static void follow_fixed(masu_governor *g, const masu_governor_sample *s, double ms) {
    static const double h[3] = {1.0, 0.0, 0.0};
    double fixed = s->fixed_ms * g->trust.unit;
    if (!(fixed > 0.0 && fixed <= ms) || g->trust.source != MASU_GOVERNOR_SOURCE_GPU) return;
    fixed += g->trust.overhead;
    double d = 0.1 * fixed + 0.02 * g->target;
    correct(g, h, fixed - g->fixed, d * d);
}

static void follow(masu_governor *g, const masu_governor_sample *s, double ms, int sure) {
    double c = g->cost[s->rung], own = sample_variance(g, ms);
    double frames = s->frame > g->newest ? (double)(s->frame - g->newest) : 0.0;
    double load = g->load, p[3][3];
    uint64_t newest = g->newest;
    memcpy(p, g->p, sizeof p);
    advance(g, masu_within(frames, 0.0, 60.0));
    g->newest = s->frame;
    if (g->cut <= s->frame) {
        g->cut = NEVER;
        restart(g, s->rung, ms);
        g->jumped = 1;
        return;
    }
    double expected = g->fixed + c * g->load, innovation = ms - expected;
    const double h[3] = {1.0, c, 0.0};
    double state = g->p[0][0] + 2.0 * c * g->p[0][1] + c * c * g->p[1][1];
    double pixel = c * g->load, rung = pixel * pixel * g->cost_variance[s->rung];
    double variance = masu_largest(state, 0.0) + rung + own, deviation = sqrt(variance);
    if (ms < ODD_FAR * expected && ms * ODD_FAR > expected) follow_noise(g, s->rung, ms);
    if (fabs(innovation) > masu_largest(GATE * deviation, GATE_LEAST * expected)) {
        if (is_certain(g, s, ms, expected, sure)) {
            if (!refit(g, s->rung, ms)) restart(g, s->rung, ms);
            g->fitted = s->rung;
            g->jumped = 1;
            return;
        }
        g->load = load; /* as if it had not come */
        g->newest = newest;
        memcpy(g->p, p, sizeof p);
        return;
    }
    g->odd_count = 0;
    g->fitted = s->rung;
    follow_grain(g, g->trust.source == MASU_GOVERNOR_SOURCE_GPU ? s->gpu_ms * g->trust.unit : ms);
    g->trend += TREND_WEIGHT * (innovation / deviation - g->trend);
    correct(g, h, innovation, own + rung);
    /* What the rung's own cost is to blame for. Its covariance with the load is left out: while it
     * matters, just after the first visit, the two are still apart. */
    double share = rung / variance;
    if (pixel > 0.0) {
        double cost = c * (1.0 + share * innovation / pixel);
        g->cost[s->rung] =
            masu_within(cost, g->prior[s->rung] / COST_RANGE, g->prior[s->rung] * COST_RANGE);
    }
    g->cost_variance[s->rung] *= 1.0 - share;
    follow_fixed(g, s, ms);
    g->fixed = masu_within(g->fixed, 0.0, ms);
    g->load = masu_within(g->load, 1e-6 * g->target, 1e9 * g->target);
    double most = SLOPE_MOST * masu_largest(g->load, 0.02 * g->target);
    g->slope = masu_within(g->slope, -most, most);
}

/* A frame over the target just after a rise, and a few frames later the same rung takes much less: loads
 * seldom fall just then, clocks that follow them rise. */
static void watch_clock(masu_governor *g, const masu_governor_sample *s, double ms) {
    if (s->rung != g->seen_rung) {
        g->seen_ms = s->rung < g->seen_rung && ms > g->target ? ms : 0.0;
        g->seen_frame = s->frame;
        g->seen_rung = s->rung;
    } else if (ms < RISE_FOLLOWS * g->seen_ms && s->frame - g->seen_frame <= TRIAL_FRAMES) {
        g->seen_ms = 0.0;
        if (!g->steady_clock) g->follows = 1;
    }
}

static int is_sound(const masu_governor *g) {
    double sum =
        g->fixed + g->load + g->slope + g->noise + g->trend + g->trust.overhead + g->trust.distrust + g->grain;
    for (int i = 0; i < 3; i++) {
        if (!(g->p[i][i] >= 0.0)) return 0;
        for (int j = 0; j < 3; j++) sum += g->p[i][j];
    }
    return sum - sum == 0.0; /* neither infinite nor NaN */
}

void masu_governor_sample_in(masu_governor *g, const masu_governor_sample *s) {
    if (g->mode == MASU_GOVERNOR_OFF || s->rung >= g->count || (g->any && s->frame <= g->last)) {
        g->rejected++;
        return;
    }
    g->any = 1;
    g->last = s->frame;
    int sure;
    if (s->exclude_from_timing || s->frame < g->since) {
        g->rejected++;
        return;
    }
    double ms = masu_trust_time(&g->trust, g->target, s, &sure);
    if (!(ms > 0.0) || !g->warm) { /* drivers still compile in the first frame */
        g->warm = g->warm || ms > 0.0;
        g->rejected++;
        return;
    }
    watch_clock(g, s, ms);
    g->samples++;
    if (g->pacing.refresh == 0.0) g->missed += ms > g->target; /* else the display tells */
    if (s->rung == g->rung && s->frame >= g->changed)
        g->misses = ms > g->target ? g->misses + (g->misses < 1000) : 0;
    if (!g->known) {
        g->newest = s->frame;
        g->fitted = s->rung;
        start(g, s->rung, ms);
        return;
    }
    follow(g, s, ms, sure);
    if (is_sound(g)) return;
    g->trust.overhead = g->trust.distrust = g->grain = 0.0;
    g->noise = NOISE_FIRST;
    start(g, s->rung, ms);
}

/* ---- The laws -------------------------------------------------------------------------------- */

/* What a frame `lead` frames past the newest sample takes at a rung, and `margin` deviations more.
 * falls: a load that falls is followed too; else it is taken as it is. */
double masu_governor_upper(const masu_governor *g, uint32_t rung, double lead, int falls, double margin) {
    double c = g->cost[rung], slope = g->slope < 0.0 && !falls ? 0.0 : g->slope;
    double load = masu_largest(g->load + slope * lead, 0.0), mean = g->fixed + c * load;
    double v = g->p[0][0] + 2.0 * c * g->p[0][1] + c * c * g->p[1][1] + sample_variance(g, mean) +
               c * load * c * load * g->cost_variance[rung];
    return mean + margin * sqrt(masu_largest(v, 0.0));
}

double masu_governor_predict(const masu_governor *g, uint32_t rung) {
    if (!g->known || rung >= g->count) return 0.0;
    return g->fixed + g->cost[rung] * g->load;
}

/* The best rung below what is drawn that keeps the target for a dwell, at the present slope; if
 * none does, the cheapest, or one that is as cheap as that. */
static uint32_t fall(const masu_governor *g, double lead, masu_governor_reason *reason) {
    double last = lead + (g->follows ? 0.0 : FALL_AHEAD * (double)g->dwell), least = 0.0;
    for (uint32_t r = g->best; r <= g->worst; r++) {
        double ms = masu_governor_upper(g, r, last, 0, 0.0);
        if (r == g->best || ms < least) least = ms;
        if (g->cost[r] < g->cost[g->rung] && masu_governor_upper(g, r, last, 0, MARGIN) <= g->target) return r;
    }
    for (uint32_t r = g->best; r <= g->worst; r++) {
        if (masu_governor_upper(g, r, last, 0, 0.0) > NO_GAIN * least) continue;
        int is_dearer = r < g->worst && g->cost[r] > 1.2 * g->cost[g->worst];
        *reason = is_dearer ? MASU_GOVERNOR_REASON_NO_GAIN : MASU_GOVERNOR_REASON_WORST;
        return r;
    }
    return g->worst;
}

/* The best rung that keeps the target with headroom, now and for a dwell; else the present one. */
static uint32_t rise(const masu_governor *g, double lead) {
    double most = g->target * (1.0 - g->headroom);
    for (uint32_t r = g->best; r < g->rung; r++) {
        double now = masu_governor_upper(g, r, lead, 1, MARGIN), then = masu_governor_upper(g, r, lead + g->dwell, 0, MARGIN);
        if (masu_largest(now, then) * g->penalty[r] <= most) return r;
    }
    return g->rung;
}

static void change(masu_governor *g, uint64_t frame, uint32_t rung, masu_governor_reason reason) {
    if (rung == g->rung) return;
    g->cost_variance[rung] = masu_largest(g->cost_variance[rung], COST_KNOWN * COST_KNOWN);
    g->rung = rung;
    g->changed = frame;
    g->reason = reason;
    g->held_before = 0;
    g->trial = reason == MASU_GOVERNOR_REASON_TRIAL;
    g->misses = 0;
    g->changes++;
    g->settled_load = -1.0;
}

static void raise_to(masu_governor *g, uint64_t frame, uint32_t rung, masu_governor_reason reason) {
    g->raised_load = g->load_low = g->load_high = g->load;
    g->raised_rung = rung;
    g->raised_ms = masu_governor_predict(g, rung);
    g->failed = 0;
    change(g, frame, rung, reason);
    g->rising = 1;
}

static int is_near(double a, double b, double factor) { return a < factor * b && b < factor * a; }

/* Whether a rise now would repeat one that was taken back, with nothing but noise in between:
 * then what its rung has taken counts against it and all better ones, and waiting for the next
 * doubles. */
static int repeats_a_mistake(masu_governor *g) {
    if (!g->failed || !is_near(g->load, g->raised_load, MISTAKE_LOAD) ||
        !is_near(g->load_low, g->raised_load, MISTAKE_RANGE) ||
        !is_near(g->load_high, g->raised_load, MISTAKE_RANGE))
        return 0;
    double penalty = masu_within(g->failed_ms / g->raised_ms, PENALTY_LEAST, PENALTY_MOST);
    for (uint32_t r = g->best; r <= g->raised_rung; r++)
        g->penalty[r] = masu_largest(g->penalty[r], penalty);
    g->mistake_load = g->load;
    if (g->patience < PATIENCE_MOST) g->patience *= 2;
    g->failed = 0;
    return 1;
}

void masu_governor_forget_mistakes(masu_governor *g) {
    for (uint32_t r = 0; r < g->count; r++) g->penalty[r] = 1.0;
    g->patience = 1;
    g->failed = 0;
}

/* 0: the load does not rise; 1: it does, for certain. What a clock does that follows is no rise: it ends
 * before the target is missed. */
static double rises(const masu_governor *g) {
    if (g->follows) return 0.0;
    double part = g->slope * (double)g->dwell / g->load;
    if (g->settled_load >= 0.0 && g->load < (1.0 + SETTLE_BAND) * g->settled_load) return 0.0;
    return moves(g) * masu_within((part - RISES_LEAST) / (RISES_MOST - RISES_LEAST), 0.0, 1.0);
}

double masu_governor_lead(const masu_governor *g, uint64_t frame) {
    return masu_within(frame > g->newest ? (double)(frame - g->newest) : 0.0, 0.0, LEAD_MOST);
}

/* A trial ends: the rung is kept if it takes no longer than it may by now, whatever the reason. */
static void end_trial(masu_governor *g, uint64_t frame, int over) {
    g->trial = 0;
    g->trial_load = g->load;
    g->trial_ended = frame;
    if (!over && masu_governor_predict(g, g->rung) < TRIAL_FOLLOWS * g->trial_ms) {
        g->follows = 1;
        g->trials = 0;
        return;
    }
    if (g->trials < TRIALS_MOST) g->trials++;
    if (g->trials >= TRIALS_DOUBT) g->follows = 0;
    if (!over) return;
    change(g, frame, g->trial_from, MASU_GOVERNOR_REASON_DOWN);
    g->rising = 0;
}

/* Nothing better fits, and there is room: begins a trial if it is time for one. */
static void try_clock(masu_governor *g, uint64_t frame, uint64_t still) {
    uint32_t r = g->rung - 1;
    if (g->rung <= g->best || g->steady_clock || g->odd_count || moves(g) > 0.0 || g->noise > 0.05)
        return;
    if (!g->follows && g->settled_load < 0.0) return;
    while (r > g->best && g->cost[r] < NO_GAIN * g->cost[g->rung]) r--;
    if (masu_governor_predict(g, g->rung) > TRIAL_BUSY * g->target ||
        masu_governor_predict(g, r) > TRIAL_MOST * g->target)
        return;
    /* Elsewhere the clock may have room again. */
    if (g->follows && !is_near(g->load, g->trial_load, FORGET_LOAD)) g->trials = 0;
    uint64_t wait = !g->follows ? TRIAL_WAIT : g->trials ? TRIAL_AGAIN : g->dwell;
    if (still < (g->follows ? g->dwell : TRIAL_WAIT) ||
        (g->trials && frame - g->trial_ended < wait << g->trials))
        return;
    g->trial_from = g->rung;
    g->trial_ms = masu_governor_predict(g, r);
    g->rising = 0;
    change(g, frame, r, MASU_GOVERNOR_REASON_TRIAL);
}

static void choose(masu_governor *g, uint64_t frame) {
    double lead = masu_governor_lead(g, frame);
    double keep = MARGIN_REST + (MARGIN_MOVES - MARGIN_REST) * rises(g);
    if (g->jumped || moves(g) > 0.5) g->restless = frame;
    if (g->load < g->load_low) g->load_low = g->load;
    if (g->load > g->load_high) g->load_high = g->load;
    if (g->jumped || !is_near(g->load, g->mistake_load, FORGET_LOAD)) {
        if (g->patience > 1) masu_governor_forget_mistakes(g);
    }
    uint64_t held = frame - g->changed + g->held_before;
    uint64_t dwell = (uint64_t)(g->dwell > HOLD ? g->dwell : HOLD) * g->patience;
    int over = masu_governor_upper(g, g->rung, lead, 1, keep) > g->target, urgent = g->misses >= 2;
    masu_governor_reason why = g->jumped ? MASU_GOVERNOR_REASON_JUMP
                               : over    ? MASU_GOVERNOR_REASON_DOWN
                                         : MASU_GOVERNOR_REASON_EMERGENCY;
    g->jumped = 0;
    if (g->trial) {
        if (held < TRIAL_FRAMES && masu_governor_predict(g, g->rung) < TRIAL_MOST * g->target) return;
        end_trial(g, frame, over);
        if (over) return;
    }
    if (over || urgent) {
        uint32_t r = fall(g, lead, &why);
        g->misses = 0;
        g->urged = 0;
        if (r == g->rung || (r < g->rung && held < dwell)) {
            g->reason = why == MASU_GOVERNOR_REASON_NO_GAIN ? why : MASU_GOVERNOR_REASON_WORST;
            return;
        }
        if (r < g->rung) { /* what it has cost in quality has saved nothing */
            raise_to(g, frame, r, why);
            return;
        }
        g->failed = g->rising && g->rung == g->raised_rung;
        g->failed_ms = masu_governor_predict(g, g->rung);
        g->rising = 0;
        change(g, frame, r, why);
        return;
    }
    uint64_t still = frame - (g->restless > g->changed ? g->restless : g->changed);
    if (g->settled_load < 0.0 && still * 2 >= SETTLE_WAIT * dwell) g->settled_load = g->load;
    uint32_t r = g->odd_count ? g->rung : rise(g, lead);
    if (r == g->rung) {
        if (!g->odd_count) g->urged = 0;
        g->reason = r == g->best ? MASU_GOVERNOR_REASON_BEST : MASU_GOVERNOR_REASON_HOLD;
        try_clock(g, frame, still);
        return;
    }
    if (g->urged && (held >= HOLD || g->urged > 1)) {
        g->urged = 0;
        g->rising = 0; /* what is found there is no mistake of this load */
        change(g, frame, r, MASU_GOVERNOR_REASON_UP);
        return;
    }
    int worth = g->cost[r] >= STEP_UP * g->cost[g->rung] || r == g->best;
    if (held < dwell || (!worth && held * 2 < STEP_WAIT * dwell) ||
        (g->settled_load >= 0.0 && g->load > (1.0 - SETTLE_BAND) * g->settled_load) ||
        repeats_a_mistake(g)) {
        g->reason = MASU_GOVERNOR_REASON_WAIT;
        return;
    }
    raise_to(g, frame, r, MASU_GOVERNOR_REASON_UP);
}

/* Whether it is asked for this frame for the first time. */
static int begin(masu_governor *g, uint64_t frame) {
    if (g->started && frame <= g->frame) return 0;
    if (!g->started) g->changed = frame;
    g->started = 1;
    g->frame = frame;
    g->target = masu_pacing_target(&g->pacing, g->asked);
    return 1;
}

static void pace(masu_governor *g, uint64_t frame, int excluded) {
    double ms = g->known ? masu_governor_upper(g, g->rung, masu_governor_lead(g, frame), 1, MARGIN_REST) : 0.0;
    masu_pacing_choose(&g->pacing, frame, masu_largest(ms, g->trust.cpu), g->target, excluded);
}

/* The host may have changed the mode or moved the range. */
static void obey(masu_governor *g, uint64_t frame) {
    int fixed = g->mode == MASU_GOVERNOR_FIXED;
    uint32_t best = fixed ? g->fixed_rung : g->best, worst = fixed ? g->fixed_rung : g->worst;
    uint32_t rung = g->rung < best ? best : g->rung > worst ? worst : g->rung;
    change(g, frame, rung, MASU_GOVERNOR_REASON_HOST);
    if (fixed) g->reason = MASU_GOVERNOR_REASON_FIXED;
}

static void decide(masu_governor *g, uint64_t frame) {
    if (!g->known || g->mode == MASU_GOVERNOR_FIXED) return;
    if (frame > g->newest && frame - g->newest > STALE_FRAMES)
        g->reason = MASU_GOVERNOR_REASON_STALE;
    else
        choose(g, frame);
}

static masu_governor_lock lock_of(const masu_governor *g) {
    if (g->mode != MASU_GOVERNOR_FIXED && g->known) {
        if (g->best == g->worst && g->reason != MASU_GOVERNOR_REASON_STALE)
            return MASU_GOVERNOR_LOCKED_FIXED;
        if (g->reason == MASU_GOVERNOR_REASON_WORST) return MASU_GOVERNOR_LOCKED_WORST;
        if (g->reason == MASU_GOVERNOR_REASON_NO_GAIN) return MASU_GOVERNOR_LOCKED_NO_GAIN;
    }
    if (g->trust.cpu > g->target) return MASU_GOVERNOR_LOCKED_CPU;
    return g->reason == MASU_GOVERNOR_REASON_STALE ? MASU_GOVERNOR_LOCKED_STALE
                                                   : MASU_GOVERNOR_FREE;
}

uint32_t masu_governor_pick(masu_governor *g, uint64_t frame) {
    if (g->mode == MASU_GOVERNOR_OFF || !begin(g, frame)) return g->rung;
    obey(g, frame);
    decide(g, frame);
    g->lock = lock_of(g);
    pace(g, frame, 0);
    return g->rung;
}

uint32_t masu_governor_hold(masu_governor *g, uint64_t frame) {
    if (g->mode == MASU_GOVERNOR_OFF || !begin(g, frame)) return g->rung;
    obey(g, frame);
    if (g->mode == MASU_GOVERNOR_ON) g->reason = MASU_GOVERNOR_REASON_EXCLUDED;
    pace(g, frame, 1);
    return g->rung;
}

void masu_governor_override(masu_governor *g, uint64_t frame, uint32_t rung, int excluded) {
    if (g->mode == MASU_GOVERNOR_OFF || rung >= g->count) return;
    if (g->mode == MASU_GOVERNOR_ON) {
        g->started = 1;
        g->frame = frame;
        /* The range is the governor's own: what comes next is chosen within it. */
        rung = rung < g->best ? g->best : rung > g->worst ? g->worst : rung;
        change(g, frame, rung, MASU_GOVERNOR_REASON_HOST);
        g->reason = MASU_GOVERNOR_REASON_HOST;
    }
    pace(g, frame, excluded);
}

void masu_governor_cut(masu_governor *g, uint64_t frame) { g->cut = frame; }

void masu_governor_shown(masu_governor *g, uint64_t frame, uint64_t ns, uint64_t refresh_ns) {
    if (g->mode != MASU_GOVERNOR_OFF)
        g->missed += (uint64_t)masu_pacing_shown(&g->pacing, frame, ns, refresh_ns);
}

/* ---- What the host changes ------------------------------------------------------------------- */

void masu_governor_adjust(masu_governor *g, const masu_governor_desc *desc) {
    masu_governor old = *g;
    apply_desc(g, desc);
    if (old.mode != g->mode && g->mode == MASU_GOVERNOR_ON)
        g->reason = g->known ? MASU_GOVERNOR_REASON_HOLD : MASU_GOVERNOR_REASON_START;
    if (old.asked == g->asked && old.headroom == g->headroom && old.best == g->best &&
        old.worst == g->worst && old.mode == g->mode)
        return;
    /* Where the load has settled and which rises were mistakes was learnt beside the old target. */
    masu_governor_forget_mistakes(g);
    g->settled_load = -1.0;
    g->misses = 0;
    g->urged = 1;
}

void masu_governor_settle_at_best(masu_governor *g) {
    g->rung = g->worst;
    g->rung = rise(g, 0.0);
}
