/* test_governor_host.c: the host's use of a renderer's governor between frames: settings, excluded
 * frames, times, state kept across masu_destroy and masu_init. The test supplies the times that
 * matter. */
#include "renderer.h"
#include "support/support.h"

#include <math.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 66, H = 48 };

static void open_governed(masu_session *s, uint32_t width, uint32_t height) {
    masu_session_desc d = test_desc("test_both", width, height);
    d.desc.rung_count = 4;
    for (uint32_t r = 0; r < 4; r++) d.desc.rungs[r].scale = 1.0f - 0.2f * (float)r;
    d.desc.resizable = 1;
    d.desc.governor = (masu_governor_desc){.mode = MASU_GOVERNOR_ON, .wall_only = 1};
    open_session(s, &d);
}

/* A frame of `load` ms at scale 1, with times from the host. Returns its rung. */
static uint32_t step(masu_session *s, double load, uint32_t excluded, double cpu,
                     masu_stats_info *stats) {
    static uint64_t now = 1000000000;
    masu_frame_desc f = {MASU_FRAME_DESC, .rung = MASU_RUNG_AUTO, .exclude_from_timing = excluded};
    masu_commands c;
    draw(s, &f, &c, NULL);
    assert_int_equal(masu_stats(s->m, c.slot, stats, &failure), MASU_OK);
    double scale = (double)s->desc.rungs[c.rung].scale;
    double ms = load * scale * scale * (1.0 + 0.002 * (double)(c.frame % 3));
    uint64_t end = now + (uint64_t)(1e6 * ms);
    masu_frame_times(s->m, c.slot, now, end, cpu);
    masu_frame_presented(s->m, c.frame, end, 0);
    now = end + 100000;
    return c.rung;
}

static uint32_t steps(masu_session *s, uint32_t count, double load, masu_stats_info *stats) {
    uint32_t rung = 9;
    for (uint32_t i = 0; i < count; i++) rung = step(s, load, 0, 0.0, stats);
    return rung;
}

