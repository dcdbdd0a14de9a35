/*
 * kernel.glsl: the mean of twelve texels that EASU takes (easu.glsl, easu_fast.glsl), weighted by where they
 * lie in a kernel that is turned and stretched along the edge (AMD, ffx_fsr1 v1.0.2). Taps lie at whole
 * steps from the first, two additions each, instead of each being turned.
 *
 * With MASU_HALF taps are weighted and summed in 16-bit floats, two at a time.
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
#define real float
#define real2 vec2
#define SUM real
#define ADD(sum, left, right, weight)                                                              \
    {                                                                                              \
        sum = left * weight.x + sum;                                                               \
        sum = right * weight.y + sum;                                                              \
    }
#define TOTAL(sum) sum
#endif

/* These two are specification, not optimisation: a true reciprocal changes hard edges by 16/255 and
 * binary noise by 70/255. They are finite for every operand met here, 0 included. */
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

/* Adds taps at (x.x, y.x) and (x.y, y.y). The weight is a polynomial stand-in for a windowed sinc, of the
 * squared distance d in the kernel's own axes: 25/16 (2/5 d - 1)^2 - 9/16, which is (d (d - 5) + 4) / 4, and
 * of weights that are divided by their sum a fourth is as good as all. */
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
    /* A step to the right and one down in the kernel's axes; from there to each tap: x holds the x of taps f
     * and g, y their y. */
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

#endif
