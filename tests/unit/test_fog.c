/*
 * test_fog.c: shaders/light/fog.glsl, compiled as C, against numeric integrals in double.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/floats.h"
#include "support/random.h"

/* The parts of GLSL and guard.glsl that the source uses. Its floats are floats, but constants are
 * doubles in C, so that results are at least as precise as on a device. */
#define MASU_GUARD_GLSL
#define min(a, b) fminf((float)(a), (float)(b))
#define max(a, b) fmaxf((float)(a), (float)(b))
#define clamp(x, a, b) fminf(fmaxf((float)(x), (float)(a)), (float)(b))
#define abs(x) fabsf(x)
static const float masu_tiny = 1e-30f;
static float masu_sane(float x, double lo, double hi) { return clamp(isfinite(x) ? x : 0, lo, hi); }
static float masu_exp2(double x) { return exp2f(clamp(x, -126, 126)); }

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#include "light/fog.glsl"
#pragma GCC diagnostic pop

/* Simpson's rule, with pieces so short that the density changes by a fortieth or less in each. */
static double integral(double density, double falloff, double height, double climb, double from,
                       double to) {
    if (!(to > from)) return 0;
    double change = falloff * fabs(climb) * (to - from);
    int n = 2 * (int)fmin(fmax(40 * change, 8), 100000);
    double step = (to - from) / n, sum = 0;
    for (int i = 0; i <= n; i++) {
        double t = from + i * step, w = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
        sum += w * density * exp(-falloff * (height + climb * t));
    }
    return sum * step / 3;
}

static void depths_are_those_of_numeric_integrals(void **state) {
    (void)state;
    uint64_t seed = 5;
    double worst = 0, relative = 0;
    int seen = 0;
    for (int i = 0; i < 4000; i++) {
        float density = (float)pow(10, -5 + 5 * random_unit(&seed));
        float falloff = (float)pow(10, -4 + 4 * random_unit(&seed));
        float height = (float)(200 * random_unit(&seed) - 50),
              start = (float)(i % 3 ? 0 : 30 * random_unit(&seed));
        float climb = (float)(2 * random_unit(&seed) - 1),
              far = (float)pow(10, 4 * random_unit(&seed));
        if (i % 4 == 0)
            climb =
                (float)((double)climb * pow(10, -8 * random_unit(&seed))); /* near the horizon */
        if (i % 64 == 0) climb = 0;
        double want = integral((double)density, (double)falloff, (double)height, (double)climb,
                               (double)start, (double)far);
        double got = (double)masu_fog_depth(density, falloff, height, climb, start, far);
        double left = (double)masu_fog_left((float)got);
        assert_true(left >= 0 && left <= 1);
        worst = worst_of(worst, fabs(left - exp(-want)));
        if (want < 1e-30 || want > 60) continue;
        seen++;
        relative = worst_of(relative, fabs(got / want - 1));
    }
    print_message(
        "fog: relative error of the depth %.1e, of the transmittance %.1e; "
        "%d rays neither clear nor lost\n",
        relative, worst, seen);
    assert_true(seen > 1500 && relative < 1e-4 && worst < 2e-6);
}

static void a_ray_to_the_sky_is_one_of_great_length(void **state) {
    (void)state;
    uint64_t seed = 6;
    double worst = 0;
    for (int i = 0; i < 1500; i++) {
        float density = (float)pow(10, -4 + 3 * random_unit(&seed));
        float falloff = (float)pow(10, -2 + 2 * random_unit(&seed));
        float height = (float)(100 * random_unit(&seed)),
              climb = (float)pow(10, -2 * random_unit(&seed));
        float start = (float)(20 * random_unit(&seed));
        double want =
            integral((double)density, (double)falloff, (double)height, (double)climb, (double)start,
                     (double)start + 40 / ((double)falloff * (double)climb));
        double sky =
            (double)masu_fog_left(masu_fog_depth_sky(density, falloff, height, climb, start));
        worst = worst_of(worst, fabs(sky - exp(-want)));
        /* Equal to a point at a great distance. */
        double far =
            (double)masu_fog_left(masu_fog_depth(density, falloff, height, climb, start, 1e12f));
        worst = worst_of(worst, fabs(sky - far));
    }
    print_message("fog: relative error of the sky's transmittance %.1e\n", worst);
    assert_true(worst < 2e-6);
    /* At the horizon and below, transmittance is 0, and it decreases to 0 continuously. */
    double before = (double)masu_fog_left(masu_fog_depth_sky(0.01f, 0.1f, 2, 1, 0));
    for (float climb = 1; climb > 1e-12f; climb *= 0.9f) {
        double left = (double)masu_fog_left(masu_fog_depth_sky(0.01f, 0.1f, 2, climb, 0));
        assert_true(left <= before && before - left < 0.05);
        before = left;
    }
    assert_true(before < 1e-6);
    assert_true(masu_fog_left(masu_fog_depth_sky(0.01f, 0.1f, 2, 0, 0)) < 1e-6f);
    assert_true(masu_fog_left(masu_fog_depth_sky(0.01f, 0.1f, 2, -1, 0)) < 1e-6f);
    assert_true(masu_fog_left(masu_fog_depth_sky(0.01f, 0, 2, 1, 0)) <
                1e-6f); /* does not thin out */
}

