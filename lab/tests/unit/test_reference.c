/* test_reference.c: the reference path tracer (lab/reference) against closed forms and tabulated
 * integrals: it has to be verified before the renderer is compared with it. Expected values are
 * quadratures or formulas that use none of its code. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lab/reference/fog.h"
#include "lab/reference/render.h"
#include "measure/patches.h"
#include "support/files.h"

/* Within 0.3 % or three standard errors. */
static void check(double found, double expected, double error, const char *what) {
    double most = fmax(0.003 * fabs(expected), 3 * error);
    if (!(fabs(found - expected) <= most))
        fail_msg("%s: found %.5f +- %.5f, expected %.5f", what, found, error, expected);
}

/* ---- Small scenes ---------------------------------------------------------------------------- */

enum { VERTICES = 60000 };
typedef struct stage {
    ref_scene scene;
    ref_world world;
    ref_sky sky;
    ref_tracer tracer;
    ref_vec positions[VERTICES], normals[VERTICES];
    ref_triangle triangles[VERTICES];
    ref_material materials[4];
    ref_emitter emitters[VERTICES];
    double pdf[VERTICES];
    masu_blob_environment environment;
} stage;

static stage *clear(void) {
    static stage s;
    memset(&s, 0, sizeof s);
    s.scene = (ref_scene){.positions = s.positions,
                          .normals = s.normals,
                          .triangles = s.triangles,
                          .materials = s.materials,
                          .emitters = s.emitters,
                          .emitter_pdf = s.pdf,
                          .environment = &s.environment};
    for (int i = 0; i < 4; i++)
        s.materials[i] =
            (ref_material){.base = ref_splat(1), .roughness = 1, .opacity = 1, .detail = {1, 1}};
    s.tracer = (ref_tracer){.world = &s.world,
                            .sky = &s.sky,
                            .physics = true,
                            .full = true,
                            .polygons_shadow = true,
                            .sky_samples = true,
                            .light_samples = true,
                            .bsdf_samples = true,
                            .bounces = 1,
                            .sun_direction = {0, 1, 0},
                            .environment = &s.environment};
    return &s;
}

/* A quadrilateral; its normal follows from counter-clockwise corners. */
static void quad(stage *s, ref_vec a, ref_vec b, ref_vec c, ref_vec d, uint32_t material) {
    ref_vec corners[4] = {a, b, c, d}, n = ref_unit(ref_cross(ref_sub(b, a), ref_sub(c, a)));
    uint32_t first = (uint32_t)s->scene.vertex_count;
    for (int i = 0; i < 4; i++) {
        s->positions[first + (uint32_t)i] = corners[i];
        s->normals[first + (uint32_t)i] = n;
    }
    s->scene.vertex_count += 4;
    s->triangles[s->scene.triangle_count++] =
        (ref_triangle){{first, first + 1, first + 2}, material};
    s->triangles[s->scene.triangle_count++] =
        (ref_triangle){{first, first + 2, first + 3}, material};
}

static void sphere(stage *s, ref_vec center, double radius, uint32_t rings, uint32_t material) {
    uint32_t segments = 2 * rings, first = (uint32_t)s->scene.vertex_count;
    /* Enlarged, so that it is on average as large as the sphere. */
    double wide = radius * (1 + 0.7 * REF_PI * REF_PI / (6.0 * rings * rings));
    for (uint32_t i = 0; i <= rings; i++) {
        for (uint32_t k = 0; k < segments; k++) {
            double polar = REF_PI * i / rings, phi = 2 * REF_PI * k / segments;
            ref_vec n = ref_v(sin(polar) * cos(phi), cos(polar), sin(polar) * sin(phi));
            s->positions[s->scene.vertex_count] = ref_along(center, wide, n);
            s->normals[s->scene.vertex_count++] = n;
        }
    }
    for (uint32_t i = 0; i < rings; i++) {
        for (uint32_t k = 0; k < segments; k++) {
            uint32_t a = first + i * segments + k, b = first + i * segments + (k + 1) % segments;
            if (i)
                s->triangles[s->scene.triangle_count++] =
                    (ref_triangle){{a, b, a + segments}, material};
            if (i + 1 < rings)
                s->triangles[s->scene.triangle_count++] =
                    (ref_triangle){{b, b + segments, a + segments}, material};
        }
    }
}

