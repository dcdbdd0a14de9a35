/*
 * guide.glsl: what the passes of reflections know of a traced texel, and of the pixel it stands for.
 *
 * The guide, rg32ui, is the G-buffer at half size. A texel stands for one pixel of its 2x2, another one
 * in each frame, so that after four frames all have been asked (noise/sequence.glsl has the turns):
 *   x  bits 0-25  octahedral normal, as in the G-buffer
 *      bits 26-31 roughness of the lobe that is traced, 0..63; 0: it is a mirror (brdf/vndf.glsl), which
 *                 0.05 must not become by rounding: its rays hold noise
 *   y  depth, its three lowest bits replaced: two by the number of the pixel, the third is set where the four
 *      pixels are not one surface; 0: nothing is traced here. What other images hold of such a texel is not
 *      defined
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
    bool mixed; /* another pixel of the four lies on another surface, or leans another way */
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
    uint rough = roughness > MASU_TABLE_SMOOTHEST ? uint(masu_sane(roughness, 0.0, 1.0) * 63.0 + 0.5) : 0u;
    return uvec2((packed_normal & 0x3FFFFFFu) | rough << 26,
                 (floatBitsToUint(depth) & ~7u) | pixel | (mixed ? 4u : 0u));
}

/* Which pixel of its 2x2 a texel stands for in a frame. Neighbours take different ones. */
uint masu_guide_pixel(uvec2 texel, uint number)
{
    const uint order = 0x1Eu; /* 2, 3, 1, 0 in pairs of bits: round the square */
    uint k = (masu_turn(number) + texel.x + 2u * texel.y) & 3u;
    return (order >> (2u * k)) & 3u;
}

/* Pixel of the render size. across: pixels along an edge of a texel, 1 or 2. */
uvec2 masu_guide_place(uvec2 texel, uint pixel, uint across)
{
    return across == 1u ? texel : 2u * texel + uvec2(pixel & 1u, pixel >> 1);
}

/* Share of what a lobe mirrors that is traced; the rest is the sky's or the probes'. */
float masu_traced_share(float roughness, float cutoff)
{
    float from = 0.75 * cutoff;
    float x = clamp((roughness - from) / max(cutoff - from, 1e-6), 0.0, 1.0);
    return cutoff > 0.0 ? 1.0 - x * x * (3.0 - 2.0 * x) : 0.0;
}

/* The lobe that is traced: the coat's where there is one, which lies on top and is the smoother one. */
float masu_traced_roughness(masu_surface s)
{
    return s.coat > 0.0 ? s.coat_roughness : s.roughness;
}

/* Whether any of what a surface mirrors is. both: the base too, below a coat that may be too rough itself. */
bool masu_is_traced(masu_surface s, float cutoff, bool both)
{
    float roughness = masu_traced_roughness(s);
    return masu_traced_share(both ? min(roughness, s.roughness) : roughness, cutoff) > 0.0;
}

/* Share of the sky's light in the mirror that the light pass still has to add: of the base, of the coat.
 * The reference traces both lobes. */
vec2 masu_kept_mirrors(masu_surface s, float cutoff, bool both)
{
    float base = s.coat > 0.0 && !both ? 0.0 : masu_traced_share(s.roughness, cutoff);
    return 1.0 - vec2(base, masu_traced_share(s.coat_roughness, cutoff));
}

/* Point under the middle of a pixel, relative to the eye. */
vec3 masu_guide_point(uvec2 pixel, float depth)
{
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    return masu_pixel_ray(pixel, size) * (frame.forward.w * masu_rcp(depth));
}

/* How far points under other pixels lie off a plane. Rays are affine in the picture, and so is what of them is along the plane's
 * normal: a pixel is two products instead of a ray, a point and a scalar product. */
struct masu_flat {
    float base;
    vec2 lean; /* a pixel to the right, a pixel down */
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

/* Of a point that is there. */
float masu_off(masu_flat f, uvec2 pixel, float depth)
{
    return (f.base + dot(f.lean, vec2(pixel))) * (frame.forward.w / depth) - f.at;
}

#endif
