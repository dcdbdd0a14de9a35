/*
 * easu_fast.glsl: an edge-adaptive upscale after FSR1's EASU (easu.glsl), with about half of its
 * arithmetic. The scalar reference is MASU_REF_FAST of tests/reference/fsr1.c. Differences:
 *
 * - If the four texels around a pixel differ by at most a step of 8 bits, the result is their
 * bilinear mean. Both this mean and EASU's result are between the least and the most of the four
 * (EASU's clamp), so they differ by a step at most. The other eight texels are not read: they can
 * rotate and stretch the kernel, but not exceed that range.
 *
 * - The straightness of an edge is computed once, from the luma that bilinear filtering gives at
 * the pixel and one texel around it, instead of at each of the four texels. The gradient is the
 * same number in both: the mean of four differences is the difference of two means.
 *
 * - Three equal lumas are not compared in their last bit: a small number under the fraction makes
 * the result continuous. So nothing has to be exact: fetches are used unchanged, the compiler may
 * fuse, and taps are at whole steps from the first instead of each being rotated.
 *
 * With MASU_HALF the taps are weighted and summed in 16-bit floats. Decisions (flat or not, the
 * edge) are made in 32 bits: a 16-bit quotient of small differences would be noise.
 */
#ifndef MASU_EASU_FAST_GLSL
#define MASU_EASU_FAST_GLSL

#include "upscale/kernel.glsl"

/* Half a step of 8 bits of grey, in twice the luma. */
const float masu_least_contrast = 1.0 / 256.0;

/* Twice the luma, cheaply. */
float luma(vec3 c)
{
    return c.b * 0.5 + (c.r * 0.5 + c.g);
}

/* 1.02: as c/255 is rounded, and for inputs of more bits. */
bool masu_flat(vec3 least, vec3 most)
{
    return all(lessThan(most - least, vec3(1.02 / 255.0)));
}

vec4 masu_centres(vec2 p)
{
    vec2 q = 1.0 - p;
    return vec4(q.x * q.y, p.x * q.y, q.x * p.y, p.x * p.y);
}

/* As differences: for four equal texels the result is bit-identical. If a constant halfway between
 * two steps of 8 bits were rounded to either, RCAS would amplify it to a pattern. */
vec3 masu_bilinear(masu_taps t, vec2 p)
{
    vec3 above = t.f + p.x * (t.g - t.f);
    vec3 below = t.j + p.x * (t.k - t.j);
    return above + p.y * (below - above);
}

float straightness(float before, float centre, float after)
{
    float largest = max(abs(after - centre), abs(centre - before)) + masu_least_contrast;
    float ratio = min(abs(after - before) * approximate_rcp(largest), 1.0);
    return ratio * ratio;
}

vec3 masu_easu_fast(masu_taps t, vec2 p, vec3 least, vec3 most)
{
    vec4 w = masu_centres(p);
    vec4 fgjk = vec4(luma(t.f), luma(t.g), luma(t.j), luma(t.k));
    float above = dot(w, vec4(luma(t.b), luma(t.c), fgjk.xy));
    float below = dot(w, vec4(fgjk.zw, luma(t.n), luma(t.o)));
    float left = dot(w, vec4(luma(t.e), fgjk.x, luma(t.i), fgjk.z));
    float right = dot(w, vec4(fgjk.y, luma(t.h), fgjk.w, luma(t.l)));
    float centre = dot(w, fgjk);

    vec2 dir = vec2(right - left, below - above);
    float square = dot(dir, dir);
    bool none = square < 1.0 / 32768.0;
    dir = none ? vec2(1.0, 0.0) : dir * approximate_rsqrt(square);
    float len = 0.5 * (straightness(left, centre, right) + straightness(above, centre, below));
    len = len * len;
    float stretch = dot(dir, dir) * approximate_rcp(max(abs(dir.x), abs(dir.y)));
    vec2 scale = vec2(1.0 + (stretch - 1.0) * len, 1.0 - 0.5 * len);
    float lobe = 0.5 - 0.29 * len;
    vec3 mean = masu_weighted_mean(t, masu_kernel(dir, scale, lobe, approximate_rcp(lobe)), p);
    return min(most, max(least, mean));
}

#endif
