/* test_cli.c: the program `masu` as a stranger runs it: what it makes, and what it says when it
 * cannot. */
#include "support.h"

#include "image.h"
#include "reference/fsr1.h"
#include "reference/patterns.h"
#include "reference/smaa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char dir[] = "/tmp/masu-test-XXXXXX";
static char out_text[1 << 16], err_text[1 << 16];

static void read_text(const char *name, char *text, size_t size) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    size_t n = fread(text, 1, size - 1, f);
    text[n] = 0;
    fclose(f);
}

/* Runs `masu ARGUMENTS` in a shell; %s in them is the scratch folder. Returns the exit code, fills
 * out_text and err_text. */
static int masu(const char *format, ...) {
    char arguments[2048], command[4096];
    const char *build = getenv("BUILD");
    va_list args;
    va_start(args, format);
    vsnprintf(arguments, sizeof arguments, format, args);
    va_end(args);
    snprintf(command, sizeof command, "%s/bin/masu %s >%s/out 2>%s/err </dev/null",
             build ? build : "build", arguments, dir, dir);
    int status = system(command);
    assert_true(WIFEXITED(status));
    read_text("out", out_text, sizeof out_text);
    read_text("err", err_text, sizeof err_text);
    return WEXITSTATUS(status);
}

/* The last run must have failed with one line on stderr, beginning "masu ", that holds `part`. */
static void said(const char *part) {
    size_t n = strlen(err_text);
    if (!n || strchr(err_text, '\n') != err_text + n - 1) fail_msg("not one line: '%s'", err_text);
    if (strncmp(err_text, "masu", 4))
        fail_msg("does not begin with the program's name: %s", err_text);
    if (!strstr(err_text, part)) fail_msg("'%s' is not in: %s", part, err_text);
    assert_string_equal(out_text, "");
}

static void write_bytes(const char *name, const void *bytes, size_t n) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    fclose(f);
}

static bool exists(const char *name) {
    char path[256];
    struct stat st;
    snprintf(path, sizeof path, "%s/%s", dir, name);
    return stat(path, &st) == 0;
}

static int make_dir(void **state) {
    (void)state;
    return mkdtemp(dir) ? 0 : 1;
}

static int remove_dir(void **state) {
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -rf %s", dir);
    return system(command);
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void help_and_version_are_there_for_every_command(void **state) {
    (void)state;
    static const char *const commands[] = {"",     "render",      "upscale",
                                           "plan", "bench", "march-bench", "cull-bench", "draw-bench",
                                           "light-bench", "trace-bench", "bench-image",
                                           "conform"};
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_int_equal(masu("%s --help", commands[i]), 0);
        assert_true(strlen(out_text) > 200);
        assert_string_equal(err_text, "");
    }
    assert_int_equal(masu("--version"), 0);
    assert_non_null(strstr(out_text, "0.1.0"));
}

/* Times are not looked at: a line for each case, with numbers that add up. */
static void bench_image_has_a_line_for_each_case(void **state) {
    (void)state;
    static const char *const names[] = {"easu+rcas", "easu", "easu-fast+rcas", "easu-fast",
                                        "bilinear",  "gather"};
    assert_int_equal(masu("bench-image --from 32x24 --size 64x48 --runs 2 --csv -"), 0);
    assert_non_null(strstr(out_text, "case,driver,ms_min,ms_median,ratio,"));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char start[64];
        double least, median, ratio, gpu;
        snprintf(start, sizeof start, "\n%s,\"", names[i]);
        const char *row = strstr(out_text, start);
        assert_non_null(row);
        row = strchr(row + strlen(start), '"');
        assert_int_equal(sscanf(row, "\",%lf,%lf,%lf,%lf", &least, &median, &ratio, &gpu), 4);
        assert_true(least > 0 && median >= least && ratio > 0 && (i || ratio == 1));
    }
    assert_int_equal(masu("bench-image --only easu,bilinear --from 32x24 --size 64x48 --runs 1"), 0);
    assert_non_null(strstr(out_text, "| easu |"));
    assert_non_null(strstr(out_text, "| bilinear |"));
    assert_null(strstr(out_text, "| gather |"));
    assert_int_equal(masu("bench-image --only easu,bicubic"), 2);
    said("bicubic");
    assert_int_equal(masu("bench-image --runs 0"), 2);
    said("runs");
    assert_int_equal(masu("bench-image %s/none.png", dir), 1);
    said("none.png");
}

