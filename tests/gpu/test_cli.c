/* test_cli.c: runs the program `masu` as a user does: its output files and its error messages. */
#include "support/support.h"
#include "support/cli.h"

#include "image.h"
#include "measure/linear.h"
#include "metric/image.h"
#include "reference/fsr1.h"
#include "reference/patterns.h"
#include "reference/smaa.h"
#include "scene/blob.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Tests ----------------------------------------------------------------------------------- */

static void help_and_version_are_there_for_every_command(void **state) {
    (void)state;
    static const char *const commands[] = {"",     "render", "upscale", "compare",
                                           "plan", "bench",  "conform"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_int_equal(cli_run("%s --help", commands[i]), 0);
        assert_true(strlen(cli_out) > 200);
        assert_string_equal(cli_err, "");
    }
    static const char *const same[][2] = {{"help", "--help"}, {"help render", "render --help"}};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        static char asked[sizeof cli_out];
        assert_int_equal(cli_run("%s", same[i][0]), 0);
        assert_string_equal(cli_err, "");
        memcpy(asked, cli_out, sizeof asked);
        assert_int_equal(cli_run("%s", same[i][1]), 0);
        assert_string_equal(asked, cli_out);
    }
    assert_int_equal(cli_run("help nothing"), 2);
    assert_non_null(strstr(cli_err, "unknown command \"nothing\""));
    assert_int_equal(cli_run("--version"), 0);
    assert_non_null(strstr(cli_out, "0.2.0"));
}

static void wrong_command_lines_are_exit_code_2(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(cli_run("render"), 2);
    cli_complained("no scene");
    assert_int_equal(cli_run("render %s", scene), 2);
    cli_complained("--output");
    assert_int_equal(cli_run("render %s -o %s/x.png --rung 3", scene, scratch), 2);
    cli_complained("--rung: expected 0 to 2, found 3");
    assert_int_equal(cli_run("render %s -o %s/x.png --size 0x9", scene, scratch), 2);
    cli_complained("size");
    assert_int_equal(cli_run("render %s -o %s/x.png --size 99999x9", scene, scratch), 2);
    cli_complained("size");
    assert_int_equal(cli_run("render %s -o %s/x.png --bogus", scene, scratch), 2);
    cli_complained("--bogus");
    assert_int_equal(cli_run("render %s -o %s/x.png --reference=0", scene, scratch), 2);
    cli_complained("reference");
    assert_int_equal(cli_run("render %s -o %s/x.png --frame=1 --frames 2", scene, scratch), 2);
    cli_complained("--frames");
    assert_int_equal(cli_run("render %s --video %s/x.y4m", scene, scratch), 2);
    cli_complained("--video needs --frames");
    assert_int_equal(cli_run("render %s -o %s/x.png --frames 0", scene, scratch), 2);
    cli_complained("frames");
    assert_int_equal(cli_run("render %s -o %s/x.png --exposure bright", scene, scratch), 2);
    cli_complained("exposure");
    assert_int_equal(cli_run("render %s -o %s/x.png --exposure 0", scene, scratch), 2);
    cli_complained("exposure");
    assert_int_equal(cli_run("render %s -o %s/x.png --tone film", scene, scratch), 2);
    cli_complained("tone");
    assert_int_equal(cli_run("upscale a.png b.png"), 2);
    cli_complained("--size");
    assert_int_equal(cli_run("upscale a.png b.png --aa off"), 2);
    cli_complained("--size");
    assert_int_equal(cli_run("render %s -o %s/x.png --aa most", scene, scratch), 2);
    cli_complained("--aa: expected one of auto, off, fxaa, smaa-low");
    assert_int_equal(cli_run("render %s -o %s/x.png --setting scale=2", scene, scratch), 2);
    cli_complained("scale: expected a number from 0 to 1, found '2'");
    assert_int_equal(
        cli_run("render %s -o %s/x.png --setting scale=0.5 --setting aa=fxaa", scene, scratch), 2);
    cli_complained("join the values by '+'");
    assert_int_equal(cli_run("render %s -o %s/x.png --setting base --ladder auto", scene, scratch),
                     2);
    cli_complained("with --ladder");
    assert_int_equal(cli_run("upscale a.png --size 4x4"), 2);
    cli_complained("output");
    assert_int_equal(cli_run("upscale a.png b.png --size 4x4 --easu slow"), 2);
    cli_complained("'slow'");
    assert_int_equal(cli_run("paint"), 2);
    cli_complained("paint");
    assert_false(is_in_scratch("x.png"));
}

