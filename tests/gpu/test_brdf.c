/* test_brdf.c: shaders/brdf/bsdf.glsl on the GPU: equal to the model in double precision
 * (tests/reference/brdf.h, tested by tests/unit/test_brdf.c), reciprocal, white in the white
 * furnace, finite for any input; and the same from the G-buffer of a frame. */
#include "reference/brdf.h"
#include "shared/masu_shared.h"
#include "split_sum.h"
#include "support/support.h"
#include "support/random.h"
#include "support/floats.h"
#include "support/compute.h"

#include "brdf_comp.spv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct test_case {
    float albedo[3], roughness;
    float metallic, specular, coat, coat_roughness;
    float normal[4], view[4], light[4]; /* normal[3], view[3]: components of the base's normal under
                                           a coat */
} test_case;

typedef struct test_result {
    float light[4], diffuse[4], specular[3], coat;
} test_result;

static uint32_t table[MASU_TABLE_WORDS_ALL];

static void run(test_case *cases, test_result *results, uint32_t count, uint32_t mode,
                uint32_t steps) {
    memcpy(table, masu_split_sum, sizeof table);
    memset(results, 0, count * sizeof *results);
    const compute_buffer buffers[] = {{0, cases, count * sizeof *cases},
                                      {1, results, count * sizeof *results},
                                      {MASU_BIND_TABLES, table, sizeof table}};
    const uint32_t push[4] = {mode, count, steps, 0};
    compute_run(masu_spv_brdf_comp, sizeof masu_spv_brdf_comp, buffers, 3, push, (count + 63) / 64);
}

/* ---- Random numbers -------------------------------------------------------------------------- */

static uint64_t state = 1;

static void direction(float out[4]) {
    double z = (double)random_float(&state), phi = 6.283185307179586 * (double)random_float(&state);
    z = fmax(z * z, 1e-3);
    out[0] = (float)(sqrt(1 - z * z) * cos(phi));
    out[1] = (float)(sqrt(1 - z * z) * sin(phi));
    out[2] = (float)z;
    out[3] = 0;
}

static test_case any_case(void) {
    test_case c = {.albedo = {random_float(&state), random_float(&state), random_float(&state)},
                   .roughness = random_float(&state),
                   .specular = random_float(&state)};
    c.metallic = random_word(&state) & 1 ? 0 : random_float(&state);
    c.coat = random_word(&state) & 1 ? 0 : random_float(&state);
    c.coat_roughness = random_float(&state);
    c.normal[2] = 1;
    direction(c.view);
    direction(c.light);
    /* Half are near the mirror direction, inside the lobe. */
    if (random_word(&state) & 1) {
        double spread = 0.3 * (double)(c.roughness * c.roughness), size = 0;
        for (int k = 0; k < 3; k++) {
            double l = k == 2 ? (double)c.view[k] : -(double)c.view[k];
            c.light[k] = (float)(l + spread * ((double)random_float(&state) - 0.5));
        }
        if (c.light[2] < 1e-3f) c.light[2] = 1e-3f;
        for (int k = 0; k < 3; k++) size += (double)c.light[k] * (double)c.light[k];
        for (int k = 0; k < 3; k++) c.light[k] = (float)((double)c.light[k] / sqrt(size));
    }
    return c;
}

static brdf_surface surface_of(const test_case *c) {
    brdf_surface s = {{(double)c->albedo[0], (double)c->albedo[1], (double)c->albedo[2]},
                      (double)c->roughness,
                      (double)c->metallic,
                      (double)c->specular,
                      (double)c->coat,
                      (double)c->coat_roughness};
    return s;
}

/* ---- Tests ----------------------------------------------------------------------------------- */

enum { MANY = 8192 };
static test_case cases[2 * MANY];
static test_result results[2 * MANY];

