/* test_bake_detail.c: checks the guarantees of masu-bake's mesh processing by dense samples and
 * rays in double precision that share no code with it: errors of LODs are bounds, occluders are
 * inside their mesh, merged meshes show the same triangles. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bake/mesh/detail.h"
#include "bake/mesh/triangles.h"
#include "bake/mesh/occluders.h"
#include "bake/mesh/shape.h"
#include "bake/mesh/surface.h"
#include "bake/scene/check.h"
#include "support/random.h"

typedef masu_bake_vec3 vec3;

/* ---- independent reference ---- */

/* Distance from p to a triangle by its seven features, independent of tools/bake/mesh/surface.c. */
static double own_distance(const vec3 t[3], vec3 p) {
    vec3 e0 = masu_bake_sub(t[1], t[0]), e1 = masu_bake_sub(t[2], t[0]), d = masu_bake_sub(t[0], p);
    double a = masu_bake_dot(e0, e0), b = masu_bake_dot(e0, e1), c = masu_bake_dot(e1, e1);
    double f = masu_bake_dot(e0, d), g = masu_bake_dot(e1, d), best = DBL_MAX;
    double det = a * c - b * b;
    double u = (b * g - c * f) / det, v = (b * f - a * g) / det;
    if (det > 0 && u >= 0 && v >= 0 && u + v <= 1) {
        vec3 q = masu_bake_mad(masu_bake_mad(t[0], e0, u), e1, v);
        best = masu_bake_length(masu_bake_sub(q, p));
    }
    for (int i = 0; i < 3; i++) {
        vec3 s = t[i], e = masu_bake_sub(t[(i + 1) % 3], s);
        double k = masu_bake_dot(masu_bake_sub(p, s), e) / fmax(masu_bake_dot(e, e), 1e-300);
        vec3 q = masu_bake_mad(s, e, fmin(fmax(k, 0), 1));
        best = fmin(best, masu_bake_length(masu_bake_sub(q, p)));
    }
    return best;
}

static double own_distance_all(const vec3 (*t)[3], size_t count, vec3 p) {
    double best = DBL_MAX;
    for (size_t i = 0; i < count; i++) best = fmin(best, own_distance(t[i], p));
    return best;
}

static vec3 point_on(uint64_t *state, const vec3 t[3]) {
    double u = random_unit(state), v = random_unit(state);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    vec3 p = masu_bake_mad(t[0], masu_bake_sub(t[1], t[0]), u);
    return masu_bake_mad(p, masu_bake_sub(t[2], t[0]), v);
}

/* Does the segment from a to b cross the triangle? (Moller, Trumbore) */
static bool crosses(vec3 a, vec3 b, const vec3 t[3]) {
    vec3 d = masu_bake_sub(b, a), e0 = masu_bake_sub(t[1], t[0]), e1 = masu_bake_sub(t[2], t[0]);
    vec3 h = masu_bake_cross(d, e1), s = masu_bake_sub(a, t[0]), q = masu_bake_cross(s, e0);
    double det = masu_bake_dot(e0, h);
    if (fabs(det) < 1e-300) return false;
    double u = masu_bake_dot(s, h) / det, v = masu_bake_dot(d, q) / det;
    double k = masu_bake_dot(e1, q) / det;
    return u >= -1e-9 && v >= -1e-9 && u + v <= 1 + 1e-9 && k >= 0 && k <= 1 + 1e-9;
}

/* ---- meshes ---- */

typedef struct soup {
    float positions[3 * 30000];
    uint32_t indices[30000];
    uint32_t count;
} soup;

static void corner(soup *s, vec3 p) {
    s->positions[3 * s->count] = (float)p.x;
    s->positions[3 * s->count + 1] = (float)p.y;
    s->positions[3 * s->count + 2] = (float)p.z;
    s->indices[s->count] = s->count;
    s->count++;
}

static void face(soup *s, vec3 a, vec3 b, vec3 c) {
    corner(s, a);
    corner(s, b);
    corner(s, c);
}

static void cuboid(soup *s, vec3 low, vec3 high, int without) {
    static const unsigned char sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                              {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int i = 0; i < 6; i++) {
        vec3 v[4];
        for (int k = 0; k < 4; k++) {
            unsigned c = sides[i][k];
            v[k] = masu_bake_v3(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y,
                                c & 4 ? high.z : low.z);
        }
        if (i == without) continue;
        face(s, v[0], v[1], v[2]);
        face(s, v[0], v[2], v[3]);
    }
}

