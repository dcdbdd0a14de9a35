/* test_truth.c: the double-precision sphere tracer against surfaces with a closed-form
 * intersection, and the shading arithmetic at points computed by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "measure/shade.h"
#include "measure/truth.h"
#include "reference/brdf.h"
#include "split_sum.h"
#include "support/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void near(double value, double wanted, double slack) {
    if (!(fabs(value - wanted) <= slack)) fail_msg("%.15g is not %.15g", value, wanted);
}

/* ---- Fields ---------------------------------------------------------------------------------- */

/* params: kind, centre or offset x y z, radius, scale of the field */
enum { SPHERE, PLANE, SLAB, BROKEN };

static double distance(const double *k, double time, const double p[3]) {
    double q[3] = {p[0] - k[1] - time, p[1] - k[2], p[2] - k[3]}, f = nan("");
    if (k[0] == SPHERE) f = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) - k[4];
    if (k[0] == PLANE) f = q[1];
    if (k[0] == SLAB) f = fabs(q[2]) - k[4];
    return k[5] * f;
}

static double step(const double *k, double time, const double p[3]) {
    return distance(k, time, p) / k[5];
}

static int part(const double *k, double time, const double p[3]) {
    (void)time;
    (void)p;
    return (int)k[0];
}

static void material(int which, double out[8]) {
    const double values[8] = {0.5, 0.25, 0.1, 0.4, 0, 0, 0, 0};
    memcpy(out, values, sizeof values);
    if (which == PLANE) out[5] = 2;
}

static const masu_truth truth = {NULL, distance, step, part, material};

/* A camera at `eye` looking along -z, 16:9, 90 degrees high. */
static masu_view make_view(int kind, double x, double y, double z) {
    masu_view v = {.width = 160, .height = 90, .eye = {x, y, z}, .forward = {0, 0, -1}};
    v.up[1] = v.tan_y = 1;
    v.right[0] = 160.0 / 90;
    v.near_distance = 0.01;
    v.max_distance = 1e7;
    for (int i = 0; i < 3; i++) {
        v.sdf_min[i] = -1e9;
        v.sdf_max[i] = 1e9;
    }
    v.params[0] = kind;
    v.params[4] = v.params[5] = 1;
    return v;
}

static masu_view_ray ray_along(double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    return (masu_view_ray){.direction = {x / length, y / length, z / length},
                           .z_scale = 1,
                           .start = 0.01,
                           .limit = 1e7};
}

/* ---- The march ------------------------------------------------------------------------------- */

/* First intersection with a sphere, or -1; miss: the ray's distance from it, in radii. */
static double sphere_at(const masu_view *v, const masu_view_ray *r, double *miss) {
    double o[3], b = 0, c = 0;
    for (int i = 0; i < 3; i++) o[i] = v->eye[i] - v->params[1 + i] - (i ? 0 : v->time);
    for (int i = 0; i < 3; i++) b += o[i] * r->direction[i];
    for (int i = 0; i < 3; i++) {
        double q = o[i] - b * r->direction[i];
        c += q * q;
    }
    double radius = v->params[4];
    *miss = sqrt(c) / radius - 1;
    return c <= radius * radius ? -b - sqrt(radius * radius - c) : -1;
}

static void check_sphere(const masu_view *v, double slack) {
    uint64_t seed = 3;
    uint32_t hits = 0;
    for (int i = 0; i < 4000; i++) {
        uint32_t x = (uint32_t)support_random_in(&seed, 0, v->width - 1);
        uint32_t y = (uint32_t)support_random_in(&seed, 0, v->height - 1);
        masu_view_ray r = masu_view_ray_at(v, x, y);
        masu_truth_sample s;
        double miss, wanted = sphere_at(v, &r, &miss);
        if (fabs(miss) < 1e-7) continue;
        masu_truth_march(&truth, v, &r, &s);
        if (s.kind == MASU_TRUTH_UNSURE) fail_msg("pixel (%u,%u) is undecided", x, y);
        if ((s.kind == MASU_TRUTH_HIT) != (wanted >= 0))
            fail_msg("pixel (%u,%u): %d, passes by %g", x, y, (int)s.kind, miss);
        if (wanted < 0) continue;
        hits++;
        /* For a grazing ray, the intersection is as ill-conditioned as 1 / sqrt(miss). */
        near(s.t / wanted, 1, slack / sqrt(fabs(miss)));
        for (int c = 0; c < 3; c++) {
            double p = v->eye[c] + r.direction[c] * s.t - v->params[1 + c] - (c ? 0 : v->time);
            near(s.normal[c], p / v->params[4], 1e-4);
        }
    }
    assert_true(hits > 100);
}

