/*
 * bvh.glsl: rays against the triangles of a scene: the tree over the instances of a frame, then the
 * trees over the triangles of their meshes (src/scene/blob.h, src/scene/trace.h). The includer
 *   declares, each of uvec4, masu_trace_static[]     header, nodes and triangles as baked
 *   masu_trace_frame[]      header, nodes and records of this frame
 *   masu_trace_vertices[]   the vertices of the blob
 *   MASU_TRACE_LANES        how many invocations its group has
 * and may define
 *   MASU_TRACE_OPAQUE(triangle, instance, barycentrics, d) false: the ray passes through
 *   MASU_TRACE_COUNTERS                                    counts visited nodes and triangles
 *
 * Rays are in world space minus the anchor. Directions need not have unit length; t is in their
 * unit. A ray that is not finite, has no direction, or begins farther than 1e15 out hits nothing. A
 * ray that would visit more than MASU_TRACE_VISITS nodes sets masu_trace_exceeded, and hits
 * nothing.
 *
 * BOXES. Near and far planes are chosen by the signs of the direction, so that no min or max has an
 * operand 0 Inf (Ize 2013, Robust BVH Ray Traversal); the smallest components of a direction are
 * raised to 1e-12 of its largest. The distance to a plane is (origin - o) / d + q scale / d with a
 * q of 0 to 255: both terms may be large with a small sum, so a relative margin on the sum, as in
 * that paper, would not be enough. The margin here is relative to the terms, which bounds the total
 * rounding.
 *
 * TRIANGLES. Watertight, Woop, Benthin and Wald 2013: vertices are sheared so that the ray is the z
 * axis, and edge functions have signs. An edge function is a difference of two rounded products,
 * and rounding is monotone: its sign is right or it is 0, and the triangle on the other side of the
 * edge gets the same number with the other sign. 0 is inside. So no ray passes between triangles
 * that share vertices, and the paper's second attempt in double is unnecessary. `precise` keeps a
 * fused multiply-add from rounding just one of the products.
 *
 * LOOPS. The cost is in loads: a software driver loads each value for each lane. So a node is 12
 * uints, its remaining children are one uint of the stack, and the tree over instances has a
 * separate loop around the loop of a mesh: in a shared loop each step would load from both buffers.
 */
#ifndef MASU_TRACE_BVH_GLSL
#define MASU_TRACE_BVH_GLSL
#extension GL_EXT_shader_integer_mix : require /* part of GLSL only from version 450 on */

#include "shared/guard.glsl"
#include "shared/trace.h"

#ifndef MASU_TRACE_OPAQUE
#define MASU_TRACE_OPAQUE(triangle, instance, barycentrics, d) true
#endif

struct masu_ray_hit {
    float t;            /* negative: a miss, and the other members are undefined */
    uint triangle;      /* index into TRACE_TRIANGLES */
    uint instance;      /* index into TRACE_INSTANCES */
    uint record;        /* index of the frame's records, for masu_trace_record_row */
    vec2 barycentrics;  /* weights of the second and third vertex */
};

/* Whether any ray of this invocation was aborted. */
bool masu_trace_exceeded = false;
#ifdef MASU_TRACE_COUNTERS
uint masu_trace_nodes_seen = 0u;
uint masu_trace_triangles_seen = 0u;
#endif

const float masu_trace_reach = 1e15;
const float masu_trace_flat = 1e-12;
const float masu_trace_margin = 1e-6; /* 8 roundings, and a division with an error of 2.5 units */

/* Remaining children of nodes, one uint per node: their first << 8, their count << 6, their order,
 * 2 bits each. In shared memory, one uint per level of the scene's trees and invocation
 * (src/device/pipelines.c): a private array would be in memory on every GPU tested, with 2 KB for
 * each lane on Intel's. */
layout(constant_id = 9) const int masu_trace_levels = MASU_TRACE_STACK;
shared uint masu_trace_stack[masu_trace_levels * MASU_TRACE_LANES];

uint masu_trace_slot(int depth)
{
    return uint(depth) * uint(MASU_TRACE_LANES) + gl_LocalInvocationIndex;
}

struct masu_trace_ray {
    vec3 origin;
    vec3 inverse;  /* 1 / the components of the direction */
    bvec3 forward; /* their signs */
};

masu_trace_ray masu_trace_prepare(vec3 origin, vec3 direction)
{
    float least = max(abs(direction.x), max(abs(direction.y), abs(direction.z))) * masu_trace_flat;
    vec3 sides = mix(vec3(least), vec3(-least), lessThan(direction, vec3(0.0)));
    vec3 d = mix(direction, sides, lessThan(abs(direction), vec3(least)));
    return masu_trace_ray(origin, 1.0 / d, greaterThan(d, vec3(0.0)));
}

