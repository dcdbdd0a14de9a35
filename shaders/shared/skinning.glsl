/*
 * skinning.glsl: a rest vertex, bent by its joints. A dispatch has an invocation for each vertex of the largest
 * skin in x and a skin in y. Matrices are blended first, then applied: the same as the mean of where each puts
 * the vertex, for fewer operations, and the normal goes by the same matrix.
 *
 *   joints         of each skin its first rest vertex, its first vertex, how many (0: it is hidden), where its
 *                  matrices begin; its first node in the trees for rays, how many, its first of boxes, 0; then
 *                  the matrices, three rows each
 *   skin_vertices  two elements a vertex: position and normal as any vertex; joints and weights, 16 bits each
 *
 * Positions are precise: the pass of now and that of the previous frame get the same bits of the same joints, and
 * what stood still a velocity of exactly 0.
 */
#ifndef MASU_SKINNING_GLSL
#define MASU_SKINNING_GLSL

#include "shared/types.h"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKIN_VERTICES, std430) readonly buffer SkinVertices
{
    uvec4 skin_vertices[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_JOINTS, std430) readonly buffer Joints
{
    uvec4 joints[];
};

struct masu_bent {
    vec4 row0, row1, row2; /* of the blended matrix */
    vec3 position;
    vec2 rest_normal; /* octahedral */
};

/* first: of the moment's elements in `joints`. False: no such vertex. */
bool masu_find_vertex(uint first, out uint rest, out uint vertex, out uint matrices)
{
    uvec4 skin = joints[first + 2u * gl_WorkGroupID.y];
    uint k = gl_GlobalInvocationID.x;
    rest = skin.x + k;
    vertex = skin.y + k;
    matrices = first + skin.w;
    return k < skin.z;
}

void masu_add_joint(uint at, float weight, inout vec4 row0, inout vec4 row1, inout vec4 row2)
{
    precise vec4 a = row0 + weight * uintBitsToFloat(joints[at]);
    precise vec4 b = row1 + weight * uintBitsToFloat(joints[at + 1u]);
    precise vec4 c = row2 + weight * uintBitsToFloat(joints[at + 2u]);
    row0 = a;
    row1 = b;
    row2 = c;
}

masu_bent masu_bend(uint rest, uint matrices)
{
    uvec4 own = skin_vertices[2u * rest];
    uvec4 by = skin_vertices[2u * rest + 1u];
    masu_bent bent;
    bent.row0 = bent.row1 = bent.row2 = vec4(0.0);
    for (uint i = 0u; i < 4u; i++) {
        uint pair = i < 2u ? by.x : by.y, weights = i < 2u ? by.z : by.w;
        uint joint = (i & 1u) == 0u ? pair & 0xFFFFu : pair >> 16;
        uint weight = (i & 1u) == 0u ? weights & 0xFFFFu : weights >> 16;
        if (weight == 0u) continue;
        masu_add_joint(matrices + 3u * joint, float(weight) / 65535.0, bent.row0, bent.row1,
                       bent.row2);
    }
    vec4 p = vec4(uintBitsToFloat(own.xyz), 1.0);
    precise vec3 moved = vec3(dot(bent.row0, p), dot(bent.row1, p), dot(bent.row2, p));
    bent.position = moved;
    bent.rest_normal = unpackSnorm2x16(own.w);
    return bent;
}

#endif