/* A row in order of names for each folder with results; other folders and files are left out. */
static void an_index_links_the_reports_of_a_folder(void **state) {
    (void)state;
    static const char *const files[] = {"ladder.json", "results.csv"};
    char to[2048];
    assert_int_equal(cli_run("bench --index %s/none", scratch), 1);
    cli_complained("found no folder with ladder.json and results.csv");
    assert_int_equal(shell("mkdir -p %s/all/half %s/all/b %s/all/a", scratch, scratch, scratch), 0);
    assert_int_equal(cli_run("bench --index %s/all", scratch), 1);
    cli_complained("/all: found no folder");
    assert_false(is_in_scratch("all/index.html"));
    for (int i = 0; i < 2; i++) {
        assert_int_equal(shell("cp docs/report/engine/%s %s/all/b", files[i], scratch), 0);
        assert_int_equal(shell("cp docs/report/mirrors/%s %s/all/a", files[i], scratch), 0);
    }
    assert_int_equal(shell("cp docs/report/engine/ladder.json %s/all/half", scratch), 0);
    assert_int_equal(cli_run("bench --index %s/all", scratch), 0);
    assert_string_equal(cli_err, "");
    cli_said("/all/index.html: 2 scenes\n");
    char *page = read_file(in_scratch("all/index.html"), NULL);
    const char *a = strstr(page, "<a href=\"./a/ladder.json\">a</a>");
    const char *b = strstr(page, "<a href=\"./b/ladder.json\">b</a>");
    assert_true(a && b && a < b && !strstr(page, "half"));
    free(page);
    assert_int_equal(cli_run("bench --index %s/all --quiet", scratch), 0);
    assert_string_equal(cli_out, "");
    /* One scene that cannot be read: no page is better than one without it. */
    assert_int_equal(
        shell("echo '[' > %s/all/b/ladder.json && rm %s/all/index.html", scratch, scratch), 0);
    assert_int_equal(cli_run("bench --index %s/all", scratch), 1);
    snprintf(to, sizeof to, "%s/all/b/ladder.json", scratch);
    cli_complained(to);
    assert_false(is_in_scratch("all/index.html"));
}

static void bad_scene_files_are_named_with_their_fault(void **state) {
    (void)state;
    FILE *f = fopen(scene_path("test_both"), "rb");
    assert_non_null(f);
    static uint8_t blob[1 << 20];
    size_t n = fread(blob, 1, sizeof blob, f);
    fclose(f);
    assert_true(n > 1000 && n < sizeof blob);
    assert_int_equal(cli_run("render %s/none.masu -o %s/x.png", scratch, scratch), 1);
    cli_complained("none.masu");
    assert_int_equal(cli_run("render %s -o %s/x.png", scratch, scratch), 1);
    cli_complained(scratch);
    write_bytes("empty.masu", blob, 0);
    assert_int_equal(cli_run("render %s/empty.masu -o %s/x.png", scratch, scratch), 1);
    cli_complained("empty.masu");
    write_bytes("cut.masu", blob, n - 100);
    assert_int_equal(cli_run("render %s/cut.masu -o %s/x.png", scratch, scratch), 1);
    cli_complained("truncated");
    blob[4] ^= 0x40; /* version */
    write_bytes("version.masu", blob, n);
    assert_int_equal(cli_run("plan %s/version.masu", scratch), 1);
    cli_complained("version");
    blob[4] ^= 0x40;
    blob[n / 2] ^= 1;
    write_bytes("damaged.masu", blob, n);
    assert_int_equal(cli_run("render %s/damaged.masu -o %s/x.png", scratch, scratch), 1);
    cli_complained("damaged");
    write_bytes("text.masu",
                "not a scene, but long enough to hold the header of one, and a bit more", 70);
    assert_int_equal(cli_run("render %s/text.masu -o %s/x.png", scratch, scratch), 1);
    cli_complained("not a Masu scene");
    assert_false(is_in_scratch("x.png"));
}

static void an_output_that_cannot_be_written_leaves_nothing_and_harms_nothing(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(
        cli_run("render %s -o %s/no/such/folder.png --size 18x18 --quiet", scene, scratch), 1);
    cli_complained("folder.png");
    write_bytes("old.png", "old", 3);
    assert_int_equal(cli_run("upscale %s/none.png %s/old.png --size 8x8", scratch, scratch), 1);
    cli_complained("none.png");
    char text[16];
    take_text("old.png", text, sizeof text);
    assert_string_equal(text, "old");
    assert_int_equal(cli_run("render %s -o /dev/full --size 18x18 --quiet", scene), 1);
    cli_complained("/dev/full");
    assert_int_equal(cli_run("render %s --stats /dev/full --size 18x18 --quiet", scene), 1);
    cli_complained("/dev/full");
}

static void an_unknown_device_lists_those_that_are_there(void **state) {
    (void)state;
    assert_int_equal(
        cli_run("render %s -o %s/x.png --device nonesuch", scene_path("test_both"), scratch), 1);
    cli_complained("nonesuch");
    assert_non_null(strstr(cli_err, "0 '"));
    assert_int_equal(cli_run("render %s -o %s/x.png --device 0 --frame --size 18x18 --quiet",
                             scene_path("test_both"), scratch),
                     0);
}

