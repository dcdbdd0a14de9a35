/*
 * probes.comp: the light of every probe in this frame: the baked transfer of the sky's parts and of
 * some suns, times the current sky and sun. One invocation per probe; lookups then read one set,
 * regardless of the number of baked sets. MASU_LIVE_PROBES adds the result of live probe rays.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/probes.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/guard.glsl"
#include "light/environment.glsl"
#include "light/sky.glsl"
#include "light/ambient.glsl"

#define MASU_PROBES_WRITE
#include "light/probes.glsl"

layout(local_size_x = 64) in;

shared vec3 factors[MASU_PROBE_SETS];
shared float nearness[MASU_PROBE_SUNS];

float near_sun(uint k)
{
    float cosine = dot(probe_grid.sun_direction[k].xyz, frame.sun_direction.xyz);
    return 1.0 - masu_acos(cosine) * 0.318309886;
}

/* Row k of the inverse, times the nearness of the sun to each baked sun. */
float sun_weight(uint k)
{
    float sum = 0.0;
    for (uint j = 0u; j < MASU_PROBE_SUNS; j++) {
        sum += probe_grid.sun_inverse[4u * k + (j >> 2)][j & 3u] * nearness[j];
    }
    return max(sum, 0.0);
}

void main()
{
    masu_count_begin();
    uint lane = gl_LocalInvocationIndex, sky = min(probe_grid.counts.w, 9u);
    uint suns = min(probe_grid.more.x, uint(MASU_PROBE_SUNS)), glow = min(probe_grid.more.y, 1u);
    uint sets = sky + glow + suns;
    if (lane < MASU_PROBE_SUNS) {
        nearness[lane] = lane < suns ? near_sun(lane) : 0.0;
    }
    barrier();
    if (lane < sets) {
        vec3 factor = vec3(1.0);
        if (lane < sky) {
            factor = masu_sky_harmonic(lane);
        } else if (lane >= sky + glow) {
            float total = 0.0;
            for (uint k = 0u; k < MASU_PROBE_SUNS; k++) {
                total += k < suns ? sun_weight(k) : 0.0;
            }
            factor = frame.sun_color.rgb * (sun_weight(lane - sky - glow) / max(total, 0.25));
        }
        factors[lane] = factor;
    }
    barrier();
    uint probe = gl_GlobalInvocationID.x;
    if (probe < masu_probe_count()) {
        uint from = probe * sets * MASU_PROBE_SET_WORDS;
        uint to = masu_probe_lit() + probe * MASU_PROBE_LIT_WORDS;
        float sums[2u * MASU_PROBE_SET_WORDS];
        for (uint word = 0u; word < MASU_PROBE_SET_WORDS; word++) {
            vec2 sum = vec2(0.0);
            uint low = (2u * word) % 3u, high = (2u * word + 1u) % 3u;
            for (uint s = 0u; s < MASU_PROBE_SETS; s++) {
                if (s < sets) {
                    vec2 v = unpackHalf2x16(probe_words[from + s * MASU_PROBE_SET_WORDS + word]);
                    vec2 k = vec2(factors[s][low], factors[s][high]);
                    sum += k * v;
                }
            }
            sums[2u * word] = sum.x;
            sums[2u * word + 1u] = sum.y;
        }
#ifdef MASU_LIVE_PROBES
        uint live = masu_probe_live() + probe * MASU_PROBE_LIT_WORDS;
        vec3 mean = masu_sane(
            vec3(unpackHalf2x16(probe_words[live]), unpackHalf2x16(probe_words[live + 1u]).x), 0.0,
            65504.0);
        for (uint k = 0u; k < 9u; k++) {
            vec3 v = mean;
            if (k > 0u) {
                v *= masu_probe_integers(probe_words[live + 1u + k]) *
                     ((k < 4u ? MASU_PROBE_MOST_1 : MASU_PROBE_MOST_2) / 511.0);
            }
            sums[3u * k] += v.x;
            sums[3u * k + 1u] += v.y;
            sums[3u * k + 2u] += v.z;
        }
#endif
        float valid = unpackHalf2x16(probe_words[from + MASU_PROBE_SET_WORDS - 1u]).y;
        vec3 first = masu_sane(vec3(sums[0], sums[1], sums[2]), 0.0, 65504.0);
        vec3 by = vec3(masu_rcp(first.x), masu_rcp(first.y), masu_rcp(first.z)) * 511.0;
        probe_words[to] = packHalf2x16(first.xy);
        probe_words[to + 1u] = packHalf2x16(vec2(first.z, masu_sane(valid, 0.0, 1.0)));
        for (uint k = 1u; k < 9u; k++) {
            vec3 v = vec3(sums[3u * k], sums[3u * k + 1u], sums[3u * k + 2u]);
            probe_words[to + 1u + k] = masu_probe_pack_ratio(v, by, k);
        }
    }
    masu_count_end();
}
