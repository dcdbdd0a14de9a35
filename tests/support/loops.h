/* loops.h: checks that every loop of a SPIR-V module ends after a number of iterations that is a
 * constant in the module. A shader that loops as long as its data says can hang a GPU; this proves
 * that ours do not.
 *
 * A loop is accepted if each iteration passes a conditional branch that remains in the loop only
 * while a counter has not passed a constant. The counter starts from a constant and changes by
 * constants of one sign in each iteration, and nothing else writes it. The comparison may be part
 * of a chain of &&, || and !, if remaining in the loop implies it. Works on the output of glslang
 * (counters in variables) and of spirv-opt (counters in phis). Loops that it cannot analyse are
 * rejected. */
#ifndef SUPPORT_LOOPS_H
#define SUPPORT_LOOPS_H

#include "support/spirv.h"

#define SUPPORT_ROUNDS_MOST 8192u /* a larger constant is not a bound */

/* Adds the number of loops to *loops. NULL: all are bounded; otherwise the name of the function
 * with an unbounded loop. */
const char *spirv_unbounded_loop(const spirv_module *module, uint32_t *loops);

#endif
