/* bake_import.h: a model file becomes a piece of a scene.
 *
 *   bake_import.c   runs the reader in a child process and checks what comes back
 *   bake_model.c    the reader: Assimp's scene to ours
 *
 * Model files are hostile: the importing library is large, and asserts, overruns and endless loops
 * in it must end the child, not masu-bake. The child has a time limit and half of the memory. */
#ifndef MASU_BAKE_IMPORT_H
#define MASU_BAKE_IMPORT_H

#include "bake_content.h"

#define MASU_BAKE_IMPORT_SECONDS 120

/* Fills `piece`. On false the error has been reported; losses are reported as warnings. */
bool masu_bake_import(const char *path, masu_bake_content *piece);

/* The child's part. Leaves warnings, one per line, and on failure an error. */
void masu_bake_read_model(const char *path, masu_bake_content *piece, masu_bake_buffer *warnings,
                          masu_bake_buffer *error);

#endif
