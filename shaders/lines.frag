/*
 * lines.frag: a debug line's colour, unless a surface that is closer by more than half a percent
 * occludes it: lines on a surface are visible.
 * The depth has render resolution, and may be shifted by the frame's jitter.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/lines.h"
#include "shared/sprites.h"
#include "shared/types.h"
#include "shared/push.glsl"

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;

layout(location = 0) in vec4 in_color;
layout(location = 1) flat in uint in_flags;

layout(location = 0) out vec4 out_color;

void main()
{
    vec2 render = vec2(pc.render_width, pc.render_height);
    vec2 at = gl_FragCoord.xy * (render / vec2(pc.output_width, pc.output_height));
    float nearest = texelFetch(depth_image, ivec2(min(at, render - 1.0)), 0).r;
    if ((in_flags & MASU_SPRITE_ON_TOP) == 0u && nearest > 1.005 * in_color.w) {
        discard;
    }
    out_color = vec4(in_color.rgb, 1.0);
}
