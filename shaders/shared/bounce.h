/* bounce.h: the live probes that trace rays in a frame (src/frame/bounce.c), and those rays. */
#ifndef MASU_SHARED_BOUNCE_H
#define MASU_SHARED_BOUNCE_H

#include "shared/types.h"

#define MASU_BOUNCE_BURST 4u      /* times as many probes in the first rounds */
#define MASU_BOUNCE_SETS 16u     /* sets of rays whose mean a probe shows */
#define MASU_BOUNCE_RAYS_MAX 64u  /* of a set: a workgroup sums them */
#define MASU_BOUNCE_RAY_BYTES 32u /* see shaders/bounce/ray.glsl */
#define MASU_BOUNCE_EMISSION 64.0 /* most radiance that a ray takes from an emissive surface */

/* Head of the buffer: the groups of both indirect dispatches, over rays and over probes; their w:
 * the number of rays, and the number of rays per probe. Then a 32-bit value per probe: its number;
 * from bit 20 on its present set; from bit 24 on the number of valid sets, including this one. */
struct masu_bounce_header {
    masu_uvec4 rays;
    masu_uvec4 probes;
};
#define MASU_BOUNCE_PROBE 0xFFFFFu
#define MASU_BOUNCE_SET_SHIFT 20u
#define MASU_BOUNCE_COUNT_SHIFT 24u

#endif
