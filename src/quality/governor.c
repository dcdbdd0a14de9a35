/* governor.c: the rules that select a rung. See governor.h. governor_model.c has the model of frame
 * times that they use. */
#include "quality/governor.h"

#include "quality/governor_desc.h"
#include "shared/floats.h"

#include <math.h>
#include <string.h>

/* ---- Constants: times in frames, or ratios ------------------------------------------- */

/* Deviations: margin for keeping a rung. Half of that for selecting one: noise between the two
 * changes nothing. */
#define MARGIN_KEEP (0.5 * MASU_GOVERNOR_MARGIN)
/* Frames without a sample: half a second at 60 Hz. The longest delay of samples is a few frames. */
#define STALE_FRAMES 30u
/* Cost ratio: a rise by less than this waits for a larger one, because each change is visible, */
#define STEP_UP 1.5
#define STEP_WAIT 2.5 /* for this many dwells: two would follow waves of the load of a second. */
/* Dwells at a steady load until a rung is settled. Above STEP_WAIT, or no small rise would
 * happen. */
#define SETTLE_WAIT 4u
/* Ratio: a load or time that differs by more than this factor is another one. About the step
 * between two rungs of a built-in ladder. */
#define OTHER 1.25
/* A clock that follows its load makes a cheap rung as slow as a better one. Trials detect
 * it. Fraction of the target: trials only below this time, as such clocks keep 90 % busy. */
#define TRIAL_BUSY 0.92
/* Frames of steady load before the first trial: 30 s at 60 Hz, as a trial costs missed frames. */
#define TRIAL_WAIT 1800u
/* Factor on the predicted time: a shorter time shows that the clock has followed. Outside the 2 to
 * 3 % by which a correct prediction errs. */
#define TRIAL_FOLLOWS 0.96
/* Fraction of the cheapest rung's time: if more is fixed, costs no longer predict the other rungs,
 * and a survey measures all of them. */
#define SURVEY_FIXED 0.5

/* ---- Init ------------------------------------------------------------------------------------ */

/* Applies the fields that may change later. Fields out of range are treated as 0. */
static void apply_desc(masu_governor *g, const masu_governor_desc *desc) {
    g->mode = desc->mode;
    g->asked = desc->target_ms >= 1.0f && desc->target_ms <= 1000.0f ? (double)desc->target_ms
                                                                     : MASU_GOVERNOR_TARGET_MS;
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
        g->penalty[r] = 1.0;
    }
    masu_governor_model_init(g);
    g->steady_clock = desc->steady_clock != 0;
    g->patience = 1;
    g->settled_load = -1.0;
    g->rung = g->mode == MASU_GOVERNOR_FIXED ? g->fixed_rung : g->best;
    g->reason = g->mode == MASU_GOVERNOR_FIXED ? MASU_GOVERNOR_REASON_FIXED
                : g->mode == MASU_GOVERNOR_ON  ? MASU_GOVERNOR_REASON_START
                                               : MASU_GOVERNOR_REASON_NONE;
}

/* ---- Rules ----------------------------------------------------------------------------------- */

/* The best rung below the present one that keeps the target for a dwell, at the present slope; the
 * worst rung if none does. */
static uint32_t fall(const masu_governor *g, double lead, int *fits) {
    double last = lead + (g->follows ? 0.0 : (double)g->dwell);
    *fits = 1;
    for (uint32_t r = g->best; r <= g->worst; r++) {
        if (g->cost[r] < g->cost[g->rung] &&
            masu_governor_upper(g, r, last, 0, MASU_GOVERNOR_MARGIN) <= g->target)
            return r;
    }
    *fits = 0;
    return g->worst;
}

/* Whether a rung keeps the target at this load. */
static int fits_load(const masu_governor *g, uint32_t rung, double load) {
    return (g->fixed + g->cost[rung] * load) * (1.0 + MASU_GOVERNOR_MARGIN * g->noise) <= g->target;
}

/* The best rung that keeps the target with headroom, now and for a dwell; else the present one. */
static uint32_t rise(masu_governor *g, uint64_t frame, double lead) {
    uint32_t barrier =
        masu_survey_barrier(&g->survey, frame, masu_governor_predict(g, g->survey.below), g->noise);
    double most = g->target * (1.0 - g->headroom), peak = masu_spikes_peak(&g->spikes);
    if (peak > 0.0 && !fits_load(g, g->worst, peak)) peak = 0.0; /* no rung keeps the target then */
    for (uint32_t r = barrier > g->best ? barrier : g->best; r < g->rung; r++) {
        if (peak > 0.0 && !fits_load(g, r, peak)) continue;
        double now = masu_governor_upper(g, r, lead, 1, MASU_GOVERNOR_MARGIN),
               then = masu_governor_upper(g, r, lead + g->dwell, 0, MASU_GOVERNOR_MARGIN);
        if (masu_largest(now, then) * g->penalty[r] <= most) return r;
    }
    return g->rung;
}

