/* test_fsr1_reference.c: tests of the FSR1 reference itself: properties that EASU and RCAS must
 * have, numbers computed by hand, and the documented size of the effect of the approximate
 * reciprocals (wrong constants would change it). The GPU is compared with this reference in other
 * tests. */
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

#define SIDE_MAX 512

/* Scratch images, large enough for every case below. */
static uint8_t bytes_in[SIDE_MAX * SIDE_MAX * 4];
static float picture[SIDE_MAX * SIDE_MAX * 3];
static float mirrored[SIDE_MAX * SIDE_MAX * 3];
static float result[SIDE_MAX * SIDE_MAX * 3];
static float other[SIDE_MAX * SIDE_MAX * 3];

static struct masu_ref_image pattern_picture(enum masu_pattern pattern, uint32_t seed,
                                             uint32_t width, uint32_t height)
{
    masu_pattern_fill(pattern, seed, width, height, bytes_in);
    masu_ref_from_rgba8(bytes_in, width, height, 0, picture);
    return (struct masu_ref_image){ .rgb = picture, .width = width, .height = height };
}

static void set_grey(float *texel, float v)
{
    texel[0] = texel[1] = texel[2] = v;
}

static void assert_near(float got, double want, double tolerance)
{
    if (!(fabs((double)got - want) <= tolerance)) {
        fail_msg("got %.7f, want %.7f +- %g", (double)got, want, tolerance);
    }
}

/* ---- EASU ---- */

static const uint32_t flat_sizes[][4] = {
    { 8, 8, 8, 8 }, { 5, 7, 13, 9 }, { 1, 1, 6, 5 }, { 9, 9, 4, 3 }, { 6, 10, 10, 17 },
};

static void a_flat_picture_comes_out_of_easu_unchanged_to_the_bit(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 8; seed++) {
        for (size_t s = 0; s < sizeof flat_sizes / sizeof flat_sizes[0]; s++) {
            const uint32_t *size = flat_sizes[s];
            struct masu_ref_image in = pattern_picture(MASU_PATTERN_FLAT, seed, size[0], size[1]);
            masu_ref_easu(&in, size[2], size[3], MASU_REF_BIT_TRICK, result);
            for (uint32_t i = 0; i < size[2] * size[3]; i++) {
                assert_memory_equal(&result[i * 3], picture, 3 * sizeof(float));
            }
        }
    }
}

static void easu_stays_within_its_four_centre_taps(void **state)
{
    (void)state;
    const uint32_t w = 30, h = 22, out_w = 53, out_h = 47; /* no output is on a texel centre */
    struct masu_ref_image in = pattern_picture(MASU_PATTERN_WHITE_NOISE, 3, w, h);
    masu_ref_easu(&in, out_w, out_h, MASU_REF_BIT_TRICK, result);
    uint32_t strictly_between = 0;
    for (uint32_t y = 0; y < out_h; y++) {
        for (uint32_t x = 0; x < out_w; x++) {
            int fx = (int)floor((x + 0.5) * w / out_w - 0.5);
            int fy = (int)floor((y + 0.5) * h / out_h - 0.5);
            for (int c = 0; c < 3; c++) {
                float least = 2.0f, most = -1.0f;
                for (int t = 0; t < 4; t++) {
                    int tx = fx + (t & 1);
                    int ty = fy + (t >> 1);
                    tx = tx < 0 ? 0 : tx > (int)w - 1 ? (int)w - 1 : tx;
                    ty = ty < 0 ? 0 : ty > (int)h - 1 ? (int)h - 1 : ty;
                    float v = picture[((uint32_t)ty * w + (uint32_t)tx) * 3 + (uint32_t)c];
                    least = v < least ? v : least;
                    most = v > most ? v : most;
                }
                float got = result[(y * out_w + x) * 3 + (uint32_t)c];
                assert_true(got >= least && got <= most);
                strictly_between += got > least && got < most;
            }
        }
    }
    assert_true(strictly_between > out_w * out_h * 3 / 2); /* not merely clamped everywhere */
}

