/* test_sky.c: the analytic sky without a GPU: its irradiance against integrals over the sky in
 * double precision, its optical depths against sums along the ray, continuity as the sun moves, and
 * the meaning of the numbers. The bounds are the measured errors, rounded up. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "frame/sky.h"
#include "frame/sky_table.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/sky_mirror.h"

#define PI 3.14159265358979323846
#define RINGS 160 /* over both halves */
#define AROUND 96

static const float ground[3] = {0.2f, 0.2f, 0.2f};
static masu_sky sky; /* with its tables, kept from test to test */

static void place_sun(double elevation, double azimuth, float turbidity) {
    double e = elevation * PI / 180, a = azimuth * PI / 180;
    const float sun[3] = {(float)(cos(e) * cos(a)), (float)sin(e), (float)(cos(e) * sin(a))};
    masu_sky_update(&sky, sun, turbidity, ground);
}

/* ---- Irradiance ------------------------------------------------------------------------------ */

static double directions[RINGS][AROUND][3], solid_angle[RINGS];
static double radiances[RINGS][AROUND][3];

static void look_around(void) {
    for (int r = 0; r < RINGS; r++) {
        double u = (r % (RINGS / 2) + 0.5) / (RINGS / 2), y = u * u * (3 - 2 * u);
        solid_angle[r] = 6 * u * (1 - u) / (RINGS / 2) * 2 * PI / AROUND;
        if (r >= RINGS / 2) y = -y;
        for (int p = 0; p < AROUND; p++) {
            double flat = sqrt(1 - y * y), a = 2 * PI * (p + 0.5) / AROUND;
            const double d[3] = {flat * cos(a), y, flat * sin(a)};
            const float f[3] = {(float)d[0], (float)d[1], (float)d[2]};
            float light[3];
            memcpy(directions[r][p], d, sizeof d);
            masu_sky_radiance(&sky.uniforms, f, light);
            for (int c = 0; c < 3; c++) radiances[r][p][c] = (double)light[c];
        }
    }
}

static void integrate(const double n[3], double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (int r = 0; r < RINGS; r++) {
        for (int p = 0; p < AROUND; p++) {
            const double *d = directions[r][p];
            double cosine = n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
            for (int c = 0; c < 3 && cosine > 0; c++)
                out[c] += cosine * solid_angle[r] / PI * radiances[r][p][c];
        }
    }
}

/* RMS over normals and colours relative to the mean; for one colour relative to that colour's
 * mean. */
static void irradiance_errors(double *all, double colors[3]) {
    double square[3] = {0, 0, 0}, mean[3] = {0, 0, 0};
    const int normals = 150;
    look_around();
    for (int i = 0; i < normals; i++) {
        double y = 1 - (2 * i + 1.0) / normals, a = 2.399963 * i, flat = sqrt(1 - y * y);
        const double n[3] = {flat * cos(a), y, flat * sin(a)};
        const float f[3] = {(float)n[0], (float)n[1], (float)n[2]};
        double truth[3];
        float got[3];
        integrate(n, truth);
        masu_sky_irradiance_at(&sky.irradiance, f, got);
        for (int c = 0; c < 3; c++) {
            square[c] += pow((double)got[c] - truth[c], 2) / normals;
            mean[c] += truth[c] / normals;
        }
    }
    for (int c = 0; c < 3; c++) colors[c] = sqrt(square[c]) / mean[c];
    *all = sqrt((square[0] + square[1] + square[2]) / 3) / ((mean[0] + mean[1] + mean[2]) / 3);
}

static void irradiance_is_the_integral_of_the_sky_within_a_percent(void **state) {
    (void)state;
    static const float turbidities[] = {2, 4, 8};
    static const double elevations[] = {-4, -2, 0, 1, 2, 5, 8, 10, 15, 20, 30, 45, 60, 75, 90};
    double worst = 0, worst_color = 0;
    for (size_t t = 0; t < sizeof turbidities / sizeof *turbidities; t++) {
        for (size_t i = 0; i < sizeof elevations / sizeof *elevations; i++) {
            double all, colors[3];
            place_sun(elevations[i], 20, turbidities[t]);
            irradiance_errors(&all, colors);
            print_message("turbidity %g, sun at %g degrees: RMS %.4f of the mean; %.4f %.4f %.4f\n",
                          (double)turbidities[t], elevations[i], all, colors[0], colors[1],
                          colors[2]);
            worst = worst_of(worst, all);
            for (int c = 0; c < 3; c++) worst_color = worst_of(worst_color, colors[c]);
        }
    }
    print_message("worst of all colours %.4f, of one %.4f\n", worst, worst_color);
    assert_true(worst <= 0.01);
    assert_true(worst_color <= 0.0115);
}

