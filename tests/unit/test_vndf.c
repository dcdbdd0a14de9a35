/* test_vndf.c: shaders/brdf/vndf.glsl, compiled as C: directions have the frequencies of the
 * density (chi squared), the density integrates to 1, weights are the lobe divided by it and at
 * most 1, and their mean is the table's albedo. tests/gpu/test_vndf.c then compares the shader on
 * devices with this compiled C. */
#include "reference/brdf.h"
#include "split_sum.h"
#include "support/floats.h"
#include "support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "reference/glsl.h"
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#include "brdf/vndf.glsl"
#include "noise/sequence.glsl"
#pragma GCC diagnostic pop
#undef uint
#undef sqrt
#undef sin
#undef cos

#define PI 3.14159265358979323846

/* 0.0451 is the smoothest lobe that is not a mirror. */
static const float roughnesses[] = {0.0451f, 0.15f, 0.35f, 0.6f, 1};
static const double angles[] = {0, 30, 60, 80, 88, 89.7};
enum { ROUGHNESSES = 5, ANGLES = 6, CASES = ROUGHNESSES * ANGLES };

static vec3 view_at(double degrees) {
    double a = degrees * PI / 180;
    return vec3(sin(a) * 0.6, sin(a) * 0.8, cos(a));
}

static double unit(uint64_t *seed) { return (double)(support_random(seed) >> 40) / 16777216; }

static vec2 unit2(uint64_t *seed) { return vec2(unit(seed), unit(seed)); }

/* ---- The unbounded cap of Dupuy and Benyoub, in double precision, for comparison ------------ */

typedef struct drawn {
    double l[3], weight;
} drawn;

static drawn uncut(vec3 view, double a, vec2 u) {
    double v[3] = {(double)view.x, (double)view.y, (double)view.z};
    double w[3] = {a * v[0], a * v[1], v[2]}, size = 0, phi = 2 * PI * (double)u.x;
    size = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    double z = (1 - (double)u.y) * (1 + w[2] / size) - w[2] / size;
    double s = sqrt(fmax(1 - z * z, 0));
    double h[3] = {a * (s * cos(phi) + w[0] / size), a * (s * sin(phi) + w[1] / size),
                   z + w[2] / size};
    size = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
    double v_h = (v[0] * h[0] + v[1] * h[1] + v[2] * h[2]) / size;
    drawn d;
    for (int k = 0; k < 3; k++) d.l[k] = 2 * v_h * h[k] / size - v[k];
    double n_l = d.l[2], root_v = sqrt(a * a + (1 - a * a) * v[2] * v[2]);
    double root_l = sqrt(a * a + (1 - a * a) * n_l * n_l);
    d.weight = n_l > 0 ? n_l * (v[2] + root_v) / (n_l * root_v + v[2] * root_l) : 0;
    return d;
}

/* ---- Chi squared ----------------------------------------------------------------------------- */

/* Bins over half vectors: TURNS of the angle; RADII of q, where 1 - (1 - q)^2 is the part of D(h)
 * h.z within this slope. The square removes the singularity of the density there: v.h / h.z. */
enum { RADII = 16, TURNS = 16, BINS = RADII * TURNS, PARTS = 600, DRAWS = 200000 };

static int bin_of(vec3 v, const double l[3], double alpha) {
    double h[3] = {(double)v.x + l[0], (double)v.y + l[1], (double)v.z + l[2]};
    double t = (h[0] * h[0] + h[1] * h[1]) / (alpha * alpha * h[2] * h[2]);
    double turn = atan2(h[1], h[0]) / (2 * PI) + 0.5;
    int r = (int)((1 - sqrt(1 / (1 + t))) * RADII), a = (int)(turn * TURNS);
    return (r < RADII ? r : RADII - 1) * TURNS + (a < TURNS ? a : TURNS - 1);
}

/* The probability of each bin by the density; returns their sum. */
static double expected(vec3 v, float roughness, double share[BINS]) {
    float alpha = masu_alpha(roughness);
    double all = 0, a2 = (double)alpha * (double)alpha;
    for (int b = 0; b < BINS; b++) {
        double sum = 0;
        for (uint32_t i = 0; i < PARTS; i++) {
            /* No grid: the horizon, at which the density ends, could coincide with its lines. */
            vec2 u = masu_noise2(0x80008000u, i);
            double q = (b / TURNS + (double)u.x) / RADII, r = 1 - (1 - q) * (1 - q);
            double phi = (2 * (b % TURNS + (double)u.y) / TURNS - 1) * PI;
            double t2 = a2 * r / (1 - r), c = 1 / sqrt(1 + t2), s = sqrt(t2) * c;
            double h[3] = {s * cos(phi), s * sin(phi), c};
            double v_h = (double)v.x * h[0] + (double)v.y * h[1] + (double)v.z * h[2];
            if (v_h <= 0) continue;
            vec3 l = vec3(2 * v_h * h[0] - (double)v.x, 2 * v_h * h[1] - (double)v.y,
                          2 * v_h * h[2] - (double)v.z);
            /* dl = 4 v.h dh; dh = d(cos) dphi */
            double area = 0.5 * c * c * c * a2 / ((1 - r) * (1 - r)) * 2 * (1 - q) * 2 * PI;
            sum += (double)masu_vndf_pdf(v, l, alpha) * 4 * v_h * area;
        }
        share[b] = sum / PARTS / BINS;
        all += share[b];
    }
    return all;
}

