/* test_governor.c: the governor on simulated GPUs (tests/support/simulated_gpu.h): its guarantees
 * on each of them, invalid samples, its modes. The results are numbers of frames and of changes,
 * not times. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "quality/governor_state.h"
#include "support/simulated_gpu.h"
#include "support/random.h"

#define SEEDS 20u
#define SETTLED SIM_SETTLED

static const sim_controller *const ours = &sim_masu;

static const sim_model *named(const char *name) {
    const sim_model *p = sim_find(name);
    if (!p) fail_msg("there is no model '%s'", name);
    return p;
}

/* ---- The standard model
 * ------------------------------------------------------------------------ */

static void it_keeps_the_bar_on_the_standard_model(void **state) {
    (void)state;
    double over, changes;
    sim_result r = sim_mean(named("standard"), ours, SEEDS, &over, &changes);
    if (over > 15.0 || changes > 32.0 || r.mean_scale < 0.68) {
        fail_msg("%.1f frames over the budget, %.1f changes, mean scale %.4f", over, changes,
                 r.mean_scale);
    }
    /* close to the upper bound for any controller */
    assert_true(sim_oracle(named("standard")) < 0.73);
}

/* ---- No limit cycles
 * --------------------------------------------------------------------------- */

/* 500 loads, from one that the best rung carries to one that no rung carries. If costs differ from
 * the governor's initial ones, it may try a rung and discover that: at most once after ten
 * seconds. */
static void it_settles_under_every_constant_load(void **state) {
    static const double exponents[] = {2.0, 1.4, 3.0};
    (void)state;
    for (uint32_t i = 0; i < 500; i++) {
        for (uint32_t e = 0; e < 3; e++) {
            sim_model p = {"constant",
                       "",
                       .frames = 1200,
                       .a = 1.0 + 0.2 * i,
                       .exponent = exponents[e],
                       .event = e ? 600 - SETTLED : 0,
                       .rungs = i % 5 ? 16 : 3};
            sim_result r = sim_run(&p, ours, i + 1, NULL, NULL);
            if (r.late_changes > (e ? 1 : 0)) {
                fail_msg("load %.1f, cost s^%.1f: %u changes after frame %u", p.a, exponents[e],
                         r.late_changes, p.event + SETTLED);
            }
        }
    }
}

static void it_changes_seldom_under_noise(void **state) {
    (void)state;
    for (uint32_t seed = 1; seed <= 40; seed++) {
        for (uint32_t i = 0; i < 3; i++) {
            sim_model p = {"noise", "", .frames = 1500, .a = 10.0 + 2.0 * seed,
                       .noise = (const double[]){0.10, 0.20, 0.30}[i]};
            sim_result r = sim_run(&p, ours, seed, NULL, NULL);
            uint32_t most = i ? 12 : 2;
            if (r.late_changes > most || (p.a < 70.0 && r.over > 4 + p.frames / 50)) {
                fail_msg("noise %.2f, load %.0f: %u changes after frame %u, %u frames over",
                         p.noise, p.a, r.late_changes, SETTLED, r.over);
            }
        }
    }
}

/* ---- Steps
 * ------------------------------------------------------------------------------------- */

static void it_settles_soon_after_a_step(void **state) {
    static const struct {
        const char *model;
        int32_t most;
    } steps[] = {
        {"standard", 12},    {"step_4x", 12},      {"step_1.8x", 10},     {"missing_5", 15},
        {"missing_50", 15},  {"latency_1", 12},    {"latency_2", 12},     {"wall_only", 12},
        {"lies_low", 12},    {"lies_frozen", 12},  {"unit_us", 12},       {"unit_ns", 12},
        {"unit_s", 12},      {"prior_flat", 12},   {"fixed_heavy", 20},   {"three_rungs", 12},
        {"clock_flips", 12}, {"garbage", 12},      {"garbage_blind", 12}, {"pause", 12},
        {"quantised", 12},   {"lies_lavapipe", 12}};
    (void)state;
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        for (uint32_t seed = 1; seed <= 2 * SEEDS; seed++) {
            sim_result r = sim_run(named(steps[i].model), ours, seed, NULL, NULL);
            if (r.settle < 0 || r.settle > steps[i].most) {
                fail_msg("%s, seed %u: settles after %d frames, not within %d", steps[i].model,
                         seed, r.settle, steps[i].most);
            }
        }
    }
}

