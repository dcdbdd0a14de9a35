/* test_probes.c: light probes: rays in a scene; the grid does not depend on the number of threads;
 * its light has a low error, much lower than without it; a wall between two rooms keeps most of
 * their light apart. The bounds are for a small grid with few rays. */
#define _DEFAULT_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "bake/light/field.h"
#include "bake/light/path.h"
#include "bake/light/probes.h"
#include "bake/build/look.h"
#include "bake/mesh/shape.h"
#include "bake/light/probe_light.h"
#include "support/random.h"

static void add_box(masu_bake_content *scene, masu_bake_vec3 low, masu_bake_vec3 high, float r,
                    float g, float b, float glow) {
    masu_bake_content piece = {0};
    masu_bake_residence residence = {0};
    masu_bake_override override = {.base_color = true, .emissive = true};
    masu_bake_overrides overrides = {&override, 1};
    override.value.base_color[0] = r;
    override.value.base_color[1] = g;
    override.value.base_color[2] = b;
    for (int k = 0; k < 3; k++) override.value.emissive[k] = glow;
    masu_bake_cuboid(&piece, masu_bake_sub(high, low), 0);
    masu_bake_affine at = masu_bake_translation(
        masu_bake_v3((low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2));
    assert_null(masu_bake_place(scene, &piece, &residence, &at, &overrides, NULL));
    masu_bake_content_release(&piece);
}

#define V masu_bake_v3

/* A room of 4 x 3 x 4 metres with one side red, open to the sky on the +z side. `wall`: across its
 * centre, leaving two rooms, of which the rear one has no window and no lamp. */
static masu_bake_content room(bool wall) {
    masu_bake_content c = {0};
    add_box(&c, V(-2.2, -0.2, -2.2), V(2.2, 0, 2.2), 0.7f, 0.7f, 0.7f, 0);
    add_box(&c, V(-2.2, 3, -2.2), V(2.2, 3.2, 2.2), 0.7f, 0.7f, 0.7f, 0);
    add_box(&c, V(-2.2, 0, -2.2), V(-2, 3, 2.2), 0.7f, 0.1f, 0.1f, 0);
    add_box(&c, V(2, 0, -2.2), V(2.2, 3, 2.2), 0.7f, 0.7f, 0.7f, 0);
    add_box(&c, V(-2, 0, -2.2), V(2, 3, -2), 0.7f, 0.7f, 0.7f, 0);
    if (wall) add_box(&c, V(-2, 0, -0.1), V(2, 3, 0.1), 0.7f, 0.7f, 0.7f, 0);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box bounds = masu_bake_bounds(&c, &identity);
    masu_bake_look look = masu_bake_default_look();
    masu_bake_build_look(&look, &bounds, &c);
    masu_bake_sort_instances(&c);
    return c;
}

static masu_bake_probe_settings settings(uint32_t threads) {
    masu_bake_probe_settings s = masu_bake_probe_defaults();
    s.rays = 256;
    s.threads = threads;
    s.has_bounds = s.has_spacing = s.has_suns = true;
    s.bounds = (masu_bake_box){V(-2.2, -0.2, -2.2), V(2.2, 3.2, 2.2)};
    s.spacing = V(0.55, 0.55, 0.55);
    s.suns = 2;
    for (int i = 0; i < 2; i++) {
        masu_bake_vec3 d = V(i ? 0.5 : -0.1, 0.5, 1);
        assert_true(masu_bake_normalize(&d));
        s.sun[i][0] = (float)d.x;
        s.sun[i][1] = (float)d.y;
        s.sun[i][2] = (float)d.z;
    }
    return s;
}

static void rays_meet_what_is_there(void **state) {
    (void)state;
    masu_bake_content c = room(false);
    masu_bake_trace *trace = masu_bake_trace_make(&c);
    assert_non_null(trace);
    assert_int_equal(masu_bake_trace_triangles(trace), 60);
    const float middle[3] = {0, 1.5f, 0}, left[3] = {-1, 0, 0}, out[3] = {0, 0, 1};
    const float inside[3] = {-2.1f, 1.5f, 0}, right[3] = {1, 0, 0};
    masu_bake_hit hit;
    assert_true(masu_bake_trace_ray(trace, middle, left, 100, &hit));
    assert_float_equal(hit.t, 2, 1e-5);
    assert_float_equal(hit.normal[0], 1, 1e-6);
    assert_float_equal(hit.albedo[0], 0.7f, 1e-6);
    assert_float_equal(hit.albedo[1], 0.1f, 1e-6);
    assert_false(hit.back);
    assert_true(hit.position[0] > -2 && hit.position[0] < -1.999f);
    assert_false(masu_bake_trace_ray(trace, middle, left, 1.9f, &hit));
    assert_false(masu_bake_trace_ray(trace, middle, out, 1e30f, &hit));
    assert_true(masu_bake_trace_free(trace, middle, out, 1e30f));
    assert_false(masu_bake_trace_free(trace, middle, left, 1e30f));
    /* From inside a wall its surface is hit from behind. */
    assert_true(masu_bake_trace_ray(trace, inside, right, 100, &hit));
    assert_true(hit.back);
    assert_float_equal(hit.normal[0], -1, 1e-6);
    masu_bake_trace_release(trace);
    masu_bake_content_release(&c);
}

static void bake_room(masu_bake_content *c, const masu_bake_probe_settings *s,
                      masu_bake_probe_report *report) {
    masu_bake_trace *trace = masu_bake_trace_make(c);
    assert_non_null(trace);
    assert_true(masu_bake_make_probes(c, s, trace, report));
    masu_bake_trace_release(trace);
}

/* A ball of 1 m behind a thin wall with a hole, as text: rays hit where the formulas predict, and
 * the closer of SDF and polygons. */
static void rays_meet_the_sdf_too(void **state) {
    (void)state;
    static const char text[] =
        "material red { albedo (0.8, 0.1, 0.2); emissive (1, 2, 3) }\n"
        "material grey { albedo 0.5 }\n"
        "part ball : red = translate((0, 1.5, 0), sphere(1));\n"
        "part wall : grey = difference(translate((0, 1.5, 1.5), box((2, 1.5, 0.02))),\n"
        "    translate((0, 1.5, 1.5), box((0.1, 0.1, 1))));\n";
    char path[] = "/tmp/masu_field_XXXXXX.sdf";
    int file = mkstemps(path, 4);
    assert_true(file >= 0 && write(file, text, sizeof text - 1) == (ssize_t)sizeof text - 1);
    (void)close(file);
    masu_bake_content c = room(false), bare = room(false);
    masu_blob_sdf sdf = {
        .bounds_min = {-2, 0, -2}, .bounds_max = {2, 3, 2}, .lipschitz = 1, .max_distance = 100};
    masu_bake_append(&c.section[MASU_BLOB_SDF], &sdf, sizeof sdf);
    masu_bake_trace *trace = masu_bake_trace_make(&c);
    masu_bake_field *field = masu_bake_field_make(&c, path);
    assert_non_null(field);
    masu_bake_trace_add(trace, field);
    const float outside[3] = {0, 1.5f, 1.9f}, aside[3] = {0.5f, 1.5f, 1.9f},
                inside[3] = {0, 1.5f, 0.5f};
    const float back[3] = {0, 0, -2}, up[3] = {0, 1, 0}, high[3] = {1.5f, 1.5f, 0};
    masu_bake_hit hit;
    /* Through the hole: the ball. The direction is 2 long. */
    assert_true(masu_bake_trace_ray(trace, outside, back, 100, &hit));
    assert_float_equal(hit.t, 0.45f, 1e-3);
    assert_float_equal(hit.normal[2], 1, 1e-3);
    assert_float_equal(hit.albedo[0], 0.8f, 1e-6);
    assert_float_equal(hit.emissive[2], 3, 1e-6);
    assert_false(hit.back);
    assert_true(masu_bake_trace_ray(trace, aside, back, 100, &hit));
    assert_float_equal(hit.t, 0.19f, 1e-3);
    assert_float_equal(hit.albedo[0], 0.5f, 1e-6);
    assert_false(masu_bake_trace_free(trace, aside, back, 100));
    assert_true(masu_bake_trace_free(trace, aside, back, 0.18f));
    /* From inside the rear part; next to it the ceiling, which is of polygons. */
    assert_true(masu_bake_trace_ray(trace, inside, up, 100, &hit));
    assert_true(hit.back && hit.t == 0);
    assert_true(masu_bake_trace_ray(trace, high, up, 100, &hit));
    assert_float_equal(hit.t, 1.5f, 1e-4);
    assert_float_equal(hit.albedo[0], 0.7f, 1e-6);
    /* Probes in the ball are inside geometry. */
    masu_bake_probe_report with, without;
    masu_bake_probe_settings s = settings(0);
    s.rays = 32;
    assert_true(masu_bake_make_probes(&c, &s, trace, &with));
    masu_bake_trace_release(trace);
    masu_bake_field_release(field);
    (void)unlink(path);
    bake_room(&bare, &s, &without);
    assert_true(with.invalid > without.invalid + 10);
    masu_bake_content_release(&bare);
    masu_bake_content_release(&c);
}

static void threads_change_no_byte(void **state) {
    (void)state;
    masu_bake_content a = room(false), b = room(false);
    masu_bake_probe_report one, three;
    masu_bake_probe_settings s = settings(1);
    s.rays = 64;
    bake_room(&a, &s, &one);
    s.threads = 3;
    bake_room(&b, &s, &three);
    assert_int_equal(one.rays, three.rays);
    assert_int_equal(one.invalid, three.invalid);
    const uint32_t kinds[] = {MASU_BLOB_PROBES, MASU_BLOB_PROBE_DATA};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(a.section[kinds[i]].bytes, b.section[kinds[i]].bytes);
        assert_memory_equal(a.section[kinds[i]].data, b.section[kinds[i]].data,
                            a.section[kinds[i]].bytes);
    }
    const masu_blob_probes *p = MASU_BAKE_ARRAY(&a, MASU_BLOB_PROBES, const masu_blob_probes);
    assert_int_equal(masu_bake_count(&a, MASU_BLOB_PROBE_DATA),
                     (uint64_t)one.probes * masu_probe_words(p));
    assert_int_equal(p->emissive, 0);
    masu_bake_content_release(&a);
    masu_bake_content_release(&b);
}