static void set_up(stage *s) {
    char error[256];
    double sum = 0;
    for (uint64_t i = 0; i < s->scene.triangle_count; i++) {
        const ref_triangle *t = &s->triangles[i];
        double power = ref_luminance(s->materials[t->material].emissive);
        ref_vec a = s->positions[t->vertex[0]];
        double area = ref_length(ref_cross(ref_sub(s->positions[t->vertex[1]], a),
                                           ref_sub(s->positions[t->vertex[2]], a))) /
                      2;
        if (!(power > 0)) continue;
        sum += power * area;
        s->pdf[i] = power;
        s->emitters[s->scene.emitter_count++] = (ref_emitter){(uint32_t)i, area, sum};
    }
    for (uint32_t i = 0; i < s->scene.emitter_count; i++) {
        s->emitters[i].cumulative /= sum;
        s->pdf[s->emitters[i].triangle] /= sum;
    }
    assert_true(ref_world_open(&s->scene, NULL, ref_splat(0), &s->world, error, sizeof error));
    assert_true(ref_sky_prepare(&s->sky));
}

static void take_down(stage *s) {
    ref_world_close(&s->world);
    ref_sky_close(&s->sky);
}

/* Mean radiance of paths from `from` towards `to`. */
static double seen(stage *s, ref_vec from, ref_vec to, int paths, double *error) {
    double sum = 0, square = 0;
    s->tracer.eye = from;
    for (int i = 0; i < paths; i++) {
        ref_random r = ref_random_at(3, 1, (uint64_t)i);
        double value = ref_radiance(&s->tracer, ref_unit(ref_sub(to, from)), &r).x;
        sum += value;
        square += value * value;
    }
    double mean = sum / paths;
    *error = sqrt(fmax(square / paths - mean * mean, 0) / paths);
    return mean;
}

static const double tilts[7] = {0, 30, 45, 60, 90, 120, 180};

/* A matt square whose normal is tilted from +Y, viewed along its normal. */
static double tilted_square(stage *s, double degrees, int paths, double *error) {
    double a = degrees * REF_PI / 180;
    ref_vec n = ref_v(sin(a), cos(a), 0), side = ref_v(cos(a), -sin(a), 0), z = ref_v(0, 0, 1);
    s->scene.vertex_count = s->scene.triangle_count = 0;
    quad(s, ref_add(side, z), ref_sub(side, z), ref_sub(ref_scale(side, -1), z), ref_sub(z, side),
         0);
    set_up(s);
    double found = seen(s, ref_scale(n, 2), ref_splat(0), paths, error);
    take_down(s);
    return found;
}

static void matt_surfaces_under_skies(void **state) {
    (void)state;
    static const double expected[3][7] = {{.8000, .7165, .6290, .5248, .3051, .1248, 0},
                                          {.6667, .5872, .5036, .4060, .2122, .0727, 0},
                                          {1, .9330, .8536, .75, .5, .25, 0}};
    enum { W = 64, H = 256 };
    static float sky[3 * W * H];
    for (int kind = 0; kind < 3; kind++) {
        stage *s = clear();
        if (kind == 0) s->sky.zenith = ref_splat(1);
        if (kind > 0) {
            for (int i = 0; i < 3 * W * H; i++) {
                double up = cos(REF_PI * (i / (3 * W) + 0.5) / H);
                sky[i] = kind == 1 ? (float)fmax(up, 0) : up > 0 ? 1.0f : 0.0f;
            }
            s->sky = (ref_sky){.panorama = sky, .width = W, .height = H, .factor = 1};
        }
        for (int i = 0; i < 7; i++) {
            double error, found = tilted_square(s, tilts[i], kind == 0 ? 40000 : 6000, &error);
            /* A bilinear lookup changes a step between two rows of the image to a ramp as wide as
             * a row. */
            check(found, expected[kind][i], fmax(error, kind ? 2e-4 : 1e-5),
                  "irradiance under a sky");
        }
    }
}