/* A fall overshoots the rung that is kept in the end by one at most. */
static void it_does_not_overshoot(void **state) {
    (void)state;
    const sim_model *p = named("step_1.8x");
    for (uint32_t seed = 1; seed <= 2 * SEEDS; seed++) {
        sim_frame frames[SIM_FRAMES_MOST];
        sim_run(p, ours, seed, frames, NULL);
        uint32_t lowest = 0, last = frames[p->frames - 1].rung;
        for (uint32_t f = p->event; f < p->frames; f++)
            if (frames[f].rung > lowest) lowest = frames[f].rung;
        if (lowest > last + 1) fail_msg("seed %u: falls to rung %u, keeps %u", seed, lowest, last);
    }
}

/* 95 % of the possible scale within 90 frames of a drop of the load, and the first rise within 40,
 * however long the load was too high: nothing winds up. */
static void it_comes_back(void **state) {
    static const char *const models[] = {"step_down", "overload"};
    (void)state;
    for (uint32_t i = 0; i < 2; i++) {
        const sim_model *p = named(models[i]);
        sim_model low = *p;
        low.frames = 400;
        low.load = NULL;
        low.a = p->b;
        double ideal = sim_oracle(&low);
        for (uint32_t seed = 1; seed <= SEEDS; seed++) {
            sim_frame frames[SIM_FRAMES_MOST];
            sim_run(p, ours, seed, frames, NULL);
            uint32_t first = 0, full = 0;
            for (uint32_t f = p->event; f < p->frames; f++) {
                if (!first && frames[f].rung < frames[f - 1].rung) first = f - p->event;
                if (!full && frames[f].scale >= 0.95 * ideal) full = f - p->event;
            }
            if (!first || first > 40 || !full || full > 90) {
                fail_msg("%s, seed %u: first rise after %u, 95 %% of %.2f after %u", p->name, seed,
                         first, ideal, full);
            }
        }
    }
}

/* ---- Wrong timestamps ------------------------------------------------------------------------ */

/* Wrong for 60 frames at a constant load: at most one rung down, at most 5 % of the frames over the
 * budget. */
static void it_is_not_moved_by_lies(void **state) {
    static const sim_lie lies[] = {SIM_TENTH,    SIM_LAVAPIPE, SIM_FROZEN, SIM_ZERO,
                                     SIM_NEGATIVE, SIM_HUGE,     SIM_NAN,    SIM_MICRO,
                                     SIM_NANO,     SIM_SECONDS,  SIM_GARBAGE};
    (void)state;
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        for (uint32_t seed = 1; seed <= SEEDS; seed++) {
            for (uint32_t wall = lies[i] == SIM_GARBAGE; wall < 2; wall++) {
                sim_frame frames[SIM_FRAMES_MOST];
                sim_model p = {"lies",           "",
                           .frames = 700,    .a = 20.0 + seed,
                           .lie = lies[i],   .lie_from = 300,
                           .lie_until = 360, .wall = wall};
                sim_run(&p, ours, seed, frames, NULL);
                uint32_t low = 99, high = 0, over = 0;
                for (uint32_t f = 299; f < 460; f++) {
                    if (frames[f].rung < low) low = frames[f].rung;
                    if (frames[f].rung > high) high = frames[f].rung;
                    over += frames[f].ms > SIM_BUDGET;
                }
                if (high - low > 1 || over > 8) {
                    fail_msg("timestamps %d, seed %u, wall %u: rungs %u to %u, %u frames over",
                             (int)lies[i], seed, wall, low, high, over);
                }
            }
        }
    }
}

