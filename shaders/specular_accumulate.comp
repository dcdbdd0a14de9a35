/*
 * specular_accumulate.comp: for comparison: the sum of the radiance of all rays of each pixel since
 * the last cut, and their number. In floats: after 2^20 frames a sum can still be incremented.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "specular/guide.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D light_image;
layout(set = MASU_SET_PASS, binding = 2, rgba32f) uniform image2D sum_image;

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        bool there = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg).there;
        vec4 sum = frame.history.y != 0u ? imageLoad(sum_image, ivec2(texel)) : vec4(0.0);
        if (there) {
            sum += vec4(texelFetch(light_image, ivec2(texel), 0).rgb, 1.0);
        }
        MASU_STORE_FLOATS(sum_image, texel, sum, 0.0, 3.4e38);
    }
    masu_count_end();
}
