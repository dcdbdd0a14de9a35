/* brdf.c: see brdf.h. */
#include "brdf.h"

#include "shared/masu_shared.h"
#include "reference/vec.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static double unit_range(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }
static double alpha_of(double roughness) {
    double r = roughness > MASU_TABLE_SMOOTHEST ? roughness : MASU_TABLE_SMOOTHEST;
    return r * r;
}
static double power5(double cosine) {
    double x = 1 - unit_range(cosine);
    return x * x * (x * x) * x;
}

static double lambda(double alpha, double mu) {
    double tangent2 = (1 - mu * mu) / (mu * mu);
    return (sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}
static double masking(double alpha, double mu_v, double mu_l) {
    return 1 / (1 + lambda(alpha, mu_v) + lambda(alpha, mu_l));
}

/* ---- Integrals ------------------------------------------------------------------------------- */

typedef struct sample {
    double weight; /* the lobe, times N.l dl */
    double v_h, n_l;
} sample;

/* Half vectors distributed by D: D cosine dh is dt dphi / 2 pi with tan^2 = alpha^2 t / (1 - t).
 * The lobe times N.l dl is then G2 (v.h) / (N.v N.h). With t = 1 - (1 - u)^2 that remains finite
 * for N.h = 0. phi covers half a circle; the other half is symmetric. */
static sample sample_of(double alpha, double mu, int i, int k, int steps) {
    double u = (i + 0.5) / steps, phi = PI * (k + 0.5) / steps;
    double rest = (1 - u) * (1 - u), t = 1 - rest;
    double tangent2 = alpha * alpha * t / rest, cosine = 1 / sqrt(1 + tangent2);
    double sine = sqrt(tangent2) * cosine;
    sample s;
    s.v_h = sqrt(1 - mu * mu) * sine * cos(phi) + mu * cosine;
    s.n_l = 2 * s.v_h * cosine - mu;
    s.weight = 0;
    if (s.v_h > 0 && s.n_l > 0)
        s.weight = masking(alpha, mu, s.n_l) * s.v_h / (mu * cosine) * 2 * (1 - u) / steps / steps;
    return s;
}

void brdf_integrals(double roughness, double mu, int steps, double out[BRDF_INTEGRALS]) {
    double alpha = alpha_of(roughness);
    memset(out, 0, BRDF_INTEGRALS * sizeof *out);
    for (int i = 0; i < steps; i++) {
        for (int k = 0; k < steps; k++) {
            sample s = sample_of(alpha, mu, i, k, steps);
            if (s.weight == 0) continue;
            double f = power5(s.v_h), larger = power5(s.n_l < mu ? s.n_l : mu);
            out[BRDF_WHITE] += s.weight;
            out[BRDF_WEIGHT] += s.weight * f;
            out[BRDF_COVERED] += s.weight * larger;
            out[BRDF_COVERED_WEIGHT] += s.weight * f * larger;
        }
    }
}

/* ---- The table ------------------------------------------------------------------------------- */

static int row_at(double roughness) {
    double at = (roughness - MASU_TABLE_SMOOTHEST) / (1 - MASU_TABLE_SMOOTHEST);
    return (int)(unit_range(at) * (MASU_TABLE_ROWS - 1) + 0.5);
}

static void pair_at(const uint32_t *table, double roughness, double mu, double out[2]) {
    double at = sqrt(unit_range(mu)) * (MASU_TABLE_SIZE - 1);
    int left = at < MASU_TABLE_SIZE - 2 ? (int)at : MASU_TABLE_SIZE - 2;
    const uint32_t *node = table + row_at(roughness) * MASU_TABLE_SIZE + left;
    for (int k = 0; k < 2; k++) {
        double a = node[0] >> 16 * k & 0xFFFF, b = node[1] >> 16 * k & 0xFFFF;
        out[k] = (a + (b - a) * (at - left)) / 65535;
    }
}

void brdf_looked_up(const uint32_t *words, double roughness, double mu,
                    double out[BRDF_INTEGRALS]) {
    pair_at(words + MASU_TABLE_LOSS, roughness, mu, out);
    out[BRDF_WHITE] = 1 - out[BRDF_WHITE];
    pair_at(words + MASU_TABLE_COAT, roughness, mu, out + 2);
}

static double average_at(const uint32_t *words, int table, int count, int k, double roughness) {
    float f;
    memcpy(&f, &words[table + row_at(roughness) * count + k], sizeof f);
    return (double)f;
}

/* ---- The model ------------------------------------------------------------------------------- */

/* The part of a lobe that passes the coat, for Fresnel term 1 and for (1 - h.v)^5, and the coat's
 * reflection. */
typedef struct returned {
    double white, weight, coat, lost;
} returned;

typedef struct model {
    const uint32_t *words;
    const brdf_surface *s;
    double a, b;                    /* of the coat */
    double f0, f90, rest, rest_all; /* the dielectric's */
    double metal_f90;
    returned all;
} model;

static returned combine(const model *m, const double base[4], const double coat[4]) {
    double c = m->s->coat;
    returned r = {.white =
                      base[BRDF_WHITE] - c * (m->a * base[BRDF_WHITE] + m->b * base[BRDF_COVERED]),
                  .weight = base[BRDF_WEIGHT] -
                            c * (m->a * base[BRDF_WEIGHT] + m->b * base[BRDF_COVERED_WEIGHT]),
                  .coat = c * (0.04 * coat[BRDF_WHITE] + 0.96 * coat[BRDF_WEIGHT])};
    double lost = 1 - r.white - r.coat;
    r.lost = lost > 0 ? lost : 0;
    return r;
}

/* over: cosine with the coat's normal, which determines the coverage. */
static returned returned_over(const model *m, double mu, double over) {
    double base[4], covered[4], coat[4];
    brdf_looked_up(m->words, m->s->roughness, mu, base);
    brdf_looked_up(m->words, m->s->roughness, over, covered);
    brdf_looked_up(m->words, m->s->coat_roughness, over, coat);
    base[BRDF_COVERED] = covered[BRDF_COVERED];
    base[BRDF_COVERED_WEIGHT] = covered[BRDF_COVERED_WEIGHT];
    return combine(m, base, coat);
}

static returned returned_of(const model *m, double mu) { return returned_over(m, mu, mu); }

/* Interreflection between facets: F^2 (1.35 - 0.35 F) E / (1 - F (1 - E)), where F is Schlick's
 * average over the hemisphere. */
static double rest_color(double f0, double f90, double lost) {
    double f = f0 * 20 / 21 + f90 / 21;
    return f * f * (1.35 - 0.35 * f) * (1 - lost) / (1 - f * lost);
}

static double matte(const model *m, returned r) {
    return r.coat + m->f0 * r.white + (m->f90 - m->f0) * r.weight + m->rest * r.lost;
}

static model model_of(const uint32_t *words, const brdf_surface *s) {
    model m = {.words = words, .s = s};
    double most = fmax(s->albedo[0], fmax(s->albedo[1], s->albedo[2]));
    m.f0 = 0.08 * s->specular;
    m.f90 = unit_range(50 * m.f0);
    m.metal_f90 = unit_range(50 * most);
    m.a = average_at(words, MASU_TABLE_COAT_AVERAGE, 4, 2, s->coat_roughness);
    m.b = average_at(words, MASU_TABLE_COAT_AVERAGE, 4, 3, s->coat_roughness);
    double base[4] = {1 - average_at(words, MASU_TABLE_AVERAGE, 2, 0, s->roughness),
                      average_at(words, MASU_TABLE_AVERAGE, 2, 1, s->roughness),
                      average_at(words, MASU_TABLE_COAT_AVERAGE, 4, 0, s->roughness),
                      average_at(words, MASU_TABLE_COAT_AVERAGE, 4, 1, s->roughness)};
    double coat[4] = {1 - average_at(words, MASU_TABLE_AVERAGE, 2, 0, s->coat_roughness),
                      average_at(words, MASU_TABLE_AVERAGE, 2, 1, s->coat_roughness), 0, 0};
    m.all = combine(&m, base, coat);
    m.rest_all = 1 - base[BRDF_WHITE];
    m.rest = rest_color(m.f0, m.f90, m.rest_all);
    return m;
}

/* Factors of the light that the lobes lose from l, and of the remaining light, times pi. */
static void broad_factors(const model *m, returned v, int channel, double *rest, double *diffuse) {
    double albedo = m->s->albedo[channel], metallic = m->s->metallic;
    double color =
        (1 - metallic) * m->rest + metallic * rest_color(albedo, m->metal_f90, m->rest_all);
    *rest = color * v.lost / fmax(m->all.lost, 1e-6);
    *diffuse = albedo * (1 - metallic) * (1 - matte(m, v)) / fmax(1 - matte(m, m->all), 1e-6);
}

static double fresnel(const model *m, int channel, double v_h) {
    double metallic = m->s->metallic;
    double f0 = (1 - metallic) * m->f0 + metallic * m->s->albedo[channel];
    double f90 = (1 - metallic) * m->f90 + metallic * m->metal_f90;
    return f0 + (f90 - f0) * power5(v_h);
}

static double through(const model *m, double mu_v, double mu_l) {
    double t = 1 - m->s->coat * (m->a + m->b * power5(mu_v < mu_l ? mu_v : mu_l));
    return t > 0 ? t : 0;
}

static double lobe(double alpha, double n_h, double mu_v, double mu_l) {
    double a2 = alpha * alpha, q = 1 + (a2 - 1) * n_h * n_h;
    return a2 / (PI * q * q) * masking(alpha, mu_v, mu_l) / (4 * mu_v * mu_l);
}

void brdf_over(const uint32_t *words, const brdf_surface *s, const double n[3], const double v[3],
               const double l[3], double out[3]) {
    model m = model_of(words, s);
    double mu_v = v[2] > 1e-4 ? v[2] : 1e-4, mu_l = unit_range(l[2]);
    double over_v = dot3(n, v) > 1e-4 ? dot3(n, v) : 1e-4, over_l = unit_range(dot3(n, l));
    double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]}, size = sqrt(dot3(h, h));
    out[0] = out[1] = out[2] = 0;
    if (!(mu_l > 0) && !(over_l > 0)) return;
    /* v.h of unit vectors. fp32 vectors are unit up to 1e-7, which matters if v + l is as short. */
    double v_h = size / 2, n_h = h[2] / size;
    returned from = returned_over(&m, mu_v, over_v), to = returned_over(&m, mu_l, over_l);
    for (int k = 0; k < 3; k++) {
        double rest, diffuse;
        broad_factors(&m, from, k, &rest, &diffuse);
        double f = mu_l > 0 ? lobe(alpha_of(s->roughness), n_h, mu_v, mu_l) * fresnel(&m, k, v_h) *
                                  through(&m, over_v, over_l)
                            : 0;
        double coat = over_l > 0 ? s->coat * (0.04 + 0.96 * power5(v_h)) *
                                       lobe(alpha_of(s->coat_roughness),
                                            unit_range(dot3(n, h) / size), over_v, over_l)
                                 : 0;
        f += (rest * to.lost + diffuse * (1 - matte(&m, to))) / PI;
        out[k] = (f * mu_l + coat * over_l) * PI;
    }
}

