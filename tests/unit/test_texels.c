/* test_texels.c: masu-bake's texel processing (mips, masks, roughness, block compression) and the
 * runtime's (decoding, the walk of chunks). Images are patterns whose mean, coverage or error is
 * exact without the code under test. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bake/texture/texel.h"
#include "support/random.h"
#include "scene/texture.h"

enum { SIDE = 64, TEXELS = SIDE * SIDE };

static float level[4 * TEXELS], next[4 * TEXELS];

/* ---- Mips ------------------------------------------------------------------------------------ */

static void srgb_goes_to_light_and_back(void **state) {
    (void)state;
    for (int c = 0; c < 256; c++) {
        assert_int_equal(masu_texel_to_srgb(masu_texel_from_srgb((uint8_t)c)), c);
        assert_int_equal(masu_texel_to_unorm((float)c / 255.0f), c);
    }
    assert_float_equal(masu_texel_from_srgb(255), 1.0f, 1e-7f);
    assert_float_equal(masu_texel_from_srgb(188), 0.5029f, 1e-4f); /* IEC 61966-2-1 */
    assert_int_equal(masu_texel_to_srgb(0.5f), 188);
    assert_int_equal(masu_texel_to_srgb(7.0f), 255);
    assert_int_equal(masu_texel_to_srgb(-1.0f), 0);
    assert_int_equal(masu_texel_to_srgb((float)NAN), 0);
    assert_int_equal(masu_texel_to_unorm((float)NAN), 0);
}

/* The mean of all texels is the mean of the image, at every mip and for any size: each texel is
 * weighted exactly by the area that it covers. */
static void every_mip_has_the_mean_of_the_picture(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{64, 64}, {1, 1}, {1, 64}, {64, 1}, {37, 21},
                                        {3, 3},   {2, 3}, {63, 5}, {7, 64}};
    uint64_t seed = 5;
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        uint32_t w = sizes[s][0], h = sizes[s][1];
        double mean = 0;
        for (uint32_t i = 0; i < 4 * w * h; i++) {
            level[i] = (float)support_random_in(&seed, 0, 1000) / 1000.0f;
            if (i % 4 == 0) mean += (double)level[i] / (w * h);
        }
        while (w > 1 || h > 1) {
            masu_texel_halve(level, w, h, false, next);
            w = w > 1 ? w / 2 : 1;
            h = h > 1 ? h / 2 : 1;
            memcpy(level, next, sizeof level);
            double now = 0;
            for (uint32_t i = 0; i < w * h; i++) now += (double)level[4 * i] / (w * h);
            assert_true(fabs(now - mean) < 1e-5);
        }
    }
}

static void a_checker_becomes_grey_of_half_the_light(void **state) {
    (void)state;
    for (uint32_t i = 0; i < TEXELS; i++) {
        float c = masu_texel_from_srgb((i + i / SIDE) % 2 ? 255 : 0);
        for (uint32_t k = 0; k < 4; k++) level[4 * i + k] = k < 3 ? c : 1.0f;
    }
    masu_texel_halve(level, SIDE, SIDE, false, next);
    for (uint32_t i = 0; i < TEXELS / 4; i++) {
        assert_int_equal(masu_texel_to_srgb(next[4 * i]), 188);
    }
}

