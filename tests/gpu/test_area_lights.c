/* test_area_lights.c: local lights that have a size (shaders/light/source.glsl) on the GPU, against closed
 * forms and against numerical integration of the reference surface (tests/reference/brdf.h) over the light. */
#include "reference/brdf.h"
#include "reference/vec.h"
#include "scene/punctual_light.h"
#include "split_sum.h"
#include "support/compute.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/support.h"

#include "area_lights_comp.spv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

typedef struct test_case {
    float roughness, metallic, coat, coat_roughness;
    float view[3], light;
    float point[3], albedo;
} test_case;

enum { CASES_MOST = 1 << 17, LIGHTS_MOST = 1024 };

static test_case cases[CASES_MOST];
static float results[CASES_MOST][4];
static uint32_t case_count;
static struct {
    masu_light_header header;
    struct masu_punctual_light_data lights[LIGHTS_MOST];
} lights;
static masu_punctual_light_state states[LIGHTS_MOST];
static uint32_t light_count;

static void begin(void) { case_count = light_count = 0; }

/* Returns its number. The range is so large that the window is 1. */
static uint32_t add_light(masu_punctual_light_state s) {
    double position[3], direction[3], value;
    s.range = 1e6f;
    if (!(s.radius > 0)) s.radius = 0.01f;
    for (int k = 0; k < 3; k++) {
        position[k] = s.position[k];
        direction[k] = (double)s.direction[k];
        if (!s.color[k]) s.color[k] = 1;
    }
    assert_true(light_count < LIGHTS_MOST);
    assert_null(masu_light_state_wrong(&s, &value));
    assert_true(masu_light_place(&s, position, direction, &lights.lights[light_count]));
    states[light_count] = s;
    return light_count++;
}

static test_case *add_case(uint32_t light, double roughness, double elevation, double turn) {
    assert_true(case_count < CASES_MOST);
    test_case *c = &cases[case_count++];
    *c = (test_case){.roughness = (float)roughness, .metallic = 1, .albedo = 1, .light = (float)light};
    c->view[0] = (float)(-cos(elevation) * cos(turn));
    c->view[1] = (float)(-cos(elevation) * sin(turn));
    c->view[2] = (float)sin(elevation);
    return c;
}

static test_case *add_matte(uint32_t light) {
    test_case *c = add_case(light, 1, PI / 2, 0);
    c->metallic = 0;
    return c;
}

static void run(void) {
    static uint32_t table[MASU_TABLE_WORDS_ALL];
    memcpy(table, masu_split_sum, sizeof table);
    memset(results, 0, sizeof results);
    lights.header.count = light_count;
    const compute_buffer buffers[] = {{0, cases, case_count * sizeof *cases},
                                      {1, results, case_count * sizeof *results},
                                      {MASU_BIND_TABLES, table, sizeof table},
                                      {MASU_BIND_LIGHTS, &lights, sizeof lights}};
    const uint32_t push[4] = {case_count};
    compute_run(masu_spv_area_lights_comp, sizeof masu_spv_area_lights_comp, buffers, 4, push,
                (case_count + 63) / 64);
    for (uint32_t i = 0; i < case_count; i++) {
        for (int k = 0; k < 2; k++) assert_true(results[i][k] >= 0 && results[i][k] < 1e30f);
    }
}

/* ---- Closed forms ---------------------------------------------------------------------------- */