vec4 masu_trace_bytes(uint word)
{
    return vec4(ivec4(uvec4(word, word >> 8, word >> 16, word >> 24) & 255u));
}

uvec4 masu_trace_sort(uvec4 k)
{
    uvec4 a = uvec4(min(k.x, k.y), max(k.x, k.y), min(k.z, k.w), max(k.z, k.w));
    uvec4 b = uvec4(min(a.x, a.z), min(a.y, a.w), max(a.x, a.z), max(a.y, a.w));
    return uvec4(b.x, min(b.y, b.z), max(b.y, b.z), b.w);
}

/* Entry distances of the boxes of the four children, as the bits of floats; hit or miss, and types
 * of the children. t_min is not negative, so integers can be used: the bits of positive floats sort
 * like the floats, any negative one is below them, and the choice between two negative ones does
 * not matter. A NaN input is above or below all; either way the result is defined, unlike
 * min(float). A software driver has one instruction for it instead of three. */
void masu_trace_boxes(uvec4 a, uvec4 b, uvec4 c, masu_trace_ray ray, float t_min, float t_max,
                      out ivec4 enter, out bvec4 hit, out uvec4 types)
{
    uvec3 exponents = uvec3(a.w << 23, a.w << 15, a.w << 7) & 0x7F800000u;
    vec3 scale = uintBitsToFloat(exponents) * ray.inverse;
    vec3 base = (uintBitsToFloat(a.xyz) - ray.origin) * ray.inverse;
    vec3 margin = (abs(base) + 255.0 * abs(scale)) * masu_trace_margin;
    vec3 first = base - margin, last = base + margin;
    uvec3 low = b.xyz, high = uvec3(b.w, c.xy);
    uvec3 front = mix(high, low, ray.forward), back = mix(low, high, ray.forward);
    /* Axis by axis: all six planes of four boxes would take 24 registers. */
    enter = max(floatBitsToInt(masu_trace_bytes(front.x) * scale.x + first.x),
                ivec4(floatBitsToInt(t_min)));
    ivec4 leave = min(floatBitsToInt(masu_trace_bytes(back.x) * scale.x + last.x),
                      ivec4(floatBitsToInt(t_max)));
    enter = max(enter, floatBitsToInt(masu_trace_bytes(front.y) * scale.y + first.y));
    leave = min(leave, floatBitsToInt(masu_trace_bytes(back.y) * scale.y + last.y));
    enter = max(enter, floatBitsToInt(masu_trace_bytes(front.z) * scale.z + first.z));
    leave = min(leave, floatBitsToInt(masu_trace_bytes(back.z) * scale.z + last.z));
    hit = lessThanEqual(enter, leave);
    types = (uvec4(a.w) >> uvec4(24u, 26u, 28u, 30u)) & 3u;
}

/* The wanted children, sorted by distance. */
uvec4 masu_trace_order(ivec4 enter, bvec4 wanted)
{
    uvec4 keys = (uvec4(enter) & ~3u) | uvec4(0u, 1u, 2u, 3u);
    return masu_trace_sort(mix(uvec4(0xFFFFFFFFu), keys, wanted));
}

uint masu_trace_count(bvec4 b)
{
    uvec4 n = uvec4(b);
    return n.x + n.y + n.z + n.w;
}

bvec4 masu_trace_both(bvec4 a, bvec4 b)
{
    return bvec4(a.x && b.x, a.y && b.y, a.z && b.z, a.w && b.w);
}

/* Selects the next node: the first of `hits` children in this order, else the most recent remaining
 * child. If there is none, `going` becomes false. */
void masu_trace_next(uint child, uint hits, uvec4 order, int bottom, inout uint node,
                     inout uint rest, inout int depth, inout bool going)
{
    uint left = (rest >> 6) & 3u;
    bool pop = hits == 0u;
    going = !pop || left > 0u;
    if (hits > 1u) {
        if (left > 0u && depth < masu_trace_levels)
            masu_trace_stack[masu_trace_slot(depth++)] = rest;
        rest = child << 8 | (hits - 1u) << 6;
        rest |= (order.y & 3u) | (order.z & 3u) << 2 | (order.w & 3u) << 4;
    }
    node = pop ? (rest >> 8) + (rest & 3u) : child + (order.x & 3u);
    if (pop) {
        if (left > 1u)
            rest = (rest & ~255u) | (left - 1u) << 6 | ((rest >> 2) & 15u);
        else
            rest = depth > bottom ? masu_trace_stack[masu_trace_slot(--depth)] : 0u;
    }
}

struct masu_trace_shear {
    vec3 shear; /* xy: of the direction divided by its largest component; z: 1 / that component */
    bvec2 axis; /* the largest is x, y; else z */
};