/* A tube around a circle: closed, with a hole. */
static void torus(soup *s, double radius, double thickness, int n, int m, bool inwards) {
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < m; k++) {
            vec3 v[4];
            for (int c = 0; c < 4; c++) {
                /* whole steps modulo n, so that the ends are bit-identical */
                double a = 2 * MASU_BAKE_PI * ((i + (c == 1 || c == 2)) % n) / n;
                double b = 2 * MASU_BAKE_PI * ((k + (c >= 2)) % m) / m;
                double r = radius + thickness * cos(b);
                v[c] = masu_bake_v3(r * cos(a), thickness * sin(b), -r * sin(a));
            }
            face(s, v[0], v[inwards ? 2 : 1], v[inwards ? 1 : 2]);
            face(s, v[0], v[inwards ? 3 : 2], v[inwards ? 2 : 3]);
        }
    }
}

static void add_primitive(masu_bake_content *c, const soup *s, float red) {
    masu_blob_material material = masu_bake_default_material();
    material.base_color[0] = red;
    masu_bake_losses losses = {0};
    masu_bake_triangles t = {.positions = s->positions,
                             .vertex_count = s->count,
                             .indices = s->indices,
                             .index_count = s->count,
                             .material = masu_bake_material(c, &material, "")};
    assert_true(masu_bake_add_triangles(c, &t, &losses));
}

static void add_mesh(masu_bake_content *c, const soup *s, const char *name) {
    uint32_t first = (uint32_t)masu_bake_count(c, MASU_BLOB_PRIMITIVES);
    add_primitive(c, s, 1);
    uint32_t text = masu_bake_name(c, name, strlen(name));
    uint32_t mesh =
        masu_bake_mesh(c, first, (uint32_t)masu_bake_count(c, MASU_BLOB_PRIMITIVES) - first, text);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_instance(c, &identity, mesh, MASU_BLOB_NONE, text);
}

static masu_bake_buffer triangles_of(const masu_bake_content *c, uint32_t first, uint32_t count) {
    masu_bake_buffer b = {0};
    masu_bake_surface_collect(c, first, count, &b);
    return b;
}

#define TRIANGLES(b) ((const vec3(*)[3])(void *)(b).data)
#define COUNT_OF(b) ((b).bytes / (3 * sizeof(vec3)))

/* ---- distances ---- */

static void distances_are_those_of_the_nearest_triangle(void **state) {
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 50; round++) {
        vec3 t[60][3];
        for (int i = 0; i < 180; i++) {
            t[i / 3][i % 3] =
                masu_bake_v3(random_between(&random, -1, 1), random_between(&random, -1, 1),
                             round % 5 ? random_between(&random, -1, 1) : 0);
        }
        size_t count = (size_t)support_random_in(&random, 1, 60);
        masu_bake_surface s = masu_bake_surface_make((const vec3(*)[3])t, count);
        for (int i = 0; i < 100; i++) {
            vec3 p = {random_between(&random, -2, 2), random_between(&random, -2, 2),
                      random_between(&random, -2, 2)};
            double got = masu_bake_surface_distance(&s, p, NULL);
            double want = own_distance_all((const vec3(*)[3])t, count, p);
            assert_true(fabs(got - want) < 1e-9);
        }
        masu_bake_surface_release(&s);
    }
}

static void a_deviation_is_a_bound_and_not_much_more(void **state) {
    (void)state;
    uint64_t random = 2;
    for (int round = 0; round < 40; round++) {
        vec3 a[12][3], b[12][3];
        for (int i = 0; i < 36; i++) {
            a[i / 3][i % 3] =
                masu_bake_v3(random_between(&random, -1, 1), random_between(&random, -1, 1),
                             random_between(&random, -1, 1));
            b[i / 3][i % 3] =
                masu_bake_v3(random_between(&random, -1, 1), random_between(&random, -1, 1),
                             random_between(&random, -1, 1));
        }
        masu_bake_surface from = masu_bake_surface_make((const vec3(*)[3])a, 12);
        masu_bake_surface to = masu_bake_surface_make((const vec3(*)[3])b, 12);
        double bound = masu_bake_surface_deviation(&from, &to, DBL_MAX), most = 0;
        for (int i = 0; i < 12 * 400; i++) {
            vec3 p = point_on(&random, (const vec3 *)a[i % 12]);
            most = fmax(most, own_distance_all((const vec3(*)[3])b, 12, p));
        }
        for (int i = 0; i < 36; i++) {
            most = fmax(most, own_distance_all((const vec3(*)[3])b, 12, a[i / 3][i % 3]));
        }
        assert_true(bound >= most);
        /* a tenth of slack, and samples miss the maximum */
        assert_true(bound <= most * 1.25 + 0.02);
        assert_true(masu_bake_surface_deviation(&from, &to, most / 2) == DBL_MAX);
        assert_true(masu_bake_surface_deviation(&from, &from, DBL_MAX) < 1e-12);
        masu_bake_surface_release(&from);
        masu_bake_surface_release(&to);
    }
}

