/* inside.h: what a model may name. A model is somebody's: the files that it says belong to it are read where they lie in
 * its own folder or below, or where the command line has said that files may come from (--texture-path). Everything that
 * opens a file because another file named it asks here: buffers and pictures of glTF, pictures of materials, what Assimp
 * opens besides the model. A scene's description is the user's own, and names what it likes. */
#ifndef MASU_BAKE_INSIDE_H
#define MASU_BAKE_INSIDE_H

#include <stdbool.h>

/* Folders with ':' between, or NULL; the text stays the caller's. Once, before anything is read: children know it too. */
void masu_bake_inside_also(const char *folders);

/* Whether `path` may be opened on behalf of `model`, a file's path: links are followed first. What is not there may be:
 * whoever opens it says so. */
bool masu_bake_inside(const char *model, const char *path);

#endif
