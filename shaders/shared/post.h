/* post.h: the buffer of the effects on the image (masu_post), one per frame in flight. */
#ifndef MASU_SHARED_POST_H
#define MASU_SHARED_POST_H

#include "shared/types.h"

/* Largest radius of the circle of confusion, of the image height. */
#define MASU_FOCUS_MOST 0.02
#define MASU_LUT_POINTS 33 /* MASU_LUT_MAX */

/* Followed by the colour table: size^3 values of 10 bits per channel, red in the lowest bits. */
struct masu_post_uniforms {
    /* x fraction of scattered light. The signed radius of the circle of confusion is y - z * depth,
     * of the image height, with the depth as stored; below 0 in front of the sharp plane. y 0: no
     * depth of field. w 1: some member of `grade` is not neutral */
    masu_vec4 lens;
    masu_vec4 grade; /* x vignette; y factor of linear light; z 1 / gamma; w table size, 0: none */
};

#endif