static void parts_are_counted_and_the_open_ones_found(void **state) {
    (void)state;
    static soup s;
    s.count = 0;
    cuboid(&s, masu_bake_v3(0, 0, 0), masu_bake_v3(1, 2, 3), -1);
    cuboid(&s, masu_bake_v3(5, 0, 0), masu_bake_v3(6, 2, 3), 2);
    torus(&s, 20, 3, 12, 8, true);
    vec3 t[400][3];
    uint32_t part[400];
    bool closed[400];
    for (uint32_t i = 0; i < s.count; i++) t[i / 3][i % 3] = masu_bake_v3f(s.positions + 3 * i);
    assert_int_equal(masu_bake_surface_parts((const vec3(*)[3])t, s.count / 3, part, closed), 3);
    assert_true(closed[0]);
    assert_false(closed[1]);
    assert_true(closed[2]);
    assert_int_equal(part[11], 0);
    assert_int_equal(part[12], 1);
    assert_int_equal(part[22], 2);
    assert_true(fabs(masu_bake_winding((const vec3(*)[3])t, 12, masu_bake_v3(0.5, 1, 1)) - 1) <
                1e-9);
    assert_true(fabs(masu_bake_winding((const vec3(*)[3])t, 12, masu_bake_v3(-0.5, 1, 1))) < 1e-9);
    assert_true(fabs(masu_bake_winding((const vec3(*)[3])(t + 22), 192, masu_bake_v3(20, 0, 0)) +
                     1) < 1e-9);
    assert_true(fabs(masu_bake_winding((const vec3(*)[3])(t + 22), 192, masu_bake_v3(0, 0, 0))) <
                1e-9);
}

/* ---- LODs ---- */

static void check_lods(masu_bake_content *c, uint32_t least_levels, uint64_t seed) {
    masu_bake_lod_report report = {0};
    masu_bake_make_lods(c, 3, &report);
    uint64_t count = masu_bake_count(c, MASU_BLOB_LODS), random = seed;
    assert_true(count >= least_levels);
    assert_int_equal(count, report.levels);
    uint32_t before = 0;
    float error = 0;
    for (uint64_t i = 0; i < count; i++) {
        masu_blob_lod l = MASU_BAKE_LODS(c)[i];
        masu_blob_mesh m = MASU_BAKE_MESHES(c)[l.mesh];
        bool first = i == 0 || l.mesh != MASU_BAKE_LODS(c)[i - 1].mesh;
        masu_bake_buffer fine = triangles_of(c, m.first_primitive, m.primitive_count);
        masu_bake_buffer coarse = triangles_of(c, l.first_primitive, m.primitive_count);
        if (first) before = (uint32_t)COUNT_OF(fine);
        assert_true(COUNT_OF(coarse) > 0 && COUNT_OF(coarse) < before);
        assert_true(first || l.error >= error);
        before = (uint32_t)COUNT_OF(coarse);
        error = l.error;
        for (uint32_t p = 0; p < m.primitive_count; p++) {
            assert_int_equal(MASU_BAKE_PRIMITIVES(c)[l.first_primitive + p].material,
                             MASU_BAKE_PRIMITIVES(c)[m.first_primitive + p].material);
        }
        double most = 0;
        for (int k = 0; k < 1500; k++) {
            size_t f = (size_t)support_random_in(&random, 0, COUNT_OF(fine) - 1);
            size_t g = (size_t)support_random_in(&random, 0, COUNT_OF(coarse) - 1);
            vec3 p = point_on(&random, TRIANGLES(fine)[f]),
                 q = point_on(&random, TRIANGLES(coarse)[g]);
            most = fmax(most, own_distance_all(TRIANGLES(coarse), COUNT_OF(coarse), p));
            most = fmax(most, own_distance_all(TRIANGLES(fine), COUNT_OF(fine), q));
        }
        assert_true(most <= (double)l.error * (1 + 1e-6) + 1e-9);
        masu_bake_release(&fine);
        masu_bake_release(&coarse);
    }
}

