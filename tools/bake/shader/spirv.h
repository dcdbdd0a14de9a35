/* spirv.h: runs the main function of a compute shader on the CPU, one invocation at a time, with
 * every float in double precision. masu-bake evaluates a scene's own GLSL with it, without a GPU.
 *
 * Supports modules that spirv-val has passed: buffers of floats or integers, arithmetic, control
 * flow, calls, GLSL.std.450. A module with anything else (images, atomics, derivatives) is rejected
 * with the number of the instruction, never run in part. Each run has a budget of instructions, so
 * that it ends. The machine owns its memory; there are no globals. */
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

/* NULL, with one line in `error`: unsupported, or out of memory. `words` must outlive the
 * machine. */
masu_bake_machine *masu_bake_machine_make(const uint32_t *words, size_t count, char *error,
                                          size_t error_size);
void masu_bake_machine_free(masu_bake_machine *machine);

/* The memory of the buffer at that binding of set 0, its members in order without padding; NULL:
 * the shader does not use it. *count: the number of cells. */
masu_bake_cell *masu_bake_machine_buffer(masu_bake_machine *machine, uint32_t binding,
                                         size_t *count);

/* For each id, the margin of its comparison, minimum, maximum, clamp or step in the last run; the
 * sign is the side that it decided for. NAN: no decision there. *count: the number of ids. */
const double *masu_bake_machine_decisions(const masu_bake_machine *machine, size_t *count);
/* The ids with a decision in the last run, in order. */
const uint32_t *masu_bake_machine_decided(const masu_bake_machine *machine, size_t *count);

/* Instructions executed by all runs. */
uint64_t masu_bake_machine_steps(const masu_bake_machine *machine);

/* False, with one line in `error`: out of budget, an array index out of range, an unsupported
 * instruction. */
bool masu_bake_machine_run(masu_bake_machine *machine, char *error, size_t error_size);

#endif