/* The same in both directions, and in two pieces as in one. */
static void fog_is_the_same_both_ways_and_adds_up(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < 1500; i++) {
        float falloff = (float)pow(10, -4 + 3 * random_unit(&seed)),
              height = (float)(20 * random_unit(&seed));
        float climb = (float)(2 * random_unit(&seed) - 1), far = (float)(100 * random_unit(&seed));
        float there = masu_fog_depth(0.0001f, falloff, height, climb, 0, far);
        float back = masu_fog_depth(0.0001f, falloff, height + climb * far, -climb, 0, far);
        float near = masu_fog_depth(0.0001f, falloff, height, climb, 0, far / 3);
        float rest = masu_fog_depth(0.0001f, falloff, height, climb, far / 3, far);
        assert_true(fabsf(there - back) <= 2e-5f * (there + 1e-6f));
        assert_true(fabsf(there - near - rest) <= 2e-5f * (there + 1e-6f));
        assert_true(masu_fog_depth(0.01f, falloff, height, climb, far, far / 2) == 0);
    }
}

static void any_bits_give_a_depth(void **state) {
    (void)state;
    static const float odd[] = {0,     -0.0f,  1,     -1,     1e-38f,   -1e-38f,   1e-45f,
                                1e38f, -1e38f, 1e15f, 1e-15f, INFINITY, -INFINITY, NAN};
    enum { N = sizeof odd / sizeof *odd };
    uint64_t seed = 8;
    for (int i = 0; i < 200000; i++) {
        float v[6];
        for (int k = 0; k < 6; k++) {
            uint32_t bits = (uint32_t)support_random_in(&seed, 0, 0xFFFFFFFFu);
            memcpy(&v[k], &bits, sizeof bits);
            if (support_random_in(&seed, 0, 1)) v[k] = odd[support_random_in(&seed, 0, N - 1)];
        }
        float depth = masu_fog_depth(v[0], v[1], v[2], v[3], v[4], v[5]);
        float sky = masu_fog_depth_sky(v[0], v[1], v[2], v[3], v[4]);
        assert_true(depth >= 0 && depth <= masu_fog_most && sky >= 0 && sky <= masu_fog_most);
        assert_true(masu_fog_left(depth) >= 0 && masu_fog_left(sky) <= 1);
    }
}

/* An invalid distance is treated as 0, as is one behind the camera. */
static void fog_that_starts_nowhere_starts_at_the_eye(void **state) {
    (void)state;
    static const float odd[] = {-30, -INFINITY, INFINITY, NAN};
    float near = masu_fog_depth(0.01f, 0.1f, 2, 0.5f, 0, 50),
          sky = masu_fog_depth_sky(0.01f, 0.1f, 2, 0.5f, 0);
    assert_true(near > 0 && sky > near);
    for (int i = 0; i < 4; i++) {
        assert_true(masu_fog_depth(0.01f, 0.1f, 2, 0.5f, odd[i], 50) == near);
        assert_true(masu_fog_depth_sky(0.01f, 0.1f, 2, 0.5f, odd[i]) == sky);
        assert_true(masu_fog_depth(0.01f, 0.1f, 2, 0.5f, 0, odd[i]) == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depths_are_those_of_numeric_integrals),
        cmocka_unit_test(a_ray_to_the_sky_is_one_of_great_length),
        cmocka_unit_test(fog_is_the_same_both_ways_and_adds_up),
        cmocka_unit_test(any_bits_give_a_depth),
        cmocka_unit_test(fog_that_starts_nowhere_starts_at_the_eye),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
