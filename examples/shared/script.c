/* script.c: see script.h. */
#include "script.h"

#include <stdio.h>
#include <string.h>

bool script_open(script *s, const char *path) {
    if (path) s->text = s->next = SDL_LoadFile(path, NULL); /* null-terminated */
    if (path && !s->text) fprintf(stderr, "cannot read the script: %s\n", SDL_GetError());
    return !path || s->text;
}

void script_close(script *s) { SDL_free(s->text); }

bool script_next(script *s, unsigned frame, script_line *out) {
    while (s->next && *s->next) {
        unsigned at = 0;
        char line[400];
        size_t length = strcspn(s->next, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, s->next);
        memset(out, 0, sizeof *out);
        bool empty = line[0] == '#' || line[strspn(line, " \t\r")] == 0;
        if (!empty &&
            sscanf(line, "frame %u %15s %255s %7s", &at, out->verb, out->value, out->how) < 2)
            snprintf(out->verb, sizeof out->verb, "%.15s", line);
        if (at > frame) return false;
        s->next += length + (s->next[length] == '\n');
        if (!empty) return true;
    }
    return false;
}

bool script_resize(const script_line *line, window *w) {
    VkSurfaceCapabilitiesKHR is;
    int width, height;
    char more;
    if (strcmp(line->verb, "resize") || sscanf(line->value, "%dx%d%c", &width, &height, &more) != 2)
        return false;
    SDL_SetWindowSize(w->sdl, width, height);
    for (int i = 0; i < 200; i++) {
        SDL_Delay(10);
        SDL_PumpEvents();
        if (vkGetPhysicalDeviceSurfaceCapabilitiesKHR(w->gpu, w->surface, &is)) break;
        if (is.currentExtent.width == (uint32_t)width &&
            is.currentExtent.height == (uint32_t)height)
            break;
    }
    return true;
}

bool script_unknown(const script_line *line) {
    return fprintf(stderr, "script: unknown command: %s %s %s\n", line->verb, line->value,
                   line->how),
           false;
}
