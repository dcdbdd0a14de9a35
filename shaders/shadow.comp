/*
 * shadow.comp: sun visibility of each pixel with respect to polygons, from the shadow map. With SDF
 * shadows it is multiplied by the SDF's result (sdf_occlusion.comp, which runs before).
 * light/sun_map.glsl has the lookup.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/sun_map.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 3, r32ui) uniform uimage2D occlusion_image;

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        uint texel = texelFetch(normal_image, ivec2(at), 0).r;
        vec2 seen = vec2(1.0);
        if (shadow.reach.w != 0.0) {
            seen = unpackUnorm2x16(imageLoad(occlusion_image, ivec2(at)).r);
        }
        vec3 n = masu_unpack_normal(texel);
        float z = frame.forward.w * masu_rcp(depth);
        vec3 rel = masu_pixel_ray(at, size) * z;
        bool there = depth > 0.0 && !masu_is_unlit_texel(texel);
        bool asks = there && masu_finite(rel) && dot(n, frame.sun_direction.xyz) > 0.0;
        if (asks && seen.x > 0.0) {
            seen.x *= masu_sun_seen(rel, n, z);
        }
        vec2 kept = masu_sane(vec4(seen, 0.0, 0.0), 0.0, 1.0).xy;
        MASU_STORE_UINT(occlusion_image, at, uvec4(packUnorm2x16(kept)));
    }
    masu_count_end();
}