masu_trace_shear masu_trace_shear_of(vec3 d)
{
    vec3 size = abs(d);
    bvec2 axis = bvec2(size.x >= size.y && size.x >= size.z, size.y >= size.z);
    vec3 turned = axis.x ? d.yzx : axis.y ? d.zxy : d;
    return masu_trace_shear(vec3(turned.xy, 1.0) / turned.z, axis);
}

vec3 masu_trace_corner(uint vertex, vec3 origin, masu_trace_shear s)
{
    precise vec3 p = uintBitsToFloat(masu_trace_vertices[vertex].xyz) - origin;
    precise vec3 v = s.axis.x ? p.yzx : s.axis.y ? p.zxy : p;
    precise vec2 sheared = v.xy - s.shear.xy * v.z;
    return vec3(sheared, v.z * s.shear.z);
}

/* Distance and weights of the second and third corner; x is negative for a miss. */
vec3 masu_trace_triangle(uvec3 vertices, vec3 origin, masu_trace_shear s, float t_min, float t_max)
{
    vec3 a = masu_trace_corner(vertices.x, origin, s);
    vec3 b = masu_trace_corner(vertices.y, origin, s);
    vec3 c = masu_trace_corner(vertices.z, origin, s);
    precise float u = c.x * b.y - c.y * b.x;
    precise float v = a.x * c.y - a.y * c.x;
    precise float w = b.x * a.y - b.y * a.x;
    float sum = u + v + w;
    bool left = u >= 0.0 && v >= 0.0 && w >= 0.0, right = u <= 0.0 && v <= 0.0 && w <= 0.0;
    bool inside = (left || right) && abs(sum) > 0.0;
    float inverse = 1.0 / (inside ? sum : 1.0);
    float t = (u * a.z + v * b.z + w * c.z) * inverse;
    inside = inside && t >= t_min && t < t_max;
    return vec3(inside ? t : -1.0, v * inverse, w * inverse);
}

vec4 masu_trace_record_row(uint record, uint row)
{
    return uintBitsToFloat(
        masu_trace_frame[masu_trace_frame[0].x + record * uint(MASU_TRACE_RECORD_UVEC4) + row]);
}

/* Transforms a normal of an instance to world space; not of unit length. */
vec3 masu_trace_normal(uint record, vec3 normal)
{
    return masu_trace_record_row(record, 0u).xyz * normal.x +
           masu_trace_record_row(record, 1u).xyz * normal.y +
           masu_trace_record_row(record, 2u).xyz * normal.z;
}

