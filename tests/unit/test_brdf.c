/* test_brdf.c: the surface model in double precision with the tables that the GPU gets: the tables
 * against independently computed integrals, the white furnace test, reciprocity.
 * tests/gpu/test_brdf.c then compares the shader with this model. */
#include "reference/brdf.h"
#include "shared/masu_shared.h"
#include "split_sum.h"
#include "support/floats.h"
#include "support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

enum { STEPS = 80, ROUGHNESSES = 33 };

/* Degrees from the normal. */
static const double angles[] = {0, 10, 25, 40, 50, 60, 68, 75, 80, 84, 87, 88.5, 89.3, 89.7, 89.9};
enum { ANGLES = sizeof angles / sizeof *angles };

static double cosine_of(double degrees) { return cos(degrees * 3.14159265358979323846 / 180); }

/* Between the nodes too: roughnesses between the rows, angles between the columns. */
static void tables_are_near_their_integrals(void **state) {
    (void)state;
    static const char *const names[] = {"white", "weight of s", "covered", "covered, weight of s"};
    double worst[BRDF_INTEGRALS] = {0}, at[BRDF_INTEGRALS][2] = {{0}};
    for (int r = 0; r < 24; r++) {
        double roughness = 0.02 + 0.98 * pow(r / 23.0, 1.5);
        for (int a = 0; a < ANGLES; a++) {
            double truth[BRDF_INTEGRALS], table[BRDF_INTEGRALS], mu = cosine_of(angles[a]);
            brdf_integrals(roughness, mu, STEPS, truth);
            brdf_looked_up(masu_split_sum, roughness, mu, table);
            for (int k = 0; k < BRDF_INTEGRALS; k++) {
                double off = fabs(table[k] - truth[k]);
                if (off <= worst[k]) continue;
                worst[k] = off;
                at[k][0] = roughness;
                at[k][1] = angles[a];
            }
        }
    }
    for (int k = 0; k < BRDF_INTEGRALS; k++) {
        print_message("  %-22s error of %.5f at most, at roughness %.3f, %.1f degrees\n", names[k],
                      worst[k], at[k][0], at[k][1]);
        assert_true(worst[k] < 0.0075);
    }
}

typedef struct material {
    const char *name;
    brdf_surface s;
} material;

#define WHITE                                                                                      \
    { 1, 1, 1 }
static const material materials[] = {
    {"metal", {WHITE, 0, 1, 0.5, 0, 0}},
    {"dielectric, specular 0", {WHITE, 0, 0, 0, 0, 0}},
    {"dielectric, specular 0.5", {WHITE, 0, 0, 0.5, 0, 0}},
    {"dielectric, specular 1", {WHITE, 0, 0, 1, 0, 0}},
    {"half metal", {WHITE, 0, 0.5, 0.5, 0, 0}},
    {"metal, coat 0.5 smooth", {WHITE, 0, 1, 0.5, 0.5, 0}},
    {"metal, coat 1 smooth", {WHITE, 0, 1, 0.5, 1, 0}},
    {"metal, coat 1 of 0.3", {WHITE, 0, 1, 0.5, 1, 0.3}},
    {"metal, coat 1 of 1", {WHITE, 0, 1, 0.5, 1, 1}},
    {"dielectric, coat 0.5", {WHITE, 0, 0, 0.5, 0.5, 0.1}},
    {"dielectric, coat 1", {WHITE, 0, 0, 0.5, 1, 0.1}},
    {"specular 0, coat 1 of 0.6", {WHITE, 0, 0, 0, 1, 0.6}},
};
enum { MATERIALS = sizeof materials / sizeof *materials };

static void in_the_white_furnace_no_light_is_lost_or_made(void **state) {
    (void)state;
    for (int i = 0; i < MATERIALS; i++) {
        double low = 1e9, high = 0, at[2] = {0, 0};
        for (int r = 0; r < ROUGHNESSES; r++) {
            brdf_surface s = materials[i].s;
            s.roughness = (double)r / (ROUGHNESSES - 1);
            for (int a = 0; a < ANGLES; a++) {
                double out[3];
                brdf_furnace(masu_split_sum, &s, cosine_of(angles[a]), STEPS, out);
                if (fabs(out[0] - 1) > fmax(high - 1, 1 - low))
                    at[0] = s.roughness, at[1] = angles[a];
                low = fmin(low, out[0]);
                high = fmax(high, out[0]);
            }
        }
        print_message("  %-26s %.4f to %.4f, farthest from 1 at roughness %.2f, %.1f degrees\n",
                      materials[i].name, low, high, at[0], at[1]);
        assert_true(low > 0.99 && high < 1.01);
    }
}