typedef struct verdict {
    double p, below;
} verdict;

/* p of Pearson's test, by Wilson and Hilferty's cube root. Bins with less than 25 draws are
 * merged. */
static verdict chi_squared(vec3 v, float roughness, int cut, const double share[BINS], double all) {
    static double count[BINS + 1];
    float alpha = masu_alpha(roughness);
    uint64_t seed = 1234;
    int draws = cut ? DRAWS : DRAWS / 4; /* errors show sooner */
    memset(count, 0, sizeof count);
    for (int i = 0; i < draws; i++) {
        drawn d;
        vec2 u = unit2(&seed);
        if (cut) {
            masu_vndf_ray r = masu_vndf_reflect(v, alpha, u);
            d = (drawn){{(double)r.l.x, (double)r.l.y, (double)r.l.z}, 0};
        } else {
            d = uncut(v, (double)alpha, u);
        }
        count[d.l[2] > 0 ? bin_of(v, d.l, (double)alpha) : BINS]++;
    }
    double sum = 0, few = 0, few_share = 0;
    int free = -1;
    for (int b = 0; b <= BINS; b++) {
        double e = draws * (b < BINS ? share[b] : 1 - all);
        if (e < 25) {
            few += count[b];
            few_share += e;
            continue;
        }
        sum += (count[b] - e) * (count[b] - e) / e;
        free++;
    }
    if (few_share >= 5) {
        sum += (few - few_share) * (few - few_share) / few_share;
        free++;
    }
    if (free < 1) return (verdict){few > 60 ? 0 : 1, count[BINS] / draws};
    double k = free, z = (cbrt(sum / k) - (1 - 2 / (9 * k))) / sqrt(2 / (9 * k));
    return (verdict){0.5 * erfc(z / sqrt(2)), count[BINS] / draws};
}

/* 30 cases and one bound of 1e-4 for each: a correct sampler would fail with one seed of 300, and
 * the seed is fixed. Samples from the unbounded cap must fail if the bound cuts anything. */
static void directions_come_as_often_as_the_density_says(void **state) {
    (void)state;
    static double share[BINS];
    int caught = 0;
    print_message("  p of chi squared, 256 bins, %d draws; integral of the density;\n"
                  "  below the surface, and of the uncut cap\n",
                  DRAWS);
    for (int i = 0; i < CASES; i++) {
        float roughness = roughnesses[i / ANGLES];
        vec3 v = view_at(angles[i % ANGLES]);
        double all = expected(v, roughness, share);
        verdict own = chi_squared(v, roughness, 1, share, all);
        verdict other = chi_squared(v, roughness, 0, share, all);
        print_message("  %.4f %5.1f degrees: p %.4f  integral %.5f  below %.4f, uncut %.4f\n",
                      (double)roughness, angles[i % ANGLES], own.p, all, own.below, other.below);
        assert_true(own.p > 1e-4);
        assert_true(all < 1.002 && fabs(all + own.below - 1) < 0.004);
        if (other.p < 1e-9) caught++;
    }
    print_message("  the unbounded cap is distinguished from the density in %d of %d cases\n",
                  caught, CASES);
    assert_true(caught >= 12);
}

/* ---- Weights --------------------------------------------------------------------------------- */

/* Lobe times N.l with a Fresnel term of 1, in double precision: Smith's Lambda and the cosine form
 * of D, the formulas of tests/reference/brdf.c and not of ggx.glsl. */
static double lobe(double alpha, vec3 view, const double l[3]) {
    double v[3] = {(double)view.x, (double)view.y, (double)view.z}, h[3], size = 0;
    for (int k = 0; k < 3; k++) h[k] = v[k] + l[k], size += h[k] * h[k];
    double c2 = h[2] * h[2] / size, a2 = alpha * alpha, q = 1 - c2 + a2 * c2;
    double d = a2 / (PI * q * q);
    double own = 0.5 * (sqrt(1 + a2 * (1 - v[2] * v[2]) / (v[2] * v[2])) - 1);
    double far = 0.5 * (sqrt(1 + a2 * (1 - l[2] * l[2]) / (l[2] * l[2])) - 1);
    return d / (1 + own + far) / (4 * v[2]);
}

