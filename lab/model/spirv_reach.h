/* spirv_reach.h: finds the instructions of a shader that remain after its specialisation constants
 * are set: a branch with a constant condition takes one path, and code reachable only by the other
 * path is removed by the compiler. The module is not changed. */
#ifndef MASU_SPIRV_REACH_H
#define MASU_SPIRV_REACH_H

#include "lab/model/spirv_cost.h"

#include <stdbool.h>
#include <vulkan/vulkan_core.h>

/* inside[k]: whether instruction k of the module can run, for module->count instructions; false
 * outside functions. special: NULL: the module's defaults. Returns false if there is no memory. */
bool masu_spirv_reach(const spirv_module *module, const VkSpecializationInfo *special,
                      bool *inside);

/* Cost of all instructions that can run, ignoring branches: each once, those of a loop that
 * compilers unroll once per iteration, as in the compiled code. Without memory: of all
 * instructions, each once. */
masu_spirv_cost masu_spirv_cost_reached(const spirv_module *module,
                                        const VkSpecializationInfo *special);

#endif