static void spheres_are_hit_where_they_are(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0.3, -0.2, 3);
    check_sphere(&v, 1e-12);
    v.params[5] = 50; /* the field grows 50 times too fast, the step is correct */
    check_sphere(&v, 1e-12);
    v.params[5] = 0.02;
    check_sphere(&v, 1e-9); /* and 50 times too slowly: the tolerance is of the field */
    v = make_view(SPHERE, 0.3, -0.2, 3);
    v.time = 0.5;
    check_sphere(&v, 1e-12);
    for (int i = 0; i < 3; i++) { /* a million units from the origin */
        v.eye[i] += 1e6;
        v.params[1 + i] += 1e6;
    }
    check_sphere(&v, 1e-8);
    v = make_view(SPHERE, 0, 0, 3e4); /* large, and tiny */
    v.params[4] = 1e4;
    check_sphere(&v, 1e-12);
    v = make_view(SPHERE, 0, 0, 3e-4);
    v.params[4] = 1e-4;
    v.near_distance = 1e-6;
    check_sphere(&v, 1e-12);
}

/* A ground plane from 10 degrees to 1e-5 radians, the farthest crossing 100,000 heights away. */
static void a_grazed_plane_is_hit_to_its_horizon(void **state) {
    (void)state;
    masu_view v = make_view(PLANE, 3, 1.7, -5);
    v.max_distance = 1e6;
    uint64_t seed = 11;
    for (int i = 0; i < 400; i++) {
        double angle = 0.17 * pow(6e-5, random_unit(&seed)), turn = 6.28 * random_unit(&seed);
        masu_view_ray r = ray_along(cos(angle) * sin(turn), -sin(angle), -cos(angle) * cos(turn));
        masu_truth_sample s;
        masu_truth_march(&truth, &v, &r, &s);
        double wanted = 1.7 / sin(angle);
        if (s.kind != MASU_TRUTH_HIT) fail_msg("angle %g: %d", angle, (int)s.kind);
        near(s.t / wanted, 1, 1e-9);
        near(s.normal[1], 1, 1e-6);
        if (s.evals > 20000) fail_msg("angle %g: %u evaluations", angle, s.evals);
        r.direction[1] = -r.direction[1]; /* the sky above is a miss */
        r.limit = 5e4;
        masu_truth_march(&truth, &v, &r, &s);
        assert_int_equal(s.kind, MASU_TRUTH_MISS);
    }
}

static void a_ray_meets_things_between_its_start_and_its_limit(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0, 0, 3);
    masu_view_ray r = ray_along(0, 0, -1);
    masu_truth_sample s;
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_HIT);
    near(s.t, 2, 1e-12);
    assert_int_equal(s.part, SPHERE);
    r.limit = 2; /* a surface at the limit is no hit */
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_MISS);
    r.limit = 1.5;
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_MISS);
    r.limit = 100;
    r.start = 2.5; /* starts inside: the hit is at the start */
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_HIT);
    near(s.t, 2.5, 0);
    r.start = 50; /* starts behind */
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_MISS);
    v.params[0] = BROKEN; /* not a number: no hit */
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_MISS);
    v = make_view(SLAB, 0, 0, 3); /* an infinitely wide plate a micrometre thick */
    v.params[4] = 5e-7;
    r = ray_along(0.3, 0.2, -1);
    masu_truth_march(&truth, &v, &r, &s);
    assert_int_equal(s.kind, MASU_TRUTH_HIT);
    near(s.t * -r.direction[2], 3 - 5e-7, 1e-12);
}

