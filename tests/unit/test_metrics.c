/* test_metrics.c: the metrics themselves: values computed by hand, independent slow implementations
 * of SSIM and FLIP, and error lists with exact results. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "metric/flip.h"
#include "metric/hdr_flip.h"
#include "metric/image.h"
#include "metric/march.h"
#include "support/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static void near(double value, double wanted, double slack) {
    if (!(fabs(value - wanted) <= slack)) fail_msg("%.12g is not %.12g", value, wanted);
}

static void fill(uint8_t *rgba, uint32_t pixels, int r, int g, int b) {
    for (uint32_t i = 0; i < pixels; i++) {
        rgba[4 * i] = (uint8_t)r;
        rgba[4 * i + 1] = (uint8_t)g;
        rgba[4 * i + 2] = (uint8_t)b;
        rgba[4 * i + 3] = (uint8_t)i; /* alpha must not matter */
    }
}

static void randomise(uint8_t *rgba, uint32_t pixels, uint64_t seed) {
    for (uint32_t i = 0; i < 4 * pixels; i++) rgba[i] = (uint8_t)support_random(&seed);
}

/* ---- RMSE, PSNR, SSIM ------------------------------------------------------------------------ */

static void rmse_and_psnr_are_those_worked_out_by_hand(void **state) {
    (void)state;
    uint8_t a[8] = {10, 20, 30, 1, 40, 50, 60, 2}, b[8] = {13, 20, 30, 9, 40, 46, 60, 7};
    near(masu_metric_rmse(a, b, 2, 1), sqrt(25.0 / 6) / 255, 1e-15);
    near(masu_metric_rmse(a, a, 2, 1), 0, 0);
    near(masu_metric_difference(a, b, 2, 1), 7.0 / 6, 1e-15); /* 3 and 4; alpha is ignored */
    near(masu_metric_difference(b, a, 1, 2), 7.0 / 6, 1e-15);
    near(masu_metric_difference(a, a, 2, 1), 0, 0);
    assert_true(isinf(masu_metric_psnr(0)));
    for (int i = 0; i < 8; i++) b[i] = (uint8_t)(a[i] + 1);
    near(masu_metric_psnr(masu_metric_rmse(a, b, 2, 1)), 48.1308036087, 1e-9);
}

