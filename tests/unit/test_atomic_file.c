/* test_atomic_file.c: drafts of files (platform/atomic_file.h) and scratch folders
 * (bake/base/file.h): files left by a killed process are removed by the next one; files of a
 * running process are kept. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bake/base/file.h"
#include "cli/cli.h"
#include "atomic_file.h"
#include "image.h"
#include "support/files.h"

/* Number of names in the folder. */
static int entries(const char *path) {
    int count = 0;
    DIR *folder = opendir(path);
    assert_non_null(folder);
    for (struct dirent *e; (e = readdir(folder));) count += e->d_name[0] != '.';
    closedir(folder);
    return count;
}

typedef struct maker {
    pid_t child;
    int go; /* closing it lets the process continue */
} maker;

/* A process that has started, and waits. Closing the pipe lets body continue. */
static maker start(void (*body)(int wait)) {
    int ready[2], go[2];
    char byte;
    assert_int_equal(pipe(ready), 0);
    assert_int_equal(pipe(go), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (!child) {
        close(ready[0]);
        close(go[1]);
        dup2(ready[1], 200);
        close(ready[1]);
        body(go[0]);
        _exit(0);
    }
    close(ready[1]);
    close(go[0]);
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
    return (maker){child, go[1]};
}

static void begun_and_told(int wait) {
    char byte = 0;
    (void)!write(200, "x", 1);
    (void)!read(wait, &byte, 1);
}

static void end(maker m, int number) {
    int status = 0;
    if (number) kill(m.child, number);
    close(m.go);
    assert_int_equal(waitpid(m.child, &status, 0), m.child);
    if (number)
        assert_true(WIFSIGNALED(status));
    else
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void write_a_draft(int wait) {
    masu_atomic_file draft;
    if (masu_atomic_file_open(&draft, in_scratch("x.png")) ||
        masu_atomic_file_write(&draft, "old", 3))
        _exit(1);
    begun_and_told(wait);
    _exit(masu_atomic_file_commit(&draft, in_scratch("x.png")) != 0);
}

static void assert_holds(const char *name, const char *text) {
    size_t bytes;
    char *found = read_file(in_scratch(name), &bytes);
    assert_string_equal(found, text);
    free(found);
}

static void write_x(const char *text) {
    char error[200];
    assert_true(masu_file_write(in_scratch("x.png"), text, strlen(text), error, sizeof error));
}

static void the_draft_of_a_killed_maker_is_removed_by_the_next(void **state) {
    (void)state;
    maker m = start(write_a_draft);
    end(m, SIGKILL);
    assert_int_equal(entries(scratch), 1);
    assert_false(is_in_scratch("x.png"));
    write_x("new");
    assert_int_equal(entries(scratch), 1);
    assert_holds("x.png", "new");
}

static void the_draft_of_a_running_maker_stays(void **state) {
    (void)state;
    maker m = start(write_a_draft);
    write_x("new");
    masu_atomic_file_remove_stale(in_scratch("x.png"));
    assert_int_equal(entries(scratch), 2);
    assert_holds("x.png", "new");
    end(m, 0);
    assert_int_equal(entries(scratch), 1);
    assert_holds("x.png", "old"); /* it was written last */
}

static void write_a_draft_and_catch(int wait) {
    masu_atomic_file_catch_signals();
    write_a_draft(wait);
}

/* Each signal ends the process as it would without a handler. */
static void a_maker_that_is_ended_takes_its_draft_along(void **state) {
    (void)state;
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        end(start(write_a_draft_and_catch), numbers[i]);
        assert_int_equal(entries(scratch), 0);
    }
}

static void write_too_much(int wait) {
    char error[200];
    static char bytes[1 << 16];
    (void)wait;
    setrlimit(RLIMIT_FSIZE, &(struct rlimit){4096, 4096});
    masu_atomic_file_catch_signals();
    (void)!write(200, "x", 1);
    bool good = masu_file_write(in_scratch("x.png"), bytes, sizeof bytes, error, sizeof error);
    _exit(good || !strstr(error, strerror(EFBIG)));
}

static void a_file_beyond_the_limit_is_an_error_and_leaves_nothing(void **state) {
    (void)state;
    end(start(write_too_much), 0);
    assert_int_equal(entries(scratch), 0);
}

static void write_to(int wait) {
    (void)wait;
    (void)!write(200, "x", 1);
    signal(SIGSEGV, SIG_DFL); /* the test program catches it */
    kill(getpid(), SIGSEGV);
}

static void statuses_are_words(void **state) {
    (void)state;
    int status = 0;
    maker m = start(write_to);
    close(m.go);
    assert_int_equal(waitpid(m.child, &status, 0), m.child);
    char expected[64];
    snprintf(expected, sizeof expected, "ended by signal %d (SIGSEGV)", SIGSEGV);
    assert_string_equal(masu_cli_status(status), expected);
    assert_string_equal(masu_cli_status(system("exit 3")), "exit code 3");
    assert_string_equal(masu_cli_status(system("exit 139")),
                        "exit code 139, which stands for signal 11 (SIGSEGV)");
    assert_string_equal(masu_cli_signal(SIGTERM), "signal 15 (SIGTERM)");
}

/* Names that resemble a draft's belong to the user. */
static void what_is_no_draft_stays(void **state) {
    (void)state;
    static const char *const names[] = {"x.png.part",     "x.png.1.part",    "x.png.1-.part",
                                        "x.png.a-1.part", "x.png.1-2.part2", "y.png.1-2.part",
                                        "xx.png.1-2.part"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) (void)write_text(names[i], "mine");
    assert_int_equal(symlink("x.png.part", in_scratch("x.png.3-0.part")), 0);
    write_x("new");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) assert_holds(names[i], "mine");
    assert_int_equal(entries(scratch), (int)(sizeof names / sizeof *names) + 2);
    (void)write_text("x.png.1-2.part", "a dead one's");
    write_x("newer");
    assert_false(is_in_scratch("x.png.1-2.part"));
}

