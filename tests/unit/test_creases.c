/* test_creases.c: normals of triangles without any: sharp edges and smooth ones, independent of
 * vertex sharing and of the triangulation. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "bake/mesh/creases.h"

enum { CORNERS = 4096 };

static float positions[3 * CORNERS];
static uint32_t corners[CORNERS];
static int16_t normals[CORNERS][2];

static void make(uint32_t vertices, uint32_t count) {
    masu_bake_triangles t = {
        .positions = positions, .vertex_count = vertices, .indices = corners, .index_count = count};
    memset(normals, 0, sizeof normals);
    masu_bake_creased_normals(&t, corners, count, normals);
}

static void expect(uint32_t corner, double x, double y, double z) {
    masu_bake_vec3 n = masu_bake_decode_normal(normals[corner]), want = {x, y, z};
    masu_bake_normalize(&want);
    if (!(masu_bake_dot(n, want) > 1 - 1e-8))
        fail_msg("corner %u: %g %g %g, not %g %g %g", corner, n.x, n.y, n.z, want.x, want.y,
                 want.z);
}

static void face_normal(uint32_t triangle, double out[3]) {
    masu_bake_vec3 p[3];
    for (uint32_t k = 0; k < 3; k++)
        p[k] = masu_bake_v3f(positions + 3 * corners[3 * triangle + k]);
    masu_bake_vec3 n = masu_bake_cross(masu_bake_sub(p[1], p[0]), masu_bake_sub(p[2], p[0]));
    masu_bake_normalize(&n);
    out[0] = n.x, out[1] = n.y, out[2] = n.z;
}

/* A cube of eight vertices, or of 36. Its sides are flat. */
static void a_cube_is_flat(void **state) {
    (void)state;
    static const uint32_t quads[6][4] = {{0, 1, 3, 2}, {2, 3, 5, 4}, {4, 5, 7, 6},
                                         {6, 7, 1, 0}, {1, 7, 5, 3}, {6, 0, 2, 4}};
    static const float eight[8][3] = {{-1, -1, 1}, {1, -1, 1}, {-1, 1, 1},   {1, 1, 1},
                                      {-1, 1, -1}, {1, 1, -1}, {-1, -1, -1}, {1, -1, -1}};
    for (int shared = 0; shared < 2; shared++) {
        uint32_t n = 0;
        if (shared) memcpy(positions, eight, sizeof eight);
        for (int q = 0; q < 6; q++) {
            static const int cut[6] = {0, 1, 2, 0, 2, 3};
            for (int k = 0; k < 6; k++, n++) {
                uint32_t from = quads[q][cut[k]];
                if (!shared) memcpy(positions + 3 * n, eight[from], sizeof eight[0]);
                corners[n] = shared ? from : n;
            }
        }
        make(shared ? 8 : 36, n);
        for (uint32_t i = 0; i < n; i++) {
            double face[3];
            face_normal(i / 3, face);
            expect(i, face[0], face[1], face[2]);
        }
    }
}

/* A tube of `sides`: smooth from six sides on, except its caps. */
static void a_tube_is_round(void **state) {
    (void)state;
    for (uint32_t sides = 3; sides <= 12; sides++) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < 2 * sides; i++) {
            double turn = 6.283185307179586 * (i / 2) / sides;
            positions[3 * i] = (float)cos(turn), positions[3 * i + 1] = (float)sin(turn),
                          positions[3 * i + 2] = (float)(i % 2);
        }
        for (uint32_t i = 0; i < sides; i++) {
            uint32_t a = 2 * i, b = 2 * ((i + 1) % sides), side[6] = {a, b, b + 1, a, b + 1, a + 1};
            memcpy(corners + n, side, sizeof side), n += 6;
        }
        for (uint32_t i = 1; i + 1 < sides; i++) {
            uint32_t cap[3] = {1, 2 * i + 1, 2 * i + 3};
            memcpy(corners + n, cap, sizeof cap), n += 3;
        }
        make(2 * sides, n);
        for (uint32_t i = 0; i < n; i++) {
            const float *p = positions + 3 * corners[i];
            double face[3];
            face_normal(i / 3, face);
            /* for any triangulation of its sides */
            if (i < 6 * sides && sides >= 6) expect(i, (double)p[0], (double)p[1], 0);
            else expect(i, face[0], face[1], face[2]);
        }
    }
}

/* More faces around a point than any surface has: each gets its own normal, quickly. No faces at
 * all. */
static void whatever_comes(void **state) {
    (void)state;
    const uint32_t blades = CORNERS / 3;
    positions[0] = positions[1] = 0, positions[2] = 1;
    for (uint32_t i = 0; i < blades; i++) {
        double turn = 6.283185307179586 * i / blades;
        positions[3 * i + 3] = (float)cos(turn), positions[3 * i + 4] = (float)sin(turn),
                          positions[3 * i + 5] = 0;
        corners[3 * i] = 0, corners[3 * i + 1] = 1 + i, corners[3 * i + 2] = 1 + (i + 1) % blades;
    }
    make(1 + blades, 3 * blades);
    for (uint32_t i = 0; i < 3 * blades; i++) {
        double face[3];
        face_normal(i / 3, face);
        if (i % 3 == 0) expect(i, face[0], face[1], face[2]);
    }
    make(1, 0);
    assert_int_equal(normals[0][0], 0);
    /* 0 is -0: a roof that is split at its ridge. */
    static const float roof[18] = {0, 0, 0, 0, 0, 1, -2, -1, 0, -0.0f, -0.0f, 0, 2, -1, 0, 0, 0, 1};
    memcpy(positions, roof, sizeof roof);
    for (uint32_t i = 0; i < 6; i++) corners[i] = i;
    make(6, 6);
    for (uint32_t i = 0; i < 2; i++) {
        masu_bake_vec3 n = masu_bake_decode_normal(normals[3 * i]);
        if (!(fabs(n.x) < 1e-3 && n.y < -0.999))
            fail_msg("the ridge is cut: %g %g %g", n.x, n.y, n.z);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_is_flat),
        cmocka_unit_test(a_tube_is_round),
        cmocka_unit_test(whatever_comes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