static void a_map_is_sampled_as_it_is_looked_up(void **state) {
    (void)state;
    enum { W = 16, H = 8 };
    static float maps[3][3 * W * H];
    for (int i = 0; i < 3; i++) maps[0][i] = 1;
    for (int i = 0; i < 3; i++)
        maps[1][3 * (1 * W + 5) + i] = 100;         /* one pixel, its row at 34 degrees */
    for (int i = 0; i < 3 * W; i++) maps[2][i] = 1; /* the top row */
    for (int m = 0; m < 3; m++) {
        for (int rough = 0; rough < 2; rough++) {
            double found[3], error[3];
            for (int way = 0; way < 3; way++) {
                stage *s = clear();
                s->sky = (ref_sky){.panorama = maps[m],
                                   .width = m ? W : 1,
                                   .height = m ? H : 1,
                                   .factor = 1,
                                   .turn = 0.7};
                s->tracer.physics = false;
                s->tracer.bsdf_samples = way != 1;
                s->tracer.sky_samples = way != 0;
                if (rough) s->materials[0].metallic = 1, s->materials[0].roughness = 0.6;
                found[way] = tilted_square(s, 20, m ? 60000 : 20000, &error[way]);
            }
            check(found[0], found[2], 1.2 * hypot(error[0], error[2]), "BSDF samples beside both");
            check(found[1], found[2], 1.2 * hypot(error[1], error[2]), "map samples beside both");
            if (!m) check(found[2], 1, error[2], "a sky of one pixel");
            assert_true(found[2] > 0);
        }
    }
}

static void ground(stage *s) {
    quad(s, ref_v(-20, 0, 20), ref_v(20, 0, 20), ref_v(20, 0, -20), ref_v(-20, 0, -20), 0);
}

static void area_lights(void **state) {
    (void)state;
    static const double high[6][2] = {{0, 1.9635}, {.5, 1.7928}, {1, 1.4050},
                                      {2, .6942},  {4, .1756},   {8, .02801}};
    static const double low[4][2] = {{.6, 8.1849}, {1, 1.9680}, {2, .2600}, {4, .03298}};
    static const double square[6][3] = {{0, 0, 6.5682}, {.5, 0, 5.9743}, {1, 0, 4.4310},
                                        {2, 0, 1.4729}, {0, 1, 3.6803},  {2, 2, .4766}};
    for (int kind = 0; kind < 3; kind++) {
        stage *s = clear();
        ground(s);
        s->materials[1].base = ref_splat(0);
        s->materials[1].emissive = ref_splat(10);
        if (kind < 2) sphere(s, ref_v(0, kind ? .25 : 2, 0), .5, 64, 1);
        if (kind == 2)
            quad(s, ref_v(-1, 1.5, -.5), ref_v(1, 1.5, -.5), ref_v(1, 1.5, .5), ref_v(-1, 1.5, .5),
                 1);
        set_up(s);
        for (int i = 0; i < (kind == 1 ? 4 : 6); i++) {
            double error,
                x = kind == 2 ? square[i][0]
                    : kind    ? low[i][0]
                              : high[i][0],
                z = kind == 2 ? square[i][1] : 0;
            double expected = kind == 2 ? square[i][2] : kind ? low[i][1] : high[i][1];
            /* From the side, below the light. */
            double found = seen(s, ref_v(x, .05, z + 3), ref_v(x, 0, z), 20000, &error);
            check(found * REF_PI, expected, error * REF_PI, "irradiance from an area light");
        }
        take_down(s);
    }
}