static void make_a_folder(int wait) {
    const char *folder = masu_bake_temporary_directory();
    char path[4096];
    snprintf(path, sizeof path, "%s/inside", folder ? folder : "");
    FILE *file = folder ? fopen(path, "wb") : NULL;
    if (!file || fclose(file)) _exit(1);
    begun_and_told(wait);
    exit(0); /* removes it */
}

static void the_folder_of_a_killed_maker_is_removed_by_the_next_and_no_other(void **state) {
    (void)state;
    setenv("TMPDIR", scratch, 1);
    maker dead = start(make_a_folder), running = start(make_a_folder);
    (void)write_text("masu-bake-notmine", "a file of another form");
    assert_int_equal(entries(scratch), 3);
    end(dead, SIGKILL);
    assert_int_equal(entries(scratch), 3);
    masu_bake_sweep_temporary();
    assert_int_equal(entries(scratch), 2);
    maker next = start(make_a_folder);
    assert_int_equal(entries(scratch), 3);
    end(next, 0);
    end(running, 0);
    assert_int_equal(entries(scratch), 1);
    unsetenv("TMPDIR");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_draft_of_a_killed_maker_is_removed_by_the_next,
                                        make_scratch, remove_scratch),
        cmocka_unit_test_setup_teardown(a_maker_that_is_ended_takes_its_draft_along, make_scratch,
                                        remove_scratch),
        cmocka_unit_test_setup_teardown(a_file_beyond_the_limit_is_an_error_and_leaves_nothing,
                                        make_scratch, remove_scratch),
        cmocka_unit_test_setup_teardown(statuses_are_words, make_scratch, remove_scratch),
        cmocka_unit_test_setup_teardown(the_draft_of_a_running_maker_stays, make_scratch,
                                        remove_scratch),
        cmocka_unit_test_setup_teardown(what_is_no_draft_stays, make_scratch, remove_scratch),
        cmocka_unit_test_setup_teardown(
            the_folder_of_a_killed_maker_is_removed_by_the_next_and_no_other, make_scratch,
            remove_scratch),
    };
    return cmocka_run_group_tests_name("draft", tests, NULL, NULL);
}