static void what_cannot_be_seen_does_not_bleed_into_colour(void **state) {
    (void)state;
    /* One red texel of four; the others are blue and transparent. */
    static const float from[16] = {1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    float to[4];
    masu_texel_halve(from, 2, 2, true, to);
    assert_float_equal(to[0], 1.0f, 1e-6f);
    assert_float_equal(to[2], 0.0f, 1e-6f);
    assert_float_equal(to[3], 0.25f, 1e-6f);
    masu_texel_halve(from, 2, 2, false, to);
    assert_float_equal(to[2], 0.75f, 1e-6f);
}

/* ---- Roughness ------------------------------------------------------------------------------- */

/* Slopes of variance s in both directions on top of a surface of slopes of variance a: together
 * a + s. alpha^2 is twice the variance. */
static void lost_normals_become_roughness(void **state) {
    (void)state;
    uint64_t seed = 3;
    for (int n = 1; n < 4; n++) {
        double s = 0.001 * n * n, sum[3] = {0}, slopes = 0;
        int count = 200000;
        for (int i = 0; i < count; i++) {
            double x = 0, y = 0; /* close enough to a normal distribution */
            for (int k = 0; k < 12; k++) {
                x += (double)support_random_in(&seed, 0, 100000) / 100000.0 - 0.5;
                y += (double)support_random_in(&seed, 0, 100000) / 100000.0 - 0.5;
            }
            x *= sqrt(s), y *= sqrt(s);
            double l = sqrt(x * x + y * y + 1);
            sum[0] += x / l, sum[1] += y / l, sum[2] += 1 / l;
            slopes += (x * x + y * y) / 2;
        }
        double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / count;
        for (int k = 0; k < 3; k++) {
            float roughness = 0.1f + 0.3f * (float)k;
            double alpha2 = pow((double)roughness, 4) + 2 * slopes / count;
            float got = masu_texel_rougher(roughness, (float)length);
            assert_true(fabs((double)got - pow(alpha2, 0.25)) < 0.01);
        }
    }
    assert_float_equal(masu_texel_rougher(0.4f, 1.0f), 0.4f, 1e-6f);
    assert_float_equal(masu_texel_rougher(0.4f, 0.0f), 1.0f, 0);
    assert_true(masu_texel_rougher(0.0f, 0.9f) > 0.0f);
}

/* ---- Blocks ---------------------------------------------------------------------------------- */

static uint8_t picture[4 * TEXELS], decoded[4 * TEXELS];
static unsigned char blocks[TEXELS];

static void draw_picture(int which) {
    uint64_t seed = 17;
    for (uint32_t y = 0; y < SIDE; y++) {
        for (uint32_t x = 0; x < SIDE; x++) {
            uint8_t *t = picture + 4 * (y * SIDE + x);
            double fx = x / 63.0, fy = y / 63.0;
            for (int k = 0; k < 4; k++) {
                double v = which == 0   ? (k == 0   ? fx
                                           : k == 1 ? fy
                                           : k == 2 ? 0.5
                                                    : fx * fy)
                           : which == 1 ? 0.5 + 0.4 * sin(fx * 9 + k) * cos(fy * 7 - k)
                                        : (double)support_random_in(&seed, 0, 255) / 255.0;
                t[k] = (uint8_t)(v * 255 + 0.5);
            }
        }
    }
}

/* Peak signal to noise ratio of the first `channels`, after blocks and back, in dB. */
static double psnr(uint32_t format, int channels) {
    size_t bytes = masu_texel_blocks(format, picture, SIDE, SIDE, blocks);
    assert_int_equal(bytes, (size_t)TEXELS / 16 * masu_blob_block_bytes(format));
    masu_blob_texture t = {format, SIDE, SIDE, 1, 1, MASU_BLOB_NONE, 0};
    masu_texture_cursor cursor = {0};
    masu_texture_region region;
    uint64_t used = 0;
    assert_true(masu_texture_next(&t, 1, 0, sizeof decoded, &cursor, &used, &region));
    masu_texture_write_region(&t, blocks, 0, &region, decoded);
    uint32_t stride = masu_texture_form_of(format, 0).block_bytes;
    double error = 0;
    for (uint32_t i = 0; i < TEXELS; i++) {
        for (int k = 0; k < channels; k++) {
            double d = (double)decoded[stride * i + (uint32_t)k] - picture[4 * i + (uint32_t)k];
            error += d * d;
        }
    }
    error /= (double)TEXELS * channels;
    return error > 0 ? 10 * log10(255.0 * 255.0 / error) : 99;
}

static void blocks_are_near_their_picture(void **state) {
    (void)state;
    static const struct {
        uint32_t format;
        int channels;
        const char *name;
        double least[3]; /* gradient, waves, noise; 1 dB below the measured values */
    } rows[] = {{MASU_TEXTURE_BC1_SRGB, 3, "BC1", {35.9, 31.1, 12.6}},
                {MASU_TEXTURE_BC3_SRGB, 4, "BC3", {37.1, 32.3, 13.8}},
                {MASU_TEXTURE_BC4, 1, "BC4", {50.4, 44.6, 28.2}},
                {MASU_TEXTURE_BC5, 2, "BC5", {50.4, 44.7, 28.2}}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double got[3];
        for (int p = 0; p < 3; p++) {
            draw_picture(p);
            got[p] = psnr(rows[i].format, rows[i].channels);
        }
        print_message("%s: gradient %.1f dB, waves %.1f, noise %.1f\n", rows[i].name, got[0],
                      got[1], got[2]);
        for (int p = 0; p < 3; p++) assert_true(got[p] >= rows[i].least[p]);
    }
}

/* The colour of texel 0 of a block of BC1, exactly. */
static void first_color(const unsigned char *b, int four, double out[3]) {
    uint32_t ends[2] = {b[0] | (uint32_t)b[1] << 8, b[2] | (uint32_t)b[3] << 8}, index = b[4] & 3;
    for (int k = 0; k < 3; k++) {
        double e[2];
        for (int i = 0; i < 2; i++) {
            uint32_t c = k == 1 ? ends[i] >> 5 & 63 : ends[i] >> (k ? 0 : 11) & 31;
            e[i] = k == 1 ? c << 2 | c >> 4 : c << 3 | c >> 2;
        }
        out[k] = index < 2                   ? e[index]
                 : four || ends[0] > ends[1] ? (index == 2 ? 2 * e[0] + e[1] : e[0] + 2 * e[1]) / 3
                                             : (e[0] + e[1]) / 2;
    }
}

/* The optimum of endpoints with 5, 6 and 5 bits and their thirds is 4/3; greys remain grey. */
static void solid_blocks_are_as_near_as_can_be(void **state) {
    (void)state;
    uint64_t seed = 23;
    for (int i = 0; i < 256 + 4000; i++) {
        uint8_t texels[64];
        unsigned char out[16];
        for (int k = 0; k < 4; k++)
            texels[k] = i < 256 && k < 3 ? (uint8_t)i : (uint8_t)support_random_in(&seed, 0, 255);
        for (int t = 1; t < 16; t++) memcpy(texels + 4 * t, texels, 4);
        for (int form = 0; form < 2; form++) {
            double got[3];
            assert_int_equal(masu_texel_blocks(form ? MASU_TEXTURE_BC3_SRGB : MASU_TEXTURE_BC1_SRGB,
                                               texels, 4, 4, out),
                             form ? 16 : 8);
            first_color(out + 8 * form, form, got);
            for (int k = 0; k < 3; k++) {
                if (!(fabs(got[k] - texels[k]) <= 1.4))
                    fail_msg("%d %d %d, channel %d: %g", texels[0], texels[1], texels[2], k,
                             got[k]);
                if (i < 256 && !(fabs(got[k] - got[0]) <= 1))
                    fail_msg("grey %d: %g %g %g", i, got[0], got[1], got[2]);
            }
            for (int t = 1; t < 4; t++) assert_int_equal(out[8 * form + 4 + t], out[8 * form + 4]);
            assert_int_equal(out[8 * form + 4] & 3, out[8 * form + 4] >> 6);
        }
    }
}

/* Hand-made blocks, texels from the definition of the format. */
static void blocks_decode_as_the_formats_say(void **state) {
    (void)state;
    uint8_t t[64];
    /* Red and blue, 565; each texel of the first row another index. */
    static const unsigned char bc1[8] = {0x00, 0xF8, 0x1F, 0x00, 0xE4, 0, 0, 0};
    masu_texture_decode(MASU_TEXTURE_BC1_SRGB, bc1, t);
    static const uint8_t four[16] = {255, 0, 0,  255, 0,  0, 255, 255,
                                     170, 0, 85, 255, 85, 0, 170, 255};
    assert_memory_equal(t, four, 16);
    /* The smaller one first: three colours and black. */
    static const unsigned char three[8] = {0x1F, 0x00, 0x00, 0xF8, 0xE4, 0, 0, 0};
    masu_texture_decode(MASU_TEXTURE_BC1_SRGB, three, t);
    static const uint8_t black[16] = {0,   0, 255, 255, 255, 0, 0, 255,
                                      128, 0, 128, 255, 0,   0, 0, 255};
    assert_memory_equal(t, black, 16);
    /* 255 down to 0 in eight steps, then 0 to 255 in six and the two ends. */
    static const unsigned char down[8] = {255, 0, 0x88, 0xC6, 0xFA, 0, 0, 0};
    masu_texture_decode(MASU_TEXTURE_BC4, down, t);
    static const uint8_t eight[8] = {255, 0, 219, 182, 146, 109, 73, 36};
    assert_memory_equal(t, eight, 8);
    static const unsigned char up[8] = {0, 255, 0x88, 0xC6, 0xFA, 0, 0, 0};
    masu_texture_decode(MASU_TEXTURE_BC4, up, t);
    static const uint8_t six[8] = {0, 255, 51, 102, 153, 204, 0, 255};
    assert_memory_equal(t, six, 8);
    /* BC3 always has four colours, in either order of the endpoints. */
    unsigned char bc3[16], bc5[16];
    memcpy(bc3, down, 8);
    memcpy(bc3 + 8, three, 8);
    masu_texture_decode(MASU_TEXTURE_BC3_SRGB, bc3, t);
    static const uint8_t with_alpha[16] = {0,  0, 255, 255, 255, 0, 0,  0,
                                           85, 0, 170, 219, 170, 0, 85, 182};
    assert_memory_equal(t, with_alpha, 16);
    memcpy(bc5, down, 8);
    memcpy(bc5 + 8, up, 8);
    masu_texture_decode(MASU_TEXTURE_BC5, bc5, t);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(t[2 * i], eight[i]);
        assert_int_equal(t[2 * i + 1], six[i]);
    }
}