static void render_writes_the_picture_and_its_numbers_under_validation(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(
        cli_run(
            "render %s -o %s/a.png --size 66x48 --stats %s/a.json --frames 3 --validate --quiet",
            scene, scratch, scratch),
        0);
    assert_string_equal(cli_err, "");
    struct masu_image image;
    char path[256], error[ERROR_SIZE];
    snprintf(path, sizeof path, "%s/a.png", scratch);
    assert_ok(masu_image_load_png(path, &image, error, sizeof error));
    assert_int_equal(image.width, 66);
    assert_int_equal(image.height, 48);
    masu_image_free(&image);
    static const char *const keys[] = {"\"driver\"",
                                       "\"wall_ms\"",
                                       "\"passes\"",
                                       "\"march\"",
                                       "\"transient_lower_bound\"",
                                       "\"sdf_evals\"",
                                       "\"timestamps_plausible\"",
                                       "\"median\""};
    take_text("a.json", cli_out, sizeof cli_out);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (!strstr(cli_out, keys[i])) fail_msg("%s is not in the statistics", keys[i]);
    }
    assert_null(strstr(cli_out, "\"exposure\"")); /* no auto-exposure */
    assert_int_equal(
        cli_run("render %s -o %s/a.png --size 66x48 --stats - --exposure auto --tone neutral "
                "--dither --validate --quiet",
                scene, scratch),
        0);
    assert_non_null(strstr(cli_out, "\"exposure\""));
    assert_non_null(strstr(cli_out, "\"meter\""));
    assert_int_equal(
        cli_run("render %s -o %s/f-###.png --size 18x18 --frames 2 --quiet", scene, scratch), 0);
    assert_true(is_in_scratch("f-000.png") && is_in_scratch("f-001.png") &&
                !is_in_scratch("f-002.png"));
    /* Clips play unless they are disabled. */
    static const char *const ways[] = {"", " --animate", " --animate=off",
                                       " --animate=off --time 0"};
    uint64_t hash[4];
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(cli_run("render %s -o %s/f.png --frame --size 48x34 --quiet --time 0.5%s",
                                 scene_path("test_swing"), scratch, ways[i]),
                         0);
        snprintf(path, sizeof path, "%s/f.png", scratch);
        assert_ok(masu_image_load_png(path, &image, error, sizeof error));
        hash[i] = masu_fnv1a64(image.rgba, (uint64_t)4 * image.width * image.height);
        masu_image_free(&image);
    }
    assert_int_equal(hash[0], hash[1]);
    assert_int_not_equal(hash[0], hash[2]);
    assert_int_equal(hash[2], hash[3]);
    assert_int_equal(cli_run("render %s --animate=on", scene), 2);
}

/* A target of a second fits on any machine. */
static void the_governor_reports_what_it_has_done(void **state) {
    (void)state;
    const char *scene = scene_path("test_sphere_sdf");
    assert_int_equal(
        cli_run("render %s --target-ms 1000 --ladder off --frames 12 --size 36x22 --times %s/t.csv "
                "--stats %s/g.json",
                scene, scratch, scratch),
        0);
    assert_non_null(strstr(cli_out, "governor: target 1000.00 ms, 0 of 12 frames over it"));
    assert_non_null(strstr(cli_out, "rung 0, scale 1.000:    12 frames"));
    assert_non_null(strstr(cli_out, "rung 7, scale 0.400:     0 frames"));
    take_text("t.csv", cli_out, sizeof cli_out);
    assert_non_null(
        strstr(cli_out, "frame,time,rung,scale,gpu_ms,wall_ms,reason\n0,0.0000,0,1.0000,"));
    assert_non_null(strstr(cli_out, "the best rung meets the target"));
    take_text("g.json", cli_out, sizeof cli_out);
    assert_non_null(strstr(cli_out, "\"predicted_ms\""));
    assert_int_equal(
        cli_run("render %s --target-ms 5 --ladder off --rung 3 --frames 5 --size 36x22", scene), 0);
    assert_non_null(strstr(cli_out, "rung 3, scale 0.675:     5 frames"));
    assert_non_null(strstr(cli_out, "the rung is fixed"));
    assert_int_equal(cli_run("render %s --target-ms 0.016", scene), 2);
}

