/*
 * probes.glsl: light probes. A probe holds SH-9 of irradiance / pi under the light of this frame,
 * which probes.comp computes from the baked data (see the design notes); a point interpolates its
 * eight neighbours (masu_probe_light). tools/bake/light/probe_light.c is the C copy; tests compare
 * them.
 *
 * Weights of the eight, multiplied:
 *   trilinear, for the point moved off its surface by the grid's bias
 *   1 in front of the surface's plane, falling to 0 at the grid's bias behind it: such a probe
 *     receives light that cannot reach the point. A cosine would favour distant probes over close
 *   ones visibility: Chebyshev's bound from the mean and mean square of distances from the probe in
 *     that direction (Donnelly and Lauritzen 2006; Majercik et al., JCGT 8-2, 2019)
 *   0 for probes inside solids
 * None is exactly 0, so the sum is a valid divisor.
 *
 * With MASU_PROBES_LIVE only the light found by live probes, without the baked light.
 */
#ifndef MASU_LIGHT_PROBES_GLSL
#define MASU_LIGHT_PROBES_GLSL

#include "shared/probes.h"
#include "shared/guard.glsl"

#ifdef MASU_PROBES_WRITE
#define MASU_PROBES_ACCESS
#else
#define MASU_PROBES_ACCESS readonly
#endif
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PROBES, std430) MASU_PROBES_ACCESS buffer Probes
{
    masu_probe_grid probe_grid;
    uint probe_words[];
};
#ifndef MASU_PROBES_WRITE
/* The same buffer, 16 bytes at a time: CPU drivers take as long for four values as for one. */
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_PROBES, std430) readonly buffer ProbeQuads
{
    masu_probe_grid probe_grid_again;
    uvec4 probe_quads[];
};
#endif

uint masu_probe_count() { return probe_grid.counts.x * probe_grid.counts.y * probe_grid.counts.z; }

uint masu_probe_sets() { return probe_grid.counts.w + probe_grid.more.y + probe_grid.more.x; }

uint masu_probe_map_words()
{
    uint side = probe_grid.more.z + 2u;
    return probe_grid.more.z > 0u ? side * side : 0u;
}

/* Offset of the distance maps, and of the data that probes.comp writes. */
uint masu_probe_maps() { return masu_probe_count() * masu_probe_sets() * MASU_PROBE_SET_WORDS; }
uint masu_probe_lit()
{
    return (masu_probe_maps() + masu_probe_count() * masu_probe_map_words() + 3u) & ~3u;
}

/* Live probes: offset of their rays' means, and of the sets with those. */
uint masu_probe_live() { return masu_probe_lit() + masu_probe_count() * MASU_PROBE_LIT_WORDS; }
uint masu_probe_live_sets()
{
    return masu_probe_live() + masu_probe_count() * MASU_PROBE_LIT_WORDS;
}

/* Position of a probe relative to the first. */
vec3 masu_probe_place(uint probe)
{
    uvec3 counts = max(probe_grid.counts.xyz, uvec3(1u));
    uvec3 at = uvec3(probe % counts.x, probe / counts.x % counts.y, probe / (counts.x * counts.y));
    return vec3(at) * probe_grid.spacing.xyz;
}

/* Packs coefficient k, divided by the first one / 511. */
uint masu_probe_pack_ratio(vec3 coefficient, vec3 by, uint k)
{
    vec3 v = coefficient * by / (k < 4u ? MASU_PROBE_MOST_1 : MASU_PROBE_MOST_2);
    uvec3 q = uvec3(ivec3(floor(masu_sane(v, -511.0, 511.0) + 0.5))) & 1023u;
    return q.x | q.y << 10 | q.z << 20;
}

vec3 masu_probe_integers(uint w)
{
    return vec3(ivec3(uvec3(w << 22, w << 12, w << 2)) >> 22);
}

/* Real spherical harmonics of a unit direction without the first (Ramamoorthi and Hanrahan 2001),
 * as factors of the packed integers. Two vectors: an array indexed by a loop would be memory. */
struct masu_probe_factors {
    vec4 a, b;
};

const float masu_probe_first = 0.282095;

masu_probe_factors masu_probe_basis(vec3 d)
{
    const float one = MASU_PROBE_MOST_1 / 511.0, two = MASU_PROBE_MOST_2 / 511.0;
    masu_probe_factors f;
    f.a = vec4(0.488603 * one * d.yzx, 1.092548 * two * d.x * d.y);
    f.b = two * vec4(1.092548 * d.y * d.z, 0.315392 * (3.0 * d.z * d.z - 1.0),
                     1.092548 * d.x * d.z, 0.546274 * (d.x * d.x - d.y * d.y));
    return f;
}

/* Bilinear lookup in the octahedral map of a probe, whose border repeats the texels across the
 * edge. */
vec2 masu_probe_distances(uint map, uint texels, vec3 d)
{
    uint side = texels + 2u;
    vec2 at = d.xy / max(abs(d.x) + abs(d.y) + abs(d.z), 1e-6);
    vec2 fold = 1.0 - abs(at.yx);
    fold = vec2(at.x >= 0.0 ? fold.x : -fold.x, at.y >= 0.0 ? fold.y : -fold.y);
    at = d.z < 0.0 ? fold : at;
    vec2 uv = clamp((at * 0.5 + 0.5) * float(texels) + 0.5, vec2(0.0), vec2(float(side) - 1.0));
    uvec2 low = min(uvec2(uv), uvec2(side - 2u));
    vec2 f = uv - vec2(low);
    uint word = map + low.y * side + low.x;
    vec2 a = mix(unpackUnorm2x16(probe_words[word]), unpackUnorm2x16(probe_words[word + 1u]), f.x);
    vec2 b = mix(unpackUnorm2x16(probe_words[word + side]),
                 unpackUnorm2x16(probe_words[word + side + 1u]), f.x);
    return mix(a, b, f.y) * vec2(1.5, 2.25);
}