static void blocks_at_an_odd_edge_hold_what_is_there(void **state) {
    (void)state;
    draw_picture(0);
    for (uint32_t w = 1; w <= 9; w++) {
        for (uint32_t h = 1; h <= 9; h += 2) {
            /* One colour: padding of the blocks must not be visible. */
            for (uint32_t i = 0; i < w * h; i++) memcpy(picture + 4 * i, "\x10\x80\xFF\xFF", 4);
            size_t bytes = masu_texel_blocks(MASU_TEXTURE_BC1_SRGB, picture, w, h, blocks);
            assert_int_equal(bytes, (size_t)((w + 3) / 4) * ((h + 3) / 4) * 8);
            for (size_t b = 0; b < bytes; b += 8) {
                uint8_t t[64];
                masu_texture_decode(MASU_TEXTURE_BC1_SRGB, blocks + b, t);
                for (int i = 0; i < 16; i++) assert_true(abs(t[4 * i + 1] - 0x80) <= 2);
            }
        }
    }
}

/* ---- The walk -------------------------------------------------------------------------------- */

/* Every texel of every mip and layer is in exactly one region, in order; regions of a chunk do not
 * overlap in the staging buffer and do not exceed it. */
static void walk(const masu_blob_texture *textures, uint32_t count, int compressed, uint64_t room) {
    static uint8_t seen[3][2][8][32][32]; /* texture, layer, mip, y, x / 4 texels */
    memset(seen, 0, sizeof seen);
    masu_texture_cursor cursor = {0};
    uint32_t chunks = 0, firsts = 0, lasts = 0;
    while (cursor.texture < count) {
        masu_texture_region r;
        uint64_t used = 0, before = 0;
        while (masu_texture_next(textures, count, compressed, room, &cursor, &used, &r)) {
            const masu_blob_texture *t = &textures[r.texture];
            assert_true(r.offset % 16 == 0 && r.offset >= before && used <= room);
            assert_true(r.offset < used);
            before = used;
            assert_int_equal(r.width, masu_blob_mip_size(t->width, r.mip));
            assert_true(r.y % 4 == 0 && r.y + r.height <= masu_blob_mip_size(t->height, r.mip));
            assert_true(r.height % 4 == 0 ||
                        r.y + r.height == masu_blob_mip_size(t->height, r.mip));
            assert_true(r.source + r.rows * r.source_row <= t->offset + masu_blob_texture_bytes(t));
            for (uint32_t y = r.y; y < r.y + r.height; y++) {
                for (uint32_t x = 0; x < r.width; x += 4) {
                    assert_int_equal(seen[r.texture][r.layer][r.mip][y][x / 4]++, 0);
                }
            }
            firsts += (uint32_t)r.first;
            lasts += (uint32_t)r.last;
        }
        assert_true(used > 0);
        chunks++;
    }
    assert_int_equal(firsts, count);
    assert_int_equal(lasts, count);
    assert_int_equal(masu_texture_chunks(textures, count, compressed, room), chunks);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t l = 0; l < textures[i].layers; l++) {
            for (uint32_t m = 0; m < textures[i].mips; m++) {
                for (uint32_t y = 0; y < masu_blob_mip_size(textures[i].height, m); y++) {
                    for (uint32_t x = 0; x < masu_blob_mip_size(textures[i].width, m); x += 4) {
                        assert_int_equal(seen[i][l][m][y][x / 4], 1);
                    }
                }
            }
        }
    }
}