/* Lights without triangles: the same irradiance from both sampling strategies. */
static void local_lights_have_a_size(void **state) {
    (void)state;
    static const double high[3][2] = {{0, 1.9635}, {1, 1.4050}, {4, .1756}};
    static const double square[3][2] = {{0, 6.5682}, {1, 4.4310}, {2, 1.4729}};
    ref_light lights[] = {{.type = MASU_LIGHT_SPHERE,
                           .color = ref_splat(10),
                           .radius = .5,
                           .position = ref_v(0, 2, 0)},
                          {.type = MASU_LIGHT_POINT,
                           .color = ref_splat(2.5),
                           .radius = .5,
                           .position = ref_v(0, 2, 0)},
                          {.type = MASU_LIGHT_CAPSULE,
                           .color = ref_splat(10),
                           .radius = .5,
                           .position = ref_v(0, 2, 0),
                           .direction = ref_v(1e-4, 0, 0)},
                          {.type = MASU_LIGHT_RECTANGLE,
                           .color = ref_splat(10),
                           .radius = .01,
                           .position = ref_v(0, 1.5, 0),
                           .direction = ref_v(1, 0, 0),
                           .half_axis = ref_v(0, 0, .5)}};
    for (int kind = 0; kind < 4; kind++) {
        lights[kind].range = 1e9;
        lights[kind].outer = -1;
        stage *s = clear();
        ground(s);
        s->scene.lights = &lights[kind];
        s->scene.light_count = 1;
        set_up(s);
        for (int i = 0; i < 6; i++) {
            const double *at = kind == 3 ? square[i / 2] : high[i / 2];
            double error;
            s->tracer.bsdf_samples = i % 2 == 0;
            double found = seen(s, ref_v(at[0], .05, 3), ref_v(at[0], 0, 0), 20000, &error);
            check(found * REF_PI, at[1], error * REF_PI, "irradiance from a local light");
        }
        s->scene.lights = NULL;
        s->scene.light_count = 0;
        take_down(s);
    }
}

static void a_closed_box_is_a_geometric_series(void **state) {
    (void)state;
    static const uint32_t bounces[5] = {0, 1, 2, 4, 8};
    for (int m = 0; m < 2; m++) {
        double rho = m ? .8 : .5;
        stage *s = clear();
        s->materials[0].base = ref_splat(rho);
        s->materials[0].emissive = ref_splat(1);
        ref_vec c[8];
        for (int i = 0; i < 8; i++) c[i] = ref_v(i & 1 ? 1 : -1, i & 2 ? 2 : -1, i & 4 ? 1 : -1);
        quad(s, c[0], c[1], c[3], c[2], 0);
        quad(s, c[4], c[6], c[7], c[5], 0);
        quad(s, c[0], c[4], c[5], c[1], 0);
        quad(s, c[2], c[3], c[7], c[6], 0);
        quad(s, c[0], c[2], c[6], c[4], 0);
        quad(s, c[1], c[5], c[7], c[3], 0);
        set_up(s);
        for (int i = 0; i < 5; i++) {
            double error;
            s->tracer.bounces = bounces[i];
            double found = seen(s, ref_v(.1, .2, .3), ref_v(.5, -.9, .2), 10000, &error);
            check(found, (1 - pow(rho, bounces[i] + 1.0)) / (1 - rho), error, "closed box");
        }
        take_down(s);
    }
}

/* Below a roof with a square hole of 1 m at a height of 1 m, under a sky of radiance 1: the
 * irradiance equals that from a square lamp. */
