/*
 * march_seed.comp: for comparison: the two-phase checkerboard march of the article that this
 * project began with, by its original rule. Half of the pixels are marched. The other half restart
 * at their neighbours' surface distance, with a sixteenth of the steps and no check. A restart that
 * does not converge copies the surface of its nearest neighbour. Known faults, kept on purpose:
 * pixels that do not converge, skipped features in front of the hint, tile borders with fewer
 * hints. masu-bake compiles it with --variants.
 *
 * 32 invocations per 8x8 tile; each owns two pixels of a row.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/march_seed.h"
#include "shared/counters.h"
#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = 4, local_size_y = 8) in;

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

shared float hits[8][4]; /* distance of each first-phase pixel, or -1 */

float raster_at(uvec2 at)
{
#if MASU_HAS_RASTER
    return texelFetch(raster_depth, ivec2(at), 0).r;
#else
    return 0.0;
#endif
}

/* The original march: fixed tolerance, no candidate, capped steps. Returns -1 if it does not
 * converge. */
float capped(ray r, float start, uint cap, float epsilon)
{
    float t = start;
    uint evals = 0u;
    float found = -1.0;
    MASU_LOOP for (int i = 0; i < MASU_MARCH_STEPS_MAX; i++) {
        if (uint(i) >= cap || !(t < r.limit) || found >= 0.0) {
            break;
        }
        bool usable;
        float f = step_at(r, t, usable);
        evals++;
        if (!usable) {
            break;
        }
        found = f < epsilon ? t : -1.0;
        t += f;
    }
    masu_count(MASU_COUNTER_SDF_EVALS, evals);
    return found;
}

void finish(uvec2 at, ray r, float t, float z_scale, float raster)
{
    float depth = raster;
    if (t >= 0.0 && t < r.limit) {
        depth = write_hit(at, r, t, false, 0u, z_scale);
    }
    MASU_STORE_R32F(depth_image, at, depth);
}

void main()
{
    masu_count_begin();
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    uvec2 me = gl_LocalInvocationID.xy;
    uvec2 corner = gl_WorkGroupID.xy * 8u;
    float z_scale;

    uvec2 at = corner + uvec2(me.x * 2u + (me.y & 1u), me.y);
    float t = -1.0;
    if (all(lessThan(at, size))) {
        float raster = raster_at(at);
        ray r = pixel_ray(at, size, raster, z_scale);
        t = capped(r, r.start, push.steps, 0.01);
        finish(at, r, t, z_scale, raster);
    }
    hits[me.y][me.x] = t;
    barrier();

    at = corner + uvec2(me.x * 2u + 1u - (me.y & 1u), me.y);
    if (all(lessThan(at, size))) {
        float raster = raster_at(at);
        ray r = pixel_ray(at, size, raster, z_scale);
        int side = (me.y & 1u) == 0u ? int(me.x) + 1 : int(me.x) - 1;
        float hints[4] = float[](t, -1.0, -1.0, -1.0);
        if (side >= 0 && side < 4) {
            hints[1] = hits[me.y][side];
        }
        if (me.y > 0u) {
            hints[2] = hits[me.y - 1u][me.x];
        }
        if (me.y < 7u) {
            hints[3] = hits[me.y + 1u][me.x];
        }
        float nearest = -1.0;
        float fallback = -1.0;
        for (int i = 0; i < 4; i++) {
            if (hints[i] >= 0.0) {
                float found = capped(r, hints[i], max(push.steps / 16u, 1u), 0.1);
                nearest = found >= 0.0 && (nearest < 0.0 || found < nearest) ? found : nearest;
                fallback = fallback < 0.0 ? hints[i] : min(fallback, hints[i]);
            }
        }
        if (nearest < 0.0 && fallback >= 0.0) {
            masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
        }
        finish(at, r, nearest >= 0.0 ? nearest : fallback, z_scale, raster);
    }
    masu_count_end();
}
