/*
 * temporal.comp: anti-aliasing and upscaling in one, by samples of frames before. Of each pixel of the output it takes
 * the mean of this frame's samples near it and of its history, each by how many samples stand in it. The frame's
 * jitter has put its samples elsewhere than those before. docs/design/41-temporal.md has the measurements;
 * temporal_find.comp has asked where the history is, and how much of it counts.
 *
 * A pixel that has not yet a whole sample takes the rest from the four texels around, as bilinear filtering would.
 *
 * Everything is display light, as an eye takes the mean of it (docs/design/31-truth.md); a: samples. Halves are rounded up
 * or down by chance: the nearest one would hold a history still that is a little wrong.
 *
 * Push constants: output_* = size to write; push.scale_* = input size * (1 / output size), push.steps_* = 1 / that;
 * push.first_*: where the first pixel's middle lies, push.last_*: how far a place may, texels of the render size whose
 * middles are whole numbers; push.end_*: the middle of the last pixel; push.texel_*, push.moved_*, push.old_*: 1 / size of
 * the images of colour, velocity, history.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#define MASU_PUSH masu_push_temporal
#include "shared/masu_shared.h"
#include "shared/output.glsl"
#include "upscale/found.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image; /* roots of display light */
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D found_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image; /* linear */
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D history_image; /* linear */
layout(set = MASU_SET_PASS, binding = 4, rgba16f) uniform writeonly image2D accumulated_image;

/* The cubic of Catmull and Rom less its mixed term: the linear mean, less so much of the second difference of
 * linear means a texel apart. */
vec4 history_at(vec2 place)
{
    vec2 end = vec2(push.end_x, push.end_y);
    vec2 inside = clamp(place, vec2(0.5), end);
    vec2 t = fract(inside - 0.5);
    vec2 bent = t * (0.5 - 0.5 * t);
    /* The image may be larger than the picture: masu_resize. */
    bent = mix(bent, vec2(0.0), greaterThan(inside, end - 1.0));
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

/* To a half, up or down by chance. R2 over the pixels as in dither.glsl, in 24 bits, which multiply faster. */
vec3 by_chance(vec3 v, uvec2 at)
{
    uint noise = at.x * 0xC13FAAu + at.y * 0x91E10Eu + frame.history.x * 0x9E3779u;
    return uintBitsToFloat((floatBitsToUint(v) + (noise >> 11 & 0x1FFFu)) & 0xFFFFE000u);
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (masu_is_outside(at)) {
        return;
    }
    vec2 steps = vec2(push.steps_x, push.steps_y);
    /* In texels of the render size, whose middles are whole numbers: where the pixel lies; that within the picture, and a
     * little before the middle of the last one, for what lies beyond is read even for a weight of 0; the texel that it is
     * in; and of the four around it the upper left one. Of a size of 1 they are the same texel. */
    vec2 place = vec2(at) * vec2(push.scale_x, push.scale_y) + (vec2(push.first_x, push.first_y) - frame.shifts.xy);
    vec2 inside = min(max(place, vec2(0.0)), vec2(push.last_x, push.last_y));
    vec2 texel = floor(inside + 0.5), corner = floor(inside);
    vec2 f = place - corner;

    vec4 old = vec4(0.0);
    uvec2 found = texelFetch(found_image, ivec2(texel), 0).xy;
    if (masu_is_found(found)) {
        /* Of what has stayed the middle of its texel, which is that texel: samplers round to 1/256, as Direct3D has them. Not a
         * fetch instead, which takes a seventh more of this pass by the estimate of Intel's compiler. */
        vec2 before = vec2(at) + 0.5;
        if (!masu_has_stayed(found)) {
            vec2 uv = (inside + 0.5) * vec2(push.moved_x, push.moved_y);
            vec2 moved = masu_found_is_beside(found)
                             ? texelFetch(velocity_image, ivec2(texel) + masu_found_beside(found), 0).xy
                             : textureLod(velocity_image, uv, 0.0).xy;
            before += (moved + frame.shifts.zw) * steps;
        }
        old = history_at(before);
        /* Of what a frame stores, 0 to 1, the cubic is within these. What none stores, as NaN, would count as many
         * samples as there can be, and be seen as long: begin anew. */
        bool stored = abs(old.r) + abs(old.g) + abs(old.b) + abs(old.a) <= 70.0;
        old = stored ? masu_found_held(found, old) : vec4(0.0);
    }

    /* A tent as wide as two pixels of the output. Of what moves or is new, at half size a quarter wider (0.6 of that and 0.4
     * of a tent of the input), or rows that this frame's samples miss would differ from those beside them: dotted edges. */
    steps = masu_found_is_long(found) ? steps : 0.6 * steps + 0.4;
    vec2 first = max(1.0 - abs(f) * steps, 0.0), second = max(1.0 - abs(1.0 - f) * steps, 0.0);
    vec2 both = first + second;
    float count = old.a + both.x * both.y;
    float rest = max(1.0 - count, 0.0);
    f = clamp(f, 0.0, 1.0);
    vec4 around = vec4(1.0 - f.x, f.x, f.x, 1.0 - f.x) * vec4(f.y, f.y, 1.0 - f.y, 1.0 - f.y);
    vec4 weights = vec4(first.x, second.x, second.x, first.x) * vec4(second.y, second.y, first.y, first.y);
    weights += rest * around;
    vec2 uv = (corner + 1.0) * vec2(push.texel_x, push.texel_y);
    vec4 red = textureGather(color_image, uv, 0), green = textureGather(color_image, uv, 1),
         blue = textureGather(color_image, uv, 2);
    vec3 sum = old.a * old.rgb + vec3(dot(weights, red * red), dot(weights, green * green), dot(weights, blue * blue));
    vec3 light = sum * (1.0 / max(count, 1.0));
    /* As integers, NaN, Inf and all that is more than 1 are more than it: nothing else is ever kept. */
    light = uintBitsToFloat(min(floatBitsToUint(light), uvec3(0x3F800000u)));
    MASU_STORE_SAFE(accumulated_image, at, vec4(by_chance(light, at), min(count, 64.0)));
}
