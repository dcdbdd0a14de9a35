/* test_reference_bsdf.c: the materials of the reference path tracer (lab/reference) against
 * tabulated integrals, in both modes. Expected values are quadratures or random walks that use none
 * of its code. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "lab/reference/tracer.h"

static const double cosines[5] = {.1, .25, .5, .75, 1};

/* Within 0.3 % or three standard errors. */
static void check(double found, double expected, double error, const char *what) {
    double most = fmax(0.003 * fabs(expected), 3 * error);
    if (!(fabs(found - expected) <= most))
        fail_msg("%s: found %.5f +- %.5f, expected %.5f", what, found, error, expected);
}

static ref_vec tilted(double cosine) { return ref_v(sqrt(1 - cosine * cosine), 0, cosine); }

/* Directional albedo of height-correlated GGX: from 1e7 visible normals per value, and by
 * quadrature over light directions. */
static const struct {
    double roughness, white[5], weight[5], average;
} lobes[] = {
    {.2, {.9289, .98365, .9955, .9976, .9983}, {.4696, .2219, .0323, .0013, 0}, .9941},
    {.4, {.8883, .8761, .9264, .9546, .9677}, {.2127, .1236, .0289, .0025, 0}, .9405},
    {.6, {.8824, .8084, .7821, .7995, .8245}, {.0927, .0524, .0157, .0025, 0}, .8030},
    {.8, {.8331, .7180, .6212, .5755, .5552}, {.0442, .0229, .0069, .0014, 0}, .6042},
    {1, {.7602, .5976, .4507, .3645, .3069}, {.0239, .0109, .0030, .0006, 0}, .4091},
};

static void the_lobe_has_its_albedo(void **state) {
    (void)state;
    for (size_t i = 0; i < 5; i++) {
        for (int k = 0; k < 5; k++) {
            ref_albedo exact = ref_ggx_integrate(lobes[i].roughness, cosines[k], 256);
            ref_albedo table = ref_ggx_albedo(lobes[i].roughness, cosines[k]);
            check(exact.white, lobes[i].white[k], 0, "albedo");
            check(table.white, lobes[i].white[k], 0, "albedo in the table");
            assert_true(fabs(exact.weight - lobes[i].weight[k]) < 2e-4);
            assert_true(fabs(table.weight - lobes[i].weight[k]) < 5e-4);
        }
        check(ref_ggx_average(lobes[i].roughness).white, lobes[i].average, 0, "average albedo");
    }
}

/* Mean weight of sampled directions. */
static double sampled(const ref_surface *s, double cosine, bool walk, int paths, double *error) {
    ref_bsdf b;
    double sum = 0, square = 0;
    ref_bsdf_make(&b, s, tilted(cosine), walk);
    for (int i = 0; i < paths; i++) {
        ref_random r = ref_random_at(5, 0, (uint64_t)i);
        ref_lobes w;
        ref_vec l;
        double value = ref_bsdf_sample(&b, &r, &l, &w) ? ref_lobes_sum(&w).x : 0;
        sum += value;
        square += value * value;
    }
    double mean = sum / paths;
    *error = sqrt(fmax(square / paths - mean * mean, 0) / paths);
    return mean;
}

static ref_surface metal(double f0, double roughness) {
    return (ref_surface){.albedo = ref_splat(f0),
                         .roughness = roughness,
                         .metallic = 1,
                         .specular = .5,
                         .normal = {0, 0, 1},
                         .coat_normal = {0, 0, 1},
                         .occlusion = 1};
}
static ref_surface lambert(double albedo) {
    return (ref_surface){.albedo = ref_splat(albedo),
                         .roughness = 1,
                         .normal = {0, 0, 1},
                         .coat_normal = {0, 0, 1},
                         .occlusion = 1};
}

static const double rows_of[3] = {.2, .6, 1};
static const double closed[3][5] = {{.7219, .6080, .5153, .5002, .4997},
                                    {.5213, .4853, .4614, .4585, .4626},
                                    {.4375, .3806, .3310, .3031, .2849}};
