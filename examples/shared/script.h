/* script.h: actions at given frames, read from a file, for reproducible runs: a line is "frame N
 * VERB [VALUE [HOW]]", in the order of frames; # starts a comment. */
#ifndef EXAMPLES_SCRIPT_H
#define EXAMPLES_SCRIPT_H

#include "window.h"

typedef struct script {
    char *text, *next; /* NULL: no script, or at its end */
} script;

typedef struct script_line {
    char verb[16], value[256], how[8]; /* "": omitted */
} script_line;

/* `path` NULL: no script. Returns false, with a message on stderr, if the script cannot be read. */
bool script_open(script *s, const char *path);
void script_close(script *s);
/* The next line of a frame up to this one; false: none. */
bool script_next(script *s, unsigned frame, script_line *out);
/* Executes a line that all scripts share: resize WxH. Returns false for other lines. */
bool script_resize(const script_line *line, window *w);
/* Reports an unknown line on stderr. Returns false, for `return`. */
bool script_unknown(const script_line *line);

#endif
