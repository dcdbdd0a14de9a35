/* cli.h: runs the program `masu` as a user does, in a shell with the scratch folder of files.h, and
 * keeps its output. Any unexpected failure here fails the test. */
#ifndef SUPPORT_CLI_H
#define SUPPORT_CLI_H

#include "support/files.h"

extern const char *cli_program; /* of $BUILD/bin: "masu" */
extern char cli_out[1 << 16], cli_err[1 << 16]; /* of the last run; longer output is cut off */

/* `masu ARGUMENTS`; returns the exit code. */
int cli_run(const char *format, ...) __attribute__((format(printf, 1, 2)));
int cli_run_list(const char *command, const char *format, va_list args); /* masu COMMAND ... */

/* Asserts that the last run failed with exactly one line on stderr and nothing on stdout; the line
 * begins with the program's name and contains `part`. */
void cli_complained(const char *part);
/* Asserts that stdout contains `part`. */
void cli_said(const char *part);

/* Reads a text file of the scratch folder; cut off at `size`. */
void take_text(const char *name, char *text, size_t size);

#endif
