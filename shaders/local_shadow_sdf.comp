/*
 * local_shadow_sdf.comp: SDF shadow maps of punctual lights: one ray from the light to its range
 * for each texel of the shadow faces that the frame renders. masu-bake compiles it with the scene's
 * SDF. The stored value is near / z, as for the depth of polygons, rounded down to 16 bits; 0 if
 * the ray hits nothing. local_shadow_keep.frag writes the closer of the two depths to the atlas. If
 * only polygons have moved in a face, it is not marched again.
 *
 * A workgroup is a block of 8x8 texels. It lists the parts whose bounding spheres its rays can
 * touch: in scenes with few parts as a bit mask, otherwise as part numbers in shared memory, or as
 * "all parts" if there are more than LIST_MOST.
 *
 * Surfaces closer than the near distance cast shadows too, from the near distance on. If a light is
 * inside a solid (its own bulb), its rays start where they leave that solid. Nothing here depends
 * on the camera or the rung, so that faces can be cached.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/counters.h"
#include "shared/local_shadow.h"
#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LOCAL_FACES, std140) uniform LocalFaces
{
    masu_local_face_uniforms faces;
};

layout(set = MASU_SET_PASS, binding = 0, r32ui) uniform writeonly uimage2D pairs_image;

#define LIST_MOST 255
#define MASU_OWN_PARTS LIST_MOST
#define MASU_RELAXED
#define MASU_SDF_NO_FLAT
#define MASU_MARCH_STEPS uint(MASU_REFLECTED_STEPS_MAX)
#include "sdf/trace.glsl"

#define LEAVE_STEPS 64
#define MASKS ((MASU_SDF_LISTED_COUNT + 31) / 32 + (MASU_SDF_LISTED_COUNT == 0 ? 1 : 0))
#define INVOCATIONS (MASU_GROUP * MASU_GROUP)

shared uint masks[MASKS];
shared uint depths[INVOCATIONS];

/* Whether a ray of the block may touch the sphere. across: distance of the rays from the centre
 * ray, at distance 1. */
bool can_touch(vec4 sphere, vec3 middle, float across, float longest)
{
    vec3 c = sphere.xyz - eye_hi - eye_lo;
    float farthest = min(longest, length(c) + sphere.w);
    vec3 off = c - middle * clamp(dot(c, middle), 0.0, longest);
    vec3 a = abs(eye_hi);
    float slack = 128.0 * ulp * (sphere.w + max(a.x, max(a.y, a.z)) + farthest);
    float reach = sphere.w + across * farthest + slack;
    return !(sphere.w >= 0.0) || !(dot(off, off) > reach * reach); /* false: unbounded, or NaN */
}

/* Restricts the SDF to the parts that the block's rays can touch, for all later evaluations. */
void list_parts(vec3 middle, float across, float longest)
{
    uint me = gl_LocalInvocationIndex;
    for (int w = 0; w < (MASKS + INVOCATIONS - 1) / INVOCATIONS; w++) {
        if (uint(w * INVOCATIONS) + me < uint(MASKS)) {
            masks[uint(w * INVOCATIONS) + me] = 0u;
        }
    }
    barrier();
    for (int i = 0; i < (MASU_SDF_LISTED_COUNT + INVOCATIONS - 1) / INVOCATIONS; i++) {
        uint part = uint(i * INVOCATIONS) + me;
        if (part >= uint(MASU_SDF_LISTED_COUNT)) {
            break;
        }
        if (can_touch(masu_sdf_bounds(part), middle, across, longest)) {
            atomicOr(masks[part >> 5], 1u << (part & 31u));
        }
    }
    barrier();
#if MASU_SDF_MASKED
    for (int w = 0; w < MASU_LIST_WORDS; w++) {
        masu_list_bits[w] = w < MASKS ? masks[min(w, MASKS - 1)] : 0u;
    }
#else
    /* Each mask is written by one invocation, after the parts of the preceding masks: ascending
     * order. */
    for (int i = 0; i < (MASKS + INVOCATIONS - 1) / INVOCATIONS; i++) {
        uint word = uint(i * INVOCATIONS) + me;
        if (word >= uint(MASKS)) {
            break;
        }
        uint place = 0u;
        for (int w = 0; w < MASKS; w++) {
            if (uint(w) >= word) {
                break;
            }
            place += uint(bitCount(masks[w]));
        }
        uint bits = masks[word];
        for (int k = 0; k < 32; k++) {
            if (bits == 0u || place >= uint(LIST_MOST)) {
                break;
            }
            masu_own_parts[place] = word * 32u + masu_low_bit(bits);
            bits &= bits - 1u;
            place++;
        }
    }
    barrier();
    uint count = 0u;
    for (int w = 0; w < MASKS; w++) {
        count += uint(bitCount(masks[w]));
    }
    masu_list_count = count > uint(LIST_MOST) ? MASU_TILE_ALL : count;
    masu_list_first = 0u;
#endif
}

