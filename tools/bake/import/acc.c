/* acc.c: TORCS's .acc, a dialect of AC3D with up to four textures per object, each with its use:
 *
 *   texture "Road.png" base
 *   texture "shadow2.rgb" tiled
 *   texture empty_texture_no_mapping skids
 *
 * In AC3D an object has one texture, and Assimp would use the last line. This file removes all
 * texture lines except the base. The other textures are overlays (a light map, tyre marks) with
 * separate coordinates, which Assimp skips. */
#include "bake/import/acc.h"

#include <string.h>
#include <strings.h>

bool masu_bake_is_acc(const char *path) {
    size_t length = strlen(path);
    return length > 4 && strcasecmp(path + length - 4, ".acc") == 0;
}

/* True if a line is a texture other than the base. A name is in quotes or has no spaces. */
static bool is_layer(const char *line, size_t length) {
    static const char word[] = "texture";
    size_t at = sizeof word - 1;
    if (length <= at || memcmp(line, word, at) != 0 || (line[at] != ' ' && line[at] != '\t')) {
        return false;
    }
    while (at < length && (line[at] == ' ' || line[at] == '\t')) at++;
    char end = ' ';
    if (at < length && line[at] == '"') {
        end = '"';
        at++;
    } else if (length - at >= 5 && memcmp(line + at, "empty", 5) == 0) {
        return true; /* not even a base */
    }
    while (at < length && line[at] != end) at++;
    at++;
    while (at < length && (line[at] == ' ' || line[at] == '\t')) at++;
    size_t left = at < length ? length - at : 0;
    while (left && (line[at + left - 1] == '\r' || line[at + left - 1] == ' ')) left--;
    return left && !(left == 4 && memcmp(line + at, "base", 4) == 0);
}

void masu_bake_strip_acc(const char *text, size_t bytes, masu_bake_buffer *out) {
    for (size_t at = 0; at < bytes;) {
        const char *end = memchr(text + at, '\n', bytes - at);
        size_t length = end ? (size_t)(end - (text + at)) + 1 : bytes - at;
        size_t line = end ? length - 1 : length;
        if (!is_layer(text + at, line)) masu_bake_append(out, text + at, length);
        at += length;
    }
}
