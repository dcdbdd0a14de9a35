/* test_model.c: `masu-lab model` on a driver: counts of shaders with counters, bytes of passes
 * with given sizes, sums, and that rungs have rows for the passes that they run. */
#include "support/support.h"
#include "plan/compile.h"

#include "support/cli.h"
#include "support/compute.h"

#include "lab/model/hook.h"
#include "lab/model/write.h"
#include "tally_comp.spv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Two rungs: everything, and half the size without reflections. */
#define LADDER_HEAD                                                                                \
    "{\"scene\": \"a.masu\", \"driver\": \"D\", \"width\": 32, \"height\": 24, \"clock\": \"wall\", "   \
    "\"error\": \"flip\", \"rungs\": ["
static const char ladder[] = LADDER_HEAD
    "{\"setting\": \"all\", \"ratio\": 1.0, \"flip\": 0.1, \"knobs\": {\"scale\": 1}},\n"
    "{\"setting\": \"half\", \"ratio\": 0.5, \"flip\": 0.2, "
    "\"knobs\": {\"scale\": 0.5, \"specular\": \"off\"}}]}";

static void model_of(const char *scene, const char *path, uint32_t width, uint32_t height,
                     uint32_t drawn_width, uint32_t drawn_height, masu_model_sheet *out) {
    masu_model_desc d = {.scene_path = scene_path(scene),
                         .ladder_path = path,
                         .size = {width, height},
                         .drawn = {drawn_width, drawn_height},
                         .time = 0.5,
                         .host = {.validate = true}};
    uint32_t messages = 1;
    char error[ERROR_SIZE];
    assert_ok(masu_model_run(&d, out, &messages, error, sizeof error));
    assert_int_equal(messages, 0);
}

/* Rounds of a loop, atomics of all invocations, bytes. */
static void a_loop_is_counted_round_by_round(void **state) {
    enum { N = 128 };
    static float values[N], expected[N];
    uint32_t counts[MASU_TALLY_WORDS] = {0};
    const uint32_t push[4] = {0};
    masu_tally t;
    (void)state;
    for (uint32_t i = 0; i < N; i++) {
        float x = values[i] = (float)i;
        for (uint32_t k = 0; k < i; k++) x = x * 0.5f + 1.0f;
        expected[i] = x;
    }
    assert_true(masu_tally_make(masu_spv_tally_comp, sizeof masu_spv_tally_comp / 4, 0, 0, &t));
    compute_buffer buffers[] = {{0, counts, sizeof counts}, {1, values, sizeof values}};
    compute_run(t.words, t.word_count * 4, buffers, 2, push, N / 64);
    for (uint32_t i = 0; i < N; i++) assert_true(fabsf(values[i] - expected[i]) < 1e-4f);
    assert_int_equal(counts[0], N);
    /* A round: a comparison, a step, and a fused multiply-add, which counts two; at the end one
     * more comparison. */
    assert_int_equal(counts[1], 3 * (N - 1) + 1);
    assert_int_equal(masu_tally_sum(counts, 0), 3 * (N * (N - 1) / 2) + N);
    assert_int_equal(masu_tally_sum(counts, 1), 4 * (N * (N - 1) / 2) + N);
    uint32_t found = 0;
    for (uint32_t n = 2; n < t.count; n++) {
        if (t.numbers[n].binding != 1) continue;
        assert_int_equal(masu_tally_sum(counts, n), 4 * N);
        found |= 1u << t.numbers[n].kind;
    }
    assert_int_equal(found, 1u << MASU_TALLY_LOADED | 1u << MASU_TALLY_STORED);
    free(t.words);
}

/* Polygons, SDF, reflections of both, with and without a shadow map: the image with counters
 * equals the one without, and every written pixel is counted once. */
