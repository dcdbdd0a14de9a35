/* test_pacing.c: the number of display refreshes that frames are planned for: when it rises, when
 * it falls, that it does not alternate, and that no input breaks it. A display of 60 Hz that
 * reports when each frame was shown. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "quality/pacing.h"

#define REFRESH 16666667u /* ns */
#define MS (REFRESH * 1e-6)

static masu_pacing p;
static uint64_t frame, now;
static uint32_t last; /* number of refreshes for which the previous frame is shown */

static int start(void **state) {
    (void)state;
    memset(&p, 0, sizeof p);
    frame = 0, now = 1000000000, last = 1;
    masu_pacing_shown(&p, frame++, now, REFRESH);
    return 0;
}

/* One frame that is expected to take `ms`, shown `late` refreshes after its time. */
static uint32_t one(double ms, uint32_t late) {
    masu_pacing_choose(&p, frame, ms, MS, 0);
    uint32_t refreshes = p.refreshes;
    now += (uint64_t)REFRESH * (last + late);
    last = refreshes;
    int was_late = masu_pacing_shown(&p, frame, now, REFRESH);
    assert_int_equal(was_late, late && frame > 1);
    frame++;
    return refreshes;
}

/* Number of frames of `ms` until the choice changes; at most `most`. */
static uint32_t until_other(double ms, uint32_t most) {
    uint32_t before = p.refreshes, n = 0;
    do n++;
    while (one(ms, 0) == before && n < most);
    return n;
}

static void without_a_display_it_says_nothing(void **state) {
    (void)state;
    masu_pacing none = {0};
    masu_pacing_choose(&none, 1, 5, 16, 0);
    assert_int_equal(none.refreshes, 0);
    assert_true(masu_pacing_target(&none, 20) == 20);
    assert_true(fabs(masu_pacing_target(&p, 17) - MS) < 1e-9); /* frames are to fit into one */
    assert_true(masu_pacing_target(&p, 10) == 10);
}

static void it_rises_when_frames_want_more_and_falls_a_second_after(void **state) {
    (void)state;
    assert_int_equal(one(10, 0), 1);
    assert_int_equal(until_other(20, 100), 4);
    assert_int_equal(p.refreshes, 2);
    /* the possible mistake is long ago */
    for (int i = 0; i < 500; i++) assert_int_equal(one(20, 0), 2);
    for (int i = 0; i < 300; i++) assert_int_equal(one(16, 0), 2); /* it fits, without margin */
    assert_int_equal(until_other(10, 1000), 60);
    assert_int_equal(p.refreshes, 1);
}

/* Each mistaken fall doubles the next wait, up to sixteen times. */
static void it_does_not_alternate(void **state) {
    (void)state;
    uint32_t wait = 60;
    assert_int_equal(one(20, 0), 2);
    for (int i = 0; i < 7; i++) {
        assert_int_equal(until_other(10, 10000), wait);
        assert_int_equal(p.refreshes, 1);
        assert_int_equal(until_other(20, 10000), 4);
        assert_int_equal(p.refreshes, 2);
        wait = wait < 16 * 60 ? 2 * wait : wait;
    }
    assert_int_equal(until_other(10, 10000), wait);
    for (int i = 0; i < 240; i++) one(10, 0);
    assert_int_equal(until_other(20, 10000), 4); /* after so long, it was correct */
    assert_int_equal(until_other(10, 10000), 60);
}

static void it_rises_when_frames_come_late(void **state) {
    (void)state;
    for (int i = 0; i < 40; i++) one(10, 0);
    /* three of sixteen are tolerated */
    for (int i = 0; i < 60; i++) assert_int_equal(one(10, i % 6 == 0), 1);
    for (int i = 0; i < 16; i++) assert_int_equal(one(10, 0), 1);
    for (int i = 0; i < 4; i++) assert_int_equal(one(10, 1), 1);
    assert_int_equal(one(10, 0), 2);
}

static void no_number_upsets_it(void **state) {
    (void)state;
    const double numbers[] = {0,          -1, 1e-300, 1e300, (double)INFINITY, -(double)INFINITY,
                              (double)NAN};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
            for (int n = 0; n < 5; n++)
                masu_pacing_choose(&p, frame++, numbers[i], numbers[k], n == 3);
            assert_in_range(p.refreshes, 1, MASU_REFRESHES_MOST);
        }
    }
    masu_pacing_choose(&p, UINT64_MAX, 10, MS, 0);
    assert_int_equal(masu_pacing_shown(&p, UINT64_MAX, UINT64_MAX, REFRESH), 0);
    /* no refresh lasts a nanosecond: the state is cleared */
    assert_int_equal(masu_pacing_shown(&p, 3, 5, 1), 0);
    assert_true(p.refresh == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(without_a_display_it_says_nothing, start),
        cmocka_unit_test_setup(it_rises_when_frames_want_more_and_falls_a_second_after, start),
        cmocka_unit_test_setup(it_does_not_alternate, start),
        cmocka_unit_test_setup(it_rises_when_frames_come_late, start),
        cmocka_unit_test_setup(no_number_upsets_it, start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