static void errors_of_lods_are_bounds(void **state) {
    (void)state;
    masu_bake_content ball = {0}, ring = {0}, fence = {0}, small = {0};
    static soup s;
    masu_bake_sphere(&ball, 2.5, 3, 0);
    check_lods(&ball, 3, 10);
    s.count = 0;
    torus(&s, 4, 1, 32, 12, false);
    add_mesh(&ring, &s, "ring");
    check_lods(&ring, 2, 11);
    s.count = 0; /* with many parts, which no collapse removes */
    cuboid(&s, masu_bake_v3(0, 0, 0), masu_bake_v3(10, 0.1, 0.1), -1);
    cuboid(&s, masu_bake_v3(0, 1, 0), masu_bake_v3(10, 1.1, 0.1), -1);
    for (int i = 0; i < 40; i++) {
        double x = i * 0.25 + 0.05;
        cuboid(&s, masu_bake_v3(x, 0.1, 0.03), masu_bake_v3(x + 0.04, 1, 0.07), -1);
    }
    add_mesh(&fence, &s, "fence");
    check_lods(&fence, 1, 12);
    masu_bake_cuboid(&small, masu_bake_v3(1, 1, 1), 0);
    masu_bake_lod_report report = {0};
    masu_bake_make_lods(&small, 3, &report);
    assert_int_equal(masu_bake_count(&small, MASU_BLOB_LODS), 0);
    assert_int_equal(report.too_small, 1);
    masu_bake_content_release(&ball);
    masu_bake_content_release(&ring);
    masu_bake_content_release(&fence);
    masu_bake_content_release(&small);
}

/* Lamps on a wall: their union is where the wall is, whatever happens to their outlines. Each level
 * shows a lamp whose colour is nowhere farther from the lamp than its stated error, or omits a lamp
 * that is no larger than the error. */
static void a_level_is_judged_by_each_of_its_materials(void **state) {
    (void)state;
    enum { LAMPS = 3, CORNERS = 48 };
    const double radius[LAMPS] = {1, 0.4, 0.02};
    static soup wall, lamps;
    masu_bake_content c = {0};
    wall.count = lamps.count = 0;
    cuboid(&wall, masu_bake_v3(-4, -4, -1), masu_bake_v3(4, 4, 0), -1);
    for (int l = 0; l < LAMPS; l++) {
        vec3 at[CORNERS];
        for (int i = 0; i < CORNERS; i++) {
            double a = 2 * MASU_BAKE_PI * i / CORNERS;
            at[i] = masu_bake_v3(2.5 * (l - 1) + radius[l] * cos(a), radius[l] * sin(a), 0);
        }
        for (int i = 1; i + 1 < CORNERS; i++) face(&lamps, at[0], at[i], at[i + 1]);
    }
    add_primitive(&c, &wall, 0);
    add_primitive(&c, &lamps, 1);
    uint32_t text = masu_bake_name(&c, "wall", 4);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_instance(&c, &identity, masu_bake_mesh(&c, 0, 2, text), MASU_BLOB_NONE, text);
    masu_bake_lod_report report = {0};
    masu_bake_make_lods(&c, 3, &report);
    assert_true(report.levels >= 1);
    uint64_t random = 13;
    for (uint64_t i = 0; i < masu_bake_count(&c, MASU_BLOB_LODS); i++) {
        masu_blob_lod l = MASU_BAKE_LODS(&c)[i];
        double error = (double)l.error * (1 + 1e-6) + 1e-9;
        masu_bake_buffer fine = triangles_of(&c, 1, 1),
                         coarse = triangles_of(&c, l.first_primitive + 1, 1);
        for (size_t k = 0; k < COUNT_OF(fine); k++) {
            double middle = TRIANGLES(fine)[k][0].x / 2.5 + 1;
            if (2 * radius[(int)(middle + 0.5)] * sqrt(2) <= error) continue;
            assert_true(COUNT_OF(coarse) > 0);
            for (int n = 0; n < 40; n++) {
                vec3 p = point_on(&random, TRIANGLES(fine)[k]);
                assert_true(own_distance_all(TRIANGLES(coarse), COUNT_OF(coarse), p) <= error);
            }
        }
        for (size_t k = 0; k < 40 * COUNT_OF(coarse); k++) {
            vec3 p = point_on(&random, TRIANGLES(coarse)[k / 40]);
            assert_true(own_distance_all(TRIANGLES(fine), COUNT_OF(fine), p) <= error);
        }
        masu_bake_release(&fine);
        masu_bake_release(&coarse);
    }
    masu_bake_content_release(&c);
}

