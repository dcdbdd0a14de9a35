/* test_bench.c: runs `masu bench` as a user does: the content of the folder, resuming an
 * interrupted run, merging shards, timing rungs again, and rejected input. Times are only checked
 * for being times. */
#include "support/support.h"
#include "support/cli.h"

#include "image.h"
#include "metric/image.h"
#include "settings/ladder.h"
#include "bench/page.h"
#include "bench/report.h"
#include "bench/sweep.h"

#include <fcntl.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* `masu bench ARGUMENTS`. */
static int bench(const char *format, ...) {
    va_list args;
    va_start(args, format);
    int code = cli_run_list("bench", format, args);
    va_end(args);
    return code;
}

/* One line on stderr: a complaint or a warning. */
static void said(const char *part) {
    if (!strstr(cli_err, part)) fail_msg("'%s' is not in: %s", part, cli_err);
    assert_ptr_equal(strchr(cli_err, '\n'), cli_err + strlen(cli_err) - 1);
}

static masu_row *rows_of(const char *folder, uint32_t *count) {
    char path[256], error[512];
    snprintf(path, sizeof path, "%s/%s", scratch, folder);
    masu_row *rows = masu_sweep_rows(path, count, error, sizeof error);
    if (!rows) fail_msg("%s", error);
    return rows;
}

/* ---- Well-formed ----------------------------------------------------------------------------- */

/* Tags close in the reverse order of opening, attribute values are quoted, and there is no stray
 * '<' or '&': the rules of XML, except for names. */
static void check_markup(const char *name) {
    char *text = read_file(in_scratch(name), NULL), stack[64][32];
    uint32_t depth = 0, elements = 0;
    for (const char *c = text; *c;) {
        if (*c == '&' && strcspn(c, ";") > 8) fail_msg("%s: a lone &", name);
        if (*c != '<') {
            c++;
            continue;
        }
        if (c[1] == '!' ||
            c[1] == '?') { /* comments have no '>' inside, in our and gnuplot's output */
            const char *end = strncmp(c, "<!--", 4) ? strchr(c, '>') : strstr(c, "-->");
            assert_non_null(end);
            c = end + 1;
            continue;
        }
        bool closes = c[1] == '/', empty = false, quoted = false;
        char tag[32] = "";
        size_t n = strcspn(c + 1 + closes, " />\n\t");
        if (n == 0 || n >= sizeof tag) fail_msg("%s: no tag: %.40s", name, c);
        memcpy(tag, c + 1 + closes, n);
        char quote = 0;
        for (c++; *c && (quoted || *c != '>'); c++) {
            if (!quoted && (*c == '"' || *c == '\'')) {
                quote = *c;
                quoted = true;
            } else if (quoted && *c == quote) {
                quoted = false;
            } else if (*c == '<') {
                fail_msg("%s: '<' inside <%s", name, tag);
            }
        }
        assert_true(*c == '>');
        empty = c[-1] == '/';
        c++;
        elements++;
        if (closes) {
            if (!depth || strcmp(stack[depth - 1], tag) != 0)
                fail_msg("%s: </%s> closes <%s>", name, tag, depth ? stack[depth - 1] : "nothing");
            depth--;
        } else if (!empty) {
            assert_true(depth < 64);
            memcpy(stack[depth++], tag, sizeof tag);
        }
    }
    if (depth) fail_msg("%s: <%s> is left open", name, stack[depth - 1]);
    assert_true(elements > 20);
    free(text);
}

/* ---- Tests ----------------------------------------------------------------------------------- */

#define SMALL "--quick --size 64x36"

/* Finite if expected, otherwise NaN. */
static void there_is(double value, bool wanted, const char *what, const masu_row *row) {
    if (wanted != (isfinite(value) && value >= 0))
        fail_msg("%s: %s is %g", row->setting, what, value);
    if (!wanted) assert_true(isnan(value));
}

static void check_columns(const masu_row *rows, uint32_t count, bool surfaces, bool traced) {
    for (uint32_t i = 0; i < count; i++) {
        const masu_row *r = &rows[i];
        bool whole = r->render_width >= 64 && r->render_height >= 36;
        bool after = strstr(r->setting, "aa=") || strstr(r->setting, "sharpen=on");
        there_is(r->hitmiss_pct, surfaces, "hit/miss", r);
        there_is(r->depth_mean_px, surfaces, "depth", r);
        there_is(r->depth_p99_px, surfaces, "p99 of depth", r);
        there_is(r->hdr_flip, whole && !after, "HDR-FLIP", r);
        there_is(r->specular_relmse, whole && traced, "relMSE", r);
        if (surfaces) assert_true(r->hitmiss_pct <= 100);
        if (whole && !after) assert_true(r->hdr_flip > 0 && r->hdr_flip <= 1);
    }
}

