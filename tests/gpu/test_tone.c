/* test_tone.c: tone curves, encodings and auto-exposure on the GPU against tests/reference/tone.h
 * in double precision: separately for arbitrary input, and in frames. */
#include "reference/tone.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"
#include "support/compute.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/support.h"

#include "tone_comp.spv.h"

#include <math.h>
#include <string.h>

typedef struct test_result {
    float none[4], filmic[4], neutral[4], pq[4];
} test_result;

enum { CASES_MAX = 4096 };
static float cases[CASES_MAX][4];
static test_result results[CASES_MAX];
static uint64_t seed = 7;

static void run(uint32_t count, float most) {
    uint32_t push[4] = {count, 0, 0, 0};
    memcpy(&push[1], &most, sizeof most);
    memset(results, 0, sizeof results);
    const compute_buffer buffers[] = {{0, cases, count * sizeof *cases},
                                      {1, results, count * sizeof *results}};
    compute_run(masu_spv_tone_comp, sizeof masu_spv_tone_comp, buffers, 2, push, (count + 63) / 64);
}

/* Spread over 2^-20 to 2^14, sometimes black. */
static float random_radiance(void) {
    uint32_t r = random_word(&seed);
    return r % 16 ? exp2f((float)(r >> 8) / 16777216.0f * 34.0f - 20.0f) : 0.0f;
}

static double worst_code(const float got[4], const double linear[3]) {
    double worst = 0;
    for (int c = 0; c < 3; c++) {
        double d = fabs((double)got[c] - masu_ref_srgb_encode(linear[c]));
        worst = d < worst ? worst : d; /* NaN is the worst */
    }
    return worst;
}

static void curves_are_those_of_the_reference(void **state) {
    (void)state;
    static const float mosts[] = {1.0f, 12.5f};
    for (uint32_t i = 0; i < CASES_MAX; i++) {
        for (int c = 0; c < 3; c++) cases[i][c] = random_radiance();
        cases[i][3] = i % 4 ? 1.0f : exp2f((float)(i % 20) - 10.0f);
    }
    for (int m = 0; m < 2; m++) {
        double none = 0, filmic = 0, neutral = 0, pq = 0, back = 0;
        run(CASES_MAX, mosts[m]);
        for (uint32_t i = 0; i < CASES_MAX; i++) {
            double x[3], y[3];
            for (int c = 0; c < 3; c++) x[c] = (double)(cases[i][c] * cases[i][3]);
            masu_ref_tone(MASU_REF_TONE_NONE, 1, x, y);
            none = worst_of(none, worst_code(results[i].none, y));
            for (int c = 0; c < 3; c++)
                pq = worst_of(pq, fabs((double)results[i].pq[c] - masu_ref_pq_encode(100 * y[c])));
            double nits = fmin(100 * y[0], 1e4);
            back = worst_of(back, fabs((double)results[i].pq[3] - nits) / (nits + 0.01));
            masu_ref_tone(MASU_REF_TONE_ACES, 1, x, y);
            filmic = worst_of(filmic, worst_code(results[i].filmic, y));
            masu_ref_tone(MASU_REF_TONE_NEUTRAL, (double)mosts[m], x, y);
            neutral = worst_of(neutral, worst_code(results[i].neutral, y));
            assert_float_equal(results[i].neutral[3], (float)y[0], 1e-4f * (float)(1 + fabs(y[0])));
        }
        print_message("most %g: error in 255ths: none %.4f, filmic %.4f, neutral %.4f; PQ %.6f of "
                      "1, there and back %.5f of itself\n",
                      (double)mosts[m], 255 * none, 255 * filmic, 255 * neutral, pq, back);
        assert_true(none < 0.1 / 255 && filmic < 0.1 / 255 && neutral < 0.1 / 255);
        assert_true(pq < 0.25 / 1023);
        assert_true(back < 0.005);
    }
}

static void curves_rise_from_black_to_the_most(void **state) {
    (void)state;
    static const float mosts[] = {1.0f, 4.0f};
    for (uint32_t i = 0; i < CASES_MAX; i++) {
        float x = i ? exp2f((float)i / (CASES_MAX - 1) * 40.0f - 24.0f) : 0.0f;
        cases[i][0] = cases[i][1] = cases[i][2] = x, cases[i][3] = 1.0f;
    }
    for (int m = 0; m < 2; m++) {
        run(CASES_MAX, mosts[m]);
        assert_true(results[0].none[0] == 0 && results[0].filmic[0] == 0);
        assert_true(results[0].neutral[0] == 0 && results[0].pq[0] < 1e-5f);
        for (uint32_t i = 1; i < CASES_MAX; i++) {
            assert_true(results[i].none[0] >= results[i - 1].none[0] - 1e-6f);
            assert_true(results[i].filmic[0] >= results[i - 1].filmic[0] - 1e-6f);
            assert_true(results[i].neutral[3] >= results[i - 1].neutral[3] - 1e-5f * mosts[m]);
            assert_true(results[i].pq[0] >= results[i - 1].pq[0] - 1e-5f);
        }
        const test_result *last = &results[CASES_MAX - 1];
        assert_true(last->none[0] >= 0.99999f && last->filmic[0] >= 0.99999f);
        assert_true(last->neutral[3] > 0.999f * mosts[m] && last->neutral[3] <= mosts[m]);
    }
}