static void matte_surfaces_have_the_irradiance_of_closed_forms(void **unused) {
    (void)unused;
    static double expected[64], tolerance[64];
    begin();
    for (int i = 0; i < 8; i++) { /* spheres over a facing plane, down to contact, and far away */
        double d = i < 7 ? 1 + 0.25 * i : 1000;
        add_matte(add_light((masu_punctual_light_state){
            .shape = MASU_SHAPE_SPHERE, .radius = 1, .position = {0, 0, d}}));
        expected[case_count - 1] = 1 / (d * d);
        tolerance[case_count - 1] = 1e-3 / (d * d);
    }
    for (int i = 0; i < 30; i++) { /* at the horizon, and a little above and below (Snyder 1996) */
        double s = (double[]){0.1, 0.3, 0.5, 0.7, 0.9, 0.99}[i % 6], c = s * (0.45 * (i / 6) - 0.9);
        double flat = sqrt(1 - c * c), x = sqrt(1 / (s * s) - 1), y = -x * c / flat;
        double root = flat * sqrt(fmax(1 - y * y, 0)), d = 1 / s;
        expected[case_count] = ((c * acos(y) - x * root) * s * s + atan(root / x)) / PI;
        tolerance[case_count] = fabs(c) < 1e-9 ? 0.01 : 0.017;
        add_matte(add_light((masu_punctual_light_state){
            .shape = MASU_SHAPE_SPHERE, .radius = 1, .position = {d * flat, 0, d * c}}));
    }
    for (int i = 0; i < 6; i++) { /* a facing rectangle on its axis */
        double h = (double[]){0.1, 0.5, 1, 3, 10, 100}[i], x = 1.5 / h, y = 0.4 / h;
        double a = sqrt(1 + x * x), b = sqrt(1 + y * y);
        expected[case_count] = 2 / PI * (x / a * atan(y / a) + y / b * atan(x / b));
        tolerance[case_count] = 2e-3 * expected[case_count];
        add_matte(add_light((masu_punctual_light_state){.shape = MASU_SHAPE_RECTANGLE,
                                                        .position = {0, 0, h},
                                                        .direction = {1.5f, 0, 0},
                                                        .half_axis = {0, -0.4f, 0}}));
    }
    for (int i = 0; i < 3; i++) { /* a capsule end-on is a disc; a long one, from the side, a
                                     cylinder */
        double d = (double[]){3, 4, 20}[i];
        expected[case_count] = i ? 0 : 1 / 9.0;
        if (i)
            expected[case_count] =
                0.1 /
                d; /* pi r L / d over an infinite one, halves at right angles: 2 r / d * pi / 2 / pi */
        tolerance[case_count] = (i ? 0.06 : 0.12) * expected[case_count];
        add_matte(add_light(
            (masu_punctual_light_state){.shape = MASU_SHAPE_CAPSULE,
                                        .radius = i ? 0.1f : 1,
                                        .position = {0, 0, d},
                                        .direction = {i ? 1e4f : 1e-5f, 0, i ? 0 : 1e-3f}}));
    }
    run();
    for (uint32_t i = 0; i < case_count; i++) {
        double is = (double)results[i][0];
        if (fabs(is - expected[i]) > tolerance[i])
            fail_msg("case %u: %g, expected %g +- %g", i, is, expected[i], tolerance[i]);
    }
}

static void a_rectangle_is_one_sided_unless_told(void **unused) {
    (void)unused;
    begin();
    for (int i = 0; i < 4; i++) {
        add_matte(add_light((masu_punctual_light_state){.shape = MASU_SHAPE_RECTANGLE,
                                                        .position = {0, 0, 2},
                                                        .direction = {1, 0, 0},
                                                        .half_axis = {0, i & 1 ? 1.0f : -1.0f, 0},
                                                        .two_sided = i >> 1}));
    }
    run();
    assert_true(results[0][0] > 0.2f && results[1][0] == 0 && results[1][2] == 0);
    assert_true(results[2][0] == results[0][0] && results[3][0] == results[0][0]);
}

