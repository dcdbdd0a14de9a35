/*
 * guide.glsl: data of a traced texel, and of the pixel that it represents.
 *
 * The guide, rg32ui, is the G-buffer at half size. A texel represents one pixel of its 2x2, another
 * one in each frame, so that four frames cover all (order: noise/sequence.glsl):
 *   x  bits 0-25  octahedral normal, as in the G-buffer
 *      bits 26-31 roughness of the traced lobe, 0..63; 0: a mirror (brdf/vndf.glsl). A roughness of
 *                 0.05 is never rounded to 0: its rays have noise
 *   y  depth, with its three lowest bits replaced: two by the number of the pixel, the third is set
 *      if the four pixels are not one surface; 0: nothing is traced here. The content of other
 *      images at such a texel is undefined
 */
#ifndef MASU_SPECULAR_GUIDE_GLSL
#define MASU_SPECULAR_GUIDE_GLSL

#include "shared/lookup_tables.h"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "noise/sequence.glsl"

struct masu_guide {
    vec3 normal;
    float roughness;
    float depth;
    uint pixel; /* x + 2 y within its 2x2 */
    bool mixed; /* another pixel of the four is on another surface, or has a different normal */
    bool there;
};

masu_guide masu_unpack_guide(uvec2 texel)
{
    masu_guide g;
    g.normal = masu_unpack_normal(texel.x);
    g.roughness = float(texel.x >> 26) / 63.0;
    g.depth = uintBitsToFloat(texel.y & ~7u);
    g.pixel = texel.y & 3u;
    g.mixed = (texel.y & 4u) != 0u;
    g.there = texel.y > 7u && masu_finite(g.depth) && g.depth > 0.0;
    return g;
}

uvec2 masu_pack_guide(uint packed_normal, float roughness, float depth, uint pixel, bool mixed)
{
    uint rough = roughness > MASU_TABLE_SMOOTHEST
                     ? uint(masu_sane(roughness, 0.0, 1.0) * 63.0 + 0.5)
                     : 0u;
    return uvec2((packed_normal & 0x3FFFFFFu) | rough << 26,
                 (floatBitsToUint(depth) & ~7u) | pixel | (mixed ? 4u : 0u));
}

/* The pixel of its 2x2 that a texel represents in a frame. Neighbours use different ones. */
uint masu_guide_pixel(uvec2 texel, uint number)
{
    const uint order = 0x1Eu; /* 2, 3, 1, 0 in pairs of bits: around the square */
    uint k = (masu_turn(number) + texel.x + 2u * texel.y) & 3u;
    return (order >> (2u * k)) & 3u;
}

/* Pixel of the render size. across: pixels along an edge of a texel, 1 or 2. */
uvec2 masu_guide_place(uvec2 texel, uint pixel, uint across)
{
    return across == 1u ? texel : 2u * texel + uvec2(pixel & 1u, pixel >> 1);
}

/* Share of a lobe's reflection that is traced; the rest is from sky or probes. */
float masu_traced_share(float roughness, float cutoff)
{
    float from = 0.75 * cutoff;
    float x = clamp((roughness - from) / max(cutoff - from, 1e-6), 0.0, 1.0);
    return cutoff > 0.0 ? 1.0 - x * x * (3.0 - 2.0 * x) : 0.0;
}

/* Roughness of the traced lobe: the coat's if there is one, which is on top and smoother. */
float masu_traced_roughness(masu_surface s)
{
    return s.coat > 0.0 ? s.coat_roughness : s.roughness;
}

/* Whether any specular reflection of a surface is traced. both: also the base, below a coat that
 * may be too rough itself. */
bool masu_is_traced(masu_surface s, float cutoff, bool both)
{
    float roughness = masu_traced_roughness(s);
    return masu_traced_share(both ? min(roughness, s.roughness) : roughness, cutoff) > 0.0;
}

/* Shares of the reflected sky, of base and coat, that the light pass still has to add. The
 * reference traces both lobes. */
vec2 masu_kept_mirrors(masu_surface s, float cutoff, bool both)
{
    float base = s.coat > 0.0 && !both ? 0.0 : masu_traced_share(s.roughness, cutoff);
    return 1.0 - vec2(base, masu_traced_share(s.coat_roughness, cutoff));
}

/* Point at the centre of a pixel, relative to the camera. */
vec3 masu_guide_point(uvec2 pixel, float depth)
{
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    return masu_pixel_ray(pixel, size) * (frame.forward.w * masu_rcp(depth));
}

/* Distance of other pixels' points from a plane. Rays are affine in the image, and so is their
 * component along the plane's normal: a pixel costs two products instead of a ray, a point and a
 * scalar product. */
struct masu_flat {
    float base;
    vec2 lean; /* per pixel to the right, per pixel down */
    float at;
};

masu_flat masu_flat_through(vec3 point, vec3 n)
{
    vec2 size = vec2(pc.render_width, pc.render_height);
    masu_flat f;
    f.lean = 2.0 / size * vec2(dot(frame.right.xyz, n), -dot(frame.up.xyz, n));
    f.base = dot(masu_pixel_ray(uvec2(0u), uvec2(size)), n);
    f.at = dot(point, n);
    return f;
}

/* The point must exist: depth above 0. */
float masu_off(masu_flat f, uvec2 pixel, float depth)
{
    return (f.base + dot(f.lean, vec2(pixel))) * (frame.forward.w / depth) - f.at;
}

#endif
