/* test_bench_rungs.c: selects settings of a folder of `masu bench` as rungs, from images and costs
 * that are made here: no rung differs too much from the one before, and none is dominated on a
 * class of GPUs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/costs.h"
#include "bench/report.h"
#include "image.h"
#include "settings/ladder.h"
#include "settings/ladder_file.h"
#include "support/files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { SIDE = 8 };

/* By falling quality; grey values of the images in motion and of stills. */
static const struct {
    const char *setting;
    uint8_t motion, rest;
} made[] = {
    {"base", 100, 100}, {"scale=0.75", 180, 102}, {"scale=0.5", 101, 120}, {"scale=0.4", 103, 105}};
enum { MADE = sizeof made / sizeof *made };

static void make_picture(const char *setting, const char *suffix, uint8_t gray) {
    uint8_t rgba[SIDE * SIDE * 4];
    char name[256], error[512];
    memset(rgba, gray, sizeof rgba);
    snprintf(name, sizeof name, "f/pictures/%s%s.png", setting, suffix);
    if (!masu_image_save_png(in_scratch(name), rgba, SIDE, SIDE, 0, error, sizeof error))
        fail_msg("%s", error);
}

static void make_folder(void) {
    mkdir(in_scratch("f"), 0777);
    mkdir(in_scratch("f/pictures"), 0777);
    (void)remove(in_scratch("f/" MASU_COSTS));
    FILE *sweep = fopen(in_scratch("f/sweep.json"), "w"),
         *rows = fopen(in_scratch("f/results.csv"), "w");
    assert_true(sweep && rows);
    fprintf(sweep,
            "{\"scene\": \"a.masu\", \"hash\": \"0\", \"driver\": \"D\", \"depth\": \"-\", "
            "\"width\": %d, \"height\": "
            "%d, \"time\": 1.0, \"dropped\": [], \"settings\": [",
            SIDE, SIDE);
    assert_true(masu_rows_header(rows) > 0);
    for (int i = 0; i < MADE; i++) {
        masu_row row;
        memset(&row, 0, sizeof row);
        snprintf(row.setting, sizeof row.setting, "%s", made[i].setting);
        snprintf(row.parent, sizeof row.parent, "base");
        snprintf(row.technique, sizeof row.technique, "scale");
        row.ratio = row.gpu_ratio = 1.0 - 0.2 * i;
        row.flip = row.rest_flip = 0.1 * (i + 1);
        if (made[i].rest != made[i].motion) row.rest_flip += 0.001;
        assert_true(masu_rows_write(rows, &row) > 0);
        fprintf(sweep, "%s{\"setting\": \"%s\", \"knobs\": {\"scale\": %g}}", i ? ", " : "",
                made[i].setting, 1.0 - 0.1 * i);
        make_picture(made[i].setting, "", made[i].motion);
        if (made[i].rest != made[i].motion) make_picture(made[i].setting, ".rest", made[i].rest);
    }
    fprintf(sweep, "]}");
    assert_true(!fclose(sweep) && !fclose(rows));
    make_picture("../truth", "", 100);
}

static void expect(const char *const *settings, const double *steps, uint32_t count) {
    char error[1024], path[256];
    masu_report_result result;
    masu_ladder_file l;
    snprintf(path, sizeof path, "%s", in_scratch("f"));
    if (!masu_report_write(path, &result, error, sizeof error)) fail_msg("%s", error);
    if (!masu_ladder_read(in_scratch("f/ladder.json"), &l, error, sizeof error))
        fail_msg("%s", error);
    assert_int_equal(l.count, count);
    assert_int_equal(result.rungs, count);
    for (uint32_t i = 0; i < count; i++) {
        assert_string_equal(l.settings[i], settings[i]);
        assert_true(i && steps[i] >= 0.0 ? fabs(l.steps[i] - steps[i]) < 1e-6 : l.steps[i] < 0.0);
    }
}

/* scale=0.5 changes the still by 18 of 255; 0.4 is close to 0.75, whatever the images in motion
 * show. */
static void a_jump_is_no_rung(void **state) {
    (void)state;
    static const char *const settings[] = {"base", "scale=0.75", "scale=0.4"};
    const double steps[] = {0, 2, 3};
    make_folder();
    expect(settings, steps, 3);
    /* Without stills the steps are unknown, and no setting is dropped: images in motion do not
     * replace them. */
    for (int i = 0; i < MADE; i++) {
        char name[256];
        snprintf(name, sizeof name, "f/pictures/%s.rest.png", made[i].setting);
        (void)remove(in_scratch(name));
    }
    static const char *const all[] = {"base", "scale=0.75", "scale=0.5", "scale=0.4"};
    const double unknown[] = {-1, -1, -1, -1};
    expect(all, unknown, 4);
}

static void what_a_class_of_gpus_has_nearer_and_cheaper_is_no_rung(void **state) {
    (void)state;
    static const char *const settings[] = {"base", "scale=0.4"};
    const double steps[] = {0, 1};
    char error[1024], path[256];
    masu_setting_list list;
    make_folder();
    make_picture("scale=0.4", ".rest", 101);
    /* On one class 0.75 costs more than the base; 0.5 has no costs. */
    write_text("f/" MASU_COSTS,
               MASU_COSTS_HEADER "\nbase,9,9,9,9,9\nscale=0.75,8,8,9.5,8,8\nscale=0.4,5,5,5,5,5\n");
    expect(settings, steps, 2);
    masu_ladder_file l;
    assert_true(masu_ladder_read(in_scratch("f/ladder.json"), &l, error, sizeof error));
    assert_true(fabs(l.ratios[0] - 1.0) < 1e-9 && fabs(l.ratios[1] - 5.0 / 9.0) < 1e-9);
    assert_string_equal(l.clock, "computed costs");
    static const char *const bad[] = {"",
                                      "setting,a\n",
                                      MASU_COSTS_HEADER "\nbase,1,2,3,4\n",
                                      MASU_COSTS_HEADER "\nbase,1,2,3,4,5,6\n",
                                      MASU_COSTS_HEADER "\nbase,1,2,3,4,nan\n",
                                      MASU_COSTS_HEADER "\nbase,1,2,3,4,0\n",
                                      MASU_COSTS_HEADER "\nbase,1,2,3,4,5"};
    snprintf(path, sizeof path, "%s", in_scratch("f"));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_text("f/" MASU_COSTS, bad[i]);
        assert_false(masu_report_rungs(path, &list, error, sizeof error));
        assert_non_null(strstr(error, "costs.csv: line "));
        assert_null(strchr(error, '\n'));
    }
    write_text("f/" MASU_COSTS, MASU_COSTS_HEADER "\nscale=0.4,5,5,5,5,5\n");
    assert_false(masu_report_rungs(path, &list, error, sizeof error));
    assert_non_null(strstr(error, "no costs of the base"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_jump_is_no_rung),
        cmocka_unit_test(what_a_class_of_gpus_has_nearer_and_cheaper_is_no_rung),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