static const uint32_t hostile[] = {0x7FC00000u, 0xFFC00000u, 0x7F800001u, 0x7F800000u, 0xFF800000u,
                                   0x80000000u, 0xBF800000u, 0x00000001u, 0x477FE000u, 0x477FF000u,
                                   0x7149F2CAu, 0xF149F2CAu, 0x7F7FFFFFu, 0x3F800000u};
enum { HOSTILE = sizeof hostile / sizeof *hostile };

static void whatever_comes_in_a_finite_colour_goes_out(void **state) {
    (void)state;
    uint32_t count = 0;
    for (uint32_t i = 0; i < HOSTILE; i++) {
        for (uint32_t j = 0; j < HOSTILE; j++, count++) {
            const uint32_t bits[4] = {hostile[i], hostile[j], 0x3F000000u,
                                      j % 2 ? 0x3F800000u : 0x4E6E6B28u /* 1e9 */};
            memcpy(cases[count], bits, sizeof bits);
        }
    }
    run(count, 1.0f);
    for (uint32_t i = 0; i < count; i++) {
        const float *all = results[i].none;
        for (uint32_t k = 0; k < sizeof *results / sizeof(float); k++) {
            if (k % 4 == 3) continue;
            if (!(all[k] >= 0 && all[k] <= 1.00001f))
                fail_msg("case %u, number %u: %g", i, k, (double)all[k]);
        }
        /* Values that are not finite are in no bin; NaN and -Inf are black, Inf is white. */
        uint32_t bits[2];
        memcpy(bits, cases[i], sizeof bits);
        if ((bits[0] & 0x7F800000u) == 0x7F800000u || (bits[1] & 0x7F800000u) == 0x7F800000u)
            assert_true(results[i].none[3] == MASU_EXPOSURE_BINS);
        if (bits[0] == 0x7F800000u) assert_true(all[0] >= 0.99999f);
        if (bits[0] == 0x7FC00000u || bits[0] == 0xFF800000u) assert_true(all[0] == 0);
    }
}

static void bins_are_eighths_of_octaves(void **state) {
    (void)state;
    for (uint32_t k = 0; k < 256; k++) {
        double edge = ldexp(1 + (k % 8) / 8.0, (int)(k / 8) - 16);
        for (int side = 0; side < 2; side++) { /* just below, just above */
            float *c = cases[2 * k + (uint32_t)side];
            c[0] = c[1] = c[2] = (float)(edge * (side ? 1.00001 : 0.99999)), c[3] = 1;
        }
    }
    run(512, 1.0f);
    for (uint32_t k = 0; k < 256; k++) {
        assert_true(results[2 * k].none[3] == (k ? (float)(k - 1) : (float)MASU_EXPOSURE_BINS));
        assert_true(results[2 * k + 1].none[3] == (float)k);
    }
}

/* ---- Exposure in frames ---------------------------------------------------------------------- */

enum { W = 32, H = 24 };
static masu_session s;

static void open_metered(const masu_exposure *exposure) {
    masu_session_desc d = test_desc("test_sphere_mesh", W, H);
    d.desc.rung_count = 1;
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.exposure = *exposure;
    d.desc.exposure.metered = MASU_ON;
    open_session(&s, &d);
}

/* Renders the scene with `scale` times the light; returns the exposure of the image. */
static float exposed(float scale, float step, int cut, uint8_t *pixels, double *mean, float low,
                     float high) {
    masu_light light;
    masu_commands commands;
    masu_stats_info stats;
    assert_int_equal(masu_light_of(s.m, &light, NULL), MASU_OK);
    for (int c = 0; c < 3; c++) {
        light.sun_color[c] *= scale, light.ambient[c] *= scale;
        light.sky_zenith[c] *= scale, light.sky_horizon[c] *= scale;
    }
    light.exposure = 1;
    masu_frame_desc frame = {.light = &light, .time_step = step, .cut = (uint32_t)cut};
    draw(&s, &frame, &commands, pixels);
    assert_int_equal(masu_stats(s.m, commands.slot, &stats, NULL), MASU_OK);
    if (mean) {
        static double rgb[W * H][3];
        const uint16_t *hdr = read_image(&s, commands.slot, MASU_READBACK_HDR);
        for (uint32_t i = 0; i < W * H; i++) {
            for (int c = 0; c < 3; c++) rgb[i][c] = half_float(hdr[4 * i + (uint32_t)c]);
        }
        assert_true(masu_ref_meter(rgb[0], W * H, 3, (double)low, (double)high, mean) > W * H / 2);
    }
    return stats.exposure;
}

