/* reflect.h: runs specular_trace_sdf.comp of a baked scene with rays made by the test, and returns
 * their hits. All inputs that the pass reads from a frame are given here. So rays can start
 * anywhere and hold any bits, and each is compared with a reference, which is not possible in an
 * image. */
#ifndef MASU_TEST_SUPPORT_REFLECT_H
#define MASU_TEST_SUPPORT_REFLECT_H

#include "shared/masu_shared.h"

#include <stddef.h>
#include <stdint.h>

typedef struct reflect_job {
    const uint32_t *spirv;
    size_t words;
    struct masu_frame_uniforms frame; /* the previous frame has the same */
    const float *slots; /* this frame's; if the code supports motion, followed by those of the
                           previous frame */
    size_t slot_count;
    uint32_t width, height;     /* traced texels, multiples of MASU_GROUP */
    const uint32_t *guide;      /* width * height * 2 */
    const uint32_t *ray;        /* the same */
    uint32_t *hit;              /* width * height * 4: before and after the run */
    uint32_t steps;
    uint64_t evals, sdf_hits, unconverged; /* results */
} reflect_job;

/* Runs under the validation layer and fails the test on any error or message. The render size is
 * twice the size in texels. */
void reflect_run(reflect_job *job);

#endif
