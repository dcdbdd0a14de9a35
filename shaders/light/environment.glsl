/*
 * environment.glsl: a sky from an environment map: radiance over the octahedron of directions, +y
 * at its centre, with mips for rising roughness (src/scene/blob.h: masu_blob_environment_map). The
 * texels of the mips follow each other, each 9 bits of r, g and b and 5 of their exponent; the
 * shader filters them.
 *
 * They are at the end of the buffer of tables. Without a map the code is compiled away. Size and
 * number of mips are in the w of the frame's sky colours. Any direction and any texel give finite
 * light.
 *
 * After shared/guard.glsl and shared/globals.glsl.
 */
#ifndef MASU_ENVIRONMENT_GLSL
#define MASU_ENVIRONMENT_GLSL

#include "brdf/tables.glsl"

layout(constant_id = 3) const bool masu_has_environment = false;
/* Frames may rotate and tint it, and change the background (masu_environment of masu.h). */
layout(constant_id = 25) const bool masu_live_environment = false;

vec3 masu_unpack_9995(uint texel)
{
    float unit = masu_exp2(float(texel >> 27) - 24.0);
    return vec3(texel & 511u, texel >> 9 & 511u, texel >> 18 & 511u) * unit;
}

/* Index of a texel; across an edge of the octahedron's square is the same edge, reversed. */
uint masu_environment_at(ivec2 at, int size, int first)
{
    if (at.x < 0 || at.x >= size) {
        at = ivec2(at.x < 0 ? -1 - at.x : 2 * size - 1 - at.x, size - 1 - at.y);
    }
    if (at.y < 0 || at.y >= size) {
        at = ivec2(size - 1 - at.x, at.y < 0 ? -1 - at.y : 2 * size - 1 - at.y);
    }
    at = clamp(at, ivec2(0), ivec2(size - 1));
    int largest = clamp(int(frame.sky_zenith.w), 1, 1024);
    int beyond = largest >> clamp(int(frame.sky_horizon.w), 1, 8);
    int all = masu_tables.length();
    first += all - (largest * largest - beyond * beyond) / 3 * 4;
    return masu_tables[clamp(first + at.y * size + at.x, 0, max(all - 1, 0))];
}

vec3 masu_environment_mip(vec2 square, int mip, int largest)
{
    int size = max(largest >> mip, 1);
    int first = (largest * largest - size * size) / 3 * 4;
    vec2 at = square * float(size) - 0.5;
    vec2 low = floor(at);
    vec2 part = at - low;
    ivec2 p = ivec2(low);
    vec3 a = masu_unpack_9995(masu_environment_at(p, size, first));
    vec3 b = masu_unpack_9995(masu_environment_at(p + ivec2(1, 0), size, first));
    vec3 c = masu_unpack_9995(masu_environment_at(p + ivec2(0, 1), size, first));
    vec3 d = masu_unpack_9995(masu_environment_at(p + ivec2(1, 1), size, first));
    return mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
}

/* Radiance towards a direction, blurred like the reflection of a surface of that roughness. */
vec3 masu_environment(vec3 direction, float roughness)
{
    vec3 v = masu_sane(direction, -1e4, 1e4);
    vec3 factor = vec3(1.0);
    if (masu_live_environment) {
        v = vec3(dot(frame.environment[0].xyz, v), dot(frame.environment[1].xyz, v),
                 dot(frame.environment[2].xyz, v));
        factor = vec3(frame.environment[0].w, frame.environment[1].w, frame.environment[2].w);
    }
    v /= max(abs(v.x) + abs(v.y) + abs(v.z), 1e-4);
    vec2 square = v.xz;
    if (v.y < 0.0) {
        square = (1.0 - abs(v.zx)) * vec2(v.x < 0.0 ? -1.0 : 1.0, v.z < 0.0 ? -1.0 : 1.0);
    }
    square = clamp(square * 0.5 + 0.5, 0.0, 1.0);
    int size = clamp(int(frame.sky_zenith.w), 1, 1024);
    int last = clamp(int(frame.sky_horizon.w), 1, 8) - 1;
    float level = clamp(roughness, 0.0, 1.0) * float(last);
    int mip = min(int(level), last);
    vec3 near = factor * masu_environment_mip(square, mip, size);
    float part = level - float(mip);
    if (!(part > 0.0)) {
        return near;
    }
    return mix(near, factor * masu_environment_mip(square, min(mip + 1, last), size), part);
}

#endif