static void surfaces_are_those_of_the_reference(void **unused) {
    (void)unused;
    for (int i = 0; i < MANY; i++) cases[i] = any_case();
    run(cases, results, MANY, 0, 0);
    double worst = 0, worst_broad = 0;
    for (int i = 0; i < MANY; i++) {
        brdf_surface s = surface_of(&cases[i]);
        double v[3], l[3], truth[3];
        for (int k = 0; k < 3; k++)
            v[k] = (double)cases[i].view[k], l[k] = (double)cases[i].light[k];
        brdf_eval(masu_split_sum, &s, v, l, truth);
        for (int k = 0; k < 3; k++) {
            double off = fabs((double)results[i].light[k] - truth[k]) / (1e-3 + truth[k]);
            double alpha = fmax(s.roughness, s.coat > 0 ? s.coat_roughness : 1);
            if (alpha > 0.2 && s.roughness > 0.2 && !(s.coat > 0 && s.coat_roughness < 0.2))
                worst_broad = worst_of(worst_broad, off);
            worst = worst_of(worst, off);
        }
    }
    print_message("  error of %.1e relative to (0.001 + value) at most, %.1e if roughness is "
                  "above 0.2\n",
                  worst, worst_broad);
    /* In a lobe 0.002 wide, the step of a component of h, 6e-8, is a thousandth of 0.06 of its
     * width. */
    assert_true(worst < 2e-3);
    assert_true(worst_broad < 1e-4);
}

/* A coat with a different normal from the base's, +z: by 45 degrees at most. */
static void coats_may_lean(void **unused) {
    (void)unused;
    for (int i = 0; i < MANY; i++) {
        test_case *c = &cases[i];
        *c = any_case();
        c->coat = fmaxf(c->coat, 0.25f);
        c->roughness = fmaxf(c->roughness, 0.1f);
        c->coat_roughness = fmaxf(c->coat_roughness, 0.1f);
        double z = 0.7 + 0.3 * (double)random_float(&state),
               phi = 6.283185307179586 * (double)random_float(&state);
        /* and with its axes inverted */
        if (i & 1) z = -z, c->view[2] = -c->view[2], c->light[2] = -c->light[2];
        c->normal[0] = (float)(sqrt(1 - z * z) * cos(phi));
        c->normal[1] = (float)(sqrt(1 - z * z) * sin(phi));
        c->normal[2] = (float)z;
        double n[3] = {(double)c->normal[0], (double)c->normal[1], (double)c->normal[2]};
        float *v = c->view; /* visible from the coat's side, as in images */
        while ((double)v[0] * n[0] + (double)v[1] * n[1] + (double)v[2] * n[2] < 1e-3) {
            direction(v);
            if (i & 1) v[2] = -v[2];
        }
        double s = n[2] < 0 ? -1 : 1; /* the base's normal is (0, 0, s): its components along both
                                         axes (masu_lean_axes) */
        c->normal[3] = (float)(s * -s * n[0]);
        c->view[3] = (float)(s * -n[1]);
    }
    run(cases, results, MANY, 0, 0);
    double worst = 0, beneath = 0;
    for (int i = 0; i < MANY; i++) {
        brdf_surface s = surface_of(&cases[i]);
        /* about the axis x: -z becomes z, y becomes -y */
        double v[3], l[3], n[3], truth[3], turn = i & 1 ? -1 : 1;
        for (int k = 0; k < 3; k++) {
            double t = k ? turn : 1;
            v[k] = t * (double)cases[i].view[k], l[k] = t * (double)cases[i].light[k];
            n[k] = t * (double)cases[i].normal[k];
        }
        brdf_over(masu_split_sum, &s, n, v, l, truth);
        beneath += n[0] * l[0] + n[1] * l[1] + n[2] * l[2] <= 0;
        for (int k = 0; k < 3; k++)
            worst =
                worst_of(worst, fabs((double)results[i].light[k] - truth[k]) / (1e-3 + truth[k]));
    }
    print_message("  error of %.1e relative to (0.001 + value) at most; %.0f lights are below the "
                  "coat's horizon\n",
                  worst, beneath);
    assert_true(worst < 1e-3);
    assert_true(beneath > 100);
}

/* Half floats: errors below 1e-3, with a coat 8e-3, also at grazing angles, where little light is
 * diffuse. */
