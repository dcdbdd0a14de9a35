/*
 * cone.comp: cone marching: the distance up to which all rays of a block of pixels are free.
 * masu-bake compiles it with the scene's SDF, once per MASU_CONE_BLOCK: 8 (starts at the camera),
 * then 4 (starts where its 8x8 block stopped).
 *
 * The rays of a block are inside a cone around its centre ray, of tangent k = block / sqrt(2)
 * pixels. If the SDF allows a step r at distance t, the whole cone is free up to the plane where
 * its rim leaves the sphere of radius r:  (s - t)^2 + (k s)^2 = r^2.  A ray of the block reaches
 * that plane at distance s or later, so it may start at s: this is exact and skips no feature. The
 * march stops if the sphere no longer contains the cone, or if it gains less than a quarter of the
 * cone's radius (from there on, separate pixels are faster).
 *
 * There are no listed parts outside their bounding box, so the distance to that box is also a safe
 * step.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/cone.h"
#include "shared/counters.h"
#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#if MASU_CONE_BLOCK == 4
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D parent_image;
layout(set = MASU_SET_PASS, binding = 1, r32f) uniform writeonly image2D cone_image;
#else
layout(set = MASU_SET_PASS, binding = 0, r32f) uniform writeonly image2D cone_image;
#endif

#if MASU_CONE_BLOCK == 4
#define MASU_TILES_WRITTEN 1
#define MASU_SDF_KEEP
#endif
#define MASU_SDF_NO_FLAT
#include "sdf/spans.glsl"
#define MASU_WRITES_BLOCKS (MASU_CONE_BLOCK == 4 && MASU_SDF_BLOCK_WORDS > 0)

vec3 box_low, box_high;

float outside_box(vec3 p)
{
    vec3 past = max(max(box_low - p, p - box_high), vec3(0.0));
    return length(past);
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        vec2 size = vec2(pc.render_width, pc.render_height);
        vec2 ndc = masu_ndc((vec2(at) + 0.5) * float(MASU_CONE_BLOCK), size);
        vec3 through = frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
        ray r;
        r.direction = through * masu_rsqrt_sure(dot(through, through)); /* at least 1 long */
        r.pixel = 2.0 * max(frame.up.w / size.y, frame.right.w / size.x);
        float k = float(MASU_CONE_BLOCK) * 0.70711 * r.pixel;
        float k2 = k * k;
        float shorter = 1.0 / (1.0 + k2);
        float t = frame.forward.w;
#if MASU_CONE_BLOCK == 4
        t = max(t, texelFetch(parent_image, ivec2(at) / 2, 0).r);
#endif
        /* Most cones end at a half-space; marching beyond the centre ray's hit on it is useless. */
        uint part;
        float limit = min(frame.sdf_max.w,
                          masu_sdf_flat(world_at(r.direction, 0.0), r.direction, t, part));
        uint evals = 0u;
        uvec2 pixels = uvec2(pc.render_width, pc.render_height);
        masu_listed_box(box_low, box_high);
        bool empty = !masu_use_tile(masu_tile_of(at * uint(MASU_CONE_BLOCK), pixels), pixels);
        bool done = empty;
        int span = 0;
        MASU_LOOP for (int i = 0; i < MASU_MARCH_STEPS_MAX + MASU_BLOCK_SPANS; i++) {
            done = done || uint(i) >= push.steps || !(t < limit);
            float at_t = t;
#if MASU_WRITES_BLOCKS
            if (done) {
                /* One more sample for each span of the rays that start here. */
                vec4 ends = span_ends(t, r.pixel);
                float begin = span == 0 ? t : span == 1 ? ends.x : span == 2 ? ends.y : ends.z;
                float end = span == 0 ? ends.x : span == 1 ? ends.y : span == 2 ? ends.z : ends.w;
                if (empty || push.all_terms != 0u || span == MASU_BLOCK_SPANS ||
                    (span > 0 && !(begin < limit))) {
                    break;
                }
                at_t = 0.5 * (begin + end);
                masu_margin = span_margin(r, begin, end);
                masu_keeping = true;
            }
#else
            if (done) {
                break;
            }
#endif
            vec3 p = world_at(r.direction, at_t);
            float f = masu_sdf(p) * safe_step;
            evals++;
#if MASU_WRITES_BLOCKS
            if (done) {
                uint place = span_place(at, pixels) + uint(1 + span * MASU_SDF_BLOCK_WORDS);
                for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
                    masu_tiles_out[place + uint(w)] = masu_kept[w];
                }
                span++;
                continue;
            }
#endif
            bool usable = masu_finite(f);
            float radius = max(f, outside_box(p));
            float inside = radius * radius * (1.0 + k2) - k2 * t * t;
            float gain = (t + sqrt(max(inside, 0.0))) * shorter - t;
            done = !usable || !(radius > 0.0) || !(inside > 0.0) || !(gain > 0.25 * k * t);
            t = done ? t : t + gain;
        }
#if MASU_WRITES_BLOCKS
        /* Few rays continue past the end of the centre ray: they use the tile's list, as all rays
         * do with push.all_terms. */
        uint place = span_place(at, pixels);
        masu_tiles_out[place] = floatBitsToUint(t);
        for (int i = 0; i < MASU_BLOCK_SPANS; i++) {
            for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
                if (i >= span) {
                    masu_tiles_out[place + uint(1 + i * MASU_SDF_BLOCK_WORDS + w)] =
                        masu_list_bits[w];
                }
            }
        }
#endif
        masu_count(MASU_COUNTER_SDF_EVALS, evals);
        MASU_STORE_R32F(cone_image, at, t);
    }
    masu_count_end();
}
