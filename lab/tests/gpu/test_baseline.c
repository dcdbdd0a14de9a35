/* test_baseline.c: `masu-lab study baseline`: the baseline traces one ray per pixel and Masu one
 * per four pixels; its mean over many samples is the ground truth; the sample counts of equal error
 * are right; earlier frames matter more with a still camera than in motion; invalid settings are
 * errors. */
#include "support/support.h"
#include "support/cli.h"

#include "measure/motion.h"
#include "lab/study/baseline.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 60, HEIGHT = 36 };

static masu_baseline baseline;

static void run(masu_baseline_desc d, const char *scene, const char *const *settings) {
    char error[ERROR_SIZE] = "";
    masu_rung rungs[MASU_BASELINE_SETTINGS];
    masu_session_desc validated = test_desc(scene, WIDTH, HEIGHT);
    for (; settings[d.rung_count]; d.rung_count++)
        assert_ok(
            masu_setting_parse(settings[d.rung_count], &rungs[d.rung_count], error, sizeof error));
    d.scene_path = scene_path(scene);
    d.size = (VkExtent2D){WIDTH, HEIGHT};
    d.rungs = rungs;
    d.host = validated.host;
    assert_ok(masu_baseline_run(&d, &baseline, error, sizeof error));
    assert_int_equal(baseline.messages, 0);
}

static const masu_baseline_point *point(uint32_t k) {
    for (uint32_t i = 0; i < baseline.point_count; i++) {
        if (baseline.points[i].samples == k) return &baseline.points[i];
    }
    fail_msg("no point for %u samples", k);
    return NULL;
}

/* The mirror fills the image; its textures require a renderer for each sample count. */
static void a_ray_a_pixel_is_measured_beside_one_in_four(void **state) {
    (void)state;
    static const char *const settings[] = {"base", "scale=0.5+sharpen=off", NULL};
    run((masu_baseline_desc){
            .positions = 4, .rays = 4, .frames = 2, .step = MASU_MOTION_STEP, .runs = 2, .most = 1},
        "test_mirror_plain", settings);
    assert_int_equal(baseline.plain_count, 1);
    assert_int_equal(baseline.entry_count, 3);
    assert_string_equal(baseline.march, "none");
    const uint64_t pixels = WIDTH * HEIGHT;
    assert_int_equal(baseline.entries[0].specular_rays, pixels);
    assert_int_equal(baseline.entries[1].specular_rays, pixels / 4);
    assert_int_equal(baseline.entries[2].specular_rays, pixels / 16);
    assert_int_equal(baseline.entries[2].render.width, WIDTH / 2);
    /* Only the plain renderer draws planes behind the camera. */
    assert_true(baseline.entries[0].triangles > baseline.entries[1].triangles);
    for (uint32_t e = 0; e < baseline.entry_count; e++) {
        for (int phase = 0; phase < MASU_BASELINE_PHASES; phase++) {
            const masu_baseline_time *t = &baseline.entries[e].times[phase];
            assert_true(t->wall_ms > 0.0 && t->ratio > 0.0 && t->least_ratio > 0.0);
        }
        double sum = 0.0;
        for (uint32_t p = 0; p < baseline.entries[e].pass_count; p++)
            sum += baseline.entries[e].pass_ms[p];
        assert_true(sum > 0.0);
    }
}

static void check_samples(const masu_baseline_entry *e, uint32_t most) {
    for (int m = 0; m < MASU_BASELINE_METRICS; m++) {
        uint32_t k = e->samples[m], below = 1;
        print_message("  %s: error %d %.4f, %u samples\n", e->name, m, e->errors.of[m], k);
        if (!k) {
            assert_true(point(most)->errors.of[m] > e->errors.of[m]);
            continue;
        }
        assert_true(point(k)->errors.of[m] <= e->errors.of[m]);
        while (2 * below < k) below *= 2; /* the last doubled count that was not enough */
        if (k > 1) assert_true(point(below)->errors.of[m] > e->errors.of[m]);
    }
}