/* Ratio 1, so p is the texel itself and only f's cross counts. Columns 1, .5, .4, .4 and the pixel
 * at column 1, with true divisions:
 *   lumas (doubled) 2, 1, .8: dX = -1.2, ratio 1.2/1 -> 1; dY = 0; len = (1/2)^2 = .25
 *   dir (-1,0), stretch 1, axes (1, .875), lobe .5 - .29/4 = .4275, clip 1/.4275 = 2.33918
 *   d2 of f 0, e g 1, b j .765625, c k i 1.765625, others past the clip where the window is 0
 *   weights f 1; e g 0 (base (.4-1)^2*25/16-9/16 = 0); b j .189514*.452519 = .085759;
 *   c k i -.427673*.060121 = -.025712
 *   sum w = 1 + 2*.085759 - 3*.025712 = 1.094381
 *   sum wC = .5*(1 + 2*.085759) - 2*.4*.025712 - 1*.025712 = .539477
 *   .539477/1.094381 = .492952, inside .4...5
 * With the bit tricks: bits(1.44) = 3FB851EC, 5F347D74 - 1FDC28F6 = 3F58547E = .845039,
 *   dir.x = -1.2*.845039 = -1.014047; rcp(1.014047) = .932411; stretch 1.028291*.932411 = .958789;
 *   axes (.989697, .875); clip 2.337735; the same sums then give .529994/1.075640 = .492725 */
static void easu_matches_a_case_computed_by_hand(void **state)
{
    (void)state;
    static const float column[4] = { 1.0f, 0.5f, 0.4f, 0.4f };
    for (uint32_t i = 0; i < 16; i++) {
        set_grey(&picture[i * 3], column[i % 4]);
    }
    struct masu_ref_image in = { .rgb = picture, .width = 4, .height = 4 };
    float rgb[3];
    masu_ref_easu_pixel(&in, 4, 4, 1, 1, MASU_REF_EXACT, rgb);
    assert_near(rgb[0], 0.4929516, 2e-6);
    masu_ref_easu_pixel(&in, 4, 4, 1, 1, MASU_REF_BIT_TRICK, rgb);
    assert_near(rgb[0], 0.4927249, 2e-6);
    assert_near(rgb[2], 0.4927249, 2e-6);
}

/* All four centres, an oblique gradient and three different channels, at twice the size; the
 * expected numbers come from an independent program in double precision. */
static void easu_matches_an_independent_oblique_case(void **state)
{
    (void)state;
    for (uint32_t y = 0; y < 4; y++) {
        for (uint32_t x = 0; x < 4; x++) {
            float *texel = &picture[(y * 4 + x) * 3];
            texel[0] = (float)((x * 7 + y * 3) % 5) / 10.0f;
            texel[1] = (float)((x * 3 + y * 5 + 1) % 5) / 5.0f;
            texel[2] = 0.05f + (float)((x + y * 2) % 6) * 0.15f;
        }
    }
    struct masu_ref_image in = { .rgb = picture, .width = 4, .height = 4 };
    static const double exact[3] = { 0.2107655, 0.7564083, 0.6535542 };
    static const double trick[3] = { 0.2064330, 0.7570892, 0.6488208 };
    float rgb[3];
    masu_ref_easu_pixel(&in, 8, 8, 3, 4, MASU_REF_EXACT, rgb);
    for (int c = 0; c < 3; c++) {
        assert_near(rgb[c], exact[c], 2e-6);
    }
    masu_ref_easu_pixel(&in, 8, 8, 3, 4, MASU_REF_BIT_TRICK, rgb);
    for (int c = 0; c < 3; c++) {
        assert_near(rgb[c], trick[c], 2e-6);
    }
}

/* At exactly twice the size all positions are exact, so a mirrored input must give the mirrored
 * output up to the order of summation. */
