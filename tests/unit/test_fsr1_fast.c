/* test_fsr1_fast.c: changes relative to AMD's shaders, tested in the scalar reference: RCAS keeps
 * constants, which an approximate reciprocal does not; and EASU's early exit is within a step of 8
 * bits of the filter, on images made to be hard for it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "reference/fsr1.h"
#include "reference/patterns.h"

enum { W = 40, H = 36, MOST = 112 };

static uint8_t bytes[W * H * 4];
static float picture[W * H * 3];
static float full[MOST * MOST * 3], fast[MOST * MOST * 3];
static float sharp_full[MOST * MOST * 3], sharp_fast[MOST * MOST * 3];

/* ---- RCAS ------------------------------------------------------------------------------------ */

static float float_of(uint32_t u) {
    float x;
    memcpy(&x, &u, sizeof x);
    return x;
}

/* AMD's medium reciprocal: an estimate from the bits, and one Newton step. */
static float medium_rcp(float a) {
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    float guess = float_of(0x7EF19FFFu - bits);
    return guess * (-guess * a + 2.0f);
}

static void rcas_keeps_constants_to_the_last_bits(void **state) {
    (void)state;
    static const float levels[] = {0.0f, 1.0f / 255.0f, 0.5f, 1.0f};
    double worst = 0, approximate = 0;
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        float texels[27], rgb[3], v = levels[i];
        for (int k = 0; k < 27; k++) texels[k] = v;
        struct masu_ref_image in = {.rgb = texels, .width = 3, .height = 3};
        for (float stops = 0.0f; stops <= 2.0f; stops += 0.2f) {
            masu_ref_rcas_pixel(&in, 1, 1, exp2f(-stops), rgb);
            double loss = fabs((double)rgb[1] - (double)v) / (v > 0.0f ? (double)v : 1.0);
            if (loss > worst) worst = loss;
        }
        /* The most negative lobe that a constant of that level allows. */
        float limit = fmaxf(-0.25f, v < 1.0f ? (1.0f - v) / (4.0f * v - 4.0f) : -1.0f);
        float lobe = fmaxf(-0.1875f, fminf(v > 0.0f ? limit : -0.25f, 0.0f));
        float ours = (lobe * 4.0f * v + v) * medium_rcp(4.0f * lobe + 1.0f);
        double lost = fabs((double)ours - (double)v) / (v > 0.0f ? (double)v : 1.0);
        if (lost > approximate) approximate = lost;
    }
    print_message("  constants: error %.5f %%, with AMD's reciprocal %.2f %%\n", 100 * worst,
                  100 * approximate);
    assert_true(worst < 1e-6);                             /* 0.0001 %; required: 0.02 % */
    /* otherwise the comparison proves nothing */
    assert_true(approximate > 2e-3 && approximate < 5e-3);
}

/* ---- EASU, flat regions ---------------------------------------------------------------------- */

typedef enum kind {
    SLOW_RAMP,  /* a step every few texels */
    STEEP_RAMP, /* a step or two for every texel, slanted */
    NOISE_1,    /* each channel one of two levels */
    NOISE_2,    /* of three */
    LINES_1,    /* lines one texel wide, one step brighter */
    LINES,      /* the same, bright */
    CHECKER_1,
    CHECKER,
    BESIDE, /* flat to one step next to an edge: the kernel is rotated and stretched */
    KINDS
} kind;

static const char *const names[KINDS] = {"slow ramp", "steep ramp", "noise 1",
                                         "noise 2",   "lines 1",    "lines",
                                         "checker 1", "checker",    "next to an edge"};

static int level(kind k, uint32_t x, uint32_t y, uint32_t c) {
    uint32_t hash = masu_pattern_hash((y * W + x) * 3 + c);
    switch (k) {
    case SLOW_RAMP: return 100 + (int)(x / 3 + y / 4) + (int)c;
    case STEEP_RAMP: return 20 + (int)(x + x / 2 + y) + (int)c;
    case NOISE_1: return 127 + (int)(hash >> 31);
    case NOISE_2: return 127 + (int)((hash >> 16) % 3);
    case LINES_1: return 90 + ((x + 2 * y) % 7 == 0);
    case LINES: return (x + 2 * y) % 7 == 0 ? 230 : 90 + (int)(hash >> 31);
    case CHECKER_1: return 200 + (int)((x + y) % 2);
    case CHECKER: return (x / 5 + y / 5) % 2 ? 255 : 0;
    default: return x > y / 2 + 14 ? 255 : 30 + (int)(hash >> 31);
    }
}

static struct masu_ref_image make(kind k) {
    for (uint32_t i = 0; i < W * H; i++) {
        for (uint32_t c = 0; c < 3; c++) bytes[4 * i + c] = (uint8_t)level(k, i % W, i / W, c);
    }
    masu_ref_from_rgba8(bytes, W, H, 0, picture);
    return (struct masu_ref_image){.rgb = picture, .width = W, .height = H};
}

static int clamped(int v, int size) { return v < 0 ? 0 : v >= size ? size - 1 : v; }

