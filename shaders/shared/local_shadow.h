/* local_shadow.h: the shadow faces of punctual lights that a frame renders. */
#ifndef MASU_SHARED_LOCAL_SHADOW_H
#define MASU_SHARED_LOCAL_SHADOW_H

#include "shared/types.h"

#define MASU_LOCAL_FACES_MAX 16
#define MASU_LOCAL_TILE_LEAST 128u
#define MASU_LOCAL_TILE_MOST 512u

/* Array elements: the faces, each with a square of LOCAL_SHADOW_FACES in whose upper left corner it
 * is rendered. A point p has the coordinates (row0 . d, row1 . d) / z, where d = p - origin and
 * z = row2 . d, and the depth near / z: 1 at the near distance, 0 infinitely far.
 *
 *   row0       xyz unit axis; w from coordinates to the square's -1..1
 *   row1       xyz unit axis; w centre of the face there
 *   row2       xyz unit axis; w near distance, m
 *   origin_hi  xyz light, rounded to float; w texel width at distance 1
 *   origin_lo  xyz light - origin_hi; w largest depth along row2, m
 *   tile       xy first texel in the atlas; z texels per edge, 0: none; w 1: the SDF reaches it,
 *              2: and is marched
 *   groups     xyz workgroups of local_shadow_sdf
 *   square     x texels per edge of a square, y squares side by side, z of the atlas, w faces */
struct masu_local_face_uniforms {
    masu_vec4 row0[MASU_LOCAL_FACES_MAX];
    masu_vec4 row1[MASU_LOCAL_FACES_MAX];
    masu_vec4 row2[MASU_LOCAL_FACES_MAX];
    masu_vec4 origin_hi[MASU_LOCAL_FACES_MAX];
    masu_vec4 origin_lo[MASU_LOCAL_FACES_MAX];
    masu_uvec4 tile[MASU_LOCAL_FACES_MAX];
    masu_uvec4 groups;
    masu_uvec4 square;
};

#endif
