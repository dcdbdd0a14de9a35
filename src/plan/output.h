/* output.h: output transform: encoding and steps of the target's format, tone curve, dither, and
 * the precision of intermediate colour. Pure functions of the description and the plan.
 * shaders/shared/output.glsl is the GPU counterpart. */
#ifndef MASU_OUTPUT_H
#define MASU_OUTPUT_H

#include "plan/plan.h"

/* Sets defaults of the output fields. All other fields must have their defaults. */
void masu_output_defaults(masu_desc *desc);
/* For a description with defaults. MASU_ERROR_ARGUMENT: `detail` names the field. */
masu_result masu_output_check(const masu_desc *desc, masu_detail *detail);
/* Whether targets of this format are filled by a copy of bytes instead of a blit. */
int masu_output_copies(const masu_desc *desc);
/* Fills the output fields of the plan; plan->needs must be complete. */
void masu_output_plan(masu_frame_plan *plan);
/* Sets output_steps (the target's steps, 10 bits each for red, green and blue) and output_flags
 * (MASU_OUTPUT_*) for the last pass of a rung. Leaves both unchanged for other passes. */
void masu_output_push(const masu_frame_plan *plan, const masu_rung_plan *rung, uint32_t pass,
                      struct masu_push *push);

#endif
