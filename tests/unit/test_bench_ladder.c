/* test_bench_ladder.c: Pareto fronts and ladders of random clouds, checked against their
 * definition; ties, values that are not numbers, single points; and the table of rows written as
 * CSV and read back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "settings/ladder.h"
#include "bench/table.h"
#include "support/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 96, CLOUDS = 400, MOST = 8 };

static bool usable(masu_ladder_point p) {
    return isfinite(p.time) && isfinite(p.error) && p.time > 0 && p.error >= 0;
}

/* Every other cloud is on a coarse grid, for many ties. In every third, slower points tend to be
 * better, for long fronts. A few values are invalid. */
static uint32_t cloud(uint64_t seed, masu_ladder_point *out) {
    uint64_t state = seed;
    uint32_t n = (uint32_t)support_random_in(&state, 1, POINTS);
    uint64_t steps = seed % 2 ? 12 : 100000;
    for (uint32_t i = 0; i < n; i++) {
        out[i].time = 1.0 + (double)support_random_in(&state, 0, steps) / (double)steps;
        out[i].error = (double)support_random_in(&state, 0, steps) / (double)steps;
        if (seed % 3 == 0) out[i].error = 0.1 * out[i].error + 2.0 - out[i].time;
        switch (support_random_in(&state, 0, 40)) {
        case 0: out[i].time = (double)NAN; break;
        case 1: out[i].error = (double)NAN; break;
        case 2: out[i].time = HUGE_VAL; break;
        case 3: out[i].time = 0.0; break;
        case 4: out[i].error = -1.0; break;
        case 5: out[i].time = -1.0; break;
        default: break;
        }
    }
    return n;
}

static bool holds(const uint32_t *list, uint32_t n, uint32_t index) {
    for (uint32_t i = 0; i < n; i++) {
        if (list[i] == index) return true;
    }
    return false;
}

static void the_front_is_all_that_nothing_dominates(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= CLOUDS; seed++) {
        masu_ladder_point p[POINTS];
        uint32_t front[POINTS], n = cloud(seed, p), count = masu_ladder_front(p, n, front);
        for (uint32_t i = 0; i < count; i++) {
            assert_true(usable(p[front[i]]));
            if (i) assert_true(p[front[i]].time > p[front[i - 1]].time);
            if (i) assert_true(p[front[i]].error < p[front[i - 1]].error);
        }
        for (uint32_t i = 0; i < n; i++) {
            if (!usable(p[i])) continue;
            bool beaten = false; /* by one at least as good in both */
            for (uint32_t k = 0; k < count; k++)
                beaten |= p[front[k]].time <= p[i].time && p[front[k]].error <= p[i].error;
            if (!beaten) fail_msg("cloud %u: nothing on the front beats %u", (unsigned)seed, i);
            if (!holds(front, count, i)) continue;
            for (uint32_t k = 0; k < n; k++) assert_false(masu_ladder_dominates(p[k], p[i]));
        }
    }
}

static void rungs_fall_in_time_and_rise_in_error(void **state) {
    (void)state;
    uint32_t longest = 0;
    for (uint64_t seed = 1; seed <= CLOUDS; seed++) {
        masu_ladder_point p[POINTS];
        uint32_t front[POINTS], rungs[POINTS], n = cloud(seed, p);
        uint32_t all = masu_ladder_front(p, n, front);
        uint32_t count = masu_ladder_rungs(p, n, MASU_LADDER_APART, 1.0, MOST, rungs);
        assert_true(count <= MOST && count <= all && (count > 0) == (all > 0));
        if (count > longest) longest = count;
        if (!count) continue;
        for (uint32_t i = 0; i < count; i++) assert_true(holds(front, all, rungs[i]));
        for (uint32_t i = 1; i < count; i++) {
            assert_true(p[rungs[i - 1]].time >= MASU_LADDER_APART * p[rungs[i]].time);
            assert_true(p[rungs[i - 1]].error < p[rungs[i]].error);
        }
        uint32_t best = front[all - 1], quickest = front[0];
        assert_int_equal(rungs[0], best);
        if (p[best].time >= MASU_LADDER_APART * p[quickest].time)
            assert_int_equal(rungs[count - 1], quickest);
        else
            assert_int_equal(count, 1);
    }
    assert_int_equal(longest, MOST); /* the clouds are wide enough to fill a ladder */
}