static void many_plain_samples_are_the_truth(void **state) {
    (void)state;
    enum { MOST = 4 };
    static const char *const settings[] = {"base", "scale=0.4", NULL};
    run((masu_baseline_desc){.time = 1.0,
                             .positions = 16,
                             .rays = 16,
                             .frames = 4,
                             .step = MASU_MOTION_STEP,
                             .most = MOST,
                             .curve = true},
        "mirrors", settings);
    const masu_baseline_entry *plain = &baseline.entries[0];
    for (uint32_t k = 1; k <= MOST; k *= 2)
        print_message("  plain, %u: FLIP %.4f, RMSE %.4f, 1 - SSIM %.4f\n", k,
                      point(k)->errors.of[0], point(k)->errors.of[1], point(k)->errors.of[2]);
    for (int m = 0; m < MASU_BASELINE_METRICS; m++) {
        assert_true(point(1)->errors.of[m] == plain->errors.of[m]);
        for (uint32_t k = 2; k <= MOST; k *= 2) {
            double now = point(k)->errors.of[m], before = point(k / 2)->errors.of[m];
            assert_true(now < before);
        }
        assert_true(point(MOST)->errors.of[m] < 0.6 * plain->errors.of[m]);
    }
    assert_true(point(MOST)->errors.of[MASU_BASELINE_FLIP] < 0.04);
    for (uint32_t e = baseline.plain_count; e < baseline.entry_count; e++)
        check_samples(&baseline.entries[e], MOST);
    /* An image of fewer pixels has a larger error than a full one, and does not need more
     * samples. */
    for (int m = 0; m < MASU_BASELINE_METRICS; m++) {
        const masu_baseline_entry *base = &baseline.entries[baseline.plain_count],
                                  *small = base + 1;
        assert_true(small->errors.of[m] > base->errors.of[m]);
        assert_true(small->samples[m] &&
                    (!base->samples[m] || small->samples[m] <= base->samples[m]));
    }
}

/* The camera moves so far between frames that little or nothing is found again. */
static void steps_are_those_between_frames(void **state) {
    (void)state;
    static const char *const settings[] = {"base", "temporal=on", NULL};
    static const double steps[] = {0.0, 0.5};
    double with[2];
    for (int i = 0; i < 2; i++) {
        run(
            (masu_baseline_desc){
                .time = 1.0, .positions = 16, .rays = 4, .frames = 24, .most = 1, .step = steps[i]},
            "engine", settings);
        const masu_baseline_entry *e = &baseline.entries[baseline.plain_count];
        with[i] = e[1].errors.of[MASU_BASELINE_RMSE] / e[0].errors.of[MASU_BASELINE_RMSE];
        print_message("  %g s: RMSE %.4f, with history %.4f\n", steps[i],
                      e[0].errors.of[MASU_BASELINE_RMSE], e[1].errors.of[MASU_BASELINE_RMSE]);
    }
    assert_true(with[0] < 0.7 && with[1] > 1.2 * with[0]);
}

static void bad_input_is_one_line(void **state) {
    (void)state;
    char good[1024];
    snprintf(good, sizeof good, "%s", scene_path("test_mirror_plain"));
    static const struct {
        const char *arguments;
        int code;
        const char *says;
    } cases[] = {{"", 2, "no scene"},
                 {"a.masu b.masu", 2, "expected one"},
                 {"%s --rung speed=3", 2, "'speed=3'"},
                 {"%s --most 0", 2, "--most"},
                 {"%s --step -1", 2, "--step"},
                 {"%s --ladder /dev/null", 1, "/dev/null"},
                 {"%s --rung base --rung base --rung base --rung base --rung base --rung base "
                  "--rung base --rung base --rung base",
                  2, "more than 8"},
                 {"%s --rung scale=2 --runs 0 --size 16x16 --positions 1", 2, "scale"},
                 {"/nowhere.masu", 1, "/nowhere.masu"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char arguments[2048];
        const char *at = strstr(cases[i].arguments, "%s");
        snprintf(arguments, sizeof arguments, "%s%s", at ? good : "",
                 at ? at + 2 : cases[i].arguments);
        int code = cli_run("study baseline %s", arguments);
        if (code != cases[i].code) fail_msg("%s: exit code %d, %s", arguments, code, cli_err);
        cli_complained(cases[i].says);
    }
}

static void rows_are_written(void **state) {
    (void)state;
    int code =
        cli_run("study baseline %s --size 32x18 --positions 2 --reference 2 --frames 2 --runs 1 "
                "--most 1 --rung scale=0.5 --csv %s/w.csv --validate",
                scene_path("test_truth"), scratch);
    if (code) fail_msg("exit code %d, %s", code, cli_err);
    char *text = read_file(in_scratch("w.csv"), NULL);
    uint32_t rows = 0, columns = 0, n = 1;
    bool quoted = false;
    for (const char *c = text; *c; c++) {
        quoted ^= *c == '"';
        n += *c == ',' && !quoted;
        if (*c != '\n') continue;
        if (!rows) columns = n;
        assert_int_equal(n, columns);
        rows++;
        n = 1;
    }
    free(text);
    assert_int_equal(rows, 3); /* header, plain, the setting */
    assert_true(columns > 40);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_a_pixel_is_measured_beside_one_in_four),
        cmocka_unit_test(many_plain_samples_are_the_truth),
        cmocka_unit_test(steps_are_those_between_frames),
        cmocka_unit_test(bad_input_is_one_line),
        cmocka_unit_test(rows_are_written),
    };
    cli_program = "masu-lab";
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
