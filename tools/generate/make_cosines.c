/* make_cosines.c: fits linearly transformed cosines to the lobe of shaders/brdf/ggx.glsl. Prints a
 * C table, which is stored as cosines.inc because the fit takes half a minute:
 *
 *   cc -O2 -Ishaders tools/generate/make_cosines.c -lm -o make_cosines && ./make_cosines >
 *   cosines.inc
 *
 * The density g over directions is a clamped cosine whose directions are transformed by a linear
 * map (Heitz, Dupuy, Hill, Neubelt, SIGGRAPH 2016). In the plane of view and normal, Nelder and
 * Mead's simplex method fits the lobe's axis, its two widths and a shear, starting each node from
 * its neighbour. The error is
 *
 *   Int (f - g)^2 / (f + g),   f: the lobe over its albedo
 *
 * over samples of the visible normals and of g together, each weighted by the sum of both
 * densities.
 *
 * The table stores the inverse map, (a 0 b, 0 1 0, c 0 d). c and d decrease with alpha and are
 * stored as c / alpha and d / (2 alpha), so that neighbours differ little. shared/lookup_tables.h
 * describes the layout. */
#include "shared/lookup_tables.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { ROWS = MASU_TRANSFORM_ROWS, COLUMNS = MASU_TRANSFORM_COLUMNS, SIDE = 20, ALL = SIDE * SIDE };
enum { ALONG, ACROSS, SHEAR, ANGLE, NUMBERS }; /* parameters of a fit: two widths, a shear, the
                                                * axis */

typedef struct direction {
    double x, y, z;
} direction;

typedef struct lobe {
    double alpha, albedo;
    direction view, to[ALL];
    double value[ALL], density[ALL];
} lobe;

