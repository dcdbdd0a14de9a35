/* test_bench_labels.c: labels of the charts of `masu bench`: none covers another, a mark or the
 * border. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/labels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static masu_labels chart(void) {
    return (masu_labels){.low = {0.1, 0.001}, .high = {10, 0.1}, .size = {800, 500}};
}

static void a_lone_label_is_right_of_its_point(void **state) {
    (void)state;
    static masu_labels l;
    l = chart();
    double out[2];
    assert_true(masu_labels_place(&l, (const double[]){1, 0.01}, "name", 10, out));
    assert_float_equal(out[0], pow(10, 7 / 400.0), 1e-9); /* 0.7 of the font's height */
    assert_float_equal(out[1], 0.01, 1e-9);
}

static void labels_never_cover_each_other(void **state) {
    (void)state;
    static masu_labels l;
    uint32_t placed = 0, random = 1;
    l = chart();
    masu_labels_mark(&l, (const double[]){1, 0.01}, 8);
    for (uint32_t i = 0; i < 300; i++) {
        double at[2], out[2];
        char text[16];
        for (int k = 0; k < 2; k++) {
            random = random * 1664525u + 1013904223u;
            at[k] = l.low[k] * pow(100, 0.35 + 0.3 * (random >> 8) / 16777216.0);
        }
        snprintf(text, sizeof text, "label %u", i);
        placed += masu_labels_place(&l, at, text, 9, out);
    }
    assert_true(placed > 60 && placed < 300); /* of 240x150 pixels, a label covers at most 49x9 */
    assert_int_equal(l.count, 1 + placed);
    for (uint32_t i = 0; i < l.count; i++) {
        const struct masu_label_box *a = &l.boxes[i];
        assert_true(a->low[0] >= 0 && a->low[1] >= 0 && a->high[0] <= 800 && a->high[1] <= 500);
        for (uint32_t k = 0; k < i; k++) {
            const struct masu_label_box *b = &l.boxes[k];
            assert_false(a->low[0] < b->high[0] && b->low[0] < a->high[0] &&
                         a->low[1] < b->high[1] && b->low[1] < a->high[1]);
        }
    }
}

/* A line blocks every place that it comes near, and no other. */
static void labels_keep_away_from_lines(void **state) {
    (void)state;
    static masu_labels l;
    const double at[2] = {1, 0.01}, right[2] = {2, 0.01}, far[2] = {9, 0.09};
    double out[2];
    l = chart();
    masu_labels_line(&l, at, right); /* to the right, where a label is if nothing is in its way */
    assert_true(masu_labels_place(&l, at, "name", 10, out));
    assert_true(out[1] > 0.01); /* above the line */
    l = chart();
    masu_labels_line(&l, (const double[]){1.5, 0.0011}, (const double[]){1.5, 0.099}); /* apart */
    masu_labels_line(&l, far, far);
    assert_true(masu_labels_place(&l, at, "name", 10, out));
    assert_float_equal(out[1], 0.01, 1e-9);
    l = chart(); /* through the text: 7 to 31 pixels right of the point, and 2 of distance */
    const double inside = pow(10, 32.5 / 400), outside = pow(10, 33.5 / 400);
    masu_labels_line(&l, (const double[]){outside, 0.002}, (const double[]){outside, 0.09});
    assert_true(masu_labels_place(&l, at, "name", 10, out) && fabs(out[1] - 0.01) < 1e-9);
    l = chart();
    masu_labels_line(&l, (const double[]){inside, 0.002}, (const double[]){inside, 0.09});
    assert_true(masu_labels_place(&l, at, "name", 10, out));
    assert_true(out[0] < 1); /* all places to the right are taken */
}

/* Near the right border a label is left of its point; one longer than the chart has no place. */
static void labels_stay_within_the_chart(void **state) {
    (void)state;
    static masu_labels l;
    double out[2];
    l = chart();
    assert_true(masu_labels_place(&l, (const double[]){9.9, 0.01}, "a name", 10, out));
    assert_true(out[0] < 9.9);
    char longest[200];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    assert_false(masu_labels_place(&l, (const double[]){1, 0.05}, longest, 10, out));
    while (l.count < MASU_LABELS_MAX) masu_labels_mark(&l, (const double[]){0.2, 0.002}, 1);
    assert_false(masu_labels_place(&l, (const double[]){1, 0.05}, "late", 10, out));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lone_label_is_right_of_its_point),
        cmocka_unit_test(labels_never_cover_each_other),
        cmocka_unit_test(labels_keep_away_from_lines),
        cmocka_unit_test(labels_stay_within_the_chart),
    };
    return cmocka_run_group_tests_name("bench_labels", tests, NULL, NULL);
}
