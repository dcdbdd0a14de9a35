/* sky_mirror.c: see sky_mirror.h. */
#include "support/sky_mirror.h"

#include <math.h>

#define PI 3.14159265358979323846

static double lerp(double a, double b, double t) { return a + (b - a) * t; }

static double clamped(double v, double lo, double hi) { return fmin(fmax(v, lo), hi); }

static void lobe_bands(double r, double bands[2]) {
    static const double fit[2][4] = {{-0.0815037, 2.8173808, -4.0033292, 1.6007921},
                                     {0.0255910, 6.6842436, -10.3014656, 4.3416570}};
    for (int b = 0; b < 2; b++) {
        double lost = fit[b][0] + r * (fit[b][1] + r * (fit[b][2] + r * fit[b][3]));
        bands[b] = clamped(1 - r * r * lost, 0, 1);
    }
}

static void sky_terms(const struct masu_sky_uniforms *sky, double y, double x, double out[3][3]) {
    double t = y < 0 ? -sqrt(-y) : sqrt(y), half = MASU_SKY_ROWS / 2 - 0.5;
    double at = clamped(half * (1 + t), 0, MASU_SKY_ROWS - 1);
    int row = (int)fmin(at, MASU_SKY_ROWS - 2);
    const masu_vec4 *rows = &sky->rows[row * MASU_SKY_ROW];
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++) {
            double v[2];
            for (int j = 0; j < 2; j++) {
                const masu_vec4 *e = rows + j * MASU_SKY_ROW + 3 * k;
                v[j] = (double)e[0][c] + x * ((double)e[1][c] + x * (double)e[2][c]);
            }
            out[k][c] = exp2(lerp(v[0], v[1], at - row));
        }
    }
}

static void sky_rough(const struct masu_sky_uniforms *sky, double y, double x, double out[3]) {
    double u = (y + 1) * (MASU_SKY_ROUGH_ROWS - 1) / 2,
           v = sqrt(fmax(0.5 - 0.5 * x, 0)) * (MASU_SKY_ROUGH_AZIMUTHS - 1);
    int row = (int)fmin(u, MASU_SKY_ROUGH_ROWS - 2),
        column = (int)fmin(v, MASU_SKY_ROUGH_AZIMUTHS - 2);
    const masu_vec4 *a = &sky->rough[row * MASU_SKY_ROUGH_AZIMUTHS + column],
                    *b = a + MASU_SKY_ROUGH_AZIMUTHS;
    for (int c = 0; c < 3; c++)
        out[c] = lerp(lerp((double)a[0][c], (double)a[1][c], v - column),
                      lerp((double)b[0][c], (double)b[1][c], v - column), u - row);
}

void sky_mirror(const masu_sky *sky, const double d[3], double roughness, double out[3]) {
    const masu_sky_irradiance *s = &sky->irradiance;
    const struct masu_sky_uniforms *u = &sky->uniforms;
    const double w2 = (double)MASU_SKY_ROUND * (double)MASU_SKY_ROUND;
    double bands[2], flat = sqrt(d[0] * d[0] + d[2] * d[2]), cosine = 0, c = 0;
    lobe_bands(roughness, bands);
    for (int k = 0; k < 3; k++) {
        cosine += d[k] * (double)u->sun[k];
        c += d[k] * (double)s->direction[k];
    }
    double x = (d[0] * (double)u->azimuth[0] + d[2] * (double)u->azimuth[1]) / fmax(flat, 1e-9);
    double air = 1 / (4 * PI) * (1 + bands[1] * (0.75 * cosine * cosine - 0.25));
    double g = (double)u->sun[3] * bands[0];
    double haze = (1 - g * g) / (4 * PI * pow(1 + g * g - 2 * g * cosine, 1.5));
    double width = sqrt((1 - bands[1]) * (1 - 0.9 * d[1] * d[1])) * 0.45;
    double rough[3], tabled = clamped(10 * roughness - 3, 0, 1);
    double t = clamped((roughness - 0.15) / 0.7, 0, 1), blend = t * t * (3 - 2 * t);
    double terms[3][3][3];
    sky_rough(u, d[1], x, rough);
    for (int i = 0; i < 3; i++) sky_terms(u, clamped(d[1] + (i - 1) * width, -1, 1), x, terms[i]);
    for (int k = 0; k < 3; k++) {
        double blurred = 0, glow = (double)s->glow[k], sh[9];
        for (int i = 0; i < 3; i++)
            blurred += (terms[i][0][k] + air * terms[i][1][k] + haze * terms[i][2][k]) / 3;
        blurred = lerp(blurred, rough[k], tabled);
        for (int i = 0; i < 9; i++) sh[i] = (double)s->sh[i][k];
        double zero = sh[0] + glow * (0.25 + w2 / 12);
        double one = sh[1] * d[0] + sh[2] * d[1] + sh[3] * d[2] + glow * 0.5 * c;
        double two = sh[4] * d[0] * d[1] + sh[5] * d[1] * d[2] + sh[6] * d[2] * d[0] +
                     sh[7] * (3 * d[1] * d[1] - 1) + sh[8] * (d[0] * d[0] - d[2] * d[2]) +
                     glow * (5.0 / 16 - 5 * w2 / 24 + w2 * w2 / 16) * (1.5 * c * c - 0.5);
        double even = fmax(zero + 1.5 * bands[0] * one + 4 * bands[1] * two, 0);
        out[k] = lerp(blurred, even, blend);
    }
}