static void weights_are_the_lobe_over_the_density(void **state) {
    (void)state;
    uint64_t seed = 8;
    double worst = 0, most = 0;
    int seen = 0;
    for (int i = 0; i < 300000; i++) {
        float roughness = (float)(0.1 + 0.9 * unit(&seed)), alpha = masu_alpha(roughness);
        double z = unit(&seed);
        vec3 v = view_at(acos(fmax(z * z, 1e-3)) * 180 / PI);
        masu_vndf_ray r = masu_vndf_reflect(v, alpha, unit2(&seed));
        most = worst_of(most, (double)r.weight);
        if (!(r.l.z > 1e-3f)) continue;
        double l[3] = {(double)r.l.x, (double)r.l.y, (double)r.l.z};
        worst =
            worst_of(worst, fabs((double)r.weight * (double)r.pdf / lobe((double)alpha, v, l) - 1));
        seen++;
    }
    print_message("  weight * pdf equals the lobe within a relative %.1e, "
                  "%d directions; most %.6f\n", worst,
                  seen, most);
    assert_true(seen > 250000 && worst < 2e-3);
    assert_true(most <= 1);
}

/* The bound must not cut directions that reflect above the surface, and must not raise a weight. */
static void the_bound_only_helps(void **state) {
    (void)state;
    print_message("  variance of the weight, cut and uncut; mean\n");
    for (int i = 0; i < CASES; i++) {
        float alpha = masu_alpha(roughnesses[i / ANGLES]);
        vec3 v = view_at(angles[i % ANGLES]);
        double sum[2] = {0}, square[2] = {0}, most = 0;
        enum { MANY = 65536 };
        for (uint32_t n = 0; n < MANY; n++) {
            vec2 u = masu_noise2(0, n);
            double w[2] = {(double)masu_vndf_reflect(v, alpha, u).weight,
                           uncut(v, (double)alpha, u).weight};
            most = worst_of(most, w[0]);
            for (int k = 0; k < 2; k++) sum[k] += w[k] / MANY, square[k] += w[k] * w[k] / MANY;
        }
        double var[2] = {square[0] - sum[0] * sum[0], square[1] - sum[1] * sum[1]};
        print_message("  %.4f %5.1f degrees: %.5f %.5f  mean %.4f %.4f\n",
                      (double)roughnesses[i / ANGLES], angles[i % ANGLES], fmax(var[0], 0),
                      fmax(var[1], 0), sum[0], sum[1]);
        assert_true(most <= 1);
        assert_true(var[0] <= var[1] + 1e-4); /* seven draws of the 65536 */
        if (i / ANGLES >= 2 && i % ANGLES >= 2) assert_true(var[0] < var[1]);
        assert_true(fabs(sum[0] - sum[1]) < 1e-3);
    }
}

/* White light from everywhere, with a Fresnel term of 1: the mean weight is the table's 1 - loss;
 * and with Schlick's term as a weight, its other number. */
static void a_white_furnace_returns_the_table(void **state) {
    (void)state;
    static const double from[] = {0, 25, 45, 60, 72, 80, 85, 88, 89.3};
    double worst[2] = {0}, at[2][2] = {{0}}, mirror = 0, mirror_steep = 0;
    for (int r = 0; r <= 24; r++) {
        double roughness = r / 24.0;
        for (size_t a = 0; a < sizeof from / sizeof *from; a++) {
            vec3 v = view_at(from[a]);
            float alpha = masu_alpha((float)roughness);
            double table[BRDF_INTEGRALS], sum[2] = {0};
            brdf_looked_up(masu_split_sum, roughness, (double)v.z, table);
            enum { MANY = 16384 };
            for (uint32_t n = 0; n < MANY; n++) {
                masu_vndf_ray ray = masu_vndf_reflect(v, alpha, masu_noise2(0, n));
                double v_h = 0.5 * sqrt(2 + 2 * (double)dot(v, ray.l)), f = 1 - fmin(v_h, 1);
                sum[0] += (double)ray.weight / MANY;
                sum[1] += (double)ray.weight / MANY * f * f * f * f * f;
            }
            for (int k = 0; k < 2; k++) {
                double off = fabs(sum[k] - table[k]);
                if (!(alpha > masu_mirror_alpha)) {
                    mirror = worst_of(mirror, off);
                    if (from[a] <= 80) mirror_steep = worst_of(mirror_steep, off);
                    continue;
                }
                if (off <= worst[k]) continue;
                worst[k] = off;
                at[k][0] = roughness;
                at[k][1] = from[a];
            }
        }
    }
    print_message(
        "  white: error %.5f at most (roughness %.3f, %.1f degrees); Schlick's weight by "
        "%.5f (%.3f, %.1f); mirrors by %.5f, up to 80 "
        "degrees by %.5f\n",
        worst[0], at[0][0], at[0][1], worst[1], at[1][0], at[1][1], mirror, mirror_steep);
    assert_true(worst[0] < 0.005 && worst[1] < 0.0075 && mirror < 0.02 && mirror_steep < 0.001);
}

