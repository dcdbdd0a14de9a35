/* ggx.c: see ggx.h. */
#include "lab/reference/ggx.h"

#include <pthread.h>
#include <string.h>

#define SMOOTHEST 0.045
enum { ROWS = 48, COLUMNS = 64, STEPS = 64 };

static bool cycles;
static pthread_once_t tables_once = PTHREAD_ONCE_INIT;
static ref_albedo table[ROWS][COLUMNS], average[ROWS];
static double line[ROWS][2];

void ref_ggx_use_cycles(bool on) { cycles = on; }
bool ref_ggx_is_cycles(void) { return cycles; }

double ref_schlick(double cosine) {
    double f = 1 - ref_clamp(cosine, 0, 1), f2 = f * f;
    return f2 * f2 * f;
}

/* Unpolarised Fresnel term of a dielectric of index 1.5, minus 0.04, over 0.96. */
static double dielectric(double cosine) {
    double c = ref_clamp(cosine, 0, 1), g = sqrt(1.25 + c * c), a = (g - c) / (g + c);
    double b = (c * (g + c) - 1) / (c * (g - c) + 1);
    return (0.5 * a * a * (1 + b * b) - 0.04) / 0.96;
}

/* From 0 at normal incidence to 1 at grazing incidence: interpolates from f0 to f90. */
static double steepness(double cosine) { return cycles ? dielectric(cosine) : ref_schlick(cosine); }

ref_vec ref_fresnel_at(const ref_fresnel *f, double cosine) {
    double s = steepness(cosine);
    return ref_add(ref_scale(f->f0, 1 - s), ref_splat(f->f90 * s));
}

double ref_ggx_lambda(double alpha, double cosine) {
    double c2 = cosine * cosine;
    if (!(c2 > 1e-300)) return HUGE_VAL;
    double root = sqrt(1 + alpha * alpha * fmax(1 - c2, 0) / c2);
    return 0.5 * ((cosine > 0 ? root : -root) - 1);
}

static double density(double alpha, ref_vec h) {
    double a2 = alpha * alpha, t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
    return h.z > 0 ? 1 / (REF_PI * a2 * t * t) : 0;
}

static double masking(double alpha, double v, double l) {
    double a = ref_ggx_lambda(alpha, v), b = ref_ggx_lambda(alpha, l);
    return cycles ? 1 / ((1 + a) * (1 + b)) : 1 / (1 + a + b);
}

double ref_ggx_lobe(double alpha, ref_vec v, ref_vec l) {
    if (!(v.z > 0) || !(l.z > 0)) return 0;
    ref_vec h = ref_unit(ref_add(v, l));
    return density(alpha, h) * masking(alpha, v.z, l.z) / (4 * v.z);
}

ref_vec ref_ggx_normal(double alpha, ref_vec v, double u1, double u2) {
    ref_vec w = ref_unit(ref_v(alpha * v.x, alpha * v.y, v.z));
    double z = (1 - u1) * (1 + w.z) - w.z, phi = 2 * REF_PI * u2;
    double r = sqrt(ref_clamp(1 - z * z, 0, 1));
    ref_vec h = ref_v(r * cos(phi) + w.x, r * sin(phi) + w.y, z + w.z);
    return ref_unit(ref_v(alpha * h.x, alpha * h.y, fmax(h.z, 0)));
}

/* Area of the facets visible from v, projected to v. */
static double projected(double alpha, double cosine) {
    return 0.5 * (cosine + sqrt(cosine * cosine + alpha * alpha * fmax(1 - cosine * cosine, 0)));
}

double ref_ggx_pdf(double alpha, ref_vec v, ref_vec l) {
    ref_vec h = ref_unit(ref_add(v, l));
    double area = projected(alpha, v.z);
    return area > 1e-12 && ref_dot(v, h) > 0 ? density(alpha, h) / (4 * area) : 0;
}

/* ---- Integrals ------------------------------------------------------------------------------- */

/* Integrates over visible normals at the midpoints of equal areas, in the layout of ref_ggx_normal;
 * radii shrink outwards, where the reflection passes the horizon and the integrand ends. */
