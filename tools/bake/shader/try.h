/* try.h: tests whether fields of hand-written GLSL satisfy their Lipschitz constant: blocks of a
 * .sdf scene, of which masu-sdfc only has the text, and GLSL sources. masu-bake compiles them
 * anyway, and runs the SPIR-V on the CPU (spirv.h). */
#ifndef MASU_BAKE_TRY_H
#define MASU_BAKE_TRY_H

#include "sdfc/sdfc.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The compute shader that evaluates one part, compiled together with sdf_scene.glsl. */
extern const char masu_bake_try_source[];

/* True if any part contains a block. */
bool masu_bake_try_needed(const masu_sdfc_result *scene);

/* The inputs that a module of the shader above still reads after optimisation: constant expressions
 * and code without influence on the result are ignored. */
typedef struct masu_bake_reads {
    bool time, params;
} masu_bake_reads;
masu_bake_reads masu_bake_try_reads(const uint32_t *words, size_t count);

/* Tests all these parts with that module, in a child process. A GLSL source is one part without a
 * name, tested within its bounds. False: an error has been reported. If a module cannot be run,
 * that is a warning and its constants are accepted. The first of cameras->cameras inside such a
 * part is a warning, with parameters at their defaults. *steepest, if not NULL: the constants are
 * ignored, and it receives the steepest slope found. */
bool masu_bake_try(const masu_sdfc_result *scene, const uint32_t *words, size_t count,
                   const masu_sdfc_options *cameras, const char *path, double *steepest);

#endif
