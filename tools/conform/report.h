/* report.h: the output of `masu conform`: lines, a summary, CSV, Markdown, JUnit XML.
 *
 * Writes to streams that the caller owns; needs no device. */
#ifndef MASU_CONFORM_REPORT_H
#define MASU_CONFORM_REPORT_H

#include "conform/run.h"

#include <stdio.h>

/* Prints a case: verdict, name, size, seconds; on the next lines the reason and the command that
 * replays the case. `command` is shell text, up to the token. */
void masu_conform_print(FILE *f, const masu_suite *suite, const masu_conform_result *r,
                        const char *command);

/* Counts the results per verdict. */
void masu_conform_tally(const masu_conform_result *results, uint32_t n,
                        uint32_t tally[MASU_VERDICT_COUNT]);

/* "24 cases: 22 passed, 1 quality warning, ... in 41.3 s", one line. */
void masu_conform_sum(FILE *f, const masu_conform_result *results, uint32_t n);

/* One row per result, one column per measure; unmeasured values are empty. */
void masu_conform_csv(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                      uint32_t n, const char *driver);

/* Rows of a Markdown table: inputs, limits, measured values. */
void masu_conform_table(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                        uint32_t n, const char *driver);

/* One testsuite: "fail" is a failure; "resource error" and "not run" are errors; "not supported" is
 * skipped; "quality warning" passes with a message. */
void masu_conform_junit(FILE *f, const masu_suite *suite, const masu_conform_result *results,
                        uint32_t n, const char *driver);

/* Quotes one argument for a POSIX shell. */
void masu_shell_quote(FILE *f, const char *text);

#endif
