/*
 * skin_trace.comp: refits the BVHs of skinned meshes, which were built for the rest pose, to the
 * current vertices: boxes of triangles, then of their nodes. A workgroup refits one tree, with a
 * sweep over its nodes for each level: a sweep refits every node whose children were refitted in an
 * earlier one. Bounded: a tree has at most MASU_TRACE_LEVELS_MAX levels, and the sweep that refits
 * the root is the last.
 *
 * Quantised boxes contain their content, like those of src/scene/trace_tree.c: positions are
 * rounded outwards by more than the error of the differences here. The margin of bvh.glsl covers
 * its own rounding.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/trace.h"

layout(local_size_x = 64) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE, std430) buffer Static
{
    uvec4 masu_trace_static[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKINNED, std430) readonly buffer Skinned
{
    uvec4 skinned[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_JOINTS, std430) readonly buffer Joints
{
    uvec4 joints[];
};

/* Two elements per node: low, and the sweep that has refitted it, 0: none; high. */
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SKIN_TREES, std430) coherent buffer Boxes
{
    uvec4 boxes[];
};

struct masu_box {
    vec3 low, high;
};

const float masu_reach = 1e15; /* MASU_TRACE_REACH */

void add(inout masu_box box, masu_box other)
{
    box.low = min(box.low, other.low);
    box.high = max(box.high, other.high);
}

masu_box nothing()
{
    return masu_box(vec3(masu_reach), vec3(-masu_reach));
}

masu_box triangle(uint at)
{
    uvec4 t = masu_trace_static[at];
    vec3 a = uintBitsToFloat(skinned[t.x].xyz), b = uintBitsToFloat(skinned[t.y].xyz);
    vec3 c = uintBitsToFloat(skinned[t.z].xyz);
    vec3 low = min(a, min(b, c)), high = max(a, max(b, c));
    return masu_box(clamp(low, vec3(-masu_reach), vec3(masu_reach)),
                    clamp(high, vec3(-masu_reach), vec3(masu_reach)));
}

/* Exponents of the smallest powers of two of which 254 cover the extents. */
uvec3 exponents_of(vec3 extent)
{
    uvec3 bits = floatBitsToUint(extent * (1.0 / 254.0));
    uvec3 e = (bits >> 23) + uvec3(1u);
    return clamp(e, uvec3(1u), uvec3(170u));
}

/* The boxes of four children. They are rotated: a variable index would put an array into memory. */
struct masu_boxes {
    masu_box first, second, third, last;
};

void rotate(inout masu_boxes of, masu_box box)
{
    of.first = of.second;
    of.second = of.third;
    of.third = of.last;
    of.last = box;
}

uint type_of(uint types, uint child)
{
    return types >> (24u + 2u * child) & 3u;
}

/* Boxes of the children, as bytes; inverted where there is no child. */
void quantise(masu_boxes of, masu_box all, inout uvec4 a, out uvec4 b, inout uvec4 c)
{
    uvec3 e = exponents_of(all.high - all.low);
    vec3 scale = uintBitsToFloat(e << 23);
    uvec3 lows = uvec3(0u), highs = uvec3(0u);
    for (uint i = 0u; i < 4u; i++) {
        vec3 low = vec3(255.0), high = vec3(0.0);
        if (type_of(a.w, i) != 0u) {
            low = clamp(floor((of.first.low - all.low) / scale - 0.001), vec3(0.0), vec3(255.0));
            high = clamp(ceil((of.first.high - all.low) / scale + 0.001), vec3(0.0), vec3(255.0));
        }
        rotate(of, all);
        lows = lows >> 8 | uvec3(low) << 24;
        highs = highs >> 8 | uvec3(high) << 24;
    }
    a = uvec4(floatBitsToUint(all.low), (a.w & 0xFF000000u) | e.x | e.y << 8 | e.z << 16);
    b = uvec4(lows, highs.x);
    c = uvec4(highs.yz, c.zw);
}

/* Refits a node if all its children that are nodes have been refitted before this sweep. */
void fit(uint node, uint first, uint first_box, uint sweep)
{
    uint at = 1u + uint(MASU_TRACE_NODE_UVEC4) * node, own = 2u * (first_box + node - first);
    if (boxes[own].w != 0u) return;
    uvec4 a = masu_trace_static[at], b, c = masu_trace_static[at + 2u];
    uint child = 2u * (first_box + c.z - first), item = masu_trace_static[0].x + c.w;
    masu_box all = nothing();
    masu_boxes of = masu_boxes(all, all, all, all);
    bool ready = true;
    for (uint i = 0u; i < 4u; i++) {
        uint type = type_of(a.w, i);
        masu_box box = nothing();
        if (type == 1u) {
            uvec4 low = boxes[child], high = boxes[child + 1u];
            ready = ready && low.w != 0u && low.w < sweep;
            box = masu_box(uintBitsToFloat(low.xyz), uintBitsToFloat(high.xyz));
            child += 2u;
        } else if (type != 0u) {
            box = triangle(item++);
            if (type == 3u) add(box, triangle(item++));
        }
        add(all, box);
        rotate(of, box);
    }
    if (!ready) return;
    quantise(of, all, a, b, c);
    masu_trace_static[at] = a;
    masu_trace_static[at + 1u] = b;
    masu_trace_static[at + 2u] = c;
    boxes[own + 1u] = uvec4(floatBitsToUint(all.high), 0u);
    boxes[own] = uvec4(floatBitsToUint(all.low), sweep);
}

void main()
{
    uvec4 tree = joints[2u * gl_WorkGroupID.x + 1u];
    uint first = tree.x, count = tree.y, first_box = tree.z;
    for (uint round = 0u; round < uint(MASU_SKIN_ROUNDS); round++) {
        uint k = 64u * round + gl_LocalInvocationID.x;
        if (k >= count) break;
        boxes[2u * (first_box + k)] = uvec4(0u);
    }
    for (uint sweep = 1u; sweep <= uint(MASU_TRACE_LEVELS_MAX); sweep++) {
        memoryBarrierBuffer();
        barrier();
        if (count == 0u || boxes[2u * first_box].w != 0u) break;
        memoryBarrierBuffer();
        barrier();
        for (uint round = 0u; round < uint(MASU_SKIN_ROUNDS); round++) {
            uint k = 64u * round + gl_LocalInvocationID.x;
            if (k >= count) break;
            fit(first + k, first, first_box, sweep);
        }
    }
}
