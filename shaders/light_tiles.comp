/*
 * light_tiles.comp: tiled light culling: lists the punctual lights that can reach a surface of each
 * tile. One workgroup per tile of 16x16 pixels; the list of a tile without surfaces is empty.
 *
 * A light is culled if its bounding sphere is
 *   - before the nearest or behind the farthest surface of the tile, or between the two at depths
 *     where the tile has no surface (32 slices of the logarithm of depth; Harada, "A 2.5D culling
 *     for forward+", SIGGRAPH Asia 2012 technical briefs),
 *   - outside one of the tile's four side planes, or outside the bounds of the frustum piece
 *     between the two depths: plane tests by themselves keep lights near a corner,
 * or if its cone misses the sphere around these bounds.
 *
 * With transparent surfaces in front (push.blended), the depth range of a tile is from the near
 * plane to its farthest surface, or unlimited if the tile contains sky.
 *
 * The culling is conservative: the host enlarges the bounding spheres by more than all rounding
 * here and in lights.glsl, and the planes are half a pixel outside of all pixel centres. A culled
 * light contributes exactly 0 to every pixel.
 *
 * Lists are in ascending order, regardless of the order in which invocations run. If a list would
 * exceed MASU_TILE_LIGHTS_MAX, its count is MASU_TILE_ALL: slower, with the same result.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/light_tiles.h"
#include "shared/counters.h"
#include "shared/lights.h"
#include "shared/sdf_limits.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#define MASU_LIGHT_TILES_WRITTEN 1
#include "light/lights.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;

#define INVOCATIONS (MASU_GROUP * MASU_GROUP)
#define WORDS (MASU_LOCAL_LIGHTS_MAX / 32)

/* Bits of view depths: they order like positive floats and grow with the logarithm. */
shared uint nearest;
shared uint farthest;
shared uint slices; /* slices with a surface */
shared uint kept[WORDS];

/* Farther than any light reaches; its square is a float. */
const float end_of_world = 1e17;

/* The piece of the tile's frustum that has surfaces. View space: x right, y down, z ahead. */
struct piece {
    vec2 low, high;           /* slopes x / z, y / z of the side planes */
    vec2 low_unit, high_unit; /* 1 / length of (1, slope) */
    vec3 box_low, box_high;
    float z_near, z_far;
    uint first, shift, filled; /* slice of a depth: (bits - first) >> shift */
};

uint slice_of(float z, uint first, uint shift)
{
    return min((floatBitsToUint(z) - first) >> shift, 31u);
}

piece make_piece(uvec2 corner, uvec2 size)
{
    piece p;
    vec2 tangent = vec2(frame.right.w, frame.up.w);
    p.low = masu_ndc(vec2(corner), vec2(size)) * tangent;
    p.high = masu_ndc(vec2(corner + uint(MASU_TILE)), vec2(size)) * tangent;
    p.low_unit = 1.0 / sqrt(1.0 + p.low * p.low);
    p.high_unit = 1.0 / sqrt(1.0 + p.high * p.high);
    p.z_near = uintBitsToFloat(nearest);
    p.z_far = uintBitsToFloat(farthest);
    p.box_low = vec3(min(p.low * p.z_near, p.low * p.z_far), p.z_near);
    p.box_high = vec3(max(p.high * p.z_near, p.high * p.z_far), p.z_far);
    p.first = nearest;
    /* Divides the range of bits into at most 32 steps of a power of two. */
    uint span = farthest - nearest;
    p.shift = uint(max(findMSB(span) - 4, 0));
    p.filled = 0u;
    return p;
}

vec3 to_view(vec3 v)
{
    return vec3(dot(v, frame.right.xyz) / frame.right.w, -dot(v, frame.up.xyz) / frame.up.w,
                dot(v, frame.forward.xyz));
}

/* With NaN the comparisons keep the light. */
bool sphere_misses(vec3 c, float radius, piece p)
{
    vec2 inside_low = (c.xy - p.low * c.z) * p.low_unit;
    vec2 inside_high = (p.high * c.z - c.xy) * p.high_unit;
    if (any(lessThan(inside_low, vec2(-radius))) || any(lessThan(inside_high, vec2(-radius))) ||
        c.z + radius < p.z_near || c.z - radius > p.z_far) {
        return true;
    }
    vec3 outside = max(max(p.box_low - c, c - p.box_high), vec3(0.0));
    if (dot(outside, outside) > radius * radius) {
        return true;
    }
    float from = max(c.z - radius, p.z_near);
    float to = min(c.z + radius, p.z_far);
    if (!(from <= to)) {
        return false;
    }
    uint mask = (0xFFFFFFFFu >> (31u - slice_of(to, p.first, p.shift))) &
                (0xFFFFFFFFu << slice_of(from, p.first, p.shift));
    return (mask & p.filled) == 0u;
}

