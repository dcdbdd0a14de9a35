/*
 * kernel.glsl: EASU's weighted mean of twelve texels (easu.glsl, easu_fast.glsl), with a kernel
 * that is rotated and stretched along the edge (AMD, ffx_fsr1 v1.0.2). Taps are at whole steps from
 * the first: their squared distance is a polynomial of two whole numbers.
 *
 * With MASU_HALF taps are weighted and summed in 16-bit floats, two at a time. The polynomial's
 * terms cancel, which floats of 11 bits do not tolerate: there both coordinates of each tap are
 * computed, by two additions.
 */
#ifndef MASU_KERNEL_GLSL
#define MASU_KERNEL_GLSL

#ifdef MASU_HALF
#define real float16_t
#define real2 f16vec2
#define SUM real2
#define ADD(sum, left, right, weight) sum += real2(vec2(left, right)) * weight
#define TOTAL(sum) (sum.x + sum.y)
#else /* one after the other: two sums would only take registers */
#define SUM float
#define ADD(sum, left, right, weight)                                                              \
    {                                                                                              \
        sum = left * weight.x + sum;                                                               \
        sum = right * weight.y + sum;                                                              \
    }
#endif

/* These two are specification, not optimisation: a true reciprocal changes hard edges by 16/255 and
 * binary noise by 70/255. They are finite for every operand here, including 0. */
float approximate_rcp(float a)
{
    return uintBitsToFloat(0x7EF07EBBu - floatBitsToUint(a));
}

float approximate_rsqrt(float a)
{
    return uintBitsToFloat(0x5F347D74u - (floatBitsToUint(a) >> 1));
}

/* The twelve texels around a pixel; f is at floor(p).
 *   b c
 * e f g h
 * i j k l
 *   n o    */
struct masu_taps {
    vec3 b, c, e, f, g, h, i, j, k, l, n, o;
};

struct masu_kernel {
    vec2 dir;   /* unit vector across the edge */
    vec2 scale; /* shortens the kernel across the edge, lengthens it along */
    float lobe; /* strength of the window */
    float clip; /* squared distance where the window ends */
};

/* Red, green, blue and weight. */
struct masu_sums {
    SUM r, g, b, w;
};

#ifdef MASU_HALF

/* Adds taps at (x.x, y.x) and (x.y, y.y). The weight is a polynomial stand-in for a windowed sinc,
 * of the squared distance d in the kernel's own axes: 25/16 (2/5 d - 1)^2 - 9/16, which is
 * (d (d - 5) + 4) / 4, and of weights that are divided by their sum a fourth is as good as all. */
void add_pair(inout masu_sums sum, real2 x, real2 y, real lobe, real2 clip, vec3 left, vec3 right)
{
    real2 distance = min(x * x + y * y, clip);
    real2 base = distance * (distance - real(5.0)) + real(4.0);
    real2 window = lobe * distance - real(1.0);
    real2 weight = base * (window * window);
    ADD(sum.r, left.r, right.r, weight);
    ADD(sum.g, left.g, right.g, weight);
    ADD(sum.b, left.b, right.b, weight);
    ADD(sum.w, 1.0, 1.0, weight);
}

