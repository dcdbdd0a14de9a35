/* issued.h: operations of SPIR-V as instructions of a GPU, by what its own compiler has made of a scene's
 * pipelines (isa/isa.h).
 *
 * A frame here counts operations as they run, through every loop and branch; a compiler says how many
 * instructions a pipeline is, written down once. What joins them is the pipeline written down once in
 * operations: each operation is as many instructions as all are on average, those for addresses, memory and
 * branches among them. Per pass, its pipelines taken together; vertex shaders apart.
 *
 * Written down once in operations is what the pipeline's constants leave of the SPIR-V (spirv_reach.h), as in
 * instructions.
 */
#ifndef MASU_MODEL_ISSUED_H
#define MASU_MODEL_ISSUED_H

#include "lab/isa/isa.h"
#include "plan/frame_plan.h"

typedef struct masu_issued {
    bool known; /* false: the rest says nothing */
    struct {
        double instructions[2]; /* of its pipelines, once: 0 fragment and compute, 1 vertex shaders */
        /* How many times as long as its instructions a pass takes because too few waves are there to wait for
         * memory in turns: latency / (waves x inverse throughput), at least 1. RADV says; others: 1. */
        double waits;
    } pass[MASU_PASS_COUNT];
} masu_issued;

void masu_issued_make(const masu_isa_rows *rows, masu_issued *out);

#endif
