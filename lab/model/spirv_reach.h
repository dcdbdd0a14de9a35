/* spirv_reach.h: which instructions of a shader are left once its specialisation constants are set: a branch whose
 * condition follows from constants alone goes one way, and what only the other leads to is compiled away. Nothing
 * is rewritten. */
#ifndef MASU_SPIRV_REACH_H
#define MASU_SPIRV_REACH_H

#include "lab/model/spirv_cost.h"

#include <stdbool.h>
#include <vulkan/vulkan_core.h>

/* inside[k]: whether instruction k of the module can run, of module->count; false of all that is outside of
 * functions. special: NULL: as the module has them. Returns false where memory is short. */
bool masu_spirv_reach(const spirv_module *module, const VkSpecializationInfo *special, bool *inside);

/* Of all instructions that can run once, whatever loops and other branches there are. Where memory is short, of
 * all. */
masu_spirv_cost masu_spirv_cost_reached(const spirv_module *module, const VkSpecializationInfo *special);

#endif