static void settings_count_from_the_next_frame_on(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    open_governed(&s, W, H);
    assert_int_equal(steps(&s, 80, 30.0, &stats), 2);
    masu_governor_setting now = {.mode = MASU_GOVERNOR_ON, .target_ms = 33.3f};
    assert_int_equal(masu_governor_set(s.m, &now, &failure), MASU_OK);
    assert_int_equal(steps(&s, 1, 30.0, &stats), 0);
    now = (masu_governor_setting){.mode = MASU_GOVERNOR_FIXED, .rung = 3};
    assert_int_equal(masu_governor_set(s.m, &now, &failure), MASU_OK);
    assert_int_equal(steps(&s, 3, 30.0, &stats), 3);
    masu_governor_setting bad = {.mode = MASU_GOVERNOR_ON, .target_ms = 0.5f};
    assert_int_equal(masu_governor_set(s.m, &bad, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "governor.target_ms");
    bad = (masu_governor_setting){.mode = MASU_GOVERNOR_ON, .worst_rung = 4};
    assert_int_equal(masu_governor_set(s.m, &bad, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "governor.worst_rung");
    bad = (masu_governor_setting){.target_ms = 20.0f};
    assert_int_equal(masu_governor_set(s.m, &bad, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "governor.mode");
    assert_int_equal(masu_governor_set(s.m, NULL, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(steps(&s, 3, 30.0, &stats), 3); /* nothing was changed */
    assert_int_equal(stats.governor.mode, MASU_GOVERNOR_FIXED);
    close_session(&s);
}

/* The times remain unused, in the governor and in the slot: the next attempt uses them. */
static void a_frame_that_fails_uses_no_time(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    open_governed(&s, W, H);
    steps(&s, 4, 12.0, &stats);
    masu_governor governor = *s.m->governor;
    masu_timeline timeline = s.m->timeline;
    masu_commands c;
    masu_frame_desc bad = {MASU_FRAME_DESC, .rung = MASU_RUNG_AUTO, .time = (double)NAN};
    assert_int_equal(masu_frame(s.m, &bad, &c, &failure), MASU_ERROR_ARGUMENT);
    assert_memory_equal(s.m->governor, &governor, sizeof governor);
    assert_memory_equal(&s.m->timeline, &timeline, sizeof timeline);
    uint64_t samples = stats.governor.samples;
    steps(&s, 1, 12.0, &stats);
    assert_int_equal(stats.governor.samples, samples + 1);
    close_session(&s);
}

/* A frame that was not returned cannot have been presented. */
static void a_frame_to_come_has_not_been_presented(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    open_governed(&s, W, H);
    steps(&s, 3, 12.0, &stats);
    masu_governor before = *s.m->governor;
    masu_frame_presented(s.m, s.m->timeline.frame, 1, 16666667);
    assert_memory_equal(s.m->governor, &before, sizeof before);
    masu_frame_presented(s.m, s.m->timeline.frame - 1, 1, 16666667);
    assert_memory_not_equal(s.m->governor, &before, sizeof before);
    close_session(&s);
}

static void unusual_frames_are_left_out(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info before, stats;
    open_governed(&s, W, H);
    steps(&s, 60, 12.0, &before);
    for (uint32_t i = 0; i < 20; i++) assert_int_equal(step(&s, 500.0, 1, 0.0, &stats), 0);
    assert_int_equal(stats.governor.reason, MASU_GOVERNOR_REASON_EXCLUDED);
    steps(&s, 20, 12.0, &stats);
    assert_int_equal(stats.governor.missed, before.governor.missed);
    assert_int_equal(stats.governor.rejected, before.governor.rejected + 20);
    assert_int_equal(stats.governor.changes, 0);
    close_session(&s);
}

static void the_hosts_own_work_is_said(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    open_governed(&s, W, H);
    for (uint32_t i = 0; i < 60; i++) assert_int_equal(step(&s, 30.0, 0, 31.0, &stats), 0);
    assert_int_equal(stats.governor.locked, MASU_GOVERNOR_LOCKED_CPU);
    assert_true(fabsf(stats.governor.cpu_ms - 31.0f) < 0.1f);
    close_session(&s);
}

static void a_state_outlives_its_renderer(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    masu_governor_state kept, bad;
    open_governed(&s, W, H);
    assert_int_equal(masu_governor_save(s.m, NULL, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(steps(&s, 80, 30.0, &stats), 2);
    assert_int_equal(masu_governor_save(s.m, &kept, &failure), MASU_OK);
    close_session(&s);
    open_governed(&s, W, H);
    assert_int_equal(steps(&s, 1, 30.0, &stats), 0); /* without it */
    close_session(&s);
    open_governed(&s, W, H);
    bad = kept;
    bad.version = 99;
    assert_int_equal(masu_governor_restore(s.m, &bad, &failure), MASU_ERROR_VERSION);
    bad = kept;
    bad.noise = (double)NAN;
    assert_int_equal(masu_governor_restore(s.m, &bad, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "state.noise");
    assert_int_equal(masu_governor_restore(s.m, &kept, &failure), MASU_OK);
    assert_int_equal(steps(&s, 1, 30.0, &stats), 2);
    assert_int_equal(steps(&s, 30, 30.0, &stats), 2);
    assert_int_equal(stats.governor.missed, 0);
    close_session(&s);
    open_governed(&s, 2 * W, 2 * H); /* four times the pixels */
    assert_int_equal(masu_governor_restore(s.m, &kept, &failure), MASU_OK);
    assert_int_equal(steps(&s, 1, 60.0, &stats), 3);
    close_session(&s);
}

/* After masu_resize the first frame has the rung for the new number of pixels, before any of its
 * times are known: a better one without a dwell, or a cheaper one without a miss. */
static void a_resize_selects_the_rung_at_once(void **state) {
    (void)state;
    masu_session s;
    masu_stats_info stats;
    open_governed(&s, 2 * W, 2 * H);
    uint32_t large = steps(&s, 80, 60.0, &stats);
    assert_int_equal(large, 3);
    masu_targets t = s.desc.targets;
    assert_int_equal(masu_resize(s.m, (VkExtent2D){W, H}, &t, NULL, &failure), MASU_OK);
    assert_int_equal(steps(&s, 1, 15.0, &stats), 0);
    uint64_t missed = stats.governor.missed;
    assert_int_equal(steps(&s, 60, 15.0, &stats), 0);
    t = s.desc.targets;
    assert_int_equal(masu_resize(s.m, (VkExtent2D){2 * W, 2 * H}, &t, NULL, &failure), MASU_OK);
    assert_int_equal(steps(&s, 30, 60.0, &stats), 3);
    assert_int_equal(stats.governor.missed, missed);
    close_session(&s);
}

static void without_a_governor_it_is_said(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_governor_state kept;
    masu_governor_setting on = {.mode = MASU_GOVERNOR_ON};
    open_session(&s, &d);
    assert_int_equal(masu_governor_set(s.m, &on, &failure), MASU_ERROR_STATE);
    assert_string_equal(failure.what, "governor.mode");
    assert_int_equal(masu_governor_save(s.m, &kept, &failure), MASU_ERROR_STATE);
    assert_int_equal(masu_governor_restore(s.m, &kept, &failure), MASU_ERROR_STATE);
    masu_frame_times(s.m, 9, 1, 2, 3.0); /* no such slot: nothing */
    masu_frame_presented(s.m, 5, 1, 2);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(settings_count_from_the_next_frame_on),
        cmocka_unit_test(a_frame_that_fails_uses_no_time),
        cmocka_unit_test(a_frame_to_come_has_not_been_presented),
        cmocka_unit_test(unusual_frames_are_left_out),
        cmocka_unit_test(the_hosts_own_work_is_said),
        cmocka_unit_test(a_state_outlives_its_renderer),
        cmocka_unit_test(a_resize_selects_the_rung_at_once),
        cmocka_unit_test(without_a_governor_it_is_said),
    };
    return cmocka_run_group_tests_name("governor_host", tests, NULL, NULL);
}