static void spikes_change_nothing(void **state) {
    (void)state;
    uint32_t changes = 0, pairs = 0;
    for (uint32_t seed = 1; seed <= 2 * SEEDS; seed++) {
        sim_model p = *named("spikes");
        p.a = 20.0 + seed;
        sim_frame frames[SIM_FRAMES_MOST];
        sim_result r = sim_run(&p, ours, seed, frames, NULL);
        for (uint32_t f = 20; f < p.frames; f++) /* two in a row look like a step */
            pairs += frames[f].ms > 2.0 * SIM_BUDGET && frames[f - 1].ms > 2.0 * SIM_BUDGET;
        changes += r.late_changes;
    }
    if (changes > 2 * pairs) fail_msg("%u changes for %u pairs of spikes", changes, pairs);
    assert_true(pairs < 2 * SEEDS);
}

/* Timestamps that the wall clock contradicts: detected permanently, and reported. */
static void it_reports_what_it_trusts(void **state) {
    static const struct {
        const char *model;
        masu_governor_source source;
        float unit;
    } cases[] = {{"constant", MASU_GOVERNOR_SOURCE_GPU, 1.0f},
                 {"wall_only", MASU_GOVERNOR_SOURCE_WALL, 1.0f},
                 {"lies_lavapipe", MASU_GOVERNOR_SOURCE_WALL, 1.0f},
                 {"unit_us", MASU_GOVERNOR_SOURCE_GPU, 1e-3f},
                 {"unit_ns", MASU_GOVERNOR_SOURCE_GPU, 1e-6f},
                 {"unit_s", MASU_GOVERNOR_SOURCE_GPU, 1e3f}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sim_state s;
        masu_governor_info info;
        sim_run(named(cases[i].model), ours, 1, NULL, &s);
        masu_governor_report(&s.governor, &info);
        if (info.source != cases[i].source || fabsf(info.unit / cases[i].unit - 1.0f) > 1e-6f) {
            fail_msg("%s: source %d, unit %g", cases[i].model, (int)info.source, (double)info.unit);
        }
    }
}

/* The estimates of the model's parts, where the simulation has them exactly. */
static void it_finds_the_fixed_part(void **state) {
    (void)state;
    for (uint32_t seed = 1; seed <= SEEDS; seed++) {
        sim_state s;
        sim_run(named("step_4x"), ours, seed, NULL, &s);
        masu_governor_info info;
        masu_governor_report(&s.governor, &info);
        for (uint32_t r = 8; r < SIM_RUNGS; r++) { /* from 0.61 down: rungs that it has used */
            double truth = 2.0 + 40.0 * pow(0.4, r / 7.5);
            double error = masu_governor_predict(&s.governor, r) / truth - 1.0;
            if (fabs(error) > 0.1) fail_msg("seed %u, rung %u: error %.3f", seed, r, error);
        }
        assert_true(info.noise > 0.008f && info.noise < 0.016f); /* 0.04 / sqrt(12) */
        assert_true(info.start_delay_ms >= 0.0f && info.start_delay_ms < 4.0f);
    }
}

/* ---- Arbitrary input ------------------------------------------------------------------------- */

static double any_time(uint64_t *random) {
    static const double values[] = {
        0.0, -1.0, 1e-300, 1e300, 1e4, 10000.1, 16.67, 0.1, 18446744073709551615.0};
    uint64_t bits = support_random(random);
    double out;
    switch (support_random_in(random, 0, 5)) {
    case 0: memcpy(&out, &bits, sizeof out); return out;
    case 1: return values[bits % (sizeof values / sizeof *values)];
    case 2: return bits & 1 ? (double)INFINITY : (double)NAN;
    case 3: return (double)(bits % 1000) * 0.05;
    default: return 10.0 + (double)(bits % 1000) * 0.01;
    }
}

