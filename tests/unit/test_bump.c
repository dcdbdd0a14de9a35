/* test_bump.c: height maps to normals, checked with an exact slope; and detection of height maps by
 * content, independent of file names. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "bake/texture/bump.h"
#include "support/random.h"

#define SIDE 64u

static uint8_t picture[4 * SIDE * SIDE];
static float normals[4 * SIDE * SIDE];

static void set(uint32_t x, uint32_t y, double r, double g, double b) {
    uint8_t *t = picture + 4 * (y * SIDE + x);
    t[0] = (uint8_t)(r + 0.5), t[1] = (uint8_t)(g + 0.5), t[2] = (uint8_t)(b + 0.5), t[3] = 255;
}

/* A ramp of 2 bytes per texel along u and 1 up the image: a slope of 2 / 255 of a height of 0.64
 * texels. */
static void a_ramp_has_one_slope(void **state) {
    (void)state;
    const bool clamped[2] = {true, true};
    for (uint32_t y = 0; y < SIDE; y++) {
        for (uint32_t x = 0; x < SIDE; x++) {
            double h = 2 * x + (SIDE - 1 - y);
            set(x, y, h, h, h);
        }
    }
    for (int strength = -8; strength <= 8; strength += 4) {
        double u = 2.0 / 255 * strength * 0.01 * SIDE, v = u / 2, length = sqrt(u * u + v * v + 1);
        masu_bump_normals(picture, SIDE, SIDE, strength, clamped, normals);
        for (uint32_t y = 1; y + 1 < SIDE; y++) {
            for (uint32_t x = 1; x + 1 < SIDE; x++) {
                const float *n = normals + 4 * (y * SIDE + x);
                assert_true(fabs((double)n[0] + u / length) < 1e-5);
                assert_true(fabs((double)n[1] + v / length) < 1e-5);
                assert_true(fabs((double)n[2] - 1 / length) < 1e-5);
                assert_float_equal(n[3], 1.0f, 0);
            }
        }
    }
}

/* A repeated image continues at the opposite edge; a clamped one ends. */
static void edges_are_as_they_are_wrapped(void **state) {
    (void)state;
    for (uint32_t y = 0; y < SIDE; y++) {
        for (uint32_t x = 0; x < SIDE; x++) {
            double h = x < SIDE / 2 ? 0 : 255;
            set(x, y, h, h, h);
        }
    }
    for (int i = 0; i < 2; i++) {
        const bool clamped[2] = {i == 1, false};
        masu_bump_normals(picture, SIDE, SIDE, 1, clamped, normals);
        for (uint32_t y = 0; y < SIDE; y++) {
            const float *row = normals + 4 * y * SIDE;
            assert_true(row[4 * (SIDE / 2)] < -0.2f); /* it rises to the right */
            assert_true(i ? row[0] == 0 : row[0] > 0.2f);
            assert_true(row[4 * (SIDE / 4)] == 0 && row[1] == 0);
        }
    }
    const bool repeated[2] = {false, false};
    /* limited to the steepest slope */
    masu_bump_normals(picture, SIDE, SIDE, 1e6, repeated, normals);
    double slope = -(double)(normals[4 * (SIDE / 2)] / normals[4 * (SIDE / 2) + 2]);
    assert_true(fabs(slope - MASU_BUMP_SLOPE_MAX) < 1e-3);
    masu_bump_normals(picture, 1, 1, 1, repeated, normals);
    assert_true(normals[0] == 0 && normals[1] == 0 && normals[2] == 1);
}

static void texels_say_what_they_are(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (int kind = 0; kind < 4; kind++) {
        for (uint32_t y = 0; y < SIDE; y++) {
            for (uint32_t x = 0; x < SIDE; x++) {
                double n = support_random_in(&seed, 0, 20), u = sin(x * 0.4) * 0.6,
                       v = cos(y * 0.3) * 0.6;
                double z = sqrt(1 - u * u - v * v), grey = 40 + 3 * (x % 40u);
                if (kind == 0) set(x, y, grey, grey + n, grey + n / 2); /* like JPEG noise */
                if (kind == 1) set(x, y, 128 + 127 * u, 128 + 127 * v, 128 + 127 * z);
                if (kind == 2) set(x, y, 120 + n, 80 + n, 50 + n); /* wood */
                if (kind == 3) set(x, y, 255, 255, 255);
            }
        }
        bool heights = masu_bump_is_height(picture, SIDE, SIDE, MASU_BAKE_RELIEF_NAMED_HEIGHTS);
        bool named_normals =
            masu_bump_is_height(picture, SIDE, SIDE, MASU_BAKE_RELIEF_NAMED_NORMALS);
        assert_int_equal(heights, kind != 1);
        assert_int_equal(named_normals, kind == 0 || kind == 3);
        assert_false(masu_bump_is_height(picture, SIDE, SIDE, MASU_BAKE_RELIEF_NORMALS));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ramp_has_one_slope),
        cmocka_unit_test(edges_are_as_they_are_wrapped),
        cmocka_unit_test(texels_say_what_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
