/*
 * gbuffer.vert: object space to clip space, by way of camera-relative space.
 *
 * The eye is subtracted from the instance's translation in two steps (high part, then low part), so
 * that a world a million metres from the origin is as steady as one at the origin.
 *
 * A draw's instances are listed from index.y on in the buffer of drawn instances.
 *
 * With MASU_MOTION (gbuffer_velocity) also to where the vertex was in the frame before, by the same
 * operations: what stood still gets the same bits twice, and a velocity of exactly 0.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/pack.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_FRAME, std140) uniform Frame
{
    masu_frame_uniforms frame;
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_INSTANCES, std430) readonly buffer Instances
{
    masu_instance_data instances[];
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_DRAWN, std430) readonly buffer Drawn
{
    uint drawn[];
};

layout(push_constant) uniform Push
{
    masu_push pc;
};

#ifdef MASU_MOTION
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PREVIOUS, std140) uniform Previous
{
    masu_frame_uniforms previous;
};

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PREVIOUS_INSTANCES, std430) readonly buffer
    PreviousInstances
{
    masu_instance_data previous_instances[];
};

layout(location = 2) out vec3 out_before;
#endif

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 oct_normal;

layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec3 out_rel;

vec3 seen_from(masu_instance_data m, vec3 eye_hi, vec3 eye_lo)
{
    precise vec3 moved =
        vec3(dot(m.row0.xyz, position), dot(m.row1.xyz, position), dot(m.row2.xyz, position));
    vec3 placed = vec3(m.row0.w, m.row1.w, m.row2.w);
    precise vec3 origin = (placed - eye_hi) - eye_lo;
    precise vec3 rel = moved + origin;
    return rel;
}

void main()
{
    uint id = drawn[pc.index.y + uint(gl_InstanceIndex)];
    masu_instance_data m = instances[id];
    vec3 rel = seen_from(m, frame.eye_hi.xyz, frame.eye_lo.xyz);

    /* Normals go by the cofactor matrix: the inverse transpose times the determinant, which needs
     * no division and so stays finite for flattened objects. A mirrored object turns its sign. */
    vec3 c0 = cross(m.row1.xyz, m.row2.xyz);
    vec3 c1 = cross(m.row2.xyz, m.row0.xyz);
    vec3 c2 = cross(m.row0.xyz, m.row1.xyz);
    vec3 n = masu_oct_decode(oct_normal);
    vec3 turned = vec3(dot(c0, n), dot(c1, n), dot(c2, n));
    out_normal = dot(m.row0.xyz, c0) < 0.0 ? -turned : turned;
    out_rel = rel;
#ifdef MASU_MOTION
    out_before =
        seen_from(previous_instances[id], previous.eye_hi.xyz, previous.eye_lo.xyz);
#endif
    gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
}
