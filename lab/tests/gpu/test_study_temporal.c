/* test_study_temporal.c: `masu-lab study temporal`: with history an image has a lower error than
 * without; rows and CSV are as requested, and mistakes are reported. */
#include "support/cli.h"
#include "support/files.h"
#include "support/support.h"

#include "lab/study/temporal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 96, HEIGHT = 64 };

static masu_past past;

static const masu_past_row *row(double scale, masu_past_way way) {
    for (uint32_t i = 0; i < past.row_count; i++) {
        const masu_past_row *r = &past.rows[i];
        if (r->way == way && r->scale > scale - 0.01 && r->scale < scale + 0.01) return r;
    }
    fail_msg("no row of %s at %g", masu_past_ways[way], scale);
    return NULL;
}

static void a_past_brings_a_picture_nearer_to_the_truth(void **state) {
    (void)state;
    char error[ERROR_SIZE] = "";
    masu_session_desc validated = test_desc("test_town", WIDTH, HEIGHT);
    const masu_past_desc d = {.scene_path = scene_path("test_town"),
                              .size = {WIDTH, HEIGHT},
                              .time = 1.5,
                              .positions = 16,
                              .rays = 16,
                              .frames = 24,
                              .fast_frames = 5,
                              .scales = {1.0, 0.5},
                              .scale_count = 2,
                              .host = validated.host};
    assert_ok(masu_past_run(&d, &past, error, sizeof error));
    assert_int_equal(past.messages, 0);
    assert_int_equal(past.row_count, 2 * MASU_PAST_WAYS);
    for (uint32_t i = 0; i < past.row_count; i++) {
        const masu_past_row *r = &past.rows[i];
        print_message("  %g %s: %.4f %.4f %.4f, flicker %.3f %.3f\n", r->scale,
                      masu_past_ways[r->way], r->flip[0], r->flip[1], r->flip[2], r->flicker[0],
                      r->flicker[1]);
        assert_int_equal(r->render_width, (uint32_t)(r->scale * WIDTH));
        assert_int_equal(r->render_height, (uint32_t)(r->scale * HEIGHT));
    }
    for (uint32_t i = 0; i < d.scale_count; i++) {
        const masu_past_row *none = row(d.scales[i], MASU_PAST_NONE);
        const masu_past_row *own = row(d.scales[i], MASU_PAST_OWN);
        for (int m = 0; m < MASU_PAST_FAST; m++) assert_true(own->flip[m] < 0.8 * none->flip[m]);
        assert_true(none->flicker[MASU_PAST_REST] < 1e-9);
        assert_true(fabs(none->flip[MASU_PAST_REST] - none->flip[MASU_PAST_SLOW]) < 1e-9);
    }
    /* Motion increases the error. */
    const masu_past_row first = *row(0.5, MASU_PAST_OWN), *own = &first;
    assert_true(own->flip[MASU_PAST_REST] < 0.8 * own->flip[MASU_PAST_SLOW]);
    assert_true(own->flip[MASU_PAST_SLOW] < own->flip[MASU_PAST_FAST]);
    /* The mean of two starts: this one, and one with five more frames. */
    masu_past_desc one = d, two = d;
    one.only = two.only = 1u << MASU_PAST_OWN;
    one.scales[0] = two.scales[0] = 0.5, one.scale_count = two.scale_count = 1;
    two.starts = 2;
    assert_ok(masu_past_run(&two, &past, error, sizeof error));
    double mean = past.rows[0].flip[MASU_PAST_SLOW];
    assert_true(fabs(mean - first.flip[MASU_PAST_SLOW]) < 0.1 * mean);
    assert_true(fabs(mean - first.flip[MASU_PAST_SLOW]) > 1e-6); /* it includes another image */
    assert_ok(masu_past_run(&one, &past, error, sizeof error));
    assert_true(fabs(past.rows[0].flip[MASU_PAST_SLOW] - first.flip[MASU_PAST_SLOW]) < 1e-9);
}

static void the_table_is_told_as_it_is_asked_for(void **state) {
    (void)state;
    static const struct {
        const char *arguments, *says;
    } mistakes[] = {{"%s --only ours", "ours"},
                    {"%s --scales 0.5,2", "0.5,2"},
                    {"", "no scene"},
                    {"%s --fast-frames 0", "--fast-frames"},
                    {"%s --frames 1", "--frames"},
                    {"%s --starts 0", "--starts"}};
    const char *good = scene_path("test_town");
    int code = cli_run(
        "study temporal %s --size 32x24 --positions 2 --reference 2 --frames 2 --fast-frames 2 "
        "--scales 0.5 --only temporal --quiet --csv %s/rows.csv",
        good, scratch);
    if (code) fail_msg("exit code %d, %s", code, cli_err);
    char *csv = read_file(in_scratch("rows.csv"), NULL);
    assert_non_null(strstr(csv, "scene,width,height,"));
    assert_non_null(strstr(csv, ",0.5,temporal,16,12,"));
    assert_null(strstr(csv, ",without,"));
    free(csv);
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        const char *at = strstr(mistakes[i].arguments, "%s");
        assert_int_equal(cli_run("study temporal %s%s", at ? good : "", at ? at + 2 : ""), 2);
        cli_complained(mistakes[i].says);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_past_brings_a_picture_nearer_to_the_truth),
        cmocka_unit_test(the_table_is_told_as_it_is_asked_for),
    };
    cli_program = "masu-lab";
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
