/* fsr1.c: see fsr1.h. Two things here are easy to break without noticing:
 *
 * 1. Rounding. Three decisions in EASU are discontinuous (which texel floor(p) picks, the "no
 * gradient" test, and 0/0-like length terms of equal-luma neighbours), so one unit in the last
 * digit can move a pixel by tens of 255ths. Every multiply and add is therefore a separate
 * statement, and the file must be compiled without contraction into fused operations (-std=c11
 * gives that on gcc; the pragma below gives it on clang, whose default differs).
 *
 * 2. The reciprocals. They look like a speed trick to be improved; they are the specification. */
#include "reference/fsr1.h"

#include "shared/floats.h"

#include <math.h>
#include <string.h>

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

/* The twelve taps, in the order in which AMD's shader accumulates them:
 *
 *        b c          offsets from f, the texel at floor(p)
 *      e f g h
 *      i j k l
 *        n o
 */
enum tap { B, C, I, J, F, E, K, L, H, G, O, N, TAP_COUNT };

static const int tap_offset[TAP_COUNT][2] = {
    [B] = { 0, -1 }, [C] = { 1, -1 }, [I] = { -1, 1 }, [J] = { 0, 1 },
    [F] = { 0, 0 },  [E] = { -1, 0 }, [K] = { 1, 1 },  [L] = { 2, 1 },
    [H] = { 2, 0 },  [G] = { 1, 0 },  [O] = { 1, 2 },  [N] = { 0, 2 },
};

