/*
 * texels.glsl: lookups in the small textures of ray tracing: bilinear in the closest mip. After
 * trace/scene.glsl.
 *
 * A texture's header: x first texel, an index of 32-bit values; y width, height in the upper half.
 * The mips follow each other, each half as large. Texels are gamma 2 and alpha, 8 bits each.
 */
#ifndef MASU_TRACE_TEXELS_GLSL
#define MASU_TRACE_TEXELS_GLSL

#include "shared/materials.h"
#include "shared/trace.h"

#extension GL_EXT_control_flow_attributes : require

#ifdef MASU_TRACE_TEXTURES
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_TRACE_TEXCOORDS, std430)
    readonly buffer TraceTexcoords
{
    uvec2 masu_trace_texcoords[];
};

/* Bit 0: vertices have colours; 1: a second set of coordinates. They follow the first set
 * (scene_data.h). */
layout(constant_id = 19) const uint masu_attributes = 0u;

/* Coordinates of a vertex in a set. */
vec2 masu_trace_texcoord(uint vertex, uint set)
{
    uint colors = masu_trace_static[masu_trace_static[0].w].w; /* index of the first colour */
    /* The second set is as long as the first, and ends at the first colour. */
    uint at = masu_attributes >= 2u && set != 0u ? vertex + (colors >> 2) : vertex;
    return uintBitsToFloat(masu_trace_texcoords[at]);
}

/* Linear colour at a point of a triangle. */
vec3 masu_trace_color(uvec3 vertices, vec3 weights)
{
    uint colors = masu_trace_static[masu_trace_static[0].w].w;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 3; i++) {
        uint at = colors + vertices[i];
        vec3 root = unpackUnorm4x8(masu_trace_texcoords[at >> 1][at & 1u]).rgb;
        sum += root * root * weights[i];
    }
    return sum;
}

/* wrap: 0 repeat, 1 clamp, 2 mirror. */
int masu_trace_wrap(int i, int size, uint wrap)
{
    if (wrap == 1u) {
        return clamp(i, 0, size - 1);
    }
    int period = wrap == 2u ? 2 * size : size;
    int k = i - period * int(floor(float(i) / float(period)));
    /* Rounding may put the quotient of a whole number of periods slightly lower. */
    k = k >= period ? k - period : k < 0 ? k + period : k;
    k = clamp(k, 0, period - 1); /* for coordinates beyond the precision of floats */
    return k < size ? k : period - 1 - k;
}

vec4 masu_trace_texel(uint word)
{
    uint at = masu_trace_static[masu_trace_static[0].w].z + (word >> 2);
    return unpackUnorm4x8(masu_trace_static[at][word & 3u]);
}

/* lod: 0 the largest. rgb linear, a alpha. */
vec4 masu_trace_picture(uint picture, vec2 uv, float lod, uint wrap)
{
    uvec4 about = masu_trace_static[masu_trace_static[masu_trace_static[0].w].y + picture];
    ivec2 size = ivec2(about.y & 0xFFFFu, about.y >> 16);
    uint first = about.x;
    int level = int(masu_sane(lod + 0.5, 0.0, 8.0));
    for (int m = 0; m < 8; m++) {
        if (m >= level || (size.x <= 1 && size.y <= 1)) {
            break;
        }
        first += uint(size.x * size.y);
        size = max(size >> 1, ivec2(1));
    }
    vec2 at = masu_sane(vec4(uv, 0.0, 0.0), -32768.0, 32768.0).xy * vec2(size) - 0.5;
    vec2 corner = floor(at);
    vec2 part = at - corner;
    vec4 sum = vec4(0.0);
    [[dont_unroll]] for (int k = 0; k < 4; k++) {
        ivec2 off = ivec2(k & 1, k >> 1);
        int x = masu_trace_wrap(int(corner.x) + off.x, size.x, wrap & 3u);
        int y = masu_trace_wrap(int(corner.y) + off.y, size.y, wrap >> 2 & 3u);
        vec4 texel = masu_trace_texel(first + uint(y * size.x + x));
        texel.rgb *= texel.rgb;
        sum += texel * mix(1.0 - part.x, part.x, float(off.x)) *
               mix(1.0 - part.y, part.y, float(off.y));
    }
    return sum;
}

/* masu_trace_picture() for a footprint of 2^width times the texture. */
vec4 masu_trace_sized(uint picture, vec2 uv, float width, uint wrap)
{
    uint size = masu_trace_static[masu_trace_static[masu_trace_static[0].w].y + picture].y;
    float side = float(max(size & 0xFFFFu, size >> 16));
    return masu_trace_picture(picture, uv, width + masu_log2(side), wrap);
}

vec2 masu_trace_uv(uvec3 vertices, vec2 b)
{
    vec2 p = masu_trace_texcoord(vertices.x, 0u);
    return p + (masu_trace_texcoord(vertices.y, 0u) - p) * b.x +
           (masu_trace_texcoord(vertices.z, 0u) - p) * b.y;
}

vec2 masu_trace_second_uv(uvec3 vertices, vec2 b)
{
    vec2 p = masu_trace_texcoord(vertices.x, 1u);
    return p + (masu_trace_texcoord(vertices.y, 1u) - p) * b.x +
           (masu_trace_texcoord(vertices.z, 1u) - p) * b.y;
}

/* Alpha masks: whether the surface exists at this point. Reads the largest mip: many rays average
 * the coverage by themselves. */
bool masu_trace_there(uvec4 about, vec2 b)
{
    if ((about.w & MASU_TRACE_HOLES) == 0u) {
        return true;
    }
    uint at = masu_trace_static[masu_trace_static[0].w].x + 4u * (about.w & MASU_TRACE_MATERIAL);
    uvec4 maps = masu_trace_static[at + 3u];
    float alpha = masu_trace_picture(maps.x, masu_trace_uv(about.xyz, b), 0.0, maps.w).a;
    /* as in shared/maps.glsl */
    return alpha >= float(maps.z >> MASU_MAP_CUTOFF_SHIFT & 255u) * (0.999999 / 255.0);
}
#endif

#ifdef MASU_TRACE_SIDES
/* Whether a triangle with holes or a single side stops a ray (with MASU_TRACE_SIDES).
 *
 * d: direction of the ray in object space, where the front of a single-sided triangle is
 * counter-clockwise as in the file, even if an instance mirrors it. */
bool masu_trace_opaque(uint triangle, vec2 b, vec3 d)
{
    uvec4 about = masu_trace_static[masu_trace_static[0].x + triangle];
    if ((about.w & MASU_TRACE_SINGLE) != 0u) {
        vec3 p = uintBitsToFloat(masu_trace_vertices[about.x].xyz);
        vec3 u = uintBitsToFloat(masu_trace_vertices[about.y].xyz) - p;
        vec3 v = uintBitsToFloat(masu_trace_vertices[about.z].xyz) - p;
        if (dot(cross(u, v), d) > 0.0) {
            return false;
        }
    }
#ifdef MASU_TRACE_TEXTURES
    return masu_trace_there(about, b);
#else
    return true;
#endif
}
#define MASU_TRACE_OPAQUE(triangle, instance, barycentrics, d)                                     \
    masu_trace_opaque(triangle, barycentrics, d)
#endif

#endif