/* Under a uniform sky in the open, irradiance / pi is the sky's radiance, for any normal. */
static void nothing_in_the_way_leaves_the_sky(void **state) {
    (void)state;
    masu_bake_content c = {0};
    add_box(&c, V(-1e-3, -1000, -1e-3), V(1e-3, -999.9, 1e-3), 1, 1, 1, 0);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box bounds = masu_bake_bounds(&c, &identity);
    masu_bake_look look = masu_bake_default_look();
    masu_bake_build_look(&look, &bounds, &c);
    masu_bake_probe_settings s = settings(1);
    masu_bake_probe_report report;
    bake_room(&c, &s, &report);
    const masu_blob_probes *p = MASU_BAKE_ARRAY(&c, MASU_BLOB_PROBES, const masu_blob_probes);
    const uint32_t *data = MASU_BAKE_ARRAY(&c, MASU_BLOB_PROBE_DATA, const uint32_t);
    uint32_t *lit = malloc(report.probes * MASU_PROBE_LIT_WORDS * sizeof *lit);
    masu_probe_sky sky = {.sky = {{3.5449077f, 2 * 3.5449077f, 0}}, .sun_direction = {0, 1, 0}};
    masu_probe_light(p, data, &sky, lit);
    uint64_t random = 5;
    for (int i = 0; i < 500; i++) {
        float u[4], at[3], n[3], got[3];
        for (int k = 0; k < 4; k++) u[k] = (float)(support_random(&random) % 65536) / 65536.0f;
        masu_path_sphere(u, n);
        for (int k = 0; k < 3; k++) at[k] = k == 1 ? u[2] * 3 : u[k + 1] * 4 - 2;
        assert_float_equal(masu_probe_lookup(p, data, lit, at, n, got), 1, 1e-6);
        assert_float_equal(got[0], 1, 0.03);
        assert_float_equal(got[1], 2, 0.06);
        assert_float_equal(got[2], 0, 1e-6);
    }
    /* Beyond the grid it fades, and a cell farther out it has no effect. */
    const float beyond[3] = {-2.2f - 0.275f, 1, 0}, far[3] = {-2.2f - 0.56f, 1, 0},
                up[3] = {0, 1, 0};
    float got[3];
    assert_float_equal(masu_probe_lookup(p, data, lit, beyond, up, got), 0.5, 1e-3);
    assert_float_equal(masu_probe_lookup(p, data, lit, far, up, got), 0, 1e-6);
    free(lit);
    masu_bake_content_release(&c);
}