static void the_mean_becomes_grey(void **state) {
    (void)state;
    static const float shares[][2] = {{0, 0}, {-1, -1}, {0.05f, 0.6f}};
    for (int i = 0; i < 3; i++) {
        masu_exposure e = {.low = shares[i][0], .high = shares[i][1]};
        float low = shares[i][0] < 0 ? 0 : shares[i][0] > 0 ? shares[i][0] : 0.1f;
        float high = shares[i][1] < 0 ? 0 : shares[i][1] > 0 ? shares[i][1] : 0.1f;
        open_metered(&e);
        for (int k = -2; k <= 2; k += 2) { /* each after a cut: adapts at once */
            double mean;
            float got = exposed(exp2f((float)(2 * k)), 0, 1, NULL, &mean, low, high);
            double wanted = fmin(1024, 0.18 / exp2(mean));
            assert_float_equal(got, (float)wanted, 1e-3f * (float)wanted);
        }
        close_session(&s);
    }
    /* The bounds are kept. */
    open_metered(&(masu_exposure){.min = 0.5f, .max = 2.0f});
    assert_float_equal(exposed(1000, 0, 1, NULL, NULL, 0, 0), 0.5f, 1e-5f);
    assert_float_equal(exposed(0.001f, 0, 1, NULL, NULL, 0, 0), 2.0f, 1e-5f);
    close_session(&s);
}

/* Exposure after `seconds` in steps of 1 / rate, starting from an image of brightness `from`. */
static float after(float from, float to, uint32_t rate, float seconds, float *wanted) {
    *wanted = exposed(to, 0, 1, NULL, NULL, 0, 0);
    float e = exposed(from, 0, 1, NULL, NULL, 0, 0);
    uint32_t frames = (uint32_t)(seconds * (float)rate + 0.5f);
    for (uint32_t i = 0; i < frames; i++)
        e = exposed(to, 1.0f / (float)rate, 0, NULL, NULL, 0, 0);
    return e;
}

static void it_adapts_by_time_and_not_by_frames(void **state) {
    (void)state;
    static const float ways[][2] = {{1, 16}, {1, 0.0625f}};
    open_metered(&(masu_exposure){.brighten = 3, .darken = 8});
    for (int i = 0; i < 2; i++) {
        float wanted, a = after(ways[i][0], ways[i][1], 30, 0.2f, &wanted);
        float b = after(ways[i][0], ways[i][1], 120, 0.2f, &wanted);
        float from = exposed(ways[i][0], 0, 1, NULL, NULL, 0, 0);
        double share = exp(-0.2 * (i ? 3.0 : 8.0)); /* brighter image: darken */
        double exact = exp2(log2((double)wanted) + share * log2((double)(from / wanted)));
        print_message("%s: %g of %g; 30 and 120 frames a second differ by %.4f %%, %.4f %% off\n",
                      i ? "brightens" : "darkens", (double)a, (double)wanted,
                      100 * fabs((double)(a / b) - 1), 100 * fabs((double)a / exact - 1));
        assert_float_equal(a, b, 0.01f * b);
        assert_float_equal(a, (float)exact, 0.01f * (float)exact);
        assert_true(fabs(log2((double)(a / wanted))) > 0.3); /* still adapting */
    }
    /* A time step of 0, a negative one, and a huge one. */
    float wanted = exposed(4, 0, 1, NULL, NULL, 0, 0), still = exposed(1, 0, 1, NULL, NULL, 0, 0);
    assert_true(exposed(4, 0, 0, NULL, NULL, 0, 0) == still);
    assert_true(exposed(4, -5, 0, NULL, NULL, 0, 0) == still);
    assert_float_equal(exposed(4, 1e15f, 0, NULL, NULL, 0, 0), wanted, 1e-4f * wanted);
    close_session(&s);
    open_metered(&(masu_exposure){0}); /* the very first frame */
    assert_float_equal(exposed(4, 0.01f, 0, NULL, NULL, 0, 0), wanted, 1e-4f * wanted);
    close_session(&s);
}

