/* test_bounce.c: selection of the live probes that trace rays in a frame (src/frame/bounce.h). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "frame/bounce.h"
#include "shared/masu_shared.h"

enum { PROBES = 576, MOST = 94, OFF_EVERY = 17 };

typedef struct grid {
    masu_bounce b;
    struct masu_bounce_probe probes[PROBES];
    uint32_t words[4 * MOST];
} grid;

static grid *make(void) {
    grid *g = calloc(1, sizeof *g);
    g->b.probes = g->probes;
    g->b.count = PROBES;
    g->b.counts[0] = 12, g->b.counts[1] = 6, g->b.counts[2] = 8;
    for (int k = 0; k < 3; k++) g->b.spacing[k] = 0.5f;
    for (uint32_t i = 0; i < PROBES; i++) {
        g->probes[i].sets = i % OFF_EVERY ? 0 : MASU_BOUNCE_OFF;
        g->b.valid += i % OFF_EVERY != 0;
    }
    g->b.quiet = MASU_BOUNCE_FIRST;
    masu_bounce_restart(&g->b);
    return g;
}

static uint32_t probe_of(uint32_t word) { return word & MASU_BOUNCE_PROBE; }
static uint32_t set_of(uint32_t word) {
    return word >> MASU_BOUNCE_SET_SHIFT & (MASU_BOUNCE_SETS - 1u);
}
static uint32_t count_of(uint32_t word) { return word >> MASU_BOUNCE_COUNT_SHIFT; }

/* Runs the frames of a whole round; `seen` counts how often each probe was selected. */
static uint32_t run_round(grid *g, uint32_t seen[PROBES]) {
    uint32_t round = g->b.round, frames = 0;
    for (; g->b.round == round; frames++) {
        uint32_t count = masu_bounce_choose(&g->b, NULL, MOST, g->words);
        if (!count) break;
        assert_true(count <= MOST);
        for (uint32_t i = 0; i < count; i++) seen[probe_of(g->words[i])]++;
    }
    return frames;
}

static void a_round_takes_every_probe_that_is_not_off_once(void **state) {
    (void)state;
    grid *g = make();
    for (uint32_t k = 0; k < 6; k++) {
        uint32_t seen[PROBES] = {0};
        assert_int_equal(run_round(g, seen), (g->b.valid + MOST - 1) / MOST);
        for (uint32_t i = 0; i < PROBES; i++) assert_int_equal(seen[i], i % OFF_EVERY != 0);
    }
    free(g);
}

/* Four sets, then the same with the light of later bounces, then the other twelve, then all in a
 * cycle. */
static void sets_go_around_and_count_from_a_restart_on(void **state) {
    (void)state;
    grid *g = make();
    uint32_t frames = (g->b.valid + MOST - 1) / MOST;
    for (uint32_t round = 0; round < 86; round++) {
        if (round == 6 || round == 20) masu_bounce_restart(&g->b);
        uint32_t since = round < 6 ? round : round < 20 ? round - 6 : round - 20;
        uint32_t set = since < 8 ? since % 4 : since < 20 ? since - 4 : (since - 20) % 16;
        uint32_t counting = since < 4 ? since + 1 : since < 8 ? 4 : since < 20 ? since - 3 : 16;
        for (uint32_t f = 0; f < frames; f++) {
            uint32_t count = masu_bounce_choose(&g->b, NULL, MOST, g->words);
            for (uint32_t i = 0; i < count; i++) {
                assert_int_equal(set_of(g->words[i]), set);
                assert_int_equal(count_of(g->words[i]), counting);
            }
        }
    }
    free(g);
}

/* Otherwise a light that changes in every frame would restrict each probe to its first set. */
static void changes_that_follow_each_other_slide_the_window(void **state) {
    (void)state;
    grid *g = make();
    uint32_t seen[PROBES] = {0}, least = 4, most = 0;
    for (uint32_t round = 0; round < 30; round++) (void)run_round(g, seen);
    for (uint32_t f = 0; f < 60; f++) {
        masu_bounce_restart(&g->b);
        uint32_t count = masu_bounce_choose(&g->b, NULL, MOST, g->words);
        assert_int_not_equal(count, 0);
        for (uint32_t i = 0; i < count && f >= 40; i++) {
            if (count_of(g->words[i]) < least) least = count_of(g->words[i]);
            if (set_of(g->words[i]) > most) most = set_of(g->words[i]);
        }
    }
    assert_int_equal(least, 4);
    assert_int_equal(most, 3);
    free(g);
}

