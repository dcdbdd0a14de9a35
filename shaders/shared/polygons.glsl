/*
 * polygons.glsl: the start of every vertex shader of placed meshes: the index of the instance, and
 * the transforms of the vertex and its normal. A draw's instances are listed from push.instances on
 * in the buffer of drawn instances.
 */
#ifndef MASU_POLYGONS_GLSL
#define MASU_POLYGONS_GLSL

#include "shared/materials.h"
#include "shared/pack.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_INSTANCES, std430) readonly buffer Instances
{
    masu_instance_data instances[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_DRAWN, std430) readonly buffer Drawn
{
    uint drawn[];
};

#include "shared/push.glsl"

layout(constant_id = 24) const uint masu_draws_more = 0u; /* MASU_DRAWS_* */
const bool masu_looks = (masu_draws_more & MASU_DRAWS_LOOKS) != 0u;
const bool masu_depth_biases = (masu_draws_more & MASU_DRAWS_BIASES) != 0u;

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 oct_normal;

/* A colour as the blob has it: linear, so that it is interpolated as light is. */
vec4 masu_vertex_color(vec4 stored)
{
    return vec4(stored.rgb * stored.rgb, stored.a);
}

uint masu_instance_id()
{
    return drawn[push.instances + uint(gl_InstanceIndex)];
}

/* Looks follow the transforms of all instances (masu_instance_data). */
masu_instance_data masu_look_of(uint id)
{
    return instances[uint(instances.length()) / 2u + id];
}

vec2 masu_moved_texcoord(uint id, vec2 at)
{
    if (masu_looks) {
        vec4 row = masu_look_of(id).row1;
        at = at * row.zw + row.xy;
    }
    return at;
}

/* Position relative to an origin that is split into two floats. */
vec3 masu_point_seen_from(masu_instance_data m, vec3 p, vec3 origin_hi, vec3 origin_lo)
{
    precise vec3 moved = vec3(dot(m.row0.xyz, p), dot(m.row1.xyz, p), dot(m.row2.xyz, p));
    vec3 placed = vec3(m.row0.w, m.row1.w, m.row2.w);
    precise vec3 origin = (placed - origin_hi) - origin_lo;
    precise vec3 rel = moved + origin;
    return rel;
}

vec3 masu_seen_from(masu_instance_data m, vec3 origin_hi, vec3 origin_lo)
{
    return masu_point_seen_from(m, position, origin_hi, origin_lo);
}

/* Transformed normal, of any length, by the cofactor matrix: the inverse transpose times the
 * determinant, which needs no division and so is finite for flattened objects. A mirrored object
 * flips its sign. */
vec3 masu_turned_normal(masu_instance_data m)
{
    vec3 c0 = cross(m.row1.xyz, m.row2.xyz);
    vec3 c1 = cross(m.row2.xyz, m.row0.xyz);
    vec3 c2 = cross(m.row0.xyz, m.row1.xyz);
    vec3 n = masu_oct_decode(oct_normal);
    vec3 turned = vec3(dot(c0, n), dot(c1, n), dot(c2, n));
    return dot(m.row0.xyz, c0) < 0.0 ? -turned : turned;
}

#endif