static void wrong_command_lines_are_exit_code_2(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(masu("render"), 2);
    said("no scene");
    assert_int_equal(masu("render %s", scene), 2);
    said("--output");
    assert_int_equal(masu("render %s -o %s/x.png --rung 3", scene, dir), 2);
    said("rung 3");
    assert_int_equal(masu("render %s -o %s/x.png --size 0x9", scene, dir), 2);
    said("size");
    assert_int_equal(masu("render %s -o %s/x.png --size 99999x9", scene, dir), 2);
    said("size");
    assert_int_equal(masu("render %s -o %s/x.png --bogus", scene, dir), 2);
    said("--bogus");
    assert_int_equal(masu("render %s -o %s/x.png --reference=0", scene, dir), 2);
    said("reference");
    assert_int_equal(masu("render %s -o %s/x.png --reference --frames 2", scene, dir), 2);
    said("--frames");
    assert_int_equal(masu("render %s -o %s/#.png --reference", scene, dir), 2);
    said("many");
    assert_int_equal(masu("render %s -o %s/x.png --frames 0", scene, dir), 2);
    said("frames");
    assert_int_equal(masu("render %s -o %s/x.png --exposure bright", scene, dir), 2);
    said("exposure");
    assert_int_equal(masu("render %s -o %s/x.png --exposure 0", scene, dir), 2);
    said("exposure");
    assert_int_equal(masu("render %s -o %s/x.png --tone film", scene, dir), 2);
    said("tone");
    assert_int_equal(masu("upscale a.png b.png"), 2);
    said("--size");
    assert_int_equal(masu("upscale a.png b.png --smaa fxaa"), 2);
    said("smaa");
    assert_int_equal(masu("upscale a.png b.png --aa off"), 2);
    said("--size");
    assert_int_equal(masu("render %s -o %s/x.png --aa most", scene, dir), 2);
    said("--aa");
    assert_int_equal(masu("upscale a.png --size 4x4"), 2);
    said("output");
    assert_int_equal(masu("upscale a.png b.png --size 4x4 --easu slow"), 2);
    said("'slow'");
    assert_int_equal(masu("paint"), 2);
    said("paint");
    assert_false(exists("x.png"));
}

static void bad_scene_files_are_named_with_their_fault(void **state) {
    (void)state;
    FILE *f = fopen(scene_path("test_both"), "rb");
    assert_non_null(f);
    static uint8_t blob[1 << 20];
    size_t n = fread(blob, 1, sizeof blob, f);
    fclose(f);
    assert_true(n > 1000 && n < sizeof blob);
    assert_int_equal(masu("render %s/none.masu -o %s/x.png", dir, dir), 1);
    said("none.masu");
    assert_int_equal(masu("render %s -o %s/x.png", dir, dir), 1);
    said(dir);
    write_bytes("empty.masu", blob, 0);
    assert_int_equal(masu("render %s/empty.masu -o %s/x.png", dir, dir), 1);
    said("empty.masu");
    write_bytes("cut.masu", blob, n - 100);
    assert_int_equal(masu("render %s/cut.masu -o %s/x.png", dir, dir), 1);
    said("truncated");
    blob[4] ^= 0x40; /* version */
    write_bytes("version.masu", blob, n);
    assert_int_equal(masu("plan %s/version.masu", dir), 1);
    said("version");
    blob[4] ^= 0x40;
    blob[n / 2] ^= 1;
    write_bytes("damaged.masu", blob, n);
    assert_int_equal(masu("render %s/damaged.masu -o %s/x.png", dir, dir), 1);
    said("damaged");
    write_bytes("text.masu",
                "not a scene, but long enough to hold the header of one, and a bit more", 70);
    assert_int_equal(masu("render %s/text.masu -o %s/x.png", dir, dir), 1);
    said("not a Masu scene");
    assert_false(exists("x.png"));
}

static void an_output_that_cannot_be_written_leaves_nothing_and_harms_nothing(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(masu("render %s -o %s/no/such/folder.png --size 16x16 --quiet", scene, dir),
                     1);
    said("folder.png");
    write_bytes("old.png", "old", 3);
    assert_int_equal(masu("upscale %s/none.png %s/old.png --size 8x8", dir, dir), 1);
    said("none.png");
    char text[16];
    read_text("old.png", text, sizeof text);
    assert_string_equal(text, "old");
    assert_int_equal(masu("render %s -o /dev/full --size 16x16 --quiet", scene), 1);
    said("/dev/full");
    assert_int_equal(masu("render %s --stats /dev/full --size 16x16 --quiet", scene), 1);
    said("/dev/full");
}

