/*
 * fine.glsl: means over frames of single pixels, four per traced texel: one 32-bit value per pixel
 * in the order of the guide's numbers, three 9-bit numbers with a shared exponent of 5 (as
 * VK_FORMAT_E5B9G9R9); all bits set: the pixel has none.
 */
#ifndef MASU_SPECULAR_FINE_GLSL
#define MASU_SPECULAR_FINE_GLSL

#include "specular/guide.glsl"
#include "specular/ray.glsl"

const uint masu_fine_none = 0xFFFFFFFFu;

/* Roughness up to which a lobe is so narrow that few rays are enough. */
const float masu_fine_narrow = 0.08;

/* Weight of a pixel's own mean; the rest is the mean of the texels around. A lobe this wide blurs
 * reflections by more than two pixels. 1 if the four pixels are not one surface. */
float masu_fine_share(masu_guide g, float roughness)
{
    return g.mixed ? 1.0 : 1.0 - smoothstep(0.1, 0.25, roughness);
}

/* dither, 0..1: the fraction of a step that is rounded up. Without dither a mean that changes
 * slowly would stall half a step before its target. 0.5 rounds to nearest: for values that are
 * replaced entirely. */
uint masu_pack_fine(vec3 color, float dither)
{
    vec3 c = masu_sane(color, 0.0, 32000.0);
    float most = max(max(c.r, c.g), max(c.b, 1.0 / 65536.0));
    /* From 511.5 on the exponent is one higher, so that values that round to 512 fit. Not below:
     * 511 must be unchanged, or the other channels, at half the precision, would be rounded again
     * in each frame that keeps the value. */
    int e = clamp(int(floatBitsToUint(most * (512.0 / 511.5)) >> 23) - 127 + 1, -15, 15);
    float scale = uintBitsToFloat(uint(127 + 9 - e) << 23);
    uvec3 m = min(uvec3(c * scale + dither), uvec3(511u));
    return m.r | m.g << 9 | m.b << 18 | uint(e + 15) << 27;
}

vec3 masu_unpack_fine(uint word)
{
    return masu_unpack_shared(word);
}

#endif
