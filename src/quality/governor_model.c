/* governor_model.c: the model of frame times: a Kalman filter for fixed cost, load and slope, and
 * the cost of each rung. governor.c uses its predictions to select a rung; trust.c selects the
 * clock.
 *
 * Only bounded variances accumulate, so nothing winds up at the ends of the ladder. */
#include "quality/governor_model.h"

#include "shared/floats.h"

#include <math.h>
#include <string.h>

/* ---- Constants: times in frames, standard deviations, or ratios ------------------------------ */

/* Relative deviation of a sample before noise is measured. That of most GPUs, 2 %. */
#define NOISE_FIRST 0.02
/* Samples in the mean of the noise: a second at 60 Hz. */
#define NOISE_WINDOW 64u
/* Fixed cost that is assumed before the first sample, and its deviation, as fractions of the first
 * frame time. */
#define FIXED_PRIOR 0.1
/* Relative deviation of the slope of the load per frame, while the load changes. Fitted to the
 * simulated loads: less lags in sines of 50 frames, more follows the noise. */
#define SLOPE_DRIFT 0.009
/* Factor on it while the load is steady: the mean then extends over 8 frames and not 2. */
#define REST 0.04
/* Weight of the newest innovation in their mean, and deviations of that mean. The mean of white
 * noise has a deviation of sqrt(w / (2 - w)) = 0.33: REST is twice that, MOVES three times. */
#define TREND_WEIGHT 0.2
#define TREND_REST 0.7
#define TREND_MOVES 1.1
/* Relative deviation of a prior cost. A larger one would attribute changes of the load to the
 * cost. */
#define COST_DEVIATION 0.005
/* Factor: a cost is at most this far from its prior, and samples beyond this factor of the
 * prediction need more that agree, unless two clocks confirm them. Clocks of one GPU differ by less
 * in normal use. */
#define FAR 4.0
#define FAR_COUNT 3u /* above: two may be consecutive spikes */
/* Below the least plausible time: likely a stopped timer. 1.5 s at 60 Hz. */
#define LIE_COUNT 90u
#define GATE 3.0 /* deviations: samples farther away are outliers, one of 370 of white noise; */
/* Samples that differ from the prediction by at most this fraction of it are no outliers: the load
 * often changes as much. */
#define GATE_LEAST 0.2
#define ODD_AGREE 1.5 /* factor within which two outliers agree */
/* After a rise, a time below this fraction of the first one shows a clock that follows the load.
 * Steady loads differ less. */
#define RISE_FOLLOWS 0.8

#define NEVER UINT64_MAX

void masu_governor_model_init(masu_governor *g) {
    for (uint32_t r = 0; r < g->count; r++) {
        g->cost[r] = g->prior[r];
        g->cost_variance[r] = COST_DEVIATION * COST_DEVIATION;
    }
    g->noise = NOISE_FIRST;
    g->cut = NEVER;
    masu_trust_start(&g->trust);
}

/* ---- The filter ------------------------------------------------------------------------------ */

/* 0: steady load; 1: changing load; more: the filter lags. */
static double late(const masu_governor *g) {
    return masu_largest((fabs(g->trend) - TREND_REST) / (TREND_MOVES - TREND_REST), 0.0);
}

double masu_governor_moves(const masu_governor *g) { return masu_within(late(g), 0.0, 1.0); }

/* A coarse timer repeats exact values, which fine timers do not. The step is the smallest
 * difference observed; the variance of a time is then a twelfth of the square of the step. */
static void follow_grain(masu_governor *g, double raw) {
    double d = fabs(raw - g->raw);
    if (d > 0.0 && (g->grain == 0.0 || d < g->grain)) g->grain = d;
    g->repeats += ((d > 0.0 ? 0.0 : 1.0) - g->repeats) / 32.0;
    if (g->repeats < 0.05) g->grain = 0.0;
    g->raw = raw;
}

/* Variance of one sample with this time. */
static double sample_variance(const masu_governor *g, double ms) {
    double r = g->noise * ms;
    return r * r + g->grain * g->grain / 12.0;
}

