/* test_bench_hostile.c: folders of `masu bench` from an untrusted source: any text in them remains
 * text in the page, in the plots' commands and on the disk. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/index.h"
#include "bench/page.h"
#include "bench/report.h"
#include "cli/gnuplot.h"
#include "cli/markup.h"
#include "image.h"
#include "support/files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HOSTILE "<script>'`touch STRUCK`'</script>&"

static void write_in(const char *folder, const char *file, const char *text) {
    char name[512];
    snprintf(name, sizeof name, "%s/%s", folder, file);
    write_text(name, text);
}

static void make_picture(const char *name) {
    static uint8_t rgba[8 * 8 * 4];
    char error[512];
    if (!masu_image_save_png(in_scratch(name), rgba, 8, 8, 0, error, sizeof error))
        fail_msg("%s", error);
}

static void write_row(FILE *f, const char *setting, const char *parent) {
    masu_row row;
    memset(&row, 0, sizeof row);
    snprintf(row.setting, sizeof row.setting, "%s", setting);
    snprintf(row.parent, sizeof row.parent, "%s", parent);
    snprintf(row.technique, sizeof row.technique, "%s",
             strcmp(setting, "base") ? "sharpen" : "base");
    row.ratio = row.gpu_ratio = strcmp(setting, "base") ? 0.5 : 1.0;
    row.flip = strcmp(setting, "base") ? 0.2 : 0.1;
    assert_true(masu_rows_write(f, &row) > 0);
}

/* The base and one setting; every text of sweep.json and machine.json that the page shows is `text`. */
static void make_folder(const char *name, const char *setting, const char *text) {
    char json[4096], path[512];
    mkdir(in_scratch(name), 0777);
    snprintf(path, sizeof path, "%s/pictures", name);
    mkdir(in_scratch(path), 0777);
    snprintf(json, sizeof json,
             "{\"scene\": \"%s\", \"hash\": \"%s\", \"driver\": \"%s\", \"depth\": \"%s\", "
             "\"width\": 8, \"height\": 8,"
             " \"time\": 1.0, \"positions\": 4, \"frames\": 8, \"runs\": 2, \"settings\": ["
             "{\"setting\": \"base\", \"knobs\": {}}, {\"setting\": \"%s\", \"knobs\": {}}],"
             " \"dropped\": [{\"setting\": \"%s\", \"why\": \"%s\"}]}",
             text, text, text, text, setting, text, text);
    write_in(name, "sweep.json", json);
    snprintf(json, sizeof json,
             "[{\"cpu\": \"%s\", \"threads\": 2, \"driver\": \"%s\", \"masu\": \"%s\", \"date\": "
             "\"%s\"}]",
             text, text, text, text);
    write_in(name, "machine.json", json);
    snprintf(path, sizeof path, "%s/results.csv", name);
    FILE *f = fopen(in_scratch(path), "w");
    assert_non_null(f);
    assert_true(masu_rows_header(f) > 0);
    write_row(f, "base", "base");
    write_row(f, setting, "base");
    assert_int_equal(fclose(f), 0);
    snprintf(path, sizeof path, "%s/truth.png", name);
    make_picture(path);
    snprintf(path, sizeof path, "%s/pictures/base.png", name);
    make_picture(path);
}

/* No element loads another file, and the size is within the limit of pages. */
static void check_alone(const char *page) {
    assert_in_range(strlen(page), 1, MASU_PAGE_BYTES);
    for (const char *at = page; (at = strstr(at, "src=\"")); at++)
        assert_int_equal(strncmp(at, "src=\"data:image/", 16), 0);
    assert_null(strstr(page, "<link"));
    assert_null(strstr(page, "url("));
    assert_null(strstr(page, "@import"));
}

