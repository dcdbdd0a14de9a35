/*
 * output.glsl: how compute passes store colour after the tone curve: MASU_STORE_COLOR. The last
 * pass of a rung converts to the encoding of the target.
 *
 * Between the tone curve and the target, images are display-encoded for EASU and RCAS: sRGB in
 * 0..1, or SMPTE ST 2084 of nits, also in 0..1, for targets brighter than white. The last pass of a
 * rung (output_flags of the push constants) stores the target's encoding: linear light, or values
 * that are quantised and dithered to output_steps. Earlier passes do not dither, because EASU and
 * RCAS would sharpen the noise.
 *
 * Dither: floor(v s + u) for a target of s steps, with u of dither.glsl, uniform in 0..1. The mean
 * is v, and a v that is exactly a step is unchanged for every u, so black and white have no
 * noise. (Triangular noise has a variance that does not depend on v, but also affects black and
 * white.)
 *
 * MASU_OUTPUT: the image is of a scene; only then set 0 is used. MASU_DEEP: images are rgba16f.
 * MASU_TEN: an intermediate image with 10 bits, because RCAS amplifies earlier rounding errors up
 * to seven times. Otherwise images are rgba8.
 */
#ifndef MASU_OUTPUT_GLSL
#define MASU_OUTPUT_GLSL

#include "shared/target.h"
#include "shared/store.glsl"

#if defined(MASU_TEN)
#define MASU_COLOR_FORMAT r32ui
#define MASU_COLOR_IMAGE uimage2D
#elif defined(MASU_DEEP)
#define MASU_COLOR_FORMAT rgba16f
#define MASU_COLOR_IMAGE image2D
#else
#define MASU_COLOR_FORMAT rgba8
#define MASU_COLOR_IMAGE image2D
#endif

#ifdef MASU_OUTPUT
#include "shared/globals.glsl"
#include "shared/dither.glsl"
#include "shared/tone.glsl"

layout(constant_id = 6) const uint masu_encoding = MASU_OUTPUT_SRGB;
/* false: the last pass does not round or swap */
layout(constant_id = 7) const bool masu_finishes = true;

bool masu_is_last()
{
    return (pc.output_flags & MASU_OUTPUT_LAST) != 0u;
}

/* Quantises v to the steps of the target; steps 0: returns v. */
float masu_rounded(float v, uint steps, uint noise)
{
    bool dither = (pc.output_flags & MASU_OUTPUT_DITHER) != 0u;
    float u = dither ? float(noise >> 8) * (1.0 / 16777216.0) : 0.5;
    float s = float(max(steps, 1u));
    precise float scaled = masu_sane(v, 0.0, 1.0) * s;
    /* A step that was stored in 8 bits or a half may be one ulp too low. */
    float near = floor(scaled + 0.5);
    float down = abs(scaled - near) < 1e-3 ? near : floor(scaled + u);
    return steps == 0u ? v : min(down, s) / s;
}

vec3 masu_stepped(vec3 v, uvec2 at)
{
    uvec3 noise = masu_dither(at);
    uint steps = pc.output_steps;
    return vec3(masu_rounded(v.r, steps & 1023u, noise.r),
                masu_rounded(v.g, steps >> 10 & 1023u, noise.g),
                masu_rounded(v.b, steps >> 20 & 1023u, noise.b));
}

/* The value to store for a display-encoded colour. */
vec3 masu_output(vec3 v, uvec2 at)
{
    if (!masu_is_last()) {
        return v;
    }
    if (masu_encoding == MASU_OUTPUT_LINEAR) {
        return vec3(masu_pq_decode(v.r), masu_pq_decode(v.g), masu_pq_decode(v.b)) * (1.0 / 80.0);
    }
    if (!masu_finishes) {
        return v;
    }
    vec3 stepped = pc.output_steps != 0u ? masu_stepped(v, at) : v;
    return (pc.output_flags & MASU_OUTPUT_SWAP) != 0u ? stepped.bgr : stepped;
}

#ifdef MASU_DEEP
/* Rounds v, in 0 to 65504, to the nearest half: some drivers truncate, and a truncated step of 10
 * bits would become the step below. Below 2^-14 the rounding is finer than necessary. */
vec3 masu_nearest_half(vec3 v)
{
    uvec3 bits = floatBitsToUint(v) + 0xFFFu + (floatBitsToUint(v) >> 13 & 1u);
    return uintBitsToFloat(bits & 0xFFFFE000u);
}

#define MASU_STORE_COLOR(img, p, v)                                                                \
    MASU_STORE_HALF(img, p, vec4(masu_nearest_half(masu_output(v, uvec2(p))), 1.0))
#elif !defined(MASU_TEN)
#define MASU_STORE_COLOR(img, p, v) MASU_STORE_UNORM(img, p, vec4(masu_output(v, uvec2(p)), 1.0))
#define MASU_STORE_FILTERED(img, p, v) MASU_STORE_SAFE(img, p, vec4(masu_output(v, uvec2(p)), 1.0))
#endif

#else /* from a source image, or an intermediate image: stored unchanged */

#include "shared/push.glsl"

#ifndef MASU_TEN
#define MASU_STORE_COLOR(img, p, v) MASU_STORE_UNORM(img, p, vec4((v), 1.0))
#define MASU_STORE_FILTERED(img, p, v) MASU_STORE_SAFE(img, p, vec4((v), 1.0))
#endif
#endif

#ifdef MASU_TEN
#define MASU_STORE_COLOR(img, p, v) MASU_STORE_TEN(img, p, v)
#define MASU_STORE_FILTERED(img, p, v) MASU_STORE_SAFE(img, p, uvec4(masu_ten_bits(v)))
#endif

/* For passes at the output size: whether the output is a multiple of the workgroup size (720, 1080
 * and 2160 rows are), so that no invocation is outside. */
layout(constant_id = 8) const bool masu_whole_groups = false;
/* Images of the output size are never larger than the output. */
layout(constant_id = 13) const bool masu_fixed_output = false;

bool masu_is_outside(uvec2 at)
{
    return !masu_whole_groups &&
           any(greaterThanEqual(at, uvec2(pc.output_width, pc.output_height)));
}

/* MASU_STORE_FILTERED: for a weighted mean of texels in 0..1, at a pixel inside the output: it
 * needs no guard. */
#if defined(MASU_DEEP) || defined(MASU_EXACT)
#undef MASU_STORE_FILTERED
#define MASU_STORE_FILTERED MASU_STORE_COLOR
#endif

#endif