static void a_window_to_the_sky_is_found(void **state) {
    (void)state;
    double error[2];
    for (int way = 0; way < 2; way++) {
        stage *s = clear();
        s->materials[0].base = ref_splat(0);
        s->sky = (ref_sky){.zenith = {1, 1, 1}, .horizon = {1, 1, 1}, .ambient = {1, 1, 1}};
        quad(s, ref_v(-99, 1, -99), ref_v(99, 1, -99), ref_v(99, 1, -.5), ref_v(-99, 1, -.5), 0);
        quad(s, ref_v(-99, 1, .5), ref_v(99, 1, .5), ref_v(99, 1, 99), ref_v(-99, 1, 99), 0);
        quad(s, ref_v(-99, 1, -.5), ref_v(-.5, 1, -.5), ref_v(-.5, 1, .5), ref_v(-99, 1, .5), 0);
        quad(s, ref_v(.5, 1, -.5), ref_v(99, 1, -.5), ref_v(99, 1, .5), ref_v(.5, 1, .5), 0);
        if (way) s->tracer.window = (ref_light_box){{-.55, .98, -.5}, {.5, 1.03, .5}, 1};
        set_up(s);
        const ref_hit at = {.p = {0, 0, 0}, .ng = {0, 1, 0}};
        double sum = 0, square = 0;
        const int paths = 20000;
        for (int i = 0; i < paths; i++) {
            ref_random r = ref_random_at(3, 1, (uint64_t)i);
            double value = ref_irradiance(&s->tracer, &at, &r).x;
            sum += value;
            square += value * value;
        }
        error[way] = sqrt((square / paths - sum / paths * sum / paths) / paths);
        double x = .5, q = sqrt(1 + x * x), expected = 4 * x / q * atan(x / q);
        check(sum / paths, expected, error[way], "irradiance through a window");
        take_down(s);
    }
    assert_true(error[1] < error[0] / 3);
}

/* By samples of the lamp, of the scattered ray, and of both. */
static void panes_dim_the_light_of_lamps(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        stage *s = clear();
        double error;
        ground(s);
        s->materials[1].base = s->materials[2].base = ref_splat(0);
        s->materials[1].emissive = ref_splat(10);
        s->materials[2].flags = MASU_MATERIAL_IS_BLEND;
        s->materials[2].opacity = .4;
        quad(s, ref_v(-1, 1.5, -.5), ref_v(1, 1.5, -.5), ref_v(1, 1.5, .5), ref_v(-1, 1.5, .5), 1);
        quad(s, ref_v(-9, 1, -9), ref_v(9, 1, -9), ref_v(9, 1, 9), ref_v(-9, 1, 9), 2);
        s->scene.blends = true;
        s->tracer.light_samples = kind != 1;
        s->tracer.bsdf_samples = kind != 0;
        set_up(s);
        double found = seen(s, ref_v(0, .05, 3), ref_splat(0), 40000, &error);
        check(found * REF_PI, .6 * 6.5682, error * REF_PI, "irradiance behind a pane");
        take_down(s);
    }
}

static void fog_and_punctual_lights(void **state) {
    (void)state;
    check(ref_fog_left(.01, 0, 0, 0, 0, 100), .3679, 0, "fog");
    check(ref_fog_left(.01, 0, 0, 0, 20, 100), .4493, 0, "fog from 20 m on");
    check(ref_fog_left(.05, .2, 1.7, 0, 0, 50), .1687, 0, "level ray in height fog");
    check(ref_fog_left(.05, .2, 1.7, .3, 0, 50), .5692, 0, "rising ray");
    check(ref_fog_left(.05, .2, 10, -.3, 0, 30), .5658, 0, "falling ray");
    check(ref_fog_left(.05, .2, 1.7, .3, 5, HUGE_VAL), .6444, 0, "ray into the sky");
    assert_true(ref_fog_left(.05, 0, 1.7, .3, 0, HUGE_VAL) == 0);
    /* White plane, light at height h, range 20, radius 0.5: 4 cos / max(d^2, 0.25), with the window
     * of KHR_lights_punctual. */
    static const double points[8][3] = {{2, 0, .9999},  {2, 1, .71510},   {2, 2, .35341},
                                        {2, 4, .08922}, {2, 8, .013854},  {2, 18, .000441},
                                        {.3, 0, 16.0},  {.3, .3, 11.3137}};
    for (int i = 0; i < 8; i++) {
        ref_light light = {.position = {0, points[i][0], 0},
                           .color = {4, 4, 4},
                           .range = 20,
                           .radius = .5,
                           .outer = -1};
        ref_vec l, color = ref_light_at(&light, ref_v(points[i][1], 0, 0), &l);
        check(color.x * l.y, points[i][2], 2e-7, "point light");
    }
    static const double cone[4][2] = {{33, .685}, {36, .411}, {39, .194}, {42, .051}};
    for (int i = 0; i < 4; i++) {
        double a = cone[i][0] * REF_PI / 180, radians = REF_PI / 180;
        ref_light light = {.position = {0, 1, 0},
                           .color = {1, 1, 1},
                           .direction = {0, -1, 0},
                           .range = 1e6,
                           .radius = .01,
                           .inner = 30 * radians,
                           .outer = 45 * radians};
        ref_vec l, color = ref_light_at(&light, ref_v(tan(a), 0, 0), &l);
        check(color.x / (cos(a) * cos(a)), cone[i][1], 2e-4, "spot light");
    }
}

