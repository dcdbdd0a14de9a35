/*
 * march.comp: sphere tracing of the scene's SDF, limited by the raster depth; the closer surface
 * wins. A hit is written to the G-buffer, so that later passes treat it like a rasterized pixel.
 *
 * One workgroup per active tile of 16x16 pixels, with the tile's list of parts; each invocation
 * begins and ends four pixels. A pixel starts where the cone of its 4x4 block stopped (cone.comp).
 * Compiled by masu-bake together with the scene's field.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/march.h"
#include "shared/counters.h"
#include "shared/sdf_limits.h"
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
#define MASU_SDF_KEEP
#define MASU_CHOOSING (push.all_terms == 0u)
#define MASU_SDF_NO_FLAT
#define MASU_SPAN_BEFORE false
#define MASU_SPAN_TILE masu_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x]
#include "sdf/spans.glsl"
#include "sdf/hit.glsl"

/* Any invocation of the tile may take any of its rays, not only its own four. */
layout(constant_id = 10) const bool share_rays = false;

#define INVOCATIONS (MASU_GROUP * MASU_GROUP)
#define RAYS (MASU_TILE * MASU_TILE)

/* Per pixel of the tile. ray_start: minus the start distance, then the hit distance, below 0 for a
 * miss; ray_limit: the end distance; ray_flat: the distance of a half-space, or -1. */
shared float ray_start[RAYS];
shared float ray_limit[RAYS];
shared float ray_flat[RAYS];
shared uint taken; /* rays that invocations have fetched */

uint tile;
uvec2 size;

/* Position of pixel i in the tile: one 8x8 block after the other. */
uvec2 place_of(uint i)
{
    return masu_block_at(i & uint(INVOCATIONS - 1)) + (uvec2(i >> 6 & 1u, i >> 7) << 3u);
}

/* Column and row of a tile by float division. Exact: there are at most 2^20 tiles, 1024 in a row,
 * and the rounding error is smaller than the added half tile. */
uvec2 tile_at(uint columns)
{
    uint row = uint((float(tile) + 0.5) / float(columns));
    return uvec2(tile - row * columns, row);
}

/* First pixel of the tile. Recomputed where a ray begins, like everything that depends on it: kept,
 * it would take registers from the march, and only AMD's compilers have scalar ones for it. */
uvec2 corner_of()
{
    uvec2 at = tile_at(masu_tile_grid(size).x);
    return at * uint(MASU_TILE);
}

/* Rejected: the direction of the first pixel plus increments per column and row. At the horizon of
 * a plane 1e5 units long the depth error was 2.3e-6 instead of 1e-6. */
ray ray_of(uvec2 corner, uvec2 place, out float z_scale)
{
    vec2 ndc_step = 2.0 / vec2(size);
    vec2 ndc = masu_ndc(vec2(corner) + 0.5, vec2(size)) + ndc_step * vec2(place);
    vec3 through = frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
    /* Rejected: one inversesqrt for both. At the horizon of a plain, half of the depths had an
     * error of 1.11e-7 instead of 0.84e-7. */
    z_scale = length(through);
    float inverse = 1.0 / z_scale;
    return ray(through * inverse, frame.up.w * ndc_step.y * inverse, 0.0, 0.0);
}

/* Bounds of the listed parts relative to the camera. The SDF's bounds are not stored as well: on
 * Vega the values shared by all rays already use all registers, and more would spill. */
vec3 box_low, box_high;

void look_at_boxes()
{
    masu_listed_box(box_low, box_high);
    box_low = box_low - eye_hi - eye_lo;
    box_high = box_high - eye_hi - eye_lo;
}

/* Distances at which the ray enters and leaves a box. */
vec2 within(vec3 low, vec3 high, vec3 inverse)
{
    vec3 a = low * inverse;
    vec3 b = high * inverse;
    vec3 enter = min(a, b);
    vec3 leave = max(a, b);
    return vec2(max(enter.x, max(enter.y, enter.z)), min(leave.x, min(leave.y, leave.z)));
}

/* Distance at which the cone of the pixel's 4x4 block stopped. */
float cone_end(uvec2 at)
{
#if MASU_SDF_BLOCK_WORDS > 0
    return uintBitsToFloat(masu_tiles[span_word(at, size)]);
#else
    return texelFetch(cone_image, ivec2(at >> 2u), 0).r;
#endif
}

/* Start and end distance of a pixel's ray, and the distance of the half-space that ends it, or -1.
 * The same as pixel_ray and clip_to_box, from values that the four pixels share. Zero components of
 * the direction are replaced by 1e-12. */
vec3 prepare(uvec2 corner, uvec2 place)
{
    uvec2 at = corner + place;
    float z_scale;
    ray r = ray_of(corner, place, z_scale);
    vec3 inverse = 1.0 / mix(r.direction, vec3(1e-12), lessThan(abs(r.direction), vec3(1e-12)));
    vec2 bounds = within(frame.sdf_low.xyz, frame.sdf_high.xyz, inverse);
    float nearest = frame.forward.w * z_scale;
    /* Half-spaces start at the SDF's bounds, which contain the box of the listed parts. */
    float first_t = MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT ? max(nearest, bounds.x) : nearest;
    float last_t = min(frame.sdf_max.w, bounds.y);
#if MASU_HAS_RASTER
    float depth = imageLoad(depth_image, ivec2(at)).r;
    last_t = depth > 0.0 ? min(last_t, nearest / depth) : last_t; /* a tie goes to the raster */
#endif
    uint part;
    float end = masu_sdf_flat(eye_hi + eye_lo, r.direction, first_t, part);
    float farthest = min(last_t, end);
    vec2 box = within(box_low, box_high, inverse);
    /* A surface on the far side of the box may be found slightly behind it. */
    last_t = min(min(last_t, box.y) * (1.0 + newton_reach * r.pixel), farthest);
    first_t = max(max(first_t, box.x), cone_end(at));
    return vec3(first_t, last_t, end <= farthest && end < 1e30 ? end : -1.0);
}

