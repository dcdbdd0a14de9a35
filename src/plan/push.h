/* push.h: the push constants of a pass: sizes, then what its row in passes.inc tells its shader.
 *
 * Pure functions of a plan; what changes from draw to draw record.c fills in. */
#ifndef MASU_PUSH_H
#define MASU_PUSH_H

#include "plan/plan.h"

/* As shaders/shared/push.glsl declares the block: the structs masu_push_NAME of tables.h begin at `own`. */
#define MASU_PUSH_OWN 16u
typedef struct masu_push_block {
    struct masu_push sizes;
    union {
        uint32_t word[MASU_PUSH_OWN];
        float real[MASU_PUSH_OWN];
    } own;
} masu_push_block;
_Static_assert(sizeof(masu_push_block) <= 128, "every device has 128 bytes of push constants");

/* What the values of a row are computed of. */
typedef struct masu_push_input {
    const masu_frame_plan *plan;
    uint32_t rung, pass;
    uint32_t few;   /* of occlusion culling: workgroups of batches with at most 64 instances */
    float scale[2]; /* input pixels / output pixels, as upscale/place.glsl wants it */
} masu_push_input;

/* All of a pass; few: see above. */
masu_push_block masu_push_of(const masu_frame_plan *plan, uint32_t rung, uint32_t pass, uint32_t few);

#endif
