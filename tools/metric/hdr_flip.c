/* hdr_flip.c: see hdr_flip.h. Its images exist during a call. */
#include "metric/hdr_flip.h"

#include <math.h>
#include <stdlib.h>

static const double shown_at = 0.85;

/* (a x + b) x / ((c x + d) x + e), for x times 0.6. */
static const double a = 2.51 * 0.36, b = 0.03 * 0.6, c = 2.43 * 0.36, d = 0.59 * 0.6, e = 0.14;

double masu_hdr_flip_tone(double x) {
    x = fmin(x, 1e30);
    double shown = (a * x + b) * x / ((c * x + d) * x + e);
    return shown > 1.0 ? 1.0 : shown;
}

/* The input for which the curve returns 0.85: the positive root of a quadratic. */
static double seen_at_shown(void) {
    double p = a - shown_at * c, q = b - shown_at * d, r = -shown_at * e;
    return (-q + sqrt(q * q - 4.0 * p * r)) / (2.0 * p);
}

static double light(float value) { return value > 0.0f ? (double)value : 0.0; }

static int by_value(const void *x, const void *y) {
    double u = *(const double *)x, v = *(const double *)y;
    return (u > v) - (u < v);
}

bool masu_hdr_flip_exposures(const float *rgb, uint32_t pixels, masu_exposures *out) {
    double *luminance = malloc(pixels * sizeof *luminance);
    *out = (masu_exposures){0.0, 0.0, 2};
    if (!luminance || !pixels) {
        free(luminance);
        return false;
    }
    for (uint32_t i = 0; i < pixels; i++) {
        luminance[i] = 0.2126 * light(rgb[3 * i]) + 0.7152 * light(rgb[3 * i + 1]) +
                       0.0722 * light(rgb[3 * i + 2]);
    }
    qsort(luminance, pixels, sizeof *luminance, by_value);
    double most = fmin(luminance[pixels - 1], 1e30);
    double median = 0.5 * (luminance[(pixels - 1) / 2] + luminance[pixels / 2]);
    free(luminance);
    if (!(most > 0.0)) return true; /* black at any exposure */
    median = fmin(fmax(median, most * exp2(-MASU_HDR_FLIP_STOPS_MAX)), most);
    out->first = log2(seen_at_shown() / most);
    out->last = log2(seen_at_shown() / median);
    double stops = ceil(out->last - out->first);
    out->count = stops < 2.0 ? 2 : (uint32_t)fmin(stops, MASU_HDR_FLIP_STOPS_MAX);
    return true;
}

static void expose(const float *rgb, size_t values, double stop, double *out) {
    double scale = exp2(stop);
    for (size_t i = 0; i < values; i++) out[i] = masu_hdr_flip_tone(scale * light(rgb[i]));
}

bool masu_metric_hdr_flip(const float *reference, const float *test, uint32_t width,
                          uint32_t height, double ppd, float *map, masu_flip *out) {
    size_t n = (size_t)width * height;
    masu_exposures range;
    double *shown = malloc(8 * n * sizeof *shown);
    bool good = shown && masu_hdr_flip_exposures(reference, (uint32_t)n, &range);
    double *other = shown + 3 * n, *errors = other + 3 * n, *worst = errors + n;
    for (size_t i = 0; i < n && good; i++) worst[i] = 0.0;
    for (uint32_t k = 0; good && k < range.count; k++) {
        double stop = range.first + (range.last - range.first) * k / (range.count - 1);
        expose(reference, 3 * n, stop, shown);
        expose(test, 3 * n, stop, other);
        good = masu_metric_flip_linear(shown, other, width, height, ppd, errors);
        for (size_t i = 0; i < n && good; i++) worst[i] = fmax(worst[i], errors[i]);
    }
    if (good) masu_flip_summarise(worst, n, map, out);
    free(shown);
    return good;
}