static void easu_of_a_mirrored_picture_is_the_mirrored_result(void **state)
{
    (void)state;
    const uint32_t w = 40, h = 32;
    static const enum masu_pattern patterns[] = { MASU_PATTERN_ZONE_PLATE, MASU_PATTERN_TEXT,
                                                  MASU_PATTERN_BINARY_NOISE };
    for (size_t p = 0; p < 3; p++) {
        for (int vertical = 0; vertical < 2; vertical++) {
            struct masu_ref_image in = pattern_picture(patterns[p], 2, w, h);
            masu_ref_easu(&in, w * 2, h * 2, MASU_REF_BIT_TRICK, result);
            for (uint32_t y = 0; y < h; y++) {
                for (uint32_t x = 0; x < w; x++) {
                    uint32_t from = vertical ? (h - 1 - y) * w + x : y * w + (w - 1 - x);
                    memcpy(&mirrored[(y * w + x) * 3], &picture[from * 3], 3 * sizeof(float));
                }
            }
            struct masu_ref_image twin = { .rgb = mirrored, .width = w, .height = h };
            masu_ref_easu(&twin, w * 2, h * 2, MASU_REF_BIT_TRICK, other);
            float worst = 0.0f;
            for (uint32_t y = 0; y < h * 2; y++) {
                for (uint32_t x = 0; x < w * 2; x++) {
                    uint32_t a = y * w * 2 + x;
                    uint32_t b = vertical ? (h * 2 - 1 - y) * w * 2 + x
                                          : y * w * 2 + (w * 2 - 1 - x);
                    float d = masu_ref_max_difference(&result[a * 3], &other[b * 3], 3);
                    worst = d > worst ? d : worst;
                }
            }
            assert_near(worst, 0.0, 0.02 / 255.0);
        }
    }
}

/* 5 to 25 texels puts output 12 exactly on texel 2. In float, 5*(1/25) as AMD's host code has it
 * gives 1.9999999 and so floor 1; 5/25 would give 2. With floor 1, the taps of the row above are
 * columns 1 and 2; with floor 2, columns 2 and 3. */
static void a_pixel_on_a_texel_centre_takes_the_side_that_amd_rounds_to(void **state)
{
    (void)state;
    const uint32_t above = 1; /* output row 4 of 8 is at 4.5*5/8 - .5 = 2.3125: centre 2 and 3 */
    struct masu_ref_image in = pattern_picture(MASU_PATTERN_WHITE_NOISE, 14, 5, 5);
    float before[3], after[3];
    masu_ref_easu_pixel(&in, 25, 8, 12, 4, MASU_REF_BIT_TRICK, before);
    float kept = picture[(above * 5 + 3) * 3];
    picture[(above * 5 + 3) * 3] = kept > 0.5f ? 0.0f : 1.0f;
    masu_ref_easu_pixel(&in, 25, 8, 12, 4, MASU_REF_BIT_TRICK, after);
    assert_memory_equal(before, after, sizeof before);
    picture[(above * 5 + 3) * 3] = kept;
    picture[(above * 5 + 1) * 3] = picture[(above * 5 + 1) * 3] > 0.5f ? 0.0f : 1.0f;
    masu_ref_easu_pixel(&in, 25, 8, 12, 4, MASU_REF_BIT_TRICK, after);
    assert_true(fabsf(before[0] - after[0]) > 1.0f / 255.0f);
}

static float effect_of_the_bit_tricks(const struct masu_ref_image *in, uint32_t out_w,
                                      uint32_t out_h)
{
    masu_ref_easu(in, out_w, out_h, MASU_REF_BIT_TRICK, result);
    masu_ref_easu(in, out_w, out_h, MASU_REF_EXACT, other);
    return 255.0f * masu_ref_max_difference(result, other, (size_t)out_w * out_h * 3);
}

/* Up to 74 on binary noise, 37 on white noise, 16 to 41 on hard edges (by image), 17 on dots. Both
 * ends matter: 0 would mean that the tricks are not in use. */