/* ---- Mirrors --------------------------------------------------------------------------------- */

/* The GGX lobe viewed from above, weighted by the cosine: 3000 directions by importance
 * sampling. */
static void integrate_lobe(const double n[3], double roughness, double out[3]) {
    double a2 = pow(roughness, 4), weight = 0, s = n[2] < 0 ? -1 : 1, a = -1 / (s + n[2]);
    double b = n[0] * n[1] * a;
    const double u[3] = {1 + s * n[0] * n[0] * a, s * b, -s * n[0]};
    const double v[3] = {b, s + n[1] * n[1] * a, -n[1]};
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 3000; i++) {
        double at = (i + 0.5) / 3000, turn = 2.399963 * i;
        double cos2 = (1 - at) / (1 + (a2 - 1) * at), h = sqrt(cos2), sine = sqrt(1 - cos2);
        double across = 2 * h * sine, up = 2 * cos2 - 1;
        float d[3], light[3];
        if (up <= 0) continue;
        for (int k = 0; k < 3; k++)
            d[k] = (float)(across * (cos(turn) * u[k] + sin(turn) * v[k]) + up * n[k]);
        masu_sky_radiance(&sky.uniforms, d, light);
        weight += up;
        for (int c = 0; c < 3; c++) out[c] += up * (double)light[c];
    }
    for (int c = 0; c < 3; c++) out[c] /= weight;
}

static void mirrors_are_near_the_sky_averaged_by_the_lobe(void **state) {
    (void)state;
    static const double elevations[] = {-3, 0.5, 5, 15, 40, 80}, turbidities[] = {2, 4, 8};
    static const double bounds[] = {0.012, 0.065, 0.105, 0.105, 0.11,
                                    0.093, 0.065, 0.048, 0.025, 0.02};
    for (int i = 0; i < 10; i++) {
        double roughness = 0.1 * (i + 1), sum = 0, worst = 0;
        for (int k = 0; k < 18; k++) {
            double square = 0, mean = 0;
            place_sun(elevations[k % 6], 20, (float)turbidities[k / 6]);
            for (int j = 0; j < 30; j++) {
                double y = 1 - (2 * j + 1.0) / 30, a = 2.399963 * j, flat = sqrt(1 - y * y);
                const double d[3] = {flat * cos(a), y, flat * sin(a)};
                double truth[3], got[3];
                integrate_lobe(d, roughness, truth);
                sky_mirror(&sky, d, roughness, got);
                for (int c = 0; c < 3; c++) {
                    square += pow(got[c] - truth[c], 2) / 90;
                    mean += truth[c] / 90;
                }
            }
            sum += square / (mean * mean) / 18;
            worst = worst_of(worst, sqrt(square) / mean);
        }
        print_message("roughness %.1f: error %.3f of the mean, at worst %.3f\n", roughness,
                      sqrt(sum), worst);
        assert_true(sqrt(sum) <= bounds[i]);
    }
}

/* ---- Continuity ------------------------------------------------------------------------------ */

#define LOOKS 200

static void look(float out[LOOKS][3]) {
    for (int i = 0; i < LOOKS; i++) {
        double y = 1 - (2 * i + 1.0) / LOOKS, a = 2.399963 * i, flat = sqrt(1 - y * y);
        const float d[3] = {(float)(flat * cos(a)), (float)y, (float)(flat * sin(a))};
        masu_sky_radiance(&sky.uniforms, d, out[i]);
    }
}

/* All values that a frame takes from the sky, before and after a small step: the largest change of
 * a number, relative to the largest of its kind. */
typedef struct sight {
    float looks[LOOKS][3], sun[3];
    masu_sky_irradiance irradiance;
} sight;

static void take(sight *s) {
    look(s->looks);
    memcpy(s->sun, sky.sun_color, sizeof s->sun);
    s->irradiance = sky.irradiance;
}

static double step_of(const float *a, const float *b, size_t n) {
    double most = 1e-6, change = 0;
    for (size_t i = 0; i < n; i++) {
        most = worst_of(most, fmax(fabs((double)a[i]), fabs((double)b[i])));
        change = worst_of(change, fabs((double)a[i] - (double)b[i]));
    }
    return change / most;
}