/* Tests against the cone's tangent plane on the side of the sphere's centre: a cone no wider than a
 * half-space is behind it. (The square root of |v|^2 - (v.axis)^2 would lose half of its digits
 * along the axis; the cross product loses none.) */
bool cone_misses(masu_punctual_light_data light, piece p)
{
    if (!(light.cone.z > 0.0) || masu_light_kind(light) != MASU_KIND_POINT) {
        return false; /* wider than a half-space, or no cone */
    }
    vec3 center = 0.5 * (p.box_low + p.box_high);
    vec3 apex = to_view(light.position.xyz);
    vec3 axis = to_view(light.axis.xyz);
    vec3 v = center - apex;
    float slack = (length(center) + length(apex) + light.bound.w) * (1.0 / 131072.0);
    float radius = 0.50001 * length(p.box_high - p.box_low) + slack;
    return light.cone.z * length(cross(v, axis)) - light.cone.y * dot(v, axis) > radius;
}

void write_list(uint list)
{
    uint count = 0u;
    uint words = (masu_light_count() + 31u) / 32u;
    for (uint w = 0u; w < uint(WORDS); w++) {
        if (w >= words) {
            break;
        }
        count += uint(bitCount(kept[w]));
    }
    bool all_lights = count > uint(MASU_TILE_LIGHTS_MAX);
    masu_light_tiles[list] = all_lights ? MASU_TILE_ALL : count;
    masu_count(MASU_COUNTER_LIGHT_TILES_FULL, all_lights ? 1u : 0u);
    if (all_lights) {
        return;
    }
    uint next = list + 1u;
    for (uint w = 0u; w < uint(WORDS); w++) {
        if (w >= words) {
            break;
        }
        uint bits = kept[w];
        for (int b = 0; b < 32; b++) {
            if (bits == 0u) {
                break;
            }
            masu_light_tiles[next] = w * 32u + masu_low_bit(bits);
            bits &= bits - 1u;
            next++;
        }
    }
}

void main()
{
    masu_count_begin();
    uint me = gl_LocalInvocationIndex;
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    uvec2 corner = gl_WorkGroupID.xy * uint(MASU_TILE);
    for (uint w = 0u; w < uint((WORDS + INVOCATIONS - 1) / INVOCATIONS); w++) {
        if (w * uint(INVOCATIONS) + me < uint(WORDS)) {
            kept[w * uint(INVOCATIONS) + me] = 0u;
        }
    }
    if (me == 0u) {
        nearest = 0xFFFFFFFFu;
        farthest = 0u;
        slices = 0u;
    }
    barrier();
    /* Non-finite depth is lit by no light: lights.glsl. */
    float z[4];
    bool there[4];
    uint low = 0xFFFFFFFFu;
    uint high = 0u;
    for (int i = 0; i < 4; i++) {
        uvec2 at = corner + gl_LocalInvocationID.xy + uvec2(i & 1, i >> 1) * uint(MASU_GROUP);
        float depth = 0.0;
        if (all(lessThan(at, size))) {
            depth = texelFetch(depth_image, ivec2(at), 0).r;
        }
        z[i] = masu_light_depth(depth);
        there[i] = depth > 0.0 && masu_finite(z[i]);
        if (there[i]) {
            low = min(low, floatBitsToUint(z[i]));
            high = max(high, floatBitsToUint(z[i]));
        } else if (push.blended != 0u && all(lessThan(at, size))) {
            high = floatBitsToUint(end_of_world);
        }
    }
    if (push.blended != 0u) {
        low = floatBitsToUint(masu_light_depth(1.0));
    }
    if (low <= high) {
        atomicMin(nearest, low);
        atomicMax(farthest, high);
    }
    barrier();
    bool any_surface = nearest <= farthest;
    piece p = make_piece(corner, size);
    if (any_surface) {
        uint mine = 0u;
        for (int i = 0; i < 4; i++) {
            mine |= there[i] ? 1u << slice_of(z[i], p.first, p.shift) : 0u;
        }
        if (mine != 0u) {
            atomicOr(slices, mine);
        }
    }
    barrier();
    if (any_surface) {
        p.filled = push.blended != 0u ? 0xFFFFFFFFu : slices;
        uint count = masu_light_count();
        for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX / INVOCATIONS); i++) {
            uint n = i * uint(INVOCATIONS) + me;
            if (n >= count) {
                break;
            }
            masu_punctual_light_data light = masu_lights[n];
            vec3 c = to_view(light.bound.xyz);
            if (!sphere_misses(c, light.bound.w, p) && !cone_misses(light, p)) {
                atomicOr(kept[n >> 5], 1u << (n & 31u));
            }
        }
    }
    barrier();
    if (me == 0u) {
        write_list(masu_light_list(gl_WorkGroupID.xy, size));
    }
    masu_count_end();
}
