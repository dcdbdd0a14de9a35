/* test_lights.c: punctual lights on the host: the bounding sphere of a light contains every point
 * that the reference lights; a culled light would light nothing in the image; and the numbers for
 * the shaders are finite for every valid state. (Images: tests/gpu.) */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "scene/punctual_light.h"
#include "reference/lights.h"
#include "support/random.h"

#define PI 3.14159265358979323846

static uint64_t seed = 1;

static masu_punctual_light_state random_light(int i) {
    masu_punctual_light_state s = {.range = (float)random_spread(&seed, 1e-6, 1e9),
                                .radius = (float)random_spread(&seed, 1e-6, 1e3),
                                .color = {1, 0.5f, 0},
                                .spot = i % 3 != 0};
    for (int k = 0; k < 3; k++) {
        s.position[k] = random_between(&seed, -1, 1) * random_spread(&seed, 1e-3, 1e9);
        s.direction[k] = (float)random_between(&seed, -1, 1);
    }
    if (s.spot) {
        s.outer =
            (float)(i % 5 ? random_between(&seed, 0.01, PI) : random_spread(&seed, 1e-6, 0.01));
        s.inner = s.outer * (float)random_between(&seed, 0, 1);
    }
    return s;
}

static masu_ref_light reference_of(const masu_punctual_light_state *s) {
    masu_ref_light r = {.range = (double)s->range,
                        .radius = (double)s->radius,
                        .inner = s->spot ? (double)s->inner : PI,
                        .outer = s->spot ? (double)s->outer : PI};
    for (int k = 0; k < 3; k++) {
        r.position[k] = s->position[k];
        r.color[k] = (double)s->color[k];
        r.axis[k] = (double)s->direction[k];
    }
    return r;
}

/* A point that the light can reach: within its range, and mostly within its cone. */
static void point_of(const masu_punctual_light_state *s, double out[3]) {
    double d[3], length = 0,
                 reach = (double)s->range * (seed & 256 ? random_between(&seed, 0, 1) : 0.99999);
    double wide = s->spot ? 1.2 * tan(fmin((double)s->outer, 1.5)) : 3;
    for (int k = 0; k < 3; k++) {
        d[k] = s->spot ? (double)s->direction[k] : 0;
        length += d[k] * d[k];
    }
    length = sqrt(length);
    double own = length;
    length = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = (own > 0 ? d[k] / own : 0) + wide * random_between(&seed, -1, 1);
        length += d[k] * d[k];
    }
    for (int k = 0; k < 3; k++) out[k] = s->position[k] + d[k] / sqrt(length) * reach;
}

static void a_bound_holds_all_that_is_reached(void **state) {
    (void)state;
    uint32_t reached = 0;
    for (int i = 0; i < 3000; i++) {
        masu_punctual_light_state s = random_light(i);
        masu_ref_light ref = reference_of(&s);
        struct masu_punctual_light_data data;
        double direction[3], value;
        for (int k = 0; k < 3; k++) direction[k] = (double)s.direction[k];
        assert_null(masu_light_state_wrong(&s, &value));
        assert_true(masu_light_place(&s, s.position, direction, &data));
        for (uint32_t f = 0; f < sizeof data / sizeof(float); f++)
            assert_true(fabsf(((const float *)&data)[f]) <= FLT_MAX);
        for (int n = 0; n < 40; n++) {
            double p[3], l[3], color[3], square = 0;
            point_of(&s, p);
            if (!masu_ref_light_reaches(&ref, p, l, color)) continue;
            for (int k = 0; k < 3; k++)
                square += (p[k] - (double)data.bound[k]) * (p[k] - (double)data.bound[k]);
            if (sqrt(square) > (double)data.bound[3])
                fail_msg("light %d reaches %g beyond its bound of %g", i,
                         sqrt(square) - (double)data.bound[3], (double)data.bound[3]);
            reached++;
        }
        /* And is no larger than the range requires. */
        double far = 0, slack = (double)s.range;
        for (int k = 0; k < 3; k++) far += fabs(s.position[k]);
        slack += far;
        assert_true((double)data.bound[3] <= (double)s.range + 3e-5 * slack);
    }
    assert_true(reached > 30000);
}

