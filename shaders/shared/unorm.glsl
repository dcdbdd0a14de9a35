/*
 * unorm.glsl: a fetched colour of 0..1, prepared for EASU and RCAS.
 *
 * The byte c is fetched as c/255 rounded, or as c * (1/255) with an error of one unit in the last
 * bit, depending on the driver; 10 bits likewise. If a filter decides by equality (EASU: do these
 * texels have the same luma?) or ends on a rounding tie (RCAS: quarters of a step are common), that
 * unit becomes a difference of up to 33/255, respectively 1/255, from the reference. With
 * MASU_EXACT (debug.exact) both become the same number on every driver; that is two thirds of
 * EASU's operations, so it is only for comparing drivers.
 *
 * MASU_BYTES: for an image format that only holds 0..1: no guard is needed.
 */
#ifndef MASU_UNORM_GLSL
#define MASU_UNORM_GLSL

#include "shared/guard.glsl"

#ifdef MASU_EXACT
/* NaN, Inf and negative numbers as 0, larger ones as 1. A value within rounding of a step of 8 or
 * of 10 bits is moved onto it; steps of the two that differ are farther apart by 20 times. Other
 * values are unchanged. c 257/65536 + c/16711680 = c/255, c 1025/1048576 + c/1072693248 = c/1023:
 * the first product is exact, and the sum is right for every c. */
vec3 masu_fetched_unorm(vec3 fetched)
{
    vec3 v = masu_sane_unit(fetched);
    precise vec3 bytes = v * 255.0;
    precise vec3 byte = roundEven(bytes);
    precise vec3 byte_tail = byte * (1.0 / 16711680.0);
    precise vec3 of_bytes = byte * (257.0 / 65536.0) + byte_tail;
    precise vec3 tens = v * 1023.0;
    precise vec3 ten = roundEven(tens);
    precise vec3 ten_tail = ten * (1.0 / 1072693248.0);
    precise vec3 of_tens = ten * (1025.0 / 1048576.0) + ten_tail;
    v = mix(v, of_tens, lessThan(abs(tens - ten), vec3(1.0 / 2048.0)));
    return mix(v, of_bytes, lessThan(abs(bytes - byte), vec3(1.0 / 8192.0)));
}
#elif defined(MASU_BYTES)
vec3 masu_fetched_unorm(vec3 v)
{
    return v;
}
#else
/* NaN, Inf and negative numbers as 0, larger ones as 1. */
vec3 masu_fetched_unorm(vec3 fetched)
{
    return masu_sane_unit(fetched);
}
#endif

#endif
