/* stl.c: see stl.h. Exporters for Windows write SOLID, FACET NORMAL and VERTEX; names keep their
 * case. */
#include "bake/import/stl.h"

#include <stdint.h>
#include <string.h>
#include <strings.h>

#define BINARY_HEAD 84u
#define BINARY_FACET 50u

bool masu_bake_is_stl(const char *path) {
    size_t length = strlen(path);
    return length > 4 && strcasecmp(path + length - 4, ".stl") == 0;
}

static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

static bool is_binary(const char *text, size_t bytes) {
    if (bytes < BINARY_HEAD) return false;
    const unsigned char *count = (const unsigned char *)text + BINARY_HEAD - 4;
    uint64_t facets = (uint64_t)count[0] | (uint64_t)count[1] << 8 | (uint64_t)count[2] << 16 |
                      (uint64_t)count[3] << 24;
    return bytes == BINARY_HEAD + facets * BINARY_FACET;
}

static bool is_keyword(const char *word, size_t length) {
    static const char *const words[] = {"solid",  "facet",   "normal",   "outer",   "loop",
                                        "vertex", "endloop", "endfacet", "endsolid"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strlen(words[i]) == length && strncasecmp(words[i], word, length) == 0) return true;
    }
    return false;
}

bool masu_bake_lower_stl(const char *text, size_t bytes, masu_bake_buffer *out) {
    size_t first = 0;
    bool changed = false;
    while (first < bytes && is_space(text[first])) first++;
    if (bytes - first < 6 || strncasecmp(text + first, "solid", 5) != 0 || is_binary(text, bytes) ||
        memchr(text, '\0', bytes))
        return false;
    char *to = masu_bake_append(out, NULL, bytes - first + 1); /* with a NUL */
    memcpy(to, text + first, bytes - first);
    for (size_t at = 0; at < bytes - first;) {
        size_t end = at;
        bool named =
            strncasecmp(to + at, "solid", 5) == 0 || strncasecmp(to + at, "endsolid", 8) == 0;
        while (to[end] && !is_space(to[end])) end++;
        for (size_t i = at; i < end && is_keyword(to + at, end - at); i++) {
            changed = changed || (to[i] >= 'A' && to[i] <= 'Z');
            if (to[i] >= 'A' && to[i] <= 'Z') to[i] = (char)(to[i] + 32);
        }
        while (named && to[end] && to[end] != '\n') end++; /* the name */
        while (is_space(to[end])) end++;
        at = end > at ? end : at + 1;
    }
    out->bytes--;
    return changed || first;
}
