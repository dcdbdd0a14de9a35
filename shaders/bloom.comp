/*
 * bloom.comp: the scattered light at 1/4 of the size: the weighted mean of all sizes of
 * bloom_reduce.comp, magnified by B-splines. Sizes are weighted by the fraction of the image height
 * that a texel covers, not by their number, so that the glow has the same width at any resolution.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/counters.h"
#include "shared/counters.glsl"
#include "shared/push.glsl"
#include "shared/store.glsl"
#include "post/bloom.glsl"
#include "post/post.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D bloom_4;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D bloom_16;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D bloom_128;
layout(set = MASU_SET_PASS, binding = 3, rgba16f) uniform writeonly image2D bloom_image;

/* The same for each octave from 1/128 to 1/24 of the height, with a fade of about an octave at both
 * ends. The last term selects the smallest size in images of few rows. */
float weight_of(uint divisor)
{
    float octave = masu_log2(float(divisor) / float(max(pc.render_height, 1u)));
    float rise = clamp(octave + 8.0, 0.0, 1.0), fall = clamp((-3.25 - octave) / 1.25, 0.0, 1.0);
    float few = 0.064 / float(divisor);
    return rise * fall + few * few;
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (!(post.lens.x > 0.0)) {
        return;
    }
    float total = weight_of(4u);
    vec3 sum = total * masu_sane(texelFetch(bloom_4, ivec2(at), 0).rgb, 0.0, 65504.0);
    for (uint k = 1u; k < 6u; k++) {
        uint divisor = 4u << k;
        float weight = weight_of(divisor), row = float(masu_bloom_row(divisor));
        vec2 place = (vec2(at) + 0.5) / float(1u << k), size = vec2(masu_bloom_size(divisor));
        if (weight > 1e-4) {
            sum += weight * (k < 3u ? masu_post_spline(bloom_16, place, size, row)
                                    : masu_post_spline(bloom_128, place, size, row));
            total += weight;
        }
    }
    MASU_STORE_HALF(bloom_image, at, vec4(sum * masu_rcp(total), 0.0));
}
