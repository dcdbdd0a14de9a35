/*
 * color.glsl: colour conversions of anti-aliasing. It blends linear light, so colours are decoded
 * first; edges are detected in the encoded output.
 */
#ifndef MASU_SMAA_COLOR_GLSL
#define MASU_SMAA_COLOR_GLSL

#include "shared/guard.glsl"

/* Rec. 709 luma times 10000, of a colour in whole steps of 8 bits: up to 2 550 000, a whole number
 * that fp32 holds exactly, so that every driver finds the same edges. Finer steps of a deeper image
 * make no edge. */
float masu_smaa_luma(vec3 color)
{
    vec3 steps = roundEven(masu_sane_unit(color) * 255.0);
    return dot(steps, vec3(2126.0, 7152.0, 722.0));
}

/* IEC 61966-2-1. */
float masu_decode(float x)
{
    return x <= 0.04045 ? x * (1.0 / 12.92) : masu_pow((x + 0.055) * (1.0 / 1.055), 2.4);
}

vec3 masu_decode(vec3 c)
{
    vec3 v = masu_sane_unit(c);
    return vec3(masu_decode(v.r), masu_decode(v.g), masu_decode(v.b));
}

float masu_encode(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * masu_pow(x, 1.0 / 2.4) - 0.055;
}

vec3 masu_encode(vec3 c)
{
    return vec3(masu_encode(c.r), masu_encode(c.g), masu_encode(c.b));
}

#endif
