/* image.c: see image.h. */
#include "metric/image.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

enum { RADIUS = 5, TAPS = 2 * RADIUS + 1 };

double masu_metric_rmse(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height) {
    size_t n = (size_t)width * height;
    uint64_t sum = 0; /* exact: 3 * 65025 per pixel */
    for (size_t i = 0; i < n; i++) {
        for (size_t c = 0; c < 3; c++) {
            int d = a[4 * i + c] - b[4 * i + c];
            sum += (uint64_t)(d * d);
        }
    }
    return n ? sqrt((double)sum / (3.0 * (double)n)) / 255.0 : 0.0;
}

double masu_metric_difference(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height) {
    const size_t pixels = (size_t)width * height;
    uint64_t sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        for (size_t k = 0; k < 3; k++) sum += (uint64_t)abs(a[4 * i + k] - b[4 * i + k]);
    }
    return (double)sum / (3.0 * (double)pixels);
}

double masu_metric_psnr(double rmse) { return rmse > 0.0 ? -20.0 * log10(rmse) : HUGE_VAL; }

/* ---- SSIM ------------------------------------------------------------------------------------ */

static double luma(const uint8_t *rgba) {
    return 0.2126 * rgba[0] + 0.7152 * rgba[1] + 0.0722 * rgba[2];
}

static uint32_t clamped(int64_t at, uint32_t size) {
    return at < 0 ? 0 : at >= (int64_t)size ? size - 1 : (uint32_t)at;
}

/* The window is separable: rows first into five planes of weighted sums, then columns. */
enum { SUM_A, SUM_B, SUM_AA, SUM_BB, SUM_AB, SUMS };

static void filter_row(const uint8_t *a, const uint8_t *b, uint32_t width, const double *weight,
                       double *out) {
    for (uint32_t x = 0; x < width; x++) {
        double sum[SUMS] = {0};
        for (int k = 0; k < TAPS; k++) {
            size_t at = 4 * (size_t)clamped((int64_t)x + k - RADIUS, width);
            double u = luma(a + at), v = luma(b + at), w = weight[k];
            sum[SUM_A] += w * u;
            sum[SUM_B] += w * v;
            sum[SUM_AA] += w * u * u;
            sum[SUM_BB] += w * v * v;
            sum[SUM_AB] += w * u * v;
        }
        for (int s = 0; s < SUMS; s++) out[SUMS * (size_t)x + (size_t)s] = sum[s];
    }
}

static double similarity(const double sum[SUMS]) {
    const double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
    double a = sum[SUM_A], b = sum[SUM_B];
    double va = sum[SUM_AA] - a * a, vb = sum[SUM_BB] - b * b, vab = sum[SUM_AB] - a * b;
    return (2 * a * b + c1) * (2 * vab + c2) / ((a * a + b * b + c1) * (va + vb + c2));
}

double masu_metric_ssim(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height) {
    double weight[TAPS], total = 0.0;
    for (int k = 0; k < TAPS; k++) {
        weight[k] = exp(-(double)((k - RADIUS) * (k - RADIUS)) / (2 * 1.5 * 1.5));
        total += weight[k];
    }
    for (int k = 0; k < TAPS; k++) weight[k] /= total;
    size_t row = (size_t)width * SUMS;
    double *planes = malloc(row * height * sizeof *planes);
    if (!planes) return nan("");
    for (uint32_t y = 0; y < height; y++) {
        size_t at = 4 * (size_t)y * width;
        filter_row(a + at, b + at, width, weight, planes + y * row);
    }
    uint32_t edge_x = width >= TAPS ? RADIUS : 0, edge_y = height >= TAPS ? RADIUS : 0;
    double mean = 0.0;
    for (uint32_t y = edge_y; y < height - edge_y; y++) {
        for (uint32_t x = edge_x; x < width - edge_x; x++) {
            double sum[SUMS] = {0};
            for (int k = 0; k < TAPS; k++) {
                const double *from =
                    planes + clamped((int64_t)y + k - RADIUS, height) * row + SUMS * (size_t)x;
                for (int s = 0; s < SUMS; s++) sum[s] += weight[k] * from[s];
            }
            mean += similarity(sum);
        }
    }
    free(planes);
    return mean / ((double)(width - 2 * edge_x) * (double)(height - 2 * edge_y));
}

/* ---- Linear light ---------------------------------------------------------------------------- */

masu_relative_error masu_metric_relative(const float *reference, const float *test,
                                         uint32_t pixels) {
    masu_relative_error e = {0};
    double squares = 0.0, sum = 0.0, relative = 0.0;
    uint64_t count = 0;
    for (size_t i = 0; i < pixels; i++) {
        double d[3], t[3];
        for (size_t c = 0; c < 3; c++) {
            t[c] = (double)reference[3 * i + c];
            d[c] = (double)test[3 * i + c] - t[c];
        }
        if (!isfinite(d[0] + d[1] + d[2])) {
            e.left_out++;
            continue;
        }
        count += 3;
        for (int c = 0; c < 3; c++) {
            squares += d[c] * d[c];
            sum += t[c];
            relative += d[c] * d[c] / (t[c] * t[c] + 0.01);
        }
    }
    if (!count) return e;
    e.rmse = squares > 0.0 ? sqrt(squares * (double)count) / fabs(sum) : 0.0;
    e.relmse = relative / (double)count;
    return e;
}