static void chunks_of_any_size_copy_every_texel_once(void **state) {
    (void)state;
    masu_blob_texture textures[3] = {{MASU_TEXTURE_BC3_SRGB, 30, 17, 5, 2, MASU_BLOB_NONE, 0},
                                     {MASU_TEXTURE_BC1_SRGB, 5, 32, 6, 2, MASU_BLOB_NONE, 0},
                                     {MASU_TEXTURE_BC4, 1, 1, 1, 1, MASU_BLOB_NONE, 0}};
    for (int i = 1; i < 3; i++) {
        uint64_t end = textures[i - 1].offset + masu_blob_texture_bytes(&textures[i - 1]);
        textures[i].offset = (end + 15) / 16 * 16;
    }
    for (uint64_t room = 480; room < 3000; room += 7) {
        walk(textures, 3, 0, room);
        walk(textures, 3, 1, room);
    }
    walk(textures, 3, 0, (uint64_t)1 << 32);
    assert_int_equal(masu_texture_chunks(textures, 3, 0, (uint64_t)1 << 32), 1);
    assert_int_equal(masu_texture_chunks(textures, 3, 1, 64),
                     0); /* not a row fits: no endless loop */
    assert_int_equal(masu_texture_chunks(textures, 0, 1, 64), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(srgb_goes_to_light_and_back),
        cmocka_unit_test(every_mip_has_the_mean_of_the_picture),
        cmocka_unit_test(a_checker_becomes_grey_of_half_the_light),
        cmocka_unit_test(what_cannot_be_seen_does_not_bleed_into_colour),
        cmocka_unit_test(lost_normals_become_roughness),
        cmocka_unit_test(blocks_are_near_their_picture),
        cmocka_unit_test(solid_blocks_are_as_near_as_can_be),
        cmocka_unit_test(blocks_decode_as_the_formats_say),
        cmocka_unit_test(blocks_at_an_odd_edge_hold_what_is_there),
        cmocka_unit_test(chunks_of_any_size_copy_every_texel_once),
    };
    return cmocka_run_group_tests_name("texels", tests, NULL, NULL);
}
