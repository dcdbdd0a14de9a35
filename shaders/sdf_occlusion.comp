/*
 * sdf_occlusion.comp: visibility of the sun and of ambient light past the SDF, for SDF and polygon
 * surfaces. Runs between the march and lighting. masu-bake compiles it with the scene's SDF for
 * scenes that request shadows or ambient occlusion (sdf_options.glsl specifies which, and their
 * range).
 *
 * The tile lists contain only the parts that are visible in a tile; a shadow caster may be outside
 * the image. So each block of 8x8 pixels builds its own lists in shared memory. Its surface points
 * are within k t of the segment [t0, t1] of its centre ray. A part is culled if its bounding sphere
 * is outside the queried region around these points. For shadows this region is the strip that the
 * segment's rays to the sun sweep: a part is culled if its distance from the strip's plane, or from
 * the ray of the segment's centre, exceeds the radii. For ambient occlusion the region is the ball
 * around the segment. Half-spaces are in neither list and are always evaluated. A culled part makes
 * steps longer but changes no result.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/sdf_occlusion.h"
#include "shared/counters.h"
#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "sdf_options.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 2, r32ui) uniform writeonly uimage2D occlusion_image;

/* Capacity of each of the two lists; a longer list becomes "all parts". Scenes with few parts use
 * bit masks, as in the tile lists, and need no list. */
#define LIST_MOST 255
#define MASU_OWN_PARTS (2 * LIST_MOST)
#include "sdf/field.glsl"
#include "sdf/occlusion.glsl"

#define SUN 0
#define AMBIENT 1
/* Half-spaces, the last parts, are in no list: they are always evaluated. */
#define MASKS ((MASU_SDF_LISTED_COUNT + 31) / 32 + (MASU_SDF_LISTED_COUNT == 0 ? 1 : 0))
#define INVOCATIONS (MASU_GROUP * MASU_GROUP)

shared uint nearest[2]; /* bits of distances; positive floats order like their bits */
shared uint farthest[2];
shared uint masks[2 * MASKS];

/* Bounds of the surface points of a block. */
struct block {
    vec3 middle; /* direction of the centre ray, unit */
    float k;     /* largest distance of the other rays from it, at distance 1 */
    float offset; /* at distance 1, at most */
};

block block_of(uvec2 corner, uvec2 size)
{
    block b;
    vec2 ndc = masu_ndc(vec2(corner) + 0.5 * float(MASU_GROUP), vec2(size));
    vec3 through = frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
    b.middle = through / length(through);
    float pixel = 2.0 * max(frame.up.w / float(size.y), frame.right.w / float(size.x));
    b.k = float(MASU_GROUP) * 0.70711 * pixel;
    b.offset = pixel;
    return b;
}

float slack_of(vec4 sphere, float t1)
{
    vec3 a = abs(frame.sdf_eye_hi.xyz);
    return 64.0 * ulp * (length(sphere.xyz) + sphere.w + max(a.x, max(a.y, a.z)) + t1);
}

/* Whether the sphere may touch a ray from the block's points to the sun's disc. */
bool in_sunlight(vec4 sphere, block b, float t0, float t1)
{
#if MASU_SHADOWS
    vec3 towards = frame.sun_direction.xyz;
    vec3 c = sphere.xyz - frame.sdf_eye_hi.xyz - frame.sdf_eye_lo.xyz;
    float reach = sphere.w + (b.k + b.offset) * t1 + slack_of(sphere, t1);
    vec3 from = c - b.middle * (0.5 * (t0 + t1));
    float half_length = 0.5 * (t1 - t0);
    /* The rays to the disc spread up to the farthest point from which they can touch the sphere: u
     * <= along + reach + w u. */
    float along = dot(from, towards);
    float highest = max(along + reach + half_length, 0.0) / (1.0 - sun_tangent);
    reach += sun_tangent * min(highest, MASU_SHADOW_DISTANCE);
    vec3 axis = masu_normalize(cross(b.middle, towards), vec3(0.0));
    bool off_plane = abs(dot(from, axis)) > reach;
    vec3 across = from - towards * along;
    float wide = reach + half_length;
    bool off_ray = dot(across, across) > wide * wide;
    bool behind = along < -wide || along > MASU_SHADOW_DISTANCE + wide;
    return !(off_plane || off_ray || behind);
#else
    return false;
#endif
}

/* Whether the sphere may touch the points themselves. */
bool in_surroundings(vec4 sphere, block b, float t0, float t1)
{
#if MASU_AMBIENT_OCCLUSION
    vec3 c = sphere.xyz - frame.sdf_eye_hi.xyz - frame.sdf_eye_lo.xyz;
    float slack = slack_of(sphere, t1);
    float around = max(MASU_AO_RADIUS, max(4.0 * b.offset * t1, slack));
    float reach = sphere.w + b.k * t1 + around + slack;
    vec3 from = c - b.middle * clamp(dot(c, b.middle), t0, t1);
    return !(dot(from, from) > reach * reach);
#else
    return false;
#endif
}

/* Builds both lists. All invocations of the group call it, with the distance of their surface along
 * its ray, or a negative number. */
