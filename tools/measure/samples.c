/* samples.c: see samples.h. */
#include "measure/samples.h"

#include <math.h>
#include <stdlib.h>

void masu_samples_add(masu_samples *s, double wall, double gpu, uint32_t frames) {
    if (s->count == MASU_SAMPLES_MAX) return;
    s->wall[s->count] = wall / frames;
    s->gpu[s->count++] = gpu / frames;
    s->plausible += gpu >= 0.5 * wall && gpu <= 1.05 * wall;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double masu_samples_at(const double *sorted, uint32_t n, double share) {
    return sorted[(uint32_t)(share * (double)(n - 1) + 0.5)];
}

void masu_samples_sort(masu_samples *s) {
    qsort(s->wall, s->count, sizeof *s->wall, by_value);
    qsort(s->gpu, s->count, sizeof *s->gpu, by_value);
}

double masu_samples_ratio(const double *base, const double *own, uint32_t n) {
    static double ratios[MASU_SAMPLES_MAX];
    for (uint32_t k = 0; k < n; k++) {
        if (!(base[k] > 0.0)) return (double)NAN;
        ratios[k] = own[k] / base[k];
    }
    qsort(ratios, n, sizeof *ratios, by_value);
    return n ? masu_samples_at(ratios, n, 0.5) : (double)NAN;
}