/* A ladder.json as masu bench writes it, of two rungs. */
static void write_ladder(const char *name, const char *second_ratio, const char *knob) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "{\"scene\": \"a.masu\", \"hash\": \"0\", \"driver\": \"D\", \"date\": \"2026-01-02\", "
        "\"width\": 36, \"height\": 22, \"time\": 0.0, \"clock\": \"wall\", \"error\": \"flip\", "
        "\"rungs\": [{\"setting\": \"base\", \"ratio\": 1, \"wall_ms\": 2, \"gpu_ms\": 2, "
        "\"flip\": 0.1, \"rmse\": 3, \"knobs\": {\"scale\": 1, \"aa\": \"smaa-low\"}}, "
        "{\"setting\": \"scale=0.5\", \"ratio\": %s, \"wall_ms\": 1, \"gpu_ms\": 1, "
        "\"flip\": 0.25, \"rmse\": 5, \"knobs\": {\"scale\": 0.5, \"march_steps\": 64, "
        "\"shadow_refresh\": [1, 2, 4, 8]%s}}]}",
        second_ratio, knob);
    write_text(name, text);
}

static void ladders_are_read_and_shown(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    write_ladder("l.json", "0.5", "");
    write_ladder("bad.json", "1.5", "");
    assert_int_equal(cli_run("bench --ladder %s/l.json", scratch), 0);
    assert_non_null(strstr(cli_out, "a.masu at 36x22, by wall, 2026-01-02"));
    assert_non_null(strstr(cli_out, "     1  0.500  0.2500    5.00     -  scale=0.5"));
    assert_int_equal(cli_run("bench --ladder %s/bad.json", scratch), 1);
    cli_complained("rungs[1]: ratio: expected less than the previous rung, 1, found 1.5");
    assert_int_equal(cli_run("bench --ladder"), 2);
    cli_complained("no ladder");
    /* In programs that plan or render. */
    assert_int_equal(cli_run("plan %s --size 36x22 --ladder %s/l.json", scene, scratch), 0);
    assert_non_null(strstr(cli_out, "1  renders 18x11, "));
    assert_non_null(strstr(cli_out, "time 0.500, FLIP 0.2500"));
    assert_int_equal(cli_run("plan %s --size 36x22 --ladder auto", scene), 0);
    assert_non_null(strstr(cli_out, "class: both; ladder: "));
    assert_int_equal(
        cli_run("render %s --target-ms 1000 --frames 3 --size 36x22 --ladder %s/l.json", scene,
                scratch),
        0);
    assert_non_null(strstr(cli_out, "rung 1, scale 0.500:     0 frames"));
    assert_null(strstr(cli_out, "rung 2"));
    assert_int_equal(cli_run("render %s -o %s/l.png --frame --rung 1 --size 36x22 --ladder auto",
                             scene, scratch),
                     0);
    assert_int_equal(
        cli_run("render %s -o %s/l.png --rung 2 --size 36x22 --ladder %s/l.json --quiet", scene,
                scratch, scratch),
        2);
    cli_complained("--rung: expected 0 to 1, found 2");
    assert_int_equal(
        cli_run("render %s -o %s/l.png --size 36x22 --ladder %s/bad.json", scene, scratch, scratch),
        1);
    cli_complained("bad.json: rungs[1]: ratio");
}

/* By the name that masu bench gives a setting: other options, ladders of the library and files have
 * the same knobs. */
static void a_setting_is_drawn_by_its_name(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    char ladder[300], other[320], name[256], error[ERROR_SIZE];
    write_ladder("l.json", "0.5", "");
    snprintf(ladder, sizeof ladder, "--ladder %s/l.json --rung 0", scratch);
    snprintf(other, sizeof other, "%s --aa fxaa", ladder);
    const char *const pairs[][2] = {{ladder, "--setting aa=smaa-low+sharpness=0"},
                                    {other, "--setting aa=fxaa+sharpness=0"},
                                    {"--aa smaa-high", "--setting sharpness=0+aa=smaa-high"},
                                    {"--rung 2", "--setting scale=0.4"},
                                    {"--rung 0", "--setting base"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        struct masu_image images[2];
        for (int k = 0; k < 2; k++) {
            snprintf(name, sizeof name, "%s/setting%d.png", scratch, k);
            assert_int_equal(cli_run("render %s -o %s --frame --size 66x48 --time 1 %s", scene,
                                     name, pairs[i][k]),
                             0);
            assert_ok(masu_image_load_png(name, &images[k], error, sizeof error));
        }
        assert_memory_equal(images[0].rgba, images[1].rgba, 4 * 64 * 48);
        masu_image_free(&images[0]);
        masu_image_free(&images[1]);
    }
}

/* Number of bytes by which the image of `masu render` with these options differs from the one
 * without. */
static int changed_by(const char *scene, const char *options) {
    struct masu_image images[2];
    char name[256], error[ERROR_SIZE];
    int changed = 0;
    for (int k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "%s/changed%d.png", scratch, k);
        if (cli_run("render %s -o %s --frame --size 66x48 --time 0.4 --animate %s",
                    scene_path(scene), name, k ? options : ""))
            fail_msg("%s: %s", options, cli_err);
        assert_ok(masu_image_load_png(name, &images[k], error, sizeof error));
    }
    for (int i = 0; i < 4 * 64 * 48; i++) changed += images[0].rgba[i] != images[1].rgba[i];
    masu_image_free(&images[0]);
    masu_image_free(&images[1]);
    return changed;
}