static const double walked[2][3][5] = {{{.9484, .9219, .9030, .9000, .8999},
                                        {.9024, .8926, .8842, .8824, .8837},
                                        {.8807, .8592, .8337, .8147, .8006}},
                                       {{.7442, .6109, .5156, .5003, .4997},
                                        {.5286, .4932, .4622, .4546, .4574},
                                        {.4551, .4011, .3449, .3080, .2827}}};

static void the_closed_model_has_its_albedo(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++) {
            double error;
            ref_surface s = metal(.5, rows_of[i]);
            ref_bsdf b;
            ref_bsdf_make(&b, &s, tilted(cosines[k]), false);
            ref_lobes albedo = ref_bsdf_albedo(&b);
            check(ref_lobes_sum(&albedo).x, closed[i][k], 0, "closed metal");
            double found = sampled(&s, cosines[k], false, 20000, &error);
            check(found, closed[i][k], error, "closed metal, sampled");
        }
    }
    /* Smooth surfaces lose light only at grazing angles. */
    for (int i = 0; i < 5; i++) {
        double error;
        ref_surface s = metal(.9, .05 + .025 * i);
        ref_bsdf b;
        ref_bsdf_make(&b, &s, tilted(.1), false);
        ref_lobes albedo = ref_bsdf_albedo(&b);
        double found = sampled(&s, .1, false, 20000, &error);
        check(found, ref_lobes_sum(&albedo).x, fmin(error, .003), "smooth metal, sampled");
    }
}

static void the_random_walk_has_its_albedo(void **state) {
    (void)state;
    for (int m = 0; m < 2; m++) {
        double f0 = m ? .5 : .9;
        ref_fresnel f = {ref_splat(f0), 1};
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 5; k++) {
                double sum = 0, square = 0, error, alpha = rows_of[i] * rows_of[i];
                int paths = 20000;
                for (int n = 0; n < paths; n++) {
                    ref_random r = ref_random_at(9, (uint64_t)k, (uint64_t)n);
                    ref_vec l, weight;
                    double value = ref_walk_sample(alpha, &f, tilted(cosines[k]), &r, &l, &weight)
                                       ? weight.x
                                       : 0;
                    sum += value;
                    square += value * value;
                }
                double mean = sum / paths;
                error = sqrt(fmax(square / paths - mean * mean, 0) / paths);
                check(mean, walked[m][i][k], error, "walk");
                if (k == 1 || k == 3) { /* also as an evaluation, sampled by another density */
                    ref_surface s = metal(f0, rows_of[i]);
                    double found = sampled(&s, cosines[k], true, 20000, &error);
                    check(found, walked[m][i][k], error, "walk, evaluated");
                }
            }
        }
    }
}

/* Mean of the light from l scattered to v. */
static double walked_through(const ref_surface *s, ref_vec v, ref_vec l, double *error) {
    enum { PATHS = 20000 };
    ref_bsdf b;
    double sum = 0, square = 0;
    ref_bsdf_make(&b, s, v, true);
    for (int i = 0; i < PATHS; i++) {
        ref_random r = ref_random_at(7, 0, (uint64_t)i);
        ref_lobes f = ref_bsdf_eval(&b, l, &r);
        double value = ref_lobes_sum(&f).x / l.z;
        sum += value;
        square += value * value;
    }
    *error = sqrt(fmax(square / PATHS - sum / PATHS * (sum / PATHS), 0) / PATHS);
    return sum / PATHS;
}

/* The light with which walks leave, against the integral of what they scatter to each direction. */
static void walks_are_sampled_as_they_are_evaluated(void **state) {
    (void)state;
    enum { PATHS = 40000 };
    ref_surface s = metal(.7, .5);
    s.metallic = .4;
    s.coat = .7;
    s.coat_roughness = .4;
    for (int k = 0; k < 5; k++) {
        ref_bsdf b;
        double left = 0, error;
        ref_bsdf_make(&b, &s, tilted(cosines[k]), true);
        for (int i = 0; i < PATHS; i++) {
            ref_random r = ref_random_at(8, 0, (uint64_t)i);
            ref_vec l, weight;
            if (ref_layers_sample(&b, &r, &l, &weight)) left += weight.x / PATHS;
        }
        double found = sampled(&s, cosines[k], true, PATHS, &error);
        check(found, left, hypot(error, .4 / sqrt(PATHS)), "evaluated walks");
    }
}

