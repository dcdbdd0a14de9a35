/*
 * march_checkerboard.comp: for comparison with march.comp: 8x8 cones, then two phases. Pixels of
 * the second phase start at the distance up to which their marched neighbours have proved the ray
 * free. masu-bake compiles it with --variants.
 *
 * A sample with the free radius r at distance t on a neighbour's ray clears every point within r.
 * On a ray at the angle d to it these are the distances t +- h, with
 *
 *   h = sqrt(r^2 - (t d)^2 + (t d^2 / 2)^2) - t d^2 / 2.
 *
 * Intervals are chained while they overlap, from the distance that the cone has cleared; the first
 * gap ends the chain. A pixel starts at the largest end of its neighbours' chains: this is exact,
 * without a cap or fallback colours. d is the pixel spacing at the image centre, the largest there
 * is.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/march_checkerboard.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D cone_image;
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D albedo_image;
layout(set = MASU_SET_PASS, binding = 2, r32ui) uniform writeonly uimage2D normal_image;
layout(set = MASU_SET_PASS, binding = 3, r32f) uniform image2D depth_image;
layout(set = MASU_SET_PASS, binding = 4, rgba16f) uniform writeonly image2D hdr_image;

#define MASU_RELAXED
#define MASU_SAFE_HINT
#include "sdf/hit.glsl"

#define EDGE (2 * MASU_GROUP)

shared float free_to[EDGE][EDGE]; /* of first-phase pixels: the free distance of their neighbours */

/* Marches one pixel; returns the free distance of its neighbours. */
float march_pixel(uvec2 at, uvec2 size, float start)
{
    if (any(greaterThanEqual(at, size))) {
        return 0.0;
    }
    float z_scale;
    uint evals;
    float depth = 0.0;
#if MASU_HAS_RASTER
    depth = imageLoad(depth_image, ivec2(at)).r;
#endif
    ray r = pixel_ray(at, size, depth, z_scale);
    /* Cones ignore half-spaces, but the SDF here includes them. */
    uint part;
    start = min(start, masu_sdf_flat(world_at(r.direction, 0.0), r.direction, r.start, part));
    r.start = max(r.start, start);
    masu_hint_delta = 2.0 * max(frame.up.w / float(size.y), frame.right.w / float(size.x));
    masu_hint_free = start;
    masu_hint_open = true;
    float t = march(r, evals);
    if (t >= 0.0) {
        depth = write_hit(at, r, t, false, 0u, z_scale);
    }
    MASU_STORE_R32F(depth_image, at, depth);
    masu_count(MASU_COUNTER_SDF_EVALS, evals);
    return masu_hint_free;
}

void main()
{
    masu_count_begin();
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    uint tile = masu_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x];
    uint columns = masu_tile_grid(size).x;
    uvec2 corner = uvec2(tile % columns, tile / columns) * uint(MASU_TILE);
    masu_use_tile(tile, size);
    uvec2 me = gl_LocalInvocationID.xy * 2u;
    MASU_LOOP for (int i = 0; i < 2; i++) {
        uvec2 p = me + uvec2(uint(i));
        float start = texelFetch(cone_image, ivec2((corner + p) / 8u), 0).r;
        free_to[p.y][p.x] = march_pixel(corner + p, size, start);
    }
    barrier();
    MASU_LOOP for (int i = 0; i < 2; i++) {
        ivec2 p = ivec2(me) + ivec2(1 - i, i);
        float own = texelFetch(cone_image, (ivec2(corner) + p) / 8, 0).r;
        float start = own;
        MASU_LOOP for (int k = 0; k < 4; k++) {
            ivec2 q = p + ivec2(k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0);
            /* A neighbour's chain starts at the end of its block's cone. */
            if (all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, ivec2(EDGE))) &&
                texelFetch(cone_image, (ivec2(corner) + q) / 8, 0).r <= own) {
                start = max(start, free_to[q.y][q.x]);
            }
        }
        march_pixel(corner + uvec2(p), size, start);
    }
    masu_count_end();
}