static void check_rows(const char *folder, uint32_t least) {
    uint32_t count;
    masu_row *rows = rows_of(folder, &count);
    assert_true(count >= least);
    assert_string_equal(rows[0].setting, "base");
    assert_true(rows[0].ratio > 0.999 && rows[0].ratio < 1.001);
    for (uint32_t i = 0; i < count; i++) {
        const masu_row *r = &rows[i];
        char name[300];
        snprintf(name, sizeof name, "%s/pictures/%s.png", folder, r->setting);
        assert_true(is_in_scratch(name));
        assert_true(r->wall_min > 0 && r->wall_p50 >= r->wall_min && r->wall_p99 >= r->wall_p50);
        assert_true(fabs(r->least_ratio - r->wall_min / r->base_wall_min) < 1e-6 * r->least_ratio);
        assert_true(r->ratio > 0 && r->plausible >= 0 && r->plausible <= 1);
        assert_true(r->flip > 0 && r->flip <= r->flip_p99 && r->rmse > 0 && r->ssim < 1);
        assert_true(fabs(r->psnr_db - 20 * log10(255 / r->rmse)) < 1e-4);
        assert_true(r->rest_flip > 0 && r->rest_flip <= 1 && r->fast_flip > 0 && r->fast_flip <= 1);
        if (strstr(r->setting, "temporal=on")) { /* the still has all of the samples */
            const masu_row *without = masu_rows_find(rows, count, r->parent);
            print_message("  %s: still %.4f, slow %.4f, fast %.4f; %s: %.4f\n",
                          r->setting, r->rest_flip, r->flip, r->fast_flip, r->parent,
                          without ? without->flip : (double)NAN);
            assert_true(without && r->rest_flip < 0.8 * without->rest_flip);
            if (r->render_width < 64)
                assert_true(r->rest_flip < 0.9 * r->flip && fabs(r->fast_flip - r->flip) > 0);
        }
        assert_true(r->device_bytes > 0 && r->render_width <= 64 && r->render_height <= 36);
        assert_non_null(masu_rows_find(rows, count, r->parent));
        for (uint32_t k = 0; k < i; k++) assert_string_not_equal(rows[k].setting, r->setting);
    }
    /* A static scene without reflections does not flicker; fewer pixels have a higher error. */
    const masu_row *least_pixels = masu_rows_find(rows, count, "scale=0.4");
    assert_non_null(least_pixels);
    assert_true(least_pixels->flip > rows[0].flip && least_pixels->rmse > rows[0].rmse);
    assert_true(rows[0].flicker >= 0 && rows[0].flicker <= 0);
    free(rows);
}

static uint8_t *picture_at_rest(const char *folder, const char *setting, struct masu_image *size) {
    char path[512], error[1024];
    snprintf(path, sizeof path, "%s/%s/pictures/%s.rest.png", scratch, folder, setting);
    if (!masu_file_exists(path))
        snprintf(path, sizeof path, "%s/%s/pictures/%s.png", scratch, folder, setting);
    if (!masu_image_load_png(path, size, error, sizeof error)) fail_msg("%s", error);
    return size->rgba;
}

/* Settings that are no jump from the one before. */
static uint32_t without_jumps(const char *folder, const masu_row *rows, uint32_t *rungs,
                              uint32_t n) {
    uint32_t kept = 0;
    struct masu_image before = {0}, shown = {0};
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t *pixels = picture_at_rest(folder, rows[rungs[i]].setting, &shown);
        if (i && masu_metric_difference(pixels, before.rgba, shown.width, shown.height) >
                     MASU_LADDER_STEP) {
            masu_image_free(&shown);
            continue;
        }
        masu_image_free(&before);
        before = shown;
        rungs[kept++] = rungs[i];
    }
    masu_image_free(&before);
    return kept;
}

