/* test_bench_against.c: comparison of two folders of `masu bench`: differences computed by hand,
 * missing rows, folders that do not belong together; and machine.json: the description of a CPU,
 * and runs that are added, merged and read again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/against.h"
#include "bench/machine.h"
#include "bench/sweep.h"
#include "support/files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct line {
    const char *setting;
    double flip, ratio, gpu_ratio;
} line;

static void write_rows(const char *folder, const line *lines, uint32_t count) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s/results.csv", scratch, folder);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(masu_rows_header(f) > 0);
    for (uint32_t i = 0; i < count; i++) {
        masu_row row;
        memset(&row, 0, sizeof row);
        snprintf(row.setting, sizeof row.setting, "%s", lines[i].setting);
        snprintf(row.parent, sizeof row.parent, "base");
        snprintf(row.technique, sizeof row.technique, "base");
        row.flip = row.rest_flip = lines[i].flip;
        row.ratio = lines[i].ratio;
        row.gpu_ratio = lines[i].gpu_ratio;
        assert_true(masu_rows_write(f, &row) > 0);
    }
    assert_int_equal(fclose(f), 0);
}

static const char sweep_json[] =
    "{\"hash\": \"0123\", \"width\": 64, \"height\": 36, \"time\": 1.0, \"positions\": 4,"
    " \"rays\": 64, \"frames\": 8, \"driver\": \"%s\"}";
static const char ladder_json[] =
    "{\"clock\": \"%s\", \"rungs\": [{\"setting\": \"base\"}, {\"setting\": \"aa=fxaa\"},"
    " {\"setting\": \"scale=0.5\"}, {\"setting\": \"ao=off\"}]}";

static void write_in(const char *folder, const char *file, const char *text) {
    char name[64];
    snprintf(name, sizeof name, "%s/%s", folder, file);
    write_text(name, text);
}

static void make_folder(const char *name, const char *clock) {
    char text[512];
    mkdir(in_scratch(name), 0777);
    snprintf(text, sizeof text, sweep_json, name); /* drivers may differ */
    write_in(name, "sweep.json", text);
    snprintf(text, sizeof text, ladder_json, clock);
    write_in(name, "ladder.json", text);
}

static const line here[] = {{"base", 0.03, 1.0, 1.0},
                            {"aa=fxaa", 0.0309, 1.1, 1.2},
                            {"scale=0.5", 0.08, 0.3, 0.25},
                            {"ao=off", 0, 0.9, 0.8}};
static const line there[] = {
    {"ao=off", 0, 0.6, 1.0}, {"scale=0.5", 0.1, 0.25, 0.25}, {"base", 0.03, 1.0, 1.0}};

static int make_dirs(void **state) {
    if (make_scratch(state)) return 1;
    make_folder("here", "timestamps");
    make_folder("there", "wall");
    write_rows("here", here, 4);
    write_rows("there", there, 3);
    return 0;
}

static void near(double value, double wanted) {
    if (!(fabs(value - wanted) <= 1e-9)) fail_msg("%.12g is not %.12g", value, wanted);
}

static void differences_are_those_worked_out_by_hand(void **state) {
    (void)state;
    masu_against a;
    char error[8192];
    if (!masu_against_compare(in_scratch("here"), in_scratch("there"), &a, error, sizeof error))
        fail_msg("%s", error);
    assert_int_equal(a.count, 4);
    assert_int_equal(a.missing, 1);
    assert_false(a.by_timestamps); /* only one of the two uses timestamps */
    assert_true(a.rungs[1].here && !a.rungs[1].there);
    near(a.rungs[0].flip_off, 0);
    near(a.rungs[2].flip_off, -0.2);
    near(a.rungs[2].time_off, 0.2);
    near(a.rungs[3].flip_off, 0); /* two zeros */
    near(a.rungs[3].time_off, 0.5);
    assert_int_equal(a.worst_flip, 2);
    assert_int_equal(a.worst_time, 3);
    make_folder("there", "timestamps");
    assert_true(
        masu_against_compare(in_scratch("here"), in_scratch("there"), &a, error, sizeof error));
    assert_true(a.by_timestamps);
    near(a.rungs[2].time_off, 0);
    near(a.rungs[3].time_off, -0.2);
    assert_int_equal(a.worst_time, 3);
    make_folder("there", "wall");
    /* The same folder twice: no differences and no missing rows. */
    assert_true(
        masu_against_compare(in_scratch("here"), in_scratch("here"), &a, error, sizeof error));
    assert_int_equal(a.missing, 0);
    for (uint32_t i = 0; i < a.count; i++) {
        near(a.rungs[i].flip_off, 0);
        near(a.rungs[i].time_off, 0);
    }
    assert_true(isinf(masu_against_off(1, 0)));
    near(masu_against_off(0, 1), -1);
}

