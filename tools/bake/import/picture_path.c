/* picture_path.c: see picture_path.h. */
#define _XOPEN_SOURCE 700
#include "bake/import/picture_path.h"
#include "bake/base/file.h"
#include "bake/base/inside.h"
#include "bake/import/acc.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

static int hex(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* The byte of "%20" at `from`, or -1. */
static int escape_at(const char *from) {
    int high = *from == '%' ? hex(from[1]) : -1, low = high >= 0 ? hex(from[2]) : -1;
    return low >= 0 ? high * 16 + low : -1;
}

size_t masu_bake_resolve_escapes(unsigned char *to, const char *from) {
    size_t bytes = 0;
    for (; *from; from++) {
        int escape = escape_at(from);
        to[bytes++] = escape >= 0 ? (unsigned char)escape : (unsigned char)*from;
        if (escape >= 0) from += 2;
    }
    return bytes;
}

void masu_bake_resolve_uri(char *to, const char *from) {
    for (; *from; from++) {
        int escape = escape_at(from);
        if (escape > 0) {
            *to++ = (char)escape;
            from += 2;
        } else {
            *to++ = *from == '\\' ? '/' : *from;
        }
    }
    *to = '\0';
}

static const char *last_part(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Writes "FOLDER/NAME" to `out`, with any_case in the file's actual spelling, and returns whether
 * it exists. folder_bytes: with its '/', or 0. */
static bool is_there(const char *folder, size_t folder_bytes, const char *name, bool any_case,
                     masu_bake_buffer *out) {
    out->bytes = 0;
    masu_bake_append(out, folder, folder_bytes);
    if (any_case) {
        if (!masu_bake_append_spelling(out, name)) return false;
        masu_bake_append(out, "", 1);
        return true;
    }
    masu_bake_append(out, name, strlen(name) + 1);
    return *name && access((const char *)out->data, F_OK) == 0;
}

/* Removes the last part of a path of `*bytes` and returns whether it is `wanted` (NULL: any). */
static bool step_up(const char *path, size_t *bytes, const char *wanted) {
    size_t end = *bytes, at = end;
    while (at && path[at - 1] != '/') at--;
    if (at < 2) return false;
    *bytes = at - 1;
    return !wanted || (end - at == strlen(wanted) && memcmp(path + at, wanted, end - at) == 0);
}

/* The same, restricted to files that the model may name. */
static bool is_own(const char *model, size_t folder_bytes, const char *name, bool any_case,
                   masu_bake_buffer *out) {
    return is_there(model, folder_bytes, name, any_case, out) &&
           masu_bake_inside(model, (const char *)out->data);
}

/* Searches the shared folder of the TORCS installation that contains the model. */
static bool is_shared(const char *model, const char *name, masu_bake_buffer *out) {
    if (!masu_bake_is_acc(model)) return false;
    char *path = realpath(model, NULL);
    if (!path) return false;
    size_t track = strlen(path), car = track;
    bool found = false;
    bool is_car =
        step_up(path, &car, NULL) && step_up(path, &car, NULL) && step_up(path, &car, "cars");
    bool is_track = step_up(path, &track, NULL) && step_up(path, &track, NULL) &&
                    step_up(path, &track, NULL) && step_up(path, &track, "tracks");
    if (is_car || is_track) {
        masu_bake_buffer folder = {0};
        masu_bake_append(&folder, path, is_car ? car : track);
        masu_bake_append_text(&folder, "/data/textures/");
        found = is_there((const char *)folder.data, folder.bytes, last_part(name), false, out) ||
                is_there((const char *)folder.data, folder.bytes, last_part(name), true, out);
        masu_bake_release(&folder);
    }
    free(path);
    return found;
}

/* The path of a file: URI ("file:///C:/a", "file://host/a", "file:a"), or the name unchanged. */
static const char *without_scheme(const char *name) {
    if (strncasecmp(name, "file:", 5) != 0) return name;
    name += 5;
    return strncmp(name, "//", 2) == 0 ? name + 2 + strcspn(name + 2, "/") : name;
}

bool masu_bake_picture_path(const char *model, const char *name, masu_bake_buffer *out) {
    masu_bake_buffer plain = {0}, resolved = {0};
    name = without_scheme(name);
    while (strncmp(name, "./", 2) == 0 || strncmp(name, ".\\", 2) == 0) name += 2;
    masu_bake_append(&plain, name, strlen(name) + 1);
    masu_bake_append(&resolved, name, strlen(name) + 1);
    char *own = (char *)plain.data, *other = (char *)resolved.data;
    for (char *c = own; *c; c++) {
        if (*c == '\\') *c = '/'; /* from a system with that separator */
    }
    masu_bake_resolve_uri(other, other);
    size_t beside = (size_t)(last_part(model) - model), folder = *own == '/' ? 0 : beside;
    bool may = false;
    for (int any_case = 0; any_case < 2 && !may; any_case++) {
        may = (!(any_case && *own == '/') && is_own(model, folder, own, any_case, out)) ||
              (*other != '/' && is_own(model, folder, other, any_case, out)) ||
              is_own(model, beside, last_part(other), any_case, out);
    }
    may = may || is_shared(model, other, out);
    if (!may) {
        bool escaped =
            !is_there(model, folder, own, false, out) && is_there(model, folder, other, false, out);
        if (!escaped) (void)is_there(model, folder, own, false, out);
        may = masu_bake_inside(model, (const char *)out->data);
    }
    masu_bake_release(&plain);
    masu_bake_release(&resolved);
    return may;
}
