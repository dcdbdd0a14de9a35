/* inside.h: restricts the files that a model may open. Models are untrusted: files that they
 * name are read only from the model's folder and its subfolders, or from folders given by
 * --texture-path. All code that opens a file named by another file must check here: buffers and
 * images of glTF, images of materials, and files that Assimp opens. A scene description is
 * trusted and may name any file. */
#ifndef MASU_BAKE_INSIDE_H
#define MASU_BAKE_INSIDE_H

#include <stdbool.h>

/* Folders separated by ':', or NULL; the caller keeps the string. Call once, before anything is
 * read, so that child processes inherit it. */
void masu_bake_inside_also(const char *folders);

/* Whether `path` may be opened for `model`, a file's path, after links are resolved. A missing
 * file is allowed: opening it reports the error. */
bool masu_bake_inside(const char *model, const char *path);

#endif
