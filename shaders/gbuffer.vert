/*
 * gbuffer.vert: transforms object space to camera-relative space, then to clip space.
 *
 * The camera position is subtracted from the instance's translation in two steps (high part, then
 * low part), so that a world a million metres from the origin is as stable as one at the origin.
 *
 * MASU_MOTION (gbuffer_velocity) also transforms to the vertex's previous position, by the same
 * operations: static vertices give bit-identical results, and a velocity of exactly 0. With
 * MASU_SKINNED the vertices from push.first_skinned on also have a previous position in their mesh,
 * from skin_previous.comp. MASU_TEXTURES passes texture coordinates, MASU_ATTRIBUTES a second set
 * and vertex colours.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/gbuffer.h"
#include "shared/frame.h"
#include "shared/materials.h"
#include "shared/polygons.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_FRAME, std140) uniform Frame
{
    masu_frame_uniforms frame;
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

#ifdef MASU_SKINNED
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PREVIOUS_VERTICES, std430) readonly buffer
    PreviousVertices
{
    float previous_vertices[];
};
#endif

#ifdef MASU_TEXTURES
layout(location = 2) in vec2 texcoord;
layout(location = 3) out vec2 out_texcoord;
#endif
#ifdef MASU_ATTRIBUTES
layout(location = 3) in vec2 second_texcoord;
layout(location = 4) in vec4 color;
layout(location = 4) out vec2 out_second;
layout(location = 5) out vec4 out_color;
#endif

#define MASU_LOOK_OUT
#include "shared/look.glsl"

/* Meshes with and without textures share edges. */
invariant gl_Position;
layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec3 out_rel;

void main()
{
    uint id = masu_instance_id();
    masu_instance_data m = instances[id];
    vec3 rel = masu_seen_from(m, frame.eye_hi.xyz, frame.eye_lo.xyz);
    out_normal = masu_turned_normal(m);
    out_rel = rel;
    masu_pass_look(id);
#ifdef MASU_TEXTURES
    out_texcoord = masu_moved_texcoord(id, texcoord);
#endif
#ifdef MASU_ATTRIBUTES
    out_second = masu_moved_texcoord(id, second_texcoord);
    out_color = masu_vertex_color(color);
#endif
#ifdef MASU_MOTION
    vec3 before = position;
#ifdef MASU_SKINNED
    uint vertex = uint(gl_VertexIndex);
    if (vertex >= push.first_skinned) {
        uint k = 3u * (vertex - push.first_skinned);
        before = vec3(previous_vertices[k], previous_vertices[k + 1u], previous_vertices[k + 2u]);
    }
#endif
    out_before = masu_point_seen_from(previous_instances[id], before, previous.eye_hi.xyz,
                                      previous.eye_lo.xyz);
#endif
    gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
    if (masu_depth_biases) {
        gl_Position.z *= push.nearer;
    }
}