/* The rungs of ladder.json match the rows, each with all knobs. */
static void check_ladder(const char *folder) {
    uint32_t count, rungs[MASU_SETTINGS_MOST];
    masu_ladder_point points[MASU_SETTINGS_MOST];
    masu_row *rows = rows_of(folder, &count);
    char path[256];
    snprintf(path, sizeof path, "%s/%s/ladder.json", scratch, folder);
    json_t *root = json_load_file(path, 0, NULL);
    assert_non_null(root);
    const json_t *list = json_object_get(root, "rungs");
    bool stamps = !strcmp(json_string_value(json_object_get(root, "clock")), "timestamps");
    assert_true(count <= MASU_SETTINGS_MOST);
    for (uint32_t i = 0; i < count; i++)
        points[i] = (masu_ladder_point){stamps ? rows[i].gpu_ratio : rows[i].ratio,
                                        masu_row_error(&rows[i])};
    for (uint32_t i = 0; i < count; i++) {
        if (rows[i].flicker > rows[0].flicker + MASU_LADDER_FLICKER) points[i].time = 0.0;
    }
    uint32_t n = masu_ladder_rungs(points, count, MASU_LADDER_APART, MASU_LADDER_BETTER,
                                   MASU_MAX_RUNGS, rungs);
    n = without_jumps(folder, rows, rungs, n);
    assert_true(n >= 1);
    assert_int_equal(json_array_size(list), n);
    double before = HUGE_VAL;
    for (uint32_t i = 0; i < n; i++) {
        const json_t *rung = json_array_get(list, i), *knobs = json_object_get(rung, "knobs");
        const masu_row *row = &rows[rungs[i]];
        double ratio = json_number_value(json_object_get(rung, "ratio"));
        assert_string_equal(json_string_value(json_object_get(rung, "setting")), row->setting);
        assert_true(fabs(json_number_value(json_object_get(rung, "flip")) - masu_row_error(row)) <
                    1e-9);
        assert_true(before >= MASU_LADDER_APART * ratio && ratio > 0);
        before = ratio;
        for (const masu_knob *k = masu_knob_table(); k->name; k++)
            assert_non_null(json_object_get(knobs, k->name));
        double scale = json_number_value(json_object_get(knobs, "scale"));
        assert_true(fabs(floor(64 * scale + 0.5) - row->render_width) <= 1);
    }
    json_decref(root);
    free(rows);
}

static void a_folder_has_rows_rungs_and_a_page(void **state) {
    (void)state;
    assert_int_equal(bench("%s " SMALL " --out %s/whole", scene_path("test_both"), scratch), 0);
    check_rows("whole", 10);
    check_ladder("whole");
    check_markup("whole/index.html");
    uint32_t count;
    masu_row *rows = rows_of("whole", &count);
    check_columns(rows, count, true, false);
    /* The same march: its surfaces are equal to those of the most exact rung. Few steps miss
     * some. */
    const masu_row *few = masu_rows_find(rows, count, "march_steps=64");
    assert_non_null(few);
    assert_true(rows[0].hitmiss_pct <= 0 && rows[0].depth_mean_px <= 0);
    assert_true(few->hitmiss_pct > 0 && few->hitmiss_pct < 5 && few->depth_mean_px > 0);
    free(rows);
    if (is_in_scratch("whole/plots/front.svg")) {
        check_markup("whole/plots/front.svg");
        check_markup("whole/plots/techniques.svg");
    } else {
        assert_non_null(strstr(cli_err, "gnuplot not found"));
    }
    char *page = read_file(in_scratch("whole/index.html"), NULL);
    assert_non_null(strstr(page, "data:image/jpeg;base64,/9j/"));
    assert_null(strstr(page, "src=\"h")); /* no external files */
    assert_true(strlen(page) <= MASU_PAGE_BYTES);
    assert_non_null(strstr(page, "The ladder"));
    static const char *const parts[] = {"HDR-FLIP",   "hit/miss", "relMSE",
                                        "<td>-</td>", "Masu 0.",  " UTC: "};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (!strstr(page, parts[i])) fail_msg("the page has no %s", parts[i]);
    }
    assert_non_null(strstr(page, "<h2>Images"));
    free(page);
    /* The scene has an SDF and polygons, and no shadow map or reflections. */
    char *json = read_file(in_scratch("whole/sweep.json"), NULL);
    assert_non_null(strstr(json, "march_steps=64"));
    assert_non_null(strstr(json, "the scene has no shadow map"));
    assert_non_null(strstr(json, "no reflections are traced"));
    assert_non_null(strstr(json, "the most exact rung"));
    free(json);
}

/* Compares the folder of the test before with itself. test_bench_against tests the content. */
static void two_folders_are_compared(void **state) {
    (void)state;
    char *text;
    assert_int_equal(bench("%s/whole --against %s/whole", scratch, scratch), 0);
    assert_non_null(strstr(cli_out, "worst: FLIP +0.00 %"));
    assert_non_null(strstr(cli_out, ", 0 without a row"));
    assert_int_equal(bench("%s/whole --against %s/whole --csv %s/csv", scratch, scratch, scratch),
                     0);
    assert_string_equal(cli_out, "");
    text = read_file(in_scratch("csv"), NULL);
    assert_int_equal(strncmp(text, "rung,setting,", 13), 0);
    free(text);
    assert_int_equal(bench("%s/whole --against %s/none", scratch, scratch), 1);
    said("sweep.json");
    assert_int_equal(bench("--against %s/whole", scratch), 2);
    said("--against");
    assert_int_equal(bench("a.masu --csv %s/csv --out %s/x", scratch, scratch), 2);
    said("--csv");
}