static void it_stays_sound_under_a_million_samples(void **state) {
    (void)state;
    masu_governor g;
    masu_governor_rung ladder[SIM_RUNGS];
    uint64_t random = 3, frame = 0;
    for (uint32_t i = 0; i < 1000000; i++) {
        if (i % 5000 == 0) {
            uint32_t n = (uint32_t)support_random_in(&random, 1, 16);
            for (uint32_t r = 0; r < n; r++) {
                ladder[r].scale = i % 3 ? 1.0 - 0.05 * r : any_time(&random);
                ladder[r].cost = i % 2 ? 0.0 : any_time(&random);
            }
            masu_governor_desc d = {.mode = MASU_GOVERNOR_ON,
                                    .target_ms = (float)any_time(&random),
                                    .headroom = (float)any_time(&random),
                                    .best_rung = (uint32_t)support_random_in(&random, 0, 3),
                                    .worst_rung = (uint32_t)support_random_in(&random, 0, 20),
                                    .dwell = (uint32_t)support_random_in(&random, 0, 700)};
            masu_governor_init(&g, &d, ladder, n);
            frame = 0;
        }
        masu_governor_sample s = {.frame = frame + support_random_in(&random, 0, 5) - 3,
                                  .rung = (uint32_t)support_random_in(&random, 0, 17),
                                  .gpu_ms = any_time(&random),
                                  .wall_ms = any_time(&random),
                                  .fixed_ms = any_time(&random),
                                  .cpu_ms = i % 4 ? 0.0 : any_time(&random),
                                  .exclude_from_timing = i % 50 == 0};
        if (support_random(&random) % 50 == 0) s.frame = support_random(&random) >> 40;
        masu_governor_sample_in(&g, &s);
        if (support_random(&random) % 1000 == 0) masu_governor_cut(&g, frame);
        if (support_random(&random) % 1000 == 0)
            masu_governor_override(&g, frame, (uint32_t)(i % 20), 0);
        if (support_random(&random) % 5000 == 0) frame += support_random(&random) >> 50;
        if (support_random(&random) % 100 == 0)
            masu_governor_shown(&g, frame - support_random_in(&random, 0, 9),
                                support_random(&random) >> 40,
                                i % 7 ? 16666667 : support_random(&random) >> 36);
        if (support_random(&random) % 3000 == 0) {
            masu_governor_desc d = {.mode = MASU_GOVERNOR_ON,
                                    .target_ms = (float)any_time(&random),
                                    .best_rung = (uint32_t)(i % 3),
                                    .worst_rung = (uint32_t)(i % 18)};
            masu_governor_adjust(&g, &d);
        }
        if (support_random(&random) % 3000 == 0) masu_governor_scale(&g, any_time(&random), frame);
        uint32_t rung = i % 40 < 38 ? masu_governor_pick(&g, frame) : masu_governor_hold(&g, frame);
        frame++;
        if (rung < g.best || rung > g.worst || g.worst >= g.count)
            fail_msg("rung %u at %u", rung, i);
        masu_governor_info info;
        masu_governor_report(&g, &info);
        int good = isfinite(info.fixed_ms) && isfinite(info.load_ms) && isfinite(info.slope_ms) &&
                   isfinite(info.noise) && isfinite(info.start_delay_ms) && isfinite(info.unit);
        for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++) good = good && isfinite(info.predicted_ms[r]);
        if (!good || !info.reason_text) fail_msg("not finite at %u", i);
        /* The estimated cost of a rung remains within a factor of the ladder's cost. */
        for (uint32_t r = 0; r < g.count; r++) {
            double learnt = g.cost[r] / g.prior[r];
            if (!(learnt > 0.2499 && learnt < 4.001))
                fail_msg("rung %u: %g of its cost at %u", r, learnt, i);
        }
    }
}

