/*
 * classify.comp: tile culling of SDF parts: lists the parts visible in each tile, and the tiles
 * with any parts. masu-bake compiles it with the scene's SDF.
 *
 * One workgroup per tile of 16x16 pixels. It copies raster depth to scene_depth (0 for background),
 * so that the march writes only pixels that it hits. A part is omitted from a tile's list if its
 * bounding sphere is outside one of the tile's four side planes, before the near plane or behind
 * the tile's farthest raster depth: no ray of the tile can hit it. Omitting a part makes steps
 * longer but changes no result. The list is in part order, regardless of the order in which
 * invocations run.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#define MASU_TILES_WRITTEN 1
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#if MASU_HAS_RASTER
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_WRITE 1
#else
#define MASU_FIRST_WRITE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE, r32f) uniform writeonly image2D depth_image;

#include "sdf/field.glsl"

#define MASKS ((MASU_SDF_LISTED_COUNT + 31) / 32 + (MASU_SDF_LISTED_COUNT == 0 ? 1 : 0))
#define INVOCATIONS (MASU_GROUP * MASU_GROUP)

shared uint farthest; /* bits of the least reverse-Z depth; positive floats order like their bits */
shared bool active_tile;
shared uint masks[MASKS];
shared vec3 planes[4];  /* the tile's side planes, through the camera */
shared bool sdf_seen, listed_seen; /* visibility of the bounds of the SDF, of the listed parts */

uvec2 pixel_of(uvec2 corner, int i)
{
    return corner + gl_LocalInvocationID.xy + uvec2(i & 1, i >> 1) * uint(MASU_GROUP);
}

#if MASU_HAS_RASTER
/* Copies the tile's raster depth to scene_depth. */
void take_depth(uvec2 corner, uvec2 size)
{
    float least = 1.0;
    for (int i = 0; i < 4; i++) {
        uvec2 at = pixel_of(corner, i);
        if (all(lessThan(at, size))) {
            float depth = texelFetch(raster_depth, ivec2(at), 0).r;
            least = min(least, depth);
            MASU_STORE_R32F(depth_image, at, depth);
        }
    }
    atomicMin(farthest, floatBitsToUint(least));
}
#else
/* Clears the depth of a tile that the march skips. */
void clear_depth(uvec2 corner, uvec2 size)
{
    for (int i = 0; i < 4; i++) {
        uvec2 at = pixel_of(corner, i);
        if (all(lessThan(at, size))) {
            MASU_STORE_R32F(depth_image, at, 0.0);
        }
    }
}
#endif

/* A side plane of the tile, through the camera, with its normal inwards. Half a pixel wider,
 * because the march stops a tenth of a pixel before a surface. */
vec3 tile_plane(uint i, uvec2 corner, uvec2 size)
{
    vec2 low = masu_ndc(vec2(corner) - 0.5, vec2(size));
    vec2 high = masu_ndc(vec2(corner + uint(MASU_TILE)) + 0.5, vec2(size));
    vec3 f = frame.forward.xyz;
    vec3 right = frame.right.xyz;
    vec3 down = -frame.up.xyz;
    vec3 side = i == 0u   ? right * low.x
                : i == 1u ? right * high.x
                : i == 2u ? down * low.y
                          : down * high.y;
    vec3 plane = masu_normalize(cross(f + side, i < 2u ? down : right), vec3(0.0));
    vec3 middle = f + right * (low.x + high.x) * 0.5 + down * (low.y + high.y) * 0.5;
    return dot(plane, middle) < 0.0 ? -plane : plane;
}

bool sphere_seen(vec4 sphere, float z_far)
{
    if (!(sphere.w >= 0.0)) {
        return true; /* unbounded, or NaN: kept */
    }
    vec3 c = sphere.xyz - frame.sdf_eye_hi.xyz - frame.sdf_eye_lo.xyz;
    /* Rounding of the centre and of the planes: a few ulp of the distances involved. */
    float radius = sphere.w + 16.0 * ulp * (length(c) + length(sphere.xyz) + sphere.w);
    float z = dot(c, frame.forward.xyz);
    bool outside = z + radius < frame.forward.w || z - radius > z_far;
    for (int i = 0; i < 4; i++) {
        outside = outside || dot(planes[i], c) < -radius;
    }
    return !outside;
}