static double error_of(const masu_bake_probe_error *errors, uint32_t rows, const char *light,
                       const char *method) {
    for (uint32_t i = 0; i < rows; i++) {
        if (!strcmp(errors[i].light, light) && !strcmp(errors[i].method, method))
            return errors[i].rmse;
    }
    fail_msg("no row %s, %s", light, method);
    return 0;
}

static void light_is_near_the_truth(void **state) {
    (void)state;
    masu_bake_content c = room(false);
    masu_bake_probe_settings s = settings(0);
    masu_bake_probe_report report;
    masu_bake_probe_error errors[MASU_BAKE_PROBE_ERRORS];
    masu_bake_trace *trace = masu_bake_trace_make(&c);
    assert_non_null(trace);
    assert_true(masu_bake_make_probes(&c, &s, trace, &report));
    uint32_t rows = masu_bake_judge_probes(&c, &s, trace, 128, 1024, errors);
    static const struct {
        const char *light;
        double most, better; /* lower than without probes, by this factor */
    } bounds[] = {{"sky", 0.25, 4}, {"sun, first baked", 0.3, 3}, {"sun, in between", 0.35, 3}};
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        double probes = error_of(errors, rows, bounds[i].light, "probes, as baked");
        double plain = error_of(errors, rows, bounds[i].light, "sky's harmonics, nothing between");
        print_message("%-18s %.3f, without probes %.3f\n", bounds[i].light, probes, plain);
        assert_true(probes < bounds[i].most);
        assert_true(probes * bounds[i].better < plain);
    }
    masu_bake_trace_release(trace);
    masu_bake_content_release(&c);
}