/* Restarts the filter at the load of this time: forgets the slope, keeps the fixed cost. */
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

/* Used if samples of a newly selected rung contradict the model. With an unchanged load, two rungs
 * and their times determine fixed cost and load. Returns 0 if the result is implausible, because
 * the load has changed as well. */
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

/* Estimates the noise from second differences of three consecutive samples at one rung. These do
 * not depend on level and slope, and have 6 times the variance of a sample. Uses the mean absolute
 * value instead of the mean square, to give outliers less weight. */
static void follow_noise(masu_governor *g, uint32_t rung, double ms) {
    if (g->before_count && g->before_rung != rung) g->before_count = 0;
    /* Steps of a coarse timer are not noise, and repeated values do not mean zero noise. */
    if (g->grain > 0.0 || (g->before_count && g->before[0] == ms)) return;
    if (g->before_count >= 2) {
        double d = fabs(ms - 2.0 * g->before[0] + g->before[1]) / ms * (1.2533 / 2.4495);
        g->noise_samples += g->noise_samples < NOISE_WINDOW;
        uint32_t n = g->noise_samples + 8 < NOISE_WINDOW ? g->noise_samples + 8 : NOISE_WINDOW;
        g->noise += (masu_within(d, 0.0, 3.0 * g->noise) - g->noise) / (double)n;
        g->noise = masu_within(g->noise, MASU_GOVERNOR_NOISE_LEAST, MASU_GOVERNOR_NOISE_MOST);
    }
    g->before[1] = g->before[0];
    g->before[0] = ms;
    g->before_rung = rung;
    if (g->before_count < 2) g->before_count++;
}

/* Time update: constant slope, plus process noise. */
static void advance(masu_governor *g, double frames) {
    double(*p)[3] = g->p;
    double q = REST + (1.0 - REST) * late(g);
    double size = masu_largest(g->load, g->target / MASU_TRUST_RANGE);
    g->load += g->slope * frames;
    p[1][1] += 2.0 * frames * p[1][2] + frames * frames * p[2][2];
    p[0][1] += frames * p[0][2];
    p[1][2] += frames * p[2][2];
    double slope = SLOPE_DRIFT * size * q;
    p[2][2] += frames * slope * slope;
    p[1][0] = p[0][1];
    p[2][1] = p[1][2];
}

/* Measurement update with value = h . state + noise with this variance. */
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

/* An outlier. Returns 1 once enough outliers agree. */
static int is_certain(masu_governor *g, const masu_governor_sample *s, double ms, double expected,
                      int sure) {
    int sign = ms > expected ? 1 : -1;
    double load = ms / g->cost[s->rung];
    uint32_t needed = 2;
    if (!sure && ms > FAR * expected) needed = FAR_COUNT;
    if (!sure && ms * FAR < expected) {
        int can_be = ms >= masu_largest(0.5 * g->fixed, g->target / MASU_TRUST_RANGE);
        needed = can_be ? MASU_GOVERNOR_HOLD : LIE_COUNT;
    }
    if (ms > MASU_TRUST_RANGE * g->target && ms > FAR * expected) needed = MASU_GOVERNOR_HOLD;
    int same = g->odd_count && g->odd_sign == sign && load < ODD_AGREE * g->odd_load &&
               load * ODD_AGREE > g->odd_load;
    g->odd_count = same ? g->odd_count + 1 : 1;
    g->odd_sign = sign;
    g->odd_load = load;
    return g->odd_count >= needed;
}

/* The times of passes at output size are an estimate of the fixed cost. It is rough: they are not
 * all of the fixed cost, and not all their cost is fixed. */
