/*
 * sdf_velocity.comp: motion vectors of SDF pixels and of the sky. masu-bake compiles it with the
 * scene's SDF.
 *
 * If no listed part of the tile, or of the span of the 4x4 block in which the ray ends, is dynamic,
 * the motion is the camera's only. Otherwise the pixel belongs to the nearest part, which may be
 * static too. For a dynamic part, the previous position of the point is found in two steps:
 *
 *   1. The part's root transform (translations, rotations and scales around the whole part) maps
 *      the point to part space with the present slots, and back with the previous ones. For rigid
 *      or scaled parts this is the full motion.
 *   2. The rest is a change of the SDF itself: a radius, a morph, a blend. The part's SDF f at the
 *      present point and the previous SDF f' at the point of step 1 differ by the motion of the
 *      surface along its normal. Steps of (f' - f) / |grad f'| undo it. A point of a deforming
 *      surface has no unique previous position: the one along the normal is the closest.
 *
 * f is compared with f' rather than with 0: the march stops a little before the surface, and this
 * gap is not motion. An unchanged SDF is evaluated twice by the same code and gives exactly 0.
 *
 * push.listed: 0: all parts; 1: the tile lists are valid; 2: the lists of 4x4 blocks are valid too.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define MASU_MOTION 1
#include "push/sdf_velocity.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#if MASU_HAS_RASTER
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_IMAGE 1
#else
#define MASU_FIRST_IMAGE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 1, rgba16f)
    uniform writeonly image2D velocity_image;

#define MASU_SDF_ASK
#define MASU_SPAN_BEFORE true
#define MASU_SPAN_TILE own_tile
uint own_tile;
#include "sdf/spans.glsl"
#include "shared/motion.glsl"

/* Previous position of p by the part's root transform. */
vec3 carried(uint part, vec3 p)
{
    vec3 own = masu_sdf_root(part, p, false);
    vec3 places[2];
    MASU_LOOP for (int i = 0; i < 2; i++) {
        masu_before = i == 1;
        places[i] = masu_sdf_root(part, own, true);
    }
    masu_before = false;
    vec3 q = p + (places[1] - places[0]);
    return masu_finite(q) ? q : p;
}

#define ROUNDS 2
#define SAMPLES (1 + 5 * ROUNDS)

/* One loop over all samples, so that the SDF is compiled once: the present SDF at p, then in each
 * iteration the previous SDF at q and at the corners of a tetrahedron around q. */
vec3 followed(uint part, vec3 p, vec3 q, float h, float enough)
{
    float now = 0.0;
    float residue = 0.0;
    vec3 slope = vec3(0.0);
    MASU_LOOP for (int i = 0; i < SAMPLES; i++) {
        int k = (i + 4) % 5; /* 0: at q; 1 to 4: corners */
        vec3 corner = vec3(k == 2 || k == 4 ? 1.0 : -1.0, k >= 3 ? 1.0 : -1.0,
                           k == 1 || k == 4 ? 1.0 : -1.0);
        masu_before = i > 0;
        float f = masu_sdf_part(part, i == 0 ? p : k == 0 ? q : q + corner * h);
        if (i == 0) {
            now = f;
        } else if (k == 0) {
            residue = f - now;
            slope = vec3(0.0);
            if (!(abs(residue) > enough)) {
                break; /* static, or NaN */
            }
        } else {
            slope += corner * (f / (4.0 * h));
        }
        if (i > 0 && k == 4) {
            vec3 step = slope * (residue * masu_rcp(dot(slope, slope)));
            q = masu_finite(step) ? q - step : q;
        }
    }
    masu_before = false;
    return q;
}

/* Whether any listed part is dynamic. */
bool any_moves()
{
#if !MASU_SDF_MOVING
    return false;
#elif MASU_SDF_MOVING_FLAT
    return true;
#elif MASU_SDF_MASKED
    uint moving = 0u;
    for (int w = 0; w < MASU_LIST_WORDS; w++) {
        moving |= masu_list_bits[w] & masu_sdf_moving_bits(w);
    }
    return moving != 0u;
#else
    uint count = masu_part_count();
    MASU_LOOP for (uint i = 0u; i < uint(MASU_SDF_LISTED_COUNT); i++) {
        if (i >= count) {
            break;
        }
        if (masu_sdf_part_moves(masu_part_at(i))) {
            return true;
        }
    }
    return false;
#endif
}

/* Motion of the part under a pixel, present to previous frame, in a tile with a dynamic part. z: t
 * along the view direction. */
vec3 part_step(uvec2 at, uvec2 size, vec3 direction, float t, float z)
{
    if (push.listed == 2u) {
        span_begin(at, size, t);
        if (!any_moves()) {
            return vec3(0.0);
        }
    }
    vec3 p = world_at(direction, t);
    uint part = masu_sdf_nearest(p);
    if (!masu_sdf_part_moves(part)) {
        return vec3(0.0);
    }
    masu_list_bits = uint[](0xFFFFFFFFu, 0xFFFFFFFFu); /* earlier, others may have mattered */
    vec3 a = abs(p);
    float pixel = 2.0 * frame.up.w / float(size.y) * z;
    float extent = ulp * max(max(a.x, max(a.y, a.z)), t);
    return followed(part, p, carried(part, p), max(0.25 * pixel, 64.0 * extent),
                    max(1e-3 * pixel, 8.0 * extent)) -
           p;
}

/* Velocity of the surface at a pixel. depth: above 0. */
vec4 surface_velocity(uvec2 at, uvec2 size, float depth)
{
    vec3 through = masu_pixel_ray(at, size);
    float z = frame.forward.w / depth;
    own_tile = masu_tile_of(at, size);
    if (push.listed != 0u) {
        masu_use_tile(own_tile, size);
    }
    vec3 moved = vec3(0.0);
    if (any_moves()) {
        float z_scale = length(through);
        moved = part_step(at, size, through / z_scale, z * z_scale, z);
    }
    return masu_point_velocity(through, z, moved, vec2(size));
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        bool polygon = false;
#if MASU_HAS_RASTER
        polygon = depth > 0.0 && depth == texelFetch(raster_depth, ivec2(at), 0).r;
#endif
        if (!polygon) {
            vec4 velocity = masu_sky_velocity(at, size);
            if (depth > 0.0) {
                velocity = surface_velocity(at, size, depth);
            }
            MASU_STORE_HALF(velocity_image, at, velocity);
        }
    }
    masu_count_end();
}