static void half_floats_keep_grazing_light(void **unused) {
    (void)unused;
    static test_result exact[MANY];
    for (int i = 0; i < MANY; i++) {
        cases[i] = any_case();
        if (i & 1) cases[i].coat = 0;
    }
    run(cases, exact, MANY, 0, 0);
    run(cases, results, MANY, 2, 0);
    double worst[2] = {0, 0};
    uint32_t differ = 0;
    for (int i = 0; i < MANY; i++) {
        const float *a = exact[i].light, *b = results[i].light;
        double value = (double)fmaxf(a[0], fmaxf(a[1], a[2])) + 1e-3 * (double)cases[i].light[2];
        for (int k = 0; k < 3; k++) {
            double off = fabs((double)a[k] - (double)b[k]) / value;
            worst[cases[i].coat > 0] = worst_of(worst[cases[i].coat > 0], off);
            differ += a[k] != b[k];
        }
    }
    print_message("  half floats: error of %.1e at most, %.1e with a coat\n", worst[0], worst[1]);
    assert_true(differ > MANY); /* they are used */
    assert_true(worst[0] < 1e-3 && worst[1] < 8e-3);
}

static void light_and_view_may_be_exchanged(void **unused) {
    (void)unused;
    for (int i = 0; i < MANY; i++) {
        cases[2 * i] = any_case();
        cases[2 * i + 1] = cases[2 * i];
        memcpy(cases[2 * i + 1].view, cases[2 * i].light, sizeof cases[0].view);
        memcpy(cases[2 * i + 1].light, cases[2 * i].view, sizeof cases[0].light);
    }
    run(cases, results, 2 * MANY, 0, 0);
    double worst = 0;
    for (int i = 0; i < MANY; i++) {
        for (int k = 0; k < 3; k++) {
            double a = (double)results[2 * i].light[k] / (double)cases[2 * i].light[2];
            double b = (double)results[2 * i + 1].light[k] / (double)cases[2 * i + 1].light[2];
            worst = worst_of(worst, fabs(a - b) / (1e-6 + fmax(a, b)));
        }
    }
    print_message("  f(v, l) and f(l, v) differ by %.1e of themselves at most\n", worst);
    assert_true(worst < 2e-5);
}

#define ROUGHNESSES 33
static const double angles[] = {0, 20, 45, 60, 72, 80, 85, 88, 89, 89.6, 89.9};
#define ANGLES (sizeof angles / sizeof *angles)

typedef struct material {
    const char *name;
    float metallic, specular, coat, coat_roughness;
} material;

static const material materials[] = {{"metal", 1, 0.5f, 0, 0},
                                     {"metal, coat 0.5", 1, 0.5f, 0.5f, 0.1f},
                                     {"metal, coat 1", 1, 0.5f, 1, 0},
                                     {"metal, coat 1 of 0.5", 1, 0.5f, 1, 0.5f},
                                     {"dielectric, specular 0", 0, 0, 0, 0},
                                     {"dielectric, specular 0.5", 0, 0.5f, 0, 0},
                                     {"dielectric, specular 1", 0, 1, 0, 0},
                                     {"dielectric, coat 0.5", 0, 0.5f, 0.5f, 0},
                                     {"dielectric, coat 1", 0, 0.5f, 1, 0.2f}};
#define MATERIALS (sizeof materials / sizeof *materials)

static void in_the_white_furnace_no_light_is_lost_or_made(void **unused) {
    (void)unused;
    uint32_t each = ROUGHNESSES * ANGLES, count = 0;
    for (size_t m = 0; m < MATERIALS; m++) {
        for (int r = 0; r < ROUGHNESSES; r++) {
            for (size_t a = 0; a < ANGLES; a++) {
                double angle = angles[a] * 3.14159265358979323846 / 180;
                cases[count++] = (test_case){.albedo = {1, 1, 1},
                                             .roughness = (float)r / (ROUGHNESSES - 1),
                                             .metallic = materials[m].metallic,
                                             .specular = materials[m].specular,
                                             .coat = materials[m].coat,
                                             .coat_roughness = materials[m].coat_roughness,
                                             .normal = {0, 0, 1, 0},
                                             .view = {(float)sin(angle), 0, (float)cos(angle), 0}};
            }
        }
    }
    run(cases, results, count, 1, 48);
    double apart = 0;
    for (size_t m = 0; m < MATERIALS; m++) {
        double low = 1e9, high = 0;
        for (uint32_t i = 0; i < each; i++) {
            const test_result *r = &results[m * each + i];
            low = fmin(low, (double)r->light[0]);
            high = fmax(high, (double)r->light[0]);
            /* The three factors of ambient light agree with the furnace. */
            double all = (double)r->diffuse[0] + (double)r->specular[0] + (double)r->coat;
            apart = worst_of(apart, fabs(all - 1));
        }
        print_message("  %-26s %.4f to %.4f\n", materials[m].name, low, high);
        assert_true(low > 0.99 && high < 1.01);
    }
    print_message("  ambient factors: error %.1e\n", apart);
    assert_true(apart < 1e-5);
}

