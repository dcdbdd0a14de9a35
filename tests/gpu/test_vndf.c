/* test_vndf.c: shaders/brdf/vndf.glsl and shaders/noise/sequence.glsl on the GPU: equal to the same
 * source compiled as C, which tests/unit has tested, and total: finite directions, weights of 0..1,
 * for any input. */
#include "support/support.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/compute.h"

#include "vndf_comp.spv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reference/glsl.h"
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#include "brdf/vndf.glsl"
#include "noise/sequence.glsl"
#pragma GCC diagnostic pop
#undef uint
#undef sqrt
#undef sin
#undef cos

typedef struct test_case {
    float view[3], roughness;
    float u[2], other[2];
    float normal[3], other_z;
    uint32_t noise[4];
} test_case;

typedef struct test_result {
    float l[3], weight;
    float pdf, other_pdf, other_weight, alpha;
    float around[3], across;
    float noise[2], hash, zero;
} test_result;

enum { MANY = 8192 };
static test_case cases[MANY];
static test_result results[MANY];

static void run(uint32_t count) {
    memset(results, 0, sizeof results);
    const compute_buffer buffers[] = {{0, cases, count * sizeof *cases},
                                      {1, results, count * sizeof *results}};
    const uint32_t push[4] = {0, count, 0, 0};
    compute_run(masu_spv_vndf_comp, sizeof masu_spv_vndf_comp, buffers, 2, push, (count + 63) / 64);
}

static uint64_t state = 1;

static void direction(float low, float out[3]) {
    double z = (double)low + (1 - (double)low) * (double)random_float(&state),
           phi = 6.283185307 * (double)random_float(&state);
    out[0] = (float)(sqrt(1 - z * z) * cos(phi));
    out[1] = (float)(sqrt(1 - z * z) * sin(phi));
    out[2] = (float)z;
}

static test_case any_case(void) {
    test_case c = {.roughness = random_float(&state),
                   .u = {random_float(&state), random_float(&state)}};
    float other[3];
    direction(0.002f, c.view);
    direction(-1, c.normal);
    direction(-0.2f, other);
    c.other[0] = other[0];
    c.other[1] = other[1];
    c.other_z = other[2];
    for (int k = 0; k < 3; k++) c.noise[k] = random_word(&state);
    return c;
}

static double apart(const float got[3], vec3 want) {
    double off = fabs((double)got[0] - (double)want.x);
    off = worst_of(off, fabs((double)got[1] - (double)want.y));
    return fmax(off, fabs((double)got[2] - (double)want.z));
}

/* Directions relative to the width of the lobe. Vulkan allows errors of 2^-11 in sine, and
 * SwiftShader has them: they rotate a direction slightly about the lobe's centre, the more the
 * farther out it is. */
static void the_gpu_draws_what_c_draws(void **unused) {
    (void)unused;
    for (int i = 0; i < MANY; i++) cases[i] = any_case();
    run(MANY);
    double l_off = 0, weight_off = 0, pdf_off = 0, other_off = 0, frame_off = 0;
    for (int i = 0; i < MANY; i++) {
        const test_case *c = &cases[i];
        const test_result *got = &results[i];
        vec3 v = vec3(c->view[0], c->view[1], c->view[2]);
        vec3 o = vec3(c->other[0], c->other[1], c->other_z);
        float alpha = masu_alpha(c->roughness);
        masu_vndf_ray r = masu_vndf_reflect(v, alpha, vec2(c->u[0], c->u[1]));
        l_off = worst_of(l_off, apart(got->l, r.l) / (double)alpha);
        /* Density and weight of the device's own l, because the different l has a larger effect
         * than their errors. */
        vec3 own = vec3(got->l[0], got->l[1], got->l[2]);
        float pdf = masu_vndf_pdf(v, own, alpha), weight = masu_vndf_weight(v, own, alpha);
        pdf_off = worst_of(pdf_off, fabs((double)(got->pdf - pdf)) / (1e-3 + (double)pdf));
        weight_off = worst_of(weight_off, fabs((double)(got->weight - weight)));
        float far = masu_vndf_pdf(v, o, alpha);
        other_off =
            worst_of(other_off, fabs((double)(got->other_pdf - far)) / (1e-3 + (double)far));
        weight = masu_vndf_weight(v, o, alpha);
        weight_off = worst_of(weight_off, fabs((double)(got->other_weight - weight)));
        masu_axes f = masu_axes_of(vec3(c->normal[0], c->normal[1], c->normal[2]));
        frame_off = worst_of(frame_off, apart(got->around, masu_axes_out(f, own)));
        frame_off = worst_of(frame_off, fabs((double)got->across));
        /* Integers: exact. */
        vec2 n = masu_noise2(c->noise[0], c->noise[1]);
        uint32_t hash = masu_hash(c->noise[2]) >> 9 | 0x3F800000u, there;
        memcpy(&there, &got->hash, sizeof there);
        assert_true(n.x == got->noise[0] && n.y == got->noise[1] && hash == there);
    }
    print_message(
        "  off: l %.1e of alpha, weight %.1e, density %.1e and %.1e of itself, frame %.1e\n", l_off,
        weight_off, pdf_off, other_off, frame_off);
    assert_true(l_off < 0.03 && weight_off < 1e-4 && pdf_off < 1e-2 && other_off < 1e-4);
    assert_true(frame_off < 2e-6);
}

