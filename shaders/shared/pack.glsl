/*
 * pack.glsl: the G-buffer's texels.
 *
 *   albedo, rgba8:  rgb  sqrt of linear albedo, or of radiance / 16 where the surface is emissive
 *                   a    perceptual roughness
 *   normal, r32ui:  bits 0-12, 13-25  octahedral normal (Cigolle et al., JCGT 3-2, 2014, section
 *   3.2); 4095 is 0
 *                   bits 26-29        metallic, 0..15
 *                   bits 30-31        MASU_SURFACE_* flags
 *   surface, rgba8, where MASU_SURFACE_MORE is set (else: specular 0.5, no coat, no relief):
 *                   r    specular
 *                   g    clear coat, 4 bits, and its roughness, 4 bits; of a small relief, which has no
 *                        coat: factor of the specular terms at grazing angles
 *                   b    occlusion
 *                   a    0: no small relief; else what its shadows leave of a light, (1 + 254 f) / 255
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
    float specular;       /* reflectance of a dielectric at normal incidence / 0.08, 0..1 */
    float coat;           /* clear coat, 0..1 */
    float coat_roughness; /* perceptual, 0..1 */
    float occlusion;      /* what of the ambient light its own relief lets through, 0..1 */
    float shadow;         /* what the shadows of its relief leave of a light, 0..1; below 0: no relief */
    float edge;           /* factor of the specular terms at grazing angles, 0..1 */
};

masu_surface masu_plain_surface(vec3 albedo, float roughness)
{
    return masu_surface(albedo, roughness, vec3(0.0), 0.0, 0.5, 0.0, 0.0, 1.0, -1.0, 1.0);
}

/* Within -1..1 but for its rounding, whatever the bits of n. */
vec2 masu_oct_encode(vec3 n)
{
    float sum = abs(n.x) + abs(n.y) + abs(n.z);
    bool usable = masu_finite(sum) && sum > masu_tiny;
    vec2 p = usable ? n.xy * (1.0 / sum) : vec2(0.0);
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
    vec3 color = masu_sane(s.albedo, 0.0, 1.0);
    if (masu_is_emissive(s)) {
        color = masu_sane(s.emissive, 0.0, masu_emissive_range) * (1.0 / masu_emissive_range);
    }
    return vec4(sqrt(color), masu_sane(s.roughness, 0.0, 1.0));
}

uint masu_pack_normal(vec3 n, masu_surface s)
{
    uvec2 q = uvec2(round(masu_oct_encode(n) * 4095.0) + 4095.0);
    uint metallic = uint(masu_sane(s.metallic, 0.0, 1.0) * 15.0 + 0.5);
    uint flags = masu_is_emissive(s) ? MASU_SURFACE_EMISSIVE : 0u;
    return q.x | q.y << 13 | metallic << 26 | flags << 30;
}

vec4 masu_pack_surface(masu_surface s)
{
    vec4 v = masu_sane(vec4(s.specular, s.coat, s.coat_roughness, s.occlusion), 0.0, 1.0);
    float coat = floor(v.y * 15.0 + 0.5) * 16.0 + floor(v.z * 15.0 + 0.5);
    if (!(s.shadow >= 0.0)) {
        return vec4(v.x, coat / 255.0, v.w, 0.0);
    }
    vec2 relief = masu_sane(vec3(s.edge, s.shadow, 0.0), 0.0, 1.0).xy;
    return vec4(v.x, relief.x, v.w, (1.0 + 254.0 * relief.y) / 255.0);
}

void masu_unpack_surface(vec4 texel, inout masu_surface s)
{
    s.specular = texel.r;
    s.occlusion = texel.b;
    s.shadow = (texel.a * 255.0 - 1.0) / 254.0;
    if (texel.a > 0.0) {
        s.edge = texel.g;
    } else {
        float coat = floor(texel.g * 255.0 + 0.5);
        s.coat = floor(coat / 16.0) / 15.0;
        s.coat_roughness = (coat - 16.0 * floor(coat / 16.0)) / 15.0;
    }
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