/* A sphere on the ground in the sun, near the origin and ten kilometres away from it. */
static void the_place_of_a_scene_does_not_matter(void **state) {
    (void)state;
    double found[2], error[2];
    for (int i = 0; i < 2; i++) {
        ref_vec away = ref_v(i * 1e4, 0, i * -7e3);
        stage *s = clear();
        quad(s, ref_add(away, ref_v(-2, 0, 2)), ref_add(away, ref_v(2, 0, 2)),
             ref_add(away, ref_v(2, 0, -2)), ref_add(away, ref_v(-2, 0, -2)), 0);
        sphere(s, ref_add(away, ref_v(0, .5, 0)), .5, 24, 1);
        s->tracer.sun_color = ref_splat(1);
        s->tracer.sun_direction = ref_unit(ref_v(1, 1, 1));
        s->tracer.bounces = 3;
        set_up(s);
        s->world.center = ref_splat(0);
        take_down(s);
        char message[256];
        ref_vec eye = ref_add(away, ref_v(0, 2, 4));
        assert_true(ref_world_open(&s->scene, NULL, eye, &s->world, message, sizeof message));
        assert_true(ref_sky_prepare(&s->sky));
        double sum = 0, square = 0;
        enum { N = 6000 };
        s->tracer.eye = eye;
        for (int n = 0; n < N; n++) {
            ref_random r = ref_random_at(4, 0, (uint64_t)n);
            double x = ref_draw(&r);
            double y = ref_draw(&r);
            ref_vec to = ref_add(away, ref_v(2 * x - 1, 0, 2 * y - 1));
            double value = ref_radiance(&s->tracer, ref_unit(ref_sub(to, eye)), &r).x;
            sum += value;
            square += value * value;
        }
        found[i] = sum / N;
        error[i] = sqrt((square / N - found[i] * found[i]) / N);
        take_down(s);
    }
    assert_true(found[0] > 0.3);
    assert_true(fabs(found[0] - found[1]) < 0.2 * error[0]); /* the same numbers are drawn */
}

static void threads_do_not_change_the_image(void **state) {
    (void)state;
    stage *s = clear();
    s->sky.zenith = ref_splat(1);
    ground(s);
    sphere(s, ref_v(0, .6, 0), .5, 16, 1);
    s->materials[1].metallic = 1;
    s->materials[1].roughness = .3;
    s->tracer.sun_color = ref_splat(1);
    s->tracer.sun_direction = ref_unit(ref_v(1, 1, 1));
    s->tracer.eye = ref_v(0, 1, 3);
    s->tracer.bounces = 4;
    set_up(s);
    ref_image images[3];
    for (uint32_t i = 0; i < 3; i++) {
        ref_render r = {.tracer = &s->tracer,
                        .camera = {s->tracer.eye, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, .5},
                        .paths = 4,
                        .threads = 1 + 2 * i,
                        .seed = 1};
        images[i] = (ref_image){32, 18, NULL, NULL};
        assert_true(ref_render_image(&r, &images[i]));
    }
    for (int i = 1; i < 3; i++) {
        assert_memory_equal(images[0].mean, images[i].mean, 3 * 32 * 18 * sizeof(float));
        assert_memory_equal(images[0].error, images[i].error, 3 * 32 * 18 * sizeof(float));
    }
    for (int i = 0; i < 3; i++) ref_image_free(&images[i]);
    take_down(s);
}

