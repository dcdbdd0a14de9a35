/*
 * lines.vert: six vertices of a parallelogram around a debug line: one pixel wide, and half a pixel
 * longer at each end. It covers the centre of one pixel in each column, or row if it is steeper,
 * including those of its ends. (The coverage of line primitives differs between devices.)
 * src/frame/debug_lines.c has clipped it: both ends are in the image.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/lines.h"
#include "shared/sprites.h"
#include "shared/types.h"
#include "shared/push.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SPRITES, std430) readonly buffer Sprites
{
    vec4 sprites[];
};

layout(location = 0) out vec4 out_color; /* sRGB; depth */
layout(location = 1) flat out uint out_flags;

void main()
{
    uint at = push.first + uint(MASU_LINE_VEC4S) * (uint(gl_VertexIndex) / 6u);
    uint k = uint(gl_VertexIndex) % 6u;
    uint corner = k < 3u ? k : 6u - k; /* 0 1 2, 3 2 1 */
    vec2 size = vec2(pc.output_width, pc.output_height);
    vec4 from = sprites[at], to = sprites[at + 1u];
    vec4 end = corner > 1u ? to : from;
    vec2 way = (to.xy - from.xy) * (0.5 * size);
    bool steep = abs(way.y) > abs(way.x);
    float length = steep ? way.y : way.x;
    vec2 along = abs(length) > 1e-6 ? way / abs(length) : vec2(1.0, 0.0);
    vec2 moved = along * (corner > 1u ? 0.5 : -0.5);
    moved += (steep ? vec2(1.0, 0.0) : vec2(0.0, 1.0)) * ((corner & 1u) != 0u ? 0.5 : -0.5);
    out_color = vec4(unpackUnorm4x8(floatBitsToUint(end.w)).rgb, end.z);
    out_flags = floatBitsToUint(from.w) >> 24;
    gl_Position = vec4(end.xy + moved * 2.0 / size, 0.5, 1.0);
}
