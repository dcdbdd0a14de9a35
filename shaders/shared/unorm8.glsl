/*
 * unorm8.glsl: a fetched colour of 0..1, as EASU and RCAS take it.
 *
 * The byte c arrives as c/255 rounded, or as c * (1/255) one unit in the last place beside it,
 * depending on the driver. Where a filter decides by equality (EASU: do these texels have the same
 * luma?) or ends on a rounding tie (RCAS: quarters of a step are common), that unit becomes up to
 * 33/255, respectively 1/255, of difference from the reference. With MASU_EXACT (debug.exact) bytes
 * become the same number on every driver; that is a third of EASU's instructions, so it is for comparing
 * drivers alone.
 *
 * MASU_BYTES: of an image of 8 bits: there is nothing else that it could hold.
 */
#ifndef MASU_UNORM8_GLSL
#define MASU_UNORM8_GLSL

#include "shared/guard.glsl"

#if !defined(MASU_EXACT) && defined(MASU_BYTES)
vec3 masu_fetched_unorm8(vec3 v)
{
    return v;
}
#elif !defined(MASU_EXACT)
/* NaN, Inf and negative numbers as 0, larger ones as 1. */
vec3 masu_fetched_unorm8(vec3 fetched)
{
    return masu_sane_unit(fetched);
}
#elif defined(MASU_BYTES)
/* 257/65536 + 1/16711680 = 1/255, the first product is exact, and the sum is right for all 256 steps. */
vec3 masu_fetched_unorm8(vec3 v)
{
    precise vec3 whole = roundEven(v * 255.0);
    precise vec3 tail = whole * (1.0 / 16711680.0);
    precise vec3 exact = whole * (257.0 / 65536.0) + tail;
    return exact;
}
#else
/* v of 0..1, NaN, Inf and negative numbers as 0, larger ones as 1. Values within 2^-13 of a step of
 * 8 bits are moved onto c/255. Others (inputs of more bits) stay. */
vec3 masu_fetched_unorm8(vec3 fetched)
{
    vec3 v = masu_sane_unit(fetched);
    precise vec3 steps = v * 255.0;
    precise vec3 whole = roundEven(steps);
    precise vec3 tail = whole * (1.0 / 16711680.0);
    precise vec3 exact = whole * (257.0 / 65536.0) + tail;
    return mix(v, exact, lessThan(abs(steps - whole), vec3(1.0 / 8192.0)));
}
#endif

#endif
