/* test_conform.c: runs `masu conform` as a user does: a part of the smoke suite passes, planted
 * errors are found and can be replayed, and an invalid suite is rejected with one line. */
#include "support/support.h"
#include "support/cli.h"
#include "support/files.h"

#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void write_suite(const char *cases) {
    char text[4096];
    int n = snprintf(text, sizeof text,
                     "{\"format\": 1, \"defaults\": {\"scene\": \"test_both\", \"size\": [36, 22],"
                     " \"budget\": {\"allocations\": 0}}, \"cases\": [%s]}",
                     cases);
    write_bytes("suite.json", text, (size_t)n);
}

/* Runs `masu conform ARGUMENTS`. */
static int conform(const char *format, ...) {
    char command[256];
    va_list args;
    snprintf(command, sizeof command, "conform --scenes %s/scenes", made_dir());
    va_start(args, format);
    int code = cli_run_list(command, format, args);
    va_end(args);
    return code;
}

static int planted(const char *more) { return conform("--suite %s/suite.json %s", scratch, more); }

/* ---- Tests ----------------------------------------------------------------------------------- */

/* A ninth of the suite; each driver runs another part. */
static void a_part_of_the_smoke_suite_passes(void **state) {
    (void)state;
    const char *driver = getenv("MASU_TEST_DRIVER");
    int part = !driver || !strcmp(driver, "system") ? 0 : !strcmp(driver, "lavapipe-25") ? 3 : 7;
    int code = conform("--suite suites/smoke.json --fraction %d,9", part);
    if (code) fail_msg("exit code %d\n%s%s", code, cli_out, cli_err);
    cli_said("0 resource errors, 0 failed");
    assert_string_equal(cli_err, "");
}

/* An unmodified build has no warning about memory, which each change of the library may
 * increase. */
static void memory_is_within_its_limits(void **state) {
    (void)state;
    const char *driver = getenv("MASU_TEST_DRIVER");
    /* The limits are the maximum over all drivers. */
    if (driver && strcmp(driver, "system") != 0) return;
    int code = conform("--suite suites/smoke.json --case 'memory.*'");
    if (code) fail_msg("exit code %d\n%s%s", code, cli_out, cli_err);
    cli_said(" 0 quality warnings, 0 not supported, 0 resource errors, 0 failed");
}

/* A golden file of the scene itself passes; another sun fails in the patches; missing files are
 * named. */
static void cases_are_judged_by_golden_files(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(
        cli_run("render %s -o %s/golden.exr --truth=16 --size 36x22 --quiet", scene, scratch), 0);
    assert_int_equal(cli_run("render %s -o %s/dim.pfm --truth=16 --sun 60,20 --size 36x22 --quiet",
                             scene, scratch),
                     0);
    assert_int_equal(
        cli_run("render %s -o %s/golden.png --frame --size 36x22 --quiet", scene, scratch), 0);
    write_suite(
        "{\"name\": \"good\", \"error\": {\"against\": \"reference\", \"golden\": \"golden.exr\","
        " \"positions\": 16, \"mean_off\": 0.008, \"patch_p95\": 0.08}},"
        "{\"name\": \"image\", \"error\": {\"against\": \"reference\", \"golden\": \"golden.png\", "
        "\"pixels\": 0}}");
    if (planted("")) fail_msg("%s%s", cli_out, cli_err);
    write_suite(
        "{\"name\": \"dim\", \"error\": {\"against\": \"reference\", \"golden\": \"dim.pfm\","
        " \"positions\": 16, \"mean_off\": 0.008, \"patch_p95\": 0.08, \"patch_z2\": 2}},"
        "{\"name\": \"none\", \"error\": {\"against\": \"reference\", \"golden\": \"none.ref\", "
        "\"mean_off\": 1}}");
    assert_int_equal(planted(""), 1);
    cli_said("mean_off is 0.");
    cli_said("patch_p95 is 0.");
    cli_said("patch_z2 is ");
    cli_said("none.ref: cannot open");
}