static void parameters_clips_and_light_are_set(void **state) {
    (void)state;
    assert_int_equal(changed_by("test_velocity", "--param radius=0.5"), 0);
    assert_in_range(changed_by("test_velocity", "--param radius=0.9"), 100, 4 * 64 * 48);
    assert_int_equal(changed_by("test_skin", "--clip 0"), 0);
    assert_in_range(changed_by("test_skin", "--clip Wuson_Walk"), 50, 4 * 64 * 48);
    assert_in_range(changed_by("test_velocity", "--sun 200,10"), 100, 4 * 64 * 48);
    assert_in_range(changed_by("test_velocity", "--exposure 3"), 100, 4 * 64 * 48);
    assert_int_equal(
        cli_run("render %s -o %s/x.png --param none=1", scene_path("test_velocity"), scratch), 1);
    assert_non_null(strstr(cli_err, "no parameter 'none', expected one of radius"));
    assert_int_equal(
        cli_run("render %s -o %s/x.png --param radius=1e9", scene_path("test_velocity"), scratch),
        1);
    assert_non_null(strstr(cli_err, "radius: expected "));
    assert_int_equal(
        cli_run("render %s -o %s/x.png --param radius", scene_path("test_velocity"), scratch), 1);
    assert_non_null(strstr(cli_err, "expected NAME=NUMBER, found 'radius'"));
    assert_int_equal(cli_run("render %s -o %s/x.png --clip none", scene_path("test_skin"), scratch),
                     1);
    assert_non_null(strstr(cli_err, "no model has the clip 'none', expected one of "));
}

/* Both formats have the same floats; encoded, they are the image in the PNG. */
static void linear_light_is_written_in_both_formats(void **state) {
    (void)state;
    static const char *const ends[] = {"exr", "pfm", "png"};
    struct masu_image images[3];
    char name[256], error[ERROR_SIZE];
    for (int k = 0; k < 3; k++) {
        snprintf(name, sizeof name, "%s/linear.%s", scratch, ends[k]);
        assert_int_equal(cli_run("render %s -o %s --frame --size 66x48 --tone none --exposure 0.5",
                                 scene_path("test_both"), name),
                         0);
        assert_ok(masu_image_load(name, &images[k], error, sizeof error));
        assert_int_equal(images[k].width, 66);
        assert_int_equal(images[k].height, 48);
    }
    assert_memory_equal(images[0].values, images[1].values, 3 * 64 * 48 * sizeof(float));
    for (uint32_t i = 0; i < 3 * 64 * 48; i++) {
        int shown = masu_srgb_encoded(0.5f * images[0].values[i]),
            have = images[2].rgba[i / 3 * 4 + i % 3];
        assert_true(abs(shown - have) <= 1);
    }
    for (int k = 0; k < 3; k++) masu_image_free(&images[k]);
    assert_int_equal(cli_run("render %s -o %s/half.pfm --frame --size 66x48 --setting scale=0.5",
                             scene_path("test_both"), scratch),
                     0);
    snprintf(name, sizeof name, "%s/half.pfm", scratch);
    assert_ok(masu_image_load(name, &images[0], error, sizeof error));
    assert_int_equal(images[0].width, 33);
    masu_image_free(&images[0]);
}

/* A still of an edge has grey levels that no raw frame has, and equals the raw frame in flat
 * areas. */
static void without_options_the_still_is_settled(void **state) {
    (void)state;
    enum { W = 66, H = 48 };
    static const char *const ways[] = {"--frame", "", "--truth=16"};
    struct masu_image images[3];
    char name[256], error[ERROR_SIZE];
    double off[3] = {0};
    for (int k = 0; k < 3; k++) {
        snprintf(name, sizeof name, "%s/still%d.png", scratch, k);
        assert_int_equal(
            cli_run("render %s -o %s --size 66x48 %s", scene_path("test_both"), name, ways[k]), 0);
        assert_ok(masu_image_load_png(name, &images[k], error, sizeof error));
        if (k == 1) assert_non_null(strstr(cli_err, "masu: still: "));
    }
    for (int k = 0; k < 2; k++) off[k] = masu_metric_rmse(images[k].rgba, images[2].rgba, W, H);
    print_message("  RMSE of 255: raw frame %.2f, still %.2f\n", 255 * off[0], 255 * off[1]);
    assert_true(off[0] > 0.005 && off[1] < 0.6 * off[0]);
    for (int k = 0; k < 3; k++) masu_image_free(&images[k]);
}

