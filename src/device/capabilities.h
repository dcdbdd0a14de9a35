/* capabilities.h: what the device can do against what a plan needs. What the host has left to us is
 * turned down where it is too much; what it has asked for is refused, and the detail names the limit. */
#ifndef MASU_CAPABILITIES_H
#define MASU_CAPABILITIES_H

#include "device/vk.h"
#include "plan/plan.h"

/* Decides in `desc` what is open there; `plan` is of it as the host gave it, and its rungs are taken
 * where the host gave none. *computed_for: the class of GPUs that costs of rungs were taken of; "": none were. */
masu_result masu_capabilities_fit(masu_desc *desc, const masu_frame_plan *plan, const masu_vk *vk,
                                  const char **computed_for, masu_detail *detail);
/* Of the plan of what that has left: sizes of buffers, dispatches and the shadow map. */
masu_result masu_capabilities_check(const masu_frame_plan *plan, const masu_vk *vk,
                                    masu_detail *detail);

#endif
