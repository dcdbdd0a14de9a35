/*
 * fog.glsl: fog whose density falls with height: density * exp(-falloff * (y - fog height)), clear
 * up to a start distance. The optical depth along a straight ray has a closed form (Lengyel,
 * "Unified Distance Formulas for Halfspace Fog", JGT 12-2, 2007, for linear density):
 *
 *   depth = density(lower end) * length * mean(falloff * |climb| * length)
 *   mean(x) = (1 - e^-x) / x
 *
 * Evaluated from the lower end upwards in either direction: from the camera, a descending ray would
 * be a small number times one that overflows. mean(x) is a series where 1 - e^-x cancels, so the
 * horizon needs no special case.
 *
 * Only scalars, in the common subset of C and GLSL: tests/unit/test_fog.c compiles this file. Any
 * input gives a depth of 0..masu_fog_most.
 */
#ifndef MASU_FOG_GLSL
#define MASU_FOG_GLSL

#include "shared/guard.glsl"

const float masu_fog_most = 64.0; /* no format can hold e^-64 */
const float masu_fog_far = 1e15;  /* metres; larger squares and products stay finite */

/* (1 - e^-x) / x for x >= 0. */
float masu_fog_mean(float x)
{
    float series = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0))));
    float closed = (1.0 - masu_exp2(-1.44269504 * min(x, 80.0))) / max(x, 0.125);
    return x < 0.125 ? series : closed;
}

/* Density at that height, per metre; at most 1e15. */
float masu_fog_density_at(float density, float falloff, float height)
{
    float fallen = clamp(falloff * height, -85.0, 85.0);
    return min(density * masu_exp2(-1.44269504 * fallen), 1e15);
}

/* height: of the camera above the fog height; climb: y of the ray's unit direction; start: where
 * fog begins; far: end of the ray, both in metres along it. */
float masu_fog_depth(float density, float falloff, float height, float climb, float start,
                     float far)
{
    float begin = masu_sane(start, 0.0, masu_fog_far);
    float end = masu_sane(far, 0.0, masu_fog_far);
    float up = masu_sane(climb, -1.0, 1.0);
    float eye = masu_sane(height, -masu_fog_far, masu_fog_far);
    float thinning = masu_sane(falloff, 0.0, 1e15);
    float length = end - begin;
    if (!(length > 0.0)) {
        return 0.0;
    }
    float low = eye + min(up * begin, up * end);
    float dense = masu_fog_density_at(masu_sane(density, 0.0, 1e15), thinning, low);
    return min(dense * (length * masu_fog_mean(thinning * abs(up) * length)), masu_fog_most);
}

/* masu_fog_depth() for an endless ray to the sky. A ray that does not climb out of the fog is fully
 * fogged. */
float masu_fog_depth_sky(float density, float falloff, float height, float climb, float start)
{
    float begin = masu_sane(start, 0.0, masu_fog_far);
    float up = masu_sane(climb, -1.0, 1.0);
    float eye = masu_sane(height, -masu_fog_far, masu_fog_far);
    float thinning = masu_sane(falloff, 0.0, 1e15);
    float dense =
        masu_fog_density_at(masu_sane(density, 0.0, 1e15), thinning, eye + up * begin);
    float rate = thinning * up;
    if (!(rate > masu_tiny)) {
        return dense > 0.0 ? masu_fog_most : 0.0;
    }
    return min(dense / rate, masu_fog_most);
}

/* Transmittance, 0..1. */
float masu_fog_left(float depth)
{
    return min(masu_exp2(-1.44269504 * depth), 1.0);
}

#endif
