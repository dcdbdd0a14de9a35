/*
 * bloom_reduce.comp: reduces the lit image for bloom (post/bloom.glsl) to 1/2, 1/4 and 1/8 of a
 * larger size, each directly.
 *
 * The source is weighted by a tent as wide as two texels of the result. All source texels have the
 * same total weight, so that the energy of the image is conserved, and a moving bright pixel
 * changes its neighbours evenly. One bilinear sample reads two source texels per axis. (J. Jimenez,
 * "Next Generation Post Processing in Call of Duty: Advanced Warfare", SIGGRAPH 2014, has a 13-tap
 * filter for each halving and a tent for each doubling.)
 *
 * There is no weighting by luminance against fireflies: it loses energy.
 *
 * Push constants: push.divisor: the source has 1 / divisor of the render size. push.levels: sizes
 * to write: 1: 1/4, else the first `levels` of 1/2, 1/4, 1/8 of the source.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/bloom_reduce.h"
#include "shared/counters.h"
#include "shared/counters.glsl"
#include "shared/push.glsl"
#include "shared/store.glsl"
#include "post/bloom.glsl"
#include "post/post.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source_image;
layout(set = MASU_SET_PASS, binding = 1, rgba16f) uniform writeonly image2D bloom_image;

/* factor: 2, 4 or 8 */
vec3 reduced(uvec2 at, uint factor)
{
    vec2 size = vec2(masu_bloom_size(push.divisor)), centre = (vec2(at) + 0.5) * float(factor);
    float row = float(masu_bloom_row(push.divisor)), step = 1.0 / float(factor);
    int pairs = int(factor / 2u);
    vec3 sum = vec3(0.0);
    for (uint j = 0u; j < 8u && j < factor; j++) {
        for (uint i = 0u; i < 8u && i < factor; i++) {
            int x = int(i) - pairs, y = int(j) - pairs;
            /* Texels at 2 k + 1/2 and 2 k + 3/2 from the centre. */
            vec2 k = vec2(x < 0 ? -1 - x : x, y < 0 ? -1 - y : y);
            vec2 weight = 2.0 - (4.0 * k + 2.0) * step;
            vec2 away = 2.0 * k + 0.5 + (1.0 - (2.0 * k + 1.5) * step) / weight;
            vec2 place = centre + vec2(x < 0 ? -away.x : away.x, y < 0 ? -away.y : away.y);
            sum += weight.x * weight.y * masu_post_sample(source_image, place, size, row);
        }
    }
    return sum * (step * step);
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (!(post.lens.x > 0.0)) {
        return;
    }
    uint divisor = push.levels == 1u ? 4u * push.divisor : 2u * push.divisor;
    uint row = 0u;
    for (uint level = 0u; level < 3u && level < push.levels; level++) {
        uvec2 size = masu_bloom_size(divisor);
        if (at.x < size.x && at.y >= row && at.y < row + size.y) {
            MASU_STORE_HALF(
                bloom_image, at,
                vec4(reduced(uvec2(at.x, at.y - row), divisor / max(push.divisor, 1u)), 0.0));
        }
        row += size.y;
        divisor *= 2u;
    }
}