/* However the run ends, files are complete and name the case that ran. */
static void a_run_that_is_killed_leaves_complete_reports(void **state) {
    (void)state;
    char text[8192];
    write_suite(
        "{\"name\": \"short\"}, {\"name\": \"long\", \"frames\": 100000}, {\"name\": \"never\"}");
    /* Killed soon after the first case. */
    int code = shell(
        "%s/bin/masu conform --scenes %s/scenes --suite %s/suite.json --junit %s/k.xml "
        "--csv %s/k.csv --table %s/k.md --images %s/new/images > /dev/null 2>&1 & i=0; "
        "until grep -q 'short.*,pass,' %s/k.csv 2> /dev/null || [ $((i += 1)) = 300 ]; "
        "do sleep 0.1; done; sleep 0.3; kill -KILL $!; wait $!; test $? = 137",
        build_dir(), made_dir(), scratch, scratch, scratch, scratch, scratch, scratch);
    assert_int_equal(code, 0);
    take_text("k.xml", text, sizeof text);
    assert_non_null(strstr(text, "tests=\"3\" "));
    assert_non_null(
        strstr(text, "message=\"the program ended during this case\" type=\"not run\""));
    assert_non_null(strstr(text, "message=\"the run ended before this case\" type=\"not run\""));
    assert_non_null(strstr(text, "</testsuites>\n"));
    take_text("k.csv", text, sizeof text);
    assert_non_null(strstr(text, "\"never\",\"test_both\",36,22,not run,"));
    take_text("k.md", text, sizeof text);
    assert_non_null(strstr(text, "| not run | never 36x22 "));
    assert_true(is_in_scratch("new/images"));
}

/* A fifteenth of the table in docs/stability.md, and a third of that on the secondary drivers of
 * CI; each runs another part. */
static void a_part_of_the_extreme_suite_passes(void **state) {
    (void)state;
    const char *driver = getenv("MASU_TEST_DRIVER");
    int first = !driver || !strcmp(driver, "system"), part = first                            ? 0
                                                             : !strcmp(driver, "lavapipe-25") ? 6
                                                                                              : 11;
    int code = conform("--suite suites/extreme.json --fraction %d,%d", part, first ? 15 : 45);
    if (code) fail_msg("exit code %d\n%s%s", code, cli_out, cli_err);
    cli_said("0 resource errors, 0 failed");
}

/* Errors planted in an extreme case are found: another view, a field that is not hit, another
 * material. */
static void extreme_cases_judge(void **state) {
    (void)state;
    if (!whole_run()) return; /* how the program judges results, on any driver */
    char table[8192];
    write_suite(
        "{\"name\": \"here\"},"
        "{\"name\": \"same\", \"extreme\": {\"cut\": true}, \"error\": {\"against\": \"here\", "
        "\"pixels\": 0}},"
        "{\"name\": \"away\", \"input\": \"a|b\", \"extreme\": {\"camera\": {\"position\": [0, 0, "
        "5]}},"
        " \"error\": {\"against\": \"here\", \"pixels\": 0}},"
        "{\"name\": \"dark\", \"extreme\": {\"light\": {\"sun\": [0, -1, 0]}},"
        " \"error\": {\"against\": \"here\", \"pixels\": 0}},"
        "{\"name\": \"gone\", \"extreme\": {\"transform\": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]},"
        " \"error\": {\"against\": \"here\", \"pixels\": 0}},"
        "{\"name\": \"none\", \"extreme\": {\"instance\": 9999, \"transform\": [0, 0, 0, 0, 0, 0, "
        "0, 0, 0, 0, 0, 0]}},"
        "{\"name\": \"glow\", \"extreme\": {\"material\": {\"emissive\": 5}},"
        " \"error\": {\"against\": \"here\", \"pixels\": 0}},"
        "{\"name\": \"rungs\", \"ladder\": [{}, {\"scale\": 0.2}], \"frames\": 2, \"extreme\": "
        "{\"cycle\": true},"
        " \"error\": {\"against\": \"here\", \"pixels\": 0}},"
        "{\"name\": \"field\", \"scene\": \"extreme/figures\", \"rung\": {\"march_steps\": 3},"
        " \"extreme\": {\"camera\": {\"position\": [1.5, 2.2, 6], \"forward\": [-0.25, -0.28, -1], "
        "\"near\": 0.05}},"
        " \"field\": {\"hitmiss_pct\": 0.1}},"
        "{\"name\": \"truth\", \"extreme\": {\"camera\": {}}, \"field\": {\"hitmiss_pct\": 0.1}}");
    char more[200];
    snprintf(more, sizeof more, "--table %s/t.md", scratch);
    assert_int_equal(planted(more), 1);
    static const char *const failing[] = {"away", "dark",  "gone",  "none",
                                          "glow", "rungs", "field", "truth"};
    for (size_t i = 0; i < sizeof failing / sizeof *failing; i++) {
        char line[64];
        snprintf(line, sizeof line, "fail             %s ", failing[i]);
        cli_said(line);
    }
    cli_said("pass             same ");
    cli_said(
        "10 cases: 2 passed, 0 quality warnings, 0 not supported, 0 resource errors, 8 failed");
    take_text("t.md", table, sizeof table);
    assert_non_null(strstr(table, "| fail | away 36x22 | a\\|b | "));
    assert_non_null(strstr(table, "pixels = 0, against here | "));
}