static void sequences_are_numbered_files_and_video(void **state) {
    (void)state;
    enum { W = 18, H = 14, FRAME = 6 + 3 * W * H };
    static uint8_t file[4096];
    const char *scene = scene_path("test_live"), *town = scene_path("test_town");
    char name[256], error[ERROR_SIZE];
    struct masu_image image, other;
    assert_int_equal(
        cli_run("render %s --video %s/v.y4m -o %s/v#.png --frames 3 --time-step 0.04 --size 18x14",
                scene, scratch, scratch),
        0);
    snprintf(name, sizeof name, "%s/v.y4m", scratch);
    FILE *f = fopen(name, "rb");
    assert_non_null(f);
    size_t count = fread(file, 1, sizeof file, f);
    (void)fclose(f);
    static const char header[] = "YUV4MPEG2 W18 H14 F25:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    assert_int_equal(count, sizeof header - 1 + 3 * FRAME);
    assert_memory_equal(file, header, sizeof header - 1);
    snprintf(name, sizeof name, "%s/v2.png", scratch);
    assert_ok(masu_image_load_png(name, &image, error, sizeof error));
    const uint8_t *planes = file + count - 3 * W * H;
    for (uint32_t i = 0; i < W * H; i++) { /* BT.709, limited range, back to R and B */
        double y = (planes[i] - 16) / 219.0, cb = (planes[W * H + i] - 128) / 224.0,
               cr = (planes[2 * W * H + i] - 128) / 224.0;
        assert_true(fabs(255 * (y + 1.5748 * cr) - image.rgba[4 * i]) < 3);
        assert_true(fabs(255 * (y + 1.8556 * cb) - image.rgba[4 * i + 2]) < 3);
    }
    masu_image_free(&image);
    /* The ground truth of a later frame is rendered at its time. */
    assert_int_equal(
        cli_run("render %s -o %s/v#.png --truth=2 --frames 2 --time 1 --time-step 0.5 --size 18x14",
                town, scratch),
        0);
    assert_int_equal(
        cli_run("render %s -o %s/one.png --truth=2 --time 1.5 --size 18x14", town, scratch), 0);
    snprintf(name, sizeof name, "%s/v1.png", scratch);
    assert_ok(masu_image_load_png(name, &image, error, sizeof error));
    snprintf(name, sizeof name, "%s/one.png", scratch);
    assert_ok(masu_image_load_png(name, &other, error, sizeof error));
    /* The noise of reflections depends on the frame's number. */
    double same = masu_metric_rmse(image.rgba, other.rgba, W, H);
    masu_image_free(&image);
    snprintf(name, sizeof name, "%s/v0.png", scratch);
    assert_ok(masu_image_load_png(name, &image, error, sizeof error));
    double apart = masu_metric_rmse(image.rgba, other.rgba, W, H);
    print_message("  RMSE of 255: the same moment %.2f, half a second before %.2f\n", 255 * same,
                  255 * apart);
    assert_true(same < 0.5 * apart);
    masu_image_free(&image);
    masu_image_free(&other);
}

/* Including its consequences: reflections have the temporal filters of images without temporal
 * upscaling. */
static void other_anti_aliasing_takes_a_past_out_of_a_rung(void **state) {
    (void)state;
    char name[256], with[512], error[ERROR_SIZE];
    write_ladder("past.json", "0.5", ", \"temporal\": \"on\"");
    snprintf(with, sizeof with, "--ladder %s/past.json --rung 1 --aa fxaa", scratch);
    const char *const ways[] = {
        with, "--setting scale=0.5+march_steps=64+shadow_refresh=1-2-4-8+aa=fxaa+sharpness=0"};
    struct masu_image images[2];
    for (int k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "%s/aa%d.png", scratch, k);
        assert_int_equal(cli_run("render %s -o %s --size 66x48 --frames 24 --time-step 0.05 %s",
                                 scene_path("test_live"), name, ways[k]),
                         0);
        assert_ok(masu_image_load_png(name, &images[k], error, sizeof error));
    }
    assert_memory_equal(images[0].rgba, images[1].rgba, 4 * 64 * 48);
    for (int k = 0; k < 2; k++) masu_image_free(&images[k]);
}

static void plan_says_what_is_in_and_what_was_left_out(void **state) {
    (void)state;
    assert_int_equal(cli_run("plan %s --size 64x64", scene_path("test_sphere_mesh")), 0);
    assert_non_null(strstr(cli_out, "the scene has no SDF"));
    assert_non_null(strstr(cli_out, "lower bound"));
    assert_int_equal(cli_run("plan %s --size 64x64 --json", scene_path("test_sphere_sdf")), 0);
    assert_non_null(strstr(cli_out, "no instances; the march writes every pixel"));
    assert_non_null(strstr(cli_out, "\"left_out_bytes\""));
}

