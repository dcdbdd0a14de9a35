/* markup.h: XML and HTML of the programs' pages. Every field of a page goes through masu_markup, whose %s escapes:
 * what came from a file, a driver or a command line cannot be markup. */
#ifndef MASU_MARKUP_H
#define MASU_MARKUP_H

#include "cli/cli.h"

#include <stdio.h>

/* As fprintf, of %s, %c, %d, %u and the %e %f %g with flags, width and precision but no `*` and no length; %s is
 * masu_markup_text of its argument, %c one of its character. Whatever else follows a % is a mistake of ours and
 * aborts. */
void masu_markup(FILE *f, const char *format, ...) MASU_CLI_PRINTF(2, 3);

/* Text for XML 1.0, in an attribute or between tags: markup is escaped, what XML cannot hold
 * (control characters, bytes that are no UTF-8, U+FFFE and U+FFFF) becomes '?'. */
void masu_markup_text(FILE *f, const char *text);

#endif