float masu_probe_seen(uint map, uint texels, vec3 d, float distance)
{
    vec2 moments = masu_probe_distances(map, texels, d);
    float beyond = distance - moments.x;
    float variance = abs(moments.y - moments.x * moments.x) + 1e-4;
    float bound = variance / (variance + beyond * beyond);
    return beyond > 0.0 ? bound * bound * bound : 1.0;
}

#ifndef MASU_PROBES_WRITE
/* Irradiance / pi of one probe for the normal. */
vec3 masu_probe_irradiance(uint quad, masu_probe_factors f, out float valid)
{
    uvec4 a = probe_quads[quad], b = probe_quads[quad + 1u], c = probe_quads[quad + 2u];
    vec2 rg = unpackHalf2x16(a.x);
    vec2 ba = unpackHalf2x16(a.y);
    vec3 sum = masu_probe_integers(a.z) * f.a.x + masu_probe_integers(a.w) * f.a.y +
               masu_probe_integers(b.x) * f.a.z + masu_probe_integers(b.y) * f.a.w +
               masu_probe_integers(b.z) * f.b.x + masu_probe_integers(b.w) * f.b.y +
               masu_probe_integers(c.x) * f.b.z + masu_probe_integers(c.y) * f.b.w;
    valid = ba.y;
    return max(vec3(rg, ba.x) * (masu_probe_first + sum), vec3(0.0));
}

/* Irradiance / pi of a surface point with that normal; finite for any `from` and any finite normal
 * within -1..1. w: weight of the grid: 1 inside, falling to 0 within a cell around it. `from`: the
 * point relative to the first probe. */
vec4 masu_probe_light(vec3 from, vec3 normal)
{
    from = masu_sane(from, -1e15, 1e15);
    /* Loaded once, not in the loop: compilers cannot assume that the grid is constant. The loop has
     * only what it needs: it has the most registers of all shading. */
    vec4 origin = probe_grid.origin;
    vec3 spacing = probe_grid.spacing.xyz;
    uvec4 counts = probe_grid.counts, more = probe_grid.more;
    vec3 last = vec3(counts.xyz - 1u);
    vec3 g = from / spacing;
    vec3 beyond = max(-0.5 - g, g - last - 0.5);
    float inside = clamp(1.0 - max(max(beyond.x, beyond.y), max(beyond.z, 0.0)), 0.0, 1.0);
    if (!(inside > 0.0)) {
        return vec4(0.0);
    }
    vec3 point = from + normal * origin.w;
    vec3 cell = clamp(point / spacing, vec3(0.0), last);
    uvec3 base = min(uvec3(cell), max(counts.xyz, uvec3(2u)) - 2u);
    vec3 f = cell - vec3(base);
    float per_diagonal = 1.0 / length(spacing), per_bias = masu_rcp(max(origin.w, 1e-4));
    uint count = counts.x * counts.y * counts.z, side = more.z + 2u;
    uint map_words = more.z > 0u ? side * side : 0u;
    uint maps = count * (counts.w + more.y + more.x) * MASU_PROBE_SET_WORDS;
    uint lit = (maps + count * map_words + 3u) / 4u;
#ifdef MASU_PROBES_LIVE
    lit += count * (MASU_PROBE_LIT_WORDS / 4u);
#endif
    masu_probe_factors by_normal = masu_probe_basis(normal);
    /* From a corner to the next along each axis: 0 where the grid has a single probe. */
    uvec3 step = uvec3(1u, counts.x, counts.x * counts.y) * min(counts.xyz - 1u, uvec3(1u));
    uint first = (base.z * counts.y + base.y) * counts.x + base.x;
    vec3 to_first = vec3(base) * spacing - point, side_by_side = spacing * min(last, vec3(1.0));
    vec3 sum = vec3(0.0);
    float total = 0.0;
    for (uint corner = 0u; corner < 8u; corner++) {
        uvec3 high = uvec3(corner, corner >> 1, corner >> 2) & 1u;
        vec3 t = max(mix(1.0 - f, f, vec3(high)), 1e-3);
        vec3 to = to_first + vec3(high) * side_by_side;
        float square = dot(to, to);
        float distance = sqrt(max(square, 1e-12));
        vec3 d = to / distance;
        float front = clamp(2.0 + dot(to, normal) * per_bias, 0.0, 1.0);
        float w = t.x * t.y * t.z * (front * front + 0.05);
        uint probe = first + high.x * step.x + high.y * step.y + high.z * step.z;
        if (map_words > 0u && square > 1e-12) {
            w *= max(masu_probe_seen(maps + probe * map_words, more.z, -d, distance * per_diagonal),
                     1e-4);
        }
        float valid;
        vec3 e = masu_probe_irradiance(lit + probe * (MASU_PROBE_LIT_WORDS / 4u), by_normal, valid);
        w *= max(valid, 1e-4);
        sum += w * e;
        total += w;
    }
    return vec4(sum / max(total, 1e-20), inside);
}
#endif

#endif
