/* test_governor_loads.c: the governor on loads that contradict the costs of the ladder: frame times
 * that no rung changes, or only some rungs, periodic spikes, times in whole refreshes of a display.
 * Simulated: the results are counts. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "quality/governor.h"
#include "support/random.h"
#include "support/simulated_gpu.h"

#define TARGET 16.67
#define FRAMES 3000u
#define SEEDS 5u
#define SETTLED 180u /* three seconds */

typedef struct load load;
struct load {
    double (*ms)(const load *l, uint64_t frame, uint32_t rung, double scale);
    double a, b, noise; /* relative standard deviation */
    uint32_t split, period, until;
    int gpu;   /* timestamps, three frames late; otherwise the wall clock, two frames late */
    int vsync; /* wall-clock times in whole refreshes */
    uint32_t rungs;
};

typedef struct result {
    uint32_t rung, late, missed; /* the last; changes and misses from frame `from` on */
    uint64_t last_change;
    double vsync;
} result;

static double flat(const load *l, uint64_t frame, uint32_t rung, double scale) {
    (void)frame, (void)rung, (void)scale;
    return l->a;
}
static double plateaus(const load *l, uint64_t frame, uint32_t rung, double scale) {
    (void)frame, (void)scale;
    return rung < l->split ? l->a : l->b;
}
static double pixels(const load *l, uint64_t frame, uint32_t rung, double scale) {
    (void)frame, (void)rung;
    return 2.0 + l->a * scale * scale;
}
/* 6 frames of each period take 1.6 times as long. */
static double beat(const load *l, uint64_t frame, uint32_t rung, double scale) {
    return pixels(l, frame, rung, scale) * (frame % l->period < 6 && frame < l->until ? 1.6 : 1.0);
}
/* No rung changes the time until frame 1500. */
static double then_pixels(const load *l, uint64_t frame, uint32_t rung, double scale) {
    return frame < 1500 ? l->b : pixels(l, frame, rung, scale);
}

static double normal(uint64_t *random) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++) sum += random_unit(random);
    return sum;
}

static result run(const load *l, uint64_t seed, uint64_t from) {
    static const double eight[] = {1.0, 0.9, 0.8, 0.7, 0.6, 0.55, 0.5, 0.4};
    static masu_governor_sample samples[FRAMES];
    masu_governor_rung ladder[16];
    uint32_t n = l->rungs ? l->rungs : 8, before = 0;
    for (uint32_t r = 0; r < n; r++)
        ladder[r] = (masu_governor_rung){.scale = n == 8 ? eight[r] : pow(0.4, r / (n - 1.0))};
    masu_governor g;
    masu_governor_init(
        &g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON, .target_ms = (float)TARGET}, ladder, n);
    uint64_t random = seed * 7919 + 1, late = l->gpu ? 3 : 2;
    result out = {0};
    for (uint64_t f = 0; f < FRAMES; f++) {
        if (f >= late) masu_governor_sample_in(&g, &samples[f - late]);
        uint32_t rung = masu_governor_pick(&g, f);
        double ms = l->ms(l, f, rung, ladder[rung].scale) * (1.0 + l->noise * normal(&random));
        if (l->vsync) ms = TARGET * ceil(ms / TARGET) + 0.05 * normal(&random);
        samples[f] = (masu_governor_sample){.frame = f, .rung = rung};
        *(l->gpu ? &samples[f].gpu_ms : &samples[f].wall_ms) = ms;
        if (f && rung != before) {
            out.last_change = f;
            out.late += f >= from;
        }
        out.missed += f >= from && ms > 1.01 * TARGET;
        before = rung;
    }
    masu_governor_info info;
    masu_governor_report(&g, &info);
    out.rung = info.rung;
    out.vsync = (double)info.vsync_ms;
    return out;
}

/* Above the target: after three seconds the best rung is kept, at any noise. */
static void a_load_that_no_rung_changes_keeps_the_best_rung(void **state) {
    static const double times[] = {17.0, 18.0, 20.0, 25.0, 33.0, 40.0, 100.0};
    static const double noises[] = {0.002, 0.005, 0.016, 0.03, 0.045, 0.06};
    (void)state;
    uint32_t runs = 0, wrong = 0;
    for (uint32_t i = 0; i < 7 * 6 * 4; i++) {
        load l = {flat, .a = times[i % 7], .noise = noises[i / 7 % 6], .gpu = i / 42 % 2,
                  .rungs = i / 84 ? 16 : 8};
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            result r = run(&l, seed, SETTLED);
            runs++;
            wrong += r.rung != 0;
            if (r.late > 0)
                fail_msg("%.0f ms, noise %.3f, seed %u: %u changes after three seconds", l.a,
                         l.noise, (unsigned)seed, r.late);
        }
    }
    if (100 * wrong > runs) fail_msg("%u of %u runs keep another rung", wrong, runs);
}

/* Just below the target, noise by itself causes single falls. They must not repeat. */
static void a_load_just_below_the_target_changes_seldom(void **state) {
    static const double times[] = {12.0, 14.0, 15.0, 15.5, 16.0, 16.4};
    static const double noises[] = {0.002, 0.005, 0.016, 0.03, 0.045, 0.06};
    (void)state;
    uint32_t sum = 0, runs = 0;
    for (uint32_t i = 0; i < 36; i++) {
        load l = {flat, .a = times[i % 6], .noise = noises[i / 6], .gpu = 1};
        for (uint64_t seed = 1; seed <= SEEDS; seed++, runs++) {
            result r = run(&l, seed, SETTLED);
            sum += r.late;
            if (r.late > 20)
                fail_msg("%.1f ms, noise %.3f, seed %u: %u changes", l.a, l.noise, (unsigned)seed,
                         r.late);
        }
    }
    if (sum > runs) fail_msg("%u changes in %u runs", sum, runs);
}

