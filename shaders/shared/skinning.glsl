/*
 * skinning.glsl: a rest vertex, bent by its joints. A dispatch has an invocation for each vertex of
 * the largest skin in x and a skin in y. Matrices are blended first, then applied: the same as the
 * mean of where each puts the vertex, for fewer operations, and the normal goes by the same matrix.
 *
 *   joints         of each skin its first rest vertex, its first vertex, how many (0: it is
 *                  hidden), where its matrices begin; its first node in the trees for rays, how
 *                  many, its first of boxes, where its morph targets begin (0: it has none); then
 *                  the matrices, three rows each; then, of each skin, how many targets have a
 *                  weight, and of each of these its first delta and the weight
 *   skin_vertices  two elements a vertex: position and normal as any vertex; joints and weights, 16
 *                  bits each; then deltas of morph targets, one element each: position, and the
 *                  normal in 11, 11 and 10 bits
 *
 * Positions are precise: the pass of now and that of the previous frame get the same bits of the
 * same joints, and what stood still a velocity of exactly 0.
 */
#ifndef MASU_SKINNING_GLSL
#define MASU_SKINNING_GLSL

#include "shared/types.h"
#include "shared/trace.h"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKIN_VERTICES, std430)
    readonly buffer SkinVertices
{
    uvec4 skin_vertices[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_JOINTS, std430) readonly buffer Joints
{
    uvec4 joints[];
};

layout(constant_id = 20) const bool masu_morphs = false; /* skins have morph targets */

struct masu_bent {
    vec4 row0, row1, row2; /* of the blended matrix */
    vec3 position;
    vec3 rest_normal; /* of any length where targets have changed it */
};

vec3 masu_morph_normal(uint packed)
{
    ivec3 n = ivec3(int(packed << 21), int(packed << 10), int(packed)) >> ivec3(21, 21, 22);
    return vec3(n) * vec3(2.0 / 1023.0, 2.0 / 1023.0, 2.0 / 511.0);
}

/* Adds the targets of a skin to a rest vertex. first: of the moment's elements in `joints`. */
void masu_morph(uint first, inout vec3 position, inout vec3 normal)
{
    uint at = joints[first + 2u * gl_WorkGroupID.y + 1u].w;
    if (at == 0u) {
        return;
    }
    uint count = joints[first + at].x;
    for (uint i = 0u; i < uint(MASU_MORPH_TARGETS); i++) {
        if (i >= count) {
            break;
        }
        uvec4 target = joints[first + at + 1u + i];
        uvec4 delta = skin_vertices[target.x + gl_GlobalInvocationID.x];
        float weight = uintBitsToFloat(target.y);
        precise vec3 moved = position + weight * uintBitsToFloat(delta.xyz);
        position = moved;
        normal += weight * masu_morph_normal(delta.w);
    }
}

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

masu_bent masu_bend(uint first, uint rest, uint matrices)
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
    vec3 at = uintBitsToFloat(own.xyz);
    bent.rest_normal = masu_oct_decode(unpackSnorm2x16(own.w));
    if (masu_morphs) {
        masu_morph(first, at, bent.rest_normal);
    }
    vec4 p = vec4(at, 1.0);
    precise vec3 moved = vec3(dot(bent.row0, p), dot(bent.row1, p), dot(bent.row2, p));
    bent.position = moved;
    return bent;
}

#endif
