/*
 * guard.glsl: functions that GLSL leaves undefined on part of their domain, made total.
 *
 * Drivers disagree on every one of these: pow(-1, 2.2) is NaN or 1, log2(0) is -Inf or -127,
 * max(1, NaN) is 1 or NaN, a denormal is kept or flushed, and isnan() itself may be optimised away.
 * So finiteness is tested on the bits, operands are repaired before the operation (a select after
 * it would still evaluate the bad arm), and each function states what it returns outside its
 * natural domain. For any bit pattern in, all but masu_pow_above return a finite value.
 *
 * Shaders call these, never the raw normalize, inversesqrt, sqrt, pow, log2, exp2, acos, atan.
 */
#ifndef MASU_GUARD_GLSL
#define MASU_GUARD_GLSL

/* Below this a float may be flushed, and its reciprocal or square may leave the range. */
const float masu_tiny = 1e-30;
const float masu_huge = 1e30;

const uint masu_exponent_mask = 0x7F800000u;

bool masu_finite(float x)
{
    return (floatBitsToUint(x) & masu_exponent_mask) != masu_exponent_mask;
}

bvec3 masu_not_finite(vec3 v)
{
    return equal(floatBitsToUint(v) & masu_exponent_mask, uvec3(masu_exponent_mask));
}

bvec4 masu_not_finite(vec4 v)
{
    return equal(floatBitsToUint(v) & masu_exponent_mask, uvec4(masu_exponent_mask));
}

bool masu_finite(vec3 v)
{
    return !any(masu_not_finite(v));
}

bool masu_finite(vec4 v)
{
    return !any(masu_not_finite(v));
}

/* NaN and +-Inf become 0, then the value is clamped to lo..hi. */
float masu_sane(float x, float lo, float hi)
{
    return clamp(masu_finite(x) ? x : 0.0, lo, hi);
}

vec3 masu_sane(vec3 v, float lo, float hi)
{
    return clamp(mix(v, vec3(0.0), masu_not_finite(v)), lo, hi);
}

vec4 masu_sane(vec4 v, float lo, float hi)
{
    return clamp(mix(v, vec4(0.0), masu_not_finite(v)), lo, hi);
}

/* masu_sane(v, 0, 1) in one test: as unsigned integers, +Inf, NaN and all negative numbers are the
 * patterns from 0x7F800000 up. For colour fetches, where it runs dozens of times a pixel. */
vec3 masu_sane_unit(vec3 v)
{
    bvec3 bad = greaterThanEqual(floatBitsToUint(v), uvec3(masu_exponent_mask));
    return min(mix(v, vec3(0.0), bad), 1.0);
}

float masu_sane_unit(float x)
{
    return min(floatBitsToUint(x) >= masu_exponent_mask ? 0.0 : x, 1.0);
}

/* 1/x; 0 for |x| < 1e-30, NaN and Inf. */
float masu_rcp(float x)
{
    bool usable = masu_finite(x) && abs(x) > masu_tiny;
    float r = 1.0 / (usable ? x : 1.0);
    return usable ? r : 0.0;
}

/* Square root; 0 for negative, NaN and Inf. */
float masu_sqrt(float x)
{
    return sqrt(max(masu_finite(x) ? x : 0.0, 0.0));
}

/* 1/sqrt(x); 0 for x < 1e-30 (negative too), NaN and Inf. */
float masu_rsqrt(float x)
{
    bool usable = masu_finite(x) && x > masu_tiny;
    float r = inversesqrt(usable ? x : 1.0);
    return usable ? r : 0.0;
}

/* masu_rsqrt() for an x within 1e-30..1e30. */
float masu_rsqrt_sure(float x)
{
    return inversesqrt(x);
}

/* log2(x) for x from 1e-30; smaller, negative and non-finite operands become 1e-30 (-99.66). */
float masu_log2(float x)
{
    return log2(max(masu_finite(x) ? x : 0.0, masu_tiny));
}

/* 2^x with x clamped to +-126, so neither Inf nor a denormal; 1 for NaN and Inf. */
float masu_exp2(float x)
{
    return exp2(masu_sane(x, -126.0, 126.0));
}

/* x^y for a base that means "at least 0": other bases (negative, NaN, Inf) become 0, and so does
 * anything below 1e-30. 0^y = 0 for y other than 0: no light rather than infinite light. x^0 = 1.
 * The result is within 2^+-126. */
float masu_pow(float x, float y)
{
    float exponent = masu_finite(y) ? y : 0.0;
    bool positive = masu_finite(x) && x > masu_tiny;
    /* 2^-99 < base and |exponent| <= 1e30 keep the product finite; masu_exp2 clamps it. */
    float power = log2(positive ? x : 1.0) * clamp(exponent, -masu_huge, masu_huge);
    float r = masu_exp2(power);
    return positive ? r : (exponent == 0.0 ? 1.0 : 0.0);
}

/* x^y for x above 0. Any other x gives any value, even NaN: only for results that are discarded
 * then. */
float masu_pow_above(float x, float y)
{
    return exp2(log2(x) * y);
}

/* acos of x clamped to [-1,1]; pi/2 (that of 0) for NaN and Inf. */
float masu_acos(float x)
{
    return acos(masu_sane(x, -1.0, 1.0));
}

/* atan(y, x); 0 at the origin and where an operand is not finite. Both are first divided by the
 * larger one, since a quotient of huge or of tiny operands could overflow inside the function; and
 * y loses its sign, since a driver returns pi for atan(-0.0, 1.0). A y of -0 becomes 0. */
float masu_atan2(float y, float x)
{
    float largest = max(abs(x), abs(y));
    bool usable = masu_finite(x) && masu_finite(y) && largest > masu_tiny && largest < masu_huge;
    float scale = 1.0 / (usable ? largest : 1.0);
    float r = atan(usable ? abs(y) * scale : 0.0, usable ? x * scale : 1.0);
    return usable ? (y < 0.0 ? -r : r) : 0.0;
}

/* v at unit length; fallback where v is not finite or its largest component is not within
 * 1e-30..1e30. Scaling by that component first keeps the squared length within 1..3, so 1e-20 and
 * 1e20 long vectors, whose squares leave the range, still normalise. */
vec3 masu_normalize(vec3 v, vec3 fallback)
{
    float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    bool usable = masu_finite(v) && largest > masu_tiny && largest < masu_huge;
    vec3 u = (usable ? v : vec3(1.0, 0.0, 0.0)) / (usable ? largest : 1.0);
    u *= inversesqrt(u.x * u.x + u.y * u.y + u.z * u.z);
    return usable ? u : fallback;
}

/* findLSB of a value other than 0, from the exponent of only its lowest bit: no vector instruction
 * of a CPU does findLSB. */
uint masu_low_bit(uint bits)
{
    return (floatBitsToUint(float(bits & (~bits + 1u))) >> 23) - 127u;
}

#endif