static void reflections_have_an_error_of_their_own(void **state) {
    (void)state;
    const char *scene = scene_path("test_reflections");
    uint32_t count, again;
    /* The base and no reflections have the numbers 0 and 10; the same at half size has 11. */
    for (int i = 0; i < 2; i++) {
        assert_int_equal(bench("%s " SMALL " --reference 4 --runs 1 --shard %s --validate"
                               " --truth %s/mirror.png --out %s/mirror%d",
                               scene, i ? "11/24" : "0/10", scratch, scratch, i),
                         0);
    }
    assert_true(is_in_scratch("mirror.pfm") && is_in_scratch("mirror.specular.pfm"));
    assert_int_equal(bench("--merge %s/mirror0 %s/mirror1 --out %s/mirrors", scratch, scratch,
                           scratch),
                     0);
    masu_row *rows = rows_of("mirrors", &count);
    assert_int_equal(count, 3);
    check_columns(rows, count, true, true);
    const masu_row *none = masu_rows_find(rows, count, "specular=off");
    assert_non_null(none);
    /* Perfect mirrors: a ray is exact. Without reflections their light is missing. */
    assert_true(rows[0].specular_relmse < 1e-4 && none->specular_relmse > 0.01);
    assert_true(none->hdr_flip > rows[0].hdr_flip);
    /* The first images, read again from the files, and compared with the ground truth. */
    assert_int_equal(bench("%s " SMALL " --reference 4 --runs 1 --shard 0/24"
                           " --truth %s/mirror.png --out %s/again",
                           scene, scratch, scratch),
                     0);
    masu_row *read = rows_of("again", &again);
    assert_int_equal(again, 1);
    assert_true(fabs(read[0].specular_relmse - rows[0].specular_relmse) <= 0);
    assert_true(fabs(read[0].hdr_flip - rows[0].hdr_flip) <= 0);
    free(read);
    free(rows);
}

/* One row makes a page. The field in double precision is next to this scene, and depth is compared
 * with it. */
static void one_row_is_a_page_and_depth_is_compared_with_the_field(void **state) {
    (void)state;
    char path[512];
    snprintf(path, sizeof path, "%s/stiff/blend.masu", made_dir());
    assert_int_equal(bench("%s --size 64x36 --positions 1 --runs 1 --shard 0/999 --out %s/few",
                           scene_path("test_both"), scratch),
                     0);
    /* One row is a page, too: with plots that have no arrow. */
    assert_int_equal(bench("--merge %s/few --out %s/lone", scratch, scratch), 0);
    check_markup("lone/index.html");
    check_ladder("lone");
    assert_int_equal(
        bench("%s --size 64x36 --positions 1 --runs 1 --shard 0/999 --out %s/exact", path, scratch),
        0);
    char *text = read_file(in_scratch("exact/sweep.json"), NULL);
    assert_non_null(strstr(text, "double precision"));
    free(text);
    uint32_t count;
    masu_row *rows = rows_of("exact", &count);
    assert_int_equal(count, 1);
    /* Not 0: the field's own march is in double precision. */
    assert_true(rows[0].depth_mean_px > 0 && rows[0].depth_mean_px < 0.1);
    assert_true(rows[0].hitmiss_pct < 1);
    free(rows);
}

/* The folder of the test before, with its last rows removed, one of them cut in half. */
static void a_run_that_was_stopped_goes_on(void **state) {
    (void)state;
    uint32_t before, after;
    masu_row *old = rows_of("whole", &before);
    char path[256];
    snprintf(path, sizeof path, "%s/whole/results.csv", scratch);
    char *text = read_file(in_scratch("whole/results.csv"), NULL), *cut = text + strlen(text) - 1;
    for (int lines = 0; lines < 3; cut -= lines < 3) lines += *cut == '\n';
    assert_int_equal(truncate(path, cut - text - 20), 0);
    free(text);
    assert_int_equal(bench("%s " SMALL " --out %s/whole", scene_path("test_both"), scratch), 0);
    assert_non_null(strstr(cli_out, "3 settings measured"));
    masu_row *rows = rows_of("whole", &after);
    assert_int_equal(after, before);
    for (uint32_t i = 0; i < after; i++) {
        assert_string_equal(rows[i].setting, old[i].setting);
        assert_true(fabs(rows[i].flip - old[i].flip) <= 0); /* images are the same in every run */
    }
    check_rows("whole", 10);
    free(rows);
    free(old);
    /* Stills of the rungs, compared with a reference of the same moment: the first rung has its
     * light. */
    assert_int_equal(cli_run("render %s -o %s/golden.exr --truth=16 --time 1 --size 128x72",
                             scene_path("test_both"), scratch),
                     0);
    assert_int_equal(bench("%s " SMALL " --out %s/whole --golden %s/golden.exr",
                           scene_path("test_both"), scratch, scratch),
                     0);
    assert_non_null(strstr(cli_out, " 0 settings measured"));
    text = read_file(in_scratch("whole/reference.csv"), NULL);
    const char *row = strchr(text, '\n');
    double ratio = 0, p95 = 1;
    assert_true(row && sscanf(row, "\n%*[^,],%lf,%lf", &ratio, &p95) == 2);
    print_message("  first rung: mean ratio %.4f, p95 of patches %.4f\n", ratio, p95);
    assert_true(fabs(ratio - 1) < 0.008 && p95 < 0.05);
    free(text);
    assert_int_equal(
        bench("%s " SMALL " --time 2 --out %s/whole", scene_path("test_both"), scratch), 1);
    said("another sweep");
    assert_int_equal(bench("%s " SMALL " --out %s/whole", scene_path("test_truth"), scratch), 1);
    said("another sweep");
}

