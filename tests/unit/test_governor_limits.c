/* test_governor_limits.c: limits and factors of the governor, one sample on either side of each.
 * The state of the model is set directly, so that expected values follow from the equations of
 * docs/design/19-governor.md. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "quality/governor_state.h"

#define TARGET 16.67

static const masu_governor_rung ladder[] = {{1.0, 1.0}, {0.8, 0.64}, {0.4, 0.16}};

/* The newest sample is of frame 10, at rung 0. Nothing is uncertain except a sample, which has this
 * relative noise. */
static masu_governor certain(double fixed, double load, double noise) {
    masu_governor g;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, ladder, 3);
    for (uint64_t f = 0; f <= 10; f++) {
        masu_governor_pick(&g, f);
        masu_governor_sample_in(
            &g, &(masu_governor_sample){.frame = f, .gpu_ms = fixed + load + 1e-3 * (double)f});
    }
    g.fixed = fixed;
    g.load = load;
    g.slope = g.trend = 0.0;
    g.noise = noise;
    memset(g.p, 0, sizeof g.p);
    return g;
}

/* Adds a sample of the next frame; `wall`: the wall clock confirms it. */
static void add(masu_governor *g, uint32_t rung, double ms, int wall) {
    masu_governor_sample s = {.frame = g->last + 1, .rung = rung, .gpu_ms = ms};
    if (wall) s.wall_ms = 1.01 * ms;
    masu_governor_sample_in(g, &s);
}

/* The number of equal samples after which a load of 10 ms is replaced. */
static uint32_t samples_needed(double ms, int wall) {
    masu_governor g = certain(0.0, 10.0, 0.01);
    for (uint32_t n = 1; n < 200; n++) {
        add(&g, 0, ms, wall);
        if (g.jumped) return n;
    }
    return 0;
}

static void improbable_times_need_more_samples(void **state) {
    (void)state;
    assert_int_equal(samples_needed(39.0, 0), 2);
    assert_int_equal(samples_needed(41.0, 0), 3);
    assert_int_equal(samples_needed(41.0, 1), 2);
    assert_int_equal(samples_needed(2.6, 0), 2);
    assert_int_equal(samples_needed(2.4, 0), 8);
    assert_int_equal(samples_needed(1.01 * TARGET / 64.0, 0), 8);
    assert_int_equal(samples_needed(0.99 * TARGET / 64.0, 0), 90); /* a stopped timer */
    assert_int_equal(samples_needed(0.99 * TARGET * 64.0, 1), 2);
    assert_int_equal(samples_needed(1.01 * TARGET * 64.0, 1), 8); /* a pause */
}

static void outliers_must_agree(void **state) {
    (void)state;
    for (int far = 0; far < 2; far++) {
        masu_governor g = certain(0.0, 10.0, 0.01);
        add(&g, 0, 20.0, 0);
        add(&g, 0, far ? 31.0 : 29.0, 0);
        assert_int_equal(g.jumped, !far);
    }
}

/* Three deviations of the sample, and at least a fifth of the prediction. A sample of x times the
 * prediction has a deviation of noise * x. */
static void outliers_are_beyond_the_gate(void **state) {
    static const struct {
        double noise, ratio;
        uint32_t outliers;
    } cases[] = {{0.1, 1.40, 0}, {0.1, 1.46, 1}, {0.01, 1.18, 0}, {0.01, 1.22, 1}};
    (void)state;
    for (uint32_t i = 0; i < 4; i++) {
        masu_governor g = certain(0.0, 10.0, cases[i].noise);
        g.before_count = 0; /* the noise remains as set */
        add(&g, 0, 10.0 * cases[i].ratio, 0);
        assert_int_equal(g.odd_count, cases[i].outliers);
    }
}

/* Times of 1 + a and 1 - a alternately have second differences of 4 a. */
static void alternate(masu_governor *g, double a, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) add(g, 0, 10.0 * (1.0 + (i & 1 ? a : -a)), 0);
}

