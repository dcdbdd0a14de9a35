/* make_split_sum.c: generates the tables of the specular lobe, as a C header on stdout. Runs during
 * the build.
 *
 * The lobe is GGX with height-correlated Smith masking (Heitz, JCGT 3-2, 2014) and alpha =
 * roughness^2; its Fresnel term is f0 + (f90 - f0) s with Schlick's s = (1 - h.v)^5. For a
 * direction v and a roughness the tables hold integrals over all l, including N.l:
 *
 *   loss = 1 - Int lobe          B  = Int lobe s            (the split sum: E = f0 (1 - loss) +
 *   (f90 - f0) B)
 *   X    = Int lobe t            XB = Int lobe s t          t = max((1 - N.v)^5, (1 - N.l)^5)
 *
 * and their averages 2 Int mu dmu. X and XB are the parts of the lobe that a clear coat above it
 * transmits (shaders/brdf/bsdf.glsl). masu_shared.h describes the layout.
 *
 * Values are 16-bit integers, not halves: the absolute error of sums that must be 1 matters, and no
 * driver flushes small integers to 0. The averages are computed from the rounded values with the
 * shader's interpolation, so that differences of looked-up values cancel exactly.
 *
 * The shader uses the nearest row, which saves half of the reads: the G-buffer has only 256
 * roughnesses, too.
 *
 * The fit of make_cosines.c follows the tables; it is too slow for the build.
 *
 * Nodes have equal steps of sqrt(N.v). A lobe of alpha 0.002 loses most at N.v = 0.001, which is
 * the second node; equal steps of N.v would miss it. */
#include "shared/masu_shared.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generate/cosines.inc"

#define PI 3.14159265358979323846

enum { N = MASU_TABLE_SIZE, ROWS = MASU_TABLE_ROWS, RADII = 64, ANGLES = 48, KINDS = 4 };
enum { LOSS, WEIGHT, COAT, COAT_WEIGHT };

static uint32_t texels[KINDS][ROWS][N]; /* 0..65535 */
static double averages[KINDS][ROWS];
static double line[ROWS][2];

static double schlick(double cosine) {
    double f = 1 - fmin(fmax(cosine, 0), 1);
    return f * f * f * f * f;
}

/* Smith's Lambda of GGX. */
static double lambda(double alpha, double cosine) {
    double c2 = cosine * cosine;
    return 0.5 * (sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
}

/* Integrates over the normals visible from v (Heitz, JCGT 7-4, 2018): the lobe times N.l is G2 / G1
 * times their density. Uses that paper's disc in polar coordinates; one half is enough, the other
 * is its mirror image. */
static void integrate(double mu, double alpha, double out[KINDS]) {
    double v[3] = {sqrt(fmax(1 - mu * mu, 0)), 0, mu};
    double w[3] = {alpha * v[0], 0, mu}, length = sqrt(w[0] * w[0] + w[2] * w[2]);
    double own = lambda(alpha, mu), stretch = 0.5 * (1 + w[2] / length);
    w[0] /= length;
    w[2] /= length;
    memset(out, 0, KINDS * sizeof *out);
    for (int i = 0; i < RADII; i++) {
        for (int k = 0; k < ANGLES; k++) {
            /* Midpoints, with areas that shrink outwards, where l passes the horizon and the
             * integrand ends abruptly. */
            double outer = 1 - (i + 0.5) / RADII, area = 2 * outer;
            double radius = sqrt(1 - outer * outer), angle = PI * ((k + 0.5) / ANGLES - 0.5);
            /* t1 across v, t2 along it; the half t1 > 0 */
            double t1 = radius * cos(angle), t2 = radius * sin(angle);
            t2 = (1 - stretch) * sqrt(1 - t1 * t1) + stretch * t2;
            double t3 = sqrt(fmax(1 - t1 * t1 - t2 * t2, 0));
            double h[3] = {-w[2] * t2 + w[0] * t3, t1, w[0] * t2 + w[2] * t3};
            h[0] *= alpha;
            h[1] *= alpha;
            h[2] = fmax(h[2], 0);
            double size = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
            double v_h = (v[0] * h[0] + v[2] * h[2]) / size;
            double n_l = 2 * v_h * h[2] / size - mu;
            if (n_l <= 0) continue;
            double part = (1 + own) / (1 + own + lambda(alpha, n_l)) * area / (RADII * ANGLES);
            double s = schlick(v_h), t = schlick(fmin(mu, n_l));
            out[LOSS] += part;
            out[WEIGHT] += part * s;
            out[COAT] += part * t;
            out[COAT_WEIGHT] += part * s * t;
        }
    }
    out[LOSS] = 1 - out[LOSS];
}

/* 2 Int f mu dmu of a row that is interpolated over x = sqrt(mu): 4 Int f x^3 dx. */
static double average(const uint32_t *row) {
    double sum = 0;
    for (int i = 0; i + 1 < N; i++) {
        double x0 = (double)i / (N - 1), x1 = (double)(i + 1) / (N - 1);
        double f0 = row[i] / 65535.0, slope = (row[i + 1] / 65535.0 - f0) / (x1 - x0);
        double cubic = pow(x1, 4) - pow(x0, 4), quartic = 0.8 * (pow(x1, 5) - pow(x0, 5));
        sum += (f0 - slope * x0) * cubic + slope * quartic;
    }
    return sum;
}

/* Finds the line a + b (1 - mu)^5 that is nowhere below the albedo of a coat of this roughness (f0
 * 0.04), nowhere above 1, and closest to the albedo on average. (It is a little higher, so that
 * rounding does not reverse the order.) Over (1 - mu)^5, whose average is 1/21, this is the edge of
 * the upper hull at 1/21. */
static int fit_coat(int row) {
    const double middle = 1.0 / 21;
    double x[N], y[N], best = -1;
    for (int i = 0; i < N; i++) {
        double root = (double)i / (N - 1);
        x[i] = schlick(root * root);
        y[i] =
            0.04 * (1 - texels[LOSS][row][i] / 65535.0) + 0.96 * texels[WEIGHT][row][i] / 65535.0;
    }
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < N; k++) {
            if (x[i] > middle || x[k] <= middle) continue;
            double slope = (y[k] - y[i]) / (x[k] - x[i]), at = y[i] + slope * (middle - x[i]);
            if (at <= best) continue;
            best = at;
            line[row][0] = y[i] - slope * x[i];
            line[row][1] = slope;
        }
    }
    line[row][0] += 2e-4;
    double over = line[row][0] + line[row][1] - 1;
    if (over > 0) line[row][1] -= over;
    return line[row][0] >= 0 && line[row][1] >= 0 && over < 1e-3;
}

