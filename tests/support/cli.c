/* cli.c: see cli.h. */
#include "support/cli.h"

#include "support/files.h"
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char cli_out[1 << 16], cli_err[1 << 16];
const char *cli_program = "masu";

void take_text(const char *name, char *text, size_t size) {
    char *all = read_file(in_scratch(name), NULL);
    snprintf(text, size, "%s", all);
    free(all);
}

int cli_run_list(const char *command, const char *format, va_list list) {
    char arguments[2048];
    assert_true(vsnprintf(arguments, sizeof arguments, format, list) < (int)sizeof arguments);
    int code = shell("%s/bin/%s %s %s >%s/out 2>%s/err </dev/null", build_dir(), cli_program,
                     command, arguments, scratch, scratch);
    take_text("out", cli_out, sizeof cli_out);
    take_text("err", cli_err, sizeof cli_err);
    return code;
}

int cli_run(const char *format, ...) {
    va_list list;
    va_start(list, format);
    int code = cli_run_list("", format, list);
    va_end(list);
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
