/* test_normal_packing.c: masu_unpack_normal against the packing of shaders/shared/pack.glsl,
 * written a second time here and in double precision, so that the measured error is only that of
 * the 26 bits and of the decoder.
 *
 * Error bound: rounding moves each coordinate by up to h = 0.5 / 4095. For equal x, y and z, (h, h)
 * on the square is (h, h, -2h) on the octahedron, sqrt(6) h long and at right angles to a radius of
 * 1/sqrt(3): sqrt(18) h = 0.0297 degrees. This is the worst case. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "masu.h"
#include "support/random.h"

#define DIRECTIONS 100000
#define PI 3.14159265358979323846
#define WORST_DEGREES 0.0297

static uint32_t packed_component(double c) { return (uint32_t)(nearbyint(c * 4095.0) + 4095.0); }

/* masu_pack_normal without material: GLSL's masu_oct_encode in double precision. */
static uint32_t packed(const double n[3]) {
    double sum = fabs(n[0]) + fabs(n[1]) + fabs(n[2]);
    double x = n[0] / sum, y = n[1] / sum;
    if (n[2] < 0.0) {
        double folded = (1.0 - fabs(y)) * (x < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(x)) * (y < 0.0 ? -1.0 : 1.0);
        x = folded;
    }
    return packed_component(x) | packed_component(y) << 13;
}

/* Degrees between a unit vector and the decoded one; atan2 keeps its precision near 0. */
static double error_degrees(const double n[3], const float out[3]) {
    double o[3] = {(double)out[0], (double)out[1], (double)out[2]};
    double cross[3] = {n[1] * o[2] - n[2] * o[1], n[2] * o[0] - n[0] * o[2],
                       n[0] * o[1] - n[1] * o[0]};
    double dot = n[0] * o[0] + n[1] * o[1] + n[2] * o[2];
    double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    return atan2(sine, dot) * 180.0 / PI;
}

static double length(const float v[3]) {
    double x = (double)v[0], y = (double)v[1], z = (double)v[2];
    return sqrt(x * x + y * y + z * z);
}

/* Uniform over the sphere: z and the angle are uniform. */
static void random_direction(uint64_t *random, double n[3]) {
    double z = (double)(support_random(random) >> 11) / 4503599627370496.0 - 1.0;
    double angle = (double)(support_random(random) >> 11) / 9007199254740992.0 * 2.0 * PI;
    double r = sqrt(1.0 - z * z);
    n[0] = r * cos(angle);
    n[1] = r * sin(angle);
    n[2] = z;
}

static void a_direction_comes_back_within_the_rounding_of_13_bits(void **state) {
    (void)state;
    uint64_t random = 1;
    double worst = 0.0, mean = 0.0, worst_length = 0.0;
    for (int i = 0; i < DIRECTIONS; i++) {
        double n[3];
        float out[3];
        random_direction(&random, n);
        masu_unpack_normal(packed(n), out);
        double error = error_degrees(n, out), off = fabs(length(out) - 1.0);
        mean += error / DIRECTIONS;
        if (!(error <= worst)) worst = error;
        if (!(off <= worst_length)) worst_length = off;
    }
    printf("%d directions: largest error %.5f degrees, mean %.5f; length error %.1e at most\n",
           DIRECTIONS, worst, mean, worst_length);
    assert_true(worst <= WORST_DEGREES);
    assert_true(worst_length <= 1e-6);
}

static void axes_come_back_exactly(void **state) {
    (void)state;
    for (int axis = 0; axis < 3; axis++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            double n[3] = {0.0, 0.0, 0.0};
            float out[3];
            n[axis] = sign;
            masu_unpack_normal(packed(n), out);
            for (int k = 0; k < 3; k++) assert_true((double)out[k] == n[k]);
        }
    }
}

static void directions_in_the_plane_of_two_axes_stay_in_it(void **state) {
    (void)state;
    for (int i = 0; i < 3600; i++) {
        double angle = i * PI / 1800.0;
        double upright[3] = {cos(angle), 0.0, sin(angle)}, flat[3] = {cos(angle), sin(angle), 0.0};
        float out[3];
        masu_unpack_normal(packed(upright), out);
        assert_true(fabs((double)out[1]) <= 1e-3);
        assert_true(error_degrees(upright, out) <= WORST_DEGREES);
        masu_unpack_normal(packed(flat), out);
        assert_true(fabs((double)out[2]) <= 1e-3);
        assert_true(error_degrees(flat, out) <= WORST_DEGREES);
    }
}

/* Also the pairs that no encoder writes: 8191 is outside -1..1, and the material bits are noise. */
static void every_texel_gives_a_unit_vector(void **state) {
    (void)state;
    uint64_t random = 2;
    for (uint32_t x = 0; x < 8192; x++) {
        for (uint32_t i = 0; i < 64; i++) {
            uint32_t y = i < 2 ? 8191 - i : (uint32_t)(support_random(&random) % 8192);
            float out[3];
            masu_unpack_normal(x | y << 13 | (uint32_t)support_random(&random) << 26, out);
            if (!(fabs(length(out) - 1.0) <= 1e-6)) {
                fail_msg("texel %u, %u has length %g", x, y, length(out));
            }
        }
    }
}

static void a_coordinate_beyond_the_square_counts_as_its_edge(void **state) {
    (void)state;
    for (uint32_t y = 0; y < 8192; y++) {
        float beyond[3], edge[3];
        uint32_t on_edge = y == 8191 ? 8190 : y;
        masu_unpack_normal(8191 | y << 13, beyond);
        masu_unpack_normal(8190 | on_edge << 13, edge);
        assert_memory_equal(beyond, edge, sizeof edge);
        masu_unpack_normal(y | 8191 << 13, beyond);
        masu_unpack_normal(on_edge | 8190 << 13, edge);
        assert_memory_equal(beyond, edge, sizeof edge);
    }
}

static void material_and_flags_do_not_turn_the_normal(void **state) {
    (void)state;
    uint64_t random = 3;
    for (int i = 0; i < 1000; i++) {
        uint32_t texel = (uint32_t)support_random(&random);
        float with[3], without[3];
        masu_unpack_normal(texel, with);
        masu_unpack_normal(texel & 0x3FFFFFFu, without);
        assert_memory_equal(with, without, sizeof with);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_direction_comes_back_within_the_rounding_of_13_bits),
        cmocka_unit_test(axes_come_back_exactly),
        cmocka_unit_test(directions_in_the_plane_of_two_axes_stay_in_it),
        cmocka_unit_test(every_texel_gives_a_unit_vector),
        cmocka_unit_test(a_coordinate_beyond_the_square_counts_as_its_edge),
        cmocka_unit_test(material_and_flags_do_not_turn_the_normal),
    };
    return cmocka_run_group_tests_name("normal_packing", tests, NULL, NULL);
}