static void a_ray_is_clipped_to_the_bounds(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0, 0, 3);
    for (int i = 0; i < 3; i++) {
        v.sdf_min[i] = -1.5;
        v.sdf_max[i] = 1.5;
    }
    v.width = 161; /* an odd number of pixels has one at the centre */
    v.height = 91;
    masu_view_ray r = masu_view_ray_at(&v, 80, 45);
    near(r.direction[2], -1, 1e-15);
    near(r.start, 1.5, 1e-12);
    near(r.limit, 4.5, 1e-12);
    near(r.z_scale, 1, 1e-15);
    near(r.pixel, 2.0 / 91, 1e-12);
    r = masu_view_ray_at(&v, 0, 0); /* up and to the left, past the bounds */
    assert_true(r.direction[0] < 0 && r.direction[1] > 0 && r.start > r.limit);
    near(r.z_scale, sqrt(1 + pow(160.0 / 161 * 160 / 90, 2) + pow(90.0 / 91, 2)), 1e-12);
}

static void a_picture_is_its_pixels(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0.1, 0.2, 3);
    v.width = 31;
    v.height = 22;
    static masu_truth_sample samples[11 * 8], s;
    assert_int_equal(masu_truth_columns(31, 3), 11);
    assert_int_equal(masu_truth_columns(22, 3), 8);
    masu_truth_image(&truth, &v, 3, samples);
    for (uint32_t i = 0; i < 11 * 8; i++) {
        masu_view_ray r = masu_view_ray_at(&v, i % 11 * 3, i / 11 * 3);
        masu_truth_march(&truth, &v, &r, &s);
        assert_int_equal(s.kind, samples[i].kind);
        near(s.t, samples[i].t, 0);
    }
}

static void a_library_is_found_beside_its_scene(void **state) {
    (void)state;
    char path[64], error[256];
    masu_truth t;
    assert_true(masu_truth_path("build/scenes/a.masu", path, sizeof path));
    assert_string_equal(path, "build/scenes/a.truth.so");
    assert_true(masu_truth_path("b", path, sizeof path));
    assert_string_equal(path, "b.truth.so");
    assert_false(masu_truth_path("build/scenes/a.masu", path, 10));
    assert_false(masu_truth_open("/no/such/library.so", &t, error, sizeof error));
    assert_non_null(strstr(error, "library.so"));
    /* not searched in the library path */
    assert_false(masu_truth_open("libm.so.6", &t, error, sizeof error));
}

/* ---- Shading --------------------------------------------------------------------------------- */

static void colours_are_those_worked_out_by_hand(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0, 0, 3);
    uint8_t rgba[4];
    v.exposure = 1;
    masu_shade_encode(&v, (double[3]){0, 1e9, -1}, rgba);
    assert_int_equal(rgba[0], 0);
    assert_int_equal(rgba[1], 255);
    assert_int_equal(rgba[2], 0);
    /* Curve at 0.18: 0.18 (2.51 * 0.18 + 0.03) / (0.18 (2.43 * 0.18 + 0.59) + 0.14) = 0.2669;
     * encoded 0.5538. */
    masu_shade_encode(&v, (double[3]){0.18, 0.18, 0.18}, rgba);
    assert_int_equal(rgba[0], 141);
    v.exposure = 0.5;
    masu_shade_encode(&v, (double[3]){0.36, 0.36, 0.36}, rgba);
    assert_int_equal(rgba[0], 141);
    memcpy(v.sky_zenith, (double[3]){0, 0, 1}, sizeof v.sky_zenith);
    memcpy(v.sky_horizon, (double[3]){1, 0, 0}, sizeof v.sky_horizon);
    memcpy(v.sun_direction, (double[3]){0, 1, 0}, sizeof v.sun_direction);
    double out[3];
    masu_shade_sky(&v, (double[3]){0.8, -0.6, 0}, out);
    near(out[0], 1, 0);
    masu_shade_sky(&v, (double[3]){sqrt(1 - 0.0625), 0.25, 0}, out);
    near(out[2], 0.5, 1e-12);
    v.sun_color[1] = 1; /* the glow around the sun */
    masu_shade_sky(&v, (double[3]){0, 1, 0}, out);
    near(out[1], 0.3, 1e-12);
}