/* With enough room, and no minimum distance, the result is the whole front. */
static void nothing_is_left_out_without_need(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        masu_ladder_point p[POINTS];
        uint32_t front[POINTS], rungs[POINTS], n = cloud(seed, p);
        uint32_t all = masu_ladder_front(p, n, front);
        assert_int_equal(masu_ladder_rungs(p, n, 1.0, 1.0, POINTS, rungs), all);
        for (uint32_t i = 0; i < all; i++) assert_int_equal(rungs[i], front[all - 1 - i]);
    }
}

static void the_nearest_neighbours_go_first(void **state) {
    (void)state;
    const masu_ladder_point p[] = {{8, 0.1}, {4, 0.2}, {3.8, 0.25}, {2, 0.3}, {1, 0.4}};
    uint32_t rungs[5];
    assert_int_equal(masu_ladder_rungs(p, 5, MASU_LADDER_APART, 1.0, 4, rungs), 4);
    const uint32_t wanted[] = {0, 1, 3, 4}; /* 4 / 2 is less than 8 / 3.8: so 3.8 is dropped */
    assert_memory_equal(rungs, wanted, sizeof wanted);
    assert_int_equal(masu_ladder_rungs(p, 5, MASU_LADDER_APART, 1.0, 2, rungs), 2);
    assert_true(rungs[0] == 0 && rungs[1] == 4);
    assert_int_equal(masu_ladder_rungs(p, 5, MASU_LADDER_APART, 1.0, 1, rungs), 1);
    assert_int_equal(rungs[0], 0);
    assert_int_equal(masu_ladder_rungs(p, 5, MASU_LADDER_APART, 1.0, 0, rungs), 0);
}

/* By definition: each kept point is better by the distance than every faster one; each dropped
 * point has a faster one that is hardly worse. */
static void hardly_better_is_no_reason_to_take_longer(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= CLOUDS; seed++) {
        masu_ladder_point p[POINTS];
        uint32_t front[POINTS], rungs[POINTS], n = POINTS;
        uint64_t r = seed;
        for (uint32_t i = 0; i < n; i++) {
            p[i].time = 1 + (double)(support_random(&r) % 1000) / 100;
            p[i].error = 1 / p[i].time + (double)(support_random(&r) % 1000) / 1e5;
        }
        uint32_t all = masu_ladder_front(p, n, front);
        uint32_t kept = masu_ladder_rungs(p, n, 1.0, 1.05, POINTS, rungs);
        assert_true(kept <= all && rungs[kept - 1] == front[0]);
        for (uint32_t i = 1; i < kept; i++)
            assert_true(1.05 * p[rungs[i - 1]].error <= p[rungs[i]].error);
        for (uint32_t f = 0; f < all; f++) {
            bool stays = false, hardly = false;
            for (uint32_t i = 0; i < kept; i++) {
                stays = stays || rungs[i] == front[f];
                hardly = hardly || (p[rungs[i]].time < p[front[f]].time &&
                                    1.05 * p[front[f]].error > p[rungs[i]].error);
            }
            assert_true(stays != hardly);
        }
    }
}

/* With several costs: kept points are not dominated in any column; dropped points are, in one. */
static void what_another_dominates_by_any_cost_is_excluded(void **state) {
    (void)state;
    enum { COLUMNS = 3 };
    static masu_ladder_point p[POINTS], left[POINTS];
    static double costs[POINTS * COLUMNS];
    uint32_t gone = 0, stay = 0;
    for (uint64_t seed = 1; seed <= CLOUDS; seed++) {
        uint64_t r = seed;
        uint32_t n = cloud(seed, p);
        /* Similar in all columns, so that some points are on all fronts. */
        for (uint32_t i = 0; i < n; i++) {
            for (uint32_t c = 0; c < COLUMNS; c++)
                costs[i * COLUMNS + c] =
                    2.0 - p[i].error + 0.2 * (double)support_random_in(&r, 0, 100) / 100;
            if (support_random_in(&r, 0, 30) == 0) costs[i * COLUMNS + 1] = 0.0;
        }
        memcpy(left, p, sizeof p);
        masu_ladder_exclude(left, n, costs, COLUMNS);
        for (uint32_t i = 0; i < n; i++) {
            bool whole = usable(p[i]) && costs[i * COLUMNS + 1] > 0.0, dominated = false;
            for (uint32_t k = 0; k < n; k++) {
                if (!usable(p[k]) || !(costs[k * COLUMNS + 1] > 0.0)) continue;
                for (uint32_t c = 0; c < COLUMNS; c++) {
                    dominated |= costs[k * COLUMNS + c] <= costs[i * COLUMNS + c] &&
                                 p[k].error <= p[i].error &&
                                 (costs[k * COLUMNS + c] < costs[i * COLUMNS + c] ||
                                  p[k].error < p[i].error);
                }
            }
            assert_int_equal(usable(left[i]), whole && !dominated);
            if (usable(left[i]))
                assert_true(!(left[i].time < p[i].time) && !(left[i].time > p[i].time));
            gone += whole && dominated;
            stay += whole && !dominated;
        }
    }
    assert_true(gone > 100 && stay > 100);
}

