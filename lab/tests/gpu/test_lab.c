/* test_lab.c: tests masu-lab from outside: help of every command, and the studies upscale, rays and
 * image on small scenes. Times are not checked. */
#include "support/cli.h"
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void help_and_version_are_there_for_every_command(void **state) {
    (void)state;
    static const char *const commands[] = {
        "", "study", "model", "isa", "simulate", "meso", "world", "ladder", "study march",
        "study image", "study rays", "study baseline", "study reflections", "study temporal",
        "study upscale", "world city", "world forza"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_int_equal(cli_run("%s --help", commands[i]), 0);
        assert_true(strlen(cli_out) > 200);
        assert_string_equal(cli_err, "");
    }
    static const char *const same[][2] = {{"help", "--help"},
                                          {"help study", "study --help"},
                                          {"help study march", "study march --help"},
                                          {"study help march", "study march --help"}};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        static char asked[sizeof cli_out];
        assert_int_equal(cli_run("%s", same[i][0]), 0);
        memcpy(asked, cli_out, sizeof asked);
        assert_int_equal(cli_run("%s", same[i][1]), 0);
        assert_string_equal(asked, cli_out);
    }
    assert_int_equal(cli_run("study ao"), 2);
    assert_non_null(strstr(cli_err, "unknown command"));
    assert_int_equal(cli_run("nothing"), 2);
    assert_non_null(strstr(cli_err, "unknown command \"nothing\""));
    assert_int_equal(cli_run("--version"), 0);
    assert_non_null(strstr(cli_out, "masu-lab "));
}

static void the_upscale_study_has_a_line_for_each_case(void **state) {
    (void)state;
    static const char *const names[] = {"easu+rcas", "easu", "easu-fast+rcas", "easu-fast",
                                        "bilinear",  "gather"};
    assert_int_equal(cli_run("study upscale --from 32x24 --size 64x48 --runs 2 --csv -"), 0);
    assert_non_null(strstr(cli_out, "case,driver,ms_min,ms_median,ratio,"));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char start[64];
        double least, median, ratio, gpu;
        snprintf(start, sizeof start, "\n%s,\"", names[i]);
        const char *row = strstr(cli_out, start);
        assert_non_null(row);
        row = strchr(row + strlen(start), '"');
        assert_int_equal(sscanf(row, "\",%lf,%lf,%lf,%lf", &least, &median, &ratio, &gpu), 4);
        assert_true(least > 0 && median >= least && ratio > 0 && (i || ratio == 1));
    }
    assert_int_equal(
        cli_run("study upscale --only easu,bilinear --from 32x24 --size 64x48 --runs 1"), 0);
    assert_non_null(strstr(cli_out, "\n  easu  "));
    assert_non_null(strstr(cli_out, "\n  bilinear  "));
    assert_null(strstr(cli_out, "\n  gather  "));
    assert_int_equal(cli_run("study upscale --only easu,bicubic"), 2);
    cli_complained("bicubic");
    assert_int_equal(cli_run("study upscale --only="), 2);
    cli_complained("only");
    assert_int_equal(cli_run("study upscale --csv %s/none/x.csv", scratch), 1);
    cli_complained("none/x.csv");
    assert_int_equal(cli_run("study upscale --runs 0"), 2);
    cli_complained("runs");
    assert_int_equal(cli_run("study upscale %s/none.png", scratch), 1);
    cli_complained("none.png");
}

static void the_rays_study_agrees_with_embree(void **state) {
    (void)state;
    static const char *const flat[] = {"", "--flat"};
    for (int i = 0; i < 2; i++) {
        unsigned rays = 0, mismatches = 9;
        assert_int_equal(
            cli_run("study rays %s --size 96x64 --runs 2 --quiet --validate --csv - %s",
                    scene_path("test_trace"), flat[i]),
            0);
        assert_int_equal(strncmp(cli_out, "scene,kind,backend,rays,mrays_s,embree_mrays_s,ratio,"
                                           "mismatches,hits,given_up,", 78), 0);
        const char *row = strstr(cli_out, "primary,compute,");
        assert_non_null(row);
        assert_int_equal(sscanf(row, "primary,compute,%u,%*f,%*f,%*f,%u", &rays, &mismatches), 2);
        assert_int_equal(rays, 96 * 64);
        assert_true(mismatches < 10);
        row = strstr(cli_out, "specular,compute,");
        assert_non_null(row);
        assert_int_equal(sscanf(row, "specular,compute,%u,%*f,%*f,%*f,%u", &rays, &mismatches), 2);
        assert_true(rays > 1000 && mismatches < 10);
    }
    assert_int_equal(cli_run("study rays"), 2);
    cli_complained("no scene");
    assert_int_equal(cli_run("study rays %s", scene_path("night")), 1);
    cli_complained("nothing is traced");
}

/* There is a row for each chain; a smaller render size has a larger error. */
static void the_image_study_has_a_row_for_each_chain(void **state) {
    (void)state;
    char line[4096];
    assert_int_equal(shell("%s/bin/masu-lab study image %s --size 96x64 --positions 4 --runs 1 "
                           "--scales 1,0.8,0.4 --csv %s --validate >/dev/null 2>&1",
                           build_dir(), scene_path("test_truth"), in_scratch("table.csv")),
                     0);
    FILE *f = fopen(in_scratch("table.csv"), "r");
    assert_non_null(f);
    double whole = -1, small = -1, flip, scale;
    uint32_t rows = 0;
    char name[64];
    while (fgets(line, sizeof line, f)) {
        if (sscanf(line, "test_truth,%lf,%63[^,],%*u,%*u,%lf", &scale, name, &flip) != 3) continue;
        rows++;
        assert_true(flip >= 0 && flip < 0.5);
        if (!strcmp(name, "none")) whole = flip;
        if (!strcmp(name, "bilinear") && scale < 0.5) small = flip;
    }
    fclose(f);
    assert_true(rows >= 24);
    assert_true(whole > 0 && small > whole);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_version_are_there_for_every_command),
        cmocka_unit_test(the_upscale_study_has_a_line_for_each_case),
        cmocka_unit_test(the_rays_study_agrees_with_embree),
        cmocka_unit_test(the_image_study_has_a_row_for_each_chain),
    };
    cli_program = "masu-lab";
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