/* Ray queries if the device has them, otherwise one line; the library's BVH on any device. */
static void rays_choose_what_finds_polygons(void **state) {
    (void)state;
    assert_int_equal(cli_run("plan %s --size 64x64 --rays compute", scene_path("mirrors")), 0);
    assert_non_null(strstr(cli_out, "specular_query      ---    omitted"));
    assert_null(strstr(cli_out, "bottom levels          buffer"));
    int code = cli_run("plan %s --size 64x64 --rays query", scene_path("mirrors"));
    if (code == 0) {
        assert_non_null(strstr(cli_out, "bottom levels          buffer"));
        assert_non_null(strstr(cli_out, "top level              buffer"));
    } else {
        assert_int_equal(code, 1);
        assert_non_null(strstr(cli_err, "ray_query is MASU_ON, but vulkan.ray_query says"));
    }
    assert_int_equal(cli_run("plan %s --rays sometimes", scene_path("mirrors")), 2);
}

static void upscale_runs_the_passes_of_the_frame_on_a_file_and_keeps_alpha(void **state) {
    (void)state;
    enum { IW = 40, IH = 28, OW = 70, OH = 49 };
    static uint8_t in[IW * IH * 4], want[OW * OH * 4];
    static float rgb[IW * IH * 3], easu[OW * OH * 3], alpha[IW * IH * 3], alpha_out[OW * OH * 3];
    char from[256], error[ERROR_SIZE];
    struct masu_image image;
    masu_pattern_fill(MASU_PATTERN_PHOTO, 1, IW, IH, in);
    for (uint32_t i = 0; i < IW * IH; i++) in[4 * i + 3] = (uint8_t)(i % IW * 6 + 6);
    snprintf(from, sizeof from, "%s/in.png", scratch);
    assert_ok(masu_image_save_png(from, in, IW, IH, 0, error, sizeof error));
    assert_int_equal(cli_run("upscale %s %s/up.png --size %ux%u --no-rcas", from, scratch,
                             (unsigned)OW, (unsigned)OH),
                     0);
    snprintf(from, sizeof from, "%s/up.png", scratch);
    assert_ok(masu_image_load_png(from, &image, error, sizeof error));
    masu_ref_from_rgba8(in, IW, IH, 0, rgb);
    for (uint32_t i = 0; i < IW * IH * 3; i++) alpha[i] = (float)in[i / 3 * 4 + 3] / 255.0f;
    struct masu_ref_image color = {rgb, IW, IH, 0}, grey = {alpha, IW, IH, 0};
    masu_ref_easu(&color, OW, OH, MASU_REF_BIT_TRICK, easu);
    masu_ref_easu(&grey, OW, OH, MASU_REF_BIT_TRICK, alpha_out);
    masu_ref_to_rgba8(easu, OW, OH, want);
    for (uint32_t i = 0; i < OW * OH; i++)
        want[4 * i + 3] = (uint8_t)lrintf(alpha_out[3 * i] * 255.0f);
    assert_true(max_difference(image.rgba, want, sizeof want) <= 1);
    masu_image_free(&image);
    /* Sharpness is in stops: 0 differs from no sharpening more than 2 does. */
    static uint8_t sharp[2][OW * OH * 4];
    static const char *const stops[] = {"0", "2"};
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(cli_run("upscale %s/in.png %s/up.png --size 70x49 --sharpness %s", scratch,
                                 scratch, stops[i]),
                         0);
        assert_ok(masu_image_load_png(from, &image, error, sizeof error));
        memcpy(sharp[i], image.rgba, sizeof sharp[i]);
        masu_image_free(&image);
    }
    uint64_t sums[2] = {0, 0};
    for (size_t i = 0; i < 2; i++) {
        for (size_t k = 0; k < sizeof want; k++) sums[i] += (uint64_t)abs(sharp[i][k] - want[k]);
    }
    assert_true(sums[0] > 2 * sums[1] && sums[1] > 0);
}

/* For any colour of a sprite's transparent pixels. */
static void upscaled_sprites_have_no_fringe(void **state) {
    (void)state;
    enum { SIDE = 24 };
    static uint8_t in[SIDE * SIDE * 4];
    char from[256], error[ERROR_SIZE];
    struct masu_image image;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = i % SIDE - 11.5, y = i / SIDE - 11.5, d = sqrt(x * x + y * y), alpha = 7.5 - d;
        in[4 * i + 3] = (uint8_t)(255.0 * fmin(fmax(alpha, 0.0), 1.0));
        in[4 * i] = in[4 * i + 3] ? 200 : 0;
        in[4 * i + 1] = in[4 * i + 3] ? 120 : 255;
    }
    snprintf(from, sizeof from, "%s/sprite.png", scratch);
    assert_ok(masu_image_save_png(from, in, SIDE, SIDE, 0, error, sizeof error));
    assert_int_equal(cli_run("upscale %s %s/large.png --size 48x48", from, scratch), 0);
    snprintf(from, sizeof from, "%s/large.png", scratch);
    assert_ok(masu_image_load_png(from, &image, error, sizeof error));
    int seen = 0, worst = 0;
    for (int i = 0; i < 48 * 48; i++) {
        if (image.rgba[4 * i + 3] < 8) continue;
        worst =
            (int)fmax(worst, fmax(abs(image.rgba[4 * i] - 200), abs(image.rgba[4 * i + 1] - 120)));
        seen++;
    }
    assert_true(seen > 600);
    if (worst > 1) fail_msg("colours differ by %d of 255", worst);
    masu_image_free(&image);
}