/* However certain the samples are, and however uncertain the cost. */
static void what_it_learns_of_a_rung_stays_near_what_the_ladder_says(void **state) {
    (void)state;
    static const double times[] = {200.0, 0.2};
    for (int k = 0; k < 2; k++) {
        masu_governor g;
        const masu_governor_rung ladder[2] = {{.scale = 1.0, .cost = 1.0},
                                              {.scale = 0.5, .cost = 0.25}};
        const masu_governor_desc d = {.mode = MASU_GOVERNOR_ON, .target_ms = 16.0f};
        masu_governor_init(&g, &d, ladder, 2);
        uint64_t frame = 0;
        for (; frame < 60; frame++) {
            masu_governor_sample s = {.frame = frame, .rung = 0, .gpu_ms = 10.0, .wall_ms = 10.0};
            masu_governor_sample_in(&g, &s);
        }
        double prior = g.prior[1], most = 1.0;
        for (; frame < 70; frame++) {
            g.cost_variance[1] = 1e4;
            masu_governor_sample s = {
                .frame = frame, .rung = 1, .gpu_ms = times[k], .wall_ms = times[k]};
            masu_governor_sample_in(&g, &s);
            double off = g.cost[1] > prior ? g.cost[1] / prior : prior / g.cost[1];
            most = off > most ? off : most;
        }
        assert_true(most > 2.0); /* it has been updated */
        assert_true(most < 4.0001);
    }
}

static void no_model_makes_it_emit_an_invalid_rung(void **state) {
    (void)state;
    for (uint32_t i = 0; i < sim_model_count; i++) {
        for (uint32_t seed = 1; seed <= 5; seed++) {
            sim_frame frames[SIM_FRAMES_MOST];
            sim_result r = sim_run(&sim_models[i], ours, seed, frames, NULL);
            masu_governor_rung ladder[SIM_RUNGS];
            uint32_t rungs = sim_ladder(&sim_models[i], ladder);
            for (uint32_t f = 0; f < r.frames; f++) assert_true(frames[f].rung < rungs);
            assert_int_equal(r.invalid, 0);
        }
    }
}

/* ---- Modes
 * ------------------------------------------------------------------------------------- */

static const masu_governor_rung three[] = {{1.0, 0.0}, {0.8, 0.0}, {0.4, 0.0}};

/* Frames of this time at scale 1, pixel-bound, latency 2. Returns the rung of the last one. */
static uint32_t feed(masu_governor *g, uint64_t *frame, uint32_t frames, double ms) {
    uint32_t rung = 0;
    for (uint32_t i = 0; i < frames; i++, (*frame)++) {
        rung = masu_governor_pick(g, *frame);
        double s = g->scale[rung];
        masu_governor_sample k = {
            .frame = *frame, .rung = rung, .gpu_ms = ms * s * s * (1.0 + 0.004 * (i % 3))};
        masu_governor_sample_in(g, &k);
    }
    return rung;
}

static void it_keeps_its_modes_and_range(void **state) {
    (void)state;
    masu_governor g;
    masu_governor_info info;
    uint64_t frame = 0;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_FIXED, .rung = 1}, three, 3);
    assert_int_equal(feed(&g, &frame, 100, 100.0), 1);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_FIXED);
    assert_true(info.predicted_ms[1] > 50.0f); /* it still measures */
    assert_int_equal(info.missed, info.samples);

    frame = 0;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON, .worst_rung = 1}, three,
                       3);
    assert_int_equal(feed(&g, &frame, 100, 100.0), 1);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_WORST);
    assert_int_equal(info.locked, MASU_GOVERNOR_LOCKED_WORST);

    frame = 0;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON, .best_rung = 1}, three,
                       3);
    assert_int_equal(feed(&g, &frame, 300, 1.0), 1);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_BEST);
    assert_int_equal(info.locked, MASU_GOVERNOR_FREE);

    frame = 0;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON, .best_rung = 2}, three,
                       3);
    assert_int_equal(feed(&g, &frame, 300, 1.0), 2);
    masu_governor_report(&g, &info);
    assert_int_equal(info.locked, MASU_GOVERNOR_LOCKED_FIXED);

    masu_governor_init(&g, &(masu_governor_desc){0}, three, 3);
    frame = 0;
    feed(&g, &frame, 10, 30.0);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_NONE);
    assert_int_equal(info.samples, 0);
}