void brdf_eval(const uint32_t *words, const brdf_surface *s, const double v[3], const double l[3],
               double out[3]) {
    brdf_over(words, s, (const double[]){0, 0, 1}, v, l, out);
}

void brdf_ambient(const uint32_t *words, const brdf_surface *s, const double n[3],
                  const double v[3], double diffuse[3], double specular[3], double *coat) {
    model m = model_of(words, s);
    returned from = returned_over(&m, fmax(v[2], 1e-4), fmax(dot3(n, v), 1e-4));
    for (int k = 0; k < 3; k++) {
        double rest, below, f0 = fresnel(&m, k, 1), f90 = fresnel(&m, k, 0);
        broad_factors(&m, from, k, &rest, &below);
        diffuse[k] = rest * fmax(m.all.lost, 1e-6) + below * fmax(1 - matte(&m, m.all), 1e-6);
        specular[k] = f0 * from.white + (f90 - f0) * from.weight;
    }
    *coat = from.coat;
}

void brdf_furnace(const uint32_t *words, const brdf_surface *s, double mu, int steps,
                  double out[3]) {
    model m = model_of(words, s);
    returned from = returned_of(&m, mu);
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < steps; i++) {
        for (int k = 0; k < steps; k++) {
            sample base = sample_of(alpha_of(s->roughness), mu, i, k, steps);
            sample coat = {0, 0, 0};
            if (s->coat > 0) coat = sample_of(alpha_of(s->coat_roughness), mu, i, k, steps);
            for (int c = 0; c < 3 && base.weight > 0; c++)
                out[c] += base.weight * fresnel(&m, c, base.v_h) * through(&m, mu, base.n_l);
            for (int c = 0; c < 3; c++)
                out[c] += s->coat * coat.weight * (0.04 + 0.96 * power5(coat.v_h));
        }
    }
    /* The rest depends only on N.l. In x = mu^(1/4), because it can change within mu = 0.001: 2 mu
     * dmu is 8 x^7 dx. */
    const int rings = 1024;
    for (int i = 0; i < rings; i++) {
        double x = (i + 0.5) / rings;
        double x3 = x * x * x;
        returned to = returned_of(&m, x3 * x);
        for (int c = 0; c < 3; c++) {
            double rest, diffuse;
            broad_factors(&m, from, c, &rest, &diffuse);
            out[c] += (rest * to.lost + diffuse * (1 - matte(&m, to))) * 8 * x3 * x3 * x / rings;
        }
    }
}