static void what_is_printed(void **state) {
    (void)state;
    masu_against a;
    char error[8192], text[4096];
    assert_true(
        masu_against_compare(in_scratch("here"), in_scratch("there"), &a, error, sizeof error));
    FILE *f = tmpfile();
    assert_non_null(f);
    assert_true(masu_against_print(f, &a, false) > 0);
    assert_true(masu_against_print(f, &a, true) > 0);
    rewind(f);
    size_t n = fread(text, 1, sizeof text - 1, f);
    text[n] = 0;
    fclose(f);
    assert_non_null(strstr(text, "no row there  aa=fxaa"));
    assert_non_null(strstr(text, "worst: FLIP -20.00 % (rung 2), time +50.00 % (rung 3)"));
    assert_non_null(strstr(text, "1 of 4 rungs within 2 % of error and 15 % of time, 1 without"));
    assert_non_null(strstr(text, "\n2,scale=0.5,0.08,0.1,-0.2,0.3,0.25,0.2\n"));
    assert_non_null(strstr(text, "\n1,aa=fxaa,nan,"));
}

static void refused(const char *a, const char *b, const char *why) {
    masu_against out;
    char error[8192] = "";
    assert_false(masu_against_compare(in_scratch(a), in_scratch(b), &out, error, sizeof error));
    if (!strstr(error, why)) fail_msg("'%s' is not in: %s", why, error);
    assert_null(strchr(error, '\n'));
}

static void folders_that_do_not_belong_together(void **state) {
    (void)state;
    make_folder("other", "wall");
    refused("here", "none", "sweep.json");
    refused("none", "here", "sweep.json");
    write_text("other/sweep.json", "{\"hash\": \"4567\"}");
    refused("here", "other", "hash");
    make_folder("other", "wall");
    write_text("other/ladder.json", "[1");
    refused("here", "other", "ladder.json");
    write_text("other/ladder.json", "{\"rungs\": []}");
    refused("other", "here", "rungs");
    write_text("other/ladder.json", "{\"rungs\": [{}]}");
    refused("other", "here", "setting");
    make_folder("other", "wall");
    write_text("other/results.csv", "setting,old\n");
    refused("here", "other", "results.csv");
}

static void what_a_cpu_is_called(void **state) {
    (void)state;
    char cpu[16];
    assert_true(
        masu_machine_cpu("processor\t: 0\nmodel name\t: Some CPU\nflags\t: a\n", cpu, sizeof cpu));
    assert_string_equal(cpu, "Some CPU");
    assert_true(masu_machine_cpu("model name : A name that is far too long", cpu, sizeof cpu));
    assert_string_equal(cpu, "A name that is ");
    static const char *const none[] = {"", "model name", "model name\n: x", "model name:\n",
                                       "cpu: x"};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        assert_false(masu_machine_cpu(none[i], cpu, sizeof cpu));
        assert_string_equal(cpu, "unknown");
    }
}

static void runs_are_added_merged_and_read(void **state) {
    (void)state;
    char error[4096];
    masu_machine m, read;
    mkdir(in_scratch("m1"), 0777);
    mkdir(in_scratch("m2"), 0777);
    masu_machine_here("some \"driver\"", &m);
    assert_true(m.cpu[0] && m.threads > 0 && strlen(m.date) == 20);
    assert_false(masu_machine_read(in_scratch("m1"), 0, &read));
    assert_true(masu_machine_append(in_scratch("m1"), &m, error, sizeof error));
    /* a minute later: the same run, as far as the file states */
    m.date[15] = m.date[15] == '0' ? '1' : '0';
    assert_true(masu_machine_append(in_scratch("m1"), &m, error, sizeof error));
    assert_false(masu_machine_read(in_scratch("m1"), 1, &read));
    snprintf(m.date, sizeof m.date, "another day");
    assert_true(masu_machine_append(in_scratch("m1"), &m, error, sizeof error));
    assert_true(masu_machine_append(in_scratch("m2"), &m, error, sizeof error));
    snprintf(m.date, sizeof m.date, "a third");
    assert_true(masu_machine_append(in_scratch("m2"), &m, error, sizeof error));
    assert_true(masu_machine_merge(in_scratch("m1"), in_scratch("m2"), error, sizeof error));
    assert_true(masu_machine_merge(in_scratch("m1"), in_scratch("none"), error, sizeof error));
    static const char *const dates[] = {NULL, "another day", "a third"}; /* one was in both */
    for (uint32_t i = 0; i < 3; i++) {
        assert_true(masu_machine_read(in_scratch("m1"), i, &read));
        assert_string_equal(read.cpu, m.cpu);
        assert_string_equal(read.driver, "some \"driver\"");
        assert_int_equal(read.threads, m.threads);
        if (dates[i]) assert_string_equal(read.date, dates[i]);
    }
    assert_false(masu_machine_read(in_scratch("m1"), 3, &read));
    write_text("m2/machine.json", "{}");
    assert_false(masu_machine_append(in_scratch("m2"), &m, error, sizeof error));
    assert_non_null(strstr(error, "machine.json"));
    assert_false(masu_machine_read(in_scratch("m2"), 0, &read));
    masu_machine_forget(in_scratch("m2"));
    masu_machine_forget(in_scratch("none"));
    assert_true(masu_machine_append(in_scratch("m2"), &m, error, sizeof error));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(differences_are_those_worked_out_by_hand),
        cmocka_unit_test(what_is_printed),
        cmocka_unit_test(folders_that_do_not_belong_together),
        cmocka_unit_test(what_a_cpu_is_called),
        cmocka_unit_test(runs_are_added_merged_and_read),
    };
    return cmocka_run_group_tests_name("bench against", tests, make_dirs, remove_scratch);
}
