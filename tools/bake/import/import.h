/* import.h: a model file becomes a piece of a scene.
 *
 *   import.c   runs the reader in a child process and checks what comes back
 *   assimp.c   the reader: Assimp's scene to ours
 *   gltf.c     our reader of glTF, whose scene has Assimp's form
 *   acc.c, stl.c   dialects that Assimp does not know
 *   picture_path.c   where pictures are that models name
 *
 * Model files are hostile: the importing library is large, and asserts, overruns and endless loops
 * in it must end the child, not masu-bake. The child has a time limit and a limit of memory. */
#ifndef MASU_BAKE_IMPORT_H
#define MASU_BAKE_IMPORT_H

#include "bake/import/model.h"

#define MASU_BAKE_IMPORT_SECONDS 120
/* Address space for importing, to which 16 times the file's size is added. */
#define MASU_BAKE_IMPORT_MEMORY ((rlim_t)3 << 29)

/* Fills `piece`. On false the error has been reported; losses are reported as warnings. */
bool masu_bake_import(const char *path, masu_bake_textures textures, masu_bake_content *piece);

/* The same with more to want. */
bool masu_bake_import_as(const char *path, const masu_bake_wanted *wanted, masu_bake_content *piece);

#endif
