/* picture_path.h: finds a file that a model names: an image or a glTF buffer. The names often come
 * from another machine: with other separators, as a URI, with folders that do not exist here. The
 * default search order:
 *
 *   1. the name unchanged, below the model's folder
 *   2. the same with "%20" decoded
 *   3. its last part, in the model's folder
 *   4. for a TORCS track or car (.acc): its last part in the installation's shared textures:
 *      ROOT/data/textures for ROOT/tracks/CATEGORY/NAME/FILE.acc and ROOT/cars/NAME/FILE.acc
 * If 1 to 3 find nothing, they are repeated without case sensitivity, as Windows finds files.
 *
 * The folders of masu-bake --texture-path are searched after these (texture/image.c). */
#ifndef MASU_BAKE_PICTURE_PATH_H
#define MASU_BAKE_PICTURE_PATH_H

#include "bake/base/buffer.h"

#include <stdbool.h>

/* Writes the path, with its NUL, to `out`: the first that exists and, for 1 to 3, that the model
 * may name (base/inside.h); else the first. False: that one exists and must not be read. name: a
 * path or a file: URI, not an image inside the model. */
bool masu_bake_picture_path(const char *model, const char *name, masu_bake_buffer *out);

/* "%20" becomes a space; never a NUL. '\' becomes '/'. to: as large as from; may be the same
 * buffer. */
void masu_bake_resolve_uri(char *to, const char *from);
/* Decodes every "%20", NUL too. Returns how many bytes; to: as large as from. */
size_t masu_bake_resolve_escapes(unsigned char *to, const char *from);

#endif
