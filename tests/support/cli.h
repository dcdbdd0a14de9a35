/* cli.h: the program `masu` as a stranger runs it: in a shell, with a scratch folder, and
 * what it has said. Anything that goes wrong here fails the test. */
#ifndef SUPPORT_CLI_H
#define SUPPORT_CLI_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

extern char cli_dir[];                           /* the scratch folder */
extern char cli_out[1 << 16], cli_err[1 << 16]; /* of the last run; longer ones are cut */

/* For cmocka_run_group_tests. */
int cli_make_dir(void **state);
int cli_remove_dir(void **state);

/* `masu ARGUMENTS`; returns the exit code. */
int cli_run(const char *format, ...) __attribute__((format(printf, 1, 2)));
int cli_run_list(const char *command, const char *format, va_list args); /* masu COMMAND ... */

/* The last run has failed: it has said nothing but one line on stderr, which begins with the
 * program's name and holds `part`. */
void cli_complained(const char *part);
/* Its stdout holds `part`. */
void cli_said(const char *part);

/* Files of the scratch folder. Text ends with a 0; freed by free(). */
char *cli_read(const char *name);
void cli_take(const char *name, char *text, size_t size); /* a longer one is cut */
void cli_write(const char *name, const void *bytes, size_t n);
bool cli_exists(const char *name);

#endif
