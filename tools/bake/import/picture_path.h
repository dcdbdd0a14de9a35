/* picture_path.h: where a file lies that a model file names: a picture, a glTF buffer. Names are of
 * other machines as often as not: with other separators, as a URI, with folders that are not here.
 * All places that are looked at by themselves are here:
 *
 *   1. the name as it is, below the model's folder
 *   2. the same with "%20" resolved
 *   3. its last part beside the model
 *   4. of a TORCS track or car (.acc) its last part in the shared textures of the same installation: of
 *      ROOT/tracks/CATEGORY/NAME/FILE.acc and ROOT/cars/NAME/FILE.acc that is ROOT/data/textures
 * If none of 1 to 3 is there, the same again with letters in another case, as Windows finds files.
 *
 * Whatever masu-bake --texture-path names is looked at after these (texture/image.c). */
#ifndef MASU_BAKE_PICTURE_PATH_H
#define MASU_BAKE_PICTURE_PATH_H

#include "bake/base/buffer.h"

#include <stdbool.h>

/* Puts the path, with its NUL, into `out`: the first of these that is there and, of 1 to 3, that
 * the model may name (base/inside.h); else the first. False: that one is there, and must not be
 * read. name: not of a picture inside the model; a path or a file: URI. */
bool masu_bake_picture_path(const char *model, const char *name, masu_bake_buffer *out);

/* "%20" becomes a space; never a NUL. '\' becomes '/'. to: as large as from, of which it may be
 * the same. */
void masu_bake_resolve_uri(char *to, const char *from);
/* Every "%20" becomes its byte, NUL too. Returns how many bytes; to: as large as from. */
size_t masu_bake_resolve_escapes(unsigned char *to, const char *from);

#endif
