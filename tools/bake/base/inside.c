/* inside.c: see inside.h. */
#define _XOPEN_SOURCE 700
#include "bake/base/inside.h"
#include "bake/base/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char *also;

void masu_bake_inside_also(const char *folders) { also = folders; }

/* Of a path without links, "." and "..". */
static bool lies_in(const char *folder, const char *path) {
    char *root = realpath(folder, NULL);
    if (!root) return false;
    size_t length = strlen(root);
    bool inside =
        strcmp(root, "/") == 0 || (strncmp(path, root, length) == 0 && path[length] == '/');
    free(root);
    return inside;
}

bool masu_bake_inside(const char *model, const char *path) {
    char *real = realpath(path, NULL);
    if (!real) return errno == ENOENT || errno == ENOTDIR;
    char *folder = masu_bake_directory_of(model);
    bool inside = lies_in(folder, real);
    free(folder);
    for (const char *at = also; !inside && at && *at;) {
        size_t length = strcspn(at, ":");
        char *one = masu_bake_allocate(length + 1);
        memcpy(one, at, length);
        one[length] = '\0';
        inside = length && lies_in(one, real);
        free(one);
        at += length + (at[length] == ':');
    }
    free(real);
    return inside;
}
