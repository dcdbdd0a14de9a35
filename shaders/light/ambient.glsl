/*
 * ambient.glsl: light from the sky at a surface: irradiance (masu_ambient) and reflection
 * (masu_ambient_mirror).
 *
 * frame.irradiance holds irradiance / pi by the normal: nine coefficients of spherical harmonics,
 * and in their w the parts of a sky that exceed order 2: a lobe around the sun (rgb in 0..2,
 * direction in 3..5) and P4 of y (rgb in 6..8). src/frame/sky.h defines them. For a constant
 * ambient light only the first is not 0.
 *
 * After light/sky.glsl.
 */
#ifndef MASU_AMBIENT_GLSL
#define MASU_AMBIENT_GLSL

#include "shared/sky.h"

vec3 masu_glow_color()
{
    return vec3(frame.irradiance[0].w, frame.irradiance[1].w, frame.irradiance[2].w);
}

vec3 masu_glow_direction()
{
    return vec3(frame.irradiance[3].w, frame.irradiance[4].w, frame.irradiance[5].w);
}

vec3 masu_band_1(vec3 n)
{
    return frame.irradiance[1].rgb * n.x + frame.irradiance[2].rgb * n.y +
           frame.irradiance[3].rgb * n.z;
}

vec3 masu_band_2(vec3 n)
{
    return frame.irradiance[4].rgb * (n.x * n.y) + frame.irradiance[5].rgb * (n.y * n.z) +
           frame.irradiance[6].rgb * (n.z * n.x) +
           frame.irradiance[7].rgb * (3.0 * n.y * n.y - 1.0) +
           frame.irradiance[8].rgb * (n.x * n.x - n.z * n.z);
}

/* Irradiance / pi on a surface of unit normal n: the light that a white surface reflects. */
vec3 masu_ambient(vec3 n)
{
    float y2 = n.y * n.y;
    float p4 = (35.0 * y2 * y2 - 30.0 * y2 + 3.0) * 0.125;
    float towards = dot(n, masu_glow_direction());
    float corner = max(towards + MASU_SKY_ROUND, 0.0);
    float lobe =
        towards > MASU_SKY_ROUND ? towards : corner * corner * (0.25 / MASU_SKY_ROUND);
    vec3 ring = vec3(frame.irradiance[6].w, frame.irradiance[7].w, frame.irradiance[8].w);
    vec3 sum = frame.irradiance[0].rgb + masu_band_1(n) + masu_band_2(n) +
               lobe * masu_glow_color() + p4 * ring;
    return max(masu_sane(sum, -1e9, 1e9), vec3(0.0));
}

/* Bands 1 and 2 of a GGX lobe's average for a roughness, viewed from above and weighted by the
 * cosine (Karis, Real Shading in Unreal Engine 4, SIGGRAPH 2013 course): our fits, within 0.002 and
 * 0.006. At roughness 1 they equal the bands of the cosine. */
vec2 masu_lobe_bands(float roughness)
{
    float r = roughness;
    vec2 lost = r * r *
                (vec2(-0.0815037, 0.0255910) +
                 r * (vec2(2.8173808, 6.6842436) +
                      r * (vec2(-4.0033292, -10.3014656) + r * vec2(1.6007921, 4.3416570))));
    return clamp(1.0 - lost, vec2(0.0), vec2(1.0));
}

/* The order-2 sky, blurred by lobes of those bands. The lobe of the glow has the Legendre bands 1/4
 * + w^2 / 12, 1/2 and 5/16 - 5/24 w^2 + w^4 / 16. */
vec3 masu_ambient_bands(vec3 d, vec2 bands)
{
    const float w2 = MASU_SKY_ROUND * MASU_SKY_ROUND;
    float c = clamp(dot(d, masu_glow_direction()), -1.0, 1.0);
    vec3 glow = masu_glow_color();
    vec3 zero = frame.irradiance[0].rgb + glow * (0.25 + w2 / 12.0);
    vec3 one = masu_band_1(d) + glow * (0.5 * c);
    vec3 two = masu_band_2(d) + glow * ((0.3125 - 5.0 / 24.0 * w2 + w2 * w2 / 16.0) *
                                        (1.5 * c * c - 0.5));
    /* The bands of irradiance are 2/3 and 1/4 of the bands of radiance. */
    return max(zero + one * (1.5 * bands.x) + two * (4.0 * bands.y), vec3(0.0));
}

/* Radiance of the sky as the k-th of nine normalised spherical harmonics: 1; y, z, x; xy, yz, 3z^2
 * - 1, xz, x^2 - y^2 (Ramamoorthi and Hanrahan 2001), for users with tables of these:
 * light/probes.glsl. The glow has its own bands; P4 is omitted. */
vec3 masu_sky_harmonic(uint k)
{
    const float w2 = MASU_SKY_ROUND * MASU_SKY_ROUND;
    vec3 glow = masu_glow_color();
    vec3 d = masu_glow_direction();
    vec3 first = glow * (0.25 + w2 / 12.0);
    vec3 second = glow * 0.5;
    vec3 third = glow * (0.3125 - 5.0 / 24.0 * w2 + w2 * w2 / 16.0);
    vec3 p = frame.irradiance[7].rgb;
    vec3 q = frame.irradiance[8].rgb;
    switch (k) {
    case 0u: return (frame.irradiance[0].rgb + first) / 0.282095;
    case 1u: return (frame.irradiance[2].rgb + second * d.y) * (1.5 / 0.488603);
    case 2u: return (frame.irradiance[3].rgb + second * d.z) * (1.5 / 0.488603);
    case 3u: return (frame.irradiance[1].rgb + second * d.x) * (1.5 / 0.488603);
    case 4u: return (frame.irradiance[4].rgb + third * (3.0 * d.x * d.y)) * (4.0 / 1.092548);
    case 5u: return (frame.irradiance[5].rgb + third * (3.0 * d.y * d.z)) * (4.0 / 1.092548);
    case 6u: return (third * (0.75 * d.z * d.z - 0.25) - 0.5 * (p + q)) * (4.0 / 0.315392);
    case 7u: return (frame.irradiance[6].rgb + third * (3.0 * d.z * d.x)) * (4.0 / 1.092548);
    default:
        return (third * (0.75 * (d.x * d.x - d.y * d.y)) + 0.5 * q - 1.5 * p) * (4.0 / 0.546274);
    }
}

/* The sky that a surface of a roughness reflects from a mirror direction, without the sun: 0 is the
 * sky itself, 1 its irradiance / pi. */
vec3 masu_ambient_mirror(vec3 direction, float roughness)
{
    if (!masu_sky_is_analytic()) {
        if (masu_has_environment) {
            return masu_environment(direction, roughness);
        }
        return mix(masu_sky_gradient(direction), frame.ambient.rgb, roughness);
    }
    vec2 bands = masu_lobe_bands(clamp(roughness, 0.0, 1.0));
    float blend = smoothstep(0.15, 0.85, roughness);
    vec3 blurred = vec3(0.0);
    if (blend < 1.0) {
        /* Three evaluations with powers cost more than all other lighting of a pixel: from 0.4 on a
         * table is read. */
        float tabled = clamp(10.0 * roughness - 3.0, 0.0, 1.0);
        if (tabled < 1.0) {
            blurred = (1.0 - tabled) * masu_sky_blurred(direction, bands.x, bands.y);
        }
        if (tabled > 0.0) {
            blurred += tabled * masu_sky_rough(direction);
        }
    }
    /* Last: earlier it would occupy registers during the evaluations. */
    return mix(blurred, masu_sane(masu_ambient_bands(direction, bands), 0.0, 1e9), blend);
}

#endif
