/* cli.h: the program `masu` as a user runs it: in a shell, with the scratch folder of files.h, and
 * what it has said. Anything that goes wrong here fails the test. */
#ifndef SUPPORT_CLI_H
#define SUPPORT_CLI_H

#include "support/files.h"

extern const char *cli_program; /* of $BUILD/bin: "masu" */
extern char cli_out[1 << 16], cli_err[1 << 16]; /* of the last run; longer ones are cut */

/* `masu ARGUMENTS`; returns the exit code. */
int cli_run(const char *format, ...) __attribute__((format(printf, 1, 2)));
int cli_run_list(const char *command, const char *format, va_list args); /* masu COMMAND ... */

/* The last run has failed: it has said nothing but one line on stderr, which begins with the
 * program's name and holds `part`. */
void cli_complained(const char *part);
/* Its stdout holds `part`. */
void cli_said(const char *part);

/* Text of a file of the scratch folder; a longer one is cut. */
void take_text(const char *name, char *text, size_t size);

#endif