void make_lists(block b, float sunny, float there)
{
    uint me = gl_LocalInvocationIndex;
    if (me < 2u) {
        nearest[me] = 0x7F7FFFFFu;
        farthest[me] = 0u;
    }
    for (int w = 0; w < (2 * MASKS + INVOCATIONS - 1) / INVOCATIONS; w++) {
        if (uint(w * INVOCATIONS) + me < uint(2 * MASKS)) {
            masks[uint(w * INVOCATIONS) + me] = 0u;
        }
    }
    barrier();
    if (sunny >= 0.0) {
        atomicMin(nearest[SUN], floatBitsToUint(sunny));
        atomicMax(farthest[SUN], floatBitsToUint(sunny));
    }
    if (there >= 0.0) {
        atomicMin(nearest[AMBIENT], floatBitsToUint(there));
        atomicMax(farthest[AMBIENT], floatBitsToUint(there));
    }
    barrier();
    vec4 range =
        uintBitsToFloat(uvec4(nearest[SUN], farthest[SUN], nearest[AMBIENT], farthest[AMBIENT]));
    for (int i = 0; i < (MASU_SDF_LISTED_COUNT + INVOCATIONS - 1) / INVOCATIONS; i++) {
        uint part = uint(i * INVOCATIONS) + me;
        if (part >= uint(MASU_SDF_LISTED_COUNT)) {
            break;
        }
        vec4 sphere = masu_sdf_bounds(part);
        bool bounded = sphere.w >= 0.0; /* false: unbounded, or NaN: kept */
        uint bit = 1u << (part & 31u);
        if (range.x <= range.y && (!bounded || in_sunlight(sphere, b, range.x, range.y))) {
            atomicOr(masks[part >> 5], bit);
        }
        if (range.z <= range.w && (!bounded || in_surroundings(sphere, b, range.z, range.w))) {
            atomicOr(masks[uint(MASKS) + (part >> 5)], bit);
        }
    }
    barrier();
#if !MASU_SDF_MASKED
    /* Each mask is written by one invocation, after the parts of the preceding masks: ascending
     * order. */
    for (int i = 0; i < (2 * MASKS + INVOCATIONS - 1) / INVOCATIONS; i++) {
        uint word = uint(i * INVOCATIONS) + me;
        if (word >= uint(2 * MASKS)) {
            break;
        }
        uint first = word < uint(MASKS) ? 0u : uint(MASKS);
        uint place = 0u;
        for (int w = 0; w < MASKS; w++) {
            if (first + uint(w) >= word) {
                break;
            }
            place += uint(bitCount(masks[first + uint(w)]));
        }
        uint bits = masks[word];
        for (int k = 0; k < 32; k++) {
            if (bits == 0u || place >= uint(LIST_MOST)) {
                break;
            }
            masu_own_parts[(first == 0u ? 0u : uint(LIST_MOST)) + place] =
                (word - first) * 32u + masu_low_bit(bits);
            bits &= bits - 1u;
            place++;
        }
    }
    barrier();
#endif
}

/* Restricts the SDF to one of the two lists, for all later evaluations. */
void use_list(uint which)
{
#if MASU_SDF_MASKED
    for (int w = 0; w < MASU_LIST_WORDS; w++) {
        uint bits = w < MASKS ? masks[which * uint(MASKS) + uint(min(w, MASKS - 1))] : 0u;
        masu_list_bits[w] = bits;
    }
#else
    uint count = 0u;
    for (int w = 0; w < MASKS; w++) {
        count += uint(bitCount(masks[which * uint(MASKS) + uint(w)]));
    }
    masu_list_count = count > uint(LIST_MOST) ? MASU_TILE_ALL : count;
    masu_list_first = which * uint(LIST_MOST);
#endif
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    float depth = 0.0;
    uint texel = 0u;
    if (all(lessThan(at, size))) {
        depth = texelFetch(depth_image, ivec2(at), 0).r;
        texel = texelFetch(normal_image, ivec2(at), 0).r;
    }
    bool there = depth > 0.0 && !masu_is_unlit_texel(texel);
    vec3 through = masu_pixel_ray(at, size);
    vec3 place = there ? through * (frame.forward.w / depth) : vec3(0.0);
    vec3 normal = masu_unpack_normal(texel);
    float pixel = 2.0 * frame.up.w / float(size.y) / length(through);
    lit_point p = lit_point_at(place, normal, pixel);
    there = there && masu_finite(place);
    float n_l = dot(normal, frame.sun_direction.xyz);
    bool sunny = there && n_l > 0.0 && MASU_SHADOWS != 0;
    float t = length(place);
    make_lists(block_of(gl_WorkGroupID.xy * uint(MASU_GROUP), size), sunny ? t : -1.0,
               there && MASU_AMBIENT_OCCLUSION != 0 ? t : -1.0);
    vec2 seen = vec2(1.0);
#if MASU_SHADOWS
    if (sunny) {
        uint evals;
        use_list(SUN);
        seen.x = sun_seen(p, evals);
        masu_count(MASU_COUNTER_SHADOW_EVALS, evals);
    }
#endif
#if MASU_AMBIENT_OCCLUSION
    if (there) {
        uint evals;
        use_list(AMBIENT);
        seen.y = ambient_seen(p, evals);
        masu_count(MASU_COUNTER_OCCLUSION_EVALS, evals);
    }
#endif
    if (all(lessThan(at, size))) {
        vec2 kept = masu_sane(vec4(seen, 0.0, 0.0), 0.0, 1.0).xy;
        MASU_STORE_UINT(occlusion_image, at, uvec4(packUnorm2x16(kept)));
    }
    masu_count_end();
}