void begin_spans(uvec2 at, float t)
{
    span_begin(min(at, size - 1u), size, t);
}

/* Evaluates the SDF at t with the terms of the span that contains t. Rejected: each ray selects its
 * terms in a ball around its second sample. It evaluated fewer terms, but the selection cost as
 * much as it saved (time: engine 1.00, city 1.03, rods 1.06). */
float field_here(ray r, float t)
{
    span_follow(t, size);
    return field_at(r, t);
}

/* The next ray after i that has an interval to march, at step 0 the invocation's first; RAYS or
 * more if there is none, or if too few steps remain to march it to its end. */
uint take(uint i, int step)
{
    MASU_LOOP for (int k = 0; k < RAYS; k++) {
        bool first = step == 0 && k == 0;
        i = first         ? gl_LocalInvocationIndex
            : !share_rays ? i + uint(INVOCATIONS)
                          : atomicAdd(taken, 1u);
        if (i >= uint(RAYS) || ray_limit[i] > 0.0) {
            break;
        }
    }
    return step <= 3 * MASU_MARCH_STEPS_MAX || !share_rays ? i : uint(RAYS);
}

march_state begin(uint i, out ray r)
{
    float z_scale;
    uvec2 corner = corner_of(), place = place_of(i);
    r = ray_of(corner, place, z_scale);
    r.start = -ray_start[i];
    r.limit = ray_limit[i];
    begin_spans(corner + place, r.start);
    return march_begin(r);
}

/* Marches all rays in one loop: an invocation that has finished a ray fetches the next, instead of
 * waiting for the slowest ray of its subgroup, which took 1.2 to 1.9 times the mean number of
 * steps. Steps of the slowest invocation over the mean (engine), for 8, 16 and 64 lanes: 1.4, 1.6,
 * 2.2 with four rays per invocation; 1.2, 1.4, 1.8 with share_rays. The invocation that marches a
 * ray varies between runs, the result does not. CPU drivers gain little from share_rays and pay for
 * the barrier: 1.1 to 1.4 times the time of the march. */
uint march_all()
{
    uint i = 0u;
    ray r = ray(vec3(0.0), 0.0, 0.0, 0.0);
    march_state m = march_begin(r); /* done */
    int step = 0;
    MASU_LOOP for (; step < 4 * MASU_MARCH_STEPS_MAX; step++) {
        if (m.done) {
            i = take(i, step);
            if (i >= uint(RAYS)) {
                break;
            }
            m = begin(i, r);
        }
        march_step(m, r, field_here(r, m.t));
        if (m.done) {
            ray_start[i] = m.t;
        }
    }
    return uint(step);
}

void main()
{
    masu_count_begin();
    tile = masu_tiles[uint(MASU_TILES_HEADER) + gl_WorkGroupID.x];
    size = uvec2(pc.output_width, pc.output_height);
    look_at_boxes();
    if (gl_LocalInvocationIndex == 0u) {
        taken = uint(INVOCATIONS);
    }
    /* Pixels outside the image march nothing. */
    MASU_LOOP for (int k = 0; k < 4; k++) {
        uint i = gl_LocalInvocationIndex + uint(k * INVOCATIONS);
        uvec2 corner = corner_of(), place = place_of(i);
        vec3 piece = vec3(-1.0);
        /* In the loop: the bits of the list would take registers until the end. */
        bool listed = masu_use_tile(tile, size);
        if (all(lessThan(corner + place, size))) {
            piece = prepare(corner, place);
        }
        /* A ray without an interval is already finished, as a miss. */
        bool any = listed && piece.x < piece.y;
        ray_start[i] = any ? -piece.x : -1.0;
        ray_limit[i] = any ? piece.y : -1.0;
        ray_flat[i] = piece.z;
    }
    if (share_rays) {
        barrier();
    }
    masu_count(MASU_COUNTER_SDF_EVALS, march_all());
    if (share_rays) {
        barrier();
    }
    MASU_LOOP for (int k = 0; k < 4; k++) {
        uint i = gl_LocalInvocationIndex + uint(k * INVOCATIONS);
        uvec2 corner = corner_of(), place = place_of(i);
        uvec2 at = corner + place;
        float t = ray_start[i];
        bool known = !(t >= 0.0);
        t = known ? ray_flat[i] : t; /* -1 outside the image */
        if (t >= 0.0) {
            float z_scale;
            ray r = ray_of(corner, place, z_scale);
            uint part = uint(MASU_SDF_LISTED_COUNT); /* half-spaces are the last */
            if (known && MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT + 1) {
                masu_sdf_flat(eye_hi + eye_lo, r.direction, t, part);
            } else if (!known) {
                begin_spans(at, t);
            }
            MASU_STORE_SAFE(depth_image, at, vec4(write_hit(at, r, t, known, part, z_scale)));
        }
#if !MASU_HAS_RASTER
        else if (all(lessThan(at, size))) {
            MASU_STORE_SAFE(depth_image, at, vec4(0.0));
        }
#endif
        masu_count(MASU_COUNTER_SDF_EVALS,
                   MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT && all(lessThan(at, size)) ? 1u
                                                                                          : 0u);
    }
    masu_count_end();
}
