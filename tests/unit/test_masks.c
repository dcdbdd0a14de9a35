/* test_masks.c: mips of alpha-tested textures keep their coverage, after compression and with the
 * device's filtering. Five foliage images, 128x128, are rendered with 16 samples per texel;
 * masu-bake's mips of them are decoded by the runtime's own decoder, and sampled in double
 * precision at random positions. For comparison: plain mips, and mips that keep the fraction of
 * opaque texels. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bake/texture/mask.h"
#include "bake/texture/texel.h"
#include "support/random.h"
#include "scene/texture.h"

enum { SIDE = 128, TEXELS = SIDE * SIDE, MIPS = 8, CUTOFF = 128, FINE = 4 * SIDE, PICTURES = 5 };
enum { PLAIN, SHARE, MADE, WAYS };

static const char *const names[PICTURES] = {"leaves", "grass", "needles", "disc", "dots"};
static float levels[MIPS][4 * TEXELS];
static uint8_t alphas[WAYS][MIPS][TEXELS];
static unsigned char blocks[TEXELS];

static void draw(int picture) {
    static uint8_t fine[FINE * FINE];
    static const int counts[PICTURES] = {33, 60, 60, 1, 220};
    uint64_t seed = 7 + (uint64_t)picture;
    memset(fine, 0, sizeof fine);
    for (int n = 0; n < counts[picture]; n++) {
        double x = random_unit(&seed) * FINE, y = random_unit(&seed) * FINE,
               turn = random_unit(&seed) * 6.2832;
        double a = 90, b = 2.2; /* half axes of an ellipse */
        if (picture == 0) a = 60 * (0.6 + 0.6 * random_unit(&seed)), b = 0.4 * a;
        if (picture == 1)
            a = 200 * (0.5 + random_unit(&seed)), b = 5 + 5 * random_unit(&seed), turn *= 0.1;
        if (picture == 3) a = b = 0.36 * FINE, x = y = FINE / 2;
        if (picture == 4) a = b = 3 + 6 * random_unit(&seed);
        int reach = (int)a + 1;
        for (int j = -reach; j <= reach; j++) {
            for (int i = -reach; i <= reach; i++) {
                double u = (i * cos(turn) + j * sin(turn)) / a;
                double v = (j * cos(turn) - i * sin(turn)) / b;
                if (u * u + v * v >= 1) continue;
                fine[((int)y + j + 8 * FINE) % FINE * FINE + ((int)x + i + 8 * FINE) % FINE] = 1;
            }
        }
    }
    for (uint32_t i = 0; i < TEXELS; i++) {
        int sum = 0;
        for (uint32_t k = 0; k < 16; k++)
            sum += fine[(4 * (i / SIDE) + k / 4) * FINE + 4 * (i % SIDE) + k % 4];
        for (uint32_t k = 0; k < 3; k++) levels[0][4 * i + k] = 1;
        levels[0][4 * i + 3] = (float)sum / 16.0f;
    }
    for (uint32_t m = 1; m < MIPS; m++)
        masu_texel_halve(levels[m - 1], SIDE >> (m - 1), SIDE >> (m - 1), true, levels[m]);
}

/* Decodes the blocks with the runtime's decoder. */
static void decode(uint32_t side, uint8_t *alpha) {
    uint32_t across = (side + 3) / 4;
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = i % side, y = i / side;
        uint8_t block[64];
        masu_texture_decode(MASU_TEXTURE_BC3_SRGB, blocks + 16 * (y / 4 * across + x / 4), block);
        alpha[i] = block[4 * (y % 4 * 4 + x % 4) + 3];
    }
}

static double share(const uint8_t *alpha, uint32_t texels) {
    uint32_t there = 0;
    for (uint32_t i = 0; i < texels; i++) there += alpha[i] >= CUTOFF;
    return (double)there / texels;
}