static void an_unknown_device_lists_those_that_are_there(void **state) {
    (void)state;
    assert_int_equal(masu("render %s -o %s/x.png --device nonesuch", scene_path("test_both"), dir),
                     1);
    said("nonesuch");
    assert_non_null(strstr(err_text, "0 '"));
    assert_int_equal(
        masu("render %s -o %s/x.png --device 0 --size 16x16 --quiet", scene_path("test_both"), dir),
        0);
}

static void render_writes_the_picture_and_its_numbers_under_validation(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    assert_int_equal(
        masu("render %s -o %s/a.png --size 64x48 --stats %s/a.json --frames 3 --validate --quiet",
             scene, dir, dir),
        0);
    assert_string_equal(err_text, "");
    struct masu_image image;
    char path[256], error[ERROR_SIZE];
    snprintf(path, sizeof path, "%s/a.png", dir);
    assert_ok(masu_image_load_png(path, &image, error, sizeof error));
    assert_int_equal(image.width, 64);
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
    read_text("a.json", out_text, sizeof out_text);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (!strstr(out_text, keys[i])) fail_msg("%s is not in the statistics", keys[i]);
    }
    assert_null(strstr(out_text, "\"exposure\"")); /* nothing is metered */
    assert_int_equal(masu("render %s -o %s/a.png --size 64x48 --stats - --exposure auto --tone neutral "
                          "--dither --validate --quiet",
                          scene, dir),
                     0);
    assert_non_null(strstr(out_text, "\"exposure\""));
    assert_non_null(strstr(out_text, "\"meter\""));
    assert_int_equal(masu("render %s -o %s/f-###.png --size 16x16 --frames 2 --quiet", scene, dir),
                     0);
    assert_true(exists("f-000.png") && exists("f-001.png") && !exists("f-002.png"));
}

/* A target of a second fits whatever the machine does. */
static void the_governor_reports_what_it_has_done(void **state) {
    (void)state;
    const char *scene = scene_path("test_sphere_sdf");
    assert_int_equal(masu("render %s --target-ms 1000 --frames 12 --size 32x24 --times %s/t.csv "
                          "--stats %s/g.json",
                          scene, dir, dir),
                     0);
    assert_non_null(strstr(out_text, "governor: target 1000.00 ms, 0 of 12 frames over it"));
    assert_non_null(strstr(out_text, "rung 0, scale 1.000:    12 frames"));
    assert_non_null(strstr(out_text, "rung 7, scale 0.400:     0 frames"));
    read_text("t.csv", out_text, sizeof out_text);
    assert_non_null(strstr(out_text, "frame,time,rung,scale,gpu_ms,wall_ms,reason\n0,0.0000,0,1.0000,"));
    assert_non_null(strstr(out_text, "the best rung fits"));
    read_text("g.json", out_text, sizeof out_text);
    assert_non_null(strstr(out_text, "\"predicted_ms\""));
    assert_int_equal(masu("render %s --target-ms 5 --rung 3 --frames 5 --size 32x24", scene), 0);
    assert_non_null(strstr(out_text, "rung 3, scale 0.675:     5 frames"));
    assert_non_null(strstr(out_text, "the rung is fixed"));
    assert_int_equal(masu("render %s --target-ms 0.016", scene), 2);
}

static void plan_says_what_is_in_and_what_was_left_out(void **state) {
    (void)state;
    assert_int_equal(masu("plan %s --size 64x64", scene_path("test_sphere_mesh")), 0);
    assert_non_null(strstr(out_text, "the scene has no SDF"));
    assert_non_null(strstr(out_text, "lower bound"));
    assert_int_equal(masu("plan %s --size 64x64 --json", scene_path("test_sphere_sdf")), 0);
    assert_non_null(strstr(out_text, "no instances; the march writes every pixel"));
    assert_non_null(strstr(out_text, "\"left_out_bytes\""));
}

/* Ray queries where the device has them, else one line; the own tree anywhere. */
static void rays_choose_what_finds_polygons(void **state) {
    (void)state;
    assert_int_equal(masu("plan %s --size 64x64 --rays compute", scene_path("mirrors")), 0);
    assert_non_null(strstr(out_text, "specular_query ---    left out"));
    assert_null(strstr(out_text, "bottom levels          buffer"));
    int code = masu("plan %s --size 64x64 --rays query", scene_path("mirrors"));
    if (code == 0) {
        assert_non_null(strstr(out_text, "bottom levels          buffer"));
        assert_non_null(strstr(out_text, "top level              buffer"));
    } else {
        assert_int_equal(code, 1);
        assert_non_null(strstr(err_text, "ray_query is MASU_ON, but vulkan.ray_query says"));
    }
    assert_int_equal(masu("plan %s --rays sometimes", scene_path("mirrors")), 2);
}

