/*
 * ray.glsl: image formats of a traced texel's ray and of its hit.
 *
 *   specular_ray, rg32ui   x  direction, octahedral, 16 + 16 bits
 *                          y  square root of the density per steradian, and the weight of the ray
 *                             for its lobe, 1 in the mean: two half floats; with debug.reference
 *                             the factor of the radiance, three numbers with a shared exponent (9
 *   bits each and 5) specular_hit, rgba32ui x  distance, a float; below 0: a miss
 *                          of a polygon  y number of the traced instance, z of the triangle, w
 *                             barycentric coordinates of its second and third corner, 16 bits each
 *                          of the SDF    y bit 31 set, then the point's previous minus present
 *                             position, three signed 8-bit numbers with a shared exponent of 7; z
 *                             normal as in the G-buffer, w albedo (sqrt) or radiance as there,
 * roughness, 8 bits each
 */
#ifndef MASU_SPECULAR_RAY_GLSL
#define MASU_SPECULAR_RAY_GLSL

#include "shared/globals.glsl"
#include "shared/pack.glsl"

#define MASU_HIT_SDF 0x80000000u /* bit of y; there are fewer instances */

uint masu_pack_direction(vec3 d)
{
    vec2 p = masu_sane(vec4(masu_oct_encode(d), 0.0, 0.0), -1.0, 1.0).xy;
    return packSnorm2x16(p);
}

vec3 masu_unpack_direction(uint word)
{
    return masu_oct_decode(unpackSnorm2x16(word));
}

/* Least weight of a ray: a texel whose rays all end below the surface would otherwise keep an
 * outdated mean; and the highest. */
const float masu_least_worth = 0.1;
const float masu_most_worth = 4.0;

/* Lobes of mirrors have densities that exceed a half float; their square roots end at 31,600. */
uint masu_pack_drawn(float density, float worth)
{
    return packHalf2x16(vec2(masu_sqrt(masu_sane(density, 1e-6, 1e9)),
                             masu_sane(worth, masu_least_worth, masu_most_worth)));
}

float masu_drawn_density(uint word)
{
    float root = masu_sane(unpackHalf2x16(word).x, 0.0, 65504.0);
    return root * root;
}

float masu_drawn_worth(uint word)
{
    return masu_sane(unpackHalf2x16(word).y, masu_least_worth, masu_most_worth);
}

/* The share of a ray in a mean, given the share of one with the mean's weight. */
float masu_worthy_share(float share, float worth)
{
    return share * worth / max(share * worth + 1.0 - share, 1e-6);
}

/* Three numbers of 0 to 65280 with a shared exponent (VK_FORMAT_E5B9G9R9), rounded up with the
 * probability of the fraction; `chance` is uniform in 0..1. The mean of many is exact, while
 * rounding to nearest would bias the identical values of a mirror. The largest is kept one step
 * below the range of the exponent for that. */
uint masu_pack_shared(vec3 v, float chance)
{
    vec3 c = masu_sane(v, 0.0, 65280.0);
    float most = max(max(c.r, c.g), max(c.b, 1.0 / 65536.0)) * (512.0 / 511.0);
    int e = int(floatBitsToUint(most) >> 23) - 127 + 1;
    e = clamp(e, -15, 16);
    float scale = uintBitsToFloat(uint(127 + 9 - e) << 23);
    uvec3 m = min(uvec3(c * scale + chance), uvec3(511u));
    return m.r | m.g << 9 | m.b << 18 | uint(e + 15) << 27;
}

vec3 masu_unpack_shared(uint word)
{
    float scale = uintBitsToFloat(((word >> 27) + 127u - 24u) << 23);
    return vec3(word & 511u, word >> 9 & 511u, word >> 18 & 511u) * scale;
}

/* Length of the ray; negative: a miss. */
float masu_met_at(uvec4 hit)
{
    return masu_sane(uintBitsToFloat(hit.x), -1.0, frame.trace_anchor.w);
}

/* A displacement as y of an SDF hit: within 1/127 of its longest coordinate, up to 2^63; shorter
 * than 2^-63 is 0. */
uint masu_pack_sdf_motion(vec3 v)
{
    vec3 c = masu_sane(v, -9e18, 9e18);
    float most = max(abs(c.x), max(abs(c.y), abs(c.z)));
    int e = int(floatBitsToUint(most) >> 23) - 126; /* most < 2^e */
    if (e < -62) {
        return MASU_HIT_SDF;
    }
    ivec3 m = ivec3(
        round(clamp(c * uintBitsToFloat(uint(127 + 7 - e) << 23), vec3(-127.0), vec3(127.0))));
    uvec3 bits = uvec3(m) & 255u;
    return MASU_HIT_SDF | bits.x | bits.y << 8 | bits.z << 16 | uint(e + 63) << 24;
}

vec3 masu_unpack_sdf_motion(uint word)
{
    int e = int(word >> 24 & 127u) - 63;
    ivec3 m = ivec3(word << 24, word << 16, word << 8) >> 24;
    return vec3(m) * uintBitsToFloat(uint(127 - 7 + e) << 23);
}

#endif
