/*
 * output.glsl: how colour passes store what they make. Compute; a source of set 0 only where
 * MASU_OUTPUT says that the picture is a scene's.
 *
 * Between tone curve and target the picture is display-encoded, as EASU and RCAS want it: sRGB in
 * 0..1; for targets that go beyond white, SMPTE ST 2084 of nits, in 0..1 too. The pass that comes last
 * in its rung (output_flags of the push constants) stores what the target wants: in linear encoding it
 * decodes, else it rounds to the target's steps, where output_steps says so. Nothing before it does: EASU
 * and RCAS would sharpen the noise.
 *
 * Dither: a step s of the target is taken with the share of the pixels that lies between: floor(v s +
 * u), u evenly in 0..1. Its mean is v, and a v that is a step stays one whatever u is: 0 and 1 do.
 * (Triangular noise has a variance that does not depend on v, but is there in black and white too.)
 * u is that of dither.glsl.
 *
 * MASU_OUTPUT: of a scene. MASU_DEEP: images are rgba16f. MASU_TEN: what is stored is not the last, and has
 * 10 bits: RCAS makes up to seven times as much of what rounding has lost before it. Else: rgba8.
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
layout(constant_id = 7) const bool masu_finishes = true; /* false: what comes last rounds and swaps nothing */

bool masu_is_last()
{
    return (pc.output_flags & MASU_OUTPUT_LAST) != 0u;
}

/* To the steps of the target; 0: as it is. */
float masu_rounded(float v, uint steps, uint noise)
{
    bool dither = (pc.output_flags & MASU_OUTPUT_DITHER) != 0u;
    float u = dither ? float(noise >> 8) * (1.0 / 16777216.0) : 0.5;
    float s = float(max(steps, 1u));
    precise float scaled = masu_sane(v, 0.0, 1.0) * s;
    /* A step that came back from 8 bits or a half may lie an ulp below itself. */
    float near = floor(scaled + 0.5);
    float down = abs(scaled - near) < 1e-3 ? near : floor(scaled + u);
    return steps == 0u ? v : min(down, s) / s;
}

vec3 masu_stepped(vec3 v, uvec2 at)
{
    uvec3 noise = masu_dither(at);
    uint steps = pc.output_steps;
    return vec3(masu_rounded(v.r, steps & 1023u, noise.r), masu_rounded(v.g, steps >> 10 & 1023u, noise.g),
                masu_rounded(v.b, steps >> 20 & 1023u, noise.b));
}

/* What to store of display-encoded colour. */
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
/* v of at least 0 and less than 65504 rounded to what a half holds: some drivers cut off the rest, and a
 * step of 10 bits less half of one is no longer that step. Below 2^-14 halves are finer than needed. */
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

#else /* of a source image, or not the last: as it is */

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

/* For passes of the size of the output. Whether it is made of whole workgroups, as 720, 1080 and 2160 rows
 * are: then no invocation lies outside. */
layout(constant_id = 8) const bool masu_whole_groups = false;
layout(constant_id = 13) const bool masu_fixed_output = false; /* images of that size are never larger than the picture */

bool masu_is_outside(uvec2 at)
{
    return !masu_whole_groups && any(greaterThanEqual(at, uvec2(pc.output_width, pc.output_height)));
}

/* MASU_STORE_FILTERED: for a mean of fetched texels of 0..1, at a pixel of the picture: nothing is left to guard. */
#if defined(MASU_DEEP) || defined(MASU_EXACT)
#undef MASU_STORE_FILTERED
#define MASU_STORE_FILTERED MASU_STORE_COLOR
#endif

#endif