static void bit_tricks_change_each_kind_of_picture_by_the_documented_amount(void **state)
{
    (void)state;
    static const struct {
        enum masu_pattern pattern;
        float least, most; /* 255ths */
    } expected[] = {
        { MASU_PATTERN_BINARY_NOISE, 50.0f, 90.0f }, { MASU_PATTERN_WHITE_NOISE, 25.0f, 50.0f },
        { MASU_PATTERN_HARD_EDGES, 10.0f, 45.0f },   { MASU_PATTERN_DOTS, 10.0f, 22.0f },
        { MASU_PATTERN_TEXT, 10.0f, 35.0f },         { MASU_PATTERN_PHOTO, 2.0f, 25.0f },
        { MASU_PATTERN_FLAT, 0.0f, 0.0f },
    };
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        struct masu_ref_image in = pattern_picture(expected[i].pattern, 7, 160, 120);
        float effect = effect_of_the_bit_tricks(&in, 256, 192);
        if (!(effect >= expected[i].least && effect <= expected[i].most)) {
            fail_msg("%s: %.2f/255, expected %.0f to %.0f",
                     masu_pattern_name(expected[i].pattern), (double)effect,
                     (double)expected[i].least, (double)expected[i].most);
        }
    }
}

/* Gentle rings, 0.05 cycles a pixel at most: about 2 to 3/255. */
static void bit_tricks_change_a_gentle_zone_plate_by_two_to_three_steps(void **state)
{
    (void)state;
    const uint32_t side = 256;
    for (uint32_t y = 0; y < side; y++) {
        for (uint32_t x = 0; x < side; x++) {
            double phase = 3.14159265 * 0.05 * (x * x + y * y) / (side * 1.41421356);
            set_grey(&picture[(y * side + x) * 3], (float)(0.5 + 0.5 * cos(phase)));
        }
    }
    struct masu_ref_image in = { .rgb = picture, .width = side, .height = side };
    assert_near(effect_of_the_bit_tricks(&in, 512, 512), 2.5, 1.5);
}

/* A linear ramp has stretch 1 and a symmetric kernel: the tricks cancel, and the result follows the
 * ramp to a small part of one texel's step. */
static void a_smooth_ramp_hardly_sees_the_bit_tricks_and_stays_a_ramp(void **state)
{
    (void)state;
    const uint32_t w = 320, h = 12, out_w = 480, out_h = 18;
    for (uint32_t i = 0; i < w * h; i++) {
        set_grey(&picture[i * 3], (float)(i % w) / (float)(w - 1));
    }
    struct masu_ref_image in = { .rgb = picture, .width = w, .height = h };
    assert_near(effect_of_the_bit_tricks(&in, out_w, out_h), 0.0, 0.04);
    for (uint32_t x = 6; x < out_w - 6; x++) {
        double ideal = ((x + 0.5) * w / out_w - 0.5) / (w - 1);
        assert_near(result[(8 * out_w + x) * 3], ideal, 0.15 / (w - 1));
    }
}

static void texels_outside_the_rectangle_never_matter(void **state)
{
    (void)state;
    const uint32_t w = 21, h = 17, stride = 33, rows = 25, out_w = 37, out_h = 29;
    struct masu_ref_image tight = pattern_picture(MASU_PATTERN_PHOTO, 1, w, h);
    masu_ref_easu(&tight, out_w, out_h, MASU_REF_BIT_TRICK, result);
    masu_ref_rcas(&tight, 1.0f, mirrored);
    for (uint32_t i = 0; i < stride * rows * 3; i++) {
        other[i] = NAN;
    }
    for (uint32_t y = 0; y < h; y++) {
        memcpy(&other[y * stride * 3], &picture[y * w * 3], w * 3 * sizeof(float));
    }
    struct masu_ref_image loose = { .rgb = other, .width = w, .height = h, .stride = stride };
    for (uint32_t y = 0; y < out_h; y++) {
        for (uint32_t x = 0; x < out_w; x++) {
            float rgb[3];
            masu_ref_easu_pixel(&loose, out_w, out_h, x, y, MASU_REF_BIT_TRICK, rgb);
            assert_memory_equal(rgb, &result[(y * out_w + x) * 3], sizeof rgb);
        }
    }
    for (uint32_t y = 0; y < h; y++) {
        for (uint32_t x = 0; x < w; x++) {
            float rgb[3];
            masu_ref_rcas_pixel(&loose, x, y, 1.0f, rgb);
            assert_memory_equal(rgb, &mirrored[(y * w + x) * 3], sizeof rgb);
        }
    }
}