/* Changes the rows of the text from `line` on to those of another build; at most `most` of the rows
 * remain. */
static void paint(char *line, uint32_t most) {
    for (char *next; (next = strchr(line, '\n')); line = next + 1, most--) {
        if (!most) break;
        assert_true(next - line > 17 && next[-17] == ',');
        memcpy(next - 16, "0123456789abcdef", 16);
    }
    *line = '\0';
}

/* Only one program, and one build, measures into a folder. */
static void rows_of_two_programs_are_refused(void **state) {
    (void)state;
    char path[256];
    uint32_t count;
    snprintf(path, sizeof path, "%s/whole", scratch);
    int folder = open(path, O_RDONLY | O_DIRECTORY);
    assert_int_equal(flock(folder, LOCK_EX | LOCK_NB), 0);
    assert_int_equal(bench("%s " SMALL " --out %s/whole", scene_path("test_both"), scratch), 1);
    said("another masu bench is writing to this folder");
    close(folder);
    free(rows_of("whole", &count));
    char *text = read_file(in_scratch("whole/results.csv"), NULL);
    char *changed = strdup(text), *last = strrchr(changed, ',') - 17; /* in the last row */
    while (last[-1] != '\n') last--;
    paint(last, 1);
    write_text("whole/results.csv", changed);
    assert_int_equal(bench("%s " SMALL " --out %s/whole", scene_path("test_both"), scratch), 1);
    said("another build of the program: found 0123456789abcdef");
    /* All by another build, with one still to be measured. */
    strcpy(changed, text);
    paint(strchr(changed, '\n') + 1, count - 1);
    write_text("whole/results.csv", changed);
    assert_int_equal(bench("%s " SMALL " --out %s/whole", scene_path("test_both"), scratch), 1);
    said("another build of the program: found 0123456789abcdef");
    write_text("whole/results.csv", text);
    free(changed);
    free(text);
}

static void shards_together_are_the_whole(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    uint32_t whole, merged, part;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(bench("%s " SMALL
                               " --shard %d/2 --truth %s/whole/truth.png --out %s/part%d",
                               scene, i, scratch, scratch, i),
                         0);
        assert_false(is_in_scratch(i ? "part1/index.html" : "part0/index.html"));
    }
    assert_int_equal(bench("--merge %s/part1 %s/part0 --out %s/merged", scratch, scratch, scratch),
                     0);
    masu_row *a = rows_of("whole", &whole), *b = rows_of("merged", &merged);
    free(rows_of("part1", &part));
    assert_int_equal(merged, whole);
    assert_int_equal(part, whole / 2);
    for (uint32_t i = 0; i < whole; i++) {
        assert_string_equal(a[i].setting, b[i].setting);
        assert_string_equal(a[i].parent, b[i].parent);
        assert_true(fabs(a[i].flip - b[i].flip) <= 0 && fabs(a[i].rmse - b[i].rmse) <= 0);
        assert_true(fabs(a[i].device_bytes - b[i].device_bytes) <= 0);
    }
    free(a);
    free(b);
    check_rows("merged", 10);
    assert_true(is_in_scratch("merged/truth.png") && is_in_scratch("merged/machine.json"));
    check_ladder("merged");
    check_markup("merged/index.html");
    /* Merging a folder into itself changes nothing; a folder of another sweep is rejected. */
    assert_int_equal(bench("--merge %s/merged --out %s/merged --quiet", scratch, scratch), 0);
    assert_string_equal(cli_out, "");
    assert_int_equal(bench("%s --quick --size 48x27 --shard 0/20 --out %s/other", scene, scratch),
                     0);
    assert_int_equal(bench("--merge %s/merged %s/other --out %s/both", scratch, scratch, scratch),
                     1);
    said("another sweep");
    assert_int_equal(bench("--merge %s/none --out %s/both2", scratch, scratch), 1);
    said("sweep.json");
}

/* Slow cascades and temporal state. */
static void slow_shadows_are_timed_over_their_whole_period(void **state) {
    (void)state;
    assert_int_equal(bench("%s " SMALL " --runs 1 --shard 8/13 --validate --out %s/slow",
                           scene_path("test_shadows"), scratch),
                     0);
    uint32_t count;
    masu_row *rows = rows_of("slow", &count);
    assert_int_equal(count, 1);
    assert_string_equal(rows[0].setting, "shadow_refresh=1-2-4-8");
    assert_true(rows[0].wall_min > 0);
    free(rows);
}