masu_ray_hit masu_trace_walk(vec3 origin, vec3 direction, float t_min, float t_max,
                             bool any_will_do)
{
    masu_ray_hit best = masu_ray_hit(-1.0, 0u, 0u, 0u, vec2(0.0));
    float most = max(abs(direction.x), max(abs(direction.y), abs(direction.z)));
    float distant = max(abs(origin.x), max(abs(origin.y), abs(origin.z)));
    float start = abs(max(masu_finite(t_min) ? t_min : 0.0, 0.0)); /* no -0 */
    float far = masu_sane(t_max, 0.0, masu_huge);
    bool top_going = masu_finite(origin) && masu_finite(direction) && distant <= masu_trace_reach &&
                     most >= 1e-6 && most <= 1e6 && start < far && masu_trace_frame[0].y > 0u;
    if (!top_going) return best;

    uint top_node = 0u, top_rest = 0u, visits = 0u, records = masu_trace_frame[0].x;
    uint triangles = masu_trace_static[0].x;
    uint waiting = 0u; /* pending instances of a node: packed as in masu_trace_stack */
    uint waiting_item = 0u;
    int depth = 0;
    for (int i = 0; i < MASU_TRACE_VISITS; i++) {
        /* Recomputed each time: kept, it would take registers from the mesh loop. */
        masu_trace_ray world = masu_trace_prepare(origin, direction);
        for (int k = 0; k < MASU_TRACE_VISITS; k++) {
            if (waiting != 0u || !top_going || visits >= uint(MASU_TRACE_VISITS)) break;
            uint at = 1u + top_node * uint(MASU_TRACE_NODE_UVEC4);
            uvec4 a = masu_trace_frame[at], b = masu_trace_frame[at + 1u];
            uvec4 c = masu_trace_frame[at + 2u];
            ivec4 enter;
            bvec4 hit;
            uvec4 types;
            masu_trace_boxes(a, b, c, world, start, far, enter, hit, types);
            bvec4 inner = equal(types, uvec4(1u));
            bvec4 into = masu_trace_both(hit, inner);
            bvec4 leaf = masu_trace_both(hit, greaterThan(types, uvec4(1u)));
            uvec4 slots = masu_trace_order(enter, leaf);
            uint leaves = masu_trace_count(leaf);
            /* Leaves have one instance each, and follow the nodes. */
            slots -= masu_trace_count(inner);
            uint turns = (slots.x & 3u) | (slots.y & 3u) << 2 | (slots.z & 3u) << 4 | slots.w << 6;
            waiting = leaves == 0u ? 0u : leaves << 8 | (turns & 255u);
            waiting_item = c.w;
            visits++;
            masu_trace_next(c.z, masu_trace_count(into), masu_trace_order(enter, into), 0, top_node,
                            top_rest, depth, top_going);
#ifdef MASU_TRACE_COUNTERS
            masu_trace_nodes_seen++;
#endif
        }
        if (waiting == 0u) break;
        uint record = waiting_item + (waiting & 3u);
        waiting = waiting >= 512u ? ((waiting >> 8) - 1u) << 8 | ((waiting >> 2) & 63u) : 0u;

        uint at = records + record * uint(MASU_TRACE_RECORD_UVEC4);
        vec4 r0 = uintBitsToFloat(masu_trace_frame[at]);
        vec4 r1 = uintBitsToFloat(masu_trace_frame[at + 1u]);
        vec4 r2 = uintBitsToFloat(masu_trace_frame[at + 2u]);
        uvec4 about = masu_trace_frame[at + 3u];
        vec3 from = origin - vec3(r0.w, r1.w, r2.w);
        vec3 o = vec3(dot(r0.xyz, from), dot(r1.xyz, from), dot(r2.xyz, from));
        vec3 d = vec3(dot(r0.xyz, direction), dot(r1.xyz, direction), dot(r2.xyz, direction));
        masu_trace_ray ray = masu_trace_prepare(o, d);
        masu_trace_shear shear = masu_trace_shear_of(d);
        uint node = about.x, rest = 0u;
        int bottom = depth;
        bool going = true;
        for (int m = 0; m < MASU_TRACE_VISITS; m++) {
            if (!going || visits >= uint(MASU_TRACE_VISITS)) break;
            uint items = 0u, item = 0u;
            for (int k = 0; k < MASU_TRACE_VISITS; k++) {
                if (items != 0u || !going || visits >= uint(MASU_TRACE_VISITS)) break;
                uint n = 1u + node * uint(MASU_TRACE_NODE_UVEC4);
                uvec4 a = masu_trace_static[n], b = masu_trace_static[n + 1u];
                uvec4 c = masu_trace_static[n + 2u];
                ivec4 enter;
                bvec4 hit;
                uvec4 types;
                masu_trace_boxes(a, b, c, ray, start, far, enter, hit, types);
                bvec4 into = masu_trace_both(hit, equal(types, uvec4(1u)));
                /* A bit for each triangle of the leaves that are hit. */
                uvec4 count = max(types, uvec4(1u)) - 1u;
                uvec4 bits = (types >> 1) * ((types & 1u) * 2u + 1u) * uvec4(hit);
                uvec3 before = uvec3(count.x, count.x + count.y, count.x + count.y + count.z);
                items = bits.x | bits.y << before.x | bits.z << before.y | bits.w << before.z;
                item = c.w;
                visits++;
                masu_trace_next(c.z, masu_trace_count(into), masu_trace_order(enter, into), bottom,
                                node, rest, depth, going);
#ifdef MASU_TRACE_COUNTERS
                masu_trace_nodes_seen++;
#endif
            }
            for (int k = 0; k < 8; k++) { /* four leaves of two */
                if (items == 0u) break;
                uint triangle = item + masu_low_bit(items);
                items &= items - 1u;
                uvec3 vertices = masu_trace_static[triangles + triangle].xyz;
                vec3 found = masu_trace_triangle(vertices, o, shear, start, far);
#ifdef MASU_TRACE_COUNTERS
                masu_trace_triangles_seen++;
#endif
                if (found.x >= 0.0 && MASU_TRACE_OPAQUE(triangle, about.y, found.yz, d)) {
                    far = found.x;
                    best = masu_ray_hit(found.x, triangle, about.y, record, found.yz);
                    if (any_will_do) {
                        going = false;
                        top_going = false;
                        waiting = 0u;
                        items = 0u;
                    }
                }
            }
        }
        depth = bottom;
    }
    if (visits >= uint(MASU_TRACE_VISITS) && !(any_will_do && best.t >= 0.0)) {
        masu_trace_exceeded = true;
        best.t = -1.0;
    }
    return best;
}

/* The closest triangle at t_min <= t < t_max. */
masu_ray_hit masu_trace(vec3 origin, vec3 direction, float t_min, float t_max)
{
    return masu_trace_walk(origin, direction, t_min, t_max, false);
}

/* Whether any triangle is hit. */
bool masu_trace_any(vec3 origin, vec3 direction, float t_min, float t_max)
{
    return masu_trace_walk(origin, direction, t_min, t_max, true).t >= 0.0;
}

#endif
