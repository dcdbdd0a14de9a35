/* brdf.c: see brdf.h. */
#include "meso/brdf.h"

#define PI MASU_BAKE_PI

static double clamp01(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

static double fresnel(double cosine) {
    double f = clamp01(1 - cosine), f2 = f * f;
    return MASU_MESO_F0 + (1 - MASU_MESO_F0) * f2 * f2 * f;
}

/* 2 G2 / (4 NoL NoV), height-correlated, halved. */
static double visibility(double n_l, double n_v, double a2) {
    double g = n_l * sqrt(a2 + (1 - a2) * n_v * n_v) + n_v * sqrt(a2 + (1 - a2) * n_l * n_l);
    return 0.5 / fmax(g, 1e-6);
}

masu_meso_lobes masu_meso_brdf(masu_meso_vec3 n, masu_meso_vec3 v, masu_meso_vec3 l,
                               double roughness) {
    double n_l = masu_bake_dot(n, l), n_v = fmax(masu_bake_dot(n, v), 1e-4);
    masu_meso_lobes lobes = {0, 0};
    if (!(n_l > 0)) return lobes;
    masu_meso_vec3 h = masu_bake_v3(l.x + v.x, l.y + v.y, l.z + v.z);
    if (!masu_bake_normalize(&h)) h = n;
    double alpha = fmax(roughness, 0.045), n_h = clamp01(masu_bake_dot(n, h));
    alpha *= alpha;
    double a2 = alpha * alpha, d = n_h * n_h * (a2 - 1) + 1;
    double f = fresnel(masu_bake_dot(v, h));
    lobes.diffuse = 1 - f;
    lobes.specular = f * a2 / (d * d) * visibility(n_l, n_v, a2);
    return lobes;
}

/* Samples half vectors by D (Walter et al., EGSR 2007, equations 35 and 36), with weight 4 V NoL
 * (v.h) / NoH times Fresnel. */
static double integrate(double n_v, double roughness) {
    enum { RINGS = 24, SPOKES = 24 };
    double alpha = fmax(roughness * roughness, 0.002), a2 = alpha * alpha, sum = 0;
    masu_meso_vec3 v = masu_bake_v3(sqrt(1 - n_v * n_v), n_v, 0);
    for (int i = 0; i < RINGS; i++) {
        double u = (i + 0.5) / RINGS, cosine = sqrt((1 - u) / (1 + (a2 - 1) * u));
        double sine = sqrt(1 - cosine * cosine);
        for (int j = 0; j < SPOKES; j++) {
            double turn = 2 * PI * (j + 0.5) / SPOKES;
            masu_meso_vec3 h = masu_bake_v3(sine * cos(turn), cosine, sine * sin(turn));
            double v_h = masu_bake_dot(v, h), n_l = 2 * v_h * h.y - v.y;
            if (!(n_l > 0 && v_h > 0)) continue;
            sum += fresnel(v_h) * 4 * visibility(n_l, n_v, a2) * n_l * v_h / h.y;
        }
    }
    return sum / (RINGS * SPOKES);
}

void masu_meso_sky_table_make(masu_meso_sky_table *table) {
    for (int i = 0; i < 33; i++) {
        for (int j = 0; j < 33; j++) {
            table->share[i][j] = (float)integrate(fmax(i / 32.0, 1e-3), j / 32.0);
        }
    }
}

double masu_meso_sky_share(const masu_meso_sky_table *table, double n_v, double roughness) {
    double x = clamp01(n_v) * 32, y = clamp01(roughness) * 32;
    int i = x < 31 ? (int)x : 31, j = y < 31 ? (int)y : 31;
    double u = x - i, v = y - j;
    return (1 - u) * ((1 - v) * (double)table->share[i][j] + v * (double)table->share[i][j + 1]) +
           u * ((1 - v) * (double)table->share[i + 1][j] + v * (double)table->share[i + 1][j + 1]);
}