/* One window at a time, mean first, then deviations: no running sums. */
static double slow_ssim(const uint8_t *a, const uint8_t *b, int width, int height) {
    double total = 0;
    int n = 0;
    for (int y = 5; y < height - 5; y++) {
        for (int x = 5; x < width - 5; x++) {
            double w = 0, ma = 0, mb = 0, va = 0, vb = 0, vab = 0;
            for (int pass = 0; pass < 2; pass++) {
                for (int j = -5; j <= 5; j++) {
                    for (int i = -5; i <= 5; i++) {
                        const uint8_t *p = a + 4 * ((y + j) * width + x + i);
                        const uint8_t *q = b + 4 * ((y + j) * width + x + i);
                        double u = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
                        double v = 0.2126 * q[0] + 0.7152 * q[1] + 0.0722 * q[2];
                        double g = exp(-(i * i + j * j) / 4.5);
                        if (!pass) {
                            w += g;
                            ma += g * u;
                            mb += g * v;
                        } else {
                            va += g * (u - ma) * (u - ma) / w;
                            vb += g * (v - mb) * (v - mb) / w;
                            vab += g * (u - ma) * (v - mb) / w;
                        }
                    }
                }
                if (!pass) {
                    ma /= w;
                    mb /= w;
                }
            }
            const double c1 = 6.5025, c2 = 58.5225;
            total +=
                (2 * ma * mb + c1) * (2 * vab + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
            n++;
        }
    }
    return total / n;
}

static void ssim_agrees_with_a_slow_form(void **state) {
    (void)state;
    enum { W = 23, H = 15 };
    static uint8_t a[W * H * 4], b[W * H * 4];
    for (uint64_t seed = 1; seed <= 4; seed++) {
        randomise(a, W * H, seed);
        randomise(b, W * H, seed + 100);
        near(masu_metric_ssim(a, b, W, H), slow_ssim(a, b, W, H), 1e-10);
        for (int i = 0; i < W * H * 4; i++) b[i] = (uint8_t)(a[i] * 3 / 4 + b[i] / 16);
        near(masu_metric_ssim(a, b, W, H), slow_ssim(a, b, W, H), 1e-10);
        near(masu_metric_ssim(a, a, W, H), 1, 1e-12);
    }
}

static void ssim_of_flat_pictures_is_that_of_their_means(void **state) {
    (void)state;
    enum { W = 20, H = 13 };
    static uint8_t a[W * H * 4], b[W * H * 4];
    fill(a, W * H, 100, 100, 100);
    fill(b, W * H, 150, 150, 150);
    double wanted = (2 * 100.0 * 150 + 6.5025) / (100.0 * 100 + 150 * 150 + 6.5025);
    near(masu_metric_ssim(a, b, W, H), wanted, 1e-9);
    near(masu_metric_ssim(a, b, 4, 3), wanted, 1e-9); /* narrower than a window */
}

/* ---- FLIP ------------------------------------------------------------------------------------ */

/* The paper's formulas pixel by pixel with whole 2-D kernels, independent of
 * tools/metric/flip.c. */
typedef struct color {
    double c[3];
} color;

static const double white[3] = {0.950428545, 1.0, 1.088900371};

static color xyz_of(color rgb) {
    const double m[9] = {0.4123866, 0.3575915, 0.1804505, 0.2126368, 0.7151830,
                         0.0721802, 0.0193306, 0.1191972, 0.9503726};
    color o;
    for (int i = 0; i < 3; i++)
        o.c[i] = m[3 * i] * rgb.c[0] + m[3 * i + 1] * rgb.c[1] + m[3 * i + 2] * rgb.c[2];
    return o;
}

static color rgb_of(color xyz) {
    const double m[9] = {3.241003275, -1.537398934, -0.498615861, -0.969224334, 1.875930071,
                         0.041554224, 0.055639423,  -0.204011202, 1.057148933};
    color o;
    for (int i = 0; i < 3; i++) {
        double v = m[3 * i] * xyz.c[0] + m[3 * i + 1] * xyz.c[1] + m[3 * i + 2] * xyz.c[2];
        o.c[i] = v < 0 ? 0 : v > 1 ? 1 : v;
    }
    return o;
}

static color hunt_of(color rgb) {
    color x = xyz_of(rgb), o;
    double f[3];
    for (int i = 0; i < 3; i++) {
        double v = x.c[i] / white[i];
        f[i] = v > 216.0 / 24389 ? pow(v, 1.0 / 3) : (24389.0 / 27 * v + 16) / 116;
    }
    o.c[0] = 116 * f[1] - 16;
    o.c[1] = 500 * (f[0] - f[1]) * o.c[0] / 100;
    o.c[2] = 200 * (f[1] - f[2]) * o.c[0] / 100;
    return o;
}

static double distance_of(color a, color b) {
    return fabs(a.c[0] - b.c[0]) +
           sqrt((a.c[1] - b.c[1]) * (a.c[1] - b.c[1]) + (a.c[2] - b.c[2]) * (a.c[2] - b.c[2]));
}

static color decoded(const uint8_t *rgba) {
    color o;
    for (int i = 0; i < 3; i++) {
        double v = rgba[i] / 255.0;
        o.c[i] = v > 0.04045 ? pow((v + 0.055) / 1.055, 2.4) : v / 12.92;
    }
    return o;
}

static color opponent_at(const color *linear, int width, int height, int x, int y) {
    color rgb, o;
    x = x < 0 ? 0 : x >= width ? width - 1 : x;
    y = y < 0 ? 0 : y >= height ? height - 1 : y;
    rgb = linear[y * width + x];
    color s = xyz_of(rgb);
    o.c[0] = 116 * s.c[1] - 16;
    o.c[1] = 500 * (s.c[0] / white[0] - s.c[1]);
    o.c[2] = 200 * (s.c[1] - s.c[2] / white[2]);
    return o;
}

static double sensitivity(int channel, double degrees_squared) {
    double z = PI * PI * degrees_squared;
    if (channel == 0) return exp(-z / 0.0047);
    if (channel == 1) return exp(-z / 0.0053);
    return 34.1 * sqrt(PI / 0.04) * exp(-z / 0.04) + 13.5 * sqrt(PI / 0.025) * exp(-z / 0.025);
}

static color seen_at(const color *rgba, int width, int height, int x, int y, double ppd) {
    int r = (int)ceil(3 * sqrt(0.04 / (2 * PI * PI)) * ppd);
    color sum = {{0, 0, 0}}, weight = {{0, 0, 0}}, xyz;
    for (int j = -r; j <= r; j++) {
        for (int i = -r; i <= r; i++) {
            color p = opponent_at(rgba, width, height, x + i, y + j);
            for (int c = 0; c < 3; c++) {
                double w = sensitivity(c, (i * i + j * j) / (ppd * ppd));
                sum.c[c] += w * p.c[c];
                weight.c[c] += w;
            }
        }
    }
    for (int c = 0; c < 3; c++) sum.c[c] /= weight.c[c];
    double l = (sum.c[0] + 16) / 116;
    xyz.c[0] = (l + sum.c[1] / 500) * white[0];
    xyz.c[1] = l;
    xyz.c[2] = (l - sum.c[2] / 200) * white[2];
    return hunt_of(rgb_of(xyz));
}

static double feature_at(const color *rgba, int width, int height, int x, int y, double ppd,
                         int order) {
    double sigma = 0.5 * 0.082 * ppd, found[2] = {0, 0}, up = 0, down = 0;
    int r = (int)ceil(3 * sigma);
    for (int pass = 0; pass < 2; pass++) {
        for (int j = -r; j <= r; j++) {
            for (int i = -r; i <= r; i++) {
                double g = exp(-(i * i + j * j) / (2 * sigma * sigma));
                double k = order == 1 ? -i * g : (i * i / (sigma * sigma) - 1) * g;
                if (!pass) {
                    if (k > 0) up += k;
                    if (k < 0) down -= k;
                    continue;
                }
                k /= k > 0 ? up : down;
                found[0] += k * (opponent_at(rgba, width, height, x + i, y + j).c[0] + 16) / 116;
                found[1] += k * (opponent_at(rgba, width, height, x + j, y + i).c[0] + 16) / 116;
            }
        }
    }
    return sqrt(found[0] * found[0] + found[1] * found[1]);
}

static double spread_out(double distance) {
    const color green = {{0, 1, 0}}, blue = {{0, 0, 1}};
    double most = pow(distance_of(hunt_of(green), hunt_of(blue)), 0.7), e = pow(distance, 0.7);
    if (e < 0.4 * most) return 0.95 / (0.4 * most) * e;
    return 0.95 + (e - 0.4 * most) / (0.6 * most) * 0.05;
}

static double slow_flip(const color *a, const color *b, int width, int height, int x, int y,
                        double ppd) {
    double e = spread_out(
        distance_of(seen_at(a, width, height, x, y, ppd), seen_at(b, width, height, x, y, ppd)));
    double f = 0;
    for (int order = 1; order <= 2; order++) {
        f = fmax(f, fabs(feature_at(a, width, height, x, y, ppd, order) -
                         feature_at(b, width, height, x, y, ppd, order)));
    }
    return pow(e, 1 - sqrt(f / sqrt(2)));
}

static void flip_agrees_with_a_slow_form(void **state) {
    (void)state;
    enum { W = 19, H = 14 };
    static uint8_t a[W * H * 4], b[W * H * 4];
    static color u[W * H], v[W * H];
    static float map[W * H];
    static const double ppds[] = {0, 23.5};
    for (uint64_t seed = 1; seed <= 2; seed++) {
        for (int p = 0; p < 2; p++) {
            masu_flip flip;
            double mean = 0, most = 0, ppd = ppds[p] > 0 ? ppds[p] : MASU_FLIP_PPD;
            randomise(a, W * H, seed);
            randomise(b, W * H, seed + 9);
            /* From noise against noise to a few changed pixels. */
            for (int i = 0; i < W * H * 4 && seed == 2; i++)
                if (b[i] > 20) b[i] = a[i];
            assert_true(masu_metric_flip(a, b, W, H, ppds[p], map, &flip));
            for (int i = 0; i < W * H; i++) {
                u[i] = decoded(a + 4 * i);
                v[i] = decoded(b + 4 * i);
            }
            for (int i = 0; i < W * H; i++) {
                double wanted = slow_flip(u, v, W, H, i % W, i / W, ppd);
                /* the slow implementation's matrix has 7 digits */
                near((double)map[i], wanted, 2e-5);
                mean += wanted / (W * H);
                most = fmax(most, wanted);
            }
            near(flip.mean, mean, 1e-5);
            near(flip.max, most, 2e-5);
            assert_true(flip.p99 <= flip.max && flip.p99 > flip.mean);
        }
    }
}

static masu_flip flip_of_flat(int a, int b) {
    enum { W = 32, H = 24 };
    static uint8_t u[W * H * 4], v[W * H * 4];
    masu_flip flip;
    fill(u, W * H, a, a, a);
    fill(v, W * H, b, b, b);
    assert_true(masu_metric_flip(u, v, W, H, 0, NULL, &flip));
    return flip;
}

static void flip_of_flat_pictures_is_that_worked_out_by_hand(void **state) {
    (void)state;
    /* Black and white: lightness differs by 100, chroma by nothing, and a flat image has no
     * features. 100^0.7 = 25.1189; green to blue is 203.48, 41.31 after the exponent; so 0.95 +
     * (25.1189 - 16.52) / (41.31 - 16.52) * 0.05. */
    masu_flip flip = flip_of_flat(0, 255);
    near(flip.mean, 0.967, 1e-3);
    near(flip.mean, spread_out(100), 1e-6);
    near(flip.max, flip.mean, 1e-9);
    near(flip_of_flat(77, 77).max, 0, 0);
    /* L* of sRGB 119 is 50.0; of 118 49.6: (0.4)^0.7 * 0.95 / 16.52. */
    near(flip_of_flat(118, 119).mean, 0.0303, 0.001);
}

static void flip_grows_with_the_error_and_is_the_same_both_ways(void **state) {
    (void)state;
    double last = 0;
    for (int d = 1; d < 128; d += 7) {
        double e = flip_of_flat(100, 100 + d).mean;
        assert_true(e > last && e < 1);
        near(flip_of_flat(100 + d, 100).mean, e, 1e-12);
        last = e;
    }
    enum { W = 24, H = 24 };
    static uint8_t a[W * H * 4], b[W * H * 4];
    masu_flip ab, ba;
    randomise(a, W * H, 5);
    randomise(b, W * H, 6);
    assert_true(masu_metric_flip(a, b, W, H, 0, NULL, &ab));
    assert_true(masu_metric_flip(b, a, W, H, 0, NULL, &ba));
    near(ab.mean, ba.mean, 1e-12);
    assert_true(masu_metric_flip(a, a, W, H, 0, NULL, &ab));
    near(ab.max, 0, 0);
}

/* ---- HDR-FLIP -------------------------------------------------------------------------------- */

/* The paper's curve in its original form: 0.6 first, then his five numbers. */
static double slow_tone(double x) {
    double v = 0.6 * x, y = v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
    return y < 0 ? 0 : y > 1 ? 1 : y;
}

/* The luminance that is shown at 0.85, found by bisection. */
static double slow_bright(void) {
    double low = 0, high = 10;
    for (int i = 0; i < 200; i++)
        *(slow_tone((low + high) / 2) < 0.85 ? &low : &high) = (low + high) / 2;
    return low;
}

static void the_tone_curve_is_that_worked_out_by_hand(void **state) {
    (void)state;
    near(masu_hdr_flip_tone(0), 0, 0);
    /* 0.6: 0.6 * (1.506 + 0.03) / (0.6 * (1.458 + 0.59) + 0.14) = 0.9216 / 1.3688 */
    near(masu_hdr_flip_tone(1), 0.9216 / 1.3688, 1e-12);
    near(masu_hdr_flip_tone(1e40), 1, 0);
    for (double x = 1e-4; x < 1e4; x *= 1.7) near(masu_hdr_flip_tone(x), slow_tone(x), 1e-12);
}

static void exposures_are_those_worked_out_by_hand(void **state) {
    (void)state;
    /* Luminances 8, 1, 1 and 0.25: three stops from the brightest to the median. */
    const float grey[] = {8, 8, 8, 1, 1, 1, 1, 1, 1, 0.25f, 0.25f, 0.25f};
    masu_exposures r;
    assert_true(masu_hdr_flip_exposures(grey, 4, &r));
    near(r.first, log2(slow_bright() / 8), 1e-9);
    near(r.last, log2(slow_bright() / 1), 1e-9);
    assert_int_equal(r.count, 3);
    /* Green by itself has the weight 0.7152, and the median of an even number is between two. */
    const float two[] = {0, 1, 0, 0, 4, 0};
    assert_true(masu_hdr_flip_exposures(two, 2, &r));
    near(r.first, log2(slow_bright() / (4 * 0.7152)), 1e-6);
    near(r.last, log2(slow_bright() / (2.5 * 0.7152)), 1e-6);
    assert_int_equal(r.count, 2);
    const float flat[] = {3, 3, 3, 3, 3, 3}, black[] = {0, 0, 0, -1, (float)NAN, 0};
    assert_true(masu_hdr_flip_exposures(flat, 2, &r));
    near(r.last, r.first, 0);
    assert_int_equal(r.count, 2);
    assert_true(masu_hdr_flip_exposures(black, 2, &r));
    near(r.first, 0, 0);
    near(r.last, 0, 0);
    /* Mostly black: 20 stops, no more. */
    const float night[] = {0, 0, 0, 0, 0, 0, 1, 1, 1};
    assert_true(masu_hdr_flip_exposures(night, 3, &r));
    near(r.last - r.first, 20, 1e-9);
    assert_int_equal(r.count, 20);
}

static void hdr_flip_agrees_with_a_slow_form(void **state) {
    (void)state;
    enum { W = 13, H = 9 };
    static float a[3 * W * H], b[3 * W * H], map[W * H];
    static color u[W * H], v[W * H];
    static double worst[W * H];
    uint64_t seed = 11;
    masu_flip flip;
    masu_exposures r;
    for (int i = 0; i < 3 * W * H; i++) { /* nine stops; one value in six differs */
        a[i] = ldexpf((float)support_random_in(&seed, 1, 1000) / 1000, (int)(i / 3 % 9) - 5);
        b[i] = support_random_in(&seed, 0, 5) ? a[i] : 2 * a[i];
    }
    assert_true(masu_hdr_flip_exposures(a, W * H, &r));
    assert_true(r.count > 2 && r.count < 9);
    assert_true(masu_metric_hdr_flip(a, b, W, H, 23.5, map, &flip));
    for (uint32_t k = 0; k < r.count; k++) {
        double scale = pow(2, r.first + k * (r.last - r.first) / (r.count - 1));
        for (int i = 0; i < W * H; i++) {
            for (int c = 0; c < 3; c++) {
                u[i].c[c] = slow_tone(scale * (double)a[3 * i + c]);
                v[i].c[c] = slow_tone(scale * (double)b[3 * i + c]);
            }
        }
        for (int i = 0; i < W * H; i++)
            worst[i] = fmax(worst[i], slow_flip(u, v, W, H, i % W, i / W, 23.5));
    }
    double mean = 0;
    for (int i = 0; i < W * H; i++) {
        near((double)map[i], worst[i], 2e-5);
        mean += worst[i] / (W * H);
    }
    near(flip.mean, mean, 1e-5);
    assert_true(mean > 0.05);
    assert_true(masu_metric_hdr_flip(a, a, W, H, 23.5, map, &flip));
    near(flip.max, 0, 0);
}

/* Flat images, so that only the curve and FLIP of greys have an effect: 1 and 2 at the only
 * exposure, which shows 1 at 0.85. */
static void hdr_flip_of_flat_pictures_is_that_worked_out_by_hand(void **state) {
    (void)state;
    enum { W = 16, H = 12 };
    static float a[3 * W * H], b[3 * W * H];
    masu_flip flip;
    for (int i = 0; i < 3 * W * H; i++) {
        a[i] = 1;
        b[i] = 2;
    }
    double y[2] = {0.85, slow_tone(2 * slow_bright())};
    double apart = 116 * (cbrt(y[1]) - cbrt(y[0])); /* lightness */
    assert_true(masu_metric_hdr_flip(a, b, W, H, 0, NULL, &flip));
    near(flip.mean, spread_out(apart), 1e-6);
    near(flip.max, flip.mean, 1e-9);
    /* An error in the dark, which the exposure for the brightest would hide. */
    for (int i = 0; i < 3 * W * H; i++) {
        a[i] = b[i] = i < 3 * W ? 1000 : 0.01f;
        if (i >= 3 * W * (H - 3)) b[i] = 0.02f;
    }
    assert_true(masu_metric_hdr_flip(a, b, W, H, 0, NULL, &flip));
    assert_true(flip.max > spread_out(apart) / 2);
    for (int i = 0; i < 3 * W * H; i++) b[i] = (float)NAN; /* is black */
    assert_true(masu_metric_hdr_flip(a, b, W, H, 0, NULL, &flip));
    assert_true(flip.mean > 0.5 && flip.max <= 1);
}

/* ---- March errors ---------------------------------------------------------------------------- */

static void march_errors_are_those_worked_out_by_hand(void **state) {
    (void)state;
    const masu_march_sample samples[] = {
        {1, 1, 10.0, 10.0, 0.01, 1.0},  /* correct */
        {2, 1, 10.05, 10.0, 0.01, 3.0}, /* half a pixel too far, 0.5 % */
        {3, 2, 12.0, 10.0, 0.01, 8.0},  /* 20 % */
        {0, 5, -1.0, 10.0, 0.01, 0.0},  /* missed */
        {4, 4, 7.0, -1.0, 0.01, 0.0},   /* hit nothing */
        {5, 4, -1.0, -1.0, 0.01, 0.0},  /* correctly missed */
    };
    masu_march_errors e;
    assert_true(masu_march_errors_of(samples, 6, &e));
    assert_int_equal(e.samples, 6);
    assert_int_equal(e.hits, 3);
    near(e.hitmiss_pct, 100.0 * 2 / 6, 1e-12);
    near(e.depth_off_pct, 100.0 / 3, 1e-12);
    near(e.depth_mean_px, (0 + 0.5 + 20) / 3, 1e-9);
    near(e.depth_max_px, 20, 1e-9);
    near(e.depth_p99_px, 20, 1e-9); /* the third of three */
    near(e.normal_mean, 4, 1e-12);
    near(e.normal_max, 8, 1e-12);
    /* Even: (1,1) right, (4,4) wrong. Odd: one miss, one far, two right. */
    assert_int_equal(e.checker.count[0], 2);
    assert_int_equal(e.checker.wrong[0], 1);
    assert_int_equal(e.checker.count[1], 4);
    assert_int_equal(e.checker.wrong[1], 2);
    assert_int_equal(e.border.count[0], 1); /* only (0,5) is on a rim */
    assert_int_equal(e.border.wrong[0], 1);
    near(e.checker.error[1], (0.5 + 4.0) / 2, 1e-9); /* 20 pixels are limited to 4 */
    assert_true(masu_march_errors_of(samples, 0, &e));
    near(e.hitmiss_pct, 0, 0);
}

static void class_tests_are_those_worked_out_by_hand(void **state) {
    (void)state;
    masu_class_test t = {.count = {1000, 1000}, .wrong = {100, 50}};
    masu_class_test_finish(&t);
    near(t.z, (0.05 - 0.001) / sqrt(0.075 * 0.925 * 0.002), 1e-12);
    near(t.chi2, t.z * t.z, 1e-12);
    assert_true(t.p < 1e-4);
    t = (masu_class_test){.count = {500, 500}, .wrong = {0, 4}};
    masu_class_test_finish(&t);
    near(t.p, 2.0 / 16, 1e-9);
    assert_true(t.z < 0 && t.z > -2);
    t = (masu_class_test){.count = {500, 500}, .wrong = {0, 0}};
    masu_class_test_finish(&t);
    near(t.p, 1, 1e-12);
    near(t.z, 0, 0);
    t = (masu_class_test){.count = {7, 0}, .wrong = {3, 0}};
    masu_class_test_finish(&t);
    near(t.p, 1, 0);
}

/* Randomly distributed errors must not be reported as a pattern, planted ones must. */
static void a_planted_pattern_is_found_and_chance_is_not(void **state) {
    (void)state;
    enum { W = 320, H = 180 };
    masu_march_sample *samples = calloc(W * H, sizeof *samples);
    assert_non_null(samples);
    for (int planted = 0; planted < 3; planted++) {
        masu_march_errors e;
        uint64_t seed = 42;
        for (uint32_t i = 0; i < W * H; i++) {
            uint32_t x = i % W, y = i / W;
            bool more = planted == 1   ? ((x + y) & 1)
                        : planted == 2 ? x % 16 == 0 || x % 16 == 15 || y % 16 == 0 || y % 16 == 15
                                       : false;
            bool wrong = support_random_in(&seed, 0, 999) < (more ? 15u : 8u);
            double t = 10 + 1e-3 * (double)support_random_in(&seed, 0, 99);
            samples[i] = (masu_march_sample){x, y, wrong ? -1 : t, 10, 0.002, 0.1};
        }
        assert_true(masu_march_errors_of(samples, W * H, &e));
        assert_true(fabs(e.checker.error_z) < 4 && fabs(e.border.error_z) < 4);
        assert_true(planted == 1 ? e.checker.z < -5 && e.checker.p < 1e-6
                                 : fabs(e.checker.z) < 3.5 && e.checker.p > 1e-3);
        assert_true(planted == 2 ? e.border.z > 5 && e.border.p < 1e-6
                                 : fabs(e.border.z) < 3.5 && e.border.p > 1e-3);
    }
    /* A depth error in only one phase, too small to be called wrong. */
    masu_march_errors e;
    uint64_t seed = 7;
    for (uint32_t i = 0; i < W * H; i++) {
        double more = (i % W + i / W) & 1 ? 0.002 : 0;
        double t = 10 + more + 1e-3 * (double)support_random_in(&seed, 0, 9);
        samples[i] = (masu_march_sample){i % W, i / W, t, 10, 0.002, 0.1};
    }
    assert_true(masu_march_errors_of(samples, W * H, &e));
    assert_true(e.checker.error_z < -20 && fabs(e.border.error_z) < 4);
    near(e.checker.z, 0, 0);
    free(samples);
}

/* With 201 values the p99 is number 198 of 0 to 200, in any order. */
static void the_99th_percentile_of_depth_leaves_out_the_worst(void **state) {
    (void)state;
    enum { N = 201 };
    static masu_march_sample samples[N];
    masu_march_errors e;
    for (uint32_t i = 0; i < N; i++) {
        double apart = 0.01 * (i * 37 % N); /* 0 to 2 m, each once; a pixel is 0.1 m there */
        samples[i] = (masu_march_sample){i, 0, 10 + (i % 2 ? apart : -apart), 10, 0.01, 0};
    }
    assert_true(masu_march_errors_of(samples, N, &e));
    near(e.depth_p99_px, 19.8, 1e-9);
    near(e.depth_max_px, 20, 1e-9);
    near(e.depth_mean_px, 10, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rmse_and_psnr_are_those_worked_out_by_hand),
        cmocka_unit_test(ssim_agrees_with_a_slow_form),
        cmocka_unit_test(ssim_of_flat_pictures_is_that_of_their_means),
        cmocka_unit_test(flip_agrees_with_a_slow_form),
        cmocka_unit_test(flip_of_flat_pictures_is_that_worked_out_by_hand),
        cmocka_unit_test(flip_grows_with_the_error_and_is_the_same_both_ways),
        cmocka_unit_test(the_tone_curve_is_that_worked_out_by_hand),
        cmocka_unit_test(exposures_are_those_worked_out_by_hand),
        cmocka_unit_test(hdr_flip_agrees_with_a_slow_form),
        cmocka_unit_test(hdr_flip_of_flat_pictures_is_that_worked_out_by_hand),
        cmocka_unit_test(march_errors_are_those_worked_out_by_hand),
        cmocka_unit_test(class_tests_are_those_worked_out_by_hand),
        cmocka_unit_test(the_99th_percentile_of_depth_leaves_out_the_worst),
        cmocka_unit_test(a_planted_pattern_is_found_and_chance_is_not),
    };
    return cmocka_run_group_tests_name("metrics", tests, NULL, NULL);
}
