/* script.h: what happens in which frame, read from a file: docs/drive.md. */
#ifndef DRIVE_SCRIPT_H
#define DRIVE_SCRIPT_H

#include <SDL.h>
#include <stdbool.h>

typedef enum script_kind { SCRIPT_KEY, SCRIPT_RESIZE, SCRIPT_SCREENSHOT, SCRIPT_QUIT } script_kind;

typedef struct script_line {
    unsigned frame;
    script_kind kind;
    SDL_Scancode key;
    bool down, up;     /* a key without either word: both */
    int width, height;
    char file[256];
} script_line;

typedef struct script {
    script_line lines[256];
    int count, next;
} script;

/* False, with a line on stderr that names the file's. */
bool script_read(script *s, const char *path);
/* The next line of this frame, or NULL. */
const script_line *script_next(script *s, unsigned frame);

#endif
