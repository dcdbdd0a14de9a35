/* cli.c: see cli.h. */
#include "support/cli.h"

#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

char cli_dir[] = "/tmp/masu-test-XXXXXX";
char cli_out[1 << 16], cli_err[1 << 16];

int cli_make_dir(void **state) {
    (void)state;
    return mkdtemp(cli_dir) ? 0 : 1;
}

int cli_remove_dir(void **state) {
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -rf %s", cli_dir);
    return system(command);
}

static FILE *open_file(const char *name, const char *mode) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", cli_dir, name);
    FILE *f = fopen(path, mode);
    if (!f) fail_msg("%s cannot be opened", path);
    return f;
}

char *cli_read(const char *name) {
    FILE *f = open_file(name, "rb");
    fseek(f, 0, SEEK_END);
    size_t n = (size_t)ftell(f);
    rewind(f);
    char *text = malloc(n + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, n, f), n);
    text[n] = 0;
    fclose(f);
    return text;
}

void cli_write(const char *name, const void *bytes, size_t n) {
    FILE *f = open_file(name, "wb");
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    fclose(f);
}

bool cli_exists(const char *name) {
    char path[512];
    struct stat st;
    snprintf(path, sizeof path, "%s/%s", cli_dir, name);
    return stat(path, &st) == 0;
}

void cli_take(const char *name, char *text, size_t size) {
    char *all = cli_read(name);
    snprintf(text, size, "%s", all);
    free(all);
}

int cli_run_list(const char *command, const char *format, va_list args) {
    char arguments[2048], line[4096];
    const char *build = getenv("BUILD");
    vsnprintf(arguments, sizeof arguments, format, args);
    snprintf(line, sizeof line, "%s/bin/masu %s %s >%s/out 2>%s/err </dev/null",
             build ? build : "build", command, arguments, cli_dir, cli_dir);
    int status = system(line);
    assert_true(WIFEXITED(status));
    cli_take("out", cli_out, sizeof cli_out);
    cli_take("err", cli_err, sizeof cli_err);
    return WEXITSTATUS(status);
}

int cli_run(const char *format, ...) {
    va_list args;
    va_start(args, format);
    int code = cli_run_list("", format, args);
    va_end(args);
    return code;
}

void cli_complained(const char *part) {
    size_t n = strlen(cli_err);
    if (!n || strchr(cli_err, '\n') != cli_err + n - 1) fail_msg("not one line: '%s'", cli_err);
    if (strncmp(cli_err, "masu", 4))
        fail_msg("does not begin with the program's name: %s", cli_err);
    if (!strstr(cli_err, part)) fail_msg("'%s' is not in: %s", part, cli_err);
    assert_string_equal(cli_out, "");
}

void cli_said(const char *part) {
    if (!strstr(cli_out, part)) fail_msg("'%s' is not in:\n%s%s", part, cli_out, cli_err);
}