static void mirrors_show_the_radiance_and_surroundings_the_albedo(void **unused) {
    (void)unused;
    begin();
    uint32_t screen = add_light((masu_punctual_light_state){.shape = MASU_SHAPE_RECTANGLE,
                                                            .position = {2, 0, 2},
                                                            .direction = {0, 1, 0},
                                                            .half_axis = {1, 0, -1},
                                                            .two_sided = 1});
    uint32_t around = add_light((masu_punctual_light_state){.shape = MASU_SHAPE_RECTANGLE,
                                                            .position = {0, 0, 1},
                                                            .direction = {1000, 0, 0},
                                                            .half_axis = {0, -1000, 0}});
    for (int i = 0; i < 3; i++) add_case(screen, 0.045 + 0.01 * i, PI / 4 + 0.02 * i, 0);
    uint32_t mirrors = case_count;
    for (int i = 0; i < 40; i++) {
        add_case(around, 0.1 + 0.1 * (i % 10), (0.15 + 0.25 * (i / 10)) * PI / 2, i);
        *add_case(around, 0, 1, 0) = *add_matte(around);
    }
    run();
    for (uint32_t i = 0; i < mirrors; i++)
        assert_true(fabs((double)results[i][1] - 1) < 0.02);
    for (uint32_t i = mirrors; i < case_count; i++) {
        /* White metal with interreflection between its facets, or white and matte: all light is
         * returned. */
        double is = (double)results[i][0] + (double)results[i][1];
        /* At grazing views the interreflection has an error: one cosine represents all of the
         * light. */
        if (fabs(is - 1) > (cases[i].view[2] > 0.3f ? 0.025 : 0.03))
            fail_msg("roughness %g: %g", (double)cases[i].roughness, is);
    }
}

/* ---- Numerical integration ------------------------------------------------------------------- */

/* A light for the integral: radiance 1 if a direction hits it. */
static int meets_sphere(const double d[3], const double center[3], double s2) {
    double along = dot3(d, center) / sqrt(dot3(center, center));
    return along > 0 && 1 - along * along < s2;
}

/* Distance along d to the plane's part within the half axes; 0: no hit. */
static double meets_rectangle(const double d[3], const double c[3], const double u[3],
                              const double v[3]) {
    double n[3], at[3];
    cross3(u, v, n);
    double t = dot3(c, n) / dot3(d, n);
    if (!(t > 0) || !(t < 1e12)) return 0;
    for (int k = 0; k < 3; k++) at[k] = t * d[k] - c[k];
    return fabs(dot3(at, u)) <= dot3(u, u) && fabs(dot3(at, v)) <= dot3(v, v) ? t : 0;
}

static double meets_capsule(const double d[3], const double c[3], const double u[3], double r) {
    /* The smallest distance of the ray to the axis, from the closest points of both lines. */
    double length = sqrt(dot3(u, u)), e[3], best = 1e30;
    for (int k = 0; k < 3; k++) e[k] = u[k] / length;
    double de = dot3(d, e), ce = dot3(c, e), cd = dot3(c, d),
           x = de * de < 1 ? (de * cd - ce) / (1 - de * de) : 0;
    x = fmin(fmax(x, -length), length);
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = c[k] + x * e[k];
    double t = dot3(p, d);
    best = dot3(p, p) - t * t;
    return t > 0 && best <= r * r;
}

enum { SAMPLES = 200 };

/* Probability density of a direction in the lobe's visible normals. */
static double lobe_density(double alpha, const double v[3], const double l[3]) {
    double h[3] = {v[0] + l[0], v[1] + l[1], v[2] + l[2]}, a2 = alpha * alpha;
    unit3(h);
    double k = alpha / (h[0] * h[0] + h[1] * h[1] + h[2] * h[2] * a2);
    return l[2] > 0 ? k * k / (2 * PI * (v[2] + sqrt(a2 + (1 - a2) * v[2] * v[2]))) : 0;
}

static void lobe_direction(double alpha, const double v[3], double a, double b, double l[3]) {
    double w[3] = {alpha * v[0], alpha * v[1], v[2]};
    unit3(w);
    double turn = 2 * PI * a, z = (1 - b) * (1 + w[2]) - w[2], flat = sqrt(fmax(1 - z * z, 0));
    double h[3] = {alpha * (flat * cos(turn) + w[0]), alpha * (flat * sin(turn) + w[1]),
                   fmax(z + w[2], 1e-9)};
    unit3(h);
    double along = 2 * dot3(v, h);
    for (int k = 0; k < 3; k++) l[k] = along * h[k] - v[k];
}

