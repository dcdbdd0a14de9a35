/*
 * skin.comp: vertex skinning: positions and normals of skinned meshes, as drawn
 * (shaders/shared/skinning.glsl).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/pack.glsl"
#include "shared/skinning.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKINNED, std430) writeonly buffer Skinned
{
    uvec4 skinned[];
};

/* Transforms a normal by the cofactor matrix, as in polygons.glsl; `rest` if the result is 0. */
vec3 turned(masu_bent bent, vec3 rest)
{
    vec3 c0 = cross(bent.row1.xyz, bent.row2.xyz);
    vec3 c1 = cross(bent.row2.xyz, bent.row0.xyz);
    vec3 c2 = cross(bent.row0.xyz, bent.row1.xyz);
    vec3 n = vec3(dot(c0, rest), dot(c1, rest), dot(c2, rest));
    n = dot(bent.row0.xyz, c0) < 0.0 ? -n : n;
    float size = max(abs(n.x), max(abs(n.y), abs(n.z)));
    return size > masu_tiny ? n * masu_rcp(size) : rest;
}

void main()
{
    uint rest, vertex, matrices;
    if (!masu_find_vertex(0u, rest, vertex, matrices)) return;
    masu_bent bent = masu_bend(0u, rest, matrices);
    vec3 normal = turned(bent, bent.rest_normal);
    skinned[vertex] =
        uvec4(floatBitsToUint(bent.position), packSnorm2x16(masu_oct_encode(normal)));
}