/* The largest changes from step to step. */
typedef struct jumps {
    double radiance, coefficients, single, sun;
} jumps;

static void compare(const sight *a, const sight *b, jumps *j) {
    double mean = fmax((double)b->irradiance.sh[0][0], 1e-6);
    j->radiance = worst_of(j->radiance, step_of(a->looks[0], b->looks[0], 3 * LOOKS));
    j->coefficients =
        fmax(j->coefficients, step_of(a->irradiance.sh[0], b->irradiance.sh[0], 27));
    for (int c = 0; c < 3; c++) {
        double glow = fabs((double)(a->irradiance.glow[c] - b->irradiance.glow[c]));
        double ring = fabs((double)(a->irradiance.ring[c] - b->irradiance.ring[c]));
        double turn = fabs((double)(a->irradiance.direction[c] - b->irradiance.direction[c]));
        j->coefficients = worst_of(j->coefficients, fmax(fmax(glow, ring) / mean, turn));
        j->sun = worst_of(j->sun, fabs((double)(a->sun[c] - b->sun[c])));
    }
    /* And each direction separately, if it is brighter than a display can show of the night. */
    for (int k = 0; k < LOOKS; k++) {
        for (int c = 0; c < 3; c++) {
            double before = (double)a->looks[k][c], now = (double)b->looks[k][c];
            if (fmax(before, now) > 1e-3) j->single = worst_of(j->single, fabs(log(before / now)));
        }
    }
}

static jumps sunrise(float turbidity, double from, double step, int steps) {
    static sight before, now;
    jumps j = {0, 0, 0, 0};
    for (int i = 0; i <= steps; i++) {
        place_sun(from + step * i, 40 + 0.5 * step * i, turbidity);
        take(&now);
        if (i > 0) compare(&before, &now, &j);
        before = now;
    }
    print_message(
        "turbidity %g, steps of %g degrees: of the brightest: radiance %.4f, coefficients "
        "%.4f; a single direction %.3f; the sun %.4f\n",
        (double)turbidity, step, j.radiance, j.coefficients, j.single, j.sun);
    return j;
}

/* A tenth of the step is a tenth of the change: fast changes are the air's, not a table's edge. */
static void the_sky_does_not_jump_as_the_sun_rises(void **state) {
    (void)state;
    static const float turbidities[] = {1.5f, 3, 10};
    for (size_t t = 0; t < sizeof turbidities / sizeof *turbidities; t++) {
        jumps j = sunrise(turbidities[t], -15, 0.1, 300);
        assert_true(j.radiance <= 0.20 && j.coefficients <= 0.18 && j.single <= 0.30);
        assert_true(j.sun <= 0.06);
        j = sunrise(turbidities[t], -8, 0.01, 1200);
        assert_true(j.radiance <= 0.025 && j.coefficients <= 0.022 && j.single <= 0.04);
        assert_true(j.sun <= 0.008);
    }
}

static void the_sky_does_not_jump_as_the_sun_crosses_the_zenith_or_the_air_gets_hazy(void **state) {
    (void)state;
    static sight before, now;
    double zenith = 0, haze = 0;
    for (int i = 0; i <= 40; i++) {
        place_sun(88 + 0.1 * i, 40, 3); /* past 90 degrees the azimuth flips */
        take(&now);
        if (i > 0) zenith = worst_of(zenith, step_of(before.looks[0], now.looks[0], 3 * LOOKS));
        before = now;
    }
    for (int i = 0; i <= 170; i++) {
        place_sun(4, 40, 1.5f + 0.05f * (float)i);
        take(&now);
        if (i > 0) haze = worst_of(haze, step_of(before.looks[0], now.looks[0], 3 * LOOKS));
        before = now;
    }
    print_message("zenith %.4f, haze %.4f\n", zenith, haze);
    assert_true(zenith <= 0.03);
    assert_true(haze <= 0.12);
}

/* ---- Meaning of the numbers ------------------------------------------------------------------ */

/* The same optical depths by a sum of many steps: air of scale height 8 km, aerosol of 1.2 km,
 * ozone between 15 and 35 km. */
