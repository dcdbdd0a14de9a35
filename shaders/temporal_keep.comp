/*
 * temporal_keep.comp: of each pixel the nearest depth of 3x3, for the next frame's temporal.comp: a pixel that a
 * silhouette is near belongs to what is in front.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1, r32f) uniform writeonly image2D kept_image;

void main()
{
    masu_count_begin();
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    if (all(lessThanEqual(at, last))) {
        float nearest = 0.0;
        for (int i = 0; i < 9; i++) {
            ivec2 beside = ivec2(i % 3 - 1, i / 3 - 1);
            nearest = max(nearest, texelFetch(depth_image, clamp(at + beside, ivec2(0), last), 0).r);
        }
        MASU_STORE_R32F(kept_image, at, nearest);
    }
    masu_count_end();
}
