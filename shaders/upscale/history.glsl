/*
 * history.glsl: of a pixel of the output what frames before have left, found again by what temporal_find.comp says of the texel
 * that it lies in. After output.glsl and found.glsl; for temporal.comp and temporal_twice.comp, whose images 1 to 4 these are.
 *
 * Push constants: push.moved_*, push.old_*: 1 / size of the images of velocity and history; push.end_*: the middle of the
 * last pixel.
 */
#ifndef MASU_HISTORY_GLSL
#define MASU_HISTORY_GLSL

#include "upscale/mean.glsl"

layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D found_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image; /* linear */
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D history_image; /* linear */
layout(set = MASU_SET_PASS, binding = 4, rg32ui) uniform writeonly uimage2D accumulated_image;

/* The cubic of Catmull and Rom less its mixed term: the linear mean, less so much of the second difference of
 * linear means a texel apart. */
vec4 masu_history_at(vec2 place)
{
    vec2 inside = place, end = vec2(push.end_x, push.end_y);
    if (!masu_fixed_output) { /* the image may be larger than the picture: masu_resize; else samplers care */
        inside = clamp(place, vec2(0.5), end);
    }
    vec2 t = fract(inside - 0.5);
    vec2 bent = t * (0.5 - 0.5 * t);
    if (!masu_fixed_output) {
        bent = mix(bent, vec2(0.0), greaterThan(inside, end - 1.0));
    }
    vec2 uv = inside * vec2(push.old_x, push.old_y);
    vec4 here = textureLod(history_image, uv, 0.0);
    if (bent.x + bent.y > 0.0) {
        vec3 beside = textureLodOffset(history_image, uv, 0.0, ivec2(-1, 0)).rgb +
                      textureLodOffset(history_image, uv, 0.0, ivec2(1, 0)).rgb;
        vec3 above = textureLodOffset(history_image, uv, 0.0, ivec2(0, -1)).rgb +
                     textureLodOffset(history_image, uv, 0.0, ivec2(0, 1)).rgb;
        here.rgb += 2.0 * (bent.x + bent.y) * here.rgb - bent.x * beside - bent.y * above;
    }
    return here;
}

/* Display light, as it may be, and how many samples of it count; 0 where it begins anew.
 *
 * middle: of the pixel; texel: of the render size, the one that the pixel lies in; inside: where it lies, within the picture, in
 * texels of the render size, whose middles are whole numbers; steps: pixels a texel. */
vec4 masu_history(uvec2 found, vec2 middle, ivec2 texel, vec2 inside, vec2 steps)
{
    if (!masu_is_found(found)) {
        return vec4(0.0);
    }
    /* Of what has stayed the middle of its texel, which is that texel: samplers round to 1/256, as Direct3D has them. Not a
     * fetch instead, which takes a seventh more of this pass by the estimate of Intel's compiler. */
    vec2 before = middle;
    if (!masu_has_stayed(found)) {
        vec2 uv = (inside + 0.5) * vec2(push.moved_x, push.moved_y);
        vec2 moved = masu_found_is_beside(found)
                         ? texelFetch(velocity_image, texel + masu_found_beside(found), 0).xy
                         : textureLod(velocity_image, uv, 0.0).xy;
        before += (moved + frame.shifts.zw) * steps;
    }
    vec4 old = masu_history_at(before);
    old.a = masu_mean_count(old);
    /* More samples than a frame stores, NaN or more light than the cubic makes of what is 0 to 1, is what none has stored, and
     * would be seen as long as all: begin anew. Unorm has neither of the last. */
    bool stored = old.a <= masu_mean_most && (!masu_half_means || abs(old.r) + abs(old.g) + abs(old.b) <= 6.0);
    return stored ? masu_found_held(found, old) : vec4(0.0);
}

#endif