static void layers_are_reciprocal(void **state) {
    (void)state;
    ref_surface s = metal(.6, .5);
    s.metallic = .3;
    for (int coat = 0; coat < 2; coat++) {
        double there, back;
        s.coat = coat;
        s.coat_roughness = .4;
        for (int k = 0; k < 4; k++) {
            ref_vec v = tilted(cosines[k]), l = tilted(cosines[k + 1]);
            l.x = -l.x;
            double f = walked_through(&s, v, l, &there), g = walked_through(&s, l, v, &back);
            check(f, g, sqrt(there * there + back * back), "both ways");
        }
    }
}

/* Without facets a dielectric mirrors Schlick's share; light that enters and is mirrored inside
 * forms a series: 1/21 of Lambertian light. */
static void a_smooth_dielectric_over_a_colour(void **state) {
    (void)state;
    ref_surface s = metal(.5, .1);
    s.metallic = 0;
    double average = .04 + .96 / 21;
    for (int k = 2; k < 5; k++) {
        double error, f = .04 + .96 * ref_schlick(cosines[k]);
        double expected = f + (1 - f) * (1 - average) * .5 / (1 - .5 * average);
        double found = sampled(&s, cosines[k], true, 60000, &error);
        assert_true(error < .004 && fabs(found - expected) < .004 + 3 * error);
    }
}

static void what_is_white_returns_all_light(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++) {
            double error;
            ref_surface kinds[4] = {metal(1, rows_of[i]), lambert(1), metal(1, rows_of[i]),
                                    metal(1, rows_of[i])};
            kinds[2].metallic = 0;
            kinds[3].metallic = 0.4;
            kinds[3].coat = 0.8;
            kinds[3].coat_roughness = 0.3;
            for (int n = 0; n < 4; n++) {
                double found = sampled(&kinds[n], cosines[k], false, 6000, &error);
                check(found, 1, error, "white furnace");
                /* Rare walks through narrow lobes have large weights: the mean approaches from
                 * below. */
                found = sampled(&kinds[n], cosines[k], true, 6000, &error);
                assert_true(error < .03 && fabs(found - 1) < .006 + 3 * error);
            }
            ref_fresnel white = {ref_splat(1), 1};
            for (int n = 0; n < 200; n++) {
                ref_random r = ref_random_at(2, 0, (uint64_t)n);
                ref_vec l, weight;
                assert_true(ref_walk_sample(rows_of[i] * rows_of[i], &white, tilted(cosines[k]), &r,
                                            &l, &weight));
                assert_true(weight.x == 1);
            }
        }
    }
}

static void thin_glass_lets_through_what_it_does_not_mirror(void **state) {
    (void)state;
    static const double angles[6] = {0, 30, 45, 60, 75, 85},
                        schlick[6] = {.0400, .0400, .0421, .0700, .2547, .6485};
    for (int i = 0; i < 6; i++) {
        ref_look look = {
            .s = metal(1, 0), .flags = MASU_MATERIAL_IS_BLEND, .cover = 1, .opacity = 0};
        ref_bsdf b;
        look.s.metallic = 0;
        ref_bsdf_make(&b, &look.s, tilted(cos(angles[i] * REF_PI / 180)), false);
        check(ref_pane_of(&look, &b).behind.x, 1 - schlick[i], 1e-3, "glass");
    }
}

int main(void) {
    ref_ggx_tables();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lobe_has_its_albedo),
        cmocka_unit_test(the_closed_model_has_its_albedo),
        cmocka_unit_test(the_random_walk_has_its_albedo),
        cmocka_unit_test(what_is_white_returns_all_light),
        cmocka_unit_test(walks_are_sampled_as_they_are_evaluated),
        cmocka_unit_test(layers_are_reciprocal),
        cmocka_unit_test(a_smooth_dielectric_over_a_colour),
        cmocka_unit_test(thin_glass_lets_through_what_it_does_not_mirror),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
