/*
 * march.comp: sphere tracing of the scene's SDF, limited by the raster depth; the nearer surface
 * wins. A hit becomes texels of the G-buffer, so that every later pass has one path.
 *
 * Four workgroups per active tile of 16x16 pixels (WorkGroupID.y), with the tile's list of parts. A
 * pixel starts where the cone of its 4x4 block stopped (cone.comp). Compiled by masu-bake together with the scene's field.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D cone_image;
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D albedo_image;
layout(set = MASU_SET_PASS, binding = 2, r32ui) uniform writeonly uimage2D normal_image;
layout(set = MASU_SET_PASS, binding = 3, r32f) uniform  image2D depth_image;

#define MASU_RELAXED
#define MASU_SDF_NO_FLAT
#include "sdf/hit.glsl"

void main()
{
    masu_count_begin();
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    uint tile = masu_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x];
    uint columns = masu_tile_grid(size).x;
    uvec2 corner = uvec2(tile % columns, tile / columns) * uint(MASU_TILE);
    uvec2 quarter = uvec2(gl_WorkGroupID.y & 1u, gl_WorkGroupID.y >> 1) * uint(MASU_GROUP);
    uvec2 at = corner + quarter + masu_block_at(gl_LocalInvocationIndex);
    bool listed = masu_use_tile(tile, size);
    if (all(lessThan(at, size))) {
        float z_scale;
        uint evals = 0u;
        float depth = 0.0;
#if MASU_HAS_RASTER
        depth = imageLoad(depth_image, ivec2(at)).r;
#endif
        ray r = pixel_ray(at, size, depth, z_scale);
        /* The nearest half-space ends the march. */
        uint part;
        float end = masu_sdf_flat(world_at(r.direction, 0.0), r.direction, r.start, part);
        bool ends = end < r.limit;
        r.limit = min(r.limit, end);
        r.start = max(r.start, texelFetch(cone_image, ivec2(at / 4u), 0).r);
        float t = -1.0;
        if (listed) {
            t = march(r, evals);
            ends = ends && !(t >= 0.0);
        }
        t = ends ? end : t;
        if (t >= 0.0) {
            depth = write_hit(at, r, t, ends, part, z_scale);
        }
        MASU_STORE_R32F(depth_image, at, depth);
        masu_count(MASU_COUNTER_SDF_EVALS, evals + (MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT ? 1u : 0u));
    }
    masu_count_end();
}