static void assert_total(uint32_t count, const char *what) {
    run(count);
    for (uint32_t i = 0; i < count; i++) {
        const test_result *r = &results[i];
        double size = 0, around = 0;
        for (int k = 0; k < 3; k++) {
            size += (double)r->l[k] * (double)r->l[k];
            around += (double)r->around[k] * (double)r->around[k];
        }
        int unit_length = fabs(size - 1) < 2e-3 && fabs(around - 1) < 2e-3;
        int weights = r->weight >= 0 && r->weight <= 1 && r->other_weight >= 0;
        int densities = isfinite(r->pdf) && r->pdf >= 0 && isfinite(r->other_pdf);
        if (!unit_length || !weights || !(r->other_weight <= 1) || !densities ||
            !(r->other_pdf >= 0) || !(r->noise[0] < 1) || !(r->noise[1] < 1))
            fail_msg("%s, case %u: |l|^2 %g, weight %g and %g, density %g and %g", what, i, size,
                     (double)r->weight, (double)r->other_weight, (double)r->pdf,
                     (double)r->other_pdf);
    }
}

/* Roughness 0, 1e-4, 1, NaN, alphas that masu_alpha never gives, views from below, corners of u. */
static void odd_surfaces_give_finite_directions(void **unused) {
    (void)unused;
    static const float roughness[] = {0,      1e-4f,      1,       NAN,       INFINITY,
                                      -1,     0.0450001f, 0.0451f, -INFINITY, 1.0000001f,
                                      1.002f, 1.5f,       3,       1e30f};
    static const float heights[] = {-1, -1e-3f, -1e-8f, 0, 1e-8f, 1e-4f, 1, NAN};
    static const float corners[] = {0, 1, 0.99999994f, 0.5f, 2, -1, NAN, 1e-30f};
    uint32_t count = 0;
    for (size_t r = 0; r < sizeof roughness / sizeof *roughness; r++) {
        for (int k = 0; k < 512; k++) {
            test_case c = any_case();
            c.roughness = roughness[r];
            c.view[2] = heights[k & 7];
            c.u[0] = corners[k >> 3 & 7];
            c.u[1] = corners[k >> 6 & 7];
            if (k % 5 == 0) {
                c.other[0] = -c.view[0];
                c.other[1] = -c.view[1];
                c.other_z = -c.view[2];
            }
            c.normal[2] = k % 3 ? c.normal[2] : -1;
            cases[count++] = c;
        }
    }
    assert_total(count, "odd");
    /* A perfect mirror. */
    for (count = 0; count < 64; count++) {
        cases[count] = any_case();
        cases[count].roughness = count & 1 ? 1e-4f : 0;
    }
    assert_total(count, "mirror");
    for (uint32_t i = 0; i < count; i++) {
        const float *v = cases[i].view;
        assert_true(apart(results[i].l, vec3(-v[0], -v[1], v[2])) < 1e-6);
    }
}

static void any_bits_give_finite_directions(void **unused) {
    (void)unused;
    for (uint32_t i = 0; i < MANY; i++) {
        uint32_t words[sizeof(test_case) / 4];
        for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
            words[k] = random_word(&state);
            if (random_word(&state) % 8 == 0) words[k] |= 0x7F800000u; /* NaN or Inf */
        }
        memcpy(&cases[i], words, sizeof words);
        if (i % 4 == 0) { /* only one member is unusual */
            cases[i] = any_case();
            ((uint32_t *)(void *)&cases[i])[random_word(&state) % 12] = words[0];
        }
    }
    assert_total(MANY, "bits");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gpu_draws_what_c_draws),
        cmocka_unit_test(odd_surfaces_give_finite_directions),
        cmocka_unit_test(any_bits_give_finite_directions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