/* A point on the light's surface in the direction l, and the density per solid angle; 0: none. */
static double light_sample(const masu_punctual_light_state *s, const double c[3], double a,
                           double b, double l[3]) {
    if (s->shape == MASU_SHAPE_RECTANGLE) {
        double u[3], v[3], n[3];
        for (int k = 0; k < 3; k++) {
            u[k] = (double)s->direction[k], v[k] = (double)s->half_axis[k];
            l[k] = c[k] + (2 * a - 1) * u[k] + (2 * b - 1) * v[k];
        }
        cross3(u, v, n);
        double d2 = dot3(l, l), facing = fabs(dot3(l, n)) / sqrt(d2);
        unit3(l);
        return facing > 0 ? d2 / (4 * facing) : 0;
    }
    double r = (double)s->radius, axis[3], t[3], across[3], far, low;
    /* Within the cone around the sphere, or around a capsule's bounding sphere: misses contribute
     * 0. */
    double length = 0;
    for (int k = 0; k < 3; k++)
        length +=
            s->shape == MASU_SHAPE_CAPSULE ? (double)s->direction[k] * (double)s->direction[k] : 0;
    r += sqrt(length);
    far = sqrt(dot3(c, c));
    low = far > r ? 1 - sqrt(1 - r * r / (far * far)) : 1.999;
    for (int k = 0; k < 3; k++) axis[k] = c[k] / far, t[k] = fabs(axis[k]) < 0.6;
    cross3(axis, t, across);
    unit3(across);
    cross3(axis, across, t);
    double q = a * low, flat = sqrt(fmax(q * (2 - q), 0));
    for (int k = 0; k < 3; k++)
        l[k] = (1 - q) * axis[k] + flat * (cos(2 * PI * b) * t[k] + sin(2 * PI * b) * across[k]);
    return 1 / (2 * PI * low);
}

static int light_meets(const masu_punctual_light_state *s, const double c[3], const double l[3]) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = (double)s->direction[k], v[k] = (double)s->half_axis[k];
    if (s->shape == MASU_SHAPE_RECTANGLE) return meets_rectangle(l, c, u, v) > 0;
    if (s->shape == MASU_SHAPE_CAPSULE) return meets_capsule(l, c, u, (double)s->radius);
    return meets_sphere(l, c, (double)s->radius * (double)s->radius / dot3(c, c));
}

/* Reflected light in a case, by samples of the light and of the lobe (balance heuristic). */
static double integral(const test_case *t) {
    const masu_punctual_light_state *s = &states[(int)t->light];
    brdf_surface surface = {{1, 1, 1}, (double)t->roughness, 1, 0, 0, 0};
    double v[3], c[3], sum = 0, alpha = fmax(surface.roughness, MASU_TABLE_SMOOTHEST);
    alpha *= alpha;
    for (int k = 0; k < 3; k++)
        v[k] = (double)t->view[k], c[k] = s->position[k] - (double)t->point[k];
    for (int i = 0; i < 2 * SAMPLES; i++) {
        /* Sequence R2, from another start for each case. */
        double n = i / 2 + 1000 * (double)(t - cases), l[3], f[3], density, other, unused[3];
        double a = fmod(0.5 + 0.7548776662466927 * n, 1), b = fmod(0.5 + 0.5698402909980532 * n, 1);
        if (i & 1) {
            density = light_sample(s, c, a, b, l);
        } else {
            lobe_direction(alpha, v, a, b, l);
            density = 0;
        }
        if (!(l[2] > 0) || !light_meets(s, c, l)) continue;
        other = lobe_density(alpha, v, l);
        if (!(i & 1)) { /* the density of the light's samples in this direction */
            if (s->shape == MASU_SHAPE_RECTANGLE) {
                double u[3], w[3], n[3];
                for (int k = 0; k < 3; k++)
                    u[k] = (double)s->direction[k], w[k] = (double)s->half_axis[k];
                double far = meets_rectangle(l, c, u, w);
                cross3(u, w, n);
                density = far * far / (4 * fabs(dot3(l, n)));
            } else {
                density = light_sample(s, c, 0.5, 0.5, unused);
            }
        }
        brdf_eval(masu_split_sum, &surface, v, l, f);
        sum += f[0] / PI / (density + other) / SAMPLES;
    }
    return sum;
}

