/*
 * tone.glsl: tone curves, encodings, and the bins of luminance that exposure is metered by. Total:
 * NaN and negative input is black; +Inf and values above 65504 count as 65504, the largest half.
 *
 * Curves, of radiance times exposure, where 1 is white (include/masu.h, masu_tone):
 *   filmic   K. Narkowicz's rational fit of the ACES reference rendering transform ("ACES Filmic
 *            Tone Mapping Curve", 2016). It reaches 1 near x = 8.1 and would run past it
 *   neutral  Khronos PBR Neutral (Khronos 2024, E. Lalish): the reflection of 0.04 that every
 *            dielectric adds is taken off; the rest is unchanged below 0.76 of the most; above,
 *            the largest channel bends towards the most, and the others go towards it as it bends.
 *            With a display that goes beyond white, "the most" is that of the display
 */
#ifndef MASU_TONE_GLSL
#define MASU_TONE_GLSL

#include "shared/exposure.h"
#include "shared/guard.glsl"

/* Radiance as the curves take it: 1e4 is far past white, and keeps their squares in range. */
vec3 masu_exposed(vec3 hdr, float exposure)
{
    /* Layers whose sum exceeds a half float are bright, not invalid. */
    hdr = mix(hdr, vec3(65504.0), equal(floatBitsToUint(hdr), uvec3(masu_exponent_mask)));
    return masu_sane(hdr * exposure, 0.0, 1e4);
}

vec3 masu_tone_filmic(vec3 x)
{
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

vec3 masu_tone_neutral(vec3 x, float most)
{
    float least = min(x.r, min(x.g, x.b));
    x = max(x - (least < 0.08 ? least - 6.25 * least * least : 0.04), 0.0);
    float peak = max(x.r, max(x.g, x.b)), start = 0.76 * most, room = most - start;
    if (peak < start) {
        return x;
    }
    float bent = most - room * room / (peak + room - start); /* the divisor is room at least */
    float grey = 1.0 - 1.0 / (0.15 * (peak - bent) + 1.0);
    return mix(x * (bent / peak), vec3(bent), grey);
}

layout(constant_id = 5) const uint masu_tone = 2;

/* Display-linear colour of a radiance by the tone curve; most: the highest output, in whites. */
vec3 masu_shown(vec3 hdr, float exposure, float most)
{
    vec3 x = masu_exposed(hdr, exposure);
    return masu_tone == 1u ? x : masu_tone == 2u ? masu_tone_filmic(x) : masu_tone_neutral(x, most);
}

/* IEC 61966-2-1, linear to encoded. */
float masu_srgb_encode(float x)
{
    return x <= 0.0031308 ? 12.92 * max(x, 0.0) : 1.055 * masu_pow(min(x, 1.0), 1.0 / 2.4) - 0.055;
}

/* masu_srgb_encode() of any number; values below 0 or above 1 remain outside. */
float masu_srgb_encode_open(float x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * masu_pow_above(x, 1.0 / 2.4) - 0.055;
}

/* Encoded to linear; x 0..1. */
float masu_srgb_decode(float x)
{
    return x <= 0.04045 ? x / 12.92 : masu_pow((x + 0.055) / 1.055, 2.4);
}

/* SMPTE ST 2084: 10000 nits are 1. */
const float masu_pq_m1 = 2610.0 / 16384.0;
const float masu_pq_m2 = 2523.0 / 32.0;
const float masu_pq_c1 = 3424.0 / 4096.0;
const float masu_pq_c2 = 2413.0 / 128.0;
const float masu_pq_c3 = 2392.0 / 128.0;

float masu_pq_encode(float nits)
{
    float y = masu_pow(clamp(nits * 1e-4, 0.0, 1.0), masu_pq_m1);
    return masu_pow((masu_pq_c1 + masu_pq_c2 * y) / (1.0 + masu_pq_c3 * y), masu_pq_m2);
}

float masu_pq_decode(float code)
{
    float y = masu_pow(clamp(code, 0.0, 1.0), 1.0 / masu_pq_m2);
    /* The denominator is c2 - c3 = 0.164 at least. */
    return 1e4 *
           masu_pow(max(y - masu_pq_c1, 0.0) / (masu_pq_c2 - masu_pq_c3 * y), 1.0 / masu_pq_m1);
}

/* Primaries of BT.709 to those of BT.2020 (BT.2087). */
vec3 masu_bt2020(vec3 c)
{
    return vec3(dot(vec3(0.6274, 0.3293, 0.0433), c), dot(vec3(0.0691, 0.9195, 0.0114), c),
                dot(vec3(0.0164, 0.0880, 0.8956), c));
}

/* Luminance of BT.709. */
float masu_luminance(vec3 c)
{
    precise float luminance = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
    return luminance;
}

/* Bins are along the bits of the float, eight to an octave: evenly spaced in log2 from octave to
 * octave and evenly in luminance within one, the same on every driver, which log2() is not. Pixels
 * that are black or not finite are in none: EXPOSURE_BINS. */
uint masu_luminance_bin(vec3 c)
{
    const uint first = uint(127 + MASU_EXPOSURE_LOG2) << 3;
    float luminance = masu_luminance(c);
    bool counts = masu_finite(c) && masu_finite(luminance) && luminance > masu_tiny;
    uint place = floatBitsToUint(counts ? luminance : 0.0) >> 20;
    return place < first ? uint(MASU_EXPOSURE_BINS)
                         : min(place - first, uint(MASU_EXPOSURE_BINS) - 1u);
}

#endif