static void noise_follows_within_a_second(void **state) {
    (void)state;
    const double part = 4.0 * 1.2533 / 2.4495;
    masu_governor g = certain(0.0, 10.0, 0.02);
    alternate(&g, 1e-5, 400);
    assert_true(g.noise == 0.003);
    alternate(&g, 0.005, 400);
    double low = g.noise;
    assert_true(fabs(low / (0.005 * part) - 1.0) < 0.02);
    alternate(&g, 0.01, 64);
    double moved = (g.noise - low) / (0.005 * part);
    assert_true(fabs(moved - (1.0 - exp(-1.0))) < 0.03);
    alternate(&g, 0.55, 400);
    assert_true(g.noise == 0.5);
}

/* Before noise is measured, a sample and the load that it gives deviate by 2 % each. A rung is left
 * at 1.25 deviations of their sum, which deviates by 2.83 %. */
static void the_first_time_has_a_margin(void **state) {
    (void)state;
    for (int over = 0; over < 2; over++) {
        masu_governor g;
        masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, ladder, 3);
        double ms = TARGET / (1.0 + 1.25 * sqrt(2.0) * 0.02) + (over ? 0.05 : -0.05);
        masu_governor_pick(&g, 0);
        for (uint64_t f = 0; f < 2; f++) /* the first one is dropped */
            masu_governor_sample_in(&g, &(masu_governor_sample){.frame = f, .gpu_ms = ms});
        assert_int_equal(masu_governor_pick(&g, 1) > 0, over);
    }
}

/* With a noise of 0.3 %, a prior cost with a deviation of 0.5 % is corrected by 0.25 / 0.34 of
 * the difference. */
static void a_visit_corrects_the_cost(void **state) {
    (void)state;
    masu_governor g = certain(0.0, 10.0, 0.003);
    add(&g, 1, 6.4 * 1.02, 0);
    double moved = (g.cost[1] / 0.64 - 1.0) / 0.02, n = 0.003 * 1.02;
    double share = 0.005 * 0.005 / (0.005 * 0.005 + n * n);
    assert_true(fabs(moved - share) < 0.01);
}

/* 2 % of the target and 2.5 deviations of a sample. */
static void a_rise_leaves_headroom(void **state) {
    (void)state;
    for (int fits = 0; fits < 2; fits++) {
        double most = TARGET * 0.98 / (1.0 + 2.5 * 0.003);
        masu_governor g = certain(0.0, most * (fits ? 0.998 : 1.002), 0.003);
        g.cost_variance[0] = 0.0;
        masu_governor_settle_at_best(&g);
        assert_int_equal(g.rung, fits ? 0 : 1);
    }
}

/* A rise that changes the cost by less than a half, and does not reach the best rung: after two and
 * a half dwells of 24 frames. */
static void a_small_rise_waits(void **state) {
    static const double costs[][2] = {{0.64, 0.43}, {0.64, 0.42}};
    static const uint32_t waits[] = {60, 24};
    (void)state;
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t large = i / 2, late = i % 2;
        masu_governor g = certain(0.0, 20.0, 0.01);
        g.cost[1] = costs[large][0];
        g.cost[2] = costs[large][1];
        g.rung = 2;
        g.changed = 11;
        g.held_before = waits[large] - 1 + late;
        masu_governor_pick(&g, 11);
        assert_int_equal(g.rung, late ? 1 : 2);
        assert_int_equal(g.reason, late ? MASU_GOVERNOR_REASON_UP : MASU_GOVERNOR_REASON_WAIT);
    }
}

static void frames_without_samples(void **state) {
    (void)state;
    masu_governor g = certain(0.0, 10.0, 0.01), stale = g;
    assert_true(masu_governor_lead(&g, 10 + 8) == 8.0);
    assert_true(masu_governor_lead(&g, 10 + 9) == 8.0);
    assert_true(masu_governor_lead(&g, 10 + 7) == 7.0);
    masu_governor_pick(&g, 10 + 30);
    assert_int_not_equal(g.reason, MASU_GOVERNOR_REASON_STALE);
    masu_governor_pick(&stale, 10 + 31);
    assert_int_equal(stale.reason, MASU_GOVERNOR_REASON_STALE);
}