/* Whether the four texels around output pixel (x, y) are within a step of each other. */
static int is_flat(uint32_t x, uint32_t y, uint32_t out_w, uint32_t out_h) {
    int fx = (int)floor((x + 0.5) * W / out_w - 0.5 + 1e-5);
    int fy = (int)floor((y + 0.5) * H / out_h - 0.5 + 1e-5);
    for (uint32_t c = 0; c < 3; c++) {
        int least = 255, most = 0;
        for (int i = 0; i < 4; i++) {
            int at = clamped(fy + i / 2, H) * W + clamped(fx + i % 2, W);
            int v = bytes[4 * at + (int)c];
            least = v < least ? v : least;
            most = v > most ? v : most;
        }
        if (most - least > 1) return 0;
    }
    return 1;
}

static uint8_t quantised[MOST * MOST * 4];

static void sharpen(const float *from, uint32_t w, uint32_t h, float *to) {
    static float stored[MOST * MOST * 3];
    masu_ref_to_rgba8(from, w, h, quantised);
    masu_ref_from_rgba8(quantised, w, h, 0, stored);
    struct masu_ref_image in = {.rgb = stored, .width = w, .height = h};
    masu_ref_rcas(&in, exp2f(-0.2f), to);
}

/* No output pixel may be on a texel centre, where this test and the reference could choose
 * different texels: sizes without odd:odd ratios. */
static const uint32_t outputs[][2] = {{80, 72}, {61, 55}, {100, 91}, {97, 38}, {43, 107}};

static void a_flat_place_left_early_is_within_a_step_of_the_filter(void **state) {
    (void)state;
    for (kind k = 0; k < KINDS; k++) {
        struct masu_ref_image in = make(k);
        uint32_t left = 0, pixels = 0;
        float worst = 0.0f, sharpened = 0.0f;
        for (size_t s = 0; s < sizeof outputs / sizeof *outputs; s++) {
            uint32_t w = outputs[s][0], h = outputs[s][1];
            masu_ref_easu(&in, w, h, MASU_REF_BIT_TRICK, full);
            masu_ref_easu(&in, w, h, MASU_REF_FAST, fast);
            for (uint32_t i = 0; i < w * h; i++) {
                int flat = is_flat(i % w, i / w, w, h);
                pixels++;
                assert_int_equal(flat, masu_ref_easu_leaves_early(&in, w, h, i % w, i / w));
                if (!flat) continue;
                left++;
                float d = masu_ref_max_difference(&full[3 * i], &fast[3 * i], 3) * 255.0f;
                if (!(d <= worst)) worst = d;
            }
            sharpen(full, w, h, sharp_full);
            sharpen(fast, w, h, sharp_fast);
            for (uint32_t y = 1; y + 1 < h; y++) {
                for (uint32_t x = 1; x + 1 < w; x++) {
                    int flat = is_flat(x, y, w, h) && is_flat(x - 1, y, w, h) &&
                               is_flat(x + 1, y, w, h) && is_flat(x, y - 1, w, h) &&
                               is_flat(x, y + 1, w, h);
                    uint32_t i = 3 * (y * w + x);
                    float d = masu_ref_max_difference(&sharp_full[i], &sharp_fast[i], 3) * 255.0f;
                    if (flat && !(d <= sharpened)) sharpened = d;
                }
            }
        }
        print_message("  %-15s %5.1f %% left early, worst %.3f/255; sharpened %.1f/255\n", names[k],
                      100.0 * left / pixels, (double)worst, (double)sharpened);
        assert_true(worst <= 1.02f);
        assert_true(k == NOISE_1 || k == CHECKER_1 || k == LINES_1 ? left == pixels
                                                                   : left < pixels);
        if (k != STEEP_RAMP && k != NOISE_2) assert_true(left > pixels / 8);
    }
}

/* The other pixels: the same taps and clamp, with a kernel stretched by a different
 * straightness. */
static void elsewhere_the_fast_way_stays_within_the_four_texels_too(void **state) {
    (void)state;
    for (int p = 0; p < MASU_PATTERN_COUNT; p++) {
        masu_pattern_fill((enum masu_pattern)p, 5, W, H, bytes);
        masu_ref_from_rgba8(bytes, W, H, 0, picture);
        struct masu_ref_image in = {.rgb = picture, .width = W, .height = H};
        masu_ref_easu(&in, 80, 72, MASU_REF_BIT_TRICK, full);
        masu_ref_easu(&in, 80, 72, MASU_REF_FAST, fast);
        double sum = 0, worst = 0;
        for (uint32_t i = 0; i < 80 * 72 * 3; i++) {
            double d = 255.0 * fabs((double)full[i] - (double)fast[i]);
            assert_true(fast[i] >= 0.0f && fast[i] <= 1.0f);
            sum += d * d;
            if (d > worst) worst = d;
        }
        print_message("  %-12s fast against full: rms %.2f, worst %.0f of 255\n",
                      masu_pattern_name((enum masu_pattern)p), sqrt(sum / (80 * 72 * 3)), worst);
        /* Smooth images hardly change; in noise, each pixel may. */
        double most = p == MASU_PATTERN_RAMP || p == MASU_PATTERN_FLAT ? 1.02
                      : p == MASU_PATTERN_PHOTO                        ? 60
                                                                       : 255;
        assert_true(worst <= most);
        assert_true(p == MASU_PATTERN_FLAT ? worst == 0 : worst > 0); /* it is another filter */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rcas_keeps_constants_to_the_last_bits),
        cmocka_unit_test(a_flat_place_left_early_is_within_a_step_of_the_filter),
        cmocka_unit_test(elsewhere_the_fast_way_stays_within_the_four_texels_too),
    };
    return cmocka_run_group_tests_name("fsr1_fast", tests, NULL, NULL);
}