/* Rungs at the budget, above it, and none. */
static void the_first_rung_within_the_budget_is_the_verdict(void **state) {
    (void)state;
    masu_row rows[3] = {{.wall_p50 = 40, .flip = 0.1, .rest_flip = 0.1},
                        {.wall_p50 = 20, .gpu_p50 = 1, .flip = 0.2, .rest_flip = 0.4},
                        {.wall_p50 = 30, .flip = 0.3, .rest_flip = 0.3}};
    const masu_row *rungs[] = {&rows[0], &rows[1], &rows[2]};
    masu_verdict v;
    assert_false(masu_verdict_find(rungs, 0, &v));
    assert_true(masu_verdict_find(rungs, 3, &v));
    assert_true(!v.holds && v.rung == 1 && v.ms == 20.0 && fabs(v.error - 0.3) < 1e-9);
    rows[2].wall_p50 = MASU_PAGE_BUDGET_MS;
    assert_true(masu_verdict_find(rungs, 3, &v) && v.holds && v.rung == 2);
    rows[2].wall_p50 = nextafter(MASU_PAGE_BUDGET_MS, 100.0);
    assert_true(masu_verdict_find(rungs, 3, &v) && !v.holds && v.rung == 2);
    rows[1].plausible = 1.0; /* timestamps count */
    assert_true(masu_verdict_find(rungs, 3, &v) && v.holds && v.rung == 1 && v.ms == 1.0);
}

/* Noise does not compress: its size is halved until the image fits. */
static void an_image_fits_its_bytes(void **state) {
    (void)state;
    static uint8_t rgba[256 * 256 * 4];
    uint32_t seed = 1;
    for (size_t i = 0; i < sizeof rgba; i++)
        rgba[i] = (uint8_t)((seed = seed * 1664525u + 1013904223u) >> 24);
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    assert_true(masu_page_image(f, rgba, 256, 256, 6000, "shot", "<a \"b\">"));
    assert_int_equal(fclose(f), 0);
    assert_in_range(bytes, 1000, 6000 * 4 / 3 + 200);
    assert_non_null(
        strstr(text, "alt=\"&lt;a &quot;b&quot;&gt;\" src=\"data:image/jpeg;base64,/9j/"));
    free(text);
}

