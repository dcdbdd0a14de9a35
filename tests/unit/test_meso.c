/* test_meso.c: the parts of masu-meso: generated patches, rays through a period, measurements
 * (against closed forms: a plane, V-grooves, hemispheres), and the bounds of the model. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/files.h"

#include "meso/author.h"

#define RADIANS (MASU_BAKE_PI / 180)

#define assert_near(got, want, most)                                                               \
    do {                                                                                           \
        double got_ = (got), want_ = (want);                                                       \
        if (!(fabs(got_ - want_) <= (most))) fail_msg("%s is %g, not %g", #got, got_, want_);       \
    } while (0)

static const double grey[3] = {0.5, 0.5, 0.5};

static void measure(const masu_meso_patch *patch, masu_meso_setup *setup, masu_meso_view *views) {
    masu_meso_tracer *tracer = masu_meso_tracer_create(patch);
    assert_non_null(tracer);
    assert_true(masu_meso_measure(tracer, patch, setup, views));
    masu_meso_tracer_free(tracer);
}

/* ---- Patches --------------------------------------------------------------------------------- */

static void made_patches_are_the_same_twice_and_whole(void **state) {
    (void)state;
    for (const char *const *name = masu_meso_made; *name; name++) {
        masu_meso_patch a, b;
        assert_true(masu_meso_make(*name, 1, 7, &a) && masu_meso_make(*name, 1, 7, &b));
        assert_int_equal(a.vertex_count, b.vertex_count);
        assert_memory_equal(a.position, b.position, a.vertex_count * 3 * sizeof(float));
        assert_true(a.high > 0.01 && a.high < 0.5);
        masu_meso_patch_free(&b);
        assert_true(masu_meso_make(*name, 1, 8, &b));
        assert_true(a.vertex_count != b.vertex_count ||
                    memcmp(a.position, b.position, a.vertex_count * 3 * sizeof(float)));
        /* Closed from above: no ray straight down finds a hole. */
        masu_meso_tracer *t = masu_meso_tracer_create(&a);
        for (int i = 0; i < 4096; i++) {
            double u, v;
            masu_meso_hit h;
            masu_meso_point((uint64_t)i, 1, &u, &v);
            assert_true(masu_meso_trace(t, masu_bake_v3(u, 1, v), masu_bake_v3(0, -1, 0), &h));
            assert_true(h.normal.y >= 0);
        }
        masu_meso_tracer_free(t);
        masu_meso_patch_free(&a);
        masu_meso_patch_free(&b);
    }
    masu_meso_patch none;
    assert_false(masu_meso_make("sand", 1, 1, &none));
}

/* A wall on the edge of the period is hit from all sides, in all periods. */
static void rays_cross_periods(void **state) {
    (void)state;
    masu_meso_patch p = {0};
    const double flat[16] = {0};
    masu_meso_patch_from_grid(&p, flat, NULL, grey, 4);
    uint32_t a = masu_meso_vertex(&p, masu_bake_v3(0, 0, -0.5), grey);
    uint32_t b = masu_meso_vertex(&p, masu_bake_v3(0, 0, 1.5), grey);
    uint32_t c = masu_meso_vertex(&p, masu_bake_v3(0, 0.5, -0.5), grey);
    uint32_t d = masu_meso_vertex(&p, masu_bake_v3(0, 0.5, 1.5), grey);
    masu_meso_triangle(&p, a, b, c);
    masu_meso_triangle(&p, b, d, c);
    masu_meso_patch_finish(&p);
    masu_meso_tracer *t = masu_meso_tracer_create(&p);
    masu_meso_hit h;
    for (int side = -1; side <= 1; side += 2) {
        for (double z = 0.05; z < 1; z += 0.1) {
            /* From 0.4 above the centre of a period, falling by 0.1 before the wall. */
            masu_meso_vec3 down = masu_bake_v3(side, -0.2, 0.3);
            masu_bake_normalize(&down);
            assert_true(masu_meso_trace(t, masu_bake_v3(0.5, 0.4, z), down, &h));
            assert_near(h.position.y, 0.3, 1e-4);
            assert_near(h.normal.x, -side, 1e-6);
        }
    }
    /* Over the wall and far away: nothing blocks, and the ground of the next period does. */
    assert_false(masu_meso_blocked(t, masu_bake_v3(0.5, 0.01, 0.5), masu_bake_v3(0, 1, 0),
                                   masu_bake_v3(0.6, 0.8, 0)));
    assert_true(masu_meso_blocked(t, masu_bake_v3(0.5, 0.01, 0.5), masu_bake_v3(0, 1, 0),
                                  masu_bake_v3(0.8, 0.6, 0)));
    masu_meso_tracer_free(t);
    masu_meso_patch_free(&p);
}