static int finite_result(const test_result *r) {
    for (int k = 0; k < 3; k++) {
        if (!isfinite(r->light[k]) || !isfinite(r->diffuse[k]) || !isfinite(r->specular[k]))
            return 0;
        if (r->light[k] < 0) return 0;
    }
    return isfinite(r->coat);
}

/* Roughness 0, 1e-4, 1 and NaN; views from below; then random bits. */
static void any_bits_give_finite_light(void **unused) {
    (void)unused;
    const float roughness[] = {0, 1e-4f, 1, NAN, INFINITY, -1, 1e30f};
    uint32_t count = 0;
    for (size_t i = 0; i < sizeof roughness / sizeof *roughness; i++) {
        for (int k = 0; k < 64; k++) {
            test_case c = any_case();
            c.roughness = roughness[i];
            c.coat_roughness = roughness[(i + (size_t)k) % 7];
            const float heights[] = {-1, -1e-3f, 0, 1e-8f};
            c.view[2] = heights[k % 4];
            if (k & 4) memcpy(c.light, (float[]){-c.view[0], -c.view[1], -c.view[2], 0}, 16);
            cases[count++] = c;
        }
    }
    uint32_t known = count;
    for (; count < MANY; count++) {
        uint32_t words[sizeof(test_case) / 4];
        for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
            words[k] = random_word(&state);
            if (random_word(&state) % 8 == 0) words[k] |= 0x7F800000u; /* NaN or Inf */
        }
        memcpy(&cases[count], words, sizeof words);
        if (count % 4 == 0) { /* only one member is unusual */
            test_case c = any_case();
            ((uint32_t *)(void *)&c)[random_word(&state) % (sizeof c / 4)] = words[0];
            cases[count] = c;
        }
    }
    run(cases, results, count, 0, 0);
    for (uint32_t i = 0; i < count; i++) {
        if (!finite_result(&results[i]))
            fail_msg("case %u: %s: not finite", i, i < known ? "known" : "random");
    }
}

/* ---- Whole frames ---------------------------------------------------------------------------- */

enum { W = 160, H = 90 };

/* scenes/surfaces.json with only the sun, from the G-buffer's own texels: plain surfaces and coated
 * ones. The remaining error is the half float of the image. */