static void change(masu_governor *g, uint64_t frame, uint32_t rung, masu_governor_reason reason) {
    if (rung == g->rung) return;
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
    masu_survey_rise(&g->survey, g->rung, rung);
    g->survey.left = 0;
    change(g, frame, rung, reason);
    g->rising = 1;
}

static int is_near(double a, double b) { return a < OTHER * b && b < OTHER * a; }

/* Whether a rise now would repeat one that was undone, with only noise in between. If so, the time
 * measured at that rung is a penalty for the rung and all better ones, and the wait before the next
 * rise doubles. */
static int repeats_a_mistake(masu_governor *g) {
    if (!g->failed || !is_near(g->load_low, g->raised_load) ||
        !is_near(g->load_high, g->raised_load))
        return 0;
    double penalty = masu_within(g->failed_ms / g->raised_ms, 1.0, MASU_SURVEY_RANGE);
    for (uint32_t r = g->best; r <= g->raised_rung; r++)
        g->penalty[r] = masu_largest(g->penalty[r], penalty);
    g->mistake_load = g->load;
    if (g->patience < 1u << MASU_GOVERNOR_DOUBLINGS) g->patience *= 2;
    g->failed = 0;
    return 1;
}

void masu_governor_forget_mistakes(masu_governor *g) {
    for (uint32_t r = 0; r < g->count; r++) g->penalty[r] = 1.0;
    g->patience = 1;
    g->failed = 0;
}

/* ---- The survey ------------------------------------------------------------------------------ */

/* The next rung to measure, or `low` if there is none: `low` is the result then. */
static uint32_t next_to_measure(masu_governor *g) {
    masu_survey *s = &g->survey;
    double least = s->mean[s->cheapest];
    if (g->fixed > SURVEY_FIXED * least) s->any = 1;
    uint32_t from = s->high > g->best ? s->high : g->best;
    for (uint32_t r = from; r < s->low; r++) {
        if (masu_governor_predict(g, r) <= (s->any ? OTHER : MASU_SURVEY_GAIN) * least ||
            masu_survey_may_be_same(s, r, s->cheapest, g->noise))
            return r;
    }
    return s->low > from && s->any ? s->low - 1 : s->low;
}

/* One step of an active survey. Returns 0 if none is active. */
static int survey(masu_governor *g, uint64_t frame) {
    masu_survey *s = &g->survey;
    if (!s->active) return 0;
    uint32_t r = g->rung;
    if (s->count[s->cheapest] < masu_survey_enough(g->noise)) {
        r = s->cheapest;
    } else {
        for (uint32_t k = 0; k < g->count; k++) {
            masu_survey_verdict v =
                r < s->low ? masu_survey_compare(s, r, g->noise) : MASU_SURVEY_SAME;
            if (v == MASU_SURVEY_UNKNOWN) break;
            if (v == MASU_SURVEY_SAME && r < s->low) s->low = r;
            if (v == MASU_SURVEY_LONGER) s->high = r + 1;
            r = next_to_measure(g);
            if (r == s->low) {
                masu_survey_answer(s, frame);
                break;
            }
        }
    }
    g->rising = 0;
    change(g, frame, r, MASU_GOVERNOR_REASON_NO_GAIN);
    g->reason = MASU_GOVERNOR_REASON_NO_GAIN;
    return 1;
}

/* ---- Trials of clocks that follow the load --------------------------------------------------- */

/* Ends a trial. The rung is kept if its time is within the target, for whatever reason. */
static void end_trial(masu_governor *g, uint64_t frame, int over) {
    g->trial = 0;
    g->trial_load = g->load;
    g->trial_ended = frame;
    if (!over && masu_governor_predict(g, g->rung) < TRIAL_FOLLOWS * g->trial_ms) {
        g->follows = 1;
        g->trials = 0;
        return;
    }
    if (g->trials < MASU_GOVERNOR_DOUBLINGS) g->trials++;
    g->follows = 0;
    if (!over) return;
    change(g, frame, g->trial_from, MASU_GOVERNOR_REASON_DOWN);
    g->rising = 0;
}

