/* test_governor.c: governed frames. The test supplies the times that matter, so that every driver
 * decides alike; with the driver's own times, only properties that hold for any times are
 * checked. */
#include "support/support.h"

#include <math.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 66, H = 48 };

static masu_session_desc governed_desc(masu_governor_mode mode) {
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.rung_count = 4;
    for (uint32_t r = 0; r < 4; r++) d.desc.rungs[r].scale = 1.0f - 0.2f * (float)r;
    d.desc.governor = (masu_governor_desc){.mode = mode};
    return d;
}

/* One frame at the governor's rung, with a wall-clock time of `load` ms times its pixels. Returns
 * the rung. */
static uint32_t step(masu_session *s, uint32_t frame, double load, masu_stats_info *stats) {
    masu_frame_desc f = {MASU_FRAME_DESC, .rung = MASU_RUNG_AUTO, .time = 0.01 * frame};
    masu_commands c;
    draw(s, &f, &c, NULL);
    assert_true(c.rung < s->desc.rung_count);
    assert_int_equal(masu_stats(s->m, c.slot, stats, &failure), MASU_OK);
    assert_int_equal(stats->rung, c.rung);
    assert_int_equal(stats->governor.rung, c.rung);
    assert_true(stats->governor.reason_text && strlen(stats->governor.reason_text) > 10);
    double scale = (double)s->desc.rungs[c.rung].scale;
    if (load > 0.0)
        masu_frame_wall(s->m, c.slot, load * scale * scale * (1.0 + 0.002 * (frame % 3)));
    return c.rung;
}

static void it_follows_the_wall_clock(void **state) {
    (void)state;
    masu_session_desc d = governed_desc(MASU_GOVERNOR_ON);
    d.desc.governor.wall_only = 1;
    masu_session s;
    masu_stats_info stats;
    uint32_t frame = 0, rung = 9;
    open_session(&s, &d);
    for (uint32_t i = 0; i < 60; i++, frame++) rung = step(&s, frame, 12.0, &stats);
    assert_int_equal(rung, 0);
    assert_int_equal(stats.governor.reason, MASU_GOVERNOR_REASON_BEST);
    assert_int_equal(stats.governor.source, MASU_GOVERNOR_SOURCE_WALL);
    assert_int_equal(stats.gpu_ns, 0); /* timestamps were not requested */
    for (uint32_t i = 0; i < 8; i++, frame++) rung = step(&s, frame, 30.0, &stats);
    assert_int_equal(rung, 2); /* 0.36 * 30 ms fits, 0.64 * 30 ms does not */
    assert_int_equal(stats.governor.changes, 1);
    for (uint32_t i = 0; i < 100; i++, frame++) rung = step(&s, frame, 30.0, &stats);
    assert_int_equal(rung, 2);
    assert_true(fabsf(stats.governor.predicted_ms[2] - 10.8f) < 0.3f);
    for (uint32_t i = 0; i < 200; i++, frame++) rung = step(&s, frame, 200.0, &stats);
    assert_int_equal(rung, 3);
    assert_int_equal(stats.governor.locked, MASU_GOVERNOR_LOCKED_WORST);
    for (uint32_t i = 0; i < 80; i++, frame++) rung = step(&s, frame, 12.0, &stats);
    assert_int_equal(rung, 0);
    close_session(&s);
}

/* With the driver's own timestamps and an unreachable target: the governor keeps to the range and
 * gives a reason; each frame is reported to it once. */
static void it_stays_in_range_with_real_times(void **state) {
    (void)state;
    if (masu_session_denied()) skip(); /* no timestamps */
    for (uint32_t debug = 0; debug < 2; debug++) {
        masu_session_desc d = governed_desc(MASU_GOVERNOR_ON);
        d.desc.governor.target_ms = 1.0f;
        d.desc.governor.best_rung = 1;
        d.desc.governor.worst_rung = 2;
        d.desc.debug.timestamps = debug;
        masu_session s;
        masu_stats_info stats;
        open_session(&s, &d);
        for (uint32_t i = 0; i < 40; i++) {
            uint32_t rung = step(&s, i, 0.0, &stats);
            assert_true(rung == 1 || rung == 2);
            uint64_t named = 0;
            for (uint32_t p = 0; p < stats.pass_count; p++) named += stats.pass_ns[p] > 0;
            if (!debug) assert_int_equal(named, 0);
        }
        assert_int_equal(stats.timed, 1);
        assert_int_equal(stats.governor.samples + stats.governor.rejected, 38);
        for (uint32_t r = 0; r < 4; r++) assert_true(isfinite(stats.governor.predicted_ms[r]));
        close_session(&s);
    }
}