static void ties_are_broken_and_points_that_are_none_left_out(void **state) {
    (void)state;
    const masu_ladder_point equal[] = {{1, 1}, {1, 1}, {1, 1}}, zero = {1, 0};
    const masu_ladder_point time[] = {{1, 0.5}, {1, 0.25}}, error[] = {{2, 0.5}, {1, 0.5}};
    const masu_ladder_point none[] = {{(double)NAN, (double)NAN}, {-1, 0}, {1, HUGE_VAL}};
    uint32_t out[3];
    assert_int_equal(masu_ladder_front(equal, 3, out), 1);
    assert_int_equal(out[0], 0);
    assert_int_equal(masu_ladder_front(time, 2, out), 1);
    assert_int_equal(out[0], 1);
    assert_int_equal(masu_ladder_front(error, 2, out), 1);
    assert_int_equal(out[0], 1);
    assert_int_equal(masu_ladder_rungs(&zero, 1, MASU_LADDER_APART, 1.0, MOST, out), 1);
    assert_int_equal(masu_ladder_rungs(none, 3, MASU_LADDER_APART, 1.0, MOST, out), 0);
    assert_int_equal(masu_ladder_rungs(none, 0, MASU_LADDER_APART, 1.0, MOST, out), 0);
    assert_false(masu_ladder_dominates(equal[0], equal[1]));
    assert_false(masu_ladder_dominates(none[0], zero));
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static masu_row random_row(uint64_t *state, uint32_t i) {
    masu_row row;
    memset(&row, 0, sizeof row);
    snprintf(row.setting, sizeof row.setting, "scale=0.%u+ao=off", i);
    snprintf(row.parent, sizeof row.parent, "base");
    snprintf(row.technique, sizeof row.technique, "ao");
    double *number = &row.render_width;
    for (; number <= &row.fast_flip; number++)
        *number = ldexp((double)support_random_in(state, 1, 1000000000), (int)(i % 40) - 60);
    if (i % 5 == 0) row.psnr_db = HUGE_VAL;
    if (i % 7 == 0) row.gpu_ratio = (double)NAN;
    return row;
}

static void same_number(double a, double b) {
    if (isnan(a) ? !isnan(b) : isinf(a) ? a != b : !(fabs(a - b) <= 1e-8 * fabs(a)))
        fail_msg("%.17g became %.17g", a, b);
}

static void rows_come_back_as_they_were_written(void **state) {
    (void)state;
    enum { ROWS = 64 };
    static masu_row rows[ROWS];
    static char text[1 << 16], again[1 << 16], error[256];
    uint64_t seed = 3;
    FILE *f = tmpfile();
    assert_non_null(f);
    assert_true(masu_rows_header(f) > 0);
    for (uint32_t i = 0; i < ROWS; i++) {
        rows[i] = random_row(&seed, i);
        assert_true(masu_rows_write(f, &rows[i]) > 0);
    }
    rewind(f);
    size_t n = fread(text, 1, sizeof text - 1, f);
    fclose(f);
    uint32_t count;
    masu_row *read = masu_rows_read(text, &count, error, sizeof error);
    assert_non_null(read);
    assert_int_equal(count, ROWS);
    f = tmpfile();
    assert_non_null(f);
    masu_rows_header(f);
    for (uint32_t i = 0; i < ROWS; i++) {
        assert_string_equal(read[i].setting, rows[i].setting);
        assert_string_equal(read[i].parent, "base");
        assert_string_equal(read[i].technique, "ao");
        const double *a = &rows[i].render_width, *b = &read[i].render_width;
        for (; a <= &rows[i].fast_flip; a++, b++) same_number(*a, *b);
        masu_rows_write(f, &read[i]);
    }
    assert_ptr_equal(masu_rows_find(read, count, rows[9].setting), &read[9]);
    assert_null(masu_rows_find(read, count, "scale=9"));
    free(read);
    rewind(f);
    assert_int_equal(fread(again, 1, sizeof again - 1, f), n);
    fclose(f);
    assert_string_equal(text, again);
    /* Truncated at any byte of the last row: only that row is lost. */
    size_t last = n - 1;
    while (text[last - 1] != '\n') last--;
    for (size_t cut = last; cut < n; cut++) {
        text[cut] = 0;
        memcpy(text + last, again + last, cut - last);
        read = masu_rows_read(text, &count, error, sizeof error);
        assert_non_null(read);
        assert_int_equal(count, ROWS - 1);
        free(read);
        text[cut] = again[cut];
    }
}

/* A folder of an older version has two columns less: they are unknown, and the ladder uses the
 * others. */
static void a_table_of_before_is_read(void **state) {
    (void)state;
    static char text[1 << 14], old[1 << 14], error[256];
    uint64_t seed = 5;
    masu_row row = random_row(&seed, 0);
    row.flip = 0.25, row.rest_flip = 0.125;
    same_number(masu_row_error(&row), 0.1875);
    FILE *f = tmpfile();
    assert_non_null(f);
    masu_rows_header(f);
    masu_rows_write(f, &row);
    rewind(f);
    assert_true(fread(text, 1, sizeof text - 1, f) > 0);
    fclose(f);
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        for (int k = 0; k < 3; k++) *strrchr(line, ',') = 0;
        strcat(strcat(old, line), "\n");
    }
    uint32_t count;
    masu_row *read = masu_rows_read(old, &count, error, sizeof error);
    assert_non_null(read);
    assert_int_equal(count, 1);
    assert_true(isnan(read->rest_flip) && isnan(read->fast_flip));
    same_number(read->specular_relmse, row.specular_relmse);
    same_number(masu_row_error(read), 0.25);
    free(read);
    strcat(old, "base,base,scale,1,2\n");
    assert_null(masu_rows_read(old, &count, error, sizeof error));
    assert_non_null(strstr(error, "line 3"));
}