/* Odd frames have the other camera; a cut, a step and settling change the temporal state. */
static void extreme_frames_are_told(void **state) {
    (void)state;
    if (!whole_run()) return; /* how the program judges results, on any driver */
    char cases[4096];
    const char *here =
        "\"camera\": {\"position\": [1.2, 0.9, 3.2], \"forward\": [-0.3, -0.25, -1]}";
    const char *there = "{\"position\": [0, 0, 4]}",
               *t = "\"rung\": {\"temporal\": \"on\"}, \"frames\": 6";
    snprintf(cases, sizeof cases,
             "{\"name\": \"odd\", \"frames\": 2, \"extreme\": {%s, \"other_camera\": %s},"
             " \"error\": {\"against\": \"there\", \"pixels\": 0}},"
             "{\"name\": \"there\", \"frames\": 2, \"extreme\": {\"camera\": %s}},"
             "{\"name\": \"settled\", \"frames\": 2, \"extreme\": {%s, \"other_camera\": %s, "
             "\"settle\": 1},"
             " \"error\": {\"against\": \"here\", \"pixels\": 0}},"
             "{\"name\": \"here\", \"frames\": 2, \"extreme\": {%s}},"
             "{\"name\": \"gathered\", %s}, {\"name\": \"cut\", %s, \"extreme\": {\"cut\": true},"
             " \"error\": {\"against\": \"gathered\", \"pixels\": 0}},"
             "{\"name\": \"slow\", \"scene\": \"test_exposure\", \"frames\": 2, \"extreme\": "
             "{\"step\": 0, %s,"
             " \"other_camera\": {\"position\": [0, 0, 1.5]}}},"
             "{\"name\": \"fast\", \"scene\": \"test_exposure\", \"frames\": 2, \"extreme\": "
             "{\"step\": 10, %s,"
             " \"other_camera\": {\"position\": [0, 0, 1.5]}}, \"error\": {\"against\": \"slow\", "
             "\"steps\": 3}}",
             here, there, there, here, there, here, t, t, here, here);
    write_suite(cases);
    assert_int_equal(planted(""), 1);
    cli_said("pass             odd ");
    cli_said("pass             settled ");
    cli_said("fail             cut ");
    cli_said("fail             fast ");
    cli_said("8 cases: 6 passed");
}

/* The value in the only row's column. */
static double column(const char *name) {
    const char *head = cli_out, *row = strchr(cli_out, '\n') + 1;
    for (; strncmp(head, name, strlen(name)) || head[strlen(name)] != ',';
         head = strchr(head, ',') + 1)
        row = strchr(row, ',') + 1;
    return strtod(row, NULL);
}

static void budgets_hold_to_the_byte(void **state) {
    (void)state;
    if (!whole_run()) return; /* how the program judges results, on any driver */
    static const char *const names[] = {"host_bytes", "device_bytes"};
    write_suite("{\"name\": \"a\", \"exact_memory\": true}");
    assert_int_equal(planted("--quiet --csv -"), 0);
    double bytes[2] = {column("host_bytes"), column("device_bytes")};
    assert_true(bytes[0] > 1000 && bytes[1] > 1000);
    for (int i = 0; i < 2; i++) {
        for (int less = 0; less < 2; less++) {
            char cases[400];
            snprintf(cases, sizeof cases,
                     "{\"name\": \"a\", \"exact_memory\": true, \"budget\": {\"%s\": %.0f}}",
                     names[i], bytes[i] - less);
            write_suite(cases);
            assert_int_equal(planted(""), less);
            cli_said(less ? "resource error   a " : "pass             a ");
            cli_said(less ? "1 resource error, 0 failed" : "1 case: 1 passed");
            if (!less) continue;
            cli_said(names[i][0] == 'h' ? "host_budget" : "device_budget");
            cli_said("replay: masu conform");
        }
    }
}