static void a_poisoned_texel_stays_in_range_and_within_the_footprint(void **state)
{
    (void)state;
    static const float poison[] = { NAN, -NAN, INFINITY, -INFINITY, -0.0f, -1.0f, 1e-40f, 65504.0f,
                                    65520.0f, 1e30f };
    const uint32_t w = 16, h = 16, out_w = 32, out_h = 32, px = 7, py = 9;
    struct masu_ref_image in = pattern_picture(MASU_PATTERN_PHOTO, 4, w, h);
    masu_ref_easu(&in, out_w, out_h, MASU_REF_BIT_TRICK, result);
    for (size_t p = 0; p < sizeof poison / sizeof poison[0]; p++) {
        set_grey(&picture[(py * w + px) * 3], poison[p]);
        masu_ref_easu(&in, out_w, out_h, MASU_REF_BIT_TRICK, other);
        for (uint32_t y = 0; y < out_h; y++) {
            for (uint32_t x = 0; x < out_w; x++) {
                uint32_t i = (y * out_w + x) * 3;
                int fx = (int)floor(x * 0.5 - 0.25);
                int fy = (int)floor(y * 0.5 - 0.25);
                int reached = abs((int)px * 2 - (fx * 2 + 1)) <= 3
                              && abs((int)py * 2 - (fy * 2 + 1)) <= 3;
                for (uint32_t c = 0; c < 3; c++) {
                    assert_true(other[i + c] >= 0.0f && other[i + c] <= 1.0f);
                    assert_true(reached || other[i + c] == result[i + c]);
                }
            }
        }
        masu_ref_rcas(&in, 1.0f, mirrored);
        for (uint32_t i = 0; i < w * h * 3; i++) {
            assert_true(mirrored[i] >= 0.0f && mirrored[i] <= 1.0f);
        }
    }
}

/* ---- RCAS ---- */

struct cross {
    float up, left, centre, right, down;
};

/* The centre pixel of a 3x3 image with these crosses in R, G, B. The corners are poison: the filter
 * must not read them. */
static void sharpen_cross(const struct cross channel[3], float strength, float rgb[3])
{
    float texels[9 * 3];
    for (size_t i = 0; i < 27; i++) {
        texels[i] = NAN;
    }
    for (size_t c = 0; c < 3; c++) {
        texels[1 * 3 + c] = channel[c].up;
        texels[3 * 3 + c] = channel[c].left;
        texels[4 * 3 + c] = channel[c].centre;
        texels[5 * 3 + c] = channel[c].right;
        texels[7 * 3 + c] = channel[c].down;
    }
    struct masu_ref_image in = { .rgb = texels, .width = 3, .height = 3 };
    masu_ref_rcas_pixel(&in, 1, 1, strength, rgb);
}

static void assert_sharpens_grey(struct cross cross, float strength, double want)
{
    struct cross channel[3] = { cross, cross, cross };
    float rgb[3];
    sharpen_cross(channel, strength, rgb);
    for (int c = 0; c < 3; c++) {
        assert_near(rgb[c], want, 1e-6);
    }
}

