/* test_study_march.c: `masu-lab study march` on a sphere whose ground truth is a few lines of C,
 * compiled here: the numbers, the CSV, and the shading in double precision against the GPU's
 * image. */
#include "support/support.h"
#include "support/files.h"
#include "support/cli.h"

#include "lab/study/marches.h"
#include "image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const sphere_text =
    "#include <math.h>\n"
    "double masu_truth_distance(const double *k, double time, const double p[3]);\n"
    "double masu_truth_step(const double *k, double time, const double p[3]);\n"
    "int masu_truth_part(const double *k, double time, const double p[3]);\n"
    "void masu_truth_material(int part, double out[8]);\n"
    "double masu_truth_distance(const double *k, double time, const double p[3]) {\n"
    "    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - k[0] + 0 * time;\n"
    "}\n"
    "double masu_truth_step(const double *k, double time, const double p[3]) {\n"
    "    return masu_truth_distance(k, time, p);\n"
    "}\n"
    "int masu_truth_part(const double *k, double time, const double p[3]) {\n"
    "    return k[0] + time + p[0] < -1e30;\n"
    "}\n"
    "void masu_truth_material(int part, double out[8]) {\n"
    "    const double m[8] = {0.7, 0.3, 0.2, 0.5, 0, 0, 0, part};\n"
    "    for (int i = 0; i < 8; i++) out[i] = m[i];\n"
    "}\n";

static int bench(const char *arguments) { return cli_run("study march %s --quiet", arguments); }

/* The scene with every march, and its field in double precision. */
static int make_truth(void **state) {
    if (make_scratch(state)) return 1;
    write_text("sphere.c", sphere_text);
    if (shell("%s/bin/masu-bake tests/scenes/test_sphere_sdf.json -o %s/test_sphere_sdf.masu "
              "--variants --quiet",
              build_dir(), scratch))
        return 1;
    return shell("%s -shared -fPIC -O2 -o %s/sphere.so %s/sphere.c -lm", c_compiler(), scratch,
                 scratch);
}

/* The value of a column in the line of a variant. */
static const char *csv_field(const char *csv, const char *variant, const char *column) {
    static char value[256];
    char start[128];
    const char *at = csv;
    size_t name = strlen(column), index = 0;
    while (strncmp(at, column, name) || (at[name] != ',' && at[name] != '\n')) {
        at = strchr(at, ',');
        if (!at) fail_msg("no column %s", column);
        at++;
        index++;
    }
    snprintf(start, sizeof start, "\ntest_sphere_sdf,%s,", variant);
    at = strstr(csv, start);
    if (!at) fail_msg("no line of %s", variant);
    for (at++; index > 0; index--) at = strchr(at, ',') + 1;
    snprintf(value, sizeof value, "%.*s", (int)strcspn(at, ",\n"), at);
    return value;
}