static double summed_depth(double height, double mu, double turbidity, int color) {
    static const double air[3] = {5.802e-3, 13.558e-3, 33.1e-3};
    static const double ozone[3] = {0.650e-3, 1.881e-3, 0.085e-3};
    static const double wave[3] = {680, 550, 440};
    double haze = (turbidity - 1) * air[1] * 8.0 / 1.2 * pow(wave[color] / 550, -1.3);
    double r = 6360 + height, depth = 0, before = 0;
    const int steps = 20000;
    for (int i = 0; i < steps; i++) {
        double t = (i + 1.0) / steps, end = 4000 * t * t, s = 0.5 * (end + before);
        double h = sqrt(r * r + s * s + 2 * r * mu * s) - 6360;
        double layer = h > 15 && h < 35 ? 0.75 : 0;
        depth += (end - before) * (air[color] * exp(-h / 8) + haze * exp(-h / 1.2) +
                                   ozone[color] * layer);
        before = end;
    }
    return depth;
}

static void depth_towards_the_sun_is_the_sum_along_the_ray(void **state) {
    (void)state;
    static const double elevations[] = {90, 60, 30, 15, 8, 4, 2, 1, 0.5};
    static const double heights[] = {0, 0.2, 2, 10, 25};
    double worst = 0;
    for (size_t i = 0; i < sizeof elevations / sizeof *elevations; i++) {
        for (size_t h = 0; h < sizeof heights / sizeof *heights; h++) {
            double got[3], mu = sin(elevations[i] * PI / 180);
            masu_sky_transmittance(heights[h], mu, 3, got);
            for (int c = 0; c < 3; c++) {
                double truth = summed_depth(heights[h], mu, 3, c);
                worst = worst_of(worst, fabs(-log(got[c]) - truth) / truth);
            }
        }
    }
    /* Beyond the horizon, from high above: the ray falls, then rises. */
    for (int i = 1; i <= 8; i++) {
        double got[3], height = 40, mu = -0.01 * i;
        masu_sky_transmittance(height, mu, 3, got);
        for (int c = 0; c < 3; c++) {
            double truth = summed_depth(height, mu, 3, c);
            worst = worst_of(worst, fabs(-log(got[c]) - truth) / truth);
        }
    }
    print_message("depth is %.4f off at most\n", worst);
    assert_true(worst <= 0.012);
}

static void average_sky(double out[3]) {
    look_around();
    out[0] = out[1] = out[2] = 0;
    for (int r = 0; r < RINGS / 2; r++) {
        for (int p = 0; p < AROUND; p++) {
            for (int c = 0; c < 3; c++)
                out[c] += radiances[r][p][c] * solid_angle[r] / (2 * PI);
        }
    }
}

static void noon_is_blue_and_the_evening_sun_red(void **state) {
    (void)state;
    double noon[3], night[3];
    float opposite[3];
    place_sun(60, 0, 2.5f);
    assert_true(sky.sun_color[0] > 1.5f && sky.sun_color[0] < 3.0f);
    assert_true(sky.sun_color[2] > 0.6f * sky.sun_color[0]);
    average_sky(noon);
    assert_true(noon[2] > 1.3 * noon[0]);
    masu_sky_radiance(&sky.uniforms, (const float[3]){-0.6f, 0.8f, 0}, opposite);
    assert_true(opposite[2] > 2 * opposite[0] && opposite[2] > 0.1f && opposite[2] < 1.0f);
    place_sun(3, 0, 2.5f);
    assert_true(sky.sun_color[0] > 5 * sky.sun_color[2]);
    place_sun(-0.4, 0, 2.5f);
    for (int c = 0; c < 3; c++) assert_true(sky.sun_color[c] == 0.0f);
    place_sun(-60, 0, 2.5f);
    average_sky(night);
    for (int c = 0; c < 3; c++) assert_true(night[c] > 1e-5 && night[c] < 1e-3 * noon[c]);
}

/* The light that reaches the ground is less than the incoming light: the sun on level ground
 * outside of the air. */
static void no_light_is_made(void **state) {
    (void)state;
    static const float turbidities[] = {1.5f, 2, 4, 10};
    double most = 0;
    for (size_t t = 0; t < sizeof turbidities / sizeof *turbidities; t++) {
        for (double e = 5; e <= 90; e += 5) {
            const double up[3] = {0, 1, 0};
            double sum[3], sine = sin(e * PI / 180);
            place_sun(e, 0, turbidities[t]);
            look_around();
            integrate(up, sum);
            for (int c = 0; c < 3; c++) {
                double all = sum[c] + sine * (double)sky.sun_color[c];
                most = worst_of(most, all / (sine * MASU_SKY_SUN));
            }
        }
    }
    print_message("the ground receives %.3f of the light at most\n", most);
    assert_true(most < 1.0);
}

