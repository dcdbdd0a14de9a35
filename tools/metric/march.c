/* march.c: see march.h. */
#include "metric/march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TILE = 16 };
static const double error_cap = 4.0; /* pixels: a missed silhouette contributes at most this */

/* ---- Two classes ----------------------------------------------------------------------------- */

static double log_choose(double n, double k) {
    return lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1);
}

/* If errors were independent of the class, each of the n wrong pixels would be of class 0 with
 * probability `share`. Returns the probability of all outcomes that are at most as likely as the
 * observed one. */
static double binomial_two_sided(uint64_t n, uint64_t seen, double share) {
    if (!n || !(share > 0.0 && share < 1.0)) return 1.0;
    double a = log(share), b = log1p(-share), total = 0.0;
    double limit =
        log_choose((double)n, (double)seen) + (double)seen * a + (double)(n - seen) * b + 1e-9;
    for (uint64_t k = 0; k <= n; k++) {
        double log_p = log_choose((double)n, (double)k) + (double)k * a + (double)(n - k) * b;
        if (log_p <= limit) total += exp(log_p);
    }
    return total > 1.0 ? 1.0 : total;
}

void masu_class_test_finish(masu_class_test *t) {
    double n[2] = {(double)t->count[0], (double)t->count[1]};
    double w[2] = {(double)t->wrong[0], (double)t->wrong[1]};
    for (int c = 0; c < 2; c++) t->rate[c] = n[c] > 0 ? w[c] / n[c] : 0.0;
    t->z = t->chi2 = 0.0;
    t->p = 1.0;
    if (!(n[0] > 0 && n[1] > 0)) return;
    double pooled = (w[0] + w[1]) / (n[0] + n[1]);
    double spread = sqrt(pooled * (1 - pooled) * (1 / n[0] + 1 / n[1]));
    double apart = t->rate[0] - t->rate[1], half = 0.5 * (1 / n[0] + 1 / n[1]);
    double left = fabs(apart) > half ? fabs(apart) - half : 0.0;
    if (spread > 0) t->z = copysign(left / spread, apart);
    t->chi2 = t->z * t->z;
    t->p = binomial_two_sided(t->wrong[0] + t->wrong[1], t->wrong[0], n[0] / (n[0] + n[1]));
}

typedef struct moments {
    double n, sum, squares;
} moments;

static void welch(const moments m[2], masu_class_test *t) {
    double variance = 0.0;
    for (int c = 0; c < 2; c++) {
        t->error[c] = m[c].n > 0 ? m[c].sum / m[c].n : 0.0;
        if (m[c].n > 1) {
            double v = (m[c].squares - m[c].sum * t->error[c]) / (m[c].n - 1);
            variance += (v > 0 ? v : 0) / m[c].n;
        }
    }
    t->error_z = variance > 0 ? (t->error[0] - t->error[1]) / sqrt(variance) : 0.0;
}

/* ---- Errors ---------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static bool on_rim(uint32_t x, uint32_t y) {
    uint32_t u = x % TILE, v = y % TILE;
    return u == 0 || u == TILE - 1 || v == 0 || v == TILE - 1;
}

static void add_to(masu_class_test *t, moments m[2], int class, bool wrong, bool both,
                   double error) {
    t->count[class]++;
    t->wrong[class] += wrong;
    if (both) {
        double e = error < error_cap ? error : error_cap;
        m[class].n++;
        m[class].sum += e;
        m[class].squares += e * e;
    }
}

bool masu_march_errors_of(const masu_march_sample *samples, uint64_t count,
                          masu_march_errors *out) {
    memset(out, 0, sizeof *out);
    double *angles = malloc(2 * (count ? count : 1) * sizeof *angles), *depths = angles + count;
    if (!angles) return false;
    moments checker[2] = {{0}}, border[2] = {{0}};
    uint64_t mismatch = 0, off = 0;
    double depth = 0.0, angle = 0.0;
    for (uint64_t i = 0; i < count; i++) {
        const masu_march_sample *s = &samples[i];
        bool hit = s->t >= 0, truly = s->truth >= 0, both = hit && truly;
        double apart = both ? fabs(s->t - s->truth) : 0.0;
        bool far = both && apart > 0.01 * s->truth;
        double error = both && s->truth > 0 ? apart / (s->pixel * s->truth) : 0.0;
        mismatch += hit != truly;
        off += far;
        if (both) {
            depth += error;
            out->depth_max_px = fmax(out->depth_max_px, error);
            depths[out->hits] = error;
            angles[out->hits++] = s->normal_angle;
            angle += s->normal_angle;
        }
        bool wrong = hit != truly || far;
        add_to(&out->checker, checker, (int)((s->x + s->y) & 1), wrong, both, error);
        add_to(&out->border, border, on_rim(s->x, s->y) ? 0 : 1, wrong, both, error);
    }
    out->samples = count;
    if (count) out->hitmiss_pct = 100.0 * (double)mismatch / (double)count;
    if (out->hits) {
        double hits = (double)out->hits;
        qsort(angles, out->hits, sizeof *angles, compare);
        out->depth_off_pct = 100.0 * (double)off / hits;
        out->depth_mean_px = depth / hits;
        qsort(depths, out->hits, sizeof *depths, compare);
        out->depth_p99_px = depths[(size_t)(0.99 * (hits - 1) + 0.5)];
        out->normal_mean = angle / hits;
        out->normal_p99 = angles[(size_t)(0.99 * (hits - 1) + 0.5)];
        out->normal_max = angles[out->hits - 1];
    }
    free(angles);
    masu_class_test_finish(&out->checker);
    masu_class_test_finish(&out->border);
    welch(checker, &out->checker);
    welch(border, &out->border);
    return true;
}
