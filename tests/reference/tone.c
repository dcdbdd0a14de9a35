/* tone.c: see tone.h. */
#include "tone.h"

#include <math.h>

static double clamp(double x, double low, double high) {
    return x > low ? (x < high ? x : high) : low; /* NaN: low */
}

/* Khronos PBR Neutral: offset, compression of the largest channel, desaturation. */
static void neutral(double most, const double in[3], double out[3]) {
    double x = fmin(in[0], fmin(in[1], in[2]));
    double offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
    double start = (0.8 - 0.04) * most, d = most - start;
    for (int c = 0; c < 3; c++) out[c] = in[c] - offset;
    double peak = fmax(out[0], fmax(out[1], out[2]));
    if (peak < start) return;
    double bent = most - d * d / (peak + d - start), g = 1 - 1 / (0.15 * (peak - bent) + 1);
    for (int c = 0; c < 3; c++) out[c] = (1 - g) * out[c] * bent / peak + g * bent;
}

void masu_ref_tone(int curve, double most, const double in[3], double out[3]) {
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = clamp(in[c], 0, 1e4);
    if (curve == MASU_REF_TONE_NEUTRAL) {
        neutral(most, x, out);
        return;
    }
    for (int c = 0; c < 3; c++) {
        double filmic = x[c] * (2.51 * x[c] + 0.03) / (x[c] * (2.43 * x[c] + 0.59) + 0.14);
        out[c] = curve == MASU_REF_TONE_ACES ? clamp(filmic, 0, 1) : x[c];
    }
}

double masu_ref_srgb_encode(double x) {
    x = clamp(x, 0, 1);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

double masu_ref_srgb_decode(double x) {
    return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

#define M1 (2610.0 / 16384)
#define M2 (2523.0 / 4096 * 128)
#define C1 (3424.0 / 4096)
#define C2 (2413.0 / 4096 * 32)
#define C3 (2392.0 / 4096 * 32)

double masu_ref_pq_encode(double nits) {
    double y = pow(clamp(nits / 10000, 0, 1), M1);
    return pow((C1 + C2 * y) / (1 + C3 * y), M2);
}

double masu_ref_pq_decode(double code) {
    double y = pow(clamp(code, 0, 1), 1 / M2);
    return 10000 * pow(fmax(y - C1, 0) / (C2 - C3 * y), 1 / M1);
}

void masu_ref_bt2020(const double in[3], double out[3]) {
    static const double m[3][3] = {
        {0.6274, 0.3293, 0.0433}, {0.0691, 0.9195, 0.0114}, {0.0164, 0.0880, 0.8956}};
    for (int r = 0; r < 3; r++) out[r] = m[r][0] * in[0] + m[r][1] * in[1] + m[r][2] * in[2];
}

uint32_t masu_ref_meter(const double *rgb, size_t count, size_t stride, double low, double high,
                        double *mean) {
    uint32_t bins[256] = {0}, all = 0;
    for (size_t i = 0; i < count; i++, rgb += stride) {
        double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        if (!isfinite(y) || !(y >= 0x1p-16)) continue;
        int exponent;
        double mantissa = frexp(y, &exponent); /* 0.5..1 */
        int bin = 8 * (exponent - 1 + 16) + (int)(8 * (2 * mantissa - 1));
        bins[bin < 255 ? bin : 255]++;
        all++;
    }
    double from = low * all, to = (1 - high) * all, below = 0, weight = 0, sum = 0;
    for (int k = 0; k < 256; k++) {
        double inside = fmax(fmin(below + bins[k], to) - fmax(below, from), 0);
        below += bins[k];
        weight += inside;
        sum += inside * (-16 + k / 8 + log2(1 + (k % 8 + 0.5) / 8));
    }
    *mean = weight > 0 ? sum / weight : 0;
    return all;
}

uint32_t masu_ref_dither(double v, uint32_t steps, uint32_t x, uint32_t y, uint32_t frame,
                         uint32_t channel) {
    uint32_t noise =
        x * 0xC13FA9A9u + y * 0x91E10DA5u + frame * 0x9E3779B9u + channel * 0x55555555u;
    double scaled = v * steps, near = floor(scaled + 0.5);
    double step = fabs(scaled - near) < 1e-3 ? near : floor(scaled + (noise >> 8) / 16777216.0);
    return step < steps ? (uint32_t)step : steps;
}
