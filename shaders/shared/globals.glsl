/*
 * globals.glsl: descriptor set 0, and values that every pass of a scene derives from it: the camera
 * ray of a pixel and the counters. A shader that counts declares this by the constant below; with
 * counters off the atomics are compiled away.
 */
#ifndef MASU_GLOBALS_GLSL
#define MASU_GLOBALS_GLSL

#include "shared/frame.h"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_FRAME, std140) uniform Frame
{
    masu_frame_uniforms frame;
};

#include "shared/push.glsl"

/* Normalised device coordinates, -1 to 1, of an image position in pixels, in the image without
 * jitter: the weights of the camera's vectors. Every ray starts with it; rasterised geometry gets
 * the same shift by clip_from_rel. */
vec2 masu_ndc(vec2 pixels, vec2 size)
{
    return pixels / size * 2.0 - 1.0 + frame.jitter.xy;
}

/* Vector from the camera through an image position in pixels, scaled to view z 1: camera + ray * z
 * is the point at view depth z. */
vec3 masu_place_ray(vec2 place, uvec2 size)
{
    vec2 ndc = masu_ndc(place, vec2(size));
    return frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
}

/* The ray through the centre of a pixel. The half texel matters: without it the march and the
 * raster sample different positions. */
vec3 masu_pixel_ray(uvec2 at, uvec2 size)
{
    return masu_place_ray(vec2(at) + 0.5, size);
}

#endif
