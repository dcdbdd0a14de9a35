/* spirv_cost.h: how many operations an instruction of SPIR-V is, by one table.
 *
 * Two numbers. `plain`: scalar operations, a transcendental as one and a fused multiply-add as one:
 * what a listing of the shader would be counted by. `weighted`: in units of a GPU's peak figure, in
 * which an addition is one and a fused multiply-add two. */
#ifndef MASU_SPIRV_COST_H
#define MASU_SPIRV_COST_H

#include "spirv/spirv.h"

typedef struct masu_spirv_cost {
    uint32_t plain, weighted;
} masu_spirv_cost;

/* Of one instruction; 0 and 0 for what moves, names or branches, and for fetches. */
masu_spirv_cost masu_spirv_cost_of(const spirv_module *module, const spirv_instruction *i);

/* Of all instructions once, whatever branches and loops there are. */
masu_spirv_cost masu_spirv_cost_straight(const spirv_module *module);

/* Components of a type: 1 of a scalar, n of a vector, n * m of a matrix; 0 of what is none. */
uint32_t masu_spirv_components(const spirv_module *module, uint32_t type);

/* The type of the value with that id; 0: not known. */
uint32_t masu_spirv_type_of(const spirv_module *module, uint32_t id);

#endif
