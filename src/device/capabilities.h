/* capabilities.h: compares the plan with the device. Features that the host left to MASU_AUTO are
 * turned off if the device cannot run them. Features that the host requires are an error, and
 * `detail` names the limit. */
#ifndef MASU_CAPABILITIES_H
#define MASU_CAPABILITIES_H

#include "device/vk.h"
#include "plan/plan.h"

/* Mali and the Raspberry Pi, whose threads have at most 64 registers. */
int masu_few_registers(const VkPhysicalDeviceProperties *properties);

/* Resolves the MASU_AUTO fields of `desc`. `plan` is the plan of `desc` before the call; its rungs
 * are used if the host gave none. *computed_for: the GPU class whose measured rung costs were used;
 * "" if none. */
masu_result masu_capabilities_fit(masu_desc *desc, const masu_frame_plan *plan, const masu_vk *vk,
                                  const char **computed_for, masu_detail *detail);
/* Checks the plan of the resolved description: buffer ranges, dispatch sizes and the shadow map. */
masu_result masu_capabilities_check(const masu_frame_plan *plan, const masu_vk *vk,
                                    masu_detail *detail);

#endif
