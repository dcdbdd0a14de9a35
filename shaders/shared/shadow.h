/* shadow.h: the sun's cascaded shadow map. */
#ifndef MASU_SHARED_SHADOW_H
#define MASU_SHARED_SHADOW_H

#include "shared/types.h"

#define MASU_CASCADES_MAX 4
/* Fraction of a cascade's half width over which it blends into the next. */
#define MASU_CASCADE_BLEND 0.1
/* Slope-scaled depth bias, in texels per texel of slope against the sun, and the largest slope. */
#define MASU_SHADOW_BIAS 1.25
#define MASU_SHADOW_STEEPEST 4.0

/* Array elements: cascades as they were rendered, possibly some frames ago. A cascade is an
 * orthographic box along the sun's direction. A point p has the coordinates row.xyz . (p - origin),
 * x and y in -1..1, and the depth row2.xyz . (p - origin) + rect.w: 1 nearest to the sun, 0
 * farthest. The w of a row serves positions relative to the current camera: row.xyz . rel +
 * row.w. */
struct masu_shadow_uniforms {
    masu_vec4 row0[MASU_CASCADES_MAX];
    masu_vec4 row1[MASU_CASCADES_MAX];
    masu_vec4 row2[MASU_CASCADES_MAX];      /* w includes rect.w */
    masu_vec4 origin_hi[MASU_CASCADES_MAX]; /* xyz origin, rounded to float; w texel width, m */
    masu_vec4 origin_lo[MASU_CASCADES_MAX]; /* xyz origin - origin_hi; w depth per metre */
    masu_vec4 rect[MASU_CASCADES_MAX]; /* xy first texel; z texels per edge; w origin depth */
    masu_vec4 reach; /* x cascades; y view depth where they start to fade, z 1 / fade distance; w
                        not 0: the occlusion image holds the sun's visibility through the SDF */
};

#endif