ref_albedo ref_ggx_integrate(double roughness, double cosine, int steps) {
    double alpha = roughness * roughness, mu = fmax(cosine, 1e-6);
    ref_vec v = ref_v(sqrt(fmax(1 - mu * mu, 0)), 0, mu);
    double own = 1 + ref_ggx_lambda(alpha, mu);
    ref_albedo sum = {0, 0, 0, 0};
    for (int i = 0; i < steps; i++) {
        double x = (i + 0.5) / steps, u1 = x * x * (3 - 2 * x), wide = 6 * x * (1 - x);
        for (int k = 0; k < steps; k++) {
            ref_vec h = ref_ggx_normal(alpha, v, u1, 0.5 * (k + 0.5) / steps);
            double v_h = ref_dot(v, h), l_z = 2 * v_h * h.z - mu;
            if (!(l_z > 0) || !(v_h > 0)) continue;
            double share = own * masking(alpha, mu, l_z) * wide / ((double)steps * steps);
            double s = steepness(v_h), t = ref_schlick(fmin(mu, l_z));
            sum.white += share;
            sum.weight += share * s;
            sum.covered += share * t;
            sum.covered_weight += share * s * t;
        }
    }
    return sum;
}

static ref_albedo blend(ref_albedo a, ref_albedo b, double t) {
    return (ref_albedo){a.white + t * (b.white - a.white), a.weight + t * (b.weight - a.weight),
                        a.covered + t * (b.covered - a.covered),
                        a.covered_weight + t * (b.covered_weight - a.covered_weight)};
}

/* Columns are even steps of sqrt(mu): smooth lobes change at small mu. */
static double cosine_of(int column) {
    double root = column / (COLUMNS - 1.0);
    return root * root;
}

/* 2 Int f mu dmu of the interpolated row: exact for linear pieces over sqrt(mu), 4 Int f x^3 dx. */
static ref_albedo average_of(const ref_albedo *row) {
    ref_albedo sum = {0, 0, 0, 0};
    for (int i = 0; i + 1 < COLUMNS; i++) {
        double a = i / (COLUMNS - 1.0), b = (i + 1) / (COLUMNS - 1.0), d = b - a;
        double whole = pow(b, 4) - pow(a, 4), far = (0.8 * (pow(b, 5) - pow(a, 5)) - a * whole) / d;
        ref_albedo part = blend(row[i], row[i + 1], far / whole);
        sum.white += part.white * whole;
        sum.weight += part.weight * whole;
        sum.covered += part.covered * whole;
        sum.covered_weight += part.covered_weight * whole;
    }
    return sum;
}

/* Upper hull of the coat's albedo over s = (1 - mu)^5, at the average of s. */
static void fit_line(const ref_albedo *row, double out[2]) {
    const double middle = 1.0 / 21;
    double best = -1;
    for (int i = 0; i < COLUMNS; i++) {
        double xi = ref_schlick(cosine_of(i)), yi = 0.04 * row[i].white + 0.96 * row[i].weight;
        if (xi > middle) continue;
        for (int k = 0; k < COLUMNS; k++) {
            double xk = ref_schlick(cosine_of(k)), yk = 0.04 * row[k].white + 0.96 * row[k].weight;
            if (xk <= middle) continue;
            double slope = (yk - yi) / (xk - xi), at = yi + slope * (middle - xi);
            if (at <= best) continue;
            best = at;
            out[0] = yi - slope * xi;
            out[1] = slope;
        }
    }
    out[1] = fmin(out[1], 1 - out[0]);
}

static void make_tables(void) {
    for (int i = 0; i < ROWS; i++) {
        double roughness = SMOOTHEST + (1 - SMOOTHEST) * i / (ROWS - 1.0);
        for (int k = 0; k < COLUMNS; k++) {
            table[i][k] =
                ref_ggx_integrate(roughness, cosine_of(k), k < COLUMNS / 4 ? STEPS : STEPS / 2);
            /* Smooth lobes lose almost nothing: a negative loss would cancel the loss at grazing
             * angles in the average. */
            table[i][k].white = fmin(table[i][k].white, 1);
        }
        average[i] = average_of(table[i]);
        fit_line(table[i], line[i]);
    }
}

void ref_ggx_tables(void) { pthread_once(&tables_once, make_tables); }

