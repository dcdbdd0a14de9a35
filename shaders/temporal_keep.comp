/*
 * temporal_keep.comp: stores the nearest depth of the 3x3 samples around each pixel, for the next
 * frame's temporal_find.comp: a pixel next to a silhouette belongs to the foreground. For a surface
 * one pixel wide, which the next frame's samples may miss, the lowest bits of the depth are its
 * velocity (masu_thin in upscale/found.glsl); nothing else of the surface is stored. A surface that
 * this frame has missed is kept, slightly in front of the samples.
 *
 * Push constants: output_* = the render size; push.depth_*: 1 / size of the depth image.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/temporal_keep.h"
#include "shared/types.h"
#include "shared/frame.h"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "upscale/found.glsl"
#include "upscale/corners.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D found_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image;
layout(set = MASU_SET_PASS, binding = 3, r32f) uniform writeonly image2D kept_image;

const float apart = 0.1; /* of the nearest depth: a silhouette, as in temporal_find.comp */
const float in_front = 1.2;

/* The bits of masu_thin of the texel `at`; 0 if the surface is not one pixel wide, or is static. */
uint thin_at(ivec2 at, float depth, vec2 size, vec2 texel)
{
    /* In the last column and row masu_corner repeats texels. */
    if (any(greaterThanEqual(vec2(at), size - 1.0))) {
        return 0u;
    }
    vec4 before = masu_corner(depth_image, vec2(at), size, texel);
    vec4 after = masu_corner(depth_image, vec2(at) + 1.0, size, texel);
    vec2 beside = vec2(max(before.x, after.z), max(before.z, after.x));
    vec4 moved = texelFetch(velocity_image, at, 0);
    moved.xy += frame.shifts.zw;
    bool thin = min(beside.x, beside.y) < (1.0 - apart) * depth && moved.w > 0.0;
    vec2 speed = abs(moved.xy);
    bool moves = any(greaterThan(speed, vec2(0.02))) &&
                 all(lessThanEqual(speed, vec2(masu_thin_fastest))); /* not NaN */
    return thin && moves ? masu_thin(moved.xy, masu_thin_lives) : 0u;
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    vec2 size = vec2(pc.output_width, pc.output_height), texel = vec2(push.depth_x, push.depth_y);
    if (any(greaterThanEqual(vec2(at), size))) {
        return;
    }
    masu_corners c = masu_corners_of(depth_image, vec2(at), size, texel);
    float nearest = masu_most_of(c);
    uint thin = 0u;
    uvec2 found = texelFetch(found_image, at, 0).xy;
    if (masu_is_missed(found)) {
        thin = masu_thin_of(found) - 1u;
        nearest = max(in_front * nearest, 1e-6);
    } else if (nearest - masu_least_of(c) > apart * nearest) {
        thin = thin_at(at + masu_found_beside(masu_way_to(c, nearest)), nearest, size, texel);
    }
    uint replaced = (thin & masu_thin_lives) != 0u ? masu_thin_bits : masu_thin_lives;
    MASU_STORE_SAFE(kept_image, at,
                    vec4(uintBitsToFloat((floatBitsToUint(nearest) & ~replaced) |
                                         (thin & replaced))));
}