/* ---- occluders ---- */

static vec3 point_of_box(uint64_t *state, const masu_blob_occluder *o) {
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = random_between(state, (double)o->low[k], (double)o->high[k]);
    int face = (int)support_random_in(state, 0, 5);
    p[face / 2] = (double)(face & 1 ? o->high : o->low)[face / 2];
    return masu_bake_v3(p[0], p[1], p[2]);
}

/* From every camera position outside the mesh's box, these primitives are in front of every point
 * of the occluder; or not, at one position. */
static bool hides(const masu_bake_content *c, const masu_blob_occluder *o, uint32_t first,
                  uint64_t seed) {
    masu_blob_mesh m = MASU_BAKE_MESHES(c)[o->mesh];
    masu_bake_buffer mesh = triangles_of(c, first, m.primitive_count);
    vec3 low = masu_bake_v3f(m.aabb_min), size = masu_bake_sub(masu_bake_v3f(m.aabb_max), low);
    vec3 middle = masu_bake_mad(low, size, 0.5);
    double radius = masu_bake_length(size);
    uint64_t random = seed;
    bool hidden = true;
    for (int i = 0; i < 3000 && hidden; i++) {
        vec3 p = point_of_box(&random, o);
        vec3 d = {random_between(&random, -1, 1), random_between(&random, -1, 1),
                  random_between(&random, -1, 1)};
        if (!masu_bake_normalize(&d)) continue;
        vec3 eye = masu_bake_mad(middle, d, radius * random_between(&random, 1, 5));
        hidden = false;
        for (size_t t = 0; t < COUNT_OF(mesh) && !hidden; t++) {
            hidden = crosses(eye, p, TRIANGLES(mesh)[t]);
        }
    }
    masu_bake_release(&mesh);
    return hidden;
}

/* Checks all occluders, against their meshes and the number of LODs that they state. Returns the
 * total number of LODs. */
static uint32_t check_occluders(const masu_bake_content *c, uint64_t seed) {
    uint32_t lods = 0;
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_OCCLUDERS); i++) {
        const masu_blob_occluder *o = &MASU_BAKE_OCCLUDERS(c)[i];
        assert_true(hides(c, o, MASU_BAKE_MESHES(c)[o->mesh].first_primitive, seed + i));
        uint32_t level = 0;
        for (uint64_t k = 0; k < masu_bake_count(c, MASU_BLOB_LODS); k++) {
            const masu_blob_lod *l = &MASU_BAKE_LODS(c)[k];
            if (l->mesh != o->mesh || level++ >= o->lods) continue;
            assert_true(hides(c, o, l->first_primitive, seed + i));
        }
        assert_true(o->lods <= level);
        lods += o->lods;
    }
    return lods;
}

static double box_volume(const masu_blob_occluder *o) {
    double v = 1;
    for (int k = 0; k < 3; k++) v *= (double)o->high[k] - (double)o->low[k];
    return v;
}

static void occluders_lie_inside(void **state) {
    (void)state;
    static soup s;
    uint64_t random = 3;
    for (int round = 0; round < 40; round++) {
        masu_bake_content c = {0};
        masu_bake_occluder_report report = {0};
        s.count = 0;
        vec3 low = {random_between(&random, -9, 0), random_between(&random, -9, 0),
                    random_between(&random, -9, 0)};
        vec3 high = {random_between(&random, 1, 9), random_between(&random, 1, 9),
                     random_between(&random, 1, 9)};
        if (round % 4 == 0)
            torus(&s, random_between(&random, 4, 9), random_between(&random, 1, 3), 24, 10,
                  round % 8);
        if (round % 4 == 1) masu_bake_sphere(&c, random_between(&random, 1, 9), 3, 0);
        if (round % 4 ==
            2) { /* a box of many faces inside an open one, so that only the inner one occludes */
            cuboid(&s, low, high, 3);
            torus(&s, 6, 2, 16, 8, false);
        }
        if (round % 4 == 3) { /* a box, and an open one */
            cuboid(&s, low, high, round % 8 == 3 ? -1 : 4);
        }
        if (s.count) add_mesh(&c, &s, "solid");
        masu_bake_make_occluders(&c, 0.5, &report);
        assert_int_equal(masu_bake_count(&c, MASU_BLOB_OCCLUDERS), round % 8 != 7);
        assert_int_equal(report.whole, round % 8 == 3);
        assert_int_equal(report.inside, round % 4 != 3);
        assert_int_equal(report.dropped, round % 8 == 7);
        (void)check_occluders(&c, 100 + (uint64_t)round);
        masu_bake_content_release(&c);
    }
}