static void the_picture_is_that_of_the_rung(void **state) {
    (void)state;
    static uint8_t plain[W * H * 4], governed[W * H * 4];
    masu_session_desc d = governed_desc(MASU_GOVERNOR_OFF);
    masu_session s;
    masu_stats_info stats;
    masu_commands c;
    d.desc.rungs[2].temporal = MASU_ON; /* the value of AUTO with a governor */
    open_session(&s, &d);
    draw_rung(&s, 2, plain);
    masu_frame_desc automatic = {MASU_FRAME_DESC, .rung = MASU_RUNG_AUTO};
    assert_int_equal(masu_frame(s.m, &automatic, &c, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "rung");
    close_session(&s);
    d.desc.rungs[2].temporal = MASU_AUTO;
    d.desc.governor = (masu_governor_desc){.mode = MASU_GOVERNOR_FIXED, .rung = 2};
    open_session(&s, &d);
    draw_rung(&s, MASU_RUNG_AUTO, governed);
    assert_int_equal(masu_stats(s.m, 0, &stats, &failure), MASU_OK);
    assert_int_equal(stats.governor.reason, MASU_GOVERNOR_REASON_FIXED);
    assert_int_equal(max_difference(plain, governed, sizeof plain), 0);
    draw_rung(&s, 0, NULL); /* a rung chosen by the host is still used */
    close_session(&s);
}

static void expect_bad(masu_session *s, masu_governor_desc governor, const char *what) {
    masu_desc d = s->desc;
    masu_memory need;
    masu_detail detail = {0};
    d.governor = governor;
    assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, what);
}

static void bad_descriptions_are_named(void **state) {
    (void)state;
    masu_session_desc d = governed_desc(MASU_GOVERNOR_OFF);
    masu_session s;
    open_session(&s, &d);
    masu_governor_desc on = {.mode = MASU_GOVERNOR_ON}, g;
#define EXPECT_BAD(field, value, name)                                                             \
    (g = on, g.field = (value), expect_bad(&s, g, "governor." name))
    EXPECT_BAD(mode, (masu_governor_mode)3, "mode");
    EXPECT_BAD(target_ms, 0.01667f, "target_ms"); /* seconds */
    EXPECT_BAD(target_ms, 16667.0f, "target_ms"); /* microseconds */
    EXPECT_BAD(target_ms, NAN, "target_ms");
    EXPECT_BAD(headroom, 0.6f, "headroom");
    EXPECT_BAD(headroom, NAN, "headroom");
    EXPECT_BAD(worst_rung, 4, "worst_rung");
    EXPECT_BAD(best_rung, 4, "best_rung");
    EXPECT_BAD(rung, 4, "rung");
    EXPECT_BAD(dwell, 601, "dwell");
    EXPECT_BAD(costs[1], -1.0f, "costs");
#undef EXPECT_BAD
    /* Without a governor there is no memory for it. */
    masu_memory without, with;
    masu_desc off = s.desc, asked = s.desc;
    asked.governor = on;
    assert_int_equal(masu_memory_query(&off, &without, NULL), MASU_OK);
    assert_int_equal(masu_memory_query(&asked, &with, NULL), MASU_OK);
    assert_true(with.host_bytes > without.host_bytes);
    masu_desc resolved = masu_session_resolved(&asked);
    assert_true(fabsf(resolved.governor.target_ms - 16.67f) < 1e-6f);
    assert_int_equal(resolved.governor.worst_rung, 3);
    assert_int_equal(resolved.governor.dwell, 24);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_follows_the_wall_clock),
        cmocka_unit_test(it_stays_in_range_with_real_times),
        cmocka_unit_test(the_picture_is_that_of_the_rung),
        cmocka_unit_test(bad_descriptions_are_named),
    };
    return cmocka_run_group_tests_name("governor", tests, NULL, NULL);
}
