/* survey.c: see survey.h. */
#include "quality/survey.h"

#include "quality/spikes.h"

#include <math.h>
#include <string.h>

#define KEPT 16u         /* minimum weight of a new time in the mean: 1 / KEPT */
#define FRESH 180u       /* frames; older times belong to another load */
#define RESOLUTION 0.017 /* relative standard error of a difference of means: a third of the gain */
#define ENOUGH_LEAST 6u
#define ENOUGH_MOST (2u * KEPT) /* more times do not improve the mean */
#define LONGER_LEAST 4u         /* fewest times that can show that a rung takes longer, */
#define LONGER_MARGIN 3.0       /* by this many standard errors */
#define SPREAD 3.0              /* standard errors by which a mean of few times may be too high */
#define WAIT_FIRST 60u          /* frames that an answer holds at least; doubles up to the most */
#define WAIT_MOST (64u * WAIT_FIRST)
#define CHECK 60u            /* times `wait`: then it is measured again in any case */
#define UNDONE_COUNT 4u      /* times of the rung below that decide whether a rise has failed: */
/* they differ by less than MASU_SURVEY_GAIN, plus the noise, from those before the rise */
#define FAILURES 2u          /* failed rises in a row that make a barrier */
#define BARRIER_FRAMES 3600u /* these end the barrier */

void masu_survey_forget(masu_survey *s) {
    memset(s->count, 0, sizeof s->count);
    s->active = 0;
}

void masu_survey_sample(masu_survey *s, uint64_t frame, uint32_t rung, double ms) {
    if (rung >= MASU_SURVEY_RUNGS) return;
    if (frame - s->last[rung] > FRESH) s->count[rung] = 0;
    uint32_t n = ++s->count[rung] < KEPT ? s->count[rung] : KEPT;
    s->mean[rung] = n > 1 ? s->mean[rung] + (ms - s->mean[rung]) / n : ms;
    s->last[rung] = frame;
}

void masu_survey_begin(masu_survey *s, uint64_t frame, uint32_t cheapest) {
    for (uint32_t r = 0; r < MASU_SURVEY_RUNGS; r++) {
        if (frame > s->last[r] && frame - s->last[r] > FRESH) s->count[r] = 0;
    }
    s->active = 1;
    s->found = 0;
    s->low = s->cheapest = cheapest;
    s->high = 0;
    s->any = 0;
}

uint32_t masu_survey_enough(double noise) {
    double n = 2.0 * noise * noise / (RESOLUTION * RESOLUTION);
    return n < ENOUGH_LEAST ? ENOUGH_LEAST : n < ENOUGH_MOST ? (uint32_t)n + 1 : ENOUGH_MOST;
}

masu_survey_verdict masu_survey_compare(const masu_survey *s, uint32_t rung, double noise) {
    uint32_t n = s->count[rung], enough = masu_survey_enough(noise);
    if (s->count[s->cheapest] < enough) return MASU_SURVEY_UNKNOWN;
    double over = s->mean[rung] - MASU_SURVEY_GAIN * s->mean[s->cheapest];
    if (n >= enough) return over > 0.0 ? MASU_SURVEY_LONGER : MASU_SURVEY_SAME;
    if (n >= LONGER_LEAST && over * sqrt(n) > LONGER_MARGIN * noise * s->mean[rung])
        return MASU_SURVEY_LONGER;
    return MASU_SURVEY_UNKNOWN;
}

int masu_survey_may_be_same(const masu_survey *s, uint32_t rung, uint32_t other, double noise) {
    if (!s->count[rung] || !s->count[other] || s->last[rung] + FRESH < s->last[other]) return 0;
    double spread = SPREAD * noise / sqrt(s->count[rung]);
    return s->mean[rung] * (1.0 - spread) <= MASU_SURVEY_GAIN * s->mean[other];
}

void masu_survey_answer(masu_survey *s, uint64_t frame) {
    s->wait = s->wait && s->low == s->answer && s->wait < WAIT_MOST ? 2 * s->wait : WAIT_FIRST;
    s->answer = s->low;
    s->answered = frame;
    s->active = 0;
    s->found = 1;
    s->ms = s->mean[s->low];
    s->near = frame;
}

int masu_survey_holds(masu_survey *s, uint64_t frame, uint32_t rung, double ms) {
    if (!s->found) return 0;
    if (ms < MASU_SURVEY_RANGE * s->ms && s->ms < MASU_SURVEY_RANGE * ms) s->near = frame;
    uint64_t since = frame - s->answered;
    int is_old = since > (uint64_t)CHECK * s->wait ||
                 (frame - s->near > MASU_SPIKE_FRAMES && since > s->wait);
    if (rung != s->low || is_old) s->found = 0;
    return s->found;
}

void masu_survey_rise(masu_survey *s, uint32_t from, uint32_t to) {
    s->before = s->count[from] >= UNDONE_COUNT ? s->mean[from] : 0.0;
    s->below = from;
    s->tried = to;
    s->undone = 0;
}

void masu_survey_undo(masu_survey *s, uint32_t to) {
    s->undone = s->before > 0.0 && to == s->below;
    if (s->undone) s->count[to] = 0;
}

uint32_t masu_survey_barrier(masu_survey *s, uint64_t frame, double ms, double noise) {
    double range = MASU_SURVEY_GAIN + noise;
    if (s->undone && s->count[s->below] >= UNDONE_COUNT) {
        int same = s->mean[s->below] < range * s->before && s->before < range * s->mean[s->below];
        s->undone = 0;
        s->failures = same ? s->failures + 1 : 0;
        if (s->failures >= FAILURES) {
            if (s->barrier <= s->tried) s->barrier = s->tried + 1;
            s->barrier_ms = s->before;
            s->barrier_near = s->barrier_made = frame;
        }
    }
    if (ms < MASU_SURVEY_RANGE * s->barrier_ms && s->barrier_ms < MASU_SURVEY_RANGE * ms)
        s->barrier_near = frame;
    int is_old = frame - s->barrier_near > MASU_SPIKE_FRAMES ||
                 frame - s->barrier_made > BARRIER_FRAMES;
    if (s->barrier && is_old) s->barrier = s->failures = 0;
    return s->barrier;
}
