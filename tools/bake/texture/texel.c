/* texel.c: see texel.h. Blocks are made by stb_dxt of the package libstb-dev. */
#include "bake/texture/texel.h"

#include <math.h>
#include <string.h>

#define STB_DXT_STATIC
#define STB_DXT_IMPLEMENTATION
#include <stb/stb_dxt.h>

float masu_texel_from_srgb(uint8_t c) {
    double v = c / 255.0;
    return (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
}

uint8_t masu_texel_to_unorm(float v) {
    if (!(v > 0)) return 0;
    return v < 1 ? (uint8_t)(v * 255.0f + 0.5f) : 255;
}

uint8_t masu_texel_to_srgb(float linear) {
    if (!(linear > 0)) return 0;
    double v = (double)linear;
    return masu_texel_to_unorm(
        (float)(v <= 0.0031308 ? v * 12.92 : 1.055 * pow(v, 1 / 2.4) - 0.055));
}

/* ---- mips ---- */

/* The texels of an axis of `from` that texel i of `to` covers, and how much of each: at most three
 * for to = from / 2, all of them if to is 1. */
typedef struct cover {
    uint32_t first, count;
    float weight[4];
} cover;

static cover cover_of(uint32_t i, uint32_t from, uint32_t to) {
    double start = (double)i * from / to, end = (double)(i + 1) * from / to;
    cover c = {(uint32_t)start, 0, {0}};
    for (uint32_t k = c.first; k < from && (double)k < end - 1e-9 && c.count < 4; k++) {
        double part = fmin(end, k + 1.0) - fmax(start, (double)k);
        c.weight[c.count++] = (float)(part / (end - start));
    }
    return c;
}

static void mean(const float *from, uint32_t width, const cover *x, const cover *y, bool by_alpha,
                 float *to) {
    double sum[4] = {0}, color[3] = {0};
    for (uint32_t j = 0; j < y->count; j++) {
        for (uint32_t i = 0; i < x->count; i++) {
            const float *t = from + 4 * ((size_t)(y->first + j) * width + x->first + i);
            double w = (double)y->weight[j] * (double)x->weight[i];
            for (int k = 0; k < 4; k++) sum[k] += w * (double)t[k];
            for (int k = 0; k < 3; k++) color[k] += w * (double)t[3] * (double)t[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        to[k] = (float)(by_alpha && sum[3] > 1e-6 ? color[k] / sum[3] : sum[k]);
    }
    to[3] = (float)sum[3];
}

void masu_texel_halve(const float *from, uint32_t width, uint32_t height, bool by_alpha,
                      float *to) {
    uint32_t w = width > 1 ? width / 2 : 1, h = height > 1 ? height / 2 : 1;
    for (uint32_t y = 0; y < h; y++) {
        cover down = cover_of(y, height, h);
        for (uint32_t x = 0; x < w; x++) {
            cover across = cover_of(x, width, w);
            mean(from, width, &across, &down, by_alpha, to + 4 * ((size_t)y * w + x));
        }
    }
}

float masu_texel_rougher(float roughness, float mean_length) {
    double length = fmin(fmax((double)mean_length, 1e-3), 1), rough = (double)roughness;
    double alpha = rough * rough;
    return (float)fmin(pow(alpha * alpha + 2 * (1 - length) / length, 0.25), 1);
}

/* ---- blocks ---- */

static void gather(const uint8_t *rgba, uint32_t width, uint32_t height, uint32_t x, uint32_t y,
                   uint8_t block[64]) {
    for (uint32_t j = 0; j < 4; j++) {
        uint32_t row = y + j < height ? y + j : height - 1;
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t column = x + i < width ? x + i : width - 1;
            memcpy(block + 16 * j + 4 * i, rgba + 4 * ((size_t)row * width + column), 4);
        }
    }
}

/* The two ends of 5 or 6 bits whose mean (2 a + b) / 3 is closest to an 8-bit value. Among equal
 * results, the closest ends: decoders of low precision have the least error with them. */
typedef struct ends {
    uint8_t a, b;
    float value;
} ends;

static float expanded(uint32_t c, uint32_t bits) {
    return (float)(c << (8 - bits) | c >> (2 * bits - 8));
}

/* The closest to `wanted` that is not far from `other`. */
static ends find_ends(float wanted, float other, uint32_t bits) {
    ends best = {0, 0, 0};
    float least = 1e9f;
    for (uint32_t a = 0; a < 1u << bits; a++) {
        for (uint32_t b = 0; b < 1u << bits; b++) {
            float value = (2 * expanded(a, bits) + expanded(b, bits)) / 3;
            float error = fmaxf(fabsf(value - wanted), 1.35f * fabsf(value - other)) +
                          1e-4f * fabsf((float)a - (float)b);
            if (!(error < least)) continue;
            least = error;
            best = (ends){(uint8_t)a, (uint8_t)b, value};
        }
    }
    return best;
}

/* Red and blue; green; and green next to an equal red and blue, so that greys have no tint. */
static const ends *ends_of(int kind) {
    static ends tables[3][256];
    static bool filled;
    for (uint32_t v = 0; v < 256 && !filled; v++) {
        tables[0][v] = find_ends((float)v, (float)v, 5);
        tables[1][v] = find_ends((float)v, (float)v, 6);
        tables[2][v] = find_ends((float)v, tables[0][v].value, 6);
    }
    filled = true;
    return tables[kind];
}

/* A block of one colour. */
static void solid_block(const uint8_t rgb[3], unsigned char out[8]) {
    bool grey = rgb[0] == rgb[1] && rgb[1] == rgb[2];
    ends r = ends_of(0)[rgb[0]], g = ends_of(grey ? 2 : 1)[rgb[1]], b = ends_of(0)[rgb[2]];
    uint32_t first = (uint32_t)r.a << 11 | (uint32_t)g.a << 5 | b.a,
             second = (uint32_t)r.b << 11 | (uint32_t)g.b << 5 | b.b;
    /* The larger end is first: otherwise the block has no means of thirds. */
    uint32_t index = first == second ? 0 : first > second ? 2 : 3;
    uint32_t high = first > second ? first : second, low = first > second ? second : first;
    const unsigned char block[8] = {(unsigned char)high,         (unsigned char)(high >> 8),
                                    (unsigned char)low,          (unsigned char)(low >> 8),
                                    (unsigned char)(index * 85), (unsigned char)(index * 85),
                                    (unsigned char)(index * 85), (unsigned char)(index * 85)};
    memcpy(out, block, sizeof block);
}

static bool is_solid(const uint8_t texels[64]) {
    for (int i = 4; i < 64; i++) {
        if (i % 4 != 3 && texels[i] != texels[i % 4]) return false;
    }
    return true;
}

static void compress(uint32_t format, const uint8_t texels[64], unsigned char *out) {
    uint8_t part[32];
    switch (format) {
    case MASU_TEXTURE_BC1_SRGB:
        stb_compress_dxt_block(out, texels, 0, STB_DXT_HIGHQUAL);
        if (is_solid(texels)) solid_block(texels, out);
        break;
    case MASU_TEXTURE_BC3_SRGB:
        stb_compress_dxt_block(out, texels, 1, STB_DXT_HIGHQUAL);
        if (is_solid(texels)) solid_block(texels, out + 8);
        break;
    case MASU_TEXTURE_BC4:
        for (int i = 0; i < 16; i++) part[i] = texels[4 * i];
        stb_compress_bc4_block(out, part);
        break;
    default:
        for (int i = 0; i < 32; i++) part[i] = texels[4 * (i / 2) + i % 2];
        stb_compress_bc5_block(out, part);
        break;
    }
}

void masu_texel_alpha_block(const uint8_t alpha[16], unsigned char out[8]) {
    stb_compress_bc4_block(out, alpha);
}

size_t masu_texel_blocks(uint32_t format, const uint8_t *rgba, uint32_t width, uint32_t height,
                         unsigned char *out) {
    size_t bytes = 0;
    for (uint32_t y = 0; y < height; y += 4) {
        for (uint32_t x = 0; x < width; x += 4) {
            uint8_t block[64];
            gather(rgba, width, height, x, y, block);
            compress(format, block, out + bytes);
            bytes += masu_blob_block_bytes(format);
        }
    }
    return bytes;
}