vec3 masu_weighted_mean(masu_taps t, masu_kernel k, vec2 p)
{
    real lobe = real(k.lobe);
    real2 clip = real2(k.clip);
    /* A step to the right and one down in the kernel's axes; from there to each tap: x holds the x
     * of taps f and g, y their y. */
    real2 right_step = real2(vec2(k.dir.x, -k.dir.y) * k.scale);
    real2 down = real2(vec2(k.dir.y, k.dir.x) * k.scale);
    real2 f = -real(p.x) * right_step - real(p.y) * down;
    real2 x = real2(f.x, f.x + right_step.x), y = real2(f.y, f.y + right_step.y);
    real2 out_x = real2(-right_step.x, right_step.x), out_y = real2(-right_step.y, right_step.y);
    masu_sums sum = masu_sums(SUM(0.0), SUM(0.0), SUM(0.0), SUM(0.0));
    add_pair(sum, x - down.x, y - down.y, lobe, clip, t.b, t.c);
    add_pair(sum, x + out_x, y + out_y, lobe, clip, t.e, t.h);
    add_pair(sum, x, y, lobe, clip, t.f, t.g);
    x += down.x, y += down.y;
    add_pair(sum, x + out_x, y + out_y, lobe, clip, t.i, t.l);
    add_pair(sum, x, y, lobe, clip, t.j, t.k);
    add_pair(sum, x + down.x, y + down.y, lobe, clip, t.n, t.o);
    vec3 sums = vec3(TOTAL(sum.r), TOTAL(sum.g), TOTAL(sum.b));
    return sums * (1.0 / float(TOTAL(sum.w))); /* the four keep the sum well above 0 */
}

#else

/* Adds two taps. The weight is a polynomial stand-in for a windowed sinc, of the squared distance d
 * in the kernel's own axes: 25/16 (2/5 d - 1)^2 - 9/16, which is ((d - 5/2)^2 - 9/4) / 4, and of
 * weights that are divided by their sum a fourth is as good as all. distance: d - 5/2; window: lobe
 * 5/2 - 1. */
void add_pair(inout masu_sums sum, vec2 distance, float lobe, float window, float clip, vec3 left,
              vec3 right)
{
    distance = min(distance, vec2(clip));
    vec2 base = distance * distance - 2.25;
    vec2 open = lobe * distance + window;
    vec2 weight = base * (open * open);
    ADD(sum.r, left.r, right.r, weight);
    ADD(sum.g, left.g, right.g, weight);
    ADD(sum.b, left.b, right.b, weight);
    ADD(sum.w, 1.0, 1.0, weight);
}

/* The squared distance of taps at whole steps is a x^2 + 2 b x y + c y^2 - 2 (d x + e y) + f: a
 * number for each column, one for each row, and what both have together. */
vec3 masu_weighted_mean(masu_taps t, masu_kernel k, vec2 p)
{
    vec2 square = k.scale * k.scale;
    float xx = k.dir.x * k.dir.x, yy = k.dir.y * k.dir.y;
    float a = square.x * xx + square.y * yy;
    float c = square.x * yy + square.y * xx;
    float b = (square.x - square.y) * (k.dir.x * k.dir.y);
    float d = a * p.x + b * p.y, e = b * p.x + c * p.y;
    float f = d * p.x + e * p.y - 2.5;
    /* Columns -1, 1 and 2 relative to 0, rows likewise. */
    float left = a + 2.0 * d, right = a - 2.0 * d, far_right = 4.0 * (a - d);
    float above = c + 2.0 * e + f, below = c - 2.0 * e + f, far_below = 4.0 * (c - e) + f;
    float both = 2.0 * b;
    float window = 2.5 * k.lobe - 1.0, clip = k.clip - 2.5;
    masu_sums sum = masu_sums(SUM(0.0), SUM(0.0), SUM(0.0), SUM(0.0));
    add_pair(sum, vec2(above, above + right - both), k.lobe, window, clip, t.b, t.c);
    add_pair(sum, vec2(f + left, f + far_right), k.lobe, window, clip, t.e, t.h);
    add_pair(sum, vec2(f, f + right), k.lobe, window, clip, t.f, t.g);
    add_pair(sum, vec2(below + left - both, below + far_right + 2.0 * both), k.lobe, window, clip,
             t.i, t.l);
    add_pair(sum, vec2(below, below + right + both), k.lobe, window, clip, t.j, t.k);
    add_pair(sum, vec2(far_below, far_below + right + 2.0 * both), k.lobe, window, clip, t.n, t.o);
    vec3 sums = vec3(sum.r, sum.g, sum.b);
    return sums * (1.0 / sum.w); /* the four keep the sum well above 0 */
}

#endif

#endif
