/* spirv_cost.h: number of operations of a SPIR-V instruction, from a table.
 *
 * Two numbers. `plain`: scalar operations; a transcendental function and a fused multiply-add are
 * one each, as in a count of the shader's listing. `weighted`: in units of a GPU's peak figure, in
 * which an addition is one and a fused multiply-add two. */
#ifndef MASU_SPIRV_COST_H
#define MASU_SPIRV_COST_H

#include "spirv/spirv.h"

typedef struct masu_spirv_cost {
    uint32_t plain, weighted;
} masu_spirv_cost;

/* The cost of one instruction; 0 and 0 for moves, names, branches and fetches. */
masu_spirv_cost masu_spirv_cost_of(const spirv_module *module, const spirv_instruction *i);

/* The cost of all instructions, each once, ignoring branches and loops. */
masu_spirv_cost masu_spirv_cost_straight(const spirv_module *module);

/* Components of a type: 1 for a scalar, n for a vector, n * m for a matrix; 0 for other types. */
uint32_t masu_spirv_components(const spirv_module *module, uint32_t type);

/* The type of the value with that id; 0: unknown. */
uint32_t masu_spirv_type_of(const spirv_module *module, uint32_t id);

#endif
