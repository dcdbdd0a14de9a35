/*
 * background.comp: the lit image before transparent surfaces, with depth in alpha, as six levels of
 * half the size each, and with MASU_REFRACTED also at full resolution (light/background.glsl). An
 * invocation reduces 8x8 pixels, a workgroup 64x64. Pixels beyond the edge repeat the last row and
 * column.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/push.glsl"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/store.glsl"
#include "light/background.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D hdr_image;
layout(set = MASU_SET_PASS, binding = 2, rgba16f) uniform writeonly image2D background_image;

const float brightest = 4096.0; /* as in transparents.frag */

shared vec4 means[MASU_GROUP * MASU_GROUP];

#ifdef MASU_REFRACTED
const uint largest = 0u;
#else
const uint largest = 1u;
#endif

void keep(uint level, uvec2 tiles, uvec2 at, vec4 mean)
{
    MASU_STORE_HALF(background_image, masu_background_at(level, largest, tiles) + at, mean);
}

vec4 mean_of_pixels(uvec2 at)
{
    ivec2 last = max(ivec2(pc.render_width, pc.render_height) - 1, 0);
    vec4 sum = vec4(0.0);
    for (uint k = 0u; k < 4u; k++) {
        uvec2 own = at * 2u + uvec2(k & 1u, k >> 1);
        ivec2 pixel = min(ivec2(own), last);
        vec4 seen =
            vec4(masu_sane(texelFetch(hdr_image, pixel, 0).rgb, 0.0, brightest),
                 masu_background_depth(masu_sane(texelFetch(depth_image, pixel, 0).r, 0.0, 1.0)));
#ifdef MASU_REFRACTED
        keep(0u, gl_NumWorkGroups.xy, own, seen);
#endif
        sum += seen;
    }
    return sum * 0.25;
}

void main()
{
    uvec2 tiles = gl_NumWorkGroups.xy, tile = gl_WorkGroupID.xy, local = gl_LocalInvocationID.xy;
    uvec2 block = gl_GlobalInvocationID.xy;
    vec4 third = vec4(0.0);
    for (uint i = 0u; i < 4u; i++) {
        uvec2 quarter = block * 2u + uvec2(i & 1u, i >> 1);
        vec4 second = vec4(0.0);
        for (uint k = 0u; k < 4u; k++) {
            uvec2 at = quarter * 2u + uvec2(k & 1u, k >> 1);
            vec4 first = mean_of_pixels(at);
            keep(1u, tiles, at, first);
            second += first * 0.25;
        }
        keep(2u, tiles, quarter, second);
        third += second * 0.25;
    }
    keep(3u, tiles, block, third);
    uint self = local.y * uint(MASU_GROUP) + local.x, side = uint(MASU_GROUP);
    means[self] = third;
    for (uint level = 4u; level <= MASU_BACKGROUND_LEVELS; level++) {
        side /= 2u;
        bool inside = all(lessThan(local, uvec2(side)));
        uvec2 from = inside ? local * 2u : uvec2(0u);
        uint first = from.y * uint(MASU_GROUP) + from.x;
        barrier();
        vec4 mean = 0.25 * (means[first] + means[first + 1u] + means[first + uint(MASU_GROUP)] +
                            means[first + uint(MASU_GROUP) + 1u]);
        barrier();
        if (inside) {
            means[self] = mean;
            keep(level, tiles, tile * side + local, mean);
        }
    }
}
