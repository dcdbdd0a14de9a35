/* markup.h: XML and HTML of the programs' pages. All fields of a page are printed by masu_markup,
 * whose %s escapes markup in text from files, drivers and command lines. */
#ifndef MASU_MARKUP_H
#define MASU_MARKUP_H

#include "cli/cli.h"

#include <stdio.h>

/* Like fprintf with %s, %c, %d, %u and %e %f %g, with flags, width and precision, but without `*`
 * and length modifiers. %s prints its argument by masu_markup_text, %c one character. Other
 * conversions are programming errors and abort. */
void masu_markup(FILE *f, const char *format, ...) MASU_CLI_PRINTF(2, 3);

/* Text for XML 1.0, in an attribute or between tags: markup is escaped; characters not allowed in
 * XML (control characters, invalid UTF-8, U+FFFE and U+FFFF) become '?'. */
void masu_markup_text(FILE *f, const char *text);

#endif
