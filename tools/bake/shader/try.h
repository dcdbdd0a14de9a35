/* try.h: tests whether fields of hand-written GLSL keep to their Lipschitz constant: blocks of a
 * .sdf scene, of which masu-sdfc only has the text, and sources of GLSL. masu-bake compiles them
 * anyway, and runs the SPIR-V on the CPU (spirv.h). */
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

/* What a module of the shader above still reads after optimisation: constant expressions and code
 * that has no influence on the result do not count. */
typedef struct masu_bake_reads {
    bool time, params;
} masu_bake_reads;
masu_bake_reads masu_bake_try_reads(const uint32_t *words, size_t count);

/* Tests all such parts with that module, in a child process. A source of GLSL is one part without a
 * name, tested within its bounds. False: the message is out. A module that cannot be run is a
 * warning: its constants are believed. Of cameras->cameras, the first one inside such a part is a
 * warning, with parameters at their defaults. *steepest, if not NULL: the constants are ignored,
 * and this becomes the steepest slope that was found. */
bool masu_bake_try(const masu_sdfc_result *scene, const uint32_t *words, size_t count,
                   const masu_sdfc_options *cameras, const char *path, double *steepest);

#endif
