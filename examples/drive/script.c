/* script.c: see script.h. */
#include "script.h"

#include <stdio.h>
#include <string.h>

/* frame N key NAME [down|up] | resize WxH | screenshot FILE | quit */
static bool parse(const char *text, script_line *out) {
    char word[16] = "", value[256] = "", how[8] = "", more;
    int n = sscanf(text, "frame %u %15s %255s %7s %c", &out->frame, word, value, how, &more);
    if (strcmp(word, "key") == 0) {
        out->kind = SCRIPT_KEY;
        out->key = SDL_GetScancodeFromName(value);
        out->down = n == 3 || strcmp(how, "down") == 0;
        out->up = n == 3 || strcmp(how, "up") == 0;
        return n <= 4 && out->key != SDL_SCANCODE_UNKNOWN && (out->down || out->up);
    }
    if (strcmp(word, "resize") == 0) {
        out->kind = SCRIPT_RESIZE;
        return n == 3 && sscanf(value, "%dx%d%c", &out->width, &out->height, &more) == 2 && out->width >= 64 &&
               out->height >= 64 && out->width <= 8192 && out->height <= 8192;
    }
    out->kind = strcmp(word, "screenshot") == 0 ? SCRIPT_SCREENSHOT : SCRIPT_QUIT;
    memcpy(out->file, value, sizeof value);
    return out->kind == SCRIPT_SCREENSHOT ? n == 3 : n == 2 && strcmp(word, "quit") == 0;
}

bool script_read(script *s, const char *path) {
    FILE *in = fopen(path, "r");
    char text[400];
    int line = 0;
    bool good = true;
    if (!in) return fprintf(stderr, "drive: cannot open the script %s\n", path), false;
    while (good && fgets(text, sizeof text, in)) {
        line++;
        if (text[0] == '#' || strspn(text, " \t\r\n") == strlen(text)) continue;
        script_line *to = &s->lines[s->count];
        good = s->count < (int)(sizeof s->lines / sizeof *s->lines) && parse(text, to) &&
               (s->count == 0 || to[-1].frame <= to->frame);
        s->count += good;
    }
    fclose(in);
    if (!good) fprintf(stderr, "drive: %s:%d: no line of a script, or out of order: %s", path, line, text);
    return good;
}

const script_line *script_next(script *s, unsigned frame) {
    return s->next < s->count && s->lines[s->next].frame <= frame ? &s->lines[s->next++] : NULL;
}
