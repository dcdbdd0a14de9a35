/*
 * focus_source.comp: depth of field: halves the lit image, and finds the largest near circle of
 * confusion of each 16x16 pixels. A workgroup has one such tile.
 *
 * The most blurred pixel of 2x2 decides: in front of the focal plane if at least two are there,
 * else behind it. Pixels whose radius differs from its radius by two pixels do not contribute, so
 * that sharp and blurred surfaces do not mix.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/store.glsl"
#include "post/focus.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D hdr_image;
layout(set = MASU_SET_PASS, binding = 2, rgba16f) uniform writeonly image2D source_image;
layout(set = MASU_SET_PASS, binding = 3, r32f) uniform writeonly image2D tiles_image;

shared uint nearest; /* bits of the largest -radius, at least 0 */

void main()
{
    if (!(post.lens.y > 0.0)) {
        return;
    }
    if (gl_LocalInvocationIndex == 0u) {
        nearest = 0u;
    }
    barrier();
    uvec2 at = gl_GlobalInvocationID.xy;
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    vec4 radius;
    for (int k = 0; k < 4; k++) {
        ivec2 pixel = min(2 * ivec2(at) + ivec2(k & 1, k >> 1), last);
        radius[k] = masu_focus_radius(texelFetch(depth_image, pixel, 0).r);
    }
    bool front = dot(step(radius, vec4(-0.5)), vec4(1.0)) > 1.5;
    float most = front ? min(min(radius.x, radius.y), min(radius.z, radius.w))
                       : max(max(radius.x, radius.y), max(radius.z, radius.w));
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 pixel = min(2 * ivec2(at) + ivec2(k & 1, k >> 1), last);
        vec3 color = masu_sane(texelFetch(hdr_image, pixel, 0).rgb, 0.0, 65504.0);
        float weight = clamp(2.0 - abs(radius[k] - most), 0.0, 1.0);
        sum += weight * vec4(color, 1.0);
    }
    /* The decisive pixel has a weight of 1. */
    MASU_STORE_HALF(source_image, at, vec4(sum.rgb / max(sum.a, 1.0), most));
    atomicMax(nearest, floatBitsToUint(max(-most, 0.0)));
    barrier();
    if (gl_LocalInvocationIndex == 0u) {
        MASU_STORE_R32F(tiles_image, gl_WorkGroupID.xy, uintBitsToFloat(nearest));
    }
}