static void rcas_matches_cases_computed_by_hand(void **state)
{
    (void)state;
    /* hitMin .5/2 = .25, hitMax .4/(2-4) = -.2; max(-.25,-.2) = -.2 -> clamped to -.1875;
     * (-.1875*2 + .6)/(1 - .75) = .225/.25 = .9 */
    struct cross bump = { 0.5f, 0.5f, 0.6f, 0.5f, 0.5f };
    assert_sharpens_grey(bump, 1.0f, 0.9);
    /* one stop: lobe -.09375; (-.1875 + .6)/(1 - .375) = .4125/.625 = .66 */
    assert_sharpens_grey(bump, 0.5f, 0.66);
    assert_sharpens_grey(bump, 0.0f, 0.6);
    /* least .2, most .8: hitMin .2/3.2 = .0625, hitMax .2/(.8-4) = -.0625: lobe -.0625;
     * (-.0625*2 + .55)/(1 - .25) = .425/.75 = .5666667 */
    struct cross mixed = { 0.2f, 0.4f, 0.55f, 0.6f, 0.8f };
    assert_sharpens_grey(mixed, 1.0f, 0.425 / 0.75);
    /* hitMin includes the centre: .1/2 = .05, hitMax .5/-2 = -.25: lobe -.05;
     * (-.05*2 + .1)/(1 - .2) = 0: driven exactly to black, not below */
    struct cross dip = { 0.5f, 0.5f, 0.1f, 0.5f, 0.5f };
    assert_sharpens_grey(dip, 1.0f, 0.0);
    /* one stop: (-.025*2 + .1)/(1 - .1) = .05/.9 */
    assert_sharpens_grey(dip, 0.5f, 0.05 / 0.9);
    /* and upwards: hitMax (1-.95)/-2 = -.025, hitMin .25; (-.05 + .95)/(1 - .1) = 1 exactly */
    struct cross peak = { 0.5f, 0.5f, 0.95f, 0.5f, 0.5f };
    assert_sharpens_grey(peak, 1.0f, 1.0);
    /* one stop: (-.0125*2 + .95)/(1 - .05) = .925/.95 */
    assert_sharpens_grey(peak, 0.5f, 0.925 / 0.95);
}

/* Separate channels would have the lobes -.1875 (R), -.1875 (G: hitMin .25, hitMax .1/(3.6-4) =
 * -.25) and -.0625 (B); the weakest serves all: R (-.125+.6)/.75, G (-.0625*3.6+.9)/.75 = .9, B
 * (-.125+.55)/.75. Which channel is the weakest must not matter. */
static void rcas_uses_one_lobe_for_all_channels(void **state)
{
    (void)state;
    static const struct cross cross[3] = { { 0.5f, 0.5f, 0.6f, 0.5f, 0.5f },
                                           { 0.9f, 0.9f, 0.9f, 0.9f, 0.9f },
                                           { 0.2f, 0.4f, 0.55f, 0.6f, 0.8f } };
    static const double want[3] = { 0.475 / 0.75, 0.9, 0.425 / 0.75 };
    for (int turn = 0; turn < 3; turn++) {
        struct cross channel[3] = { cross[turn], cross[(turn + 1) % 3], cross[(turn + 2) % 3] };
        float rgb[3];
        sharpen_cross(channel, 1.0f, rgb);
        for (int c = 0; c < 3; c++) {
            assert_near(rgb[c], want[(c + turn) % 3], 1e-6);
        }
    }
}

/* A black ring leaves 0/0 in hitMin, a white one in hitMax; the other bound decides.
 * Black, centre .5: hitMax .5/-4 = -.125, .5/(1-.5) = 1. White, centre .5: -hitMin = -.5/4 = -.125,
 * (-.5+.5)/.5 = 0. Black, centre .25: -.1875 by the clamp, .25/.25 = 1. */
static void rcas_survives_black_and_white_rings(void **state)
{
    (void)state;
    assert_sharpens_grey((struct cross){ 0.0f, 0.0f, 0.5f, 0.0f, 0.0f }, 1.0f, 1.0);
    assert_sharpens_grey((struct cross){ 1.0f, 1.0f, 0.5f, 1.0f, 1.0f }, 1.0f, 0.0);
    assert_sharpens_grey((struct cross){ 0.0f, 0.0f, 0.25f, 0.0f, 0.0f }, 1.0f, 1.0);
    assert_sharpens_grey((struct cross){ 0.0f, 0.0f, 0.0f, 0.0f, 0.0f }, 1.0f, 0.0);
    assert_sharpens_grey((struct cross){ 1.0f, 1.0f, 1.0f, 1.0f, 1.0f }, 1.0f, 1.0);
    assert_sharpens_grey((struct cross){ 0.0f, 0.0f, 1.0f, 0.0f, 0.0f }, 1.0f, 1.0);
    assert_sharpens_grey((struct cross){ 1.0f, 1.0f, 0.0f, 1.0f, 1.0f }, 1.0f, 0.0);
}