static void a_box_in_a_sphere_is_not_needlessly_small(void **state) {
    (void)state;
    masu_bake_content c = {0};
    masu_bake_occluder_report report = {0};
    masu_bake_sphere(&c, 1, 3, 0);
    masu_bake_make_occluders(&c, 0.5, &report);
    assert_int_equal(report.inside, 1);
    assert_true(box_volume(MASU_BAKE_OCCLUDERS(&c)) >
                0.8 * 8 / sqrt(27.0)); /* the cube inside has side 2 / sqrt 3 */
    masu_bake_content_release(&c);
}

static void what_is_open_thin_or_small_has_no_occluder(void **state) {
    (void)state;
    static soup s;
    masu_bake_content c = {0};
    masu_bake_occluder_report report = {0};
    s.count = 0; /* open, and too many triangles to render directly */
    torus(&s, 6, 2, 16, 8, false);
    s.count -= 3;
    add_mesh(&c, &s, "open");
    s.count = 0;
    cuboid(&s, masu_bake_v3(0, 0, 0), masu_bake_v3(9, 0.2, 0.2), -1);
    add_mesh(&c, &s, "pole");
    masu_bake_make_occluders(&c, 0.5, &report);
    assert_int_equal(masu_bake_count(&c, MASU_BLOB_OCCLUDERS), 0);
    assert_int_equal(report.dropped, 1);
    assert_int_equal(report.too_small, 1);
    masu_bake_content_release(&c);
}

static void an_occluder_says_which_lods_hold_it(void **state) {
    (void)state;
    uint32_t held = 0, not_held = 0;
    for (int round = 0; round < 6; round++) {
        static soup s;
        masu_bake_content c = {0};
        masu_bake_occluder_report report = {0};
        masu_bake_lod_report lods = {0};
        s.count = 0;
        if (round < 3) masu_bake_sphere(&c, 1 + round, 3, 0);
        if (round >= 3) {
            torus(&s, 6, 1 + 0.7 * (round - 3), 32, 16, false);
            add_mesh(&c, &s, "ring");
        }
        masu_bake_make_occluders(&c, 0.5, &report);
        if (round % 3 == 2) { /* an occluder of half the size is inside more LODs */
            masu_blob_occluder *o = MASU_BAKE_OCCLUDERS(&c);
            for (int k = 0; k < 3; k++) {
                float middle = 0.5f * (o->low[k] + o->high[k]);
                o->low[k] = 0.5f * (o->low[k] + middle);
                o->high[k] = 0.5f * (o->high[k] + middle);
            }
        }
        masu_bake_make_lods(&c, 3, &lods);
        masu_bake_prove_occluders(&c);
        uint32_t of = check_occluders(&c, 300 + (uint64_t)round);
        assert_true(lods.levels > 0);
        held += of;
        not_held += lods.levels - of;
        masu_bake_content_release(&c);
    }
    assert_true(held > 0);
    assert_true(not_held > 0); /* otherwise nothing shows that the check can fail */
}

static void boxes_that_stick_out_are_not_inside(void **state) {
    (void)state;
    static soup s;
    s.count = 0;
    torus(&s, 6, 2, 16, 8, false);
    vec3 t[256][3];
    for (uint32_t i = 0; i < s.count; i++) t[i / 3][i % 3] = masu_bake_v3f(s.positions + 3 * i);
    for (int out = 0; out < 3; out++) { /* in the ring; through its wall; in its hole */
        double x = out == 0 ? 5 : out == 1 ? 5.5 : -1;
        masu_bake_box box = {{x, -0.5, -0.5}, {x + (out == 1 ? 3 : 1.5), 0.5, 0.5}};
        assert_int_equal(masu_bake_is_inside((const vec3(*)[3])t, s.count / 3, &box), out == 0);
        /* An open mesh has no inside. */
        assert_false(masu_bake_is_inside((const vec3(*)[3])t, s.count / 3 - 1, &box));
    }
}