static brdf_surface any_surface(uint64_t *seed) {
    brdf_surface s;
    for (int k = 0; k < 3; k++) s.albedo[k] = random_unit(seed);
    s.roughness = random_unit(seed);
    s.metallic = random_unit(seed) < 0.5 ? 0 : random_unit(seed);
    s.specular = random_unit(seed);
    s.coat = random_unit(seed) < 0.5 ? 0 : random_unit(seed);
    s.coat_roughness = random_unit(seed);
    return s;
}

static void any_direction(uint64_t *seed, double out[3]) {
    double z = random_unit(seed), phi = 6.283185307179586 * random_unit(seed);
    z = fmax(z * z, 1e-3);
    out[0] = sqrt(1 - z * z) * cos(phi);
    out[1] = sqrt(1 - z * z) * sin(phi);
    out[2] = z;
}

static void light_and_view_may_be_exchanged(void **state) {
    (void)state;
    uint64_t seed = 5;
    double worst = 0;
    for (int i = 0; i < 20000; i++) {
        brdf_surface s = any_surface(&seed);
        double v[3], l[3], there[3], back[3];
        any_direction(&seed, v);
        any_direction(&seed, l);
        brdf_eval(masu_split_sum, &s, v, l, there);
        brdf_eval(masu_split_sum, &s, l, v, back);
        for (int k = 0; k < 3; k++) {
            double a = there[k] / l[2], b = back[k] / v[2];
            worst = worst_of(worst, fabs(a - b) / fmax(a, b));
        }
    }
    print_message("  f(v, l) and f(l, v) differ by %.1e of themselves at most\n", worst);
    assert_true(worst < 1e-9);
}

static void no_surface_gives_more_light_than_it_gets(void **state) {
    (void)state;
    uint64_t seed = 9;
    double most = 0;
    for (int i = 0; i < 500; i++) {
        brdf_surface s = any_surface(&seed);
        double out[3], mu = fmax(random_unit(&seed), 1.75e-3);
        brdf_furnace(masu_split_sum, &s, mu * mu < 1.75e-3 ? mu : mu * mu, 48, out);
        for (int k = 0; k < 3; k++) most = worst_of(most, out[k]);
    }
    print_message("  coloured surfaces return %.4f at most\n", most);
    assert_true(most < 1.01);
}

/* A coat tilted by 20 degrees over white surfaces, by quadrature over directions: rough enough for
 * it. */
static void a_leaning_coat_makes_no_light(void **state) {
    (void)state;
    const int rings = 160, turns = 160;
    double low[2] = {9, 9}, high[2] = {0, 0}; /* dielectrics, metals */
    for (int i = 0; i < 24; i++) {
        brdf_surface s = {.albedo = WHITE,
                          .roughness = i & 1 ? 0.4 : 1,
                          .metallic = i & 2 ? 1 : 0,
                          .specular = 0.5,
                          .coat = i & 4 ? 1 : 0.5,
                          .coat_roughness = 0.4};
        double lean = cosine_of(20), angle = i / 8 * 30.0, all[3] = {0, 0, 0};
        const double v[3] = {sqrt(1 - cosine_of(angle) * cosine_of(angle)), 0, cosine_of(angle)};
        const double n[3] = {(i & 8 ? -1 : 1) * sqrt(1 - lean * lean), 0, lean};
        for (int r = 0; r < rings; r++) {
            for (int t = 0; t < turns; t++) {
                double z = 2 * (r + 0.5) / rings - 1, phi = 6.283185307179586 * (t + 0.5) / turns,
                       f[3];
                const double l[3] = {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z};
                /* times pi; dl is 4 pi / (rings * directions) */
                brdf_over(masu_split_sum, &s, n, v, l, f);
                for (int k = 0; k < 3; k++) all[k] += f[k] * 4 / (rings * turns);
            }
        }
        low[i >> 1 & 1] = fmin(low[i >> 1 & 1], all[0]);
        high[i >> 1 & 1] = fmax(high[i >> 1 & 1], all[0]);
    }
    print_message("  dielectrics %.4f to %.4f, metals %.4f to %.4f\n", low[0], high[0], low[1],
                  high[1]);
    assert_true(low[0] > 0.97 && high[0] < 1.001);
    /* the table has no light that leaves the metal at a steep angle */
    assert_true(low[1] > 0.82 && high[1] < 1.025);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_are_near_their_integrals),
        cmocka_unit_test(in_the_white_furnace_no_light_is_lost_or_made),
        cmocka_unit_test(light_and_view_may_be_exchanged),
        cmocka_unit_test(no_surface_gives_more_light_than_it_gets),
        cmocka_unit_test(a_leaning_coat_makes_no_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
