/*
 * march_plain.comp: the baseline march: every pixel separately, from the near plane, with all
 * parts. Kept for masu-lab study march. masu-bake compiles it with the scene's SDF.
 * MASU_HAS_RASTER: polygon depth limits the rays.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/march_plain.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#if MASU_HAS_RASTER
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_WRITE 1
#else
#define MASU_FIRST_WRITE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE, rgba8)
    uniform writeonly image2D albedo_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE + 1, r32ui)
    uniform writeonly uimage2D normal_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE + 2, r32f)
    uniform writeonly image2D depth_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE + 3, rgba16f)
    uniform writeonly image2D hdr_image;

#include "sdf/hit.glsl"

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        float depth = 0.0;
#if MASU_HAS_RASTER
        depth = texelFetch(raster_depth, ivec2(at), 0).r;
#endif
        float z_scale;
        uint evals;
        ray r = pixel_ray(at, size, depth, z_scale);
        float t = march(r, evals);
        if (t >= 0.0) {
            depth = write_hit(at, r, t, false, 0u, z_scale);
        }
        masu_count(MASU_COUNTER_SDF_EVALS, evals);
        MASU_STORE_R32F(depth_image, at, depth);
    }
    masu_count_end();
}