static const double roughnesses[] = {0.045, 0.1, 0.2, 0.4, 0.7, 1};
enum { ROUGHNESSES = sizeof roughnesses / sizeof *roughnesses };

/* Integral over all directions of a sphere's centre, denser near the mirror direction, relative to
 * the exact one: each light direction is inside the sphere for a solid angle of centres, and white
 * metal with interreflection between the facets returns all light. */
static double sphere_energy(double roughness, double sine, double elevation, double *worst) {
    static double weights[LIGHTS_MOST];
    enum { RINGS = 64, TURNS = 12 };
    double alpha = roughness * roughness, start = 1e-4 + 0.5 * (alpha * alpha + sine * sine);
    double m[3] = {cos(elevation), 0, sin(elevation)},
           side[3] = {-sin(elevation), 0, cos(elevation)};
    double span = log(1 + 2 / start), is = 0;
    begin();
    uint32_t n = 0;
    for (int i = 0; i < RINGS; i++) {
        for (int k = 0; k < TURNS; k++) { /* the other half is its mirror image */
            double q = start * (exp((i + 0.5) / RINGS * span) - 1), turn = PI * (k + 0.5) / TURNS;
            double flat = sqrt(fmax(q * (2 - q), 0)), x = flat * cos(turn);
            masu_punctual_light_state s = {.shape = MASU_SHAPE_SPHERE, .radius = (float)sine};
            for (int j = 0; j < 3; j++) s.position[j] = (1 - q) * m[j] + x * side[j];
            s.position[1] = flat * sin(turn);
            if (s.position[2] <= -sine) continue;
            weights[n++] = (q + start) * span / RINGS * 2 * PI / TURNS;
            add_case(add_light(s), roughness, elevation, 0);
        }
    }
    run();
    for (uint32_t i = 0; i < n; i++) is += weights[i] * (double)results[i][1];
    is /= 2 * PI * (1 - sqrt(1 - sine * sine));
    *worst = worst_of(*worst, fabs(is - 1));
    return is;
}

static void spheres_keep_their_energy(void **unused) {
    (void)unused;
    static const double sines[] = {0.02, 0.1, 0.35, 0.67, 0.95}, elevations[] = {20, 40, 80};
    double worst = 0;
    for (int e = 0; e < 3; e++) {
        for (int r = 0; r < ROUGHNESSES; r++) {
            print_message("  view %2g, roughness %.3f: energy of radius / distance", elevations[e],
                          roughnesses[r]);
            for (int k = 0; k < 5; k++)
                print_message(
                    " %g: %.2f%s", sines[k],
                    sphere_energy(roughnesses[r], sines[k], elevations[e] * PI / 180, &worst),
                    k < 4 ? "," : "\n");
        }
    }
    assert_true(worst < 0.15);
}

/* Over a plane below the light: -6 <= x <= 2, 0 <= y <= 3, points towards y = 0 closer by its cube, since the highlight of a
 * strip on a smooth surface is no wider than the strip. */
