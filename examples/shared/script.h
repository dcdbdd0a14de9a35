/* script.h: what happens in which frame, read from a file, for drives that are the same each time: a line is
 * "frame N VERB [VALUE [HOW]]", in the order of frames; what starts with # is a comment. */
#ifndef EXAMPLES_SCRIPT_H
#define EXAMPLES_SCRIPT_H

#include "window.h"

typedef struct script {
    char *text, *next; /* NULL: there is none, or it is at its end */
} script;

typedef struct script_line {
    char verb[16], value[256], how[8]; /* "": left out */
} script_line;

/* NULL for `path` is fine: no script. False: it cannot be read, which stderr says. */
bool script_open(script *s, const char *path);
void script_close(script *s);
/* The next line of a frame up to this one; false: there is none. */
bool script_next(script *s, unsigned frame, script_line *out);
/* What all scripts can do: resize WxH, after which the window has that size. False: it is no such line. */
bool script_resize(const script_line *line, window *w);
/* Says on stderr that it is no line of a script. Returns false, for `return`. */
bool script_unknown(const script_line *line);

#endif
