/* push.h: the push constants of a pass: sizes, then the values of its row in passes.inc.
 *
 * Pure functions of a plan. record.c fills in values that change per draw. */
#ifndef MASU_PUSH_H
#define MASU_PUSH_H

#include "plan/plan.h"

/* The push constant block as in shaders/shared/push.glsl; the structs masu_push_NAME of tables.h
 * start at `own`. */
#define MASU_PUSH_OWN 16u
typedef struct masu_push_block {
    struct masu_push sizes;
    union {
        uint32_t word[MASU_PUSH_OWN];
        float real[MASU_PUSH_OWN];
    } own;
} masu_push_block;
_Static_assert(sizeof(masu_push_block) <= 128, "every device has 128 bytes of push constants");

/* Inputs of the expressions in rows. */
typedef struct masu_push_input {
    const masu_frame_plan *plan;
    uint32_t rung, pass;
    uint32_t few;   /* occlusion culling: workgroups of batches with at most 64 instances */
    float scale[2]; /* input pixels / output pixels, for upscale/place.glsl */
} masu_push_input;

/* All push constants of a pass. few: see above. */
masu_push_block masu_push_of(const masu_frame_plan *plan, uint32_t rung, uint32_t pass,
                             uint32_t few);

#endif