/* Tests a box against the same planes, by its corner farthest along each normal. */
bool box_seen(vec3 low, vec3 high, float z_far)
{
    low = low - frame.sdf_eye_hi.xyz - frame.sdf_eye_lo.xyz;
    high = high - frame.sdf_eye_hi.xyz - frame.sdf_eye_lo.xyz;
    vec3 forward = frame.forward.xyz;
    float slack = 16.0 * ulp *
                  (length(frame.sdf_min.xyz) + length(frame.sdf_max.xyz) + length(low));
    vec3 near_corner = mix(low, high, lessThan(forward, vec3(0.0)));
    bool outside = dot(near_corner, forward) > z_far + slack;
    for (int i = 0; i < 4; i++) {
        vec3 corner = mix(low, high, greaterThan(planes[i], vec3(0.0)));
        outside = outside || dot(planes[i], corner) < -slack;
    }
    return !outside;
}

/* Half-spaces are in no list. The rate at which a ray approaches one is affine over the image: if
 * no corner ray of the tile hits it, no ray does. */
bool flat_parts_seen(uvec2 corner, uvec2 size)
{
    bool seen = false;
    for (int i = 0; i < 4; i++) {
        vec2 at = vec2(corner) + vec2(i & 1, i >> 1) * float(MASU_TILE);
        vec2 ndc = masu_ndc(at, vec2(size));
        vec3 through = frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
        uint part;
        seen = seen || masu_sdf_flat(world_at(through, 0.0), through, 0.0, part) < 1e30;
    }
    return seen;
}

void write_list(uint tile, uvec2 size, bool flat_seen)
{
    uvec2 grid = masu_tile_grid(size);
    uint stride = masu_list_stride();
    uint list = uint(MASU_TILES_HEADER) + grid.x * grid.y + tile * stride;
    uint count = 0u;
    for (int w = 0; w < MASKS; w++) {
        count += uint(bitCount(masks[w]));
    }
    active_tile = count > 0u || flat_seen;
    if (active_tile) {
        uint place = atomicAdd(masu_tiles_out[0], 1u);
        masu_tiles_out[uint(MASU_TILES_HEADER) + place] = tile;
    }
#if MASU_SDF_MASKED
    for (int w = 0; w < MASU_LIST_WORDS; w++) {
        masu_tiles_out[list + uint(w)] = w < MASKS ? masks[min(w, MASKS - 1)] : 0u;
    }
#else
    bool all_parts = count >= stride;
    masu_tiles_out[list] = all_parts ? MASU_TILE_ALL : count;
    if (all_parts || !active_tile) {
        return;
    }
    uint next = list + 1u;
    for (int w = 0; w < MASKS; w++) {
        uint bits = masks[w];
        for (int b = 0; b < 32; b++) {
            if (bits == 0u) {
                break;
            }
            masu_tiles_out[next] = uint(w) * 32u + masu_low_bit(bits);
            bits &= bits - 1u;
            next++;
        }
    }
#endif
}

void main()
{
    uint me = gl_LocalInvocationIndex;
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    uvec2 corner = gl_WorkGroupID.xy * uint(MASU_TILE);
    uint tile = gl_WorkGroupID.y * masu_tile_grid(size).x + gl_WorkGroupID.x;
    for (int w = 0; w < (MASKS + INVOCATIONS - 1) / INVOCATIONS; w++) {
        if (uint(w * INVOCATIONS) + me < uint(MASKS)) {
            masks[uint(w * INVOCATIONS) + me] = 0u;
        }
    }
    /* Values common to all parts are computed by few invocations. */
    if (me < 4u) {
        planes[me] = tile_plane(me, corner, size);
    }
    float least = 0.0;
#if MASU_HAS_RASTER
    if (me == 0u) {
        farthest = floatBitsToUint(1.0);
    }
    barrier();
    take_depth(corner, size);
    barrier();
    least = uintBitsToFloat(farthest);
#else
    barrier();
#endif
    float z_far = least > 0.0 ? frame.forward.w / least : 3e38;
    if (me == 0u) {
        sdf_seen = box_seen(frame.sdf_min.xyz, frame.sdf_max.xyz, z_far);
        vec3 low, high;
        masu_listed_box(low, high);
        listed_seen = box_seen(low, high, z_far);
    }
    barrier();
    if (me < max(uint(MASU_SDF_LISTED_COUNT), 1u) && listed_seen) {
        for (int i = 0; i < (MASU_SDF_LISTED_COUNT + INVOCATIONS - 1) / INVOCATIONS; i++) {
            uint part = uint(i * INVOCATIONS) + me;
            if (part < uint(MASU_SDF_LISTED_COUNT) && sphere_seen(masu_sdf_bounds(part), z_far)) {
                atomicOr(masks[part >> 5], 1u << (part & 31u));
            }
        }
    }
    barrier();
    if (me == 0u) {
        write_list(tile, size, sdf_seen && flat_parts_seen(corner, size));
    }
#if !MASU_HAS_RASTER
    barrier();
    if (!active_tile) {
        clear_depth(corner, size);
    }
#endif
}
