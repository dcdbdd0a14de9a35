/* output.h: what becomes of the picture at its end: encoding and steps of the target's format, the tone
 * curve, dither, and in how many bits colour is kept in between. Pure functions of the description and
 * the plan; shaders/shared/output.glsl is their other half. */
#ifndef MASU_OUTPUT_H
#define MASU_OUTPUT_H

#include "plan/plan.h"

/* Fills in what the description leaves open; the rest of it has its defaults. */
void masu_output_defaults(masu_desc *desc);
/* Of a description with defaults: MASU_ERROR_ARGUMENT names the field. */
masu_result masu_output_check(const masu_desc *desc, masu_detail *detail);
/* Whether targets of that format are filled by a copy of bytes. */
int masu_output_copies(const masu_desc *desc);
/* What the plan says of it; after its needs are known. */
void masu_output_plan(masu_frame_plan *plan);
/* Of expose: param speed to brighten, to darken, least, most; index.xy shares of 65536 left out. Of
 * passes that write colour: index.z the target's steps, 10 bits each of red, green, blue; index.w
 * MASU_OUTPUT_* of the one that comes last in its rung, else 0. Of tonemap also param.x white in nits,
 * param.y the most that is shown, in whites. */
void masu_output_push(const masu_frame_plan *plan, const masu_rung_plan *rung, uint32_t pass,
                      struct masu_push *push);

#endif