static void counters_change_no_pixel(void **state) {
    enum { W = 96, H = 64 };
    static uint8_t plain[W * H * 4], counted[W * H * 4];
    static const char *const scenes[] = {"mirrors", "wet_city"};
    static masu_frame_plan plan;
    (void)state;
    for (size_t i = 0; i < (long_run() ? sizeof scenes / sizeof *scenes : 1); i++) {
        masu_session_desc d = test_desc(scenes[i], W, H);
        uint32_t passes[MASU_PASS_COUNT], shaders;
        char error[ERROR_SIZE];
        masu_session s;
        masu_detail detail;
        d.desc.debug.counters = 0;
        open_session(&s, &d);
        for (uint32_t frame = 0; frame < 3; frame++) draw_rung(&s, 2, plain);
        close_session(&s);
        d.no_renderer = d.host.stores = true;
        d.desc.ray_query = MASU_OFF;
        d.host.get_instance_proc_addr = masu_hook_get_instance_proc_addr;
        open_session(&s, &d);
        assert_int_equal(masu_compile(&s.desc, 256, 64, &plan, &detail), MASU_OK);
        uint32_t n = masu_count_passes(&plan, passes);
        assert_ok(masu_hook_begin(&s.host, passes, n, error, sizeof error));
        assert_ok(masu_session_start(&s, error, sizeof error));
        assert_ok(masu_hook_good(error, sizeof error));
        for (uint32_t frame = 0; frame < 3; frame++) {
            masu_hook_clear();
            draw_rung(&s, 2, counted);
        }
        assert_ok(masu_hook_read(error, sizeof error));
        assert_int_equal(max_difference(plain, counted, sizeof plain), 0);
        uint64_t written = 0;
        const masu_hook_shader *list = masu_hook_shaders(&shaders);
        for (uint32_t k = 0; k < shaders; k++) {
            for (uint32_t t = 2; t < list[k].tally.count && list[k].pass == MASU_PASS_RCAS; t++) {
                if (list[k].tally.numbers[t].kind == MASU_TALLY_WRITTEN)
                    written += masu_tally_sum(list[k].counts, t);
            }
        }
        assert_int_equal(written, W * H);
        masu_headless_settle(&s.host);
        masu_destroy(s.m);
        s.m = NULL;
        masu_hook_end();
        close_session(&s);
    }
}

static void check_sums(const masu_model_sheet *m) {
    for (uint32_t r = 0; r < m->rung_count; r++) {
        const masu_model_rung *one = &m->rungs[r];
        double bytes = 0.0, operations = 0.0, floor[MASU_MODEL_CLASSES] = {0};
        for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
            if (!one->rows[p].runs) continue;
            bytes += one->rows[p].bytes;
            operations += one->rows[p].weighted;
            for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++)
                floor[k] += masu_model_floor(&one->rows[p], k, NULL);
        }
        assert_true(fabs(bytes - one->sum.bytes) <= 1e-9 * bytes);
        assert_true(fabs(operations - one->sum.weighted) <= 1e-9 * operations);
        for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
            assert_true(fabs(floor[k] - one->floor[k]) <= 1e-9 * floor[k]);
            assert_true(one->realistic[k] >= 1.3 * one->floor[k] * (1.0 - 1e-9));
            assert_true(one->realistic[k] <= 2.5 * one->floor[k] * (1.0 + 1e-9));
        }
    }
}

static void assert_near(double given, double wanted, double part) {
    if (fabs(given - wanted) > part * wanted) fail_msg("%g instead of %g", given, wanted);
}