/* Castano's first method, before compression: the fraction of the texels. */
static float share_scale(const float *level, uint32_t texels, double wanted) {
    float low = 1.0f / 16, high = 16;
    for (int i = 0; i < 24; i++) {
        float middle = sqrtf(low * high);
        uint32_t there = 0;
        for (uint32_t k = 0; k < texels; k++) there += level[4 * k + 3] * middle >= CUTOFF / 255.0f;
        if ((double)there / texels < wanted) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return high;
}

/* Mips without this processing: blocks of the scaled alpha. */
static void plain_blocks(const float *level, uint32_t side, float scale) {
    static uint8_t bytes[4 * TEXELS];
    for (uint32_t i = 0; i < 4 * side * side; i++)
        bytes[i] = masu_texel_to_unorm(level[i] * (i % 4 == 3 ? scale : 1.0f));
    masu_texel_blocks(MASU_TEXTURE_BC3_SRGB, bytes, side, side, blocks);
}

static void make_mips(int picture) {
    static uint8_t scratch[TEXELS];
    draw(picture);
    double wanted = 0, texels = 0;
    for (uint32_t m = 0; m < MIPS; m++) {
        uint32_t side = SIDE >> m;
        plain_blocks(levels[m], side, 1);
        decode(side, alphas[PLAIN][m]);
        float scale = m ? share_scale(levels[m], side * side, texels) : 1;
        plain_blocks(levels[m], side, scale);
        decode(side, alphas[SHARE][m]);
        scale = m ? masu_mask_scale(levels[m], side, side, CUTOFF, wanted, scratch) : 1;
        masu_mask_encode(levels[m], side, side, CUTOFF, scale, scratch, blocks);
        decode(side, alphas[MADE][m]);
        if (m) continue;
        wanted = masu_mask_coverage(scratch, side, side, CUTOFF);
        texels = share(alphas[SHARE][0], TEXELS);
    }
}

/* ---- Coverage -------------------------------------------------------------------------------- */

static double sample(const uint8_t *alpha, uint32_t side, double u, double v) {
    double x = u * side + 7.5 * side - 0.5, y = v * side + 7.5 * side - 0.5;
    uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
    double fx = x - ix, fy = y - iy;
    const uint8_t *row[2] = {alpha + iy % side * side, alpha + (iy + 1) % side * side};
    uint32_t left = ix % side, right = (ix + 1) % side;
    return (1 - fy) * ((1 - fx) * row[0][left] + fx * row[0][right]) +
           fy * ((1 - fx) * row[1][left] + fx * row[1][right]);
}

/* Coverage that a trilinear sampler gives at a level between mips. */
static double seen(int way, double lod) {
    uint32_t m = (uint32_t)lod, there = 0, count = 40000;
    double f = lod - m;
    uint64_t seed = 99;
    for (uint32_t i = 0; i < count; i++) {
        double u = random_unit(&seed), v = random_unit(&seed),
               a = sample(alphas[way][m], SIDE >> m, u, v);
        if (f > 0) a += f * (sample(alphas[way][m + 1], SIDE >> (m + 1), u, v) - a);
        there += a >= CUTOFF;
    }
    return (double)there / count;
}

static void every_mip_covers_what_the_first_covers(void **state) {
    (void)state;
    for (int picture = 0; picture < PICTURES; picture++) {
        make_mips(picture);
        double first = masu_mask_coverage(alphas[MADE][0], SIDE, SIDE, CUTOFF);
        print_message("%s, %.4f: mip, plain, share of texels, as made\n", names[picture], first);
        for (uint32_t m = 0; m < MIPS - 1; m++) {
            uint32_t side = SIDE >> m;
            double got[WAYS];
            for (int w = 0; w < WAYS; w++)
                got[w] = masu_mask_coverage(alphas[w][m], side, side, CUTOFF);
            print_message("  %u %.4f %.4f %.4f\n", m, got[PLAIN], got[SHARE], got[MADE]);
            double texel = 1.0 / (side * side);
            assert_true(fabs(got[MADE] - first) <= (texel > 0.01 ? texel : 0.01));
        }
        if (picture == 2 || picture == 4) { /* thin shapes were lost */
            assert_true(masu_mask_coverage(alphas[PLAIN][3], SIDE >> 3, SIDE >> 3, CUTOFF) < 0.01);
            assert_true(masu_mask_coverage(alphas[SHARE][3], SIDE >> 3, SIDE >> 3, CUTOFF) <
                        0.8 * first);
        }
    }
}

static void a_sampler_sees_that_coverage_between_mips_too(void **state) {
    (void)state;
    double worst[WAYS] = {0};
    for (int picture = 0; picture < PICTURES; picture++) {
        make_mips(picture);
        double first = seen(MADE, 0);
        for (double lod = 0; lod <= 4; lod += 0.25) {
            for (int w = 0; w < WAYS; w++) {
                double off = fabs(seen(w, lod) - first);
                if (off > worst[w]) worst[w] = off;
            }
            assert_true(fabs(seen(MADE, lod) - first) < 0.035);
        }
    }
    print_message(
        "coverage in a trilinear sampler, down to 8 texels: error %.3f plain, %.3f by share of "
        "texels, %.3f as made\n",
        worst[PLAIN], worst[SHARE], worst[MADE]);
    assert_true(worst[PLAIN] > 0.09 && worst[SHARE] > 2 * worst[MADE]);
}

/* The measure against random positions. */
static void coverage_is_what_random_places_say(void **state) {
    (void)state;
    for (int picture = 0; picture < PICTURES; picture++) {
        make_mips(picture);
        for (uint32_t m = 0; m < 5; m++) {
            double c = masu_mask_coverage(alphas[MADE][m], SIDE >> m, SIDE >> m, CUTOFF);
            assert_true(fabs(c - seen(MADE, m)) < 0.012); /* 4 sigma of 40,000 positions */
        }
    }
}

/* ---- Blocks ---------------------------------------------------------------------------------- */

static void compression_moves_no_texel_across_the_cut_off(void **state) {
    (void)state;
    static uint8_t alpha[TEXELS];
    uint64_t seed = 1;
    uint32_t moved = 0, plain = 0;
    for (int kind = 0; kind < 3; kind++) { /* noise; close to the cut-off; almost opaque or
                                              transparent */
        for (uint32_t i = 0; i < TEXELS; i++) {
            float a = (float)random_unit(&seed);
            if (kind == 1) a = (124.0f + 8.0f * a) / 255.0f;
            if (kind == 2) a = a < 0.5f ? 0.1f * a : 1 - 0.1f * a;
            levels[0][4 * i + 3] = a;
        }
        masu_mask_encode(levels[0], SIDE, SIDE, CUTOFF, 1, alpha, blocks);
        decode(SIDE, alphas[MADE][0]);
        assert_memory_equal(alpha, alphas[MADE][0], TEXELS);
        plain_blocks(levels[0], SIDE, 1);
        decode(SIDE, alphas[PLAIN][0]);
        for (uint32_t i = 0; i < TEXELS; i++) {
            int there = masu_texel_to_unorm(levels[0][4 * i + 3]) >= CUTOFF;
            moved += (alpha[i] >= CUTOFF) != there;
            plain += (alphas[PLAIN][0][i] >= CUTOFF) != there;
        }
    }
    print_message("%u of %d texels on another side of the cut-off, %u by only the encoder\n",
                  moved, 3 * TEXELS, plain);
    assert_int_equal(moved, 0);
    assert_true(plain > 100);
}

static void masks_of_everything_or_nothing_stay_so(void **state) {
    (void)state;
    uint8_t alpha[15];
    for (int full = 0; full < 2; full++) {
        for (uint32_t i = 0; i < 15; i++) levels[0][4 * i + 3] = (float)full;
        for (uint32_t cutoff = 1; cutoff < 256; cutoff += 127) {
            float scale = masu_mask_scale(levels[0], 5, 3, (uint8_t)cutoff, full, alpha);
            assert_true(scale > 0.01f && scale < 100.0f);
            masu_mask_encode(levels[0], 5, 3, (uint8_t)cutoff, scale, alpha, NULL);
            assert_float_equal(masu_mask_coverage(alpha, 5, 3, (uint8_t)cutoff), full, 0);
        }
    }
    levels[0][3] = (float)NAN;
    masu_mask_encode(levels[0], 1, 1, CUTOFF, 1, alpha, NULL);
    assert_float_equal(masu_mask_coverage(alpha, 1, 1, CUTOFF), 0, 0);
    assert_float_equal(masu_mask_coverage(alpha, 1, 1, 0), 1, 0);
}

/* Masks are detected by their histogram: the foliage above is one, gloss or smoke is not. */
static void masks_are_told_from_what_else_is_in_alpha(void **state) {
    (void)state;
    uint64_t histogram[256];
    for (int p = 0; p < PICTURES; p++) {
        draw(p);
        memset(histogram, 0, sizeof histogram);
        for (uint32_t i = 0; i < TEXELS; i++) histogram[(int)(levels[0][4 * i + 3] * 255 + 0.5f)]++;
        if (!masu_mask_is_meant(histogram, CUTOFF)) fail_msg("%s are no mask", names[p]);
    }
    for (int kind = 0; kind < 5; kind++) {
        for (int a = 0; a < 256; a++)
            histogram[a] = kind == 0 ? 1 /* a gradient */
                           : kind == 1
                               ? (a < 200 ? 256u - (unsigned)a : 0) /* a gloss, mostly dull */
                           : kind == 2 ? a == 0                     /* all texels at 0 */
                           : kind == 3 ? a >= 200                   /* no texel below the cut-off */
                                       : a == 0 || a == 120;        /* no solid texel */
        if (masu_mask_is_meant(histogram, CUTOFF)) fail_msg("kind %d is a mask", kind);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mip_covers_what_the_first_covers),
        cmocka_unit_test(a_sampler_sees_that_coverage_between_mips_too),
        cmocka_unit_test(coverage_is_what_random_places_say),
        cmocka_unit_test(compression_moves_no_texel_across_the_cut_off),
        cmocka_unit_test(masks_of_everything_or_nothing_stay_so),
        cmocka_unit_test(masks_are_told_from_what_else_is_in_alpha),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
