/*
 * irradiance.glsl: light from everywhere: what of it arrives at a surface.
 *
 * frame.irradiance holds irradiance / pi by the normal: nine coefficients of spherical harmonics, and
 * in their w what order 2 cannot hold of a sky: a lobe around the sun (rgb in 0..2, direction in 3..5)
 * and P4 of y (rgb in 6..8). src/frame/sky.h says how they are meant. Of a constant ambient light only the
 * first is not 0.
 */
#ifndef MASU_IRRADIANCE_GLSL
#define MASU_IRRADIANCE_GLSL

#include "shared/globals.glsl"

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

/* Irradiance / pi on a surface of unit normal n: what a white surface reflects. */
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

#endif