/* By hand: n pixels rendered, P shown. */
static void bytes_of_known_passes_are_those_worked_out_by_hand(void **state) {
    static masu_model_sheet m, larger;
    (void)state;
    const char *path = write_text("ladder.json", ladder);
    model_of("mirrors", path, 96, 64, 96, 64, &m);
    assert_int_equal(m.rung_count, 2);
    check_sums(&m);
    const double P = 96.0 * 64.0, n = P / 4.0;
    const masu_model_row *all = m.rungs[0].rows, *half = m.rungs[1].rows;
    assert_near(all[MASU_PASS_TONEMAP].bytes, 12.0 * P, 1e-9); /* rgba16f to rgba8 */
    assert_near(half[MASU_PASS_TONEMAP].bytes, 12.0 * n, 1e-9);
    assert_near(half[MASU_PASS_EASU_TWICE].bytes, 4.0 * n + 4.0 * P, 1e-9);
    assert_near(half[MASU_PASS_RCAS].bytes, 8.0 * P, 1e-9);
    assert_int_equal(half[MASU_PASS_RCAS].bytes_sure, MASU_MODEL_EXACT);
    /* depth, normal and the written occlusion; bytes of the shadow map depend on the scene */
    assert_true(half[MASU_PASS_SHADOW].bytes >= 12.0 * n);
    /* albedo, normal, depth at least, and vertices */
    assert_true(half[MASU_PASS_GBUFFER].bytes > 12.0 * n);
    assert_true(all[MASU_PASS_GBUFFER].bytes > 12.0 * P);
    /* EASU: 12 fetches for four pixels, 4 for flat ones; the sky and evenly lit parts are flat. */
    double easu = half[MASU_PASS_EASU_TWICE].plain / P;
    if (!(easu > 60.0 && easu < 300.0)) fail_msg("%g operations a pixel", easu);
    assert_false(half[MASU_PASS_EASU].runs || all[MASU_PASS_EASU_TWICE].runs);
    /* The rung's passes have rows. */
    uint32_t traced = 0;
    for (uint32_t p = MASU_PASS_SPECULAR_GUIDE; p <= MASU_PASS_SPECULAR_COMPOSITE; p++) {
        traced += all[p].runs;
        assert_false(half[p].runs);
        assert_true(half[p].bytes == 0.0 && half[p].weighted == 0.0);
    }
    assert_true(traced >= 8);
    assert_true(all[MASU_PASS_SPECULAR_TRACE].weighted > 0.0);
    assert_true(all[MASU_PASS_SPECULAR_TRACE].asked > 0.0);
    /* More pixels cost more; a scaled sheet equals one that is drawn at the full size. */
    model_of("mirrors", path, 192, 128, 96, 64, &larger);
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        assert_int_equal(larger.rungs[0].rows[p].runs, all[p].runs);
        if (all[p].runs && masu_passes[p].extent == MASU_EXTENT_RENDER)
            assert_true(larger.rungs[0].rows[p].weighted > 2.0 * all[p].weighted ||
                        p == MASU_PASS_GBUFFER);
    }
    model_of("mirrors", path, 192, 128, 192, 128, &m);
    assert_near(larger.rungs[0].sum.weighted, m.rungs[0].sum.weighted, 0.15);
    assert_near(larger.rungs[0].sum.bytes, m.rungs[0].sum.bytes, 0.15);
    assert_near(larger.rungs[1].rows[MASU_PASS_RCAS].bytes, 8.0 * 192.0 * 128.0, 1e-9);
}

/* Only an SDF, at the library's own rungs: each is faster than the one before. */
static void rungs_of_an_sdf_cost_less_one_by_one(void **state) {
    static masu_model_sheet m;
    (void)state;
    model_of("spheres", NULL, 96, 64, 96, 64, &m);
    assert_int_equal(m.rung_count, 3);
    check_sums(&m);
    assert_true(m.rungs[0].rows[MASU_PASS_MARCH].weighted > 0.0);
    for (uint32_t r = 1; r < m.rung_count; r++)
        assert_true(m.rungs[r].rows[MASU_PASS_MARCH].weighted <
                    m.rungs[r - 1].rows[MASU_PASS_MARCH].weighted);
    for (uint32_t k = 0; k < MASU_MODEL_CLASSES; k++) {
        for (uint32_t b = 0; b < MASU_MODEL_BUDGETS; b++) {
            int chosen = m.chosen[k][b], first = -1;
            for (int r = (int)m.rung_count - 1; r >= 0; r--) {
                if (m.rungs[r].realistic[k] <= masu_model_budgets[b]) first = r;
            }
            assert_int_equal(chosen, first);
        }
    }
}