static uint32_t bits_of(float x)
{
    uint32_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

static float float_of(uint32_t u)
{
    float x;
    memcpy(&x, &u, sizeof x);
    return x;
}

static float low(float a, float b)
{
    return a < b ? a : b;
}

static float high(float a, float b)
{
    return a > b ? a : b;
}

/* Bit patterns from 0x7F800000 up are +Inf, NaN and everything with the sign bit. */
static float sane_unit(float x)
{
    return bits_of(x) >= 0x7F800000u ? 0.0f : low(x, 1.0f);
}

static float approximate_rcp(float a, enum masu_ref_math math)
{
    if (math == MASU_REF_EXACT) {
        return 1.0f / a;
    }
    return float_of(0x7EF07EBBu - bits_of(a));
}

static float approximate_rsqrt(float a, enum masu_ref_math math)
{
    if (math == MASU_REF_EXACT) {
        return 1.0f / sqrtf(a);
    }
    return float_of(0x5F347D74u - (bits_of(a) >> 1));
}

static void fetch(const struct masu_ref_image *in, int x, int y, float rgb[3])
{
    int right = (int)in->width - 1;
    int bottom = (int)in->height - 1;
    size_t stride = in->stride ? in->stride : in->width;
    x = x < 0 ? 0 : x > right ? right : x;
    y = y < 0 ? 0 : y > bottom ? bottom : y;
    const float *texel = in->rgb + ((size_t)y * stride + (size_t)x) * 3;
    for (int c = 0; c < 3; c++) {
        rgb[c] = sane_unit(texel[c]);
    }
}

/* Position of output pixel o in input texels. AMD prepares in*(1/out) on the host, in this order
 * (two roundings, not one): with an odd:odd ratio such as 3:5 some pixels land exactly on a texel
 * centre, and there the last bit decides which four texels the result is clamped to. */
static float source_position(uint32_t o, uint32_t in_size, uint32_t out_size)
{
    float reciprocal = 1.0f / (float)out_size;
    float scale = (float)in_size * reciprocal;
    float half_scale = 0.5f * scale;
    float offset = half_scale - 0.5f;
    float moved = (float)o * scale;
    return moved + offset;
}

/* Monotonicity of the luma over three texels in a row: 1 = monotonic, 0 = a reversal. */
static float straightness(float before, float centre, float after, enum masu_ref_math math)
{
    float largest = high(fabsf(after - centre), fabsf(centre - before));
    if (math == MASU_REF_EXACT && !(largest > 0.0f)) {
        return 0.0f; /* the approximate reciprocal of 0 is finite and needs no such guard */
    }
    float ratio = fabsf(after - before) * approximate_rcp(largest, math);
    ratio = low(ratio, 1.0f);
    return ratio * ratio;
}

struct edge {
    float dir_x, dir_y; /* gradient, not yet of unit length */
    float len;          /* sum of straightness over both axes, 0..2 */
};

/*        above
 *   left centre right
 *        below          */
static void add_edge(struct edge *edge, float weight, float above, float left, float centre,
                     float right, float below, enum masu_ref_math math)
{
    float step_x = (right - left) * weight;
    edge->dir_x += step_x;
    float len_x = straightness(left, centre, right, math) * weight;
    edge->len += len_x;
    float step_y = (below - above) * weight;
    edge->dir_y += step_y;
    float len_y = straightness(above, centre, below, math) * weight;
    edge->len += len_y;
}

struct kernel {
    float dir_x, dir_y;     /* unit vector across the edge */
    float scale_x, scale_y; /* shortens the kernel across the edge, lengthens it along */
    float lobe, clip;       /* window strength; squared distance where the window ends */
};

static struct kernel kernel_of(struct edge edge, enum masu_ref_math math)
{
    struct kernel k = { .dir_x = edge.dir_x, .dir_y = edge.dir_y };

    float square_x = k.dir_x * k.dir_x;
    float square_y = k.dir_y * k.dir_y;
    float square = square_x + square_y;
    if (square < 1.0f / 32768.0f) {
        k.dir_x = 1.0f; /* y keeps its (tiny) value, as in the original */
    } else {
        float scale = approximate_rsqrt(square, math);
        k.dir_x = k.dir_x * scale;
        k.dir_y = k.dir_y * scale;
    }

    float len = edge.len * 0.5f;
    len = len * len;

    square_x = k.dir_x * k.dir_x;
    square_y = k.dir_y * k.dir_y;
    square = square_x + square_y;
    float stretch = square * approximate_rcp(high(fabsf(k.dir_x), fabsf(k.dir_y)), math);
    float longer = (stretch - 1.0f) * len;
    k.scale_x = 1.0f + longer;
    float shorter = -0.5f * len;
    k.scale_y = 1.0f + shorter;
    float softer = (0.25f - 0.04f - 0.5f) * len;
    k.lobe = 0.5f + softer;
    k.clip = approximate_rcp(k.lobe, math);
    return k;
}

/* Polynomial stand-in for a windowed sinc, of the squared distance. */
static float tap_weight(const struct kernel *k, float off_x, float off_y)
{
    float xx = off_x * k->dir_x;
    float yy = off_y * k->dir_y;
    float xy = off_x * -k->dir_y;
    float yx = off_y * k->dir_x;
    float v_x = (xx + yy) * k->scale_x;
    float v_y = (xy + yx) * k->scale_y;
    float square_x = v_x * v_x;
    float square_y = v_y * v_y;
    float distance = low(square_x + square_y, k->clip);

    float base = 0.4f * distance;
    base = base + -1.0f;
    base = base * base;
    base = 1.5625f * base; /* 25/16 */
    base = base + -0.5625f;
    float window = k->lobe * distance;
    window = window + -1.0f;
    window = window * window;
    return base * window;
}

/* Luma of all twelve; weights of f, g, j, k. */
static struct edge edge_of(const float l[TAP_COUNT], const float w[4], enum masu_ref_math math)
{
    struct edge edge = { 0.0f, 0.0f, 0.0f };
    add_edge(&edge, w[0], l[B], l[E], l[F], l[G], l[J], math);
    add_edge(&edge, w[1], l[C], l[F], l[G], l[H], l[K], math);
    add_edge(&edge, w[2], l[F], l[I], l[J], l[K], l[N], math);
    add_edge(&edge, w[3], l[G], l[J], l[K], l[L], l[O], math);
    return edge;
}

/* ---- The fast form: shaders/upscale/easu_fast.glsl ---- */

static float weighted(const float w[4], float f, float g, float j, float k)
{
    return w[0] * f + w[1] * g + w[2] * j + w[3] * k;
}

/* Half a step of 8 bits of grey, in twice the luma: smaller differences are no edge. */
static float fast_straightness(float before, float centre, float after)
{
    float largest = high(fabsf(after - centre), fabsf(centre - before)) + 1.0f / 256.0f;
    float ratio = low(fabsf(after - before) * approximate_rcp(largest, MASU_REF_FAST), 1.0f);
    return ratio * ratio;
}

static struct edge fast_edge_of(const float l[TAP_COUNT], const float w[4])
{
    float left = weighted(w, l[E], l[F], l[I], l[J]);
    float right = weighted(w, l[G], l[H], l[K], l[L]);
    float above = weighted(w, l[B], l[C], l[F], l[G]);
    float below = weighted(w, l[J], l[K], l[N], l[O]);
    float centre = weighted(w, l[F], l[G], l[J], l[K]);
    struct edge edge = { right - left, below - above,
                         fast_straightness(left, centre, right)
                             + fast_straightness(above, centre, below) };
    if (edge.dir_x * edge.dir_x + edge.dir_y * edge.dir_y < 1.0f / 32768.0f) {
        edge.dir_x = edge.dir_y = 0.0f; /* kernel_of then uses (1, 0) */
    }
    return edge;
}

/* The four nearest texels differ by at most one step of 8 bits. */
static int is_flat(float colour[TAP_COUNT][3])
{
    for (int c = 0; c < 3; c++) {
        float least = low(low(colour[F][c], colour[G][c]), low(colour[J][c], colour[K][c]));
        float most = high(high(colour[F][c], colour[G][c]), high(colour[J][c], colour[K][c]));
        if (!(most - least < 1.02f / 255.0f)) {
            return 0;
        }
    }
    return 1;
}

void masu_ref_easu_pixel(const struct masu_ref_image *in, uint32_t out_width, uint32_t out_height,
                         uint32_t x, uint32_t y, enum masu_ref_math math, float rgb[3])
{
    float p_x = source_position(x, in->width, out_width);
    float p_y = source_position(y, in->height, out_height);
    float f_x = floorf(p_x);
    float f_y = floorf(p_y);
    p_x = p_x - f_x;
    p_y = p_y - f_y;

    float colour[TAP_COUNT][3];
    float luma[TAP_COUNT]; /* twice the luma, cheaply */
    for (int t = 0; t < TAP_COUNT; t++) {
        fetch(in, (int)f_x + tap_offset[t][0], (int)f_y + tap_offset[t][1], colour[t]);
        float red_green = colour[t][0] * 0.5f + colour[t][1]; /* the halving is exact */
        luma[t] = colour[t][2] * 0.5f + red_green;
    }

    float q_x = 1.0f - p_x;
    float q_y = 1.0f - p_y;
    if (math == MASU_REF_FAST && is_flat(colour)) {
        for (int c = 0; c < 3; c++) {
            float above = colour[F][c] + p_x * (colour[G][c] - colour[F][c]);
            float below = colour[J][c] + p_x * (colour[K][c] - colour[J][c]);
            rgb[c] = above + p_y * (below - above);
        }
        return;
    }
    float weights[4] = { q_x * q_y, p_x * q_y, q_x * p_y, p_x * p_y };
    struct edge edge = math == MASU_REF_FAST ? fast_edge_of(luma, weights)
                                             : edge_of(luma, weights, math);
    struct kernel kernel = kernel_of(edge, math);
    float sum[3] = { 0.0f, 0.0f, 0.0f };
    float weight_sum = 0.0f;
    for (int t = 0; t < TAP_COUNT; t++) {
        float off_x = (float)tap_offset[t][0] - p_x;
        float off_y = (float)tap_offset[t][1] - p_y;
        float weight = tap_weight(&kernel, off_x, off_y);
        for (int c = 0; c < 3; c++) {
            float product = colour[t][c] * weight;
            sum[c] = sum[c] + product;
        }
        weight_sum = weight_sum + weight;
    }

    float reciprocal = 1.0f / weight_sum; /* the four centre taps keep the sum well above 0 */
    for (int c = 0; c < 3; c++) {
        float least = low(low(colour[F][c], colour[G][c]), low(colour[J][c], colour[K][c]));
        float most = high(high(colour[F][c], colour[G][c]), high(colour[J][c], colour[K][c]));
        rgb[c] = low(most, high(least, sum[c] * reciprocal));
    }
}

int masu_ref_easu_leaves_early(const struct masu_ref_image *in, uint32_t out_width,
                               uint32_t out_height, uint32_t x, uint32_t y)
{
    int f_x = (int)floorf(source_position(x, in->width, out_width));
    int f_y = (int)floorf(source_position(y, in->height, out_height));
    float colour[TAP_COUNT][3];
    fetch(in, f_x, f_y, colour[F]);
    fetch(in, f_x + 1, f_y, colour[G]);
    fetch(in, f_x, f_y + 1, colour[J]);
    fetch(in, f_x + 1, f_y + 1, colour[K]);
    return is_flat(colour);
}

void masu_ref_easu(const struct masu_ref_image *in, uint32_t out_width, uint32_t out_height,
                   enum masu_ref_math math, float *out)
{
    for (uint32_t y = 0; y < out_height; y++) {
        for (uint32_t x = 0; x < out_width; x++, out += 3) {
            masu_ref_easu_pixel(in, out_width, out_height, x, y, math, out);
        }
    }
}

void masu_ref_bilinear(const struct masu_ref_image *in, uint32_t out_width, uint32_t out_height,
                       float *out)
{
    for (uint32_t y = 0; y < out_height; y++) {
        for (uint32_t x = 0; x < out_width; x++, out += 3) {
            float p_x = source_position(x, in->width, out_width);
            float p_y = source_position(y, in->height, out_height);
            float f_x = floorf(p_x), f_y = floorf(p_y);
            float four[4][3];
            for (int i = 0; i < 4; i++) {
                fetch(in, (int)f_x + i % 2, (int)f_y + i / 2, four[i]);
            }
            p_x -= f_x;
            p_y -= f_y;
            for (int c = 0; c < 3; c++) {
                float above = four[0][c] + p_x * (four[1][c] - four[0][c]);
                float below = four[2][c] + p_x * (four[3][c] - four[2][c]);
                out[c] = above + p_y * (below - above);
            }
        }
    }
}

/* Rings darker than the first, or closer to white than the second, have no headroom on that side:
 * the quotient would be 0/0. Far below one step of 8 bits, far above a denormal. */
#define RCAS_DARK 1e-6f
#define RCAS_BRIGHT (1.0f - 1e-6f)

void masu_ref_rcas_pixel(const struct masu_ref_image *in, uint32_t x, uint32_t y, float strength,
                         float rgb[3])
{
    int ix = (int)x;
    int iy = (int)y;
    float up[3], left[3], centre[3], right[3], down[3];
    fetch(in, ix, iy - 1, up);
    fetch(in, ix - 1, iy, left);
    fetch(in, ix, iy, centre);
    fetch(in, ix + 1, iy, right);
    fetch(in, ix, iy + 1, down);

    /* The most negative lobe that keeps all channels within 0..1. */
    float lobe = -1.0f;
    for (int c = 0; c < 3; c++) {
        float least = low(low(up[c], left[c]), low(right[c], down[c]));
        float most = high(high(up[c], left[c]), high(right[c], down[c]));
        float limit = -1.0f;
        if (most > RCAS_DARK) {
            limit = high(limit, -(low(least, centre[c]) / (4.0f * most)));
        }
        if (least < RCAS_BRIGHT) {
            float room = 1.0f - high(most, centre[c]);
            float span = 4.0f * least;
            limit = high(limit, room / (span - 4.0f));
        }
        lobe = high(lobe, limit);
    }
    lobe = high(-0.1875f, low(lobe, 0.0f)) * strength;

    float denominator = 4.0f * lobe;
    denominator = denominator + 1.0f;
    for (int c = 0; c < 3; c++) {
        float ring = (up[c] + left[c]) + (right[c] + down[c]);
        float shared = lobe * ring;
        rgb[c] = sane_unit((shared + centre[c]) / denominator);
    }
}

void masu_ref_rcas(const struct masu_ref_image *in, float strength, float *out)
{
    for (uint32_t y = 0; y < in->height; y++) {
        for (uint32_t x = 0; x < in->width; x++, out += 3) {
            masu_ref_rcas_pixel(in, x, y, strength, out);
        }
    }
}

void masu_ref_from_rgba8(const uint8_t *rgba, uint32_t width, uint32_t height, uint32_t stride,
                         float *rgb)
{
    size_t row = stride ? stride : width;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++, rgb += 3) {
            const uint8_t *texel = rgba + ((size_t)y * row + x) * 4;
            for (int c = 0; c < 3; c++) {
                rgb[c] = (float)texel[c] / 255.0f;
            }
        }
    }
}