static double product(direction a, direction b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static direction unit(direction a) {
    double s = 1 / sqrt(product(a, a));
    return (direction){a.x * s, a.y * s, a.z * s};
}

/* Lobe times cosine, and the density of l if visible normals reflect the view. */
static double ggx(double alpha, direction v, direction l, double *density) {
    *density = 0;
    if (l.z <= 0) return 0;
    direction h = unit((direction){v.x + l.x, v.y + l.y, v.z + l.z});
    double a2 = alpha * alpha, k = alpha / (h.x * h.x + h.y * h.y + h.z * h.z * a2);
    double d = k * k / PI, of_v = sqrt(a2 + (1 - a2) * v.z * v.z);
    double of_l = sqrt(a2 + (1 - a2) * l.z * l.z);
    *density = d / (2 * (v.z + of_v));
    return d * 0.5 * l.z / (l.z * of_v + v.z * of_l);
}

static direction reflected(double alpha, direction v, double u1, double u2) {
    direction w = unit((direction){alpha * v.x, alpha * v.y, v.z});
    double turn = 2 * PI * u1, z = (1 - u2) * (1 + w.z) - w.z, flat = sqrt(fmax(0, 1 - z * z));
    direction h = unit((direction){alpha * (flat * cos(turn) + w.x),
                                   alpha * (flat * sin(turn) + w.y), fmax(z + w.z, 1e-9)});
    double d = 2 * product(v, h);
    return (direction){d * h.x - v.x, d * h.y - v.y, d * h.z - v.z};
}

static void make_lobe(lobe *b, double alpha, double cosine) {
    double sum = 0;
    b->alpha = alpha;
    b->view = (direction){-sqrt(1 - cosine * cosine), 0, cosine};
    for (int k = 0; k < ALL; k++) {
        b->to[k] = reflected(alpha, b->view, (k / SIDE + 0.5) / SIDE, (k % SIDE + 0.5) / SIDE);
        b->value[k] = ggx(alpha, b->view, b->to[k], &b->density[k]);
        if (b->density[k] > 0) sum += b->value[k] / b->density[k];
    }
    b->albedo = sum / ALL;
}

static double cosine_at(const double q[NUMBERS], direction l) {
    double c = cos(q[ANGLE]), s = sin(q[ANGLE]), z = s * l.x + c * l.z;
    double x = (c * l.x - s * l.z - q[SHEAR] * z) / q[ALONG], y = l.y / q[ACROSS];
    double square = x * x + y * y + z * z;
    return z > 0 ? z / (PI * q[ALONG] * q[ACROSS] * square * square) : 0;
}

static direction drawn(const double q[NUMBERS], double u1, double u2) {
    double radius = sqrt(u1), z = sqrt(1 - u1), c = cos(q[ANGLE]), s = sin(q[ANGLE]);
    double x = q[ALONG] * radius * cos(2 * PI * u2) + q[SHEAR] * z;
    return unit((direction){c * x + s * z, q[ACROSS] * radius * sin(2 * PI * u2), c * z - s * x});
}

static double difference(double f, double g) { return (f - g) * (f - g) / (f + g); }

static double error_of(const lobe *b, const double fit[NUMBERS]) {
    double q[NUMBERS] = {fmax(fabs(fit[0]), 1e-5), fmax(fabs(fit[1]), 1e-5), fit[2], fit[3]},
           sum = 0;
    for (int k = 0; k < ALL; k++) {
        double g = cosine_at(q, b->to[k]);
        if (b->density[k] > 0)
            sum += difference(b->value[k] / b->albedo, g) / (b->density[k] + g);
        direction l = drawn(q, (k / SIDE + 0.5) / SIDE, (k % SIDE + 0.5) / SIDE);
        double density, f = ggx(b->alpha, b->view, l, &density) / b->albedo;
        g = cosine_at(q, l);
        if (g > 0) sum += difference(f, g) / (density + g);
    }
    return sum / ALL;
}

static void between(const double a[NUMBERS], const double b[NUMBERS], double part,
                    double out[NUMBERS]) {
    for (int k = 0; k < NUMBERS; k++) out[k] = a[k] + part * (b[k] - a[k]);
}

static double improve(const lobe *b, double q[NUMBERS], double step, int steps) {
    double corner[NUMBERS + 1][NUMBERS], error[NUMBERS + 1];
    int best = 0;
    for (int i = 0; i <= NUMBERS; i++) {
        memcpy(corner[i], q, sizeof corner[i]);
        if (i)
            corner[i][i - 1] += i - 1 < SHEAR    ? step * fabs(q[i - 1])
                                : i - 1 == SHEAR ? step / 2
                                                 : step;
        error[i] = error_of(b, corner[i]);
    }
    for (int n = 0; n < steps; n++) {
        int worst = 0, second = best = 0;
        for (int i = 1; i <= NUMBERS; i++) {
            if (error[i] < error[best]) best = i;
            if (error[i] > error[worst]) worst = i;
        }
        second = best;
        double middle[NUMBERS] = {0}, there[NUMBERS], at[NUMBERS];
        for (int i = 0; i <= NUMBERS; i++) {
            if (i == worst) continue;
            if (error[i] > error[second]) second = i;
            for (int k = 0; k < NUMBERS; k++) middle[k] += corner[i][k] / NUMBERS;
        }
        between(corner[worst], middle, 2, there);
        double tried = error_of(b, there), more;
        if (tried < error[best]) {
            between(corner[worst], middle, 3, at);
            more = error_of(b, at);
            if (more < tried) memcpy(there, at, sizeof there), tried = more;
        }
        if (tried >= error[second]) {
            between(corner[worst], middle, 0.5, there);
            tried = error_of(b, there);
        }
        if (tried < error[worst]) {
            memcpy(corner[worst], there, sizeof there);
            error[worst] = tried;
            continue;
        }
        for (int i = 0; i <= NUMBERS; i++) {
            if (i == best) continue;
            between(corner[best], corner[i], 0.5, corner[i]);
            error[i] = error_of(b, corner[i]);
        }
    }
    for (int i = 0; i <= NUMBERS; i++) best = error[i] < error[best] ? i : best;
    memcpy(q, corner[best], sizeof corner[best]);
    q[ALONG] = fabs(q[ALONG]);
    q[ACROSS] = fabs(q[ACROSS]);
    return error[best];
}

static double cosine_of(int column) {
    double x = (double)column / (COLUMNS - 1);
    return fmax(1 - x * x, 1e-3);
}

static uint32_t packed(double low, double high) {
    int a = (int)lround(fmin(fmax(low, -1), 1) * 32767),
        b = (int)lround(fmin(fmax(high, -1), 1) * 32767);
    return ((uint32_t)a & 0xFFFFu) | (uint32_t)b << 16;
}

int main(void) {
    static lobe b;
    static uint32_t words[ROWS][COLUMNS][2];
    double worst = 0, mean = 0;
    for (int row = 0; row < ROWS; row++) {
        double roughness = MASU_TABLE_SMOOTHEST + (1 - MASU_TABLE_SMOOTHEST) * row / (ROWS - 1.0);
        double alpha = roughness * roughness, wide = alpha < 0.5 ? 2 * alpha : 0.8 + 0.4 * alpha;
        double q[NUMBERS] = {wide, wide, 0, 0};
        for (int column = 0; column < COLUMNS; column++) {
            make_lobe(&b, alpha, cosine_of(column));
            if (column)
                q[ANGLE] += (alpha < 0.3 ? 1 : 0.3) *
                            (acos(cosine_of(column)) - acos(cosine_of(column - 1)));
            improve(&b, q, alpha < 0.05 ? 0.06 : 0.15, 160);
            double error = improve(&b, q, 0.05, 160);
            if (!column) {
                q[ALONG] = q[ACROSS] = sqrt(q[ALONG] * q[ACROSS]);
                q[SHEAR] = q[ANGLE] = 0;
            }
            double ratio = q[ACROSS] / q[ALONG], c = cos(q[ANGLE]), s = sin(q[ANGLE]);
            words[row][column][0] = packed(ratio * (c - q[SHEAR] * s), -ratio * (s + q[SHEAR] * c));
            words[row][column][1] = packed(q[ACROSS] * s / alpha, q[ACROSS] * c / (2 * alpha));
            worst = fmax(worst, error);
            mean += error / (ROWS * COLUMNS);
        }
    }
    fprintf(stderr, "error: mean %.5f, largest %.5f\n", mean, worst);
    printf("/* cosines.inc: made by make_cosines.c. */\nstatic const uint32_t cosines[] = {\n");
    for (int i = 0; i < ROWS * COLUMNS * 2; i++)
        printf("0x%08x,%s", words[i / (2 * COLUMNS)][i / 2 % COLUMNS][i % 2],
               i % 8 == 7 ? "\n" : " ");
    printf("};\n");
    return fflush(stdout) || ferror(stdout) ? EXIT_FAILURE : EXIT_SUCCESS;
}
