/* report.h: what `masu conform` says of its results: lines, a sum, CSV, JUnit XML.
 *
 * Writes to streams that the caller owns; knows no device and no command line. */
#ifndef MASU_CONFORM_REPORT_H
#define MASU_CONFORM_REPORT_H

#include "conform/run.h"

#include <stdio.h>

/* A case's lines: verdict, name, size, seconds; below them what made the verdict, and how to run it
 * alone. `command` is what a shell takes, up to the token. */
void masu_conform_print(FILE *f, const masu_suite *suite, const masu_conform_result *r,
                        const char *command);

/* How many results have each verdict. */
void masu_conform_tally(const masu_conform_result *results, uint32_t n,
                        uint32_t tally[MASU_VERDICT_COUNT]);

/* "24 cases: 22 passed, 1 quality warning, ... in 41.3 s", one line. */
void masu_conform_sum(FILE *f, const masu_conform_result *results, uint32_t n);

/* A row for each result, a column for each measure; what was not measured is empty. */
void masu_conform_csv(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                      uint32_t n, const char *driver);

/* Rows of a table in Markdown: what is given, what must hold, what was measured. */
void masu_conform_table(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                        uint32_t n, const char *driver);

/* One testsuite: fail is a failure, a resource error and a case that was not run an error, not
 * supported is skipped; a quality warning passes and says so. */
void masu_conform_junit(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                        uint32_t n, const char *driver);

/* One word for a POSIX shell. */
void masu_shell_quote(FILE *f, const char *text);

#endif
