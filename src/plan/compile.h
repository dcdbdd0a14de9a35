/* compile.h: a description becomes a plan. Pure data, no Vulkan calls, no allocation.
 *
 * masu_compile turns zeros into defaults, checks the description, decides for each rung which passes run,
 * resolves the stand-ins ("latest depth", "latest colour"), and derives each image's size, usage flags and
 * lifetime and each buffer's size. It fails with the detail filled where the description is refused. */
#ifndef MASU_COMPILE_H
#define MASU_COMPILE_H

#include "plan/plan.h"

/* Fills plan from desc. Device limits that shape the buffers come in as alignments. */
masu_result masu_compile(const masu_desc *desc, uint64_t uniform_alignment,
                         uint64_t storage_alignment, masu_frame_plan *plan, masu_detail *detail);

/* The plan as the public struct. pipeline_ns may be NULL. */
void masu_plan_export(const masu_frame_plan *plan, const uint64_t *pipeline_ns,
                      masu_plan_info *out);
/* Its memory part. */
void masu_memory_export(const masu_frame_plan *plan, uint64_t host_bytes, masu_memory *out);

#endif