void masu_ref_to_rgba8(const float *rgb, uint32_t width, uint32_t height, uint8_t *rgba)
{
    size_t texels = (size_t)width * height;
    for (size_t i = 0; i < texels; i++) {
        for (int c = 0; c < 3; c++) {
            float scaled = sane_unit(rgb[i * 3 + (size_t)c]) * 255.0f;
            rgba[i * 4 + (size_t)c] = (uint8_t)nearbyintf(scaled);
        }
        rgba[i * 4 + 3] = 255;
    }
}

void masu_ref_to_ten(float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        float scaled = sane_unit(values[i]) * 1023.0f;
        values[i] = nearbyintf(scaled) / 1023.0f;
    }
}

float masu_ref_max_difference(const float *a, const float *b, size_t count)
{
    float worst = 0.0f;
    for (size_t i = 0; i < count; i++) {
        float d = fabsf(a[i] - b[i]);
        if (!(d <= worst)) { /* a NaN difference is the largest of all */
            worst = d;
        }
    }
    return worst;
}

uint32_t masu_ref_max_difference_rgba8(const uint8_t *a, const uint8_t *b, size_t texels)
{
    uint32_t worst = 0;
    for (size_t i = 0; i < texels * 4; i++) {
        uint32_t d = a[i] > b[i] ? (uint32_t)(a[i] - b[i]) : (uint32_t)(b[i] - a[i]);
        worst = d > worst ? d : worst;
    }
    return worst;
}
