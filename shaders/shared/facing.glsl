/*
 * facing.glsl: which side of a triangle the eye is on, and shading normals that agree with it. For fragment shaders: it
 * takes derivatives, so it comes before any discard.
 *
 * The triangle decides, not its shading normal. Near the silhouette of a coarse mesh the normals of triangles that face the eye
 * lean away from it; turned around they would be lit from behind, and a dark rim would stand there. Nor does the order of its
 * vertices decide: many models have it anyhow.
 */
#ifndef MASU_FACING_GLSL
#define MASU_FACING_GLSL

#include "shared/guard.glsl"

/* Whether the eye sees the face that n, unit, does not stand on. rel: relative to the eye. Only where n leans away, too: of a
 * triangle that is all but edge-on the derivatives say little, and its normal need not be turned. */
bool masu_seen_from_below(vec3 n, vec3 rel)
{
    vec3 across = cross(dFdx(rel), dFdy(rel));
    return dot(n, rel) > 0.0 && (dot(n, across) > 0.0) != (dot(across, rel) < 0.0);
}

/* n, unit, leaned towards the eye until its cosine is `least`, whatever rel; not renormalised. */
vec3 masu_lean_to_eye(vec3 n, vec3 rel, float least)
{
    float per_length = masu_rsqrt(dot(rel, rel));
    return n - rel * (per_length * max(least + dot(n, rel) * per_length, 0.0));
}

#endif