bool any_listed()
{
#if MASU_SDF_LISTED_COUNT == 0
    return false;
#else
    uint any_bits = 0u;
    for (int w = 0; w < MASKS; w++) {
        any_bits |= masks[w];
    }
    return any_bits != 0u;
#endif
}

/* Distance from the light to the ray's hit, or -1. */
float march_from_light(ray r, inout uint evals)
{
    march_state s = march_begin(r);
    bool leaving = r.start == 0.0;
    float lift = 0.0;
    MASU_LOOP for (int i = 0; i < MASU_REFLECTED_STEPS_MAX + LEAVE_STEPS; i++) {
        if (s.done) {
            break;
        }
        float f = field_at(r, s.t);
        evals++;
        if (i == 0) {
            lift = max(-0.01 * f, 2.0 * tolerance(r, 0.0));
            leaving = leaving && f < 0.0;
        }
        leaving = leaving && i < LEAVE_STEPS && f < lift;
        if (leaving) {
            s.t += max(-f, lift);
            s.before_t = s.t;
            s.done = !(s.t < r.limit);
            s.t = s.done ? -1.0 : s.t;
        } else {
            march_step(s, r, f);
        }
    }
    return s.done ? s.t : -1.0;
}

float depth_of_texel(uint k, vec2 at, bool listed, inout uint evals)
{
    vec3 towards = faces.row2[k].xyz + faces.row0[k].xyz * at.x + faces.row1[k].xyz * at.y;
    float scale = length(towards); /* distance along the ray per unit of z, at least 1 */
    ray r = ray(towards / scale, faces.origin_hi[k].w / scale, 0.0, faces.origin_lo[k].w * scale);
    clip_to_box(r, frame.sdf_min.xyz, frame.sdf_max.xyz);
    float t = -1.0;
    if (r.start < r.limit) {
        uint part;
        float end = masu_sdf_flat(world_at(r.direction, 0.0), r.direction, r.start, part);
        bool ends = end < r.limit;
        vec3 low, high;
        masu_listed_box(low, high);
        float farthest = ends ? end : r.limit;
        clip_to_box(r, low, high);
        /* As in march.comp: a surface at the very side of the box may be hit slightly behind it. */
        r.limit = min(r.limit * (1.0 + newton_reach * r.pixel), farthest);
        if (listed && r.start < r.limit) {
            t = march_from_light(r, evals);
        }
        t = t < 0.0 && ends ? end : t;
    }
    float z = t / scale;
    return t < 0.0 ? 0.0 : z > faces.row2[k].w ? faces.row2[k].w / z : 1.0;
}

void main()
{
    masu_count_begin();
    uint k = min(gl_WorkGroupID.z, uint(MASU_LOCAL_FACES_MAX - 1));
    uvec2 texel = gl_GlobalInvocationID.xy;
    float edge = float(faces.tile[k].z);
    float width = faces.origin_hi[k].w;
    /* Uniform in the workgroup: tiles are whole blocks. */
    if (faces.tile[k].w == 2u && gl_WorkGroupID.x * uint(MASU_GROUP) < faces.tile[k].z &&
        gl_WorkGroupID.y * uint(MASU_GROUP) < faces.tile[k].z) {
        eye_hi = faces.origin_hi[k].xyz - frame.anchor.xyz;
        eye_lo = faces.origin_lo[k].xyz;
        vec3 a = abs(eye_hi);
        coarse = 8.0 * ulp * max(a.x, max(a.y, a.z));
        vec2 block =
            (vec2(gl_WorkGroupID.xy) * float(MASU_GROUP) + 0.5 * float(MASU_GROUP) - 0.5 * edge) *
            width;
        vec3 middle = faces.row2[k].xyz + faces.row0[k].xyz * block.x + faces.row1[k].xyz * block.y;
        float stretch = length(middle);
        /* Half the diagonal of the block, plus the march's hit distance. */
        float across = (0.70711 * float(MASU_GROUP) + newton_reach) * width;
        list_parts(middle / stretch, across, faces.origin_lo[k].w * (stretch + across));
        uint evals = 0u;
        float depth = depth_of_texel(k, (vec2(texel) + 0.5 - 0.5 * edge) * width, any_listed(),
                                     evals);
        masu_count(MASU_COUNTER_SHADOW_EVALS, evals);
        depths[gl_LocalInvocationIndex] = min(uint(clamp(depth, 0.0, 1.0) * 65535.0), 65535u);
        barrier();
        if (gl_LocalInvocationIndex < uint(INVOCATIONS) / 2u) {
            uint i = 2u * gl_LocalInvocationIndex;
            uvec2 at = gl_WorkGroupID.xy * uvec2(MASU_GROUP) +
                       uvec2(i % uint(MASU_GROUP), i / uint(MASU_GROUP));
            at = (faces.tile[k].xy + at) / uvec2(2u, 1u);
            MASU_STORE_UINT(pairs_image, at, uvec4(depths[i] | depths[i + 1u] << 16));
        }
    }
    masu_count_end();
}
