/*
 * motion.glsl: the velocity of a surface point, in the format of the image `velocity` (for
 * rung.temporal specular_composite.comp replaces it on mirrors by the velocity of the reflection):
 *
 *   x, y  previous position minus present one, pixels of this frame's render size, y down
 *   z     previous view depth / present one, minus 1; 0 for the sky
 *   w     1; 0 (and all else 0): the point was behind the camera, or its motion is unavailable
 *
 * so that previous = present + velocity. Both positions are projected by the same operations, and
 * a static point has a velocity of exactly 0. The difference of the two, and not "previous minus
 * pixel centre": a rasteriser that snaps vertices to a grid shows a point next to the pixel's
 * centre. Needs globals.glsl before it.
 */
#ifndef MASU_MOTION_GLSL
#define MASU_MOTION_GLSL

#include "shared/frame.h"
#include "shared/guard.glsl"

/* sdf/field.glsl declares it if the SDF needs it. */
#ifndef MASU_FIELD_GLSL
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PREVIOUS, std140) uniform Previous
{
    masu_frame_uniforms previous;
};
#endif

vec3 masu_clip(masu_mat4 m, vec4 rel)
{
    precise vec4 clip = m * rel;
    return clip.xyw;
}

/* rel: the point relative to the camera; before: the previous point relative to the previous
 * camera. w is 1, or 0 for a direction. */
vec4 masu_velocity(vec4 rel, vec4 before, vec2 size)
{
    vec3 now = masu_clip(frame.clip_from_rel, rel);
    vec3 was = masu_clip(previous.clip_from_rel, before);
    bool told = now.z > masu_tiny && was.z > 1e-6 * now.z;
    vec2 ahead = told ? now.xy / now.z : vec2(0.0);
    vec2 behind = told ? was.xy / was.z : vec2(0.0);
    precise vec2 moved = (behind - ahead) * (0.5 * size);
    /* a GPU's x / x may not be 1 */
    float depth = told && rel.w > 0.0 ? (was.z - now.z) / now.z : 0.0;
    vec4 velocity = vec4(moved, depth, 1.0);
    told = told && masu_finite(velocity) && all(lessThan(abs(velocity.xyz), vec3(65504.0)));
    return told ? velocity : vec4(0.0);
}

/* Removes the difference of the frames' jitter from a motion in pixels: a static point gets 0,
 * wherever the frames sampled its pixel. Used to find histories: their texels are means over such
 * positions. */
vec2 masu_unjittered(vec2 moved, vec2 size)
{
    return moved + (previous.jitter.zw - frame.jitter.zw) * (0.5 * size);
}

/* The point at view depth z of the ray `through` a pixel, whose view depth is 1. step: from the
 * point to where it was in the previous frame, 0 of a static surface. */
vec4 masu_point_velocity(vec3 through, float z, vec3 step, vec2 size)
{
    precise vec3 eye_step = (frame.eye_hi.xyz - previous.eye_hi.xyz) +
                            (frame.eye_lo.xyz - previous.eye_lo.xyz);
    precise vec3 rel = through * z;
    precise vec3 was = rel + (eye_step + step);
    return masu_velocity(vec4(rel, 1.0), vec4(was, 1.0), size);
}

vec4 masu_sky_velocity(uvec2 at, uvec2 size)
{
    vec4 direction = vec4(masu_pixel_ray(at, size), 0.0);
    return masu_velocity(direction, direction, vec2(size));
}

#endif
