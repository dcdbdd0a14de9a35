/* test_emission.c: the two texels of emissive surfaces (measure/texel.h, the C copy of
 * shaders/shared/pack.glsl), of ray hits and of the G-buffer: rounding errors of materials, the lit
 * flag, and that any texels decode to numbers in range. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "measure/texel.h"
#include "shared/masu_shared.h"
#include "support/random.h"

static uint64_t state_of = 20;

static double any(void) { return random_unit(&state_of); }

static uint32_t round_trip(const double m[8], double out[8]) {
    uint8_t albedo[4];
    uint32_t normal;
    masu_texel_pack_met(m, albedo, &normal);
    assert_int_equal(normal & 0x3FFFFFF, 0);
    masu_texel_unpack_met(albedo, normal, out);
    return normal;
}

static void what_emits_and_is_lit_is_rounded_so_far(void **state) {
    (void)state;
    double bright = 0, hue = 0, albedo = 0, rough = 0, dim = 0;
    for (int i = 0; i < 200000; i++) {
        double m[8], out[8], most = 0, kept = 0;
        double level = pow(2, -8 + 12 * any());
        for (int k = 0; k < 8; k++) m[k] = any();
        m[7] = any() < 0.5 ? 0 : 1;
        m[4 + i % 3] = 1;
        for (int c = 0; c < 3; c++) m[4 + c] *= level;
        uint32_t normal = round_trip(m, out);
        assert_true(normal >> 30 & MASU_SURFACE_EMISSIVE);
        assert_false(masu_texel_is_unlit(normal));
        for (int c = 0; c < 3; c++) {
            most = fmax(most, m[4 + c]);
            kept = fmax(kept, out[4 + c]);
            albedo = fmax(albedo, fabs(sqrt(m[c]) - sqrt(out[c])));
        }
        for (int c = 0; c < 3; c++)
            hue = fmax(hue, fabs(sqrt(m[4 + c] / most) - sqrt(out[4 + c] / kept)));
        if (level >= 1)
            bright = fmax(bright, fabs(kept / most - 1));
        else if (level >= 1.0 / 16)
            dim = fmax(dim, fabs(kept / most - 1));
        rough = fmax(rough, fabs(m[3] - out[3]));
        assert_true(m[7] == out[7]);
    }
    printf("  emission %.4f from 1 on, %.4f from 1/16 on, hue %.4f, albedo %.4f, roughness %.4f\n",
           bright, dim, hue, albedo, rough);
    assert_true(bright < 0.033 && dim < 0.066 && hue < 1 / 23.9 && albedo < 1 / 61.9 &&
                rough < 1 / 25.9);
    assert_true(bright > 0.025 && hue > 1 / 26.0); /* and the trials reach it */
}

static void what_is_black_keeps_eight_bits(void **state) {
    (void)state;
    for (int i = 0; i < 20000; i++) {
        double m[8] = {0, 0, 0, any(), 16 * any(), 16 * any(), 16 * any(), 0}, out[8];
        uint32_t normal = round_trip(m, out);
        assert_false(masu_texel_is_unlit(normal));
        for (int c = 0; c < 3; c++)
            assert_true(fabs(sqrt(m[4 + c] / 16) - sqrt(out[4 + c] / 16)) < 0.501 / 255 &&
                        out[c] == 0);
        assert_true(fabs(m[3] - out[3]) < 0.501 / 255 && out[7] == 0);
    }
}

static void what_is_lit(void **state) {
    (void)state;
    static const struct {
        double m[8];
        int emits, unlit;
    } cases[] = {{{0, 0, 0, 1, 1, 0, 0, 0}, 1, 1},       {{0, 0, 0, 1, 0, 0, 0, 0}, 0, 0},
                 {{0, 0, 0, 0.99, 1, 0, 0, 0}, 1, 0},    {{0, 0.01, 0, 1, 1, 0, 0, 0}, 1, 0},
                 {{0.5, 0.5, 0.5, 1, 1, 1, 1, 1}, 1, 0}, {{0, 0, 0, 1, 0, 0.0009, 0, 0}, 0, 0},
                 {{0, 0, 0, 1, 0, 0.001, 0, 1}, 1, 1},   {{1, 1, 1, 0, 0, 0, -1, 0}, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double out[8];
        uint32_t normal = round_trip(cases[i].m, out);
        assert_int_equal(normal >> 30 & MASU_SURFACE_EMISSIVE, cases[i].emits);
        assert_int_equal(masu_texel_is_unlit(normal), cases[i].unlit);
        assert_int_equal(masu_texel_unlit(cases[i].m), cases[i].unlit);
    }
}

static void any_texels_are_materials(void **state) {
    (void)state;
    for (int i = 0; i < 200000; i++) {
        uint32_t word = (uint32_t)support_random(&state_of),
                 normal = (uint32_t)support_random(&state_of);
        uint8_t texel[4];
        double m[8];
        memcpy(texel, &word, sizeof texel);
        masu_texel_unpack_met(texel, normal, m);
        for (int k = 0; k < 8; k++) assert_true(m[k] >= 0 && m[k] <= (k >= 4 && k < 7 ? 33 : 1));
    }
}

/* Emission costs the G-buffer nothing: base colour and roughness keep 8 bits, metallic 15 of 16
 * steps. */
static void the_gbuffer_keeps_the_base_beside_emission(void **state) {
    (void)state;
    for (int i = 0; i < 20000; i++) {
        double m[8], out[8];
        uint8_t albedo[4];
        uint32_t normal;
        for (int k = 0; k < 8; k++) m[k] = any();
        m[4] = 0.01 + 60000 * any();
        masu_texel_pack(m, albedo, &normal);
        masu_texel_unpack(albedo, normal, out);
        assert_true(normal >> 30 & MASU_SURFACE_EMISSIVE);
        assert_false(masu_texel_is_unlit(normal));
        for (int c = 0; c < 3; c++) assert_true(fabs(sqrt(m[c]) - sqrt(out[c])) < 0.501 / 255);
        assert_true(fabs(m[3] - out[3]) < 0.501 / 255 && fabs(m[7] - out[7]) < 0.501 / 14);
    }
    const double lamp[8] = {0, 0, 0, 1, 3, 2, 1, 0};
    uint8_t albedo[4];
    uint32_t normal;
    masu_texel_pack(lamp, albedo, &normal);
    assert_true(masu_texel_is_unlit(normal));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gbuffer_keeps_the_base_beside_emission),
        cmocka_unit_test(what_emits_and_is_lit_is_rounded_so_far),
        cmocka_unit_test(what_is_black_keeps_eight_bits),
        cmocka_unit_test(what_is_lit),
        cmocka_unit_test(any_texels_are_materials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