/* At its own size an image is only anti-aliased, whether its size is given or not. */
static void upscale_smooths_edges(void **state) {
    (void)state;
    enum { W = 50, H = 38, BYTES = W * H * 4 };
    static uint8_t in[BYTES], want[BYTES], edges[2 * W * H], weights[BYTES];
    static float rgb[W * H * 3], smooth[W * H * 3];
    static const char *const ways[] = {"--aa smaa-high", "--size 50x38 --aa smaa-high"};
    char name[256], error[ERROR_SIZE];
    struct masu_image image;
    masu_pattern_fill(MASU_PATTERN_HARD_EDGES, 1, W, H, in);
    snprintf(name, sizeof name, "%s/edges.png", scratch);
    assert_ok(masu_image_save_png(name, in, W, H, 0, error, sizeof error));
    struct masu_ref_image from = {rgb, W, H, 0};
    struct masu_ref_smaa with = masu_ref_smaa_preset(2);
    masu_ref_from_rgba8(in, W, H, 0, rgb);
    masu_ref_smaa_edges(&from, &with, edges);
    masu_ref_smaa_weights(edges, W, H, &with, weights);
    masu_ref_smaa_blend(&from, weights, smooth);
    masu_ref_to_rgba8(smooth, W, H, want);
    assert_true(max_difference(in, want, BYTES) > 20);
    snprintf(name, sizeof name, "%s/smooth.png", scratch);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(cli_run("upscale %s/edges.png %s %s", scratch, name, ways[i]), 0);
        assert_ok(masu_image_load_png(name, &image, error, sizeof error));
        assert_true(image.width == W && image.height == H);
        assert_true(max_difference(image.rgba, want, BYTES) <= 2);
        masu_image_free(&image);
    }
    assert_int_equal(cli_run("upscale %s/edges.png %s --aa fxaa --size 100x76", scratch, name), 0);
    assert_ok(masu_image_load_png(name, &image, error, sizeof error));
    assert_true(image.width == 2 * W && image.height == 2 * H);
    masu_image_free(&image);
}

static void the_example_of_the_readme_draws(void **state) {
    (void)state;
    char error[ERROR_SIZE];
    struct masu_image image;
    assert_int_equal(shell("%s/examples/minimal %s %s/example.png >%s/out", build_dir(),
                           scene_path("test_both"), scratch, scratch),
                     0);
    take_text("out", cli_out, sizeof cli_out);
    assert_non_null(strstr(cli_out, "bytes host"));
    assert_ok(masu_image_load_png(in_scratch("example.png"), &image, error, sizeof error));
    assert_int_equal(image.width, 1280);
    masu_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_version_are_there_for_every_command),
        cmocka_unit_test(wrong_command_lines_are_exit_code_2),
        cmocka_unit_test(an_index_links_the_reports_of_a_folder),
        cmocka_unit_test(bad_scene_files_are_named_with_their_fault),
        cmocka_unit_test(an_output_that_cannot_be_written_leaves_nothing_and_harms_nothing),
        cmocka_unit_test(an_unknown_device_lists_those_that_are_there),
        cmocka_unit_test(render_writes_the_picture_and_its_numbers_under_validation),
        cmocka_unit_test(ladders_are_read_and_shown),
        cmocka_unit_test(a_setting_is_drawn_by_its_name),
        cmocka_unit_test(parameters_clips_and_light_are_set),
        cmocka_unit_test(linear_light_is_written_in_both_formats),
        cmocka_unit_test(without_options_the_still_is_settled),
        cmocka_unit_test(sequences_are_numbered_files_and_video),
        cmocka_unit_test(other_anti_aliasing_takes_a_past_out_of_a_rung),
        cmocka_unit_test(plan_says_what_is_in_and_what_was_left_out),
        cmocka_unit_test(the_governor_reports_what_it_has_done),
        cmocka_unit_test(rays_choose_what_finds_polygons),
        cmocka_unit_test(the_example_of_the_readme_draws),
        cmocka_unit_test(upscale_runs_the_passes_of_the_frame_on_a_file_and_keeps_alpha),
        cmocka_unit_test(upscaled_sprites_have_no_fringe),
        cmocka_unit_test(upscale_smooths_edges),
    };
    return cmocka_run_group_tests_name("cli", tests, make_scratch, remove_scratch);
}