/* ---- merging ---- */

/* Sums that the order of the triangles hardly changes. */
static void measure(const masu_bake_content *c, uint64_t *triangles, double *area, vec3 *flux) {
    *triangles = 0;
    *area = 0;
    *flux = masu_bake_v3(0, 0, 0);
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(c)[i];
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(c)[n->mesh];
        masu_bake_affine a;
        for (int k = 0; k < 12; k++) a.m[k] = (double)n->transform[k];
        masu_bake_buffer b = triangles_of(c, m->first_primitive, m->primitive_count);
        *triangles += COUNT_OF(b);
        for (size_t t = 0; t < COUNT_OF(b); t++) {
            vec3 p[3];
            for (int k = 0; k < 3; k++) p[k] = masu_bake_apply(&a, TRIANGLES(b)[t][k]);
            vec3 f = masu_bake_cross(masu_bake_sub(p[1], p[0]), masu_bake_sub(p[2], p[0]));
            double y = (p[0].y + p[1].y + p[2].y) / 3;
            *area += masu_bake_length(f) / 2;
            *flux = masu_bake_mad(*flux, f, y);
        }
        masu_bake_release(&b);
    }
}

static void merging_shows_the_same_triangles_in_small_meshes(void **state) {
    (void)state;
    static soup s;
    masu_bake_content c = {0};
    uint64_t random = 5, before, after;
    double area, merged_area;
    vec3 flux, merged_flux;
    for (int i = 0; i < 60; i++) {
        s.count = 0;
        cuboid(&s, masu_bake_v3(0, 0, 0), masu_bake_v3(1, 1, 1), -1);
        add_mesh(&c, &s, "brick");
        masu_blob_instance *n = &MASU_BAKE_INSTANCES(&c)[i];
        for (int k = 0; k < 3; k++)
            n->transform[4 * k + 3] = (float)random_between(&random, -50, 50);
        n->transform[5] = (float)random_between(&random, 0.5, 3);
    }
    s.count = 0;
    torus(&s, 4, 1, 32, 12, false);
    add_mesh(&c, &s, "ring");
    masu_bake_affine again = masu_bake_translation(masu_bake_v3(30, 0, 0));
    masu_bake_instance(&c, &again, 60, MASU_BLOB_NONE, MASU_BLOB_NONE);
    measure(&c, &before, &area, &flux);
    assert_null(masu_bake_merge(&c, 25));
    assert_null(masu_bake_check(&c));
    measure(&c, &after, &merged_area, &merged_flux);
    assert_int_equal(after, before);
    assert_true(fabs(merged_area - area) < 1e-3 * area);
    assert_true(masu_bake_length(masu_bake_sub(merged_flux, flux)) < 1e-3 * area);
    assert_true(masu_bake_count(&c, MASU_BLOB_MESHES) < 61);
    uint64_t rings = 0;
    for (uint64_t i = 0; i < masu_bake_count(&c, MASU_BLOB_MESHES); i++) {
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(&c)[i];
        bool ring = strcmp(masu_bake_name_text(&c, m->name), "ring") == 0;
        rings += ring;
        for (int k = 0; k < 3 && !ring; k++) { /* a cell, and the parts that stick out of it */
            assert_true(m->aabb_max[k] - m->aabb_min[k] <= 25 + 2 * 3);
        }
    }
    assert_int_equal(rings, 1); /* used twice and large: unchanged */
    masu_bake_content_release(&c);
}

static void merging_keeps_the_outside_of_what_is_mirrored(void **state) {
    (void)state;
    masu_bake_content c = {0};
    masu_bake_sphere(&c, 1, 2, 0);
    MASU_BAKE_INSTANCES(&c)[0].transform[0] = -2;
    uint64_t count;
    double area;
    vec3 flux;
    assert_null(masu_bake_merge(&c, 100));
    measure(&c, &count, &area, &flux);
    masu_bake_buffer b = triangles_of(&c, 0, (uint32_t)masu_bake_count(&c, MASU_BLOB_PRIMITIVES));
    double wound = masu_bake_winding(TRIANGLES(b), COUNT_OF(b), masu_bake_v3(0.1, 0, 0));
    assert_true(fabs(wound - 1) < 1e-6);
    masu_bake_release(&b);
    masu_bake_content_release(&c);
}