static void rectangles_and_capsules_keep_their_energy(void **unused) {
    (void)unused;
    static const struct {
        const char *what;
        masu_punctual_light_state light;
        double energy, error; /* allowed */
    } shapes[] = {
        {"rectangle 2 x 0.6, level",
         {.shape = MASU_SHAPE_RECTANGLE,
          .position = {0, 0, 1.5},
          .direction = {1, 0, 0},
          .half_axis = {0, -0.3f, 0}},
         0.05,
         0.15},
        {"rectangle 2 x 0.6, upright",
         {.shape = MASU_SHAPE_RECTANGLE,
          .position = {0, 0, 1.2},
          .direction = {0, 1, 0},
          .half_axis = {0, 0, 0.3f},
          .two_sided = 1},
         0.06,
         0.15},
        {"strip 3 x 0.1",
         {.shape = MASU_SHAPE_RECTANGLE,
          .position = {0, 0, 0.5},
          .direction = {1.5f, 0, 0},
          .half_axis = {0, -0.05f, 0}},
         0.05,
         0.08},
        {"capsule 2 x 0.1, level",
         {.shape = MASU_SHAPE_CAPSULE,
          .radius = 0.1f,
          .position = {0, 0, 1},
          .direction = {0, 1, 0}},
         0.06,
         0.2},
        {"capsule 2 x 0.1, upright",
         {.shape = MASU_SHAPE_CAPSULE,
          .radius = 0.1f,
          .position = {0, 0, 1.3},
          .direction = {0, 0, 1}},
         0.1,
         0.3},
    };
    int bad = 0;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        for (int r = 0; r < ROUGHNESSES; r++) {
            print_message("  %-26s roughness %.3f:", shapes[i].what, roughnesses[r]);
            for (int e = 0; e < 2; e++) {
                enum { ROWS = 24, COLUMNS = 32 };
                double is = 0, should = 0, square = 0, all = 0;
                begin();
                uint32_t light = add_light(shapes[i].light);
                for (int y = 0; y < ROWS; y++) {
                    for (int x = 0; x < COLUMNS; x++) {
                        test_case *c = add_case(light, roughnesses[r], e ? PI / 9 : PI / 3, 0);
                        c->point[0] = (float)(-6 + (x + 0.5) * 8 / COLUMNS);
                        c->point[1] = (float)(3 * pow((y + 0.5) / ROWS, 3));
                    }
                }
                run();
                for (uint32_t k = 0; k < case_count; k++) {
                    double a = (double)results[k][1], b = integral(&cases[k]),
                           w = pow((k / COLUMNS + 0.5) / ROWS, 2);
                    is += w * a, should += w * b, square += w * (a - b) * (a - b), all += w * b * b;
                }
                double error = sqrt(square / all);
                print_message(" view %d: energy %.3f, L2 error %.3f;", e ? 20 : 60, is / should,
                              error);
                if (fabs(is / should - 1) > shapes[i].energy || error > shapes[i].error) bad++;
            }
            print_message("\n");
        }
    }
    assert_int_equal(bad, 0);
}

static void a_point_without_a_radius_is_a_sun_of_its_direction(void **unused) {
    (void)unused;
    uint64_t seed = 5;
    begin();
    for (int i = 0; i < 200; i++) {
        masu_punctual_light_state s = {.radius = 1e-6f};
        for (int k = 0; k < 3; k++) s.position[k] = random_between(&seed, -3, 3);
        s.position[2] = fabs(s.position[2]) + 0.1;
        add_case(add_light(s), random_between(&seed, 0.1, 1), random_between(&seed, 0.2, 1.5), i);
    }
    run();
    for (uint32_t i = 0; i < case_count; i++) {
        double l[3], v[3], f[3], d2 = 0;
        brdf_surface surface = {{1, 1, 1}, (double)cases[i].roughness, 1, 0, 0, 0};
        for (int k = 0; k < 3; k++)
            l[k] = states[i].position[k], v[k] = (double)cases[i].view[k], d2 += l[k] * l[k];
        unit3(l);
        brdf_eval(masu_split_sum, &surface, v, l, f);
        assert_true(fabs((double)results[i][1] * d2 - f[0]) < 1e-3 * (f[0] + 1e-3));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matte_surfaces_have_the_irradiance_of_closed_forms),
        cmocka_unit_test(a_rectangle_is_one_sided_unless_told),
        cmocka_unit_test(mirrors_show_the_radiance_and_surroundings_the_albedo),
        cmocka_unit_test(a_point_without_a_radius_is_a_sun_of_its_direction),
        cmocka_unit_test(spheres_keep_their_energy),
        cmocka_unit_test(rectangles_and_capsules_keep_their_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