static masu_setting_list rungs_in(const char *folder) {
    masu_setting_list rungs;
    char path[256], error[512];
    snprintf(path, sizeof path, "%s/%s", scratch, folder);
    if (!masu_report_rungs(path, &rungs, error, sizeof error)) fail_msg("%s", error);
    return rungs;
}

/* All rows of the folder's tables have those errors, and the times of steady.csv if they have
 * any. */
static void check_steady(const char *folder, const masu_row *old, uint32_t old_count) {
    char name[256], error[512];
    uint32_t count, steady_count;
    snprintf(name, sizeof name, "%s/steady.csv", folder);
    char *text = read_file(in_scratch(name), NULL);
    masu_row *rows = rows_of(folder, &count);
    masu_row *steady = masu_rows_read(text, &steady_count, error, sizeof error);
    const masu_setting_list rungs = rungs_in(folder);
    assert_non_null(steady);
    assert_int_equal(count, old_count);
    for (uint32_t i = 0; i < rungs.count; i++) {
        if (!strcmp(rungs.id[i], "base")) continue;
        if (!masu_rows_find(steady, steady_count, rungs.id[i]))
            fail_msg("%s was not timed again", rungs.id[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        const masu_row *again = masu_rows_find(steady, steady_count, rows[i].setting);
        const masu_row *timed = again ? again : &old[i];
        assert_string_equal(rows[i].setting, old[i].setting);
        assert_true(fabs(rows[i].flip - old[i].flip) <= 0);
        assert_true(fabs(rows[i].ratio - timed->ratio) <= 0);
        assert_true(fabs(rows[i].wall_min - timed->wall_min) <= 0);
        assert_true(fabs(rows[i].base_wall_min - timed->base_wall_min) <= 0);
    }
    assert_null(masu_rows_find(steady, steady_count, "base"));
    free(steady);
    free(rows);
    free(text);
}

/* One table of a folder, without the times of the other. */
static masu_row *table_of(const char *folder, const char *file, uint32_t *count) {
    char name[256], error[512];
    snprintf(name, sizeof name, "%s/%s", folder, file);
    char *text = read_file(in_scratch(name), NULL);
    masu_row *rows = masu_rows_read(text, count, error, sizeof error);
    if (!rows) fail_msg("%s: %s", name, error);
    free(text);
    return rows;
}

static void write_table(const char *folder, const char *file, const masu_row *rows,
                        uint32_t count) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s/%s", scratch, folder, file);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(masu_rows_header(f) > 0);
    for (uint32_t i = 0; i < count; i++) assert_true(masu_rows_write(f, &rows[i]) > 0);
    assert_int_equal(fclose(f), 0);
}

/* Impossible times, in a table, for one setting or for all. */
static void spoil(const char *folder, const char *file, const char *setting) {
    uint32_t count;
    masu_row *rows = table_of(folder, file, &count);
    for (uint32_t i = 0; i < count; i++) {
        if (setting && strcmp(rows[i].setting, setting) != 0) continue;
        rows[i].ratio = rows[i].gpu_ratio = 1e-3;
        rows[i].wall_min = 12345;
        rows[i].flip = 0.9;
    }
    write_table(folder, file, rows, count);
    free(rows);
}

static bool spoilt(const masu_row *row) { return row->wall_min > 12344 || row->ratio < 2e-3; }

/* Makes the setting's still equal to the last rung's: it is no jump. */
static void no_jump(const char *folder, const char *setting) {
    const masu_setting_list rungs = rungs_in(folder);
    struct masu_image shown = {0};
    char path[512], error[1024];
    (void)picture_at_rest(folder, rungs.id[rungs.count - 1], &shown);
    snprintf(path, sizeof path, "%s/%s/pictures/%s.rest.png", scratch, folder, setting);
    if (!masu_image_save_png(path, shown.rgba, shown.width, shown.height, 0, error, sizeof error))
        fail_msg("%s", error);
    masu_image_free(&shown);
}

/* The folder of the first test, in which nothing else is left to do. One of its rows has a time so
 * short that it is certainly a rung; measured again, it is not. */
static void rungs_are_timed_again(void **state) {
    (void)state;
    const char *scene = scene_path("test_both"), *quick = "scale=0.4";
    uint32_t before, count;
    masu_row *table = table_of("whole", "results.csv", &count);
    masu_row *found = NULL;
    for (uint32_t i = 0; i < count; i++)
        found = strcmp(table[i].setting, quick) ? found : &table[i];
    assert_non_null(found);
    no_jump("whole", quick);
    found->ratio = found->gpu_ratio = 1e-3;
    write_table("whole", "results.csv", table, count);
    masu_row *old = rows_of("whole", &before);
    assert_true(spoilt(masu_rows_find(old, before, quick)));
    assert_false(is_in_scratch("whole/steady.csv"));
    assert_int_equal(bench("%s " SMALL " --steady 0.2 --validate --out %s/whole", scene, scratch),
                     0);
    check_steady("whole", old, before);
    check_ladder("whole");
    masu_row *rows = rows_of("whole", &count);
    assert_false(spoilt(masu_rows_find(rows, count, quick)));
    char *first = read_file(in_scratch("whole/steady.csv"), NULL);
    assert_int_equal(bench("%s " SMALL " --steady 0.2 --out %s/whole", scene, scratch), 0);
    cli_said("; 0 timed again");
    char *second = read_file(in_scratch("whole/steady.csv"), NULL);
    assert_string_equal(first, second);
    free(first);
    free(second);
    free(rows);
    free(table);
    free(old);
}

/* As in a clone of the project, which has only the rows of its reports. */
static void a_row_without_its_picture_is_measured_again(void **state) {
    (void)state;
    char path[512];
    uint32_t before, after;
    const char *setting = "scale=0.4"; /* it has been measured again */
    masu_row *old = rows_of("whole", &before);
    spoil("whole", "steady.csv", setting);
    snprintf(path, sizeof path, "%s/whole/pictures/%s.png", scratch, setting);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(
        bench("%s " SMALL " --steady 0.2 --out %s/whole", scene_path("test_both"), scratch), 0);
    cli_said(": 1 settings measured");
    masu_row *rows = rows_of("whole", &after);
    assert_int_equal(after, before);
    for (uint32_t i = 0; i < after; i++) {
        const masu_row *was = masu_rows_find(old, before, rows[i].setting);
        assert_non_null(was);
        assert_false(spoilt(&rows[i]));
        assert_true(fabs(rows[i].flip - was->flip) <= 0);
    }
    check_steady("whole", rows, after);
    check_ladder("whole");
    free(rows);
    free(old);
}

static void check_same_table(const char *a, const char *b, const char *file) {
    uint32_t a_count, b_count;
    masu_row *of_a = table_of(a, file, &a_count), *of_b = table_of(b, file, &b_count);
    assert_int_equal(a_count, b_count);
    for (uint32_t i = 0; i < a_count; i++) {
        const masu_row *row = masu_rows_find(of_b, b_count, of_a[i].setting);
        assert_non_null(row);
        assert_true(fabs(of_a[i].ratio - row->ratio) <= 0 && fabs(of_a[i].flip - row->flip) <= 0);
    }
    free(of_a);
    free(of_b);
}

static void both_tables_are_joined_and_forgotten_together(void **state) {
    (void)state;
    char path[512];
    uint32_t count, steady;
    assert_int_equal(bench("--merge %s/whole --out %s/joined", scratch, scratch), 0);
    check_same_table("whole", "joined", "results.csv");
    check_same_table("whole", "joined", "steady.csv");
    /* Times of a removed row are removed too, although its image exists. */
    spoil("joined", "steady.csv", NULL);
    snprintf(path, sizeof path, "%s/joined/results.csv", scratch);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(bench("%s " SMALL " --out %s/joined", scene_path("test_both"), scratch), 0);
    masu_row *rows = rows_of("joined", &count);
    free(table_of("joined", "steady.csv", &steady));
    assert_int_equal(steady, 0);
    assert_true(count >= 10);
    for (uint32_t i = 0; i < count; i++) assert_false(spoilt(&rows[i]));
    free(rows);
}

static void rungs_alone_are_measured_elsewhere(void **state) {
    (void)state;
    const char *scene = scene_path("test_both");
    const masu_setting_list rungs = rungs_in("whole");
    uint32_t count, whole_count;
    bool base = false;
    assert_int_equal(bench("%s " SMALL " --rungs-of %s/whole --steady 0.2 --out %s/alone", scene,
                           scratch, scratch),
                     0);
    masu_row *rows = rows_of("alone", &count), *whole = rows_of("whole", &whole_count);
    for (uint32_t i = 0; i < rungs.count; i++) {
        const masu_row *a = masu_rows_find(rows, count, rungs.id[i]);
        const masu_row *b = masu_rows_find(whole, whole_count, rungs.id[i]);
        base = base || !strcmp(rungs.id[i], "base");
        assert_non_null(a);
        assert_true(fabs(a->flip - b->flip) <= 0);
    }
    assert_int_equal(count, rungs.count + !base);
    check_steady("alone", rows, count);
    check_markup("alone/index.html");
    assert_int_equal(bench("%s/whole --against %s/alone", scratch, scratch), 0);
    assert_non_null(strstr(cli_out, ", 0 without a row"));
    free(rows);
    free(whole);
}

/* A folder "odd" with only two rows of the tests before: the base, and one that is certainly fast,
 * under a name that no scene has. */
static void make_odd(void) {
    char path[256];
    uint32_t count;
    masu_row *rows = rows_of("whole", &count);
    const masu_row *quick = masu_rows_find(rows, count, "scale=0.4");
    assert_non_null(quick);
    masu_row odd = *quick;
    snprintf(odd.setting, sizeof odd.setting, "scale=0.3");
    odd.ratio = odd.gpu_ratio = 0.5;
    snprintf(path, sizeof path, "%s/odd", scratch);
    assert_int_equal(mkdir(path, 0777), 0);
    snprintf(path, sizeof path, "%s/odd/results.csv", scratch);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    const masu_row *base = masu_rows_find(rows, count, "base");
    assert_true(masu_rows_header(f) > 0 && base && masu_rows_write(f, base) > 0);
    assert_true(masu_rows_write(f, &odd) > 0);
    assert_int_equal(fclose(f), 0);
    free(rows);
    char *text = read_file(in_scratch("whole/sweep.json"), NULL);
    for (char *at = text; (at = strstr(at, "scale=0.4\"")); at++) at[8] = '3';
    write_text("odd/sweep.json", text);
    free(text);
}

static void rungs_of_no_use_are_refused(void **state) {
    (void)state;
    make_odd();
    assert_int_equal(bench("%s " SMALL " --rungs-of %s/odd --out %s/y", scene_path("test_both"),
                           scratch, scratch),
                     1);
    said("scale=0.3 is not a setting of this sweep");
    assert_int_equal(bench("%s " SMALL " --rungs-of %s/none --out %s/y", scene_path("test_both"),
                           scratch, scratch),
                     1);
    said("none: cannot read sweep.json");
    assert_false(is_in_scratch("y"));
    assert_int_equal(bench("a.masu --out %s/y --steady -1", scratch), 2);
    said("steady");
    assert_int_equal(bench("a.masu --out %s/y --steady 1 --shard 0/2", scratch), 2);
    said("--steady");
    assert_int_equal(bench("a.masu --out %s/y --rungs-of %s/y", scratch, scratch), 2);
    said("one folder");
    assert_int_equal(bench("%s --quick --size 32x18 --rungs-of %s/whole --out %s/z",
                           scene_path("test_both"), scratch, scratch),
                     1);
    said("\"width\" in sweep.json");
    assert_int_equal(
        bench("--merge --rungs-of %s/odd %s/whole --out %s/y", scratch, scratch, scratch), 2);
    said("--rungs-of");
}

static void wrong_command_lines_are_exit_code_2(void **state) {
    (void)state;
    assert_int_equal(bench("--help"), 0);
    assert_non_null(strstr(cli_out, "--shard"));
    assert_int_equal(bench("--out %s/x", scratch), 2);
    said("no scene");
    assert_int_equal(bench("--merge --out %s/x", scratch), 2);
    said("no folder");
    assert_int_equal(bench("a.masu"), 2);
    said("--out");
    assert_int_equal(bench("a.masu b.masu --out %s/x", scratch), 2);
    said("b.masu");
    static const char *const shards[] = {"2/2", "1", "/", "1/", "-1/2", "0/0", "1/2x"};
    for (size_t i = 0; i < sizeof shards / sizeof *shards; i++) {
        assert_int_equal(bench("a.masu --out %s/x --shard %s", scratch, shards[i]), 2);
        said("shard");
    }
    assert_int_equal(bench("a.masu --out %s/x --runs 0", scratch), 2);
    said("runs");
    assert_int_equal(bench("%s/none.masu --out %s/x --quick", scratch, scratch), 1);
    said("none.masu");
    assert_false(is_in_scratch("x"));
    assert_int_equal(
        bench("%s --out %s/whole/results.csv/such --quick", scene_path("test_both"), scratch), 1);
    said("results.csv/such: cannot create the folder");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_folder_has_rows_rungs_and_a_page),
        cmocka_unit_test(two_folders_are_compared),
        cmocka_unit_test(a_run_that_was_stopped_goes_on),
        cmocka_unit_test(rows_of_two_programs_are_refused),
        cmocka_unit_test(shards_together_are_the_whole),
        cmocka_unit_test(slow_shadows_are_timed_over_their_whole_period),
        cmocka_unit_test(reflections_have_an_error_of_their_own),
        cmocka_unit_test(one_row_is_a_page_and_depth_is_compared_with_the_field),
        cmocka_unit_test(rungs_are_timed_again),
        cmocka_unit_test(a_row_without_its_picture_is_measured_again),
        cmocka_unit_test(both_tables_are_joined_and_forgotten_together),
        cmocka_unit_test(rungs_alone_are_measured_elsewhere),
        cmocka_unit_test(rungs_of_no_use_are_refused),
        cmocka_unit_test(wrong_command_lines_are_exit_code_2),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
