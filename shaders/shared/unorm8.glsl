/*
 * unorm8.glsl: makes a fetched 8-bit colour the same number on every driver.
 *
 * The byte c arrives as c/255 rounded, or as c * (1/255) one unit in the last place beside it,
 * depending on the driver. Where a filter decides by equality (EASU: do these texels have the same
 * luma?) or ends on a rounding tie (RCAS: quarters of a step are common), that unit becomes up to
 * 33/255, respectively 1/255, of difference from the reference.
 */
#ifndef MASU_UNORM8_GLSL
#define MASU_UNORM8_GLSL

#include "shared/guard.glsl"

#ifdef MASU_BYTES
/* As below, of an image that is known to have 8 bits: there is nothing else that it could hold. */
vec3 masu_fetched_unorm8(vec3 v)
{
    precise vec3 whole = roundEven(v * 255.0);
    precise vec3 tail = whole * (1.0 / 16711680.0);
    precise vec3 exact = whole * (257.0 / 65536.0) + tail;
    return exact;
}
#else
/* v of 0..1, NaN, Inf and negative numbers as 0, larger ones as 1. Values within 2^-13 of a step of
 * 8 bits are moved onto c/255, correctly rounded: 257/65536 + 1/16711680 = 1/255, the first product
 * is exact, and the sum is right for all 256 steps. Others (inputs of more bits) stay. */
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