/* The line below the verdict, and the token. */
static void take_failure(char *why, char *token, size_t size) {
    const char *line = strstr(cli_out, "\n    "), *mark = strstr(cli_out, "--replay ");
    assert_true(line && mark);
    snprintf(why, size, "%.*s", (int)strcspn(line + 1, "\n"), line + 1);
    snprintf(token, size, "%.*s", (int)strcspn(mark + 9, "\n"), mark + 9);
}

static void a_failure_is_replayed_by_its_token(void **state) {
    (void)state;
    char why[2][256], token[2][256], more[400], xml[8192];
    write_suite(
        "{\"name\": \"good\"},"
        "{\"name\": \"far <&> 'off'\", \"sizes\": [[36, 22], [33, 25]], \"rung\": {\"scale\": 0.5},"
        " \"error\": {\"against\": \"truth\", \"positions\": 4, \"flip\": 0}},"
        "{\"name\": \"other\", \"rung\": {\"scale\": 0.5}, \"error\": {\"against\": \"good\", "
        "\"pixels\": 0}},"
        "{\"name\": \"near\", \"rung\": {\"occlusion\": \"off\"}, \"error\": {\"against\": "
        "\"good\", "
        "\"pixels\": 0}}");
    snprintf(more, sizeof more, "--junit %s/out.xml", scratch);
    assert_int_equal(planted(more), 1);
    cli_said("5 cases: 2 passed, 0 quality warnings, 0 not supported, 0 resource errors, 3 failed");
    cli_said("fail             other");
    cli_said("pass             near");
    take_text("out.xml", xml, sizeof xml);
    assert_non_null(strstr(xml, "tests=\"5\" failures=\"3\" errors=\"0\" skipped=\"0\""));
    assert_non_null(strstr(xml, "name=\"far &lt;&amp;&gt; &apos;off&apos; (33x25)\""));
    take_failure(why[0], token[0], sizeof why[0]);
    assert_non_null(strstr(why[0], "flip is 0."));
    snprintf(more, sizeof more, "--replay %s", token[0]);
    assert_int_equal(planted(more), 1);
    cli_said("1 case: 0 passed");
    take_failure(why[1], token[1], sizeof why[1]);
    assert_string_equal(why[0], why[1]); /* the same error to ten digits */
    assert_string_equal(token[0], token[1]);
    write_suite("{\"name\": \"good\"}");
    assert_int_equal(planted(more), 2);
    cli_complained("token of another suite");
}

static void what_is_planted_has_its_verdict(void **state) {
    (void)state;
    if (!whole_run()) return; /* how the program judges results, on any driver */
    write_suite("{\"name\": \"count\", \"counts\": {\"triangles\": 3}},"
                "{\"name\": \"least\", \"at_least\": {\"specular_rays\": 1}},"
                "{\"name\": \"warns\", \"counts\": {\"triangles\": {\"warn\": 3, \"fail\": 1000}}},"
                "{\"name\": \"scene\", \"scene\": \"none\"},"
                "{\"name\": \"settles\", \"size\": [18, 18], \"governed\": {\"target_ms\": 20, "
                "\"frames\": 60,"
                " \"told\": {\"fixed_ms\": 1, \"load_ms\": 100}, \"settles\": [0, 1]}},"
                "{\"name\": \"rays\", \"needs\": [\"ray-query\"]}");
    assert_int_equal(planted("--rays compute"), 1);
    cli_said("fail             count");
    cli_said("triangles is 12, expected at most 3");
    cli_said("fail             least");
    cli_said("specular_rays is 0, expected at least 1");
    cli_said("quality warning  warns");
    cli_said("fail             scene");
    cli_said("none.masu");
    cli_said("fail             settles");
    cli_said("after 60 frames the rung is");
    cli_said("not supported    rays");
    cli_said("the device has no ray-query");
    cli_said("6 cases: 0 passed, 1 quality warning, 1 not supported, 0 resource errors, 4 failed");
    assert_int_equal(planted("--rays compute --case warns"), 0); /* neither case is a failure */
    assert_int_equal(planted("--rays compute --case rays"), 0);
}

