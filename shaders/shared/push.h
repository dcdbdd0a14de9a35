/* push.h: push constants common to all passes. The constants of the pass itself follow; the rows of
 * src/plan/passes.inc define them and shaders/tables.sh writes them to push/NAME.h. All together
 * need at most 128 bytes, the smallest allowed maxPushConstantsSize. */
#ifndef MASU_SHARED_PUSH_H
#define MASU_SHARED_PUSH_H

#include "shared/types.h"

struct masu_push {
    masu_uint render_width; /* valid sub-rectangle of the input images, texels from (0,0) */
    masu_uint render_height;
    masu_uint output_width; /* sub-rectangle that the pass writes, texels from (0,0) */
    masu_uint output_height;
    masu_uint output_steps; /* quantisation steps of the target, 10 bits each of red, green and
                               blue; 0: not quantised. For passes that write the target */
    masu_uint output_flags; /* MASU_OUTPUT_* of the last pass of a rung; 0 for other passes */
};

#endif