static void turning_the_sun_turns_the_sky(void **state) {
    (void)state;
    static masu_sky_irradiance first;
    for (int turn = 0; turn < 8; turn++) {
        double a = 0.7 * turn;
        place_sun(12, a * 180 / PI, 3);
        if (turn == 0) first = sky.irradiance;
        for (int i = 0; i < 50; i++) {
            double y = 1 - (2 * i + 1.0) / 50, b = 2.4 * i, flat = sqrt(1 - y * y);
            const float d[3] = {(float)(flat * cos(b)), (float)y, (float)(flat * sin(b))};
            const float t[3] = {(float)(flat * cos(b + a)), (float)y, (float)(flat * sin(b + a))};
            float want[3], got[3];
            masu_sky_irradiance_at(&first, d, want);
            masu_sky_irradiance_at(&sky.irradiance, t, got);
            for (int c = 0; c < 3; c++) assert_float_equal(got[c], want[c], 1e-4);
        }
    }
}

static void only_what_has_changed_is_computed(void **state) {
    (void)state;
    static masu_sky s;
    const float sun[3] = {0, 0.5f, 1}, longer[3] = {0, 1, 2}, other[3] = {0, 0.51f, 1};
    memset(&s, 0, sizeof s);
    assert_int_equal(masu_sky_update(&s, sun, 3, ground), 1);
    uint64_t first = s.steps;
    assert_int_equal(masu_sky_update(&s, longer, 3, ground), 0);
    assert_int_equal(masu_sky_update(&s, other, 3, ground), 1);
    assert_int_equal(s.air_updates, 1);
    assert_int_equal(s.sun_updates, 2);
    uint64_t second = s.steps - first;
    print_message("%llu points of the air for a sun, %llu more for a turbidity\n",
                  (unsigned long long)second, (unsigned long long)(first - second));
    assert_true(second <= 1800 && first - second <= 8100);
    assert_int_equal(masu_sky_update(&s, other, 4, ground), 1);
    assert_int_equal(s.air_updates, 2);
}

static void any_sun_and_air_give_finite_light(void **state) {
    (void)state;
    static const float values[] = {0,    1,     -1,   1e-30f,   1e30f, -1e38f,
                                   NAN, INFINITY, 1e-45f, 0.3f, -0.001f};
    static masu_sky s;
    uint64_t random = 7;
    const uint64_t n = sizeof values / sizeof *values;
    memset(&s, 0, sizeof s);
    for (int i = 0; i < 300; i++) {
        float v[7];
        for (int k = 0; k < 7; k++) v[k] = values[support_random(&random) % n];
        masu_sky_update(&s, v, v[3], v + 4);
        const float *words = (const float *)(const void *)&s.uniforms;
        for (size_t k = 0; k < sizeof s.uniforms / sizeof *words; k++)
            assert_true(isfinite(words[k]));
        words = (const float *)(const void *)&s.irradiance;
        for (size_t k = 0; k < sizeof s.irradiance / sizeof *words; k++)
            assert_true(isfinite(words[k]));
        for (int c = 0; c < 3; c++) assert_true(s.sun_color[c] >= 0 && isfinite(s.sun_color[c]));
        for (int k = 0; k < 20; k++) {
            double y = 1 - k / 9.5, flat = sqrt(fmax(1 - y * y, 0));
            const float d[3] = {(float)flat, (float)y, 0};
            float light[3];
            masu_sky_radiance(&s.uniforms, d, light);
            for (int c = 0; c < 3; c++) assert_true(light[c] > 0 && light[c] < 1e4f);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(irradiance_is_the_integral_of_the_sky_within_a_percent),
        cmocka_unit_test(mirrors_are_near_the_sky_averaged_by_the_lobe),
        cmocka_unit_test(the_sky_does_not_jump_as_the_sun_rises),
        cmocka_unit_test(the_sky_does_not_jump_as_the_sun_crosses_the_zenith_or_the_air_gets_hazy),
        cmocka_unit_test(depth_towards_the_sun_is_the_sum_along_the_ray),
        cmocka_unit_test(noon_is_blue_and_the_evening_sun_red),
        cmocka_unit_test(no_light_is_made),
        cmocka_unit_test(turning_the_sun_turns_the_sky),
        cmocka_unit_test(only_what_has_changed_is_computed),
        cmocka_unit_test(any_sun_and_air_give_finite_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