static uint32_t bits_of(double v) {
    float f = (float)v;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

static uint32_t words[MASU_TABLE_WORDS_ALL];

int main(void) {
    for (int row = 0; row < ROWS; row++) {
        double roughness =
            MASU_TABLE_SMOOTHEST + (1 - MASU_TABLE_SMOOTHEST) * row / (double)(ROWS - 1);
        for (int i = 0; i < N; i++) {
            double root = (double)i / (N - 1), v[KINDS];
            integrate(fmax(root * root, 1e-6), roughness * roughness, v);
            for (int k = 0; k < KINDS; k++) {
                texels[k][row][i] = (uint32_t)(fmin(fmax(v[k], 0), 1) * 65535 + 0.5);
            }
        }
        for (int k = 0; k < KINDS; k++) averages[k][row] = average(texels[k][row]);
        if (!fit_coat(row)) {
            fprintf(stderr, "make_split_sum: row %d: no line for the coat: %g + %g s\n", row,
                    line[row][0], line[row][1]);
            return EXIT_FAILURE;
        }
    }
    for (int row = 0; row < ROWS; row++) {
        for (int i = 0; i < N; i++) {
            int at = row * N + i;
            words[MASU_TABLE_LOSS + at] = texels[LOSS][row][i] | texels[WEIGHT][row][i] << 16;
            words[MASU_TABLE_COAT + at] = texels[COAT][row][i] | texels[COAT_WEIGHT][row][i] << 16;
        }
        uint32_t *two = &words[MASU_TABLE_AVERAGE + 2 * row];
        uint32_t *four = &words[MASU_TABLE_COAT_AVERAGE + 4 * row];
        two[0] = bits_of(averages[LOSS][row]);
        two[1] = bits_of(averages[WEIGHT][row]);
        four[0] = bits_of(averages[COAT][row]);
        four[1] = bits_of(averages[COAT_WEIGHT][row]);
        four[2] = bits_of(line[row][0]);
        four[3] = bits_of(line[row][1]);
    }
    memcpy(&words[MASU_TABLE_TRANSFORM], cosines, sizeof cosines);
    printf("/* Made by tools/generate/make_split_sum.c. */\nstatic const uint32_t masu_split_sum[] "
           "= {\n");
    for (int i = 0; i < MASU_TABLE_WORDS_ALL; i++) {
        printf("0x%08x,%s", words[i], i % 8 == 7 ? "\n" : " ");
    }
    printf("};\n");
    return fflush(stdout) || ferror(stdout) ? EXIT_FAILURE : EXIT_SUCCESS;
}
