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

/* Whether the eye sees the face that n, of any length, does not stand on. rel: relative to the eye. */
bool masu_seen_from_below(vec3 n, vec3 rel)
{
    vec3 across = cross(dFdx(rel), dFdy(rel));
    return (dot(n, across) > 0.0) != (dot(across, rel) < 0.0);
}

/* n, unit, leaned towards the eye until it is edge-on at most; not renormalised. */
vec3 masu_lean_to_eye(vec3 n, vec3 rel)
{
    return n - rel * (max(dot(n, rel), 0.0) / max(dot(rel, rel), masu_tiny));
}

#endif
