/* script.h: input events and actions at given frames, for tests and recordings: a file of lines
 *
 *     frame N key F2             pressed and released; Shift+Left, Ctrl+... with modifiers
 *     frame N down W             held until ...
 *     frame N up W
 *     frame N wheel -1
 *     frame N mouse X Y          moved to, window coordinates
 *     frame N button left down   or right, up
 *     frame N click X Y          left button down and up at this position
 *     frame N resize 800x600
 *     frame N minimise           or restore
 *     frame N screenshot out.png of the previous frame
 *     frame N drop FILE          dropped on the window; its bake continues in later frames
 *     frame N wait               until the bake is finished
 *     frame N run COMMAND        by sh; waited for
 *     frame N lose               simulates a lost device
 *     frame N quit
 *
 * in ascending order; # starts a comment. Keys have SDL's names. Frame numbers count iterations of
 * the loop from 0, including those of a minimised window, which draw nothing. Events pass through
 * SDL's queue like real ones. The script owns the text. */
#ifndef MASU_VIEW_SCRIPT_H
#define MASU_VIEW_SCRIPT_H

#include "view/viewer.h"

typedef struct masu_script {
    char *text; /* NULL: no script */
    struct masu_script_line *lines;
    uint32_t count, next;
} masu_script;

/* On false `error` is one line with file and line number, and *out owns nothing. */
bool masu_script_read(const char *path, masu_script *out, char *error, size_t size);
void masu_script_free(masu_script *script);

/* Executes the lines of this iteration. On false v->error has the failure. */
bool masu_script_play(masu_script *script, masu_viewer *v);

#endif