/* ---- Measurement ----------------------------------------------------------------------------- */

static void a_plane_is_a_plane(void **state) {
    (void)state;
    masu_meso_patch p = {.roughness = 0.4};
    const double flat[64] = {0};
    masu_meso_patch_from_grid(&p, flat, NULL, grey, 8);
    masu_meso_patch_finish(&p);
    masu_meso_setup s = {.view = {0, 45, 88},
                         .view_count = 3,
                         .light = {{10, 0}, {60, 120}},
                         .light_count = 2,
                         .side = 16,
                         .sky_rays = 64,
                         .seed = 3};
    masu_meso_view views[3];
    measure(&p, &s, views);
    for (int i = 0; i < 3; i++) {
        assert_near(views[i].toward, 0, 1e-6);
        assert_near(views[i].up, 1, 1e-6);
        assert_near(views[i].ao, 1, 1e-9);
        assert_near(views[i].lit[0], 1, 1e-9);
        masu_meso_vec3 n = {0, 1, 0}, v = masu_meso_from_above(views[i].angle, 0);
        masu_meso_vec3 l = masu_meso_light_direction(&s.light[1], 0, 1);
        masu_meso_lobes lobes = masu_meso_brdf(n, v, l, 0.4);
        assert_near(views[i].sun[1][0], l.y * (0.5 * lobes.diffuse + lobes.specular), 1e-6);
    }
    masu_meso_patch_free(&p);
}

/* Grooves along z whose walls rise at 45 degrees. Facing walls are strips of equal width w under an
 * opening of sqrt(2) w: by the crossed-strings rule (Hottel) the form factor from a wall to the
 * opening is (sqrt 2 w + w - w) / (2 w) = sqrt 2 / 2. Viewed across at 60 degrees, beyond the
 * slope, the wall that faces away is hidden, and all visible surfaces are tilted by 45 degrees to
 * the viewer. */
static void grooves_have_their_closed_form(void **state) {
    (void)state;
    enum { SIDE = 16 };
    masu_meso_patch p = {.roughness = 1};
    double height[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) height[i] = i % 2 ? 1.0 / SIDE : 0;
    masu_meso_patch_from_grid(&p, height, NULL, grey, SIDE);
    masu_meso_patch_finish(&p);
    masu_meso_setup s = {.view = {0}, .view_count = 1, .side = 64, .sky_rays = 64, .seed = 1};
    masu_meso_view view;
    measure(&p, &s, &view);
    assert_near(view.up, sqrt(0.5), 1e-6);
    assert_near(view.ao, sqrt(0.5), 0.004);
    masu_meso_tracer *t = masu_meso_tracer_create(&p);
    masu_meso_vec3 v = masu_meso_from_above(60, 0), down = {-v.x, -v.y, -v.z};
    for (int i = 0; i < 2000; i++) {
        double x, z;
        masu_meso_hit h;
        masu_meso_point((uint64_t)i, 5, &x, &z);
        assert_true(masu_meso_trace(t, masu_bake_v3(x, 0.2, z), down, &h));
        assert_near(h.normal.x, sqrt(0.5), 1e-5);
    }
    masu_meso_tracer_free(t);
    masu_meso_patch_free(&p);
}

/* Hemispheres on a plane, covering a fraction s = pi r^2. From above, the mean normal is (1 - s) +
 * s 2/3 up. Along the ground only the half that faces the viewer is visible: its mean normal has
 * the length 2/3 and is horizontal, as the mean over the projected half disc. */
