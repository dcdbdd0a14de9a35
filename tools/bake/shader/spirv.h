/* spirv.h: runs the main function of a compute shader on the CPU, one invocation at a time, with
 * every float in double precision: what a scene's own GLSL computes, before any GPU has seen it.
 *
 * For modules that spirv-val has passed: buffers of floats or numbers, arithmetic, control flow,
 * calls, GLSL.std.450. Anything else (images, atomics, derivatives) is not known: the module is
 * then refused by the number of the instruction, never run in part. Each run has a budget of
 * instructions, so that it ends. The machine owns its memory; nothing is global. */
#ifndef MASU_BAKE_SPIRV_H
#define MASU_BAKE_SPIRV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef union masu_bake_cell {
    double f;   /* of a float */
    uint32_t u; /* of an int, a uint, a bool (0 or 1) */
} masu_bake_cell;

typedef struct masu_bake_machine masu_bake_machine;

/* NULL, with one line in `error`: not known, or no memory. The words must outlive the machine. */
masu_bake_machine *masu_bake_machine_make(const uint32_t *words, size_t count, char *error,
                                          size_t error_size);
void masu_bake_machine_free(masu_bake_machine *machine);

/* The memory of the buffer at that binding of set 0, member after member, without padding; NULL:
 * the shader does not use it. *count: how many cells. */
masu_bake_cell *masu_bake_machine_buffer(masu_bake_machine *machine, uint32_t binding,
                                         size_t *count);

/* Of each id: by how much its comparison, minimum, maximum, clamp or step decided as it did in the
 * last run, above or below 0 by the side; NAN: nothing was decided there. *count: how many ids. */
const double *masu_bake_machine_decisions(const masu_bake_machine *machine, size_t *count);
/* The ids that decided something in the last run, in order. */
const uint32_t *masu_bake_machine_decided(const masu_bake_machine *machine, size_t *count);

/* Instructions that all runs so far have executed. */
uint64_t masu_bake_machine_steps(const masu_bake_machine *machine);

/* False, with one line in `error`: out of budget, an index outside of its array, an instruction
 * that is not known. */
bool masu_bake_machine_run(masu_bake_machine *machine, char *error, size_t error_size);

#endif
