/* loops.h: does every loop of a SPIR-V module end after a number of rounds that stands in
 * the module? A shader that loops for as long as its data says can hang a GPU; this is the proof
 * that ours do not.
 *
 * A loop is accepted when in each round control passes a conditional branch that stays in the loop
 * only while a counter has not passed a constant. The counter starts from a constant and moves by
 * constants of one sign in each round; nothing else touches it. The comparison may be part of a
 * chain of &&, || and !, as long as staying implies it. Works on what glslang writes (counters in
 * variables) and on what spirv-opt makes of it (phis). Where it cannot tell, it says no. */
#ifndef SUPPORT_LOOPS_H
#define SUPPORT_LOOPS_H

#include "support/spirv.h"

#define SUPPORT_ROUNDS_MOST 8192u /* a constant as large as that bounds nothing */

/* Adds the number of loops to *loops. NULL: all are bounded; else the name of the function that has
 * one that is not. */
const char *spirv_unbounded_loop(const spirv_module *module, uint32_t *loops);

#endif
