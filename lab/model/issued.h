/* issued.h: converts SPIR-V operations to instructions of a GPU, with the output of the GPU's
 * compiler for a scene's pipelines (isa/isa.h).
 *
 * count.h counts operations as they execute, including every loop iteration and branch. A compiler
 * reports the number of instructions of a pipeline's code, each counted once. The ratio between
 * them is the pipeline's instructions / its operations, each counted once: an operation corresponds
 * to the average number of instructions, including those for addresses, memory and branches.
 * Computed per pass over all its pipelines, separately for vertex shaders.
 *
 * Operations are counted in the SPIR-V that the pipeline's constants leave reachable
 * (spirv_reach.h), as the compiler does for instructions. */
#ifndef MASU_MODEL_ISSUED_H
#define MASU_MODEL_ISSUED_H

#include "lab/isa/isa.h"
#include "plan/frame_plan.h"

typedef struct masu_issued {
    bool known; /* false: the rest is undefined */
    struct {
        double instructions[2]; /* code size of its pipelines: 0 fragment and compute, 1 vertex
                                 * shaders */
        /* Factor on the time of a pass because too few waves are resident to hide memory latency:
         * latency / (waves x inverse throughput), at least 1. Only RADV reports it; others: 1. */
        double waits;
    } pass[MASU_PASS_COUNT];
} masu_issued;

void masu_issued_make(const masu_isa_rows *rows, masu_issued *out);

#endif
