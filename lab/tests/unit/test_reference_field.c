/* test_reference_field.c: distances of fields of the reference path tracer: a GLSL source,
 * blocks of GLSL in a .sdf source, reports of mistakes; also its ambient occlusion, and parts that
 * emit light. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lab/reference/tracer.h"
#include "support/files.h"

/* A scene of that source, with the parameter "radius" of 0.75. */
static void blob_of(uint32_t parts, ref_blob *blob) {
    static masu_blob_sdf sdf;
    static masu_blob_sdf_param param;
    static const char names[] = "\0radius";
    sdf = (masu_blob_sdf){.bounds_min = {-9, -9, -9},
                          .bounds_max = {9, 9, 9},
                          .lipschitz = 2,
                          .max_distance = 50,
                          .part_count = parts};
    param = (masu_blob_sdf_param){.value = 0.75f, .minimum = 0, .maximum = 2, .name = 1};
    memset(blob, 0, sizeof *blob);
    blob->section[MASU_BLOB_SDF] = &sdf;
    blob->section[MASU_BLOB_SDF_PARAMS] = &param;
    blob->section[MASU_BLOB_NAMES] = names;
    blob->count[MASU_BLOB_SDF] = blob->count[MASU_BLOB_SDF_PARAMS] = 1;
}

static bool open(const char *file, const char *text, uint32_t parts, double time, ref_field *f,
                 char error[1024]) {
    ref_blob blob;
    blob_of(parts, &blob);
    write_text(file, text);
    return ref_field_open(in_scratch(file), &blob, time, f, error, 1024);
}

static ref_vec any_point(int i) {
    return ref_v(4 * sin(1.7 * i), 4 * sin(2.3 * i + 1), 4 * sin(3.1 * i + 2));
}

static double sphere(ref_vec p, ref_vec c, double radius) {
    return ref_length(ref_sub(p, c)) - radius;
}

/* Twice the distance to a mirrored sphere that rises with time, written with features that C++
 * lacks or has in another form: swizzles, matrices, vector comparisons, arrays, out parameters,
 * globals, files. */
static const char glsl[] =
    "#include \"half.glsl\"\n"
    "vec3 shift = vec3(0.0);\n"
    "struct ball { vec3 at; float r; };\n"
    "void place(out ball b) { b.at.xy = vec2(1.0, masu_time()); b.at.z = 0.0;\n"
    "    b.r = masu_param(MASU_PARAM_RADIUS); }\n"
    "float masu_sdf(vec3 p) {\n"
    "    masu_terms_begin();\n"
    "    const float weights[] = float[](0.25, 0.75, 1.0);\n"
    "    ball b; place(b); shift.zx += vec2(0.5, 0.0);\n"
    "    p.z -= shift.z; shift = vec3(0.0);\n"
    "    p = any(lessThan(p.xz, vec2(0.0)).xx) ? vec3(-p.x, p.yz) : p;\n"
    "    mat3 turn = mat3(0, 1, 0, -1, 0, 0, 0, 0, 1);\n"
    "    float d = 0.0;\n"
    "    for (int i = 0; i < 3; i++) d += weights[i] * half_of(length(turn * (p - b.at)) - b.r);\n"
    "    masu_term_joined(1, 0u, 1e30, d, 0.0); masu_terms_end();\n"
    "    return masu_term(1) ? d * 2.0 : 0.0;\n"
    "}\n"
    "void masu_sdf_surface(vec3 p, inout masu_surface s) {\n"
    "    s.albedo = mix(vec3(0.2), masu_normal * 0.5 + 0.5, step(p.y, 100.0));\n"
    "    s.roughness = masu_sqrt(0.0625);\n"
    "    s.emissive = vec3(masu_exp2(3.0), masu_rcp(0.0), masu_pow(2.0, 2.0));\n"
    "}\n";

static void a_source_of_glsl_is_the_distance_that_it_computes(void **state) {
    (void)state;
    char error[1024];
    ref_field f;
    write_text("half.glsl", "float half_of(float x) { return 0.5 * x; }\n");
    if (!open("ball.glsl", glsl, 1, 0.3, &f, error)) fail_msg("%s", error);
    for (int i = 0; i < 200; i++) {
        ref_vec p = any_point(i);
        double expected = 2 * sphere(ref_v(fabs(p.x), p.y, p.z), ref_v(1, 0.3, 0.5), 0.75);
        double found = ref_field_distance(&f, p);
        /* In doubles, also the time of 0.3: floats would only reach 1e-6. */
        if (!(fabs(found - expected) < 1e-12))
            fail_msg("at %g %g %g: %.17g, expected %.17g", p.x, p.y, p.z, found, expected);
    }
    double t = ref_field_trace(&f, ref_v(1, 0.3, 8), ref_v(0, 0, -1), HUGE_VAL);
    assert_true(fabs(t - (8 - 0.5 - 0.75)) < 1e-6);
    ref_vec hit = ref_v(1, 0.3, 8 - t), n = ref_field_normal(&f, hit);
    assert_true(fabs(n.z - 1) < 1e-9);
    ref_surface s;
    ref_field_surface(&f, hit, n, &s);
    assert_true(fabs(s.albedo.z - 1) < 1e-9 && fabs(s.albedo.x - 0.5) < 1e-6);
    assert_true(fabs(s.roughness - 0.25) < 1e-12 && !(s.metallic > 0)); /* the default */
    assert_true(fabs(s.emissive.x - 8) < 1e-12 && !(s.emissive.y > 0) &&
                fabs(s.emissive.z - 4) < 1e-12);
    ref_field_close(&f);
}

