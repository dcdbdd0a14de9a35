/* try.h: GLSL blocks of a .sdf scene, tried: does the field of each part that holds one keep to
 * the Lipschitz constant that its author has stated? masu-sdfc proves and tries what
 * it has written itself; of a block it has only the text. masu-bake compiles it anyway, and runs the
 * SPIR-V on random pairs of points (spirv.h). */
#ifndef MASU_BAKE_TRY_H
#define MASU_BAKE_TRY_H

#include "sdfc/sdfc.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The compute shader that evaluates one part, to be compiled beside sdf_scene.glsl. */
extern const char masu_bake_try_source[];

/* Whether any part holds a block. */
bool masu_bake_try_needed(const masu_sdfc_result *scene);

/* Tries all such parts with that module, in a child process. False: the message is out. A module
 * that cannot be run is a warning: its parts are believed. */
bool masu_bake_try(const masu_sdfc_result *scene, const uint32_t *words, size_t count,
                   const char *path);

#endif
