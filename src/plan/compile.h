/* compile.h: compiles a description to a plan. Pure functions: no Vulkan calls, no allocation.
 *
 * masu_compile replaces zeros by defaults and checks the description. It decides which passes run
 * in each rung, resolves the stand-ins ("latest depth", "latest colour"), and derives the size,
 * usage flags and lifetime of each image and the size of each buffer. If the description is
 * invalid, it fails and fills `detail`. */
#ifndef MASU_COMPILE_H
#define MASU_COMPILE_H

#include "plan/plan.h"

/* Fills `plan` from `desc`. Buffer sizes depend on two limits of the device, the alignments. */
masu_result masu_compile(const masu_desc *desc, uint64_t uniform_alignment,
                         uint64_t storage_alignment, masu_frame_plan *plan, masu_detail *detail);

/* Writes the plan as the public struct. pipeline_ns: creation time per pass, or NULL. */
void masu_plan_export(const masu_frame_plan *plan, const uint64_t *pipeline_ns,
                      masu_plan_info *out);
/* Writes the memory part of the plan. */
void masu_memory_export(const masu_frame_plan *plan, uint64_t host_bytes, masu_memory *out);

#endif
