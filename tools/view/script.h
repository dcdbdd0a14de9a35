/* script.h: what happens at which frame, for tests and recordings: a file of lines
 *
 *     frame N key F2             pressed and released; Shift+Left, Ctrl+... with modifiers
 *     frame N down W             held until ...
 *     frame N up W
 *     frame N wheel -1
 *     frame N mouse X Y          moved to, window coordinates
 *     frame N button left down   or right, up
 *     frame N click X Y          left, down and up, there
 *     frame N resize 800x600
 *     frame N minimise           or restore
 *     frame N screenshot out.png of the frame before
 *     frame N drop FILE          dropped on the window; what is baked for it goes on in later frames,
 *     frame N wait               until it is baked
 *     frame N run COMMAND        by sh; waited for
 *     frame N lose               as if the device were lost
 *     frame N quit
 *
 * in rising order; # begins a comment. Keys have SDL's names. Frame numbers count turns of the loop from
 * 0, also those of a minimised window, which draw nothing. Events go through SDL's own queue, so that
 * they take the way of a hand's. The text belongs to the script. */
#ifndef MASU_VIEW_SCRIPT_H
#define MASU_VIEW_SCRIPT_H

#include "view/viewer.h"

typedef struct masu_script {
    char *text; /* NULL: there is none */
    struct masu_script_line *lines;
    uint32_t count, next;
} masu_script;

/* On false `error` is one line with file and line number, and nothing is kept. */
bool masu_script_read(const char *path, masu_script *out, char *error, size_t size);
void masu_script_free(masu_script *script);

/* Does what is written for this turn. False: v->error says what has failed. */
bool masu_script_play(masu_script *script, masu_viewer *v);

#endif