/* If no better rung fits but there is headroom, starts a trial when one is due. */
static void try_clock(masu_governor *g, uint64_t frame, uint64_t still) {
    uint32_t r = g->rung - 1;
    if (g->rung <= g->best || g->steady_clock || g->odd_count || masu_governor_moves(g) > 0.0 ||
        g->noise > MASU_SURVEY_GAIN - 1.0)
        return;
    if (!g->follows && g->settled_load < 0.0) return;
    while (r > g->best && g->cost[r] < MASU_SURVEY_GAIN * g->cost[g->rung]) r--;
    if (masu_governor_predict(g, g->rung) > TRIAL_BUSY * g->target ||
        masu_governor_predict(g, r) > OTHER * g->target)
        return;
    /* At another load the clock may have headroom again. */
    if (g->follows && !is_near(g->load, g->trial_load)) g->trials = 0;
    uint64_t wait = g->follows ? g->dwell : TRIAL_WAIT;
    if (still < wait || (g->trials && frame - g->trial_ended < wait << g->trials)) return;
    g->trial_from = g->rung;
    g->trial_ms = masu_governor_predict(g, r);
    g->rising = 0;
    change(g, frame, r, MASU_GOVERNOR_REASON_TRIAL);
}

/* The rung is predicted to miss the target, or has missed it: falls if a cheaper rung helps. */
static void leave(masu_governor *g, uint64_t frame, double lead, masu_governor_reason why,
                  int may_rise) {
    int fits, enough = g->survey.count[g->rung] >= masu_survey_enough(g->noise);
    int holds = masu_survey_holds(&g->survey, frame, g->rung, masu_governor_predict(g, g->rung));
    uint32_t r = fall(g, lead, &fits);
    g->misses = 0;
    g->urged = 0;
    if (holds && g->rung < g->worst) {
        g->reason = MASU_GOVERNOR_REASON_NO_GAIN;
        return;
    }
    if (r == g->rung || (r < g->rung && !may_rise)) {
        g->reason = MASU_GOVERNOR_REASON_WORST;
        if (!fits && !holds && enough && frame - g->restless >= MASU_SPIKE_FRAMES) {
            masu_survey_begin(&g->survey, frame, g->worst);
            survey(g, frame);
        }
        return;
    }
    if (masu_spikes_now(&g->spikes, frame, g->load) && !fits_load(g, g->worst, g->spikes.peak)) {
        g->reason = MASU_GOVERNOR_REASON_HOLD;
        return;
    }
    if (r < g->rung) { /* the lower quality has gained nothing: returns to the better rung */
        raise_to(g, frame, r, why);
        return;
    }
    /* A jump right after a rise: the cost of the rung is wrong, not the load. */
    uint32_t below = g->survey.below;
    if (g->rising && frame - g->changed <= MASU_GOVERNOR_TRIAL &&
        why == MASU_GOVERNOR_REASON_JUMP && below > g->rung && below <= g->worst)
        r = below;
    masu_survey_undo(&g->survey, r);
    int rested = (!g->changes || frame - g->restless > MASU_SPIKE_FRAMES) &&
                 fabs(g->slope) * g->dwell < (MASU_SURVEY_GAIN - 1.0) * g->load;
    if (!g->survey.left && rested) g->survey.left = g->rung + 1;
    g->failed = g->rising && g->rung == g->raised_rung;
    g->failed_ms = masu_governor_predict(g, g->rung);
    g->rising = 0;
    masu_spikes_fell(&g->spikes, frame, g->load);
    change(g, frame, r, why);
}

/* After a fall at a steady load, if the rung takes as long as the better one did: measures the
 * better one again. */
static int fell_in_vain(masu_governor *g, uint64_t frame, uint64_t still) {
    masu_survey *s = &g->survey;
    if (!s->left || still < MASU_SPIKE_FRAMES || s->count[g->rung] < masu_survey_enough(g->noise))
        return 0;
    uint32_t left = s->left - 1;
    s->left = 0;
    if (left >= g->rung || left < g->best || !masu_survey_may_be_same(s, left, g->rung, g->noise))
        return 0;
    masu_survey_begin(s, frame, g->rung);
    s->count[left] = 0;
    change(g, frame, left, MASU_GOVERNOR_REASON_NO_GAIN);
    return 1;
}

