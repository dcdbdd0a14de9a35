/*
 * sun_map.glsl: visibility of the sun past the polygons, from the shadow map: masu_sun_seen(). The
 * includer binds the map at binding 2 of its set, or defines another binding: MASU_AT_SUN_MAP.
 *
 * A point uses the first cascade that contains it, blended with the next one near the border;
 * beyond the depth of the last one it is lit. The comparison: nine texels, each lit or not, with
 * the weights of a quadratic B-spline around the point. The weights change smoothly while the point
 * moves across the texels, so an edge is a ramp three texels wide without steps.
 *
 * BIAS. Each of the nine texels is compared with the surface's own plane there if that rises
 * towards the sun, and with the point's depth if it falls: exact on a plane, for any sun. The
 * casters' bias (cascade.vert) covers the difference between the normals of curved meshes and their
 * flat triangles, and the foot of a steep wall towards the ground in front. Rejected: raising the
 * point by its slope times the reach of the filter (three times as many pixels on the wrong side of
 * an edge, since light leaks in under closer occluders); moving it along its normal (shifts the
 * shadow sideways); choosing the cascade first and sampling once (a cascade per lane is indexed
 * memory: 1.5 times the time on lavapipe).
 */
#ifndef MASU_SUN_MAP_GLSL
#define MASU_SUN_MAP_GLSL

#include "shared/shadow.h"

#extension GL_EXT_control_flow_attributes : require

#include "shared/globals.glsl"

#ifndef MASU_AT_SUN_MAP
#define MASU_AT_SUN_MAP 2
#endif
layout(set = MASU_SET_PASS, binding = MASU_AT_SUN_MAP) uniform sampler2D shadow_map;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SHADOW, std140) uniform Shadow
{
    masu_shadow_uniforms shadow;
};

const float masu_steepest = 200.0; /* steepest slope against the sun that is compensated: 0.3
                                    * degrees */
const float masu_least_bias = 0.1; /* texels: covers the rounding of depth and normal */

/* Weights of the texels before, at and after the point; f: distance from its texel's centre. */
vec3 masu_spline(float f)
{
    float a = 0.5 - f;
    float b = 0.5 + f;
    return vec3(0.5 * a * a, 0.75 - f * f, 0.5 * b * b);
}

/* at: in texels of the cascade, 0 is the edge of the first; corner: its first texel in the map;
 * depth: of the point; slope: change of the surface depth per texel. */
float masu_map_lit(vec2 at, ivec2 corner, float depth, vec2 slope)
{
    vec2 texel = floor(at);
    vec3 across = masu_spline(at.x - texel.x - 0.5);
    vec3 down = masu_spline(at.y - texel.y - 0.5);
    float sum = 0.0;
    for (int y = 0; y < 3; y++) {
        vec3 seen;
        for (int x = 0; x < 3; x++) {
            ivec2 tap = corner + ivec2(texel) + ivec2(x - 1, y - 1);
            float nearest = texelFetch(shadow_map, tap, 0).r;
            vec2 off = texel + vec2(x, y) - 0.5 - at;
            float rise = max(dot(slope, off), 0.0);
            seen[x] = min(depth + rise, 1.0) >= nearest ? 1.0 : 0.0;
        }
        sum += down[y] * dot(across, seen);
    }
    return sum;
}

/* rel: relative to the camera; n: unit, on the side of the sun. */
float masu_cascades_seen(vec3 rel, vec3 n)
{
    uint count = min(uint(shadow.reach.x), uint(MASU_CASCADES_MAX));
    float seen = 0.0;
    float left = 1.0;
    [[dont_unroll]] for (uint k = 0u; k < uint(MASU_CASCADES_MAX); k++) {
        if (k >= count || !(left > 0.0)) {
            break;
        }
        vec4 row0 = shadow.row0[k];
        vec4 row1 = shadow.row1[k];
        vec4 row2 = shadow.row2[k];
        float texel = shadow.origin_hi[k].w;
        float metre = shadow.origin_lo[k].w;
        float size = shadow.rect[k].z;
        /* The normal along the axes of the cascade. */
        float facing = max(dot(n, row2.xyz) / metre, 1e-6);
        float half_width = 0.5 * texel * size;
        vec2 across = vec2(dot(n, row0.xyz), dot(n, row1.xyz)) * half_width;
        vec2 at = vec2(dot(row0.xyz, rel) + row0.w, dot(row1.xyz, rel) + row1.w);
        float depth = dot(row2.xyz, rel) + row2.w;
        vec2 slope = clamp(-across / facing, -masu_steepest, masu_steepest) * (texel * metre);
        float inside = (1.0 - 3.0 / size) - max(abs(at.x), abs(at.y));
        if (inside >= 0.0 && depth >= 0.0) {
            float share = k + 1u == count ? 1.0 : min(inside / MASU_CASCADE_BLEND, 1.0);
            seen += left * share * masu_map_lit((at * 0.5 + 0.5) * size, ivec2(shadow.rect[k].xy),
                                       depth + masu_least_bias * texel * metre, slope);
            left -= left * share;
        }
    }
    return seen + left;
}

/* masu_cascades_seen() with the fade-out of the last cascade; z: view depth. */
float masu_sun_seen(vec3 rel, vec3 n, float z)
{
    float fade = clamp((z - shadow.reach.y) * shadow.reach.z, 0.0, 1.0);
    return fade < 1.0 ? mix(masu_cascades_seen(rel, n), 1.0, fade) : 1.0;
}

#endif