static void it_says_why(void **state) {
    (void)state;
    masu_governor g;
    masu_governor_info info;
    uint64_t frame = 0;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, three, 3);
    assert_int_equal(masu_governor_pick(&g, frame), 0);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_START);
    assert_true(info.predicted_ms[0] == 0.0f);
    assert_int_equal(info.source, MASU_GOVERNOR_SOURCE_NONE);
    frame = 1;
    feed(&g, &frame, 60, 10.0);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_BEST);
    assert_int_equal(feed(&g, &frame, 3, 22.0), 1); /* two samples show that the load has jumped */
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_JUMP);
    assert_int_equal(info.changes, 1);
    assert_int_equal(feed(&g, &frame, 5, 12.0), 1);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_WAIT);
    assert_int_equal(feed(&g, &frame, 60, 12.0), 0);
    assert_int_equal(masu_governor_pick(&g, frame + 100), 0); /* no samples for a long time */
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_STALE);
    assert_int_equal(info.locked, MASU_GOVERNOR_LOCKED_STALE);
    for (int r = 0; r < 15; r++) {
        const char *text = masu_governor_reason_string((masu_governor_reason)r);
        assert_true(strlen(text) > 10 && strcmp(text, "unknown reason") != 0);
    }
    assert_string_equal(masu_governor_reason_string((masu_governor_reason)99), "unknown reason");
}

/* After a cut one sample is enough; without a cut two are needed. */
static void a_cut_is_believed_at_once(void **state) {
    (void)state;
    for (uint32_t cut = 0; cut < 2; cut++) {
        masu_governor g;
        uint64_t frame = 0;
        masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, three, 3);
        feed(&g, &frame, 60, 10.0);
        if (cut) masu_governor_cut(&g, frame);
        feed(&g, &frame, 1, 60.0);
        assert_int_equal(masu_governor_pick(&g, frame), cut ? 2 : 0);
    }
}

static void it_takes_the_hosts_rungs(void **state) {
    (void)state;
    masu_governor g;
    masu_governor_info info;
    uint64_t frame = 0;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, three, 3);
    feed(&g, &frame, 60, 10.0);
    masu_governor_override(&g, frame, 2, 0);
    masu_governor_report(&g, &info);
    assert_int_equal(info.reason, MASU_GOVERNOR_REASON_HOST);
    assert_int_equal(info.rung, 2);
    frame++;
    assert_int_equal(feed(&g, &frame, 60, 10.0), 0); /* and back, after the dwell */
}

/* The times of passes give the fixed part before any rung has changed. */
static void it_learns_from_fixed_passes(void **state) {
    (void)state;
    masu_governor g;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, three, 3);
    for (uint64_t f = 0; f < 60; f++) {
        masu_governor_pick(&g, f);
        masu_governor_sample k = {
            .frame = f, .gpu_ms = 14.0 + 0.1 * (double)(f % 3), .fixed_ms = 9.0};
        masu_governor_sample_in(&g, &k);
    }
    double error = masu_governor_predict(&g, 2) - (9.0 + 5.1 * 0.16);
    if (fabs(error) > 0.7) fail_msg("rung 2 is predicted %.2f ms wrong", error);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_keeps_the_bar_on_the_standard_model),
        cmocka_unit_test(it_settles_under_every_constant_load),
        cmocka_unit_test(it_changes_seldom_under_noise),
        cmocka_unit_test(it_settles_soon_after_a_step),
        cmocka_unit_test(it_does_not_overshoot),
        cmocka_unit_test(it_comes_back),
        cmocka_unit_test(it_is_not_moved_by_lies),
        cmocka_unit_test(spikes_change_nothing),
        cmocka_unit_test(it_reports_what_it_trusts),
        cmocka_unit_test(it_finds_the_fixed_part),
        cmocka_unit_test(it_stays_sound_under_a_million_samples),
        cmocka_unit_test(what_it_learns_of_a_rung_stays_near_what_the_ladder_says),
        cmocka_unit_test(no_model_makes_it_emit_an_invalid_rung),
        cmocka_unit_test(it_keeps_its_modes_and_range),
        cmocka_unit_test(it_says_why),
        cmocka_unit_test(a_cut_is_believed_at_once),
        cmocka_unit_test(it_takes_the_hosts_rungs),
        cmocka_unit_test(it_learns_from_fixed_passes),
    };
    return cmocka_run_group_tests_name("governor", tests, NULL, NULL);
}
