/* script.c: see script.h. */
#include "view/script.h"

#include "cli/cli.h"
#include "file_kind.h"
#include "image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define BYTES_MAX ((size_t)1 << 20)

typedef enum masu_act {
    ACT_KEY,
    ACT_DOWN,
    ACT_UP,
    ACT_WHEEL,
    ACT_MOUSE,
    ACT_BUTTON,
    ACT_CLICK,
    ACT_RESIZE,
    ACT_MINIMISE,
    ACT_RESTORE,
    ACT_SCREENSHOT,
    ACT_DROP,
    ACT_WAIT,
    ACT_RUN,
    ACT_LOSE,
    ACT_QUIT
} masu_act;

static const char *const act_names[] = {
    "key",      "down",    "up",         "wheel", "mouse", "button", "click", "resize",
    "minimise", "restore", "screenshot", "drop",  "wait",  "run",    "lose",  "quit"};
enum { ACTS = sizeof act_names / sizeof *act_names };

typedef struct masu_script_line {
    uint64_t frame;
    masu_act act;
    const char *text; /* the arguments, within the script's text */
    int x, y;
    SDL_Keycode key;
    uint16_t modifiers;
} masu_script_line;

/* ---- Reading --------------------------------------------------------------------------------- */

static bool read_key(const char *text, masu_script_line *line) {
    static const struct {
        const char *name;
        uint16_t bit;
    } modifiers[] = {{"Shift+", KMOD_LSHIFT}, {"Ctrl+", KMOD_LCTRL}, {"Alt+", KMOD_LALT}};
    for (size_t i = 0; i < sizeof modifiers / sizeof *modifiers; i++) {
        size_t n = strlen(modifiers[i].name);
        if (strncasecmp(text, modifiers[i].name, n) != 0 || !text[n]) continue;
        line->modifiers |= modifiers[i].bit;
        return read_key(text + n, line);
    }
    line->key = SDL_GetKeyFromName(text);
    return line->key != SDLK_UNKNOWN;
}

static bool read_text(masu_script_line *line) {
    char end;
    switch (line->act) {
    case ACT_KEY:
    case ACT_DOWN:
    case ACT_UP: return read_key(line->text, line);
    case ACT_WHEEL: return sscanf(line->text, "%d %c", &line->y, &end) == 1;
    case ACT_CLICK:
    case ACT_MOUSE: return sscanf(line->text, "%d %d %c", &line->x, &line->y, &end) == 2;
    case ACT_BUTTON:
        line->x = !strncmp(line->text, "right", 5) ? SDL_BUTTON_RIGHT : SDL_BUTTON_LEFT;
        line->y = strstr(line->text, " down") != NULL;
        return !strcmp(line->text, "left down") || !strcmp(line->text, "left up") ||
               !strcmp(line->text, "right down") || !strcmp(line->text, "right up");
    case ACT_RESIZE:
        return sscanf(line->text, "%dx%d %c", &line->x, &line->y, &end) == 2 && line->x >= 1 &&
               line->y >= 1 && line->x <= 16384 && line->y <= 16384;
    case ACT_SCREENSHOT: return *line->text && masu_file_named(line->text, ".png", NULL, 0);
    case ACT_DROP:
    case ACT_RUN: return *line->text != '\0';
    default: return *line->text == '\0';
    }
}

/* Parses a trimmed, non-empty line. *wrong is the error if it returns false. */
static bool read_line(char *text, masu_script_line *line, const char **wrong) {
    char word[16];
    int used = 0;
    unsigned long long frame;
    memset(line, 0, sizeof *line);
    *wrong = "expected 'frame N ACTION'";
    if (sscanf(text, "frame %llu %15s%n", &frame, word, &used) != 2 ||
        strchr(text, '-') == text + 6)
        return false;
    line->frame = frame;
    line->text = text + used + strspn(text + used, " \t");
    for (int a = 0; a < ACTS; a++) {
        if (strcmp(act_names[a], word) != 0) continue;
        line->act = (masu_act)a;
        *wrong = a == ACT_SCREENSHOT ? "expected a name that ends in .png"
                                     : "wrong or missing argument of the action";
        return read_text(line);
    }
    *wrong = "unknown action";
    return false;
}

static char *trimmed(char *text) {
    char *comment = strchr(text, '#');
    if (comment && (comment == text || comment[-1] == ' ' || comment[-1] == '\t')) *comment = '\0';
    text += strspn(text, " \t\r");
    size_t n = strlen(text);
    while (n && strchr(" \t\r", text[n - 1])) text[--n] = '\0';
    return text;
}

