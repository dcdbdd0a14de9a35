/* picture_path.c: see picture_path.h. */
#define _XOPEN_SOURCE 700
#include "bake/import/picture_path.h"
#include "bake/base/inside.h"
#include "bake/import/acc.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int hex(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

void masu_bake_resolve_uri(char *to, const char *from) {
    for (; *from; from++) {
        int high = *from == '%' ? hex(from[1]) : -1, low = high >= 0 ? hex(from[2]) : -1;
        if (low >= 0 && (high || low)) {
            *to++ = (char)(high * 16 + low);
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

/* Puts "FOLDER/NAME" into `out` and says whether it is there. folder_bytes: with its '/', or 0. */
static bool is_there(const char *folder, size_t folder_bytes, const char *name, masu_bake_buffer *out) {
    out->bytes = 0;
    masu_bake_append(out, folder, folder_bytes);
    masu_bake_append(out, name, strlen(name) + 1);
    return *name && access((const char *)out->data, F_OK) == 0;
}

/* Cuts the last part off a path of `*bytes` and says whether it is `wanted` (NULL: whatever it is). */
static bool step_up(const char *path, size_t *bytes, const char *wanted) {
    size_t end = *bytes, at = end;
    while (at && path[at - 1] != '/') at--;
    if (at < 2) return false;
    *bytes = at - 1;
    return !wanted || (end - at == strlen(wanted) && memcmp(path + at, wanted, end - at) == 0);
}

/* The same of what the model may name. */
static bool is_own(const char *model, size_t folder_bytes, const char *name, masu_bake_buffer *out) {
    return is_there(model, folder_bytes, name, out) && masu_bake_inside(model, (const char *)out->data);
}

/* In the shared folder of the TORCS installation that the model is of. */
static bool is_shared(const char *model, const char *name, masu_bake_buffer *out) {
    if (!masu_bake_is_acc(model)) return false;
    char *path = realpath(model, NULL);
    if (!path) return false;
    size_t track = strlen(path), car = track;
    bool found = false;
    bool is_car = step_up(path, &car, NULL) && step_up(path, &car, NULL) && step_up(path, &car, "cars");
    bool is_track = step_up(path, &track, NULL) && step_up(path, &track, NULL) && step_up(path, &track, NULL) &&
                    step_up(path, &track, "tracks");
    if (is_car || is_track) {
        masu_bake_buffer folder = {0};
        masu_bake_append(&folder, path, is_car ? car : track);
        masu_bake_append_text(&folder, "/data/textures/");
        found = is_there((const char *)folder.data, folder.bytes, last_part(name), out);
        masu_bake_release(&folder);
    }
    free(path);
    return found;
}

bool masu_bake_picture_path(const char *model, const char *name, masu_bake_buffer *out) {
    masu_bake_buffer plain = {0}, resolved = {0};
    while (strncmp(name, "./", 2) == 0 || strncmp(name, ".\\", 2) == 0) name += 2;
    masu_bake_append(&plain, name, strlen(name) + 1);
    masu_bake_append(&resolved, name, strlen(name) + 1);
    char *own = (char *)plain.data, *other = (char *)resolved.data;
    for (char *c = own; *c; c++) {
        if (*c == '\\') *c = '/'; /* written where that was the separator */
    }
    masu_bake_resolve_uri(other, other);
    size_t beside = (size_t)(last_part(model) - model), folder = *own == '/' ? 0 : beside;
    bool may = is_own(model, folder, own, out) || (*other != '/' && is_own(model, folder, other, out)) ||
               is_own(model, beside, last_part(other), out) || is_shared(model, other, out);
    if (!may) {
        (void)is_there(model, folder, own, out);
        may = masu_bake_inside(model, (const char *)out->data);
    }
    masu_bake_release(&plain);
    masu_bake_release(&resolved);
    return may;
}