static void at_rest_nothing_is_traced_until_something_changes(void **state) {
    (void)state;
    grid *g = make();
    uint32_t seen[PROBES] = {0}, rounds = 0;
    while (rounds < 2 * MASU_BOUNCE_REST && run_round(g, seen)) rounds++;
    assert_int_equal(rounds, MASU_BOUNCE_REST);
    assert_int_equal(masu_bounce_choose(&g->b, NULL, MOST, g->words), 0);
    masu_bounce_restart(&g->b);
    assert_int_equal(masu_bounce_choose(&g->b, NULL, MOST, g->words), MOST);
    assert_int_equal(count_of(g->words[0]), 1);
    free(g);
}

/* An SDF that depends on parameters is static while they are unchanged; one that depends on time is
 * not. */
static void only_time_keeps_a_field_of_parameters_awake(void **state) {
    (void)state;
    for (int timed = 0; timed < 2; timed++) {
        static masu_frame_plan plan;
        static masu_frame_data f;
        static masu_lights lights;
        static masu_instances instances;
        static masu_materials materials;
        grid *g = make();
        plan.needs =
            (masu_needs){.sdf = 1, .dynamic = 1, .timed = timed, .bounce = 1, .bounce_sdf = 1};
        f.plan = &plan;
        f.u.sdf_params[0][0] = 0.25f;
        masu_bounce_follow(&g->b, &lights, &instances, &materials, &f);
        g->b.quiet = MASU_BOUNCE_REST;
        f.u.eye_hi[3] += 0.5f; /* time */
        masu_bounce_follow(&g->b, &lights, &instances, &materials, &f);
        assert_int_equal(g->b.quiet, timed ? 0 : MASU_BOUNCE_REST);
        g->b.quiet = MASU_BOUNCE_REST;
        f.u.sdf_params[0][0] = 0.5f;
        masu_bounce_follow(&g->b, &lights, &instances, &materials, &f);
        assert_int_equal(g->b.quiet, 0);
        free(g);
    }
}

/* Twice the rays until all sets are traced, but not if one change follows another. */
static void a_change_brings_more_rays_for_some_rounds(void **state) {
    (void)state;
    grid *g = make();
    uint32_t seen[PROBES] = {0};
    for (uint32_t round = 0; round < MASU_BOUNCE_SWIFT_ROUNDS; round++) {
        assert_int_equal(masu_bounce_pace(&g->b, 4 * MOST), 2 * MOST);
        (void)run_round(g, seen);
    }
    assert_int_equal(masu_bounce_pace(&g->b, 4 * MOST), MOST);
    for (uint32_t k = 0; k < 200; k++) {
        masu_bounce_restart(&g->b);
        (void)masu_bounce_choose(&g->b, NULL, masu_bounce_pace(&g->b, 4 * MOST), g->words);
    }
    assert_int_equal(masu_bounce_pace(&g->b, 4 * MOST), MOST);
    g->b.burst = 1;
    assert_int_equal(masu_bounce_pace(&g->b, 4 * MOST), 4 * MOST);
    free(g);
}

static void what_is_in_view_comes_first(void **state) {
    (void)state;
    grid *g = make();
    /* Looks along -z from beyond the grid's centre: probes in front have z below 1. */
    const float clip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, 0, 0, 0.05f, 0};
    const masu_bounce_view view = {clip, {2.75, 1.25, 1.0}};
    uint32_t before = 0, count, last = 0;
    int behind = 0;
    for (uint32_t f = 0; before < g->b.valid && f < 20; f++) {
        count = masu_bounce_choose(&g->b, &view, MOST, g->words);
        for (uint32_t i = 0; i < count && before + i < g->b.valid; i++) {
            uint32_t z = probe_of(g->words[i]) / 72;
            behind |= z > 4; /* two cells around the camera are treated as visible */
            if (z < 2) last = before + i;
            if (behind && z == 0) last = UINT32_MAX;
        }
        before += count;
    }
    assert_true(behind);
    assert_true(last < g->b.valid);
    free(g);
}

static void all_inside_of_things_is_no_work(void **state) {
    (void)state;
    grid *g = make();
    for (uint32_t i = 0; i < PROBES; i++) g->probes[i].sets = MASU_BOUNCE_OFF;
    g->b.valid = 0;
    masu_bounce_restart(&g->b);
    assert_int_equal(masu_bounce_choose(&g->b, NULL, MOST, g->words), 0);
    free(g);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_round_takes_every_probe_that_is_not_off_once),
        cmocka_unit_test(sets_go_around_and_count_from_a_restart_on),
        cmocka_unit_test(changes_that_follow_each_other_slide_the_window),
        cmocka_unit_test(at_rest_nothing_is_traced_until_something_changes),
        cmocka_unit_test(only_time_keeps_a_field_of_parameters_awake),
        cmocka_unit_test(a_change_brings_more_rays_for_some_rounds),
        cmocka_unit_test(what_is_in_view_comes_first),
        cmocka_unit_test(all_inside_of_things_is_no_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
