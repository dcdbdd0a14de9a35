/* import.h: imports a model file as a piece of a scene.
 *
 *   import.c   runs the reader in a child process and checks the result
 *   assimp.c   the reader: converts Assimp's scene
 *   gltf.c     Masu's glTF reader, whose scene has Assimp's form
 *   acc.c, stl.c   dialects that Assimp does not support
 *   picture_path.c   finds the images that models name
 *
 * Model files are untrusted. The importing library is large; its asserts, overruns and endless
 * loops must end the child, not masu-bake. The child has a time limit and a memory limit. */
#ifndef MASU_BAKE_IMPORT_H
#define MASU_BAKE_IMPORT_H

#include "bake/import/model.h"

#define MASU_BAKE_IMPORT_SECONDS 120
/* Address space for importing; 16 times the file's size is added. */
#define MASU_BAKE_IMPORT_MEMORY ((rlim_t)3 << 29)

/* Fills `piece`. On false the error has been reported; losses are reported as warnings. */
bool masu_bake_import(const char *path, masu_bake_textures textures, masu_bake_content *piece);

/* The same with more options. */
bool masu_bake_import_as(const char *path, const masu_bake_wanted *wanted,
                         masu_bake_content *piece);

#endif