static void the_same_frames_give_the_same_bits(void **state) {
    (void)state;
    static uint8_t a[4 * W * H], b[4 * W * H];
    float e[2];
    for (int i = 0; i < 2; i++) {
        open_metered(&(masu_exposure){0});
        for (int k = 0; k < 5; k++) e[i] = exposed(k < 2 ? 1 : 8, 0.1f, 0, i ? b : a, NULL, 0, 0);
        close_session(&s);
    }
    assert_true(e[0] == e[1]);
    assert_int_equal(max_difference(a, b, sizeof a), 0);
}

static void a_scene_may_ask_for_it(void **state) {
    (void)state;
    static double rgb[W * H][3];
    masu_session_desc d = test_desc("test_exposure", W, H);
    d.desc.readback = MASU_READBACK_HDR;
    d.desc = masu_session_resolved(&d.desc); /* before the scene is given, as tools do */
    for (int off = 0; off < 2; off++) {
        masu_stats_info stats;
        masu_readback_image image;
        double mean;
        d.desc.exposure.metered = off ? MASU_OFF : MASU_AUTO;
        open_session(&s, &d);
        draw_rung(&s, 0, NULL);
        assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
        assert_int_equal(masu_readback(s.m, 0, MASU_READBACK_HDR, &image, NULL), MASU_OK);
        const uint16_t *hdr = image.pixels;
        for (uint32_t i = 0; i < W * H; i++) {
            for (uint32_t c = 0; c < 3; c++) rgb[i][c] = half_float(hdr[4 * i + c]);
        }
        assert_true(masu_ref_meter(rgb[0], W * H, 3, 0.1, 0.1, &mean) > 0);
        double wanted = 2 * 0.18 / exp2(mean); /* the scene's factor is 2 */
        assert_float_equal(stats.exposure, off ? 0.0f : (float)wanted, 1e-3f * (float)wanted);
        assert_true(masu_scene_data_of(&s.scene)->metered == 1 &&
                    masu_scene_data_of(&s.scene)->darken == 5 &&
                    masu_scene_data_of(&s.scene)->brighten == 0);
        close_session(&s);
    }
}

static void what_is_not_metered_costs_nothing(void **state) {
    (void)state;
    static masu_plan_info with, without;
    masu_session_desc d = test_desc("test_sphere_mesh", W, H);
    masu_detail detail;
    masu_memory_row rows[MEMORY_ROWS];
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_plan(&s.desc, &without, &detail), MASU_OK);
    s.desc.exposure.metered = MASU_ON;
    assert_int_equal(masu_plan(&s.desc, &with, &detail), MASU_OK);
    for (uint32_t p = 0; p < with.pass_count; p++) {
        int meters =
            !strcmp(with.passes[p].name, "meter") || !strcmp(with.passes[p].name, "expose");
        assert_int_equal(with.passes[p].active, meters ? 7 : without.passes[p].active);
        if (meters) assert_int_equal(without.passes[p].active, 0);
    }
    assert_int_equal(with.rungs[0].dispatches, without.rungs[0].dispatches + 2);
    print_message("metered: %llu bytes of device memory more\n",
                  (unsigned long long)(with.memory.device_bytes - without.memory.device_bytes));
    assert_true(with.memory.device_bytes >= without.memory.device_bytes); /* there may be padding */
    assert_true(with.memory.device_bytes < without.memory.device_bytes + 4096);
    s.desc.exposure.metered = MASU_AUTO; /* the scene does not request it */
    char error[ERROR_SIZE];
    assert_ok(masu_session_start(&s, error, sizeof error));
    uint32_t n = memory_rows(s.m, rows);
    for (uint32_t i = 0; i < n; i++) assert_string_not_equal(rows[i].name, "exposure");
    draw_rung(&s, 0, NULL);
    masu_stats_info stats;
    assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
    assert_true(stats.exposure == 0);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_are_those_of_the_reference),
        cmocka_unit_test(curves_rise_from_black_to_the_most),
        cmocka_unit_test(whatever_comes_in_a_finite_colour_goes_out),
        cmocka_unit_test(bins_are_eighths_of_octaves),
        cmocka_unit_test(the_mean_becomes_grey),
        cmocka_unit_test(it_adapts_by_time_and_not_by_frames),
        cmocka_unit_test(the_same_frames_give_the_same_bits),
        cmocka_unit_test(a_scene_may_ask_for_it),
        cmocka_unit_test(what_is_not_metered_costs_nothing),
    };
    return cmocka_run_group_tests_name("tone", tests, NULL, NULL);
}