static void light_bench_compares_pictures_and_counts_lights(void **state) {
    (void)state;
    assert_int_equal(masu("light-bench %s --size 64x40 --repeat 1 --quiet --validate",
                          scene_path("night")),
                     0);
    assert_non_null(strstr(out_text, "pictures are the same"));
    assert_non_null(strstr(out_text, "   256 "));
    assert_int_equal(masu("light-bench %s --size 16x16 --repeat 2 --json --quiet",
                          scene_path("night")),
                     0);
    assert_non_null(strstr(out_text, "\"asked_per_pixel\""));
    assert_int_equal(masu("light-bench"), 2);
    said("no scene");
    assert_int_equal(masu("light-bench %s", scene_path("spheres")), 1);
    said("has no lights");
}

static void trace_bench_agrees_with_embree(void **state) {
    (void)state;
    static const char *const flat[] = {"", "--flat"};
    for (int i = 0; i < 2; i++) {
        unsigned rays = 0, mismatches = 9;
        assert_int_equal(masu("trace-bench %s --size 96x64 --repeat 2 --quiet --validate --csv - %s",
                              scene_path("test_trace"), flat[i]),
                         0);
        assert_int_equal(strncmp(out_text, "scene,kind,backend,rays,mrays_s,embree_mrays_s,ratio,"
                                           "mismatches,hits,given_up,", 78), 0);
        const char *row = strstr(out_text, "primary,compute,");
        assert_non_null(row);
        assert_int_equal(sscanf(row, "primary,compute,%u,%*f,%*f,%*f,%u", &rays, &mismatches), 2);
        assert_int_equal(rays, 96 * 64);
        assert_true(mismatches < 10);
        row = strstr(out_text, "specular,compute,");
        assert_non_null(row);
        assert_int_equal(sscanf(row, "specular,compute,%u,%*f,%*f,%*f,%u", &rays, &mismatches), 2);
        assert_true(rays > 1000 && mismatches < 10);
    }
    assert_int_equal(masu("trace-bench"), 2);
    said("no scene");
    assert_int_equal(masu("trace-bench %s", scene_path("night")), 1);
    said("nothing is traced");
}

static void draw_bench_compares_pictures_and_counts_triangles(void **state) {
    (void)state;
    assert_int_equal(masu("draw-bench %s --size 64x40 --frames 4 --turn 50 --quiet --validate",
                          scene_path("test_town")),
                     0);
    assert_non_null(strstr(out_text, "4 frames, least of 1"));
    assert_non_null(strstr(out_text, "pictures: 0 of 4 frames differ"));
    assert_non_null(strstr(out_text, "1.00x  5042\n")); /* neither stage: all of the town */
    assert_int_equal(masu("draw-bench %s --size 64x40 --frames 2 --repeat 2 --json --quiet",
                          scene_path("test_shadows")),
                     0);
    assert_non_null(strstr(out_text, "\"different_frames\": 0"));
    assert_non_null(strstr(out_text, "\"triangles_stage1\""));
    assert_int_equal(masu("draw-bench"), 2);
    said("no scene");
    assert_int_equal(masu("draw-bench %s", scene_path("spheres")), 1);
    said("has no instances");
}

