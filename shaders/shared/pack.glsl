/*
 * pack.glsl: the G-buffer's texels.
 *
 *   albedo, rgba8:  rgb  sqrt of linear albedo, or of radiance / 16 where the surface is emissive
 *                   a    perceptual roughness
 *   normal, r32ui:  bits 0-12, 13-25  octahedral normal (Cigolle et al., JCGT 3-2, 2014, section
 *   3.2); 4095 is 0
 *                   bits 26-29        metallic, 0..15
 *                   bits 30-31        MASU_SURFACE_* flags
 *   depth, float:   near / view z; 0: nothing there
 *
 * 13 bits per axis leave a normal within 0.03 degrees. src/masu.c, masu_unpack_normal is the twin
 * in C.
 */
#ifndef MASU_PACK_GLSL
#define MASU_PACK_GLSL

#include "shared/guard.glsl"

const float masu_emissive_range = 16.0;

struct masu_surface {
    vec3 albedo;   /* linear, 0..1 */
    float roughness; /* perceptual, 0..1 */
    vec3 emissive; /* linear radiance, 0..16; any above 0 replaces the lit surface */
    float metallic;
};

vec2 masu_oct_encode(vec3 n)
{
    float sum = abs(n.x) + abs(n.y) + abs(n.z);
    vec2 p = n.xy * masu_rcp(sum);
    if (n.z < 0.0) {
        vec2 s = vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
        p = (1.0 - abs(p.yx)) * s;
    }
    return p;
}

/* Any pair in -1..1 gives a unit vector: the octahedron comes no nearer to the origin than
 * 1/sqrt(3). */
vec3 masu_oct_decode(vec2 p)
{
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) {
        vec2 s = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
        n.xy = (1.0 - abs(n.yx)) * s;
    }
    return n * masu_rsqrt(dot(n, n));
}

bool masu_is_emissive(masu_surface s)
{
    return any(greaterThan(s.emissive, vec3(0.0)));
}

vec4 masu_pack_albedo(masu_surface s)
{
    vec3 radiance = masu_sane(s.emissive, 0.0, masu_emissive_range) / masu_emissive_range;
    vec3 color = masu_is_emissive(s) ? radiance : masu_sane(s.albedo, 0.0, 1.0);
    return vec4(sqrt(color), masu_sane(s.roughness, 0.0, 1.0));
}

uint masu_pack_normal(vec3 n, masu_surface s)
{
    vec2 p = masu_sane(vec4(masu_oct_encode(n), 0.0, 0.0), -1.0, 1.0).xy;
    uvec2 q = uvec2(round(p * 4095.0) + 4095.0);
    uint metallic = uint(masu_sane(s.metallic, 0.0, 1.0) * 15.0 + 0.5);
    uint flags = masu_is_emissive(s) ? MASU_SURFACE_EMISSIVE : 0u;
    return q.x | q.y << 13 | metallic << 26 | flags << 30;
}

vec3 masu_unpack_normal(uint texel)
{
    vec2 q = vec2(texel & 0x1FFFu, texel >> 13 & 0x1FFFu) / 4095.0 - 1.0;
    return masu_oct_decode(min(q, vec2(1.0)));
}

float masu_unpack_metallic(uint texel)
{
    return float(texel >> 26 & 15u) / 15.0;
}

uint masu_unpack_flags(uint texel)
{
    return texel >> 30;
}

#endif
