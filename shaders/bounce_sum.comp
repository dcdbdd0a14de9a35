/*
 * bounce_sum.comp: updates each live probe that has traced rays in this frame. The rays' radiance
 * is projected to nine harmonics of irradiance / pi and stored as one set of the probe, in halves.
 * The mean of the probe's sets is then stored for light.comp and for the next frame's rays. A
 * workgroup per probe, an invocation per ray, then per coefficient.
 *
 * A coefficient keeps its old value if the new one is within one half-float step, at the magnitude
 * of the first coefficient. Otherwise rounding of the light that is fed back would oscillate
 * forever.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "shared/globals.glsl"
#include "shared/guard.glsl"
#define MASU_PROBES_WRITE
#include "light/probes.glsl"
#include "bounce/ray.glsl"

layout(local_size_x = 64) in;

shared vec3 light[MASU_BOUNCE_RAYS_MAX];
shared vec3 directions[MASU_BOUNCE_RAYS_MAX];
shared float means[28];

/* Real spherical harmonics (Ramamoorthi and Hanrahan 2001), times the factor from radiance to
 * irradiance / pi. */
float harmonic(uint k, vec3 d)
{
    switch (k) {
    case 0u: return 0.282095;
    case 1u: return 0.325735 * d.y;
    case 2u: return 0.325735 * d.z;
    case 3u: return 0.325735 * d.x;
    case 4u: return 0.273137 * d.x * d.y;
    case 5u: return 0.273137 * d.y * d.z;
    case 6u: return 0.078848 * (3.0 * d.z * d.z - 1.0);
    case 7u: return 0.273137 * d.x * d.z;
    default: return 0.1365685 * (d.x * d.x - d.y * d.y);
    }
}

float projected(uint coefficient, uint rays)
{
    uint k = coefficient / 3u, c = coefficient % 3u;
    float sum = 0.0;
    for (uint r = 0u; r < MASU_BOUNCE_RAYS_MAX; r++) {
        if (r >= rays) {
            break;
        }
        sum += light[r][c] * harmonic(k, directions[r]);
    }
    return masu_sane(sum * (12.5663706 / float(rays)), -65504.0, 65504.0);
}

/* The old value, unless the new one differs by more than a step. */
float settled(float old, float new, float first)
{
    float step = max(abs(first), 6e-5) * (1.0 / 1024.0);
    return abs(new - old) <= step ? old : new;
}

void main()
{
    uint lane = gl_LocalInvocationIndex, rays = masu_bounce_each();
    uint word = masu_bounce_list[gl_WorkGroupID.x];
    uint probe = min(word & MASU_BOUNCE_PROBE, max(masu_probe_count(), 1u) - 1u);
    uint set = word >> MASU_BOUNCE_SET_SHIFT & (MASU_BOUNCE_SETS - 1u);
    uint count = clamp(word >> MASU_BOUNCE_COUNT_SHIFT, 1u, MASU_BOUNCE_SETS);
    if (lane < rays) {
        uint i = gl_WorkGroupID.x * rays + lane;
        uvec4 seen = masu_bounce_rays[2u * i + 1u];
        vec2 ba = unpackHalf2x16(seen.y);
        vec3 sum = vec3(unpackHalf2x16(seen.x), ba.x);
        if (uintBitsToFloat(masu_bounce_rays[2u * i].w) >= 0.0) {
            sum += vec3(ba.y, unpackHalf2x16(seen.z));
        }
        light[lane] = masu_sane(sum, 0.0, 65504.0);
        directions[lane] =
            masu_bounce_direction(masu_bounce_ray(word & MASU_BOUNCE_PROBE, set, lane));
    }
    barrier();
    if (lane < 28u) {
        means[lane] = lane < 27u ? projected(lane, rays) : 0.0;
    }
    barrier();
    vec2 found = vec2(0.0);
    uint own = masu_probe_live_sets() + (probe * MASU_BOUNCE_SETS + set) * MASU_PROBE_SET_WORDS;
    if (lane < MASU_PROBE_SET_WORDS) {
        vec2 before = unpackHalf2x16(probe_words[own + lane]);
        vec2 first = vec2(means[2u * lane % 3u], means[(2u * lane + 1u) % 3u]);
        vec2 now = unpackHalf2x16(packHalf2x16(vec2(means[2u * lane], means[2u * lane + 1u])));
        now = vec2(settled(before.x, now.x, first.x), settled(before.y, now.y, first.y));
        now = masu_sane(vec4(now, 0.0, 0.0), -65504.0, 65504.0).xy;
        probe_words[own + lane] = packHalf2x16(now);
        vec2 mean = now;
        for (uint s = 0u; s < MASU_BOUNCE_SETS; s++) {
            if (s < count && s != set) {
                uint other = masu_probe_live_sets() +
                             (probe * MASU_BOUNCE_SETS + s) * MASU_PROBE_SET_WORDS;
                mean += masu_sane(vec4(unpackHalf2x16(probe_words[other + lane]), 0.0, 0.0),
                                  -65504.0, 65504.0)
                            .xy;
            }
        }
        found = mean / float(count);
    }
    barrier();
    if (lane < MASU_PROBE_SET_WORDS) {
        means[2u * lane] = found.x;
        means[2u * lane + 1u] = found.y;
    }
    barrier();
    if (lane < 9u) {
        vec3 first = masu_sane(vec3(means[0], means[1], means[2]), 0.0, 65504.0);
        vec3 by = vec3(masu_rcp(first.x), masu_rcp(first.y), masu_rcp(first.z)) * 511.0;
        vec3 v = vec3(means[3u * lane], means[3u * lane + 1u], means[3u * lane + 2u]);
        uint to = masu_probe_live() + probe * MASU_PROBE_LIT_WORDS;
        if (lane == 0u) {
            probe_words[to] = packHalf2x16(first.xy);
            probe_words[to + 1u] = packHalf2x16(vec2(first.z, 1.0));
        } else {
            probe_words[to + 1u + lane] = masu_probe_pack_ratio(v, by, lane);
        }
    }
}
