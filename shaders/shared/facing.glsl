/*
 * facing.glsl: the side of a triangle that faces the camera, and shading normals that agree. For
 * fragment shaders: it takes derivatives, so call it before any discard.
 *
 * The triangle decides, not its shading normal. Near the silhouette of a coarse mesh, normals of
 * triangles that face the camera lean away from it; flipped, they would be lit from behind and show
 * a dark rim. The vertex order does not decide either: in many models it is arbitrary.
 */
#ifndef MASU_FACING_GLSL
#define MASU_FACING_GLSL

#include "shared/guard.glsl"

/* Whether the camera sees the back face for n, unit. rel: relative to the camera. Only if n leans
 * away, too: for an almost edge-on triangle the derivatives are unreliable, and its normal needs no
 * flip. */
bool masu_seen_from_below(vec3 n, vec3 rel)
{
    vec3 across = cross(dFdx(rel), dFdy(rel));
    return dot(n, rel) > 0.0 && (dot(n, across) > 0.0) != (dot(across, rel) < 0.0);
}

/* Leans n, unit, towards the camera until its cosine is `least`, for any rel; not renormalised. */
vec3 masu_lean_to_eye(vec3 n, vec3 rel, float least)
{
    float per_length = masu_rsqrt(dot(rel, rel));
    return n - rel * (per_length * max(least + dot(n, rel) * per_length, 0.0));
}

#endif