static void what_is_no_table_is_refused(void **state) {
    (void)state;
    char header[1024] = "", text[4096], error[256];
    uint32_t count;
    FILE *f = tmpfile();
    assert_non_null(f);
    masu_rows_header(f);
    rewind(f);
    assert_non_null(fgets(header, sizeof header, f));
    fclose(f);
    masu_row *rows = masu_rows_read(header, &count, error, sizeof error);
    assert_non_null(rows);
    assert_int_equal(count, 0);
    free(rows);
    assert_null(masu_rows_read("", &count, error, sizeof error));
    assert_null(masu_rows_read("setting,parent\n", &count, error, sizeof error));
    assert_non_null(strstr(error, "columns"));
    static const char *const bad[] = {"", "base", "base,base,scale,1,2",
                                      "a,b,c,,,,,,,,,,,,,,,,,,,"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, sizeof text, "%s%s\n", header, bad[i]);
        assert_null(masu_rows_read(text, &count, error, sizeof error));
        assert_non_null(strstr(error, "line 2"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_front_is_all_that_nothing_dominates),
        cmocka_unit_test(rungs_fall_in_time_and_rise_in_error),
        cmocka_unit_test(nothing_is_left_out_without_need),
        cmocka_unit_test(the_nearest_neighbours_go_first),
        cmocka_unit_test(hardly_better_is_no_reason_to_take_longer),
        cmocka_unit_test(what_another_dominates_by_any_cost_is_excluded),
        cmocka_unit_test(ties_are_broken_and_points_that_are_none_left_out),
        cmocka_unit_test(rows_come_back_as_they_were_written),
        cmocka_unit_test(a_table_of_before_is_read),
        cmocka_unit_test(what_is_no_table_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
