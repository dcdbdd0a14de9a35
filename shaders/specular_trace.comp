/*
 * specular_trace.comp: the first polygon that the ray of each traced texel hits (trace/bvh.glsl).
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_trace.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#define MASU_TRACE_POLYGONS
#include "trace/scene.glsl"
#define MASU_TRACE_COUNTERS
#define MASU_TRACE_LANES (MASU_GROUP * MASU_GROUP)
#include "trace/texels.glsl"
#include "trace/bvh.glsl"
#include "specular/origin.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D ray_image;
layout(set = MASU_SET_PASS, binding = 2, rgba32ui) uniform writeonly uimage2D hit_image;

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        if (g.there) {
            vec3 origin = masu_specular_origin(masu_specular_point(texel, g), g);
            vec3 direction = masu_unpack_direction(texelFetch(ray_image, ivec2(texel), 0).r);
            masu_ray_hit hit = masu_trace(origin, direction, 0.0, frame.trace_anchor.w);
            if (hit.t >= 0.0) {
                vec2 b = masu_sane(vec4(hit.barycentrics, 0.0, 0.0), 0.0, 1.0).xy;
                MASU_STORE_UINT(
                    hit_image, texel,
                    uvec4(floatBitsToUint(hit.t), hit.instance, hit.triangle, packUnorm2x16(b)));
                masu_count(MASU_COUNTER_SPECULAR_HITS, 1u);
            }
            masu_count(MASU_COUNTER_SPECULAR_NODES, masu_trace_nodes_seen);
        }
    }
    masu_count_end();
}
