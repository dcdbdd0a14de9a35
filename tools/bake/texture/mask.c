/* mask.c: see mask.h. */
#include "bake/texture/mask.h"
#include "bake/texture/texel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* bisection steps over a range of 256: to 2^-15 of the scale, finer than bytes */
#define HALVINGS 18
#define LARGEST 16.0f
/* Measured on 140 masks of trees, fences and lamps: at most 17 % of the texels are in between.
 * Textures that are not masks have at least 24 %. */
#define CLEAR 26
#define SOLID 230
#define BETWEEN_MOST 0.25
#define SOLID_LEAST 0.01

/* Sample positions between four texels at odd eighths: their weights are whole 64ths. */
static uint32_t places(int a, int b, int c, int d, int cutoff) {
    uint32_t there = (uint32_t)(a >= cutoff) + (b >= cutoff) + (c >= cutoff) + (d >= cutoff);
    /* samples between them are all above or all below */
    if (there == 0 || there == 4) return 4 * there;
    there = 0;
    for (int y = 1; y < 8; y += 2) {
        for (int x = 1; x < 8; x += 2) {
            int sum = (8 - y) * ((8 - x) * a + x * b) + y * ((8 - x) * c + x * d);
            there += sum >= 64 * cutoff;
        }
    }
    return there;
}

bool masu_mask_is_meant(const uint64_t histogram[256], uint8_t cutoff) {
    uint64_t all = 0, below = 0, clear = 0, solid = 0;
    for (int a = 0; a < 256; a++) {
        all += histogram[a];
        below += a < cutoff ? histogram[a] : 0;
        clear += a < CLEAR ? histogram[a] : 0;
        solid += a >= SOLID ? histogram[a] : 0;
    }
    return below && (double)solid >= SOLID_LEAST * (double)all &&
           (double)(all - clear - solid) <= BETWEEN_MOST * (double)all;
}

double masu_mask_coverage(const uint8_t *alpha, uint32_t width, uint32_t height, uint8_t cutoff) {
    uint64_t sum = 0;
    for (uint32_t y = 0; y < height; y++) {
        const uint8_t *row = alpha + (size_t)y * width;
        const uint8_t *below = alpha + (size_t)((y + 1) % height) * width;
        for (uint32_t x = 0; x < width; x++) {
            uint32_t right = x + 1 < width ? x + 1 : 0;
            sum += places(row[x], row[right], below[x], below[right], cutoff);
        }
    }
    return (double)sum / (16.0 * width * height);
}

/* The eight values of a block, rounded as in src/scene/texture.c; a device may differ by one. */
static void values_of(const unsigned char block[8], int values[8]) {
    int a = values[0] = block[0], b = values[1] = block[1];
    for (int i = 1; a > b && i < 7; i++) values[1 + i] = ((7 - i) * a + i * b + 3) / 7;
    for (int i = 1; a <= b && i < 5; i++) values[1 + i] = ((5 - i) * a + i * b + 2) / 5;
    if (a <= b) values[6] = 0, values[7] = 255;
}

/* The index of the value closest to `wanted` on the same side of the cut-off; -1: none. A value
 * that is within rounding of the cut-off belongs to neither side, if there is an alternative. */
static int next_value(const int values[8], int wanted, int cutoff) {
    int best = -1, nearest = 1 << 20;
    for (int i = 0; i < 8; i++) {
        if ((values[i] >= cutoff) != (wanted >= cutoff)) continue;
        int risky = values[i] == cutoff - 1 || values[i] == cutoff;
        int away = abs(values[i] - wanted) + (risky && i > 1 ? 2 : 0);
        if (away >= nearest) continue;
        nearest = away;
        best = i;
    }
    return best;
}

/* Encodes a block and decodes it again. The encoder may choose a value on the wrong side of the
 * cut-off. The ends of its range are the least and largest alpha of the block, so a value on the
 * right side is always close. */
static void encode_block(const uint8_t alpha[16], int cutoff, unsigned char block[8],
                         uint8_t decoded[16]) {
    int values[8];
    uint64_t bits = 0;
    masu_texel_alpha_block(alpha, block);
    values_of(block, values);
    for (uint32_t i = 0; i < 6; i++) bits |= (uint64_t)block[2 + i] << 8 * i;
    for (uint32_t i = 0; i < 16; i++) {
        uint32_t index = (uint32_t)(bits >> 3 * i & 7);
        int good = next_value(values, alpha[i], cutoff);
        if (good >= 0 && (values[index] >= cutoff) != (alpha[i] >= cutoff)) {
            index = (uint32_t)good;
            bits = (bits & ~(UINT64_C(7) << 3 * i)) | (uint64_t)index << 3 * i;
        }
        decoded[i] = (uint8_t)values[index];
    }
    for (uint32_t i = 0; i < 6; i++) block[2 + i] = (unsigned char)(bits >> 8 * i);
}

void masu_mask_encode(const float *level, uint32_t width, uint32_t height, uint8_t cutoff,
                      float scale, uint8_t *alpha, unsigned char *blocks) {
    for (uint32_t y = 0; y < height; y += 4) {
        for (uint32_t x = 0; x < width; x += 4) {
            uint8_t texels[16], decoded[16];
            unsigned char block[8];
            for (uint32_t i = 0; i < 16; i++) {
                uint32_t row = y + i / 4 < height ? y + i / 4 : height - 1;
                uint32_t column = x + i % 4 < width ? x + i % 4 : width - 1;
                texels[i] =
                    masu_texel_to_unorm(level[4 * ((size_t)row * width + column) + 3] * scale);
            }
            encode_block(texels, cutoff, block, decoded);
            for (uint32_t i = 0; i < 16; i++) {
                if (y + i / 4 >= height || x + i % 4 >= width) continue;
                alpha[(size_t)(y + i / 4) * width + x + i % 4] = decoded[i];
            }
            if (!blocks) continue;
            memcpy(blocks, block, sizeof block);
            blocks += 16;
        }
    }
}

/* Coverage rises with the scale in steps and, apart from compression errors, never falls. Bisection
 * ends at the step next to `wanted`; the result is the best scale of all that were tried. */
float masu_mask_scale(const float *level, uint32_t width, uint32_t height, uint8_t cutoff,
                      double wanted, uint8_t *alpha) {
    float low = 1 / LARGEST, high = LARGEST, best = 1;
    double least = (double)INFINITY;
    for (int i = 0; i < HALVINGS; i++) {
        float middle = sqrtf(low * high);
        masu_mask_encode(level, width, height, cutoff, middle, alpha, NULL);
        double off = masu_mask_coverage(alpha, width, height, cutoff) - wanted;
        if (fabs(off) < least) {
            least = fabs(off);
            best = middle;
        }
        if (off < 0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return best;
}
