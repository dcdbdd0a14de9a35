/*
 * pick.vert: draws polygons again for picking, into a target of 2x2 pixels: the aligned 2x2 block
 * of the image that contains the requested pixel (frame.temporal.w). So each pixel samples the same
 * point as in the image, and has the same neighbours for the derivatives that select the mip level.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/pick.h"
#include "shared/frame.h"
#include "shared/polygons.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_FRAME, std140) uniform Frame
{
    masu_frame_uniforms frame;
};

#ifdef MASU_TEXTURES
layout(location = 2) in vec2 texcoord;
layout(location = 3) out vec2 out_texcoord;
#endif

layout(location = 0) flat out uint out_id;

void main()
{
    uint id = masu_instance_id();
    out_id = id;
#ifdef MASU_TEXTURES
    out_texcoord = masu_moved_texcoord(id, texcoord);
#endif
    vec3 rel = masu_seen_from(instances[id], frame.eye_hi.xyz, frame.eye_lo.xyz);
    vec4 clip = frame.clip_from_rel * vec4(rel, 1.0);
    vec2 size = vec2(pc.render_width, pc.render_height);
    uvec2 pixel = uvec2(frame.temporal.w & 0xFFFFu, frame.temporal.w >> 16);
    /* Distance from the centre of the block in pixels: 1 is the edge of the target. */
    vec2 middle = vec2(pixel & ~1u) + 1.0;
    precise vec2 moved = clip.xy * (0.5 * size) + clip.w * (0.5 * size - middle);
    gl_Position = vec4(moved, clip.zw);
    if (masu_depth_biases) {
        gl_Position.z *= push.nearer;
    }
}