static double number(const char *variant, const char *column) {
    return strtod(csv_field(cli_out, variant, column), NULL);
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void a_sphere_is_measured(void **state) {
    (void)state;
    char arguments[1024];
    snprintf(arguments, sizeof arguments,
             "%s --truth %s/sphere.so --size 64x48 --csv %s/a.csv --validate",
             in_scratch("test_sphere_sdf.masu"), scratch, scratch);
    if (bench(arguments)) fail_msg("%s", cli_err);
    assert_string_equal(cli_err, "");
    assert_non_null(strstr(cli_out, "plain"));
    assert_non_null(strstr(cli_out, "truth: 3072 rays, 0 undecided"));
    take_text("a.csv", cli_out, sizeof cli_out);
    static const char *const first =
        "scene,variant,evals_per_px,ms,ratio_vs_plain,hitmiss_pct,depth_off_pct,flip,";
    assert_int_equal(strncmp(cli_out, first, strlen(first)), 0);
    assert_in_range((uint64_t)(100 * number("masu", "evals_per_px")), 200, 2000);
    assert_true(number("masu", "ms") > 0);
    assert_true(number("masu", "hits") > 500);
    /* The rim is 120 pixels long; the march's tolerance widens the sphere by a tenth of a pixel. */
    assert_true(number("masu", "hitmiss_pct") < 100 * 24.0 / 3072);
    assert_true(number("masu", "depth_off_pct") == 0);
    assert_true(number("masu", "depth_mean_px") < 0.02);
    assert_true(number("masu", "normal_mean_deg") < 0.5);
    assert_true(number("masu", "flip") < 0.03);
    assert_true(number("masu", "ssim") > 0.99);
    assert_true(fabs(number("masu", "checker_z")) < 3);
    for (int v = 0; v < MASU_BENCH_VARIANTS; v++)
        assert_string_equal(
            csv_field(cli_out, masu_bench_names[v], "truth_pixels"),
            strcmp(csv_field(cli_out, masu_bench_names[v], "hits"), "n/a") ? "3072" : "n/a");
}

/* The ground truth is shaded like on the GPU: away from the rim all bytes are within 2. */
static void the_shaded_truth_is_the_picture(void **state) {
    (void)state;
    enum { W = 120, H = 90 };
    char arguments[1024], path[256], error[ERROR_SIZE];
    snprintf(arguments, sizeof arguments, "%s --truth %s/sphere.so --size %dx%d --images %s",
             in_scratch("test_sphere_sdf.masu"), scratch, W, H, scratch);
    if (bench(arguments)) fail_msg("%s", cli_err);
    struct masu_image image[2];
    static const char *const names[2] = {"truth", "masu"};
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/test_sphere_sdf.%s.png", scratch, names[i]);
        assert_ok(masu_image_load_png(path, &image[i], error, sizeof error));
        assert_int_equal(image[i].width, W);
        assert_int_equal(image[i].height, H);
    }
    uint32_t rim = 0, different = 0;
    for (size_t i = 0; i < (size_t)W * H; i++) {
        uint32_t d = max_difference(image[0].rgba + 4 * i, image[1].rgba + 4 * i, 4);
        different += d > 0;
        rim += d > 2;
    }
    /* The rim is about 250 pixels long; a tenth of its pixels have their centre within 0.1 pixel of
     * the edge, near which light changes fast. */
    if (rim > 75) fail_msg("%u pixels are off by more than 2", rim);
    assert_true(different < W * H / 4);
    for (int i = 0; i < 2; i++) masu_image_free(&image[i]);
}

static void what_is_missing_is_said(void **state) {
    (void)state;
    char arguments[1024];
    snprintf(arguments, sizeof arguments, "%s --size 32x24 --csv %s/b.csv",
             in_scratch("test_sphere_sdf.masu"), scratch);
    if (bench(arguments)) fail_msg("%s", cli_err);
    assert_non_null(strstr(cli_out, "truth: none"));
    take_text("b.csv", cli_out, sizeof cli_out);
    assert_string_equal(csv_field(cli_out, "masu", "flip"), "n/a");
    assert_true(number("masu", "evals_per_px") > 2);
    snprintf(arguments, sizeof arguments, "%s --size 32x24", scene_path("test_sphere_mesh"));
    assert_int_equal(bench(arguments), 1);
    assert_non_null(strstr(cli_err, "has no SDF"));
    snprintf(arguments, sizeof arguments, "%s --size 32x24 --truth %s/none.so",
             in_scratch("test_sphere_sdf.masu"), scratch);
    assert_int_equal(bench(arguments), 1);
    assert_non_null(strstr(cli_err, "none.so"));
    assert_int_equal(bench(""), 2);
    snprintf(arguments, sizeof arguments, "%s --runs 8", in_scratch("test_sphere_sdf.masu"));
    assert_int_equal(bench(arguments), 2);
}

static void a_choice_of_ways_is_drawn_and_may_go_untimed(void **state) {
    (void)state;
    char arguments[1024];
    snprintf(arguments, sizeof arguments,
             "%s --size 32x24 --runs 0 --only masu,seed --csv %s/c.csv",
             in_scratch("test_sphere_sdf.masu"), scratch);
    if (bench(arguments)) fail_msg("%s", cli_err);
    take_text("c.csv", cli_out, sizeof cli_out);
    assert_true(number("masu", "evals_per_px") > 1);
    assert_true(number("seed", "evals_per_px") > 1);
    assert_string_equal(csv_field(cli_out, "masu", "ms"), "n/a");
    assert_string_equal(csv_field(cli_out, "plain", "evals_per_px"), "n/a");
    snprintf(arguments, sizeof arguments, "%s --only masu,seeds",
             in_scratch("test_sphere_sdf.masu"));
    assert_int_equal(bench(arguments), 2);
    assert_non_null(strstr(cli_err, "\"seeds\""));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_is_measured),
        cmocka_unit_test(the_shaded_truth_is_the_picture),
        cmocka_unit_test(what_is_missing_is_said),
        cmocka_unit_test(a_choice_of_ways_is_drawn_and_may_go_untimed),
    };
    cli_program = "masu-lab";
    return cmocka_run_group_tests_name("study_march", tests, make_truth, remove_scratch);
}