/* Two scenes, one with markup and URL syntax in its name, and one without a page. */
static void the_index_links_every_scene(void **state) {
    (void)state;
    char error[1024], path[256];
    uint32_t count;
    masu_report_result result;
    mkdir(in_scratch("all"), 0777);
    snprintf(path, sizeof path, "%s", in_scratch("all"));
    assert_false(masu_bench_index(path, &count, error, sizeof error));
    static const char *const names[] = {"all/a<b>#%", "all/plain"};
    for (int i = 0; i < 2; i++) {
        char picture[256], folder[256];
        make_folder(names[i], "scale=0.5", "x");
        snprintf(picture, sizeof picture, "%s/pictures/scale=0.5.png", names[i]);
        make_picture(picture);
        snprintf(folder, sizeof folder, "%s", in_scratch(names[i]));
        if (!masu_report_write(folder, &result, error, sizeof error)) fail_msg("%s", error);
    }
    assert_int_equal(remove(in_scratch("all/plain/index.html")), 0);
    if (!masu_bench_index(path, &count, error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(count, 2);
    char *page = read_file(in_scratch("all/index.html"), NULL);
    assert_non_null(strstr(page, "href=\"./a%3Cb%3E%23%25/index.html\">a&lt;b&gt;#%</a>"));
    assert_non_null(strstr(page, "href=\"./plain/ladder.json\">plain</a>"));
    check_alone(page);
    free(page);
}

/* More folders than any fixed list had room for; all of them are one. */
static void the_index_has_no_most(void **state) {
    (void)state;
    enum { FOLDERS = 1100 };
    char error[1024], path[256], name[64];
    uint32_t count, found = 0;
    masu_report_result result;
    mkdir(in_scratch("many"), 0777);
    make_folder("one", "scale=0.5", "x");
    make_picture("one/pictures/scale=0.5.png");
    snprintf(path, sizeof path, "%s", in_scratch("one"));
    if (!masu_report_write(path, &result, error, sizeof error)) fail_msg("%s", error);
    for (int i = 0; i < FOLDERS; i++) {
        snprintf(name, sizeof name, "many/%04d", i);
        assert_int_equal(symlink("../one", in_scratch(name)), 0);
    }
    snprintf(path, sizeof path, "%s", in_scratch("many"));
    if (!masu_bench_index(path, &count, error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(count, FOLDERS);
    char *page = read_file(in_scratch("many/index.html"), NULL);
    for (const char *at = page; (at = strstr(at, "<a href=")); at++) {
        snprintf(name, sizeof name, "<a href=\"./%04u/index.html\">", found++);
        assert_int_equal(strncmp(at, name, strlen(name)), 0);
    }
    assert_int_equal(found, FOLDERS);
    free(page);
}

static void what_a_folder_says_is_text_in_its_page(void **state) {
    (void)state;
    char error[1024], path[256];
    masu_report_result result;
    make_folder("page", "scale=0.5", HOSTILE);
    make_picture("page/pictures/scale=0.5.png");
    snprintf(path, sizeof path, "%s", in_scratch("page"));
    if (!masu_report_write(path, &result, error, sizeof error)) fail_msg("%s", error);
    char *page = read_file(in_scratch("page/index.html"), NULL);
    const char *script = strstr(page, "<script>\n"); /* the page's own, and no other */
    assert_non_null(script);
    assert_null(strstr(page, "<script>'"));
    assert_null(strstr(script + 1, "<script"));
    check_alone(page);
    uint32_t shown = 0;
    for (const char *at = page; (at = strstr(at, "&lt;script&gt;")); at++) shown++;
    assert_true(shown >= 8); /* scene twice, hash, driver, depth, one of machine.json's, the omitted
                                rows */
    assert_non_null(strstr(page, "; scene &lt;script&gt;"));
    free(page);
}

/* Inside single quotes gnuplot interprets only the closing quote. */
static void a_title_is_no_command_of_gnuplot(void **state) {
    (void)state;
    char error[1024], path[256];
    masu_report_result result;
    make_folder("plots", "scale=0.5", "it's `touch STRUCK`.masu");
    make_picture("plots/pictures/scale=0.5.png");
    snprintf(path, sizeof path, "%s", in_scratch("plots"));
    if (!masu_report_write(path, &result, error, sizeof error)) fail_msg("%s", error);
    assert_false(is_in_scratch("plots/plots/STRUCK"));
    char *text = read_file(in_scratch("plots/plots/plots.gp"), NULL);
    assert_non_null(strstr(text, "set title 'it''s `touch STRUCK`.masu: "));
    free(text);
}

static void a_quoted_text_is_one_string_of_gnuplot(void **state) {
    (void)state;
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    assert_non_null(f);
    fprintf(f, "x = ");
    masu_gnuplot_quote(f, "a'; system \"touch STRUCK\"\nsystem 'touch STRUCK' #`touch STRUCK`");
    fprintf(f, "\n$d << EOD\n1 2 ");
    masu_gnuplot_label(f, "\"`touch STRUCK`\nEOD\nsystem 'touch STRUCK'");
    fprintf(f, "\nEOD\nset terminal svg\nset output 'out.svg'\nplot $d using 1:2:3 with labels "
               "noenhanced\n");
    assert_int_equal(fclose(f), 0);
    masu_gnuplot_end end = masu_gnuplot_run(scratch, text, bytes);
    assert_int_not_equal(end, MASU_GNUPLOT_FAILED);
    if (end == MASU_GNUPLOT_DRAWN) assert_true(is_in_scratch("out.svg"));
    assert_false(is_in_scratch("STRUCK"));
    assert_non_null(strstr(
        text, "x = 'a''; system \"touch STRUCK\" system ''touch STRUCK'' #`touch STRUCK`'\n"));
    assert_non_null(strstr(text, "1 2 \"'`touch STRUCK` EOD system 'touch STRUCK'\"\n"));
    free(text);
}

static bool merge(const char *part, const char *out, char *error, size_t error_size) {
    char from[256], to[256];
    snprintf(from, sizeof from, "%s", in_scratch(part));
    snprintf(to, sizeof to, "%s", in_scratch(out));
    const char *const parts[] = {from};
    return masu_sweep_merge(to, parts, 1, error, error_size);
}

static void a_setting_does_not_lead_out_of_the_folder(void **state) {
    (void)state;
    static const char *const names[] = {"../../ESCAPED", "/tmp/ESCAPED", ".ESCAPED",
                                        "a/ESCAPED",     "a\\ESCAPED",   "ESCAPED`x`"};
    char error[1024], path[256];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "out%zu", i);
        make_folder("part", names[i], "x");
        mkdir(in_scratch("part/pictures/a"), 0777);
        make_picture("ESCAPED.png"); /* part/pictures/../../ESCAPED.png: the file exists */
        make_picture("part/pictures/a/ESCAPED.png");
        assert_false(merge("part", path, error, sizeof error));
        assert_non_null(strstr(error, "results.csv"));
        assert_null(strchr(error, '\n'));
        snprintf(path, sizeof path, "out%zu/pictures/a", i);
        assert_false(is_in_scratch(path));
        char out[4096];
        assert_false(masu_sweep_picture("folder", names[i], "", out));
    }
    char out[4096];
    assert_true(masu_sweep_picture("folder", "scale=0.5+aa=smaa-low", "", out));
    assert_string_equal(out, "folder/pictures/scale=0.5+aa=smaa-low.png");
}

static void what_is_no_picture_is_not_copied(void **state) {
    (void)state;
    char error[1024];
    make_folder("bytes", "scale=0.5", "x");
    write_in("bytes", "pictures/scale=0.5.png", "#!/bin/sh\ntouch STRUCK\n");
    assert_false(merge("bytes", "copied", error, sizeof error));
    assert_non_null(strstr(error, "scale=0.5.png"));
    assert_false(is_in_scratch("copied/pictures/scale=0.5.png"));
    make_picture("bytes/pictures/scale=0.5.png");
    assert_true(merge("bytes", "copied", error, sizeof error));
    assert_true(is_in_scratch("copied/pictures/scale=0.5.png"));
}

static void a_size_that_is_none_is_refused(void **state) {
    (void)state;
    static const char *const sizes[] = {"-1", "1e300", "65536", "0", "8.5e9", "\"x\""};
    char error[1024], path[256], json[256];
    masu_setting_list list;
    make_folder("size", "scale=0.5", "x");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        snprintf(json, sizeof json,
                 "{\"width\": %s, \"height\": 65536, \"settings\": [{\"setting\": \"base\"}]}",
                 sizes[i]);
        write_in("size", "sweep.json", json);
        snprintf(path, sizeof path, "%s", in_scratch("size"));
        assert_false(masu_report_rungs(path, &list, error, sizeof error));
        assert_non_null(strstr(error, "size"));
    }
}

static void every_field_of_markup_is_escaped(void **state) {
    (void)state;
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    assert_non_null(f);
    masu_markup(f, "<a b=\"%s\">%c%d %u %.2f%% %+.1e|%-4d|</a>", "<&\">", '<', -1, 7u, 0.5, 2.0, 3);
    assert_int_equal(fclose(f), 0);
    assert_string_equal(text, "<a b=\"&lt;&amp;&quot;&gt;\">&lt;-1 7 0.50% +2.0e+00|3   |</a>");
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_folder_says_is_text_in_its_page),
        cmocka_unit_test(the_first_rung_within_the_budget_is_the_verdict),
        cmocka_unit_test(an_image_fits_its_bytes),
        cmocka_unit_test(the_index_links_every_scene),
        cmocka_unit_test(the_index_has_no_most),
        cmocka_unit_test(a_title_is_no_command_of_gnuplot),
        cmocka_unit_test(a_quoted_text_is_one_string_of_gnuplot),
        cmocka_unit_test(a_setting_does_not_lead_out_of_the_folder),
        cmocka_unit_test(what_is_no_picture_is_not_copied),
        cmocka_unit_test(a_size_that_is_none_is_refused),
        cmocka_unit_test(every_field_of_markup_is_escaped),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
