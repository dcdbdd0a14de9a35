/* reflect.h: specular_trace_sdf.comp of a baked scene by itself: rays that the test has made, and what
 * they meet. Everything that the pass reads of a frame is given here, so that rays can begin anywhere and hold
 * any bits, and be compared one by one with the truth, which a picture does not allow. */
#ifndef MASU_TEST_SUPPORT_REFLECT_H
#define MASU_TEST_SUPPORT_REFLECT_H

#include "shared/masu_shared.h"

#include <stddef.h>
#include <stdint.h>

typedef struct reflect_job {
    const uint32_t *spirv;
    size_t words;
    struct masu_frame_uniforms frame; /* previous is the same */
    const float *slots; /* of the present; where the code knows motion, then those of the previous frame */
    size_t slot_count;
    uint32_t width, height;     /* traced texels, multiples of MASU_GROUP */
    const uint32_t *guide;      /* width * height * 2 */
    const uint32_t *ray;        /* the same */
    uint32_t *hit;              /* width * height * 4: before, and afterwards */
    uint32_t steps;
    uint64_t evals, sdf_hits, unconverged; /* out */
} reflect_job;

/* Under the validation layer; fails the test on any error or message. The render size is twice the texels'. */
void reflect_run(reflect_job *job);

#endif