static void a_frame_shows_what_the_formulas_say(void **unused) {
    (void)unused;
    static uint32_t normals[W * H];
    static uint8_t albedo[4 * W * H];
    static uint16_t hdr[4 * W * H];
    masu_session s;
    masu_commands commands;
    masu_session_desc d = test_desc("surfaces", W, H);
    d.desc.readback = MASU_READBACK_ALBEDO | MASU_READBACK_NORMAL | MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = 1;
    const masu_camera camera = {.position = {0, 2, 9}, .forward = {0, 0, -1}, .fov_y = 0.6f};
    const masu_light light = {.sun_direction = {0.3f, 0.6f, 0.742f}, .sun_color = {2, 2, 2}};
    const masu_frame_desc frame = {.camera = &camera, .light = &light};
    open_session(&s, &d);
    draw(&s, &frame, &commands, NULL);
    const struct {
        masu_readback_bits bit;
        void *to;
        size_t bytes;
    } images[] = {{MASU_READBACK_ALBEDO, albedo, sizeof albedo},
                  {MASU_READBACK_NORMAL, normals, sizeof normals},
                  {MASU_READBACK_HDR, hdr, sizeof hdr}};
    for (size_t i = 0; i < 3; i++) {
        memcpy(images[i].to, read_image(&s, commands.slot, images[i].bit), images[i].bytes);
    }
    double most = on_gpu(&s) ? 0.01 : 0.005; /* an NVIDIA H200: 0.0071, for an unknown reason */
    close_session(&s);
    double sun[3] = {0.3, 0.6, 0.742}, size = sqrt(0.3 * 0.3 + 0.6 * 0.6 + 0.742 * 0.742);
    double worst[2] = {0, 0}, sum[2] = {0, 0};
    uint32_t counts[2] = {0, 0};
    for (int k = 0; k < 3; k++) sun[k] /= size;
    for (int i = 0; i < W * H; i++) {
        for (int k = 0; k < 3; k++) assert_true(isfinite(half_float(hdr[4 * i + k])));
        if (!normals[i]) continue;
        float unpacked[3];
        masu_unpack_normal(normals[i], unpacked);
        int coated = (normals[i] >> 26 & 15) == 12; /* the row with metallic 0.8 */
        double n[3] = {(double)unpacked[0], (double)unpacked[1], (double)unpacked[2]};
        double scale = tan(0.3), v[3] = {-((i % W + 0.5) / W * 2 - 1) * scale * W / H,
                                         ((i / W + 0.5) / H * 2 - 1) * scale, 1};
        size = sqrt(v[0] * v[0] + v[1] * v[1] + 1);
        for (int k = 0; k < 3; k++) v[k] /= size;
        /* n becomes z. */
        double x[3] = {n[2], 0, -n[0]}, length = sqrt(n[2] * n[2] + n[0] * n[0]);
        if (length < 1e-3) x[0] = length = 1;
        for (int k = 0; k < 3; k++) x[k] /= length;
        double y[3] = {n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2],
                       n[0] * x[1] - n[1] * x[0]};
        double to_v[3] = {0, 0, 0}, to_l[3] = {0, 0, 0}, expected[3];
        for (int k = 0; k < 3; k++) {
            to_v[0] += x[k] * v[k], to_v[1] += y[k] * v[k], to_v[2] += n[k] * v[k];
            to_l[0] += x[k] * sun[k], to_l[1] += y[k] * sun[k], to_l[2] += n[k] * sun[k];
        }
        brdf_surface surface = {.roughness = albedo[4 * i + 3] / 255.0,
                                .metallic = (normals[i] >> 26 & 15) / 15.0,
                                .specular = 128 / 255.0,
                                .coat = coated,
                                .coat_roughness = 1 / 15.0};
        for (int k = 0; k < 3; k++) surface.albedo[k] = pow(albedo[4 * i + k] / 255.0, 2);
        brdf_eval(masu_split_sum, &surface, to_v, to_l, expected);
        for (int k = 0; k < 3; k++) {
            double off =
                fabs(half_float(hdr[4 * i + k]) - 2 * expected[k]) / (0.05 + 2 * expected[k]);
            worst[coated] = worst_of(worst[coated], off);
            sum[coated] += off;
        }
        counts[coated] += 3;
    }
    for (int c = 0; c < 2; c++) {
        print_message("  %s: %u values, error of %.4f relative to (0.05 + value) at most, %.5f in "
                      "the mean\n",
                      c ? "coated" : "plain", counts[c], worst[c], sum[c] / counts[c]);
        assert_true(counts[c] > 1000);
        assert_true(worst[c] < most && sum[c] / counts[c] < 0.001);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_those_of_the_reference),
        cmocka_unit_test(coats_may_lean),
        cmocka_unit_test(half_floats_keep_grazing_light),
        cmocka_unit_test(light_and_view_may_be_exchanged),
        cmocka_unit_test(in_the_white_furnace_no_light_is_lost_or_made),
        cmocka_unit_test(any_bits_give_finite_light),
        cmocka_unit_test(a_frame_shows_what_the_formulas_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