bool masu_script_read(const char *path, masu_script *s, char *error, size_t size) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    memset(s, 0, sizeof *s);
    if (!masu_file_read(path, BYTES_MAX, &bytes, &count, error, size)) return false;
    s->text = malloc(count + 1);
    s->lines = malloc((count / 8 + 1) * sizeof *s->lines); /* the shortest line starts with "frame 0
                                                            * " */
    if (!s->text || !s->lines) {
        free(bytes);
        masu_script_free(s);
        snprintf(error, size, "%s: out of memory", path);
        return false;
    }
    if (count) memcpy(s->text, bytes, count);
    s->text[count] = '\0';
    free(bytes);
    unsigned number = 1;
    for (char *at = s->text, *next; at; at = next, number++) {
        const char *wrong;
        next = strchr(at, '\n');
        if (next) *next++ = '\0';
        char *text = trimmed(at);
        if (!*text) continue;
        masu_script_line *line = &s->lines[s->count];
        bool good = read_line(text, line, &wrong);
        if (good && s->count && line->frame < s->lines[s->count - 1].frame) {
            good = false;
            wrong = "expected frame numbers in rising order";
        }
        if (!good) {
            snprintf(error, size, "%s:%u: %s: '%.80s'", path, number, wrong, text);
            masu_script_free(s);
            return false;
        }
        s->count++;
    }
    return true;
}

void masu_script_free(masu_script *s) {
    free(s->text);
    free(s->lines);
    memset(s, 0, sizeof *s);
}

/* ---- Playing --------------------------------------------------------------------------------- */

static void push_key(const masu_viewer *v, const masu_script_line *l, bool down) {
    SDL_Event e = {.key = {.type = down ? SDL_KEYDOWN : SDL_KEYUP,
                           .windowID = SDL_GetWindowID(v->window.sdl),
                           .state = down ? SDL_PRESSED : SDL_RELEASED,
                           .keysym = {.sym = l->key, .mod = l->modifiers}}};
    SDL_PushEvent(&e);
}

static void push_window(const masu_viewer *v, uint8_t what) {
    SDL_Event e = {.window = {.type = SDL_WINDOWEVENT,
                              .windowID = SDL_GetWindowID(v->window.sdl),
                              .event = what}};
    SDL_PushEvent(&e);
}

static void push_button(const masu_viewer *v, const masu_script_line *l) {
    int x = (int)(v->split * v->window.extent.width); /* the left button grabs the dividing line */
    SDL_Event e = {.button = {.type = l->y ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP,
                              .windowID = SDL_GetWindowID(v->window.sdl),
                              .button = (uint8_t)l->x,
                              .x = x}};
    SDL_PushEvent(&e);
}

static void push_click(const masu_viewer *v, const masu_script_line *l) {
    for (int down = 1; down >= 0; down--) {
        SDL_Event e = {.button = {.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP,
                                  .windowID = SDL_GetWindowID(v->window.sdl),
                                  .button = SDL_BUTTON_LEFT,
                                  .x = l->x,
                                  .y = l->y}};
        SDL_PushEvent(&e);
    }
}

static bool run(masu_viewer *v, const char *command) {
    fflush(NULL);
    int status = system(command);
    if (!status) return true;
    snprintf(v->error, sizeof v->error, "run: %s: %.300s", masu_cli_status(status), command);
    return false;
}

static bool play(masu_viewer *v, const masu_script_line *l) {
    SDL_Event e;
    memset(&e, 0, sizeof e);
    switch (l->act) {
    case ACT_KEY: push_key(v, l, true); push_key(v, l, false); return true;
    case ACT_DOWN: push_key(v, l, true); return true;
    case ACT_UP: push_key(v, l, false); return true;
    case ACT_WHEEL:
        e.wheel = (SDL_MouseWheelEvent){.type = SDL_MOUSEWHEEL, .y = l->y};
        SDL_PushEvent(&e);
        return true;
    case ACT_MOUSE:
        e.motion = (SDL_MouseMotionEvent){.type = SDL_MOUSEMOTION,
                                          .x = l->x,
                                          .y = l->y,
                                          .xrel = l->x - v->mouse[0],
                                          .yrel = l->y - v->mouse[1]};
        v->mouse[0] = l->x;
        v->mouse[1] = l->y;
        SDL_PushEvent(&e);
        return true;
    case ACT_BUTTON: push_button(v, l); return true;
    case ACT_CLICK: push_click(v, l); return true;
    case ACT_RESIZE: SDL_SetWindowSize(v->window.sdl, l->x, l->y); return true;
    case ACT_MINIMISE: push_window(v, SDL_WINDOWEVENT_MINIMIZED); return true;
    case ACT_RESTORE: push_window(v, SDL_WINDOWEVENT_RESTORED); return true;
    case ACT_SCREENSHOT: return masu_viewer_screenshot(v, l->text, false);
    case ACT_DROP:
        e.drop = (SDL_DropEvent){.type = SDL_DROPFILE, .file = SDL_strdup(l->text)};
        SDL_PushEvent(&e);
        return true;
    case ACT_WAIT: return masu_baker_wait(v);
    case ACT_RUN: return run(v, l->text);
    case ACT_LOSE: v->lose = true; return true;
    case ACT_QUIT: e.type = SDL_QUIT; SDL_PushEvent(&e); return true;
    }
    return true;
}

bool masu_script_play(masu_script *s, masu_viewer *v) {
    while (s->next < s->count && s->lines[s->next].frame <= v->turns) {
        if (!play(v, &s->lines[s->next++])) return false;
    }
    return true;
}
