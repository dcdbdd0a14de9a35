/* test_meso.c: shaders/brdf/meso.glsl on the GPU equals tools/meso/model.c, and is finite for any
 * input. */
#include "meso/model.h"
#include "support/support.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/compute.h"

#include "meso_comp.spv.h"

#include <math.h>
#include <string.h>

enum { MANY = 8192 };

typedef struct test_case {
    float curves[MASU_MESO_NUMBERS];
    float view[4], light[4], normal[4], color[4];
} test_case;

typedef struct test_result {
    float normal[4], color[4], rest[4];
} test_result;

static test_case cases[MANY];
static test_result results[MANY];

static uint64_t state = 1;

static float between(double low, double high) {
    return (float)(low + (high - low) * (double)random_float(&state));
}

static void direction(float out[4]) {
    double up = (double)between(0, 1), turn = (double)between(0, 6.2831853);
    double side = sqrt(1 - up * up);
    out[0] = (float)(side * cos(turn));
    out[1] = (float)up;
    out[2] = (float)(side * sin(turn));
}

static void run(void) {
    memset(results, 0, sizeof results);
    const compute_buffer buffers[] = {{0, cases, sizeof cases}, {1, results, sizeof results}};
    const uint32_t push[4] = {0, MANY, 0, 0};
    compute_run(masu_spv_meso_comp, sizeof masu_spv_meso_comp, buffers, 2, push, (MANY + 63) / 64);
}

static masu_meso_vec3 vec3_of(const float v[4]) {
    return masu_bake_v3((double)v[0], (double)v[1], (double)v[2]);
}

static void the_gpu_says_what_the_model_says(void **unused) {
    (void)unused;
    for (int i = 0; i < MANY; i++) {
        test_case *c = &cases[i];
        for (uint32_t k = 0; k < MASU_MESO_NUMBERS; k++) c->curves[k] = between(-2, 2);
        c->curves[3] = between(0, 1);  /* facet */
        c->curves[7] = between(-4, 4); /* spread, from here on beyond its clamps */
        c->curves[19] = between(-8, 8);
        c->curves[23] = between(-8, 8);
        c->curves[11] = between(0, 3); /* alpha */
        c->curves[15] = between(0, 2); /* offset */
        direction(c->view);
        direction(c->light);
        direction(c->normal);
        c->normal[3] = between(0, 1);
        for (int k = 0; k < 4; k++) c->color[k] = between(0, 1);
    }
    run();
    double worst = 0;
    for (int i = 0; i < MANY; i++) {
        const test_case *c = &cases[i];
        masu_meso_curves curves;
        double *number =
            curves.tilt; /* the struct is an array of numbers: checked in tools/meso/fit.c */
        double all[MASU_MESO_NUMBERS];
        for (uint32_t k = 0; k < MASU_MESO_NUMBERS; k++) all[k] = (double)c->curves[k];
        memcpy(number, all, sizeof curves);
        masu_meso_vec3 v = vec3_of(c->view);
        masu_meso_surface s = {vec3_of(c->normal),
                               {(double)c->color[0], (double)c->color[1], (double)c->color[2]},
                               (double)c->normal[3],
                               (double)c->color[3],
                               1,
                               1};
        masu_meso_bend(&curves, v, masu_bake_v3(0, 1, 0), &s);
        const double want[12] = {s.normal.x,
                                 s.normal.y,
                                 s.normal.z,
                                 s.roughness,
                                 s.color[0],
                                 s.color[1],
                                 s.color[2],
                                 s.ao,
                                 s.specular,
                                 s.shadow,
                                 masu_meso_shadow(&s, v, vec3_of(c->light)),
                                 0};
        float got[12];
        memcpy(got, &results[i], sizeof got);
        for (int k = 0; k < 12; k++) worst = worst_of(worst, fabs((double)got[k] - want[k]));
    }
    print_message("  error of %.1e at most\n", worst);
    /* A tilt that almost flips the normal leaves a short vector to be normalised. */
    assert_true(worst < 1e-3);
}

/* The extreme numbers that a blob may have, and surfaces at their limits. */
static void the_widest_numbers_give_finite_surfaces(void **unused) {
    (void)unused;
    for (int i = 0; i < MANY; i++) {
        test_case *c = &cases[i];
        static const float limit[] = {-1000, -1, -1e-30f, 0, 1e-40f, 1, 1000};
        for (uint32_t k = 0; k < MASU_MESO_NUMBERS; k++)
            c->curves[k] = limit[random_word(&state) % 7];
        c->curves[3] = random_word(&state) & 1 ? 1 : 0;
        for (uint32_t k = 11; k < 16; k += 4) c->curves[k] = random_word(&state) & 1 ? 4 : 0;
        direction(c->view);
        direction(c->light);
        direction(c->normal);
        if (random_word(&state) & 1) memcpy(c->normal, c->view, 3 * sizeof(float));
        if (random_word(&state) & 1) c->view[0] = c->view[2] = 0, c->view[1] = 1;
        c->normal[3] = random_word(&state) & 1 ? 1 : 0;
        for (int k = 0; k < 4; k++) c->color[k] = random_word(&state) & 1 ? 1 : 0;
    }
    run();
    for (int i = 0; i < MANY; i++) {
        float got[12];
        memcpy(got, &results[i], sizeof got);
        for (int k = 0; k < 12; k++) assert_true(isfinite(got[k]));
        for (int k = 3; k < 11; k++) assert_true(got[k] >= 0 && got[k] <= 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gpu_says_what_the_model_says),
        cmocka_unit_test(the_widest_numbers_give_finite_surfaces),
    };
    return cmocka_run_group_tests_name("meso", tests, NULL, NULL);
}