static void time_is_a_ratio_to_the_calibration(void **state) {
    (void)state;
    write_suite("{\"name\": \"a\", \"budget\": {\"ms_ratio\": 1e9}}");
    assert_int_equal(planted("--quiet --runs 2 --csv -"), 0);
    assert_true(column("ms_ratio") > 0.0);
    write_suite("{\"name\": \"a\", \"budget\": {\"ms_ratio\": {\"warn\": 1e-9}}}");
    assert_int_equal(planted("--runs 1"), 0);
    cli_said("ms_ratio is ");
}

static void parts_are_chosen_and_listed(void **state) {
    (void)state;
    if (!whole_run()) return; /* how the program judges results, on any driver */
    assert_int_equal(conform("--list --case 'memory.*'"), 0);
    cli_said("memory.both");
    assert_null(strstr(cli_out, "march."));
    assert_int_equal(conform("--list --case 'memory.*' --fraction 1,2"), 0);
    assert_null(strstr(cli_out, "64x48"));
    assert_int_equal(conform("--list --suite suites/full.json"), 0);
    static char by_file[sizeof cli_out];
    snprintf(by_file, sizeof by_file, "%s", cli_out);
    assert_int_equal(conform("--list --suite full"), 0); /* by its name, next to the program */
    assert_string_equal(cli_out, by_file);
    assert_int_equal(conform("--list --suite none"), 1);
    cli_complained("suites/none.json");
    assert_int_equal(conform("--case nonesuch"), 2);
    cli_complained("nonesuch");
    static const char *const bad[] = {"4,4", "1", "-1,4", "1,2,3", "0,0", "a,b"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(conform("--fraction=%s", bad[i]), 2);
        cli_complained("I,N");
    }
    assert_int_equal(conform("--replay here"), 2);
    cli_complained("expected a token");
    assert_int_equal(conform("--replay here --case x"), 2);
    cli_complained("--replay names one case");
    assert_int_equal(conform("suites/smoke.json"), 2);
    cli_complained("--suite");
}

static void what_is_no_suite_is_refused_in_one_line(void **state) {
    (void)state;
    if (!whole_run()) return; /* how the program judges results, on any driver */
    assert_int_equal(conform("--suite %s/none.json", scratch), 1);
    cli_complained("none.json");
    write_suite("{\"name\": \"a\", \"rung\": {\"scale\": 2}}");
    assert_int_equal(planted(""), 1);
    cli_complained("suite.json: case 'a': rung.scale: expected a number from 0 to 1, found 2");
    write_suite("{\"name\": \"a\"");
    assert_int_equal(planted(""), 1);
    cli_complained("suite.json:1:");
    write_suite("{\"name\": \"a\"}");
    assert_int_equal(planted("--device nonesuch"), 1);
    cli_complained("nonesuch");
    assert_int_equal(planted("--junit /dev/full --quiet"), 1);
    cli_complained("/dev/full");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_of_the_smoke_suite_passes),
        cmocka_unit_test(cases_are_judged_by_golden_files),
        cmocka_unit_test(memory_is_within_its_limits),
        cmocka_unit_test(a_run_that_is_killed_leaves_complete_reports),
        cmocka_unit_test(a_part_of_the_extreme_suite_passes),
        cmocka_unit_test(extreme_cases_judge),
        cmocka_unit_test(extreme_frames_are_told),
        cmocka_unit_test(budgets_hold_to_the_byte),
        cmocka_unit_test(a_failure_is_replayed_by_its_token),
        cmocka_unit_test(what_is_planted_has_its_verdict),
        cmocka_unit_test(time_is_a_ratio_to_the_calibration),
        cmocka_unit_test(parts_are_chosen_and_listed),
        cmocka_unit_test(what_is_no_suite_is_refused_in_one_line),
    };
    return cmocka_run_group_tests_name("conform", tests, make_scratch, remove_scratch);
}