static void blocks_of_glsl_are_parts_like_any_other(void **state) {
    (void)state;
    static const char sdf[] =
        "param radius = 0.75 [0, 2];\n"
        "material red { albedo (1, 0, 0); roughness 0.3 }\n"
        "material blue { albedo (0, 0, 1) }\n"
        "part a : red = translate((2, time, 0), glsl { return 2.0 * (length(p) - "
        "masu_param(MASU_PARAM_RADIUS)); } bounds (-1, -1, -1), (1, 1, 1) lipschitz 2);\n"
        "part b : blue = translate((-3, 0, 0), sphere(1));\n";
    char error[1024];
    ref_field f;
    ref_surface s;
    if (!open("blocks.sdf", sdf, 2, 0.3, &f, error)) fail_msg("%s", error);
    for (int i = 0; i < 200; i++) {
        ref_vec p = any_point(i);
        double b = sphere(p, ref_v(-3, 0, 0), 1), a = 2 * sphere(p, ref_v(2, 0.3, 0), 0.75);
        /* A block is intersected with its bounds. */
        ref_vec q = ref_sub(p, ref_v(2, 0.3, 0));
        ref_vec out = ref_v(fmax(fabs(q.x) - 1, 0), fmax(fabs(q.y) - 1, 0), fmax(fabs(q.z) - 1, 0));
        a = fmax(a, 2 * ref_length(out));
        double found = ref_field_distance(&f, p);
        if (!(fabs(found - fmin(a, b)) < 1e-6)) /* the part's 1 / L is a float */
            fail_msg("at %g %g %g: %.9g, expected %.9g", p.x, p.y, p.z, found, fmin(a, b));
    }
    double t = ref_field_trace(&f, ref_v(2, 0.3, 8), ref_v(0, 0, -1), HUGE_VAL);
    assert_true(fabs(t - 7.25) < 1e-6);
    ref_field_surface(&f, ref_v(2, 0.3, 8 - t), ref_v(0, 0, 1), &s);
    assert_true(fabs(s.albedo.x - 1) < 1e-9 && fabs(s.roughness - 0.3) < 1e-6);
    ref_field_surface(&f, ref_v(-3, 1, 0), ref_v(0, 1, 0), &s);
    assert_true(fabs(s.albedo.z - 1) < 1e-9);
    ref_field_close(&f);
}

static void a_mistake_is_reported_with_its_line(void **state) {
    (void)state;
    char error[1024];
    ref_field f;
    assert_false(
        open("bad.glsl", "\nfloat masu_sdf(vec3 p) { return lenght(p); }\n", 1, 0, &f, error));
    assert_non_null(strstr(error, "bad.glsl:2:"));
    assert_non_null(strstr(error, "lenght"));
    assert_null(strchr(error, '\n'));
}

/* The light of a floor from a uniform environment, divided by the light without ambient
 * occlusion. */
static double open_share(ref_tracer *t, double all, double field, double strength) {
    enum { PATHS = 16000 };
    double sum[2] = {0};
    for (int k = 0; k < 2; k++) {
        uint64_t paths = k && all > 0 && field > all ? PATHS / 16 : PATHS; /* each traces 16 rays */
        t->occlusion_radius = k ? all : 0;
        t->field_occlusion_radius = k ? field : 0;
        t->field_occlusion_strength = strength;
        for (uint64_t i = 0; i < paths; i++) {
            ref_random r = ref_random_at(1, 0, i);
            sum[k] += ref_radiance(t, ref_v(0, -1, 0), &r).x;
        }
        sum[k] /= (double)paths;
    }
    return sum[1] / sum[0];
}

/* A ceiling at the height a R occludes directions with cos > a by 1 - a / cos each; weighted by the
 * cosine, (1 - a)^2 in total. */