static int row_of(double roughness, double *part) {
    double at = ref_clamp((roughness - SMOOTHEST) / (1 - SMOOTHEST), 0, 1) * (ROWS - 1);
    int low = at < ROWS - 2 ? (int)at : ROWS - 2;
    *part = at - low;
    return low;
}

ref_albedo ref_ggx_albedo(double roughness, double cosine) {
    double t, at = sqrt(ref_clamp(cosine, 0, 1)) * (COLUMNS - 1);
    int row = row_of(roughness, &t), column = at < COLUMNS - 2 ? (int)at : COLUMNS - 2;
    return blend(blend(table[row][column], table[row][column + 1], at - column),
                 blend(table[row + 1][column], table[row + 1][column + 1], at - column), t);
}

ref_albedo ref_ggx_average(double roughness) {
    double t;
    int row = row_of(roughness, &t);
    return blend(average[row], average[row + 1], t);
}

void ref_ggx_coat_line(double roughness, double *a, double *b) {
    double t;
    int row = row_of(roughness, &t);
    *a = line[row][0] + t * (line[row + 1][0] - line[row][0]);
    *b = line[row][1] + t * (line[row + 1][1] - line[row][1]);
}

/* ---- Random walk ----------------------------------------------------------------------------- */

/* Heights of facets are uniform over -1..1; masking does not depend on their distribution. */
static double share_below(double height) { return ref_clamp(0.5 * (height + 1), 0, 1); }

/* The height at which a ray along w from `height` hits a facet; false: it leaves. */
static bool next_height(double alpha, ref_vec w, double *height, double u) {
    if (w.z > 0.999999) return false;
    if (w.z < -0.999999) {
        *height = 2 * u * share_below(*height) - 1;
        return true;
    }
    if (fabs(w.z) < 1e-6) return true;
    double lambda = ref_ggx_lambda(alpha, w.z);
    if (w.z > 0 && u > 1 - pow(share_below(*height), lambda)) return false;
    *height = 2 * ref_clamp(share_below(*height) / pow(1 - u, 1 / lambda), 0, 1) - 1;
    return true;
}

enum { WALK_MOST = 200 };

ref_vec ref_walk_multiple(double alpha, const ref_fresnel *f, ref_vec v, ref_vec l, ref_random *r) {
    ref_vec w = ref_scale(v, -1), weight = ref_splat(1), sum = ref_splat(0);
    double height = 1, out = ref_ggx_lambda(alpha, l.z);
    if (!(l.z > 0) || !(v.z > 0)) return sum;
    for (int i = 0; i < WALK_MOST; i++) {
        double u = ref_draw(r);
        if (!next_height(alpha, w, &height, u)) break;
        ref_vec back = ref_scale(w, -1);
        if (i > 0) {
            ref_vec h = ref_unit(ref_add(back, l));
            double phase = ref_ggx_pdf(alpha, back, l), open = pow(share_below(height), out);
            sum = ref_add(
                sum, ref_scale(ref_mul(weight, ref_fresnel_at(f, ref_dot(back, h))), phase * open));
        }
        double u1 = ref_draw(r);
        double u2 = ref_draw(r);
        ref_vec n = ref_ggx_normal(alpha, back, u1, u2);
        double cosine = ref_dot(back, n);
        weight = ref_mul(weight, ref_fresnel_at(f, cosine));
        w = ref_reflect(back, n);
        if (!(ref_max(weight) > 1e-6)) break;
    }
    return sum;
}

bool ref_walk_sample(double alpha, const ref_fresnel *f, ref_vec v, ref_random *r, ref_vec *l,
                     ref_vec *weight) {
    ref_vec w = ref_scale(v, -1);
    double height = 1;
    *weight = ref_splat(1);
    for (int i = 0; i < WALK_MOST; i++) {
        double u = ref_draw(r);
        if (!next_height(alpha, w, &height, u)) {
            *l = w;
            return i > 0 && w.z > 0;
        }
        ref_vec back = ref_scale(w, -1);
        double u1 = ref_draw(r);
        double u2 = ref_draw(r);
        ref_vec n = ref_ggx_normal(alpha, back, u1, u2);
        *weight = ref_mul(*weight, ref_fresnel_at(f, ref_dot(back, n)));
        w = ref_reflect(back, n);
    }
    return false;
}