typedef struct mapped_corner {
    float position[3], texcoord[2]; /* in the world, rounded as the baker does */
} mapped_corner;

static int by_value(const void *a, const void *b) {
    const mapped_corner *p = a, *q = b;
    for (int k = 0; k < 3; k++) {
        if (p->position[k] != q->position[k]) return p->position[k] < q->position[k] ? -1 : 1;
    }
    for (int k = 0; k < 2; k++) {
        if (p->texcoord[k] != q->texcoord[k]) return p->texcoord[k] < q->texcoord[k] ? -1 : 1;
    }
    return 0;
}

/* Each corner of each visible triangle, sorted. */
static masu_bake_buffer mapped_corners(const masu_bake_content *c) {
    masu_bake_buffer out = {0};
    const float *texcoords = MASU_BAKE_ARRAY(c, MASU_BLOB_TEXCOORDS, const float);
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(c)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(c)[n->mesh];
        masu_bake_affine a;
        for (int k = 0; k < 12; k++) a.m[k] = (double)n->transform[k];
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[mesh->first_primitive + j];
            for (uint32_t k = 0; k < p->index_count; k++) {
                size_t v = p->first_vertex + MASU_BAKE_INDICES(c)[p->first_index + k];
                vec3 at = masu_bake_apply(&a, masu_bake_v3f(MASU_BAKE_VERTICES(c)[v].position));
                mapped_corner m = {{(float)at.x + 0.0f, (float)at.y + 0.0f, (float)at.z + 0.0f},
                                   {texcoords[2 * v], texcoords[2 * v + 1]}};
                masu_bake_append(&out, &m, sizeof m);
            }
        }
    }
    qsort(out.data, out.bytes / sizeof(mapped_corner), sizeof(mapped_corner), by_value);
    return out;
}

static void merging_carries_texture_coordinates(void **state) {
    (void)state;
    masu_bake_content c = {0};
    uint64_t random = 9;
    masu_bake_sphere(&c, 3, 2, 5); /* 320 triangles: kept if used twice */
    for (int i = 0; i < 40; i++) masu_bake_cuboid(&c, masu_bake_v3(2, 3, 4), 1 + i);
    masu_bake_instance(&c, &(masu_bake_affine){{1, 0, 0, 60, 0, 1, 0, 0, 0, 0, 1, 0}}, 0,
                       MASU_BLOB_NONE, MASU_BLOB_NONE);
    for (uint64_t i = 0; i < masu_bake_count(&c, MASU_BLOB_INSTANCES); i++) {
        masu_blob_instance *n = &MASU_BAKE_INSTANCES(&c)[i];
        for (int k = 0; k < 3; k++)
            n->transform[4 * k + 3] = (float)random_between(&random, -50, 50);
        if (i % 3 == 1) n->transform[0] = -2; /* mirrored: the corner order is reversed */
    }
    masu_bake_buffer before = mapped_corners(&c);
    assert_true(before.bytes > 2000 * sizeof(mapped_corner));
    assert_null(masu_bake_merge(&c, 60));
    assert_null(masu_bake_check(&c));
    assert_true(masu_bake_count(&c, MASU_BLOB_MESHES) < 41);
    masu_bake_buffer after = mapped_corners(&c);
    assert_int_equal(after.bytes, before.bytes);
    assert_memory_equal(after.data, before.data, before.bytes);
    masu_bake_release(&before);
    masu_bake_release(&after);
    masu_bake_content_release(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_the_nearest_triangle),
        cmocka_unit_test(a_deviation_is_a_bound_and_not_much_more),
        cmocka_unit_test(parts_are_counted_and_the_open_ones_found),
        cmocka_unit_test(errors_of_lods_are_bounds),
        cmocka_unit_test(a_level_is_judged_by_each_of_its_materials),
        cmocka_unit_test(occluders_lie_inside),
        cmocka_unit_test(a_box_in_a_sphere_is_not_needlessly_small),
        cmocka_unit_test(what_is_open_thin_or_small_has_no_occluder),
        cmocka_unit_test(an_occluder_says_which_lods_hold_it),
        cmocka_unit_test(boxes_that_stick_out_are_not_inside),
        cmocka_unit_test(merging_shows_the_same_triangles_in_small_meshes),
        cmocka_unit_test(merging_keeps_the_outside_of_what_is_mirrored),
        cmocka_unit_test(merging_carries_texture_coordinates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