static void hemispheres_have_theirs(void **state) {
    (void)state;
    enum { SIDE = 512 };
    const double r = 0.4;
    double *height = malloc(SIDE * SIDE * sizeof *height);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = (i % SIDE) / (double)SIDE - 0.5, z = (double)(i / SIDE) / SIDE - 0.5;
        double left = r * r - x * x - z * z;
        height[i] = left > 0 ? sqrt(left) : 0;
    }
    masu_meso_patch p = {.roughness = 1};
    masu_meso_patch_from_grid(&p, height, NULL, grey, SIDE);
    free(height);
    masu_meso_patch_finish(&p);
    masu_meso_setup s = {.view = {0}, .view_count = 1, .side = 128, .sky_rays = 1, .seed = 1};
    masu_meso_view view;
    measure(&p, &s, &view);
    double covered = MASU_BAKE_PI * r * r;
    assert_near(view.up, 1 - covered / 3, 0.01);
    assert_near(view.toward, 0, 0.01);
    masu_meso_patch_free(&p);
}

static void the_sky_table_keeps_energy(void **state) {
    (void)state;
    static masu_meso_sky_table table;
    masu_meso_sky_table_make(&table);
    for (double x = 0.02; x <= 1; x += 0.07) {
        for (double r = 0; r <= 1; r += 0.1) {
            double e = masu_meso_sky_share(&table, x, r);
            assert_true(e > 0 && e < 1);
        }
    }
    /* A mirror: Schlick's Fresnel itself. */
    assert_near(masu_meso_sky_share(&table, 1, 0), MASU_MESO_F0, 2e-3);
    assert_near(masu_meso_sky_share(&table, 0.5, 0), 0.04 + 0.96 / 32, 3e-3);
}

/* ---- The model ------------------------------------------------------------------------------- */

static void identity_changes_nothing(void **state) {
    (void)state;
    masu_meso_curves c = masu_meso_identity(0.3);
    masu_meso_vec3 n = {0.6, 0.8, 0}, v = masu_meso_from_above(70, 1);
    masu_meso_surface s = {n, {0.1, 0.2, 0.3}, 0.5, 0.7, 1, 1};
    masu_meso_bend(&c, v, masu_bake_v3(0, 1, 0), &s);
    assert_near(s.normal.x, n.x, 1e-12);
    assert_near(s.color[2], 0.3, 1e-12);
    assert_near(s.roughness, 0.5, 1e-12);
    assert_near(s.ao, 0.7, 1e-12);
    assert_near(s.specular, 1, 0);
    assert_near(s.shadow, 1, 0);
}

/* For any curves: unit normals, fractions within 0..1. */
static void any_curves_stay_in_range(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 20000; i++) {
        union {
            masu_meso_curves c;
            double v[MASU_MESO_NUMBERS];
        } any;
        for (uint64_t k = 0; k < MASU_MESO_NUMBERS; k++) {
            double u, w;
            masu_meso_point(i * MASU_MESO_NUMBERS + k, 9, &u, &w);
            any.v[k] = (2 * u - 1) * pow(10, 6 * w - 3);
        }
        any.c.facet = fmin(fabs(any.c.facet), 1);
        double a, b, d, e;
        masu_meso_point(i, 4, &a, &b);
        masu_meso_point(i, 5, &d, &e);
        masu_meso_surface s = {masu_meso_from_above(90 * d, 6 * e), {a, b, d}, e, b, 1, 1};
        masu_meso_vec3 v = masu_meso_from_above(90 * a, 6 * b);
        masu_meso_bend(&any.c, v, masu_bake_v3(0, 1, 0), &s);
        assert_near(masu_bake_length(s.normal), 1, 1e-9);
        double shadow = masu_meso_shadow(&s, v, masu_meso_from_above(90 * e, 6 * d));
        const double shares[] = {s.color[0], s.color[1], s.color[2], s.roughness,
                                 s.ao,       s.specular, s.shadow,   shadow};
        for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
            assert_true(shares[k] >= 0 && shares[k] <= 1);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(made_patches_are_the_same_twice_and_whole),
        cmocka_unit_test(rays_cross_periods),
        cmocka_unit_test(a_plane_is_a_plane),
        cmocka_unit_test(grooves_have_their_closed_form),
        cmocka_unit_test(hemispheres_have_theirs),
        cmocka_unit_test(the_sky_table_keeps_energy),
        cmocka_unit_test(identity_changes_nothing),
        cmocka_unit_test(any_curves_stay_in_range),
    };
    return cmocka_run_group_tests_name("meso", tests, NULL, NULL);
}