/* Mean light on the floor behind the wall, relative to the floor in front. */
static double leak(uint32_t visibility) {
    masu_bake_content c = room(true);
    masu_bake_probe_settings s = settings(0);
    masu_bake_probe_report report;
    s.visibility = visibility;
    bake_room(&c, &s, &report);
    const masu_blob_probes *p = MASU_BAKE_ARRAY(&c, MASU_BLOB_PROBES, const masu_blob_probes);
    const uint32_t *data = MASU_BAKE_ARRAY(&c, MASU_BLOB_PROBE_DATA, const uint32_t);
    uint32_t *lit = malloc(report.probes * MASU_PROBE_LIT_WORDS * sizeof *lit);
    masu_probe_sky sky = {.sky = {{3.5449077f, 3.5449077f, 3.5449077f}},
                          .sun_direction = {0, 1, 0}};
    masu_probe_light(p, data, &sky, lit);
    double sum[2] = {0, 0};
    for (int side = 0; side < 2; side++) {
        for (int x = 0; x < 16; x++) {
            for (int z = 1; z <= 6; z++) {
                const float up[3] = {0, 1, 0};
                float got[3], at[3] = {(float)x * 0.2f - 1.5f, 0, 0.1f + 0.05f * (float)z};
                if (side) at[2] = -at[2];
                masu_probe_lookup(p, data, lit, at, up, got);
                sum[side] += (double)got[1];
            }
        }
    }
    free(lit);
    masu_bake_content_release(&c);
    return sum[1] / sum[0];
}

