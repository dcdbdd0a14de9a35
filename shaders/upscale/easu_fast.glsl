/*
 * easu_fast.glsl: an edge-adaptive upscale after FSR1's EASU (easu.glsl), for about half of its
 * arithmetic. The scalar judge is MASU_REF_FAST of tests/reference/fsr1.c. What differs:
 * - Where the four texels around a pixel differ by at most a step of 8 bits, it is their bilinear
 *   mean. Both that and what EASU gives lie between the least and the most of the four (EASU's
 *   clamp), so they differ by a step at most. The other eight texels are not read: they can turn
 *   and stretch the kernel, but not lead it out of that range.
 * - How straight an edge is is asked once, of the luma that bilinear filtering gives at the pixel
 *   and one texel beside it, instead of at each of the four texels. The gradient is the same number
 *   in both: the mean of four differences is the difference of two means.
 * - Three equal lumas are not asked which of them differs in the last bit: a small number under the
 *   fraction makes that continuous. So nothing has to be exact: fetches are taken as they come, the
 *   compiler may fuse, and taps lie at whole steps from the first instead of each being turned.
 *
 * With MASU_HALF the taps are weighted and summed in 16-bit floats. What decides (flat or not, the
 * edge) stays in 32: a half of a quotient of small differences would be noise.
 */
#ifndef MASU_EASU_FAST_GLSL
#define MASU_EASU_FAST_GLSL

#ifdef MASU_HALF
#define real float16_t
#define real2 f16vec2
#else
#define real float
#define real2 vec2
#endif

/* Half a step of 8 bits of grey, in twice the luma. */
const float masu_least_contrast = 1.0 / 256.0;

/* The twelve texels around a pixel; f is at floor(p).
 *   b c
 * e f g h
 * i j k l
 *   n o    */
struct masu_taps {
    vec3 b, c, e, f, g, h, i, j, k, l, n, o;
};

/* AMD's approximations (ffx_fsr1 v1.0.2): finite for every operand met here, 0 included. */
float approximate_rcp(float a)
{
    return uintBitsToFloat(0x7EF07EBBu - floatBitsToUint(a));
}

float approximate_rsqrt(float a)
{
    return uintBitsToFloat(0x5F347D74u - (floatBitsToUint(a) >> 1));
}

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

/* In differences: of four equal texels it is that texel, to the bit. Were a constant half way
 * between two steps of 8 bits to fall to either, RCAS would make a pattern of it. */
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

/* Red, green, blue and weight of two taps side by side: halves are multiplied two at a time. */
struct masu_pairs {
    real2 r, g, b, w;
};

/* Adds taps at (x.x, y.x) and (x.y, y.y), by the weight of easu.glsl. */
void add_pair(inout masu_pairs sum, real2 x, real2 y, real lobe, real2 clip, vec3 left, vec3 right)
{
    real2 distance = min(x * x + y * y, clip);
    real2 base = distance * (distance - real(5.0)) + real(4.0);
    real2 window = lobe * distance - real(1.0);
    real2 weight = base * (window * window);
    sum.r += real2(vec2(left.r, right.r)) * weight;
    sum.g += real2(vec2(left.g, right.g)) * weight;
    sum.b += real2(vec2(left.b, right.b)) * weight;
    sum.w += weight;
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
    real lobe = real(0.5 - 0.29 * len);
    real2 clip = real2(approximate_rcp(0.5 - 0.29 * len));

    /* A step to the right and one down in the kernel's axes; from there to each tap: of f and g, side by
     * side, x in one pair and y in another. */
    real2 right_step = real2(vec2(dir.x, -dir.y) * scale);
    real2 down = real2(vec2(dir.y, dir.x) * scale);
    real2 f = -real(p.x) * right_step - real(p.y) * down;
    real2 x = real2(f.x, f.x + right_step.x), y = real2(f.y, f.y + right_step.y);
    real2 out_x = real2(-right_step.x, right_step.x), out_y = real2(-right_step.y, right_step.y);
    masu_pairs sum = masu_pairs(real2(0.0), real2(0.0), real2(0.0), real2(0.0));
    add_pair(sum, x - down.x, y - down.y, lobe, clip, t.b, t.c);
    add_pair(sum, x + out_x, y + out_y, lobe, clip, t.e, t.h);
    add_pair(sum, x, y, lobe, clip, t.f, t.g);
    x += down.x, y += down.y;
    add_pair(sum, x + out_x, y + out_y, lobe, clip, t.i, t.l);
    add_pair(sum, x, y, lobe, clip, t.j, t.k);
    add_pair(sum, x + down.x, y + down.y, lobe, clip, t.n, t.o);
    vec3 sums = vec3(sum.r.x + sum.r.y, sum.g.x + sum.g.y, sum.b.x + sum.b.y);
    vec3 mean = sums * (1.0 / float(sum.w.x + sum.w.y)); /* the four keep the sum well above 0 */
    return min(most, max(least, mean));
}

#endif