static void choose(masu_governor *g, uint64_t frame) {
    double lead = masu_governor_lead(g, frame), keep = MARGIN_KEEP;
    if (g->slope > 0.0 && !g->follows) keep *= 1.0 + masu_governor_moves(g);
    if (g->jumped || masu_governor_moves(g) > 0.5) g->restless = frame;
    if (g->load < g->load_low) g->load_low = g->load;
    if (g->load > g->load_high) g->load_high = g->load;
    if (g->jumped || !is_near(g->load, g->mistake_load)) {
        if (g->patience > 1) masu_governor_forget_mistakes(g);
    }
    uint64_t held = frame - g->changed + g->held_before;
    uint64_t dwell = g->dwell > MASU_GOVERNOR_HOLD ? g->dwell : MASU_GOVERNOR_HOLD;
    dwell *= g->patience;
    int over = masu_governor_upper(g, g->rung, lead, 1, keep) > g->target, urgent = g->misses >= 2;
    masu_governor_reason why = g->jumped ? MASU_GOVERNOR_REASON_JUMP
                               : over    ? MASU_GOVERNOR_REASON_DOWN
                                         : MASU_GOVERNOR_REASON_EMERGENCY;
    g->jumped = 0;
    double peak_before = masu_spikes_peak(&g->spikes);
    masu_spikes_follow(&g->spikes, frame, g->load, over);
    double peak = masu_spikes_peak(&g->spikes);
    if (peak_before > 0.0 && peak == 0.0) { /* the rung was kept for spikes and has not settled */
        g->settled_load = -1.0;
        g->restless = frame;
        g->survey.barrier = g->survey.failures = 0;
    }
    if (peak > 0.0 && g->load < OTHER * peak && fits_load(g, g->rung, peak))
        over = urgent = 0;
    masu_survey_holds(&g->survey, frame, g->rung, masu_governor_predict(g, g->rung));
    if (survey(g, frame)) return;
    if (g->trial) {
        if (held < MASU_GOVERNOR_TRIAL &&
            masu_governor_predict(g, g->rung) < OTHER * g->target)
            return;
        end_trial(g, frame, over);
        if (over) return;
    }
    if (over || urgent) {
        leave(g, frame, lead, why, held >= dwell);
        return;
    }
    uint64_t still = frame - (g->restless > g->changed ? g->restless : g->changed);
    if (fell_in_vain(g, frame, still)) return;
    if (g->settled_load < 0.0 && still >= SETTLE_WAIT * dwell) g->settled_load = g->load;
    uint32_t r = g->odd_count ? g->rung : rise(g, frame, lead);
    if (r == g->rung) {
        if (!g->odd_count) g->urged = 0;
        g->reason = r == g->best ? MASU_GOVERNOR_REASON_BEST : MASU_GOVERNOR_REASON_HOLD;
        try_clock(g, frame, still);
        return;
    }
    if (g->urged && (held >= MASU_GOVERNOR_HOLD || g->urged > 1)) {
        g->urged = 0;
        g->rising = 0; /* the result is no failed rise at this load */
        change(g, frame, r, MASU_GOVERNOR_REASON_UP);
        return;
    }
    int worth = g->cost[r] >= STEP_UP * g->cost[g->rung] || r == g->best;
    if (held < dwell || (!worth && (double)held < STEP_WAIT * (double)dwell) ||
        (g->settled_load >= 0.0 && g->load * MASU_SURVEY_GAIN > g->settled_load) ||
        repeats_a_mistake(g)) {
        g->reason = MASU_GOVERNOR_REASON_WAIT;
        return;
    }
    raise_to(g, frame, r, MASU_GOVERNOR_REASON_UP);
}

/* Whether this frame is requested for the first time. */
static int begin(masu_governor *g, uint64_t frame) {
    if (g->started && frame <= g->frame) return 0;
    if (!g->started) g->changed = frame;
    g->started = 1;
    g->frame = frame;
    g->target = masu_pacing_target(&g->pacing, g->asked);
    return 1;
}

static void pace(masu_governor *g, uint64_t frame, int excluded) {
    double ms = g->known
                    ? masu_governor_upper(g, g->rung, masu_governor_lead(g, frame), 1, MARGIN_KEEP)
                    : 0.0;
    masu_pacing_choose(&g->pacing, frame, masu_largest(ms, g->trust.cpu), g->target, excluded);
}

/* Applies changes of mode and range by the host. */
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
        /* The range applies to the governor's choices: they are clamped to it. */
        rung = rung < g->best ? g->best : rung > g->worst ? g->worst : rung;
        g->survey.active = 0;
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

/* ---- Settings -------------------------------------------------------------------------------- */

void masu_governor_adjust(masu_governor *g, const masu_governor_desc *desc) {
    masu_governor old = *g;
    apply_desc(g, desc);
    if (old.mode != g->mode && g->mode == MASU_GOVERNOR_ON)
        g->reason = g->known ? MASU_GOVERNOR_REASON_HOLD : MASU_GOVERNOR_REASON_START;
    if (old.asked == g->asked && old.headroom == g->headroom && old.best == g->best &&
        old.worst == g->worst && old.mode == g->mode)
        return;
    /* The settled load and the failed rises refer to the old target. */
    masu_governor_forget_mistakes(g);
    memset(&g->survey, 0, sizeof g->survey);
    g->settled_load = -1.0;
    g->misses = 0;
    g->urged = 1;
}

void masu_governor_settle_at_best(masu_governor *g) {
    g->rung = g->worst;
    g->rung = rise(g, 0, 0.0);
}