static void rcas_returns_constants_exactly_in_8_bits(void **state)
{
    (void)state;
    for (uint32_t c = 0; c < 256; c++) {
        float texels[27];
        for (size_t i = 0; i < 27; i++) {
            texels[i] = (float)c / 255.0f;
        }
        struct masu_ref_image in = { .rgb = texels, .width = 3, .height = 3 };
        for (int stops = 0; stops < 3; stops++) {
            float rgb[3];
            uint8_t rgba[4];
            masu_ref_rcas_pixel(&in, 1, 1, exp2f((float)-stops), rgb);
            assert_near(rgb[1], c / 255.0, 0.01 / 255.0);
            masu_ref_to_rgba8(rgb, 1, 1, rgba);
            assert_int_equal(rgba[0], c);
        }
    }
}

static void fewer_stops_sharpen_more(void **state)
{
    (void)state;
    const uint32_t w = 48, h = 48;
    struct masu_ref_image in = pattern_picture(MASU_PATTERN_PHOTO, 6, w, h);
    double before = 0.0;
    for (int stops = 4; stops >= 0; stops--) {
        masu_ref_rcas(&in, exp2f((float)-stops), result);
        double change = 0.0;
        for (uint32_t i = 0; i < w * h * 3; i++) {
            change += (double)fabsf(result[i] - picture[i]);
        }
        assert_true(change > before * 1.3);
        before = change;
    }
    masu_ref_rcas(&in, 0.0f, result);
    assert_memory_equal(result, picture, w * h * 3 * sizeof(float));
}

/* ---- conversions and patterns ---- */

static void eight_bit_values_survive_the_trip_through_floats(void **state)
{
    (void)state;
    for (uint32_t c = 0; c < 256; c++) {
        uint8_t in[8] = { 9, 9, 9, 9, (uint8_t)c, (uint8_t)(255 - c), 7, 3 };
        uint8_t out[4];
        float rgb[3];
        masu_ref_from_rgba8(in + 4, 1, 1, 2, rgb);
        masu_ref_to_rgba8(rgb, 1, 1, out);
        assert_int_equal(out[0], c);
        assert_int_equal(out[1], 255 - c);
        assert_int_equal(out[2], 7);
        assert_int_equal(out[3], 255);
    }
    float wild[3] = { NAN, -4.0f, 1e30f };
    uint8_t out[4];
    masu_ref_to_rgba8(wild, 1, 1, out);
    assert_int_equal(out[0], 0);
    assert_int_equal(out[1], 0);
    assert_int_equal(out[2], 255);
}

static void differences_are_found_wherever_they_are(void **state)
{
    (void)state;
    uint8_t a[8] = { 0, 10, 20, 30, 40, 50, 60, 70 };
    uint8_t b[8] = { 0, 10, 20, 30, 40, 50, 60, 79 };
    assert_int_equal(masu_ref_max_difference_rgba8(a, b, 2), 9);
    assert_int_equal(masu_ref_max_difference_rgba8(b, a, 2), 9);
    float x[3] = { 0.0f, 1.0f, 2.0f };
    float y[3] = { 0.5f, NAN, 2.0f };
    assert_near(masu_ref_max_difference(x, y, 1), 0.5, 0.0);
    assert_true(isnan(masu_ref_max_difference(x, y, 2)));
}

/* Hashes of the images that other tests' numbers were measured on: a change invalidates them. */
static void patterns_are_the_same_everywhere(void **state)
{
    (void)state;
    static const uint32_t golden[MASU_PATTERN_COUNT] = {
        0x40DB795Du, 0xEF652992u, 0x8C381F14u, 0x43A33790u, 0x8E77EA55u,
        0x76715EDFu, 0xCB7DB30Cu, 0xDBB7476Cu, 0xFDF88B28u,
    };
    for (int p = 0; p < MASU_PATTERN_COUNT; p++) {
        memset(bytes_in, 0x5A, sizeof bytes_in);
        masu_pattern_fill((enum masu_pattern)p, 7, 97, 61, bytes_in);
        uint32_t got = masu_pattern_fnv1a(bytes_in, 97 * 61 * 4);
        assert_int_equal(bytes_in[97 * 61 * 4], 0x5A);
        if (got != golden[p]) {
            fail_msg("%s: %08X, expected %08X", masu_pattern_name((enum masu_pattern)p), got,
                     golden[p]);
        }
    }
    assert_string_equal(masu_pattern_name(MASU_PATTERN_COUNT), "?");
}

