/*
 * temporal_keep.comp: what the next frame's temporal.comp asks of this one: the depth of each pixel; below 0 where
 * the surface has moved by itself.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/globals.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D velocity_image;
layout(set = MASU_SET_PASS, binding = 2, r32f) uniform writeonly image2D kept_image;

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        float depth = 0.0;
        for (int i = 0; i < 9; i++) {
            ivec2 to = clamp(ivec2(at) + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), ivec2(pc.output_width, pc.output_height) - 1);
            depth = max(depth, texelFetch(depth_image, to, 0).r);
        }
        MASU_STORE_R32F(kept_image, at, depth);
    }
}