/* ---- Totality, frames ------------------------------------------------------------------------ */

static void any_bits_give_a_direction(void **state) {
    (void)state;
    static const float odd[] = {0,    -0.0f, 1,     -1,     1e-4f,    -1e-4f,    0.5f, 1e-38f,
                                1e30, -1e30, 1e38f, -1e-8f, INFINITY, -INFINITY, NAN,  2};
    enum { N = sizeof odd / sizeof *odd };
    uint64_t seed = 8;
    for (int i = 0; i < 300000; i++) {
        float x[6];
        for (int k = 0; k < 6; k++) x[k] = odd[support_random(&seed) % N];
        vec3 v = vec3(x[0], x[1], x[2]);
        masu_vndf_ray r = masu_vndf_reflect(v, x[3], vec2(x[4], x[5]));
        float size = dot(r.l, r.l);
        assert_true(size > 0.999f && size < 1.001f);
        assert_true(r.weight >= 0 && r.weight <= 1 && isfinite(r.pdf) && r.pdf >= 0);
        float p = masu_vndf_pdf(v, vec3(x[4], x[5], x[0]), x[3]);
        float w = masu_vndf_weight(v, vec3(x[4], x[5], x[0]), x[3]);
        assert_true(isfinite(p) && p >= 0 && w >= 0 && w <= 1);
        masu_axes f = masu_axes_of(v);
        assert_true(fabsf(dot(f.n, f.n) - 1) < 1e-5f && fabsf(dot(f.t, f.t) - 1) < 1e-5f);
    }
    /* A mirror exactly up to the roughness bound; no step in its weight. */
    vec3 v = view_at(60);
    masu_vndf_ray r = masu_vndf_reflect(v, masu_alpha(0), vec2(0.3, 0.9));
    assert_true(r.l.x == -v.x && r.l.y == -v.y && fabsf(r.l.z - v.z) < 1e-6f && r.weight > 0.9999f);
    r = masu_vndf_reflect(v, masu_mirror_alpha * 1.01f, vec2(0.3, 0.9));
    assert_true(r.l.x != -v.x && r.weight > 0.99f);
}

static void frames_are_right_angled(void **state) {
    (void)state;
    uint64_t seed = 2;
    double worst = 0;
    for (int i = 0; i < 200000; i++) {
        double z =
            i % 2 ? 2 * unit(&seed) - 1 : copysign(1 - pow(10, -16 * unit(&seed)), i % 4 - 1);
        double phi = 2 * PI * unit(&seed), s = sqrt(1 - z * z);
        masu_axes f = masu_axes_of(vec3(s * cos(phi), s * sin(phi), z));
        worst = worst_of(worst, fabs((double)dot(f.t, f.b)));
        worst = worst_of(worst, fabs((double)dot(f.t, f.n)));
        worst = worst_of(worst, fabs((double)dot(f.b, f.n)));
        worst = worst_of(worst, fabs((double)dot(f.t, f.t) - 1));
        worst = worst_of(worst, fabs((double)dot(f.b, f.b) - 1));
        /* Right-handed: t x b = n. */
        worst = worst_of(worst, fabs((double)(f.t.x * f.b.y - f.t.y * f.b.x - f.n.z)));
        vec3 a = vec3(unit(&seed), unit(&seed), unit(&seed)),
             b = masu_axes_out(f, masu_axes_in(f, a));
        worst = worst_of(worst, fabs((double)(a.x - b.x)) + fabs((double)(a.y - b.y)));
        worst = worst_of(worst, fabs((double)(a.z - b.z)));
    }
    print_message("  tangent frames have an error of %.1e\n", worst);
    assert_true(worst < 2e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(directions_come_as_often_as_the_density_says),
        cmocka_unit_test(weights_are_the_lobe_over_the_density),
        cmocka_unit_test(the_bound_only_helps),
        cmocka_unit_test(a_white_furnace_returns_the_table),
        cmocka_unit_test(any_bits_give_a_direction),
        cmocka_unit_test(frames_are_right_angled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