static void of_equal_rungs_the_best_is_kept(void **state) {
    static const double pairs[][2] = {{25.0, 20.0}, {40.0, 25.0}, {33.0, 18.0}};
    static const double noises[] = {0.002, 0.005, 0.016, 0.03};
    (void)state;
    uint32_t runs = 0, right = 0;
    for (uint32_t i = 0; i < 3 * 4 * 7; i++) {
        load l = {plateaus, .a = pairs[i % 3][0], .b = pairs[i % 3][1], .noise = noises[i / 3 % 4],
                  .split = 1 + i / 12};
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            result r = run(&l, seed, SETTLED);
            runs++;
            right += r.rung == l.split;
            if (r.late > 0 || r.rung < l.split || r.rung > l.split + 2)
                fail_msg("%.0f and %.0f ms from rung %u, noise %.3f, seed %u: rung %u, %u changes",
                         l.a, l.b, l.split, l.noise, (unsigned)seed, r.rung, r.late);
        }
    }
    if (10 * right < 9 * runs)
        fail_msg("%u of %u runs keep the best of the cheap rungs", right, runs);
}

/* The answer of a survey does not outlive the load that it was measured with. */
static void it_falls_where_rungs_begin_to_count(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 5; i++) {
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            load l = {then_pixels, .a = 34.0 + 6.0 * i, .b = 25.0, .noise = 0.02};
            result r = run(&l, seed, 1600);
            double most = (TARGET - 2.0) / l.a, s = r.rung < 7 ? 1.0 - 0.1 * r.rung : 0.4;
            if (r.missed > 30 || r.rung < 3 || (r.rung < 5 && s * s > most))
                fail_msg("load %.0f, seed %u: rung %u, %u missed", l.a, (unsigned)seed, r.rung,
                         r.missed);
        }
    }
}

/* After three equal spikes no more falls. The best rung returns after the last spike. */
static void spikes_that_come_back_cost_three_falls(void **state) {
    (void)state;
    uint32_t sum = 0, runs = 0;
    for (uint32_t period = 30; period <= 240; period += 15) {
        for (uint64_t seed = 1; seed <= SEEDS; seed++, runs++) {
            load l = {beat, .a = 11.0, .noise = 0.03, .period = period, .until = FRAMES};
            result r = run(&l, seed, 4 * period + 60);
            sum += r.late;
            if (r.late > 3 || r.missed > 12)
                fail_msg("period %u, seed %u: %u changes, %u missed", period, (unsigned)seed,
                         r.late, r.missed);
            l.until = 1200;
            r = run(&l, seed, 1200 + 4 * period + 180);
            if (r.rung || r.late > 1)
                fail_msg("period %u, seed %u: still rung %u", period, (unsigned)seed, r.rung);
        }
    }
    if (sum > runs) fail_msg("%u changes in %u runs", sum, runs);
}

/* With vertical synchronisation: the best rung whose frames need as few refreshes as the
 * cheapest's. */
static void vertical_synchronisation_is_reported(void **state) {
    static const struct {
        double load;
        uint32_t rung;
    } cases[] = {{4.0, 0},  {11.0, 0}, {13.0, 0}, {17.0, 1},
                 {21.0, 2}, {27.0, 3}, {37.0, 4}, {42.0, 5}};
    (void)state;
    for (uint32_t i = 0; i < 8; i++) {
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            load l = {pixels, .a = cases[i].load, .noise = 0.004, .vsync = 1};
            result r = run(&l, seed, SETTLED);
            if (r.late > 0 || r.rung != cases[i].rung)
                fail_msg("load %.0f, seed %u: rung %u, not %u, %u changes", l.a, (unsigned)seed,
                         r.rung, cases[i].rung, r.late);
        }
    }
    for (uint64_t seed = 1; seed <= SEEDS; seed++) { /* half of the frames take two refreshes */
        load l = {pixels, .a = 92.0, .noise = 0.03, .vsync = 1};
        result r = run(&l, seed, SETTLED);
        if (fabs(r.vsync - TARGET) > 0.2)
            fail_msg("seed %u: refresh %.2f ms", (unsigned)seed, r.vsync);
        l.vsync = 0;
        assert_true(run(&l, seed, SETTLED).vsync == 0.0);
    }
}

/* No simulated load is mistaken for vertical synchronisation. */
static void other_loads_are_not_reported_as_synchronised(void **state) {
    (void)state;
    for (uint32_t i = 0; i < sim_model_count; i++) {
        sim_model p = sim_models[i];
        p.wall = 1;
        for (uint64_t seed = 1; seed <= 3; seed++) {
            sim_state s;
            sim_run(&p, &sim_masu, seed, NULL, &s);
            if (s.governor.trust.vsync > 0.0)
                fail_msg("%s: %.2f ms", p.name, s.governor.trust.vsync);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_load_that_no_rung_changes_keeps_the_best_rung),
        cmocka_unit_test(a_load_just_below_the_target_changes_seldom),
        cmocka_unit_test(of_equal_rungs_the_best_is_kept),
        cmocka_unit_test(it_falls_where_rungs_begin_to_count),
        cmocka_unit_test(spikes_that_come_back_cost_three_falls),
        cmocka_unit_test(vertical_synchronisation_is_reported),
        cmocka_unit_test(other_loads_are_not_reported_as_synchronised),
    };
    return cmocka_run_group_tests_name("governor_loads", tests, NULL, NULL);
}
