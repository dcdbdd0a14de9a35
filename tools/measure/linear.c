/* linear.c: see linear.h. */
#include "measure/linear.h"

#include "measure/texel.h"

#include <math.h>
#include <string.h>

bool masu_linear_read(const masu_renderer *m, uint32_t slot, VkExtent2D size, float *rgb) {
    masu_readback_image image;
    if (masu_readback(m, slot, MASU_READBACK_HDR, &image, NULL)) return false;
    if (image.width != size.width || image.height != size.height) return false;
    for (uint32_t y = 0; y < image.height; y++) {
        const uint8_t *row = (const uint8_t *)image.pixels + (size_t)y * image.row_bytes;
        for (uint32_t x = 0; x < image.width; x++) {
            uint16_t texel[4];
            memcpy(texel, row + 8 * (size_t)x, sizeof texel);
            for (int c = 0; c < 3; c++) {
                float value = masu_texel_half(texel[c]);
                /* the same limits as the tone curve */
                if (!isfinite(value)) value = value > 0.0f ? 65504.0f : 0.0f;
                *rgb++ = value;
            }
        }
    }
    return true;
}

bool masu_linear_is_metered(const masu_session *s) {
    return masu_session_resolved(&s->desc).exposure.metered == MASU_ON;
}

double masu_linear_exposure(masu_session *s, uint32_t slot, const masu_light *light) {
    masu_stats_info stats;
    masu_light own;
    if (masu_linear_is_metered(s) && !masu_stats(s->m, slot, &stats, NULL) && stats.exposure > 0.0f)
        return (double)stats.exposure;
    if (!light && !masu_light_of(s->m, &own, NULL)) light = &own;
    return light && light->exposure > 0.0f ? (double)light->exposure : 1.0;
}

/* The ACES fit of Narkowicz: shaders/shared/tone.glsl. */
static double filmic(double x) {
    return fmin(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1.0);
}

/* Khronos PBR Neutral, limited to white. */
static void neutral(double x[3]) {
    const double least = fmin(x[0], fmin(x[1], x[2])), start = 0.76, room = 1.0 - start;
    const double offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
    for (int c = 0; c < 3; c++) x[c] = fmax(x[c] - offset, 0.0);
    const double peak = fmax(x[0], fmax(x[1], x[2]));
    if (peak < start) return;
    const double bent = 1.0 - room * room / (peak + room - start),
                 gray = 1.0 - 1.0 / (0.15 * (peak - bent) + 1.0);
    for (int c = 0; c < 3; c++) x[c] = (1.0 - gray) * x[c] * bent / peak + gray * bent;
}

void masu_linear_show(const masu_session *s, const float *rgb, size_t pixels, double exposure,
                      float *shown) {
    const masu_tone tone = masu_session_resolved(&s->desc).tone;
    for (size_t p = 0; p < pixels; p++) {
        double x[3];
        for (size_t c = 0; c < 3; c++) {
            const double value = (double)rgb[3 * p + c] * exposure;
            x[c] = value > 0.0 ? fmin(value, 1e4) : 0.0;
        }
        if (tone == MASU_TONE_NEUTRAL) neutral(x);
        for (size_t c = 0; c < 3; c++)
            shown[3 * p + c] = (float)(tone == MASU_TONE_ACES ? filmic(x[c]) : fmin(x[c], 1.0));
    }
}

void masu_srgb_encode(const float *shown, size_t pixels, uint8_t *rgba) {
    for (size_t p = 0; p < pixels; p++) {
        for (size_t c = 0; c < 3; c++) rgba[4 * p + c] = masu_srgb_encoded(shown[3 * p + c]);
        rgba[4 * p + 3] = 255;
    }
}

float masu_srgb_decoded(uint8_t encoded) {
    double v = (double)encoded / 255.0;
    return (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
}

uint8_t masu_srgb_encoded(float linear) {
    double v = linear > 0.0f ? fmin((double)linear, 1.0) : 0.0;
    v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
    return (uint8_t)(255.0 * v + 0.5);
}