/* A camera as in src/frame/camera.c: clip rows of an image with these tangents. */
static void make_camera(float clip[16], double right[3], double up[3], double forward[3],
                        double tan_x, double tan_y) {
    double length;
    for (int k = 0; k < 3; k++)
        forward[k] = random_between(&seed, -1, 1), right[k] = random_between(&seed, -1, 1);
    length = sqrt(forward[0] * forward[0] + forward[1] * forward[1] + forward[2] * forward[2]);
    for (int k = 0; k < 3; k++) forward[k] = (double)(float)(forward[k] / length);
    up[0] = right[1] * forward[2] - right[2] * forward[1];
    up[1] = right[2] * forward[0] - right[0] * forward[2];
    up[2] = right[0] * forward[1] - right[1] * forward[0];
    length = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
    for (int k = 0; k < 3; k++) up[k] = (double)(float)(up[k] / length);
    right[0] = forward[1] * up[2] - forward[2] * up[1];
    right[1] = forward[2] * up[0] - forward[0] * up[2];
    right[2] = forward[0] * up[1] - forward[1] * up[0];
    memset(clip, 0, 16 * sizeof *clip);
    for (int k = 0; k < 3; k++) {
        clip[4 * k] = (float)((double)(float)right[k] / tan_x);
        clip[4 * k + 1] = (float)(-up[k] / tan_y);
        clip[4 * k + 3] = (float)forward[k];
    }
    clip[14] = 0.1f;
}

static void what_is_left_out_lights_nothing_in_the_picture(void **state) {
    (void)state;
    uint32_t outside = 0, seen = 0;
    for (int i = 0; i < 4000; i++) {
        float clip[16];
        double right[3], up[3], forward[3];
        double tan_y = i % 4 ? random_between(&seed, 0.1, 2) : random_spread(&seed, 5e-4, 48),
               tan_x = tan_y * random_spread(&seed, 0.1, 10);
        make_camera(clip, right, up, forward, tan_x, tan_y);
        masu_punctual_light_state s = random_light(i);
        masu_ref_light ref = reference_of(&s);
        struct masu_punctual_light_data data;
        double direction[3];
        for (int k = 0; k < 3; k++) direction[k] = (double)s.direction[k];
        assert_true(masu_light_place(&s, s.position, direction, &data));
        int out = masu_light_outside(data.bound, clip);
        outside += (uint32_t)out;
        for (int n = 0; n < 30; n++) {
            double p[3], l[3], color[3], x = 0, y = 0, z = 0;
            point_of(&s, p);
            for (int k = 0; k < 3; k++) {
                x += p[k] * right[k];
                y += p[k] * up[k];
                z += p[k] * forward[k];
            }
            if (!(z > 0) || fabs(x) > tan_x * z || fabs(y) > tan_y * z) continue;
            if (!masu_ref_light_reaches(&ref, p, l, color)) continue;
            if (out) fail_msg("light %d is culled, but visible at %g %g %g", i, p[0], p[1], p[2]);
            seen++;
        }
    }
    assert_true(outside > 1000 && seen > 1000);
}

/* Every accepted value is written as finite numbers. */
static void extremes_give_finite_numbers(void **state) {
    (void)state;
    static const double places[] = {0, 1e-30, 1, -1e7, 1e15, -1e15};
    static const float ranges[] = {0, 1e-30f, 1e-15f, 1e-6f, 1, 1e9f, 1e15f};
    static const float radii[] = {1e-6f, 1, 1e9f}, colors[] = {0, 1e-30f, 1, 1e9f};
    static const float outers[] = {-1, 0, 1e-20f, 1e-6f, 0.7f, 1.5707964f, 1.6f, 3.14159274f};
    for (size_t i = 0; i < 6 * 7 * 3 * 4 * 8 * 2; i++) {
        masu_punctual_light_state s = {.range = ranges[i / 6 % 7], .radius = radii[i / 42 % 3]};
        float outer = outers[i / 504 % 8];
        struct masu_punctual_light_data data;
        double direction[3] = {0, (double)1e-15f * 1.5, 0}, value;
        s.direction[1] = (float)direction[1];
        s.position[0] = s.position[2] = places[i % 6];
        s.color[1] = colors[i / 126 % 4];
        s.spot = outer >= 0;
        if (s.spot) s.outer = outer, s.inner = i / 4032 ? outer : 0;
        assert_null(masu_light_state_wrong(&s, &value));
        int lights = masu_light_place(&s, s.position, direction, &data);
        for (uint32_t f = 0; f < sizeof data / sizeof(float); f++)
            assert_true(fabsf(((const float *)&data)[f]) <= FLT_MAX);
        int should = s.range >= 2e-15f && s.color[1] > 0 && outer != 0;
        if (s.range < 2e-15f && s.range > 1e-16f) continue;
        assert_int_equal(lights, should);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bound_holds_all_that_is_reached),
        cmocka_unit_test(what_is_left_out_lights_nothing_in_the_picture),
        cmocka_unit_test(extremes_give_finite_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