static void patterns_are_what_their_names_say(void **state)
{
    (void)state;
    const uint32_t w = 96, h = 96;
    masu_pattern_fill(MASU_PATTERN_BINARY_NOISE, 1, w, h, bytes_in);
    uint32_t ones = 0;
    for (uint32_t i = 0; i < w * h * 4; i++) {
        assert_true(bytes_in[i] == 0 || bytes_in[i] == 255);
        ones += i % 4 != 3 && bytes_in[i];
    }
    assert_true(ones > w * h * 3 * 45 / 100 && ones < w * h * 3 * 55 / 100);

    masu_pattern_fill(MASU_PATTERN_DOTS, 1, w, h, bytes_in);
    uint32_t dots = 0;
    for (uint32_t i = 0; i < w * h; i++) {
        dots += bytes_in[i * 4] == 255;
    }
    assert_true(dots > w * h / 60 && dots < w * h / 25);

    /* A photo is smooth nearly everywhere but has steps; hard edges are flat except for steps. */
    static const enum masu_pattern kinds[] = { MASU_PATTERN_PHOTO, MASU_PATTERN_HARD_EDGES };
    for (size_t k = 0; k < 2; k++) {
        masu_pattern_fill(kinds[k], 1, w, h, bytes_in);
        uint32_t equal = 0, small = 0, large = 0;
        for (uint32_t i = 0; i + 1 < w * h; i++) {
            int d = abs(bytes_in[i * 4] - bytes_in[i * 4 + 4]);
            equal += d == 0;
            small += d > 0 && d < 16;
            large += d >= 32;
        }
        assert_true(large > 50);
        assert_true(kinds[k] == MASU_PATTERN_PHOTO ? small > w * h / 2 : equal > w * h * 8 / 10);
    }

    masu_pattern_fill(MASU_PATTERN_FLAT, 3, 2, 2, bytes_in);
    assert_int_equal(bytes_in[0], 255);
    masu_pattern_fill(MASU_PATTERN_FLAT, 1, 2, 2, bytes_in);
    assert_int_equal(bytes_in[13], 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_picture_comes_out_of_easu_unchanged_to_the_bit),
        cmocka_unit_test(easu_stays_within_its_four_centre_taps),
        cmocka_unit_test(easu_matches_a_case_computed_by_hand),
        cmocka_unit_test(easu_matches_an_independent_oblique_case),
        cmocka_unit_test(easu_of_a_mirrored_picture_is_the_mirrored_result),
        cmocka_unit_test(a_pixel_on_a_texel_centre_takes_the_side_that_amd_rounds_to),
        cmocka_unit_test(bit_tricks_change_each_kind_of_picture_by_the_documented_amount),
        cmocka_unit_test(bit_tricks_change_a_gentle_zone_plate_by_two_to_three_steps),
        cmocka_unit_test(a_smooth_ramp_hardly_sees_the_bit_tricks_and_stays_a_ramp),
        cmocka_unit_test(texels_outside_the_rectangle_never_matter),
        cmocka_unit_test(a_poisoned_texel_stays_in_range_and_within_the_footprint),
        cmocka_unit_test(rcas_matches_cases_computed_by_hand),
        cmocka_unit_test(rcas_uses_one_lobe_for_all_channels),
        cmocka_unit_test(rcas_survives_black_and_white_rings),
        cmocka_unit_test(rcas_returns_constants_exactly_in_8_bits),
        cmocka_unit_test(fewer_stops_sharpen_more),
        cmocka_unit_test(eight_bit_values_survive_the_trip_through_floats),
        cmocka_unit_test(differences_are_found_wherever_they_are),
        cmocka_unit_test(patterns_are_the_same_everywhere),
        cmocka_unit_test(patterns_are_what_their_names_say),
    };
    return cmocka_run_group_tests_name("fsr1_reference", tests, NULL, NULL);
}
