/*
 * wide.glsl: numbers of two floats, x + y with |y| at most half an ulp of x: 48 bits where a device
 * may have no doubles. The slots of an anchored SDF are made of them, once per frame: a million
 * metres away from the origin "where the part is minus where the anchor is" must be right to a
 * micrometre, and so must the terms.
 *
 * Exact sum and product: T. J. Dekker, "A floating-point technique for extending the available
 * precision", Numer. Math. 18, 1971. `precise` keeps compilers from simplifying the error terms
 * away. No fma: GLSL lets it be two roundings.
 */
#ifndef MASU_WIDE_GLSL
#define MASU_WIDE_GLSL

vec2 masu_two_sum(float a, float b)
{
    precise float sum = a + b;
    precise float c = sum - a;
    precise float rest = (a - (sum - c)) + (b - c);
    return vec2(sum, rest);
}

/* Two halves of 12 bits each. */
vec2 masu_halves(float a)
{
    precise float c = 4097.0 * a;
    precise float high = c - (c - a);
    precise float low = a - high;
    return vec2(high, low);
}

vec2 masu_two_product(float a, float b)
{
    vec2 p = masu_halves(a);
    vec2 q = masu_halves(b);
    precise float product = a * b;
    precise float rest = ((p.x * q.x - product) + p.x * q.y + p.y * q.x) + p.y * q.y;
    return vec2(product, rest);
}

vec2 masu_wide_add(vec2 a, vec2 b)
{
    vec2 s = masu_two_sum(a.x, b.x);
    precise float rest = s.y + (a.y + b.y);
    return masu_two_sum(s.x, rest);
}

vec2 masu_wide_sub(vec2 a, vec2 b)
{
    return masu_wide_add(a, -b);
}

vec2 masu_wide_mul(vec2 a, vec2 b)
{
    vec2 p = masu_two_product(a.x, b.x);
    precise float rest = p.y + (a.x * b.y + a.y * b.x);
    return masu_two_sum(p.x, rest);
}

/* x less whole periods s: within s / 2, give or take rounding. inverse = 1 / s. */
vec2 masu_wide_fold(vec2 x, vec2 s, vec2 inverse)
{
    float n = floor(x.x * inverse.x + 0.5);
    return masu_wide_sub(x, masu_wide_mul(s, vec2(n, 0.0)));
}

#endif
