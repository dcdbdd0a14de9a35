/*
 * easu.glsl: the arithmetic of FSR1's edge-adaptive upscale (AMD, ffx_fsr1 v1.0.2, fp32 path),
 * approximate reciprocals included. The scalar judge is tests/reference/fsr1.c.
 *
 * The result jumps, by up to tens of 255ths, if the gradient is taken as zero, and if three
 * neighbours of different colour have the same luma: one unit in the last place then decides
 * between a straight edge and none. With MASU_EXACT (debug.exact) every operation is rounded by
 * itself, in AMD's order, so that all drivers take the same side. Without, compilers fuse and taps
 * are placed in steps: 0.3 of the operations.
 */
#ifndef MASU_EASU_GLSL
#define MASU_EASU_GLSL

#ifdef MASU_EXACT
#define SAME precise
#else
#define SAME
#endif

#include "upscale/kernel.glsl"

/* Twice the luma, cheaply. */
float luma(vec3 c)
{
    SAME float red_green = c.r * 0.5 + c.g;
    SAME float all_three = c.b * 0.5 + red_green;
    return all_three;
}

/* How straight the luma runs through three texels in a row: 1 = monotonic, 0 = a reversal. For
 * equal lumas 0 times the finite "reciprocal of 0" is 0: an exact division would need a guard. */
float straightness(float before, float centre, float after)
{
    SAME float largest = max(abs(after - centre), abs(centre - before));
    SAME float ratio = min(abs(after - before) * approximate_rcp(largest), 1.0);
    SAME float squared = ratio * ratio;
    return squared;
}

/* Adds one of the four centres: xy gradient, z straightness of both axes. */
vec3 add_edge(vec3 edge, float weight, float above, float left, float centre, float right,
              float below)
{
    SAME float x = edge.x + (right - left) * weight;
    SAME float z = edge.z + straightness(left, centre, right) * weight;
    SAME float y = edge.y + (below - above) * weight;
    z = z + straightness(above, centre, below) * weight;
    return vec3(x, y, z);
}

masu_kernel masu_kernel_of(vec3 edge)
{
    SAME float x = edge.x;
    SAME float y = edge.y;
    SAME float square = x * x + y * y;
    bool none = square < 1.0 / 32768.0;
    SAME float unit = none ? 1.0 : approximate_rsqrt(square);
    x = (none ? 1.0 : x) * unit;
    y = y * unit;

    SAME float len = edge.z * 0.5;
    len = len * len;

    SAME float square_unit = x * x + y * y;
    SAME float stretch = square_unit * approximate_rcp(max(abs(x), abs(y)));
    SAME float longer = 1.0 + (stretch - 1.0) * len;
    SAME float shorter = 1.0 + -0.5 * len;
    SAME float lobe = 0.5 + (0.25 - 0.04 - 0.5) * len;
    return masu_kernel(vec2(x, y), vec2(longer, shorter), lobe, approximate_rcp(lobe));
}

#ifdef MASU_EXACT
/* Adds one tap to rgb = weighted colour, a = weight, in AMD's order; kernel.glsl explains the
 * weight. */
vec4 add_tap(vec4 sum, masu_kernel k, vec2 p, float x, float y, vec3 colour)
{
    SAME vec2 offset = vec2(x, y) - p;
    SAME float across = (offset.x * k.dir.x + offset.y * k.dir.y) * k.scale.x;
    SAME float along = (offset.x * -k.dir.y + offset.y * k.dir.x) * k.scale.y;
    SAME float distance = min(across * across + along * along, k.clip);
    SAME float base = 0.4 * distance + -1.0;
    base = 1.5625 * (base * base) + -0.5625;
    SAME float window = k.lobe * distance + -1.0;
    SAME float weight = base * (window * window);
    SAME vec3 weighted = sum.rgb + colour * weight;
    SAME float weights = sum.a + weight;
    return vec4(weighted, weights);
}

vec3 weighted_mean(masu_taps t, masu_kernel shape, vec2 p)
{
    vec4 sum = vec4(0.0);
    sum = add_tap(sum, shape, p, 0.0, -1.0, t.b);
    sum = add_tap(sum, shape, p, 1.0, -1.0, t.c);
    sum = add_tap(sum, shape, p, -1.0, 1.0, t.i);
    sum = add_tap(sum, shape, p, 0.0, 1.0, t.j);
    sum = add_tap(sum, shape, p, 0.0, 0.0, t.f);
    sum = add_tap(sum, shape, p, -1.0, 0.0, t.e);
    sum = add_tap(sum, shape, p, 1.0, 1.0, t.k);
    sum = add_tap(sum, shape, p, 2.0, 1.0, t.l);
    sum = add_tap(sum, shape, p, 2.0, 0.0, t.h);
    sum = add_tap(sum, shape, p, 1.0, 0.0, t.g);
    sum = add_tap(sum, shape, p, 1.0, 2.0, t.o);
    sum = add_tap(sum, shape, p, 0.0, 2.0, t.n);
    SAME vec3 mean = sum.rgb * (1.0 / sum.a); /* the four centres keep the sum well above 0 */
    return mean;
}
#else
#define weighted_mean masu_weighted_mean
#endif

/* Weights of f, g, j, k. */
vec4 masu_bilinear_weights(vec2 p)
{
    SAME vec2 q = 1.0 - p;
    SAME vec4 weights = vec4(q.x * q.y, p.x * q.y, q.x * p.y, p.x * p.y);
    return weights;
}

vec3 masu_edge_of(masu_taps t, vec2 p)
{
    float f = luma(t.f), g = luma(t.g), j = luma(t.j), k = luma(t.k);
    float b = luma(t.b), c = luma(t.c), e = luma(t.e), h = luma(t.h);
    float i = luma(t.i), l = luma(t.l), n = luma(t.n), o = luma(t.o);
    vec4 w = masu_bilinear_weights(p);
    vec3 edge = vec3(0.0);
    edge = add_edge(edge, w.x, b, e, f, g, j);
    edge = add_edge(edge, w.y, c, f, g, h, k);
    edge = add_edge(edge, w.z, f, i, j, k, n);
    return add_edge(edge, w.w, g, j, k, l, o);
}

/* The same at f, g, j and k, not weighted yet: gradient and straightness, for all pixels between
 * them. */
struct masu_centres {
    vec4 x, y, z;
};

masu_centres masu_centres_of(masu_taps t)
{
    float f = luma(t.f), g = luma(t.g), j = luma(t.j), k = luma(t.k);
    float b = luma(t.b), c = luma(t.c), e = luma(t.e), h = luma(t.h);
    float i = luma(t.i), l = luma(t.l), n = luma(t.n), o = luma(t.o);
    masu_centres m;
    m.x = vec4(g - e, h - f, k - i, l - j);
    m.y = vec4(j - b, k - c, n - f, o - g);
    m.z = vec4(straightness(e, f, g) + straightness(b, f, j),
               straightness(f, g, h) + straightness(c, g, k),
               straightness(i, j, k) + straightness(f, j, n),
               straightness(j, k, l) + straightness(g, k, o));
    return m;
}

/* The clamp removes ringing, and leaves a flat area unchanged. */
vec3 masu_easu(masu_taps t, vec3 edge, vec2 p)
{
    vec3 least = min(min(t.f, t.g), min(t.j, t.k));
    vec3 most = max(max(t.f, t.g), max(t.j, t.k));
    vec3 mean = weighted_mean(t, masu_kernel_of(edge), p);
    return min(most, max(least, mean));
}

#endif