static void walls_keep_light_out(void **state) {
    (void)state;
    double with = leak(8), without = leak(0);
    print_message("light on the floor behind a wall: %.3f of that before it, without maps %.3f\n",
                  with, without);
    assert_true(with < 0.1);
    assert_true(with * 2 < without);
}

/* Weights of the baked suns: 1 at each, linear along the arc, continuous for any direction. */
static void suns_blend_smoothly(void **state) {
    (void)state;
    masu_bake_content c = room(false);
    masu_bake_probe_settings s = settings(1);
    masu_bake_probe_report report;
    s.rays = 16;
    s.suns = 5;
    for (int i = 0; i < 5; i++) {
        double a = (20 + 35 * i) * MASU_BAKE_PI / 180;
        s.sun[i][0] = (float)cos(a);
        s.sun[i][1] = (float)(sin(a) * 0.8);
        s.sun[i][2] = (float)(sin(a) * 0.6);
    }
    bake_room(&c, &s, &report);
    const masu_blob_probes *p = MASU_BAKE_ARRAY(&c, MASU_BLOB_PROBES, const masu_blob_probes);
    float w[MASU_PROBE_SUNS_MAX], before[MASU_PROBE_SUNS_MAX];
    for (int i = 0; i < 5; i++) {
        masu_probe_sun_weights(p, p->sun_direction[i], w);
        for (int k = 0; k < 16; k++) assert_float_equal(w[k], k == i, 2e-3);
    }
    for (int step = 0; step <= 3600; step++) {
        double a = step * MASU_BAKE_PI / 1800, sum = 0;
        const float d[3] = {(float)cos(a), (float)(sin(a) * 0.8), (float)(sin(a) * 0.6)};
        masu_probe_sun_weights(p, d, w);
        for (int k = 0; k < 16; k++) {
            assert_true(w[k] >= 0 && w[k] <= 1.001f);
            if (step) assert_float_equal(w[k], before[k], 0.03);
            sum += (double)w[k];
        }
        if (step >= 200 && step <= 1600) assert_float_equal(sum, 1, 1e-3);
        memcpy(before, w, sizeof w);
    }
    masu_bake_content_release(&c);
}

/* Half floats as the format defines them. */
static void halfs_round_to_the_nearest(void **state) {
    (void)state;
    for (uint32_t h = 0; h < 0x7C00; h++) {
        assert_int_equal(masu_probe_pack(masu_probe_half(h), 0), h);
        if (h) assert_int_equal(masu_probe_pack(-masu_probe_half(h), 0), h | 0x8000u);
        if (h + 1 >= 0x7C00) continue;
        float a = masu_probe_half(h), b = masu_probe_half(h + 1), middle = (a + b) / 2;
        assert_int_equal(masu_probe_pack(middle, 0), h & 1 ? h + 1 : h);
        assert_int_equal(masu_probe_pack(nextafterf(middle, b), 0), h + 1);
        assert_int_equal(masu_probe_pack(nextafterf(middle, a), 0), h);
    }
    assert_int_equal(masu_probe_pack(INFINITY, -1e30f), 0xFBFF7BFFu);
    assert_int_equal(masu_probe_pack(NAN, 1), 0x3C000000u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_what_is_there),
        cmocka_unit_test(rays_meet_the_sdf_too),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(nothing_in_the_way_leaves_the_sky),
        cmocka_unit_test(light_is_near_the_truth),
        cmocka_unit_test(walls_keep_light_out),
        cmocka_unit_test(suns_blend_smoothly),
        cmocka_unit_test(halfs_round_to_the_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