static void follow_fixed(masu_governor *g, const masu_governor_sample *s, double ms) {
    static const double h[3] = {1.0, 0.0, 0.0};
    double fixed = s->fixed_ms * g->trust.unit;
    if (!(fixed > 0.0 && fixed <= ms) || g->trust.source != MASU_GOVERNOR_SOURCE_GPU) return;
    fixed += g->trust.overhead;
    double d = FIXED_PRIOR * fixed + g->target / MASU_TRUST_RANGE;
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
    if (ms < FAR * expected && ms * FAR > expected) follow_noise(g, s->rung, ms);
    if (fabs(innovation) > masu_largest(GATE * deviation, GATE_LEAST * expected)) {
        if (is_certain(g, s, ms, expected, sure)) {
            /* At a new rung the cost may be wrong; at the same rung the load has changed. */
            if (s->rung == g->fitted) masu_survey_forget(&g->survey);
            masu_survey_sample(&g->survey, s->frame, s->rung, ms);
            if (!refit(g, s->rung, ms)) restart(g, s->rung, ms);
            g->fitted = s->rung;
            g->jumped = 1;
            return;
        }
        g->load = load; /* ignores the sample */
        g->newest = newest;
        memcpy(g->p, p, sizeof p);
        return;
    }
    g->odd_count = 0;
    g->fitted = s->rung;
    masu_survey_sample(&g->survey, s->frame, s->rung, ms);
    follow_grain(g, g->trust.source == MASU_GOVERNOR_SOURCE_GPU ? s->gpu_ms * g->trust.unit : ms);
    g->trend += TREND_WEIGHT * (innovation / deviation - g->trend);
    correct(g, h, innovation, own + rung);
    /* The share of the innovation that the cost of the rung causes. Its covariance with the load
     * is neglected: it matters only right after the first visit, when the two are still
     * independent. */
    double share = rung / variance;
    if (pixel > 0.0) {
        double cost = c * (1.0 + share * innovation / pixel);
        g->cost[s->rung] =
            masu_within(cost, g->prior[s->rung] / FAR, g->prior[s->rung] * FAR);
    }
    g->cost_variance[s->rung] *= 1.0 - share;
    follow_fixed(g, s, ms);
    g->fixed = masu_within(g->fixed, 0.0, ms);
    g->load = masu_within(g->load, 1e-6 * g->target, 1e9 * g->target);
}

/* Detects a clock that follows the load: a frame misses the target right after a rise, and the same
 * rung takes much less a few frames later. The load seldom falls just then. */
static void watch_clock(masu_governor *g, const masu_governor_sample *s, double ms) {
    if (s->rung != g->seen_rung) {
        g->seen_ms = s->rung < g->seen_rung && ms > g->target ? ms : 0.0;
        g->seen_frame = s->frame;
        g->seen_rung = s->rung;
    } else if (ms < RISE_FOLLOWS * g->seen_ms && s->frame - g->seen_frame <= MASU_GOVERNOR_TRIAL) {
        g->seen_ms = 0.0;
        if (!g->steady_clock) g->follows = 1;
    }
}

static int is_sound(const masu_governor *g) {
    double sum = g->fixed + g->load + g->slope + g->noise + g->trend + g->trust.overhead +
                 g->trust.distrust + g->grain;
    for (int i = 0; i < 3; i++) {
        if (!(g->p[i][i] >= 0.0)) return 0;
        for (int j = 0; j < 3; j++) sum += g->p[i][j];
    }
    return sum - sum == 0.0; /* finite */
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
    if (!(ms > 0.0) || !g->warm) { /* drivers may still compile in the first frame */
        g->warm = g->warm || ms > 0.0;
        g->rejected++;
        return;
    }
    watch_clock(g, s, ms);
    g->samples++;
    /* else the display reports late frames */
    if (g->pacing.refresh == 0.0) g->missed += ms > g->target;
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

/* ---- Predictions ----------------------------------------------------------------------------- */

/* Predicted time of a frame `lead` frames after the newest sample at a rung, plus `margin`
 * deviations. falls: extrapolate a falling load too; otherwise only a rising one. */
double masu_governor_upper(const masu_governor *g, uint32_t rung, double lead, int falls,
                           double margin) {
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

double masu_governor_lead(const masu_governor *g, uint64_t frame) {
    double lead = frame > g->newest ? (double)(frame - g->newest) : 0.0;
    return masu_within(lead, 0.0, (double)MASU_GOVERNOR_HOLD);
}
