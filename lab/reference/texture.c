/* texture.c: decodes the block-compressed textures of a blob and samples them. Formats: Khronos
 * Data Format Specification, chapters S3TC and RGTC. */
#include "lab/reference/texture.h"

#include <stdlib.h>
#include <string.h>

static void decode_color(const uint8_t *block, bool opaque, uint8_t out[64]) {
    uint32_t c0 = block[0] | (uint32_t)block[1] << 8, c1 = block[2] | (uint32_t)block[3] << 8;
    uint32_t bits =
        block[4] | (uint32_t)block[5] << 8 | (uint32_t)block[6] << 16 | (uint32_t)block[7] << 24;
    uint32_t ends[2] = {c0, c1};
    double palette[4][3];
    for (int e = 0; e < 2; e++) {
        palette[e][0] = (ends[e] >> 11 & 31) * (255.0 / 31);
        palette[e][1] = (ends[e] >> 5 & 63) * (255.0 / 63);
        palette[e][2] = (ends[e] & 31) * (255.0 / 31);
    }
    bool four = !opaque || c0 > c1; /* BC3 always has four colours */
    for (int k = 0; k < 3; k++) {
        double a = palette[0][k], b = palette[1][k];
        palette[2][k] = four ? (2 * a + b) / 3 : (a + b) / 2;
        palette[3][k] = four ? (a + 2 * b) / 3 : 0;
    }
    for (int i = 0; i < 16; i++) {
        for (int k = 0; k < 3; k++) out[4 * i + k] = (uint8_t)(palette[bits >> 2 * i & 3][k] + 0.5);
        out[4 * i + 3] = 255;
    }
}

static void decode_channel(const uint8_t *block, int channel, uint8_t out[64]) {
    uint64_t bits = 0;
    double palette[8] = {block[0], block[1], 0, 0, 0, 0, 0, 255};
    for (int i = 0; i < 6; i++) bits |= (uint64_t)block[2 + i] << 8 * i;
    int inner = block[0] > block[1] ? 7 : 5;
    for (int i = 1; i < inner; i++)
        palette[i + 1] = ((inner - i) * palette[0] + i * palette[1]) / inner;
    for (int i = 0; i < 16; i++) out[4 * i + channel] = (uint8_t)(palette[bits >> 3 * i & 7] + 0.5);
}

bool ref_texture_decode(const masu_blob_texture *t, const uint8_t *texels, uint32_t layer,
                        ref_texture *out) {
    uint32_t bytes = masu_blob_block_bytes(t->format), across = (t->width + 3) / 4;
    const uint8_t *from = texels + t->offset + masu_blob_texture_bytes(t) / t->layers * layer;
    *out = (ref_texture){t->width, t->height, malloc(4 * (size_t)t->width * t->height),
                         t->format == MASU_TEXTURE_BC1_SRGB || t->format == MASU_TEXTURE_BC3_SRGB};
    if (!out->rgba) return false;
    for (uint32_t by = 0; by < (t->height + 3) / 4; by++) {
        for (uint32_t bx = 0; bx < across; bx++) {
            const uint8_t *block = from + ((size_t)by * across + bx) * bytes;
            uint8_t texel[64] = {0};
            if (t->format == MASU_TEXTURE_BC1_SRGB) decode_color(block, true, texel);
            if (t->format == MASU_TEXTURE_BC3_SRGB) {
                decode_color(block + 8, false, texel);
                decode_channel(block, 3, texel);
            }
            if (t->format == MASU_TEXTURE_BC4 || t->format == MASU_TEXTURE_BC5)
                decode_channel(block, 0, texel);
            if (t->format == MASU_TEXTURE_BC5) decode_channel(block + 8, 1, texel);
            for (uint32_t i = 0; i < 16; i++) {
                uint32_t x = 4 * bx + i % 4, y = 4 * by + i / 4;
                if (x < t->width && y < t->height)
                    memcpy(out->rgba + 4 * ((size_t)y * t->width + x), texel + 4 * i, 4);
            }
        }
    }
    return true;
}

static uint32_t wrapped(double at, uint32_t size, uint32_t wrap) {
    double n = size, i = floor(at);
    wrap &= 3u;
    if (wrap == 1) return (uint32_t)ref_clamp(i, 0, n - 1);
    if (wrap == 2) {
        double m = i - 2 * n * floor(i / (2 * n));
        return (uint32_t)ref_clamp(m < n ? m : 2 * n - 1 - m, 0, n - 1);
    }
    return (uint32_t)ref_clamp(i - n * floor(i / n), 0, n - 1);
}

static double linear_of(uint8_t byte) {
    double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

void ref_texture_at(const ref_texture *t, double u, double v, const uint32_t wrap[2],
                    double out[4]) {
    double x = u * t->width - 0.5, y = v * t->height - 0.5;
    double px = x - floor(x), py = y - floor(y);
    if (wrap[0] & 4u) px = px < 0.5 ? 0 : 1, py = py < 0.5 ? 0 : 1; /* not interpolated */
    memset(out, 0, 4 * sizeof *out);
    for (int i = 0; i < 4; i++) {
        double weight = (i & 1 ? px : 1 - px) * (i & 2 ? py : 1 - py);
        uint32_t tx = wrapped(x + (i & 1), t->width, wrap[0]),
                 ty = wrapped(y + (i >> 1), t->height, wrap[1]);
        const uint8_t *texel = t->rgba + 4 * ((size_t)ty * t->width + tx);
        for (int k = 0; k < 4; k++)
            out[k] += weight * (t->srgb && k < 3 ? linear_of(texel[k]) : texel[k] / 255.0);
    }
}