static void the_camera_is_that_of_the_renderer(void **state) {
    (void)state;
    masu_blob_camera_key keys[2] = {
        {.time = 0, .position = {0, 0, 0}, .target = {0, 0, -1}, .fov_y = 1.0f},
        {.time = 2, .position = {2, 0, 0}, .target = {2, 0, -1}, .fov_y = 1.0f}};
    ref_blob blob;
    memset(&blob, 0, sizeof blob);
    blob.section[MASU_BLOB_CAMERA_KEYS] = keys;
    blob.count[MASU_BLOB_CAMERA_KEYS] = 2;
    ref_camera c = ref_camera_at(&blob, 1);
    ref_vec d =
        ref_camera_ray(&c, 1, 0, 2); /* upper right corner of an image twice as wide as high */
    assert_true(fabs(c.eye.x - 1) < 1e-12);
    assert_true(fabs(d.x / -d.z - 2 * tan(.5)) < 1e-6 && fabs(d.y / -d.z - tan(.5)) < 1e-6);
}

/* ---- Stored references ----------------------------------------------------------------------- */

static void stored_references(void **state) {
    (void)state;
    enum { W = 128, H = 72 };
    static float pixels[3 * W * H], errors[3 * W * H];
    masu_reference r = {.width = W,
                        .height = H,
                        .command = "masu-lab reference x.masu",
                        .pixels = pixels},
                   back;
    char error[256];
    for (int i = 0; i < 3 * W * H; i++) {
        pixels[i] = (float)(i % 97) * 0.01f + (float)(i / W) * 1e-4f;
        errors[i] = 0.01f;
    }
    masu_patches_of(pixels, errors, W, H, r.patches);
    assert_true(fabs((double)r.patches[0].error[0] - 0.01 / 8) < 1e-7); /* 64 pixels */
    assert_true(masu_reference_save(in_scratch("reference.ref"), &r, error, sizeof error));
    assert_true(masu_reference_load(in_scratch("reference.ref"), &back, error, sizeof error));
    assert_memory_equal(back.patches, r.patches, sizeof r.patches);
    assert_string_equal(back.command, r.command);
    for (int i = 0; i < 3 * W * H; i++)
        assert_true(fabs((double)(back.pixels[i] - pixels[i])) <= 5e-4 * (double)pixels[i] + 1e-7);
    masu_reference_free(&back);
    static masu_patch image[MASU_PATCHES];
    masu_patches_of(pixels, NULL, W, H, image);
    masu_patch_judgement j = masu_patches_judge(r.patches, image);
    assert_true(fabs(j.ratio - 1) < 1e-9 && j.p95 == 0 && j.trimmed == 0);
    for (int i = 0; i < 3 * W * H; i++) pixels[i] *= 1.05f;
    masu_patches_of(pixels, NULL, W, H, image);
    j = masu_patches_judge(r.patches, image);
    assert_true(fabs(j.ratio - 1.05) < 1e-4 && j.p95 > .035 && j.trimmed > 1.02);
    assert_false(masu_reference_load("lab/README.md", &back, error, sizeof error));
    assert_non_null(strstr(error, "not a stored reference"));
}

int main(void) {
    ref_ggx_tables();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matt_surfaces_under_skies),
        cmocka_unit_test(a_map_is_sampled_as_it_is_looked_up),
        cmocka_unit_test(area_lights),
        cmocka_unit_test(local_lights_have_a_size),
        cmocka_unit_test(a_closed_box_is_a_geometric_series),
        cmocka_unit_test(a_window_to_the_sky_is_found),
        cmocka_unit_test(panes_dim_the_light_of_lamps),
        cmocka_unit_test(fog_and_punctual_lights),
        cmocka_unit_test(the_place_of_a_scene_does_not_matter),
        cmocka_unit_test(threads_do_not_change_the_image),
        cmocka_unit_test(the_camera_is_that_of_the_renderer),
        cmocka_unit_test(stored_references),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