static void surfaces_are_those_worked_out_by_hand(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0, 0, 3);
    double m[8] = {1, 1, 1, 1, 0, 0, 0, 0}, out[3];
    memcpy(v.sun_direction, (double[3]){0, 1, 0}, sizeof v.sun_direction);
    v.sun_color[0] = v.ambient[1] = 1;
    /* White, rough, lit and viewed from straight above: compared with the other model in double
     * precision. All of the ambient light, 1, is returned; the reflection is the ambient light
     * too. */
    const brdf_surface surface = {.albedo = {1, 1, 1}, .roughness = 1, .specular = 0.5};
    double expected[3];
    brdf_eval(masu_split_sum, &surface, (double[3]){0, 0, 1}, (double[3]){0, 0, 1}, expected);
    masu_shade_surface(&v, (double[3]){0, -1, 0}, (double[3]){0, 1, 0}, m, out);
    near(out[0], expected[0], 1e-9);
    assert_in_range((int)(1000 * out[0]), 950, 1050);
    near(out[1], 1, 1e-9);
    near(out[2], 0, 0);
    /* Facing away from the sun: no red. */
    masu_shade_surface(&v, (double[3]){0, 1, 0}, (double[3]){0, -1, 0}, m, out);
    near(out[0], 0, 0);
    /* Emission is added. */
    double sun;
    masu_shade_surface(&v, (double[3]){0, -1, 0}, (double[3]){0, 1, 0}, m, out);
    sun = out[0];
    m[5] = 4;
    masu_shade_surface(&v, (double[3]){0, -1, 0}, (double[3]){0, 1, 0}, m, out);
    near(out[0], sun, 1e-12);
    near(out[1], 1 + 4, 1e-9);
    near(out[2], 0, 0);
    /* Black and at maximum roughness: nothing else. */
    m[0] = m[1] = m[2] = 0;
    masu_shade_surface(&v, (double[3]){0, -1, 0}, (double[3]){0, 1, 0}, m, out);
    near(out[0], 0, 0);
    near(out[1], 4, 1e-12);
}

static void a_texel_is_shaded_as_the_surface_it_holds(void **state) {
    (void)state;
    masu_view v = make_view(SPHERE, 0, 0, 3);
    memcpy(v.sun_direction, (double[3]){0.6, 0.8, 0}, sizeof v.sun_direction);
    for (int i = 0; i < 3; i++) v.sun_color[i] = v.ambient[i] = 0.5 + 0.1 * i;
    const double down[3] = {0, 0, -1}, n[3] = {0, 0, 1};
    uint32_t up_z = 4095u | 4095u << 13; /* octahedral (0, 0) */
    const uint8_t albedo[4] = {255, 128, 0, 51};
    double root = 128 / 255.0, a[3], b[3];
    double m[8] = {1, root * root, 0, 0.2, 0, 0, 0, 0.4};
    masu_shade_texel(&v, down, albedo, up_z | 6u << 26, (double[3]){0}, a);
    masu_shade_surface(&v, down, n, m, b);
    for (int i = 0; i < 3; i++) near(a[i], b[i], 1e-12);
    masu_shade_texel(&v, down, (uint8_t[4]){0, 0, 0, 255}, up_z | 1u << 30, (double[3]){100, 16, 0},
                     a);
    near(a[0], 100, 1e-12);
    near(a[2], 0, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_are_hit_where_they_are),
        cmocka_unit_test(a_grazed_plane_is_hit_to_its_horizon),
        cmocka_unit_test(a_ray_meets_things_between_its_start_and_its_limit),
        cmocka_unit_test(a_ray_is_clipped_to_the_bounds),
        cmocka_unit_test(a_picture_is_its_pixels),
        cmocka_unit_test(a_library_is_found_beside_its_scene),
        cmocka_unit_test(colours_are_those_worked_out_by_hand),
        cmocka_unit_test(surfaces_are_those_worked_out_by_hand),
        cmocka_unit_test(a_texel_is_shaded_as_the_surface_it_holds),
    };
    return cmocka_run_group_tests_name("truth", tests, NULL, NULL);
}