static void the_command_writes_its_sheet_and_refuses_what_is_wrong(void **state) {
    static char arguments[600], text[1 << 16];
    (void)state;
    snprintf(arguments, sizeof arguments,
             "%s --size 64x48 --csv %s/m.csv --html-fragment %s/m.xhtml",
             scene_path("test_sphere_mesh"), scratch, scratch);
    assert_int_equal(cli_run("model %s", arguments), 0);
    take_text("out", text, sizeof text);
    assert_non_null(strstr(text, "COMPUTED"));
    assert_non_null(strstr(text, "tonemap"));
    take_text("m.csv", text, sizeof text);
    assert_non_null(strstr(text, "\nCOMPUTED,test_sphere_mesh.masu,64,48,0,"));
    take_text("m.xhtml", text, sizeof text);
    assert_non_null(strstr(text, "<caption>COMPUTED"));
    assert_null(strstr(text, "instructions by"));
    assert_int_equal(cli_run("model"), 2);
    /* RADV compiles for raven without the GPU. Other GPUs represent no class. */
    snprintf(arguments, sizeof arguments,
             "%s --size 64x48 --drawn 64x48 --isa raven --csv %s/i.csv",
             scene_path("test_sphere_mesh"), scratch);
    int code = cli_run("model %s", arguments);
    take_text("err", text, sizeof text);
    if (code && strstr(text, "RADV is not installed")) skip();
    assert_int_equal(code, 0);
    take_text("out", text, sizeof text);
    assert_non_null(strstr(text, "Vega8: instructions by the compiler of raven"));
    take_text("i.csv", text, sizeof text);
    assert_non_null(strstr(text, ",COMPUTED instructions raven\n"));
    const char *tone = strstr(text, ",tonemap,"), *end = tone ? strchr(tone, '\n') : NULL;
    assert_non_null(end);
    while (end[-1] != ',') end--;
    double per_pixel = strtod(end, NULL) / (64 * 48);
    if (!(per_pixel > 20 && per_pixel < 500))
        fail_msg("%g instructions of tonemap for each pixel", per_pixel);
    snprintf(arguments, sizeof arguments, "%s --isa navi14", scene_path("test_sphere_mesh"));
    assert_int_equal(cli_run("model %s", arguments), 2);
    take_text("err", text, sizeof text);
    assert_non_null(strstr(text, "has no class for navi14"));
    snprintf(arguments, sizeof arguments, "%s --ladder auto", scene_path("test_sphere_mesh"));
    assert_int_equal(cli_run("model %s", arguments), 2);
    snprintf(arguments, sizeof arguments, "%s --ladder %s/none.json",
             scene_path("test_sphere_mesh"), scratch);
    assert_int_equal(cli_run("model %s", arguments), 1);
    take_text("err", text, sizeof text);
    assert_non_null(strstr(text, "none.json"));
    const char *bad = write_text(
        "bad.json", LADDER_HEAD "{\"setting\": \"a\", \"ratio\": 1, \"flip\": 0, "
                                "\"knobs\": {\"aa\": \"many\"}}]}");
    snprintf(arguments, sizeof arguments, "%s --ladder %s", scene_path("test_sphere_mesh"), bad);
    assert_int_equal(cli_run("model %s", arguments), 1);
    take_text("err", text, sizeof text);
    assert_non_null(strstr(text, "bad.json: rungs[0]: aa"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_is_counted_round_by_round),
        cmocka_unit_test(counters_change_no_pixel),
        cmocka_unit_test(bytes_of_known_passes_are_those_worked_out_by_hand),
        cmocka_unit_test(rungs_of_an_sdf_cost_less_one_by_one),
        cmocka_unit_test(the_command_writes_its_sheet_and_refuses_what_is_wrong),
    };
    cli_program = "masu-lab";
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