static void upscale_runs_the_passes_of_the_frame_on_a_file_and_keeps_alpha(void **state) {
    (void)state;
    enum { IW = 40, IH = 28, OW = 70, OH = 49 };
    static uint8_t in[IW * IH * 4], want[OW * OH * 4];
    static float rgb[IW * IH * 3], easu[OW * OH * 3], alpha[IW * IH * 3], alpha_out[OW * OH * 3];
    char from[256], error[ERROR_SIZE];
    struct masu_image image;
    masu_pattern_fill(MASU_PATTERN_PHOTO, 1, IW, IH, in);
    for (uint32_t i = 0; i < IW * IH; i++) in[4 * i + 3] = (uint8_t)(i % IW * 6);
    snprintf(from, sizeof from, "%s/in.png", dir);
    assert_ok(masu_image_save_png(from, in, IW, IH, 0, error, sizeof error));
    assert_int_equal(
        masu("upscale %s %s/up.png --size %ux%u --no-rcas", from, dir, (unsigned)OW, (unsigned)OH),
        0);
    snprintf(from, sizeof from, "%s/up.png", dir);
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
        assert_int_equal(
            masu("upscale %s/in.png %s/up.png --size 70x49 --sharpness %s", dir, dir, stops[i]), 0);
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

/* At its own size a picture is smoothed and nothing else; both spellings, and as part of upscaling. */
static void upscale_smooths_edges(void **state) {
    (void)state;
    enum { W = 50, H = 38, BYTES = W * H * 4 };
    static uint8_t in[BYTES], want[BYTES], edges[2 * W * H], weights[BYTES];
    static float rgb[W * H * 3], smooth[W * H * 3];
    static const char *const ways[] = {"--aa high", "--smaa high", "--size 50x38 --smaa high"};
    char name[256], error[ERROR_SIZE];
    struct masu_image image;
    masu_pattern_fill(MASU_PATTERN_HARD_EDGES, 1, W, H, in);
    snprintf(name, sizeof name, "%s/edges.png", dir);
    assert_ok(masu_image_save_png(name, in, W, H, 0, error, sizeof error));
    struct masu_ref_image from = {rgb, W, H, 0};
    struct masu_ref_smaa with = masu_ref_smaa_preset(2);
    masu_ref_from_rgba8(in, W, H, 0, rgb);
    masu_ref_smaa_edges(&from, &with, edges);
    masu_ref_smaa_weights(edges, W, H, &with, weights);
    masu_ref_smaa_blend(&from, weights, smooth);
    masu_ref_to_rgba8(smooth, W, H, want);
    assert_true(max_difference(in, want, BYTES) > 20);
    snprintf(name, sizeof name, "%s/smooth.png", dir);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(masu("upscale %s/edges.png %s %s", dir, name, ways[i]), 0);
        assert_ok(masu_image_load_png(name, &image, error, sizeof error));
        assert_true(image.width == W && image.height == H);
        assert_true(max_difference(image.rgba, want, BYTES) <= 2);
        masu_image_free(&image);
    }
    assert_int_equal(masu("upscale %s/edges.png %s --aa fxaa --size 100x76", dir, name), 0);
    assert_ok(masu_image_load_png(name, &image, error, sizeof error));
    assert_true(image.width == 2 * W && image.height == 2 * H);
    masu_image_free(&image);
}

static void the_example_of_the_readme_draws(void **state) {
    (void)state;
    char command[1024], error[ERROR_SIZE];
    const char *build = getenv("BUILD");
    struct masu_image image;
    snprintf(command, sizeof command, "%s/examples/minimal %s %s/example.png >%s/out",
             build ? build : "build", scene_path("test_both"), dir, dir);
    assert_int_equal(system(command), 0);
    read_text("out", out_text, sizeof out_text);
    assert_non_null(strstr(out_text, "bytes host"));
    snprintf(command, sizeof command, "%s/example.png", dir);
    assert_ok(masu_image_load_png(command, &image, error, sizeof error));
    assert_int_equal(image.width, 1280);
    masu_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_and_version_are_there_for_every_command),
        cmocka_unit_test(bench_image_has_a_line_for_each_case),
        cmocka_unit_test(wrong_command_lines_are_exit_code_2),
        cmocka_unit_test(bad_scene_files_are_named_with_their_fault),
        cmocka_unit_test(an_output_that_cannot_be_written_leaves_nothing_and_harms_nothing),
        cmocka_unit_test(an_unknown_device_lists_those_that_are_there),
        cmocka_unit_test(render_writes_the_picture_and_its_numbers_under_validation),
        cmocka_unit_test(draw_bench_compares_pictures_and_counts_triangles),
        cmocka_unit_test(trace_bench_agrees_with_embree),
        cmocka_unit_test(light_bench_compares_pictures_and_counts_lights),
        cmocka_unit_test(plan_says_what_is_in_and_what_was_left_out),
        cmocka_unit_test(the_governor_reports_what_it_has_done),
        cmocka_unit_test(rays_choose_what_finds_polygons),
        cmocka_unit_test(the_example_of_the_readme_draws),
        cmocka_unit_test(upscale_runs_the_passes_of_the_frame_on_a_file_and_keeps_alpha),
        cmocka_unit_test(upscale_smooths_edges),
    };
    return cmocka_run_group_tests_name("cli", tests, make_dir, remove_dir);
}