/* If more than half of the cheapest rung's time is fixed, all rungs are measured. */
static void a_survey_measures_all_rungs(void **state) {
    (void)state;
    for (int more = 0; more < 2; more++) {
        masu_governor g = certain(20.0 * (more ? 0.51 : 0.49), 1.0, 0.01);
        masu_survey_begin(&g.survey, 10, 2);
        for (uint64_t f = 0; f < 20; f++) masu_survey_sample(&g.survey, 10, 2, 20.0);
        g.rung = 2;
        masu_governor_pick(&g, 11);
        assert_int_equal(g.survey.any, more);
    }
}

/* A load that remains high for more than 16 frames after a fall is a new load, not a spike. */
static void spikes_are_short(void **state) {
    (void)state;
    masu_spikes s = {.calm = 10.0};
    masu_spikes_fell(&s, 100, 20.0);
    masu_spikes_follow(&s, 116, 20.0, 0);
    assert_true(s.open && s.calm == 10.0);
    masu_spikes_follow(&s, 117, 20.0, 0);
    assert_true(!s.open && s.calm == 20.0);
}

static void the_limits_of_a_state(void **state) {
    (void)state;
    masu_governor g = certain(0.0, 10.0, 0.01);
    masu_governor_state s;
    masu_detail detail;
    masu_governor_export_state(&g, (VkExtent2D){64, 64}, &s);
    s.patience = 64, s.trials = 6;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_OK);
    s.patience = 65;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "state.patience");
    s.patience = 64, s.trials = 7;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "state.trials");
    masu_governor_rung many[40];
    for (uint32_t r = 0; r < 40; r++) many[r] = (masu_governor_rung){1.0 - 0.02 * r, 0.0};
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, many, 40);
    assert_int_equal(g.count, 16);
}

/* A GPU time that is bit-identical across a change of rung is not a measurement, even if the wall
 * time is the same too. */
static void a_clock_that_ignores_the_rung_is_frozen(void **state) {
    (void)state;
    for (uint32_t rung = 0; rung < 2; rung++) {
        masu_trust t;
        int sure;
        masu_trust_start(&t);
        masu_governor_sample s = {.gpu_ms = 12.0, .wall_ms = 13.0};
        for (; s.frame < 8; s.frame++) masu_trust_time(&t, TARGET, &s, &sure);
        assert_int_equal(t.source, MASU_GOVERNOR_SOURCE_GPU);
        s.rung = rung;
        double overhead = t.overhead;
        for (; s.frame < 12; s.frame++) {
            assert_true(masu_trust_time(&t, TARGET, &s, &sure) == 13.0);
            assert_int_equal(t.source,
                             rung ? MASU_GOVERNOR_SOURCE_WALL : MASU_GOVERNOR_SOURCE_GPU);
        }
        assert_true(t.overhead == overhead);
        s.wall_ms = 0.0; /* without a wall clock there is no time */
        assert_true((masu_trust_time(&t, TARGET, &s, &sure) == 0.0) == (rung == 1));
        s.gpu_ms = 9.0; /* it counts again */
        assert_true(masu_trust_time(&t, TARGET, &s, &sure) > 9.0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(improbable_times_need_more_samples),
        cmocka_unit_test(outliers_must_agree),
        cmocka_unit_test(outliers_are_beyond_the_gate),
        cmocka_unit_test(noise_follows_within_a_second),
        cmocka_unit_test(the_first_time_has_a_margin),
        cmocka_unit_test(a_visit_corrects_the_cost),
        cmocka_unit_test(a_rise_leaves_headroom),
        cmocka_unit_test(a_small_rise_waits),
        cmocka_unit_test(frames_without_samples),
        cmocka_unit_test(a_survey_measures_all_rungs),
        cmocka_unit_test(spikes_are_short),
        cmocka_unit_test(the_limits_of_a_state),
        cmocka_unit_test(a_clock_that_ignores_the_rung_is_frozen),
    };
    return cmocka_run_group_tests_name("governor_limits", tests, NULL, NULL);
}