static void a_ceiling_occludes_by_a_closed_form(void **state) {
    (void)state;
    static const char sdf[] = "param radius = 0.75 [0, 2];\n"
                              "part floor = plane((0, 1, 0), 0);\n"
                              "part roof = translate((0, 2, 0), box((9, 1, 9)));\n";
    char error[1024];
    ref_field f;
    ref_scene scene;
    ref_world world;
    masu_blob_environment environment;
    ref_sky sky = {.zenith = {1, 1, 1}, .horizon = {1, 1, 1}, .ambient = {1, 1, 1}};
    memset(&scene, 0, sizeof scene);
    memset(&environment, 0, sizeof environment);
    if (!open("roof.sdf", sdf, 2, 0, &f, error)) fail_msg("%s", error);
    assert_true(ref_world_open(&scene, &f, ref_v(0, 0.5, 0), &world, error, sizeof error));
    ref_tracer t = {.world = &world,
                    .sky = &sky,
                    .bsdf_samples = true,
                    .sun_direction = {0, 1, 0},
                    .eye = {0, 0.5, 0},
                    .environment = &environment};
    /* Radii for all surfaces and for the field, its strength; the remaining light. */
    const double rows[][4] = {{0, 2, 1, 0.75},   {0, 4, 1, 0.4375}, {0, 2, 0.4, 0.9},
                              {0, 0.9, 1, 1},    {4, 0, 1, 0.4375}, {4, 2, 1, 0.4375},
                              {2, 4, 1, 0.4375}, {2, 4, 0.2, 0.75}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double found = open_share(&t, rows[i][0], rows[i][1], rows[i][2]);
        if (!(fabs(found - rows[i][3]) < 0.01))
            fail_msg("radii %g, %g, strength %g: %g is left, expected %g", rows[i][0], rows[i][1],
                     rows[i][2], found, rows[i][3]);
    }
    ref_world_close(&world);
    ref_field_close(&f);
}

/* The light of a ball of radius 0.5, 2 m above a white floor, and of a tube: by samples of the
 * lamp, of the scattered ray, and of both. */
static void parts_that_emit_are_found(void **state) {
    (void)state;
    static const char *const shapes[2] = {"translate((0, 2, 0), sphere(0.5))",
                                          "capsule((-0.6, 1, 0.2), (0.5, 1.3, 0.2), 0.04)"};
    static const double high[6][2] = {{0, 1.9635}, {.5, 1.7928}, {1, 1.4050},
                                      {2, .6942},  {4, .1756},   {8, .02801}};
    for (int kind = 0; kind < 2; kind++) {
        char text[512], error[1024];
        ref_field f;
        ref_scene scene;
        ref_world world;
        ref_sky sky = {.ambient = {0, 0, 0}};
        masu_blob_environment environment;
        snprintf(text, sizeof text,
                 "param radius = 0.75 [0, 2];\n"
                 "material white { albedo 1; roughness 1 }\n"
                 "material glow { albedo 0; roughness 1; emissive 10 }\n"
                 "part floor : white = plane((0, 1, 0), 0);\n"
                 "part lamp : glow = %s;\n",
                 shapes[kind]);
        memset(&scene, 0, sizeof scene);
        memset(&environment, 0, sizeof environment);
        if (!open("lamp.sdf", text, 2, 0, &f, error)) fail_msg("%s", error);
        assert_int_equal(f.emitter_count, 1);
        assert_true(ref_world_open(&scene, &f, ref_v(0, 0.5, 0), &world, error, sizeof error));
        ref_tracer t = {.world = &world,
                        .sky = &sky,
                        .physics = true,
                        .full = true,
                        .bounces = 1,
                        .sun_direction = {0, 1, 0},
                        .environment = &environment};
        for (int i = 0; i < (kind ? 3 : 6); i++) {
            double mean[3], deviation[3];
            for (int way = 0; way < 3; way++) {
                double sum = 0, square = 0, x = kind ? .7 * i - .5 : high[i][0];
                const int paths = way == 1 ? 60000 : 10000;
                const ref_hit at = {.p = {x, 0, 0}, .ng = {0, 1, 0}, .triangle = REF_SDF};
                t.light_samples = way != 1;
                t.bsdf_samples = way != 0;
                for (int k = 0; k < paths; k++) {
                    ref_random r = ref_random_at(5, (uint64_t)i, (uint64_t)k);
                    double value = ref_irradiance(&t, &at, &r).x;
                    sum += value;
                    square += value * value;
                }
                mean[way] = sum / paths;
                deviation[way] = sqrt(fmax(square / paths - mean[way] * mean[way], 0) / paths);
            }
            double expected = kind ? mean[1] : high[i][1], most = kind ? 4 * deviation[1] : 0;
            for (int way = 0; way < 3; way++) {
                if (!(fabs(mean[way] - expected) <=
                      fmax(.004 * expected, most + 4 * deviation[way])))
                    fail_msg("%d, place %d, way %d: %g +- %g, expected %g", kind, i, way, mean[way],
                             deviation[way], expected);
            }
            assert_true(deviation[2] < .03 * mean[2]); /* of 10,000 paths */
        }
        ref_world_close(&world);
        ref_field_close(&f);
    }
}

int main(void) {
    ref_ggx_tables();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_source_of_glsl_is_the_distance_that_it_computes),
        cmocka_unit_test(blocks_of_glsl_are_parts_like_any_other),
        cmocka_unit_test(a_ceiling_occludes_by_a_closed_form),
        cmocka_unit_test(parts_that_emit_are_found),
        cmocka_unit_test(a_mistake_is_reported_with_its_line),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
