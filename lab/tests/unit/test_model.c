/* test_model.c: counts and computations of the model sheet, without a device: costs of instructions
 * on modules made for the test and on EASU's, counters added to every kind of shader, rows and sums
 * of a sheet with given counts, rungs from JSON. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "settings/setting.h"
#include "plan/compile.h"
#include "lab/model/sheet.h"
#include "lab/model/write.h"
#include "lab/model/spirv_reach.h"
#include "lab/model/spirv_tally.h"
#include "support/files.h"
#include "support/spirv.h"

#include "bilinear_comp.spv.h"
#include "easu_bytes_comp.spv.h"
#include "easu_bytes_exact_comp.spv.h"
#include "gbuffer_textured_frag.spv.h"
#include "gbuffer_vert.spv.h"
#include "rcas_bytes_comp.spv.h"
#include "rcas_bytes_exact_comp.spv.h"
#include "specular_trace_comp.spv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Costs ----------------------------------------------------------------------------------- */

static masu_spirv_cost cost_of_source(const char *body) {
    char text[1024];
    spirv_module m;
    snprintf(text, sizeof text,
             "#version 440\nlayout(set = 0, binding = 0) buffer B { vec4 a, b, c; mat3 m; uvec4 u; "
             "ivec4 i; };\nvoid main() { %s }\n",
             body);
    int good = spirv_compile(write_text("cost.comp", text), "", &m);
    if (!good) fail_msg("does not compile: %s", body);
    masu_spirv_cost cost = masu_spirv_cost_straight(&m);
    spirv_free(&m);
    return cost;
}

/* Each computed by hand: components times the cost of one. */
static void costs_are_those_counted_by_hand(void **state) {
    static const struct {
        const char *body;
        uint32_t plain, weighted;
    } cases[] = {
        {"a = b;", 0, 0},
        {"a = b + c;", 4, 4},
        {"a = -b;", 0, 0},
        {"a = fma(a, b, c);", 4, 8},
        {"a.xyz = sqrt(b.xyz);", 3, 12},
        {"a.x = b.x / c.x;", 1, 5},
        {"a.x = dot(b.xyz, c.xyz);", 5, 5},
        {"a.x = dot(b, c);", 7, 7},
        {"a.xyz = m * b.xyz;", 15, 15},
        {"a.xyz = b.xyz * m;", 15, 15},
        {"m = m * m;", 45, 45},
        {"a.xyz = cross(b.xyz, c.xyz);", 9, 9},
        {"a.xyz = normalize(b.xyz);", 9, 12},
        {"a.x = length(b.xyz);", 6, 9},
        {"a = clamp(b, 0.0, 1.0);", 4, 8},
        {"a.x = pow(b.x, c.x);", 1, 9},
        {"u.x = u.y * u.z;", 1, 4},
        {"u.x = u.y / u.z;", 1, 20},
        {"i.xy = i.zw + i.xy;", 2, 2},
        {"a = vec4(u);", 4, 4},
        {"a.x = uintBitsToFloat(u.x);", 0, 0},
        {"a = mix(b, c, a);", 4, 8},
    };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        masu_spirv_cost cost = cost_of_source(cases[k].body);
        if (cost.plain != cases[k].plain || cost.weighted != cases[k].weighted)
            fail_msg("%s: %u, %u instead of %u, %u", cases[k].body, cost.plain, cost.weighted,
                     cases[k].plain, cases[k].weighted);
    }
}

static masu_spirv_cost straight(const uint32_t *words, size_t bytes) {
    spirv_module m;
    assert_true(spirv_from_words(words, bytes / 4, &m));
    masu_spirv_cost cost = masu_spirv_cost_straight(&m);
    spirv_free(&m);
    return cost;
}

/* For a branch that constants decide, only the taken side counts, however the constant is
 * tested. */
static void what_constants_leave_out_is_not_counted(void **state) {
    (void)state;
    static const char
        source[] = "#version 440\n"
                   "layout(constant_id = 3) const bool on = true;\n"
                   "layout(constant_id = 5) const uint kind = 2;\n"
                   "layout(set = 0, binding = 0) buffer B { vec4 a, b; uint n; };\n"
                   "vec4 twice(vec4 v) { return v + v; }\n" /* 4 */
                   "void main() {\n"
                   "    a += b;\n"                    /* 4 */
                   "    if (on) { a = a * b + b; }\n" /* 8 */
                   "    if (kind == 1u) { a = sqrt(a); } else if (kind + 1u > 2u) { a = twice(a * "
                   "b); }\n"                                       /* 4; 8 */
                   "    if (!on && n > 3u) { a.x = exp2(a.x); }\n" /* 1, 1 to test; a PHI */
                   "    switch (kind) { case 7u: a *= a; break; default: a.x *= 2.0; }\n" /* 4; 1 */
                   "    for (uint i = 0u; i < n; i++) { b += 1.0; if (kind == 9u) { b *= 3.0; } "
                   "}\n" /* 4, and the loop's; 4 */
                   "}\n";
    static const struct {
        uint32_t on, kind, counts; /* added to the common ones */
    } cases[] = {{1, 2, 4 + 8 + 8 + 1 + 4},     {0, 2, 4 + 8 + 1 + 4 + 1 + 1},
                 {0, 1, 4 + 4 + 1 + 4 + 1 + 1}, {1, 1, 4 + 8 + 4 + 1 + 4},
                 {1, 7, 4 + 8 + 8 + 4 + 4},     {1, 9, 4 + 8 + 8 + 1 + 4 + 4},
                 {1, 0, 4 + 8 + 1 + 4}};
    spirv_module m;
    assert_true(spirv_compile(write_text("constants.comp", source), "-O", &m) ||
                spirv_compile(write_text("constants.comp", source), "", &m));
    VkSpecializationMapEntry entries[] = {{3, 0, 4}, {5, 4, 4}};
    uint32_t base = 0, everything = masu_spirv_cost_straight(&m).plain;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        uint32_t data[] = {cases[k].on, cases[k].kind};
        VkSpecializationInfo special = {2, entries, sizeof data, data};
        uint32_t plain = masu_spirv_cost_reached(&m, &special).plain;
        if (!k) base = plain - cases[k].counts;
        if (plain != base + cases[k].counts)
            fail_msg("%u, %u: %u instead of %u", cases[k].on, cases[k].kind, plain,
                     base + cases[k].counts);
        assert_true(plain < everything);
    }
    /* Without values from the host the module's own values hold. */
    assert_int_equal(masu_spirv_cost_reached(&m, NULL).plain, base + cases[0].counts);
    VkSpecializationInfo other = {1, &(VkSpecializationMapEntry){4, 0, 4}, 4, &(uint32_t){0}};
    assert_int_equal(masu_spirv_cost_reached(&m, &other).plain, base + cases[0].counts);
    spirv_free(&m);
}

/* Operations of one loop. */
static uint32_t loop_cost(const char *loop) {
    char source[512], command[2048];
    spirv_module m;
    snprintf(source, sizeof source,
             "#version 440\n"
             "layout(local_size_x = 1) in;\n"
             "layout(set = 0, binding = 0) buffer block { vec4 a, b; uint n; };\n"
             "void main() { vec4 c = a; %s b = c; }\n",
             loop);
    const char *text = write_text("loop.comp", source);
    snprintf(command, sizeof command,
             "glslangValidator --quiet -V --target-env vulkan1.1 -o %s.spv %s && "
             "spirv-opt --target-env=vulkan1.1 -O %s.spv -o %s.spv",
             text, text, text, text);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof command, "%s.spv", text);
    assert_true(spirv_from_file(command, &m));
    uint32_t plain = masu_spirv_cost_reached(&m, NULL).plain;
    spirv_free(&m);
    return plain;
}

/* A loop that compilers unroll counts once per iteration; one of unknown or many iterations, with
 * many operations, or with another exit counts once. An iteration has 4 products, a comparison and
 * an addition. */
static void a_loop_that_compilers_unroll_counts_per_iteration(void **state) {
    (void)state;
    assert_int_equal(loop_cost("for (uint i = 0u; i < n; i++) c *= a;"), 6);
    assert_int_equal(loop_cost("for (uint i = 0u; i < 4u; i++) c *= a;"), 4 * 6);
    assert_int_equal(loop_cost("for (int i = 3; i < 12; i += 2) c *= a;"), 5 * 6);
    assert_int_equal(loop_cost("for (uint i = 0u; i < 32u; i++) c *= a;"), 32 * 6);
    assert_int_equal(loop_cost("for (uint i = 0u; i < 33u; i++) c *= a;"), 6);
    assert_int_equal(loop_cost("for (uint i = 0u; i < 32u; i++) c = sqrt(c) * a;"), 32 * 10);
    assert_int_equal(loop_cost("for (uint i = 0u; i < 32u; i++) c = sqrt(sqrt(c)) * a;"), 14);
    assert_int_equal(loop_cost("for (uint i = 0u; i < 4u; i++) { c *= a; if (c.x > 1.0) break; }"),
                     7);
}

/* By hand, EASU with debug.exact costs 794, without locating and bounding the pixel, plus 14 for
 * each of 36 numbers that may be of 10 bits; without debug.exact it costs about a third. RCAS costs
 * 175 per pixel; it computes two, from 24 numbers. */
static void easu_costs_about_what_was_counted_by_hand(void **state) {
    (void)state;
    masu_spirv_cost easu =
        straight(masu_spv_easu_bytes_exact_comp, sizeof masu_spv_easu_bytes_exact_comp);
    masu_spirv_cost rcas =
        straight(masu_spv_rcas_bytes_exact_comp, sizeof masu_spv_rcas_bytes_exact_comp);
    masu_spirv_cost quick_easu =
        straight(masu_spv_easu_bytes_comp, sizeof masu_spv_easu_bytes_comp);
    masu_spirv_cost quick_rcas =
        straight(masu_spv_rcas_bytes_comp, sizeof masu_spv_rcas_bytes_comp);
    masu_spirv_cost bilinear = straight(masu_spv_bilinear_comp, sizeof masu_spv_bilinear_comp);
    assert_in_range(easu.plain, 794 + 14 * 36 - 20, 794 + 14 * 36 + 20);
    assert_in_range(rcas.plain, 2 * 175 + 14 * 24 - 40, 2 * 175 + 14 * 24 + 40);
    assert_in_range(bilinear.plain, 81, 81 + 40);
    assert_true(easu.weighted >= easu.plain);
    assert_in_range(quick_easu.plain, 320, 370);
    assert_in_range(quick_rcas.plain, 140, 180);
}

/* ---- Counters -------------------------------------------------------------------------------- */

static bool counts_of(const masu_tally *t, masu_tally_kind kind, uint32_t set, uint32_t binding) {
    for (uint32_t n = 2; n < t->count; n++) {
        const masu_tally_number *one = &t->numbers[n];
        if (one->kind == kind && one->set == set && one->binding == binding) return true;
    }
    return false;
}

static masu_tally tally(const uint32_t *words, size_t bytes) {
    masu_tally t;
    spirv_module m;
    assert_true(masu_tally_make(words, bytes / 4, 3, 0, &t));
    assert_true(spirv_from_words(t.words, t.word_count, &m));
    spirv_free(&m);
    const char *path = write_bytes("counted.spv", t.words, (size_t)t.word_count * 4);
    assert_int_equal(shell("spirv-val --target-env vulkan1.1 %s", path), 0);
    free(t.words);
    return t;
}

static void a_counted_shader_is_a_valid_one_that_counts_each_access(void **state) {
    (void)state;
    masu_tally easu = tally(masu_spv_easu_bytes_comp, sizeof masu_spv_easu_bytes_comp);
    assert_int_equal(easu.model, 5);
    assert_true(counts_of(&easu, MASU_TALLY_FETCHED, MASU_SET_PASS, 0));
    assert_true(counts_of(&easu, MASU_TALLY_WRITTEN, MASU_SET_PASS, 1));
    masu_tally vertex = tally(masu_spv_gbuffer_vert, sizeof masu_spv_gbuffer_vert);
    assert_int_equal(vertex.model, 0);
    assert_true(counts_of(&vertex, MASU_TALLY_LOADED, MASU_SET_GLOBAL, MASU_BIND_INSTANCES));
    masu_tally fragment =
        tally(masu_spv_gbuffer_textured_frag, sizeof masu_spv_gbuffer_textured_frag);
    assert_int_equal(fragment.model, 4);
    assert_true(fragment.late); /* masks are cut */
    masu_tally trace = tally(masu_spv_specular_trace_comp, sizeof masu_spv_specular_trace_comp);
    assert_true(counts_of(&trace, MASU_TALLY_LOADED, MASU_SET_GLOBAL, MASU_BIND_TRACE));
    static const uint32_t none[] = {0x07230203, 0x10300, 0, 8, 0};
    masu_tally t;
    assert_false(masu_tally_make(none, 5, 3, 0, &t));
    assert_false(masu_tally_make(none, 1, 3, 0, &t));
}

/* ---- The sheet ------------------------------------------------------------------------------- */

/* An image from elsewhere, upscaled from half to full size and sharpened; drawn at half of
 * that. */
static void plan_upscaling(uint32_t width, uint32_t height, masu_frame_plan *plan) {
    masu_desc d = {
        MASU_DESC,
        .source = {.width = width / 2, .height = height / 2, .format = VK_FORMAT_R8G8B8A8_UNORM},
        .output = {width, height},
        .targets = {.storage = 1, .count = 1},
        .rung_count = 1};
    static VkImage image;
    static VkImageView view;
    masu_detail detail;
    memset(&image, 1, sizeof image);
    memset(&view, 1, sizeof view);
    d.source.view = view;
    d.targets.images = &image;
    d.targets.views = &view;
    d.debug.exact = 1; /* EASU, pixel by pixel */
    if (masu_compile(&d, 256, 64, plan, &detail)) fail_msg("refused: %s", detail.text);
}

static void count_of(masu_pass_count *c, double pixels, double plain, double weighted,
                     double fetched) {
    *c = (masu_pass_count){.invocations = pixels,
                           .plain = plain * pixels,
                           .weighted = weighted * pixels,
                           .most = plain,
                           .number_count = 2,
                           .numbers = {{MASU_TALLY_FETCHED, MASU_SET_PASS, 0, fetched * pixels},
                                       {MASU_TALLY_WRITTEN, MASU_SET_PASS, 1, pixels}}};
}

/* Drawn with 960x540 pixels; the sheet has four times as many. */
static void count_upscaling(masu_count *count, double pixels) {
    plan_upscaling(960, 540, &count->drawn);
    plan_upscaling(1920, 1080, &count->sheet);
    count->rung_count = 1;
    count_of(&count->passes[0][MASU_PASS_EASU], pixels, 800.0, 850.0, 12.0);
    count_of(&count->passes[0][MASU_PASS_RCAS], pixels, 100.0, 150.0, 5.0);
}

static void assert_near(double given, double wanted) {
    if (fabs(given - wanted) > 1e-9 * fabs(wanted))
        fail_msg("%.12g instead of %.12g", given, wanted);
}

static void the_sheet_has_the_numbers_worked_out_by_hand(void **state) {
    static masu_count count;
    static masu_model_sheet m;
    const double p = 960.0 * 540.0, P = 4.0 * p, n = p; /* n: half of P's sides */
    (void)state;
    count_upscaling(&count, p);
    masu_model_make(&count, NULL, &m);
    const masu_model_row *easu = &m.rungs[0].rows[MASU_PASS_EASU];
    const masu_model_row *rcas = &m.rungs[0].rows[MASU_PASS_RCAS];
    assert_true(easu->runs && rcas->runs && !m.rungs[0].rows[MASU_PASS_LIGHT].runs);
    assert_near(easu->bytes, 4.0 * n + 4.0 * P);
    assert_near(rcas->bytes, 8.0 * P);
    assert_near(easu->weighted, 850.0 * P);
    assert_int_equal(easu->bytes_sure, MASU_MODEL_EXACT);
    assert_int_equal(easu->weighted_sure, MASU_MODEL_EXACT);
    /* Xe80: 850 operations for 2.07 M pixels at 1.66 TFLOPS take 1.06 ms, 8 bytes at 68 GB/s
     * 0.24. */
    bool by_bytes;
    assert_near(masu_model_floor(easu, 0, &by_bytes), 850.0 * P / 1.66e9);
    assert_false(by_bytes);
    assert_near(masu_model_realistic(easu, 0), 2.5 * 850.0 * P / 1.66e9);
    assert_near(masu_model_floor(rcas, 0, &by_bytes), 8.0 * P / 68e6);
    assert_true(by_bytes);
    assert_near(masu_model_realistic(rcas, 0), 1.3 * 8.0 * P / 68e6);
    assert_near(m.rungs[0].sum.bytes, easu->bytes + rcas->bytes);
    assert_near(m.rungs[0].floor[0], 850.0 * P / 1.66e9 + 8.0 * P / 68e6);
    assert_int_equal(m.chosen[0][0], 0);  /* Xe80 */
    assert_int_equal(m.chosen[4][0], -1); /* 850 and 150 operations for 2 M pixels at 0.15 TFLOPS */
    assert_int_equal(m.chosen[4][1], -1);
    /* Pixels with different branches, and texels that are never fetched. */
    count.passes[0][MASU_PASS_EASU].most = 900.0;
    count.passes[0][MASU_PASS_RCAS].numbers[0].amount = 0.25 * p;
    masu_model_make(&count, NULL, &m);
    assert_int_equal(easu->weighted_sure, MASU_MODEL_MEASURED);
    assert_int_equal(rcas->bytes_sure, MASU_MODEL_MEASURED);
    assert_near(rcas->bytes, 4.0 * (0.25 * P + P));
}

static void add_row(masu_isa_rows *rows, const char *pipeline, const char *stage, uint32_t lanes,
                    double instructions, double waves, double cycles, double latency) {
    masu_isa_row *r = &rows->row[rows->count++];
    *r = (masu_isa_row){.lanes = lanes};
    snprintf(r->pipeline, sizeof r->pipeline, "%s", pipeline);
    snprintf(r->stage, sizeof r->stage, "%s", stage);
    for (int i = 0; i < MASU_ISA_FIELD_COUNT; i++) r->value[i] = (double)NAN;
    r->value[MASU_ISA_INSTRUCTIONS] = instructions;
    r->value[MASU_ISA_WAVES] = waves;
    r->value[MASU_ISA_CYCLES] = cycles;
    r->value[MASU_ISA_LATENCY] = latency;
}

/* Pipelines of a pass are summed; of several widths the widest counts, binning does not. */
static void instructions_of_compilers_are_found_by_pass_and_stage(void **state) {
    static masu_isa_rows rows;
    static masu_issued issued;
    const double no = (double)NAN;
    (void)state;
    masu_issued_make(&rows, &issued);
    assert_false(issued.known);
    add_row(&rows, "easu", "Compute Shader", 64, 400, 8, 100, 1600);
    add_row(&rows, "rcas", "Compute Shader", 64, 90, 16, 100, 1500);
    add_row(&rows, "gbuffer", "vertex", 8, 50, no, 10, no);
    add_row(&rows, "gbuffer", "SIMD8 fragment", 8, 70, no, 10, no);
    add_row(&rows, "gbuffer", "SIMD16 fragment", 16, 60, no, 10, no);
    add_row(&rows, "transparents", "SIMD16 fragment", 16, 210, no, 10, no);
    add_row(&rows, "transparents", "SIMD32 fragment", 32, 400, no, 10, no);
    add_row(&rows, "cascades, masks", "FS", 64, 44, no, no, no);
    add_row(&rows, "gbuffer, masks", "SIMD8 fragment", 8, 200, no, 10, no);
    add_row(&rows, "cascade_0", "VS", 64, 33, 4, no, no);
    add_row(&rows, "cascade_0", "Binning VS", 64, 30, 4, no, no);
    add_row(&rows, "no_such_pass", "compute", 64, 1, 1, 1, 1);
    masu_issued_make(&rows, &issued);
    assert_true(issued.known);
    assert_near(issued.pass[MASU_PASS_EASU].instructions[0], 400);
    assert_near(issued.pass[MASU_PASS_EASU].waits, 2); /* 1600 cycles, of which 8 waves fill 800 */
    assert_near(issued.pass[MASU_PASS_RCAS].waits, 1);
    assert_near(issued.pass[MASU_PASS_GBUFFER].instructions[0], 260);
    assert_near(issued.pass[MASU_PASS_GBUFFER].instructions[1], 50);
    assert_near(issued.pass[MASU_PASS_CASCADE_0].instructions[1], 33);
    assert_near(issued.pass[MASU_PASS_CASCADE_0].instructions[0], 44);
    /* Two of 32 lanes count as one. */
    assert_near(issued.pass[MASU_PASS_TRANSPARENTS].instructions[0], 200);
    assert_near(issued.pass[MASU_PASS_CASCADE_0].waits, 1);
}

static void the_sheet_counts_the_compilers_instructions_where_it_was_asked(void **state) {
    static masu_count count;
    static masu_model_sheet m;
    static masu_issued issued[MASU_MODEL_CLASSES];
    const double p = 960.0 * 540.0, P = 4.0 * p;
    (void)state;
    count_upscaling(&count, p);
    count.straight[MASU_PASS_EASU][0] = 400.0; /* half of what runs: a loop of two rounds */
    issued[0].known = true;
    issued[0].pass[MASU_PASS_EASU].instructions[0] = 600.0;
    issued[0].pass[MASU_PASS_EASU].waits = 1.25;
    issued[0].pass[MASU_PASS_RCAS].instructions[0] = 90.0; /* `straight` is 0: once per
                                                            * invocation */
    issued[0].pass[MASU_PASS_RCAS].waits = 1.0;
    masu_model_make(&count, issued, &m);
    const masu_model_row *easu = &m.rungs[0].rows[MASU_PASS_EASU],
                         *rcas = &m.rungs[0].rows[MASU_PASS_RCAS];
    assert_near(easu->issued[0], 800.0 * P * 1.5);
    assert_near(rcas->issued[0], 90.0 * P);
    assert_near(m.rungs[0].sum.issued[0], 1290.0 * P);
    /* One instruction of a lane is half of the two operations of a fused multiply-add. */
    assert_near(masu_model_floor(easu, 0, NULL), 1200.0 * P / 0.83e9);
    assert_near(masu_model_realistic(easu, 0), 1.5 * 1.25 * 1200.0 * P / 0.83e9);
    /* The other classes are unchanged. */
    assert_near(easu->issued[1], 0.0);
    assert_near(masu_model_floor(easu, 1, NULL), 850.0 * P / 0.42e9);
    assert_true(m.issued[0] && !m.issued[1]);
}

static void what_is_computed_says_so(void **state) {
    static masu_model_sheet m;
    char *text = NULL;
    size_t bytes = 0;
    (void)state;
    m.rung_count = 1;
    m.rungs[0].measured = 0.5;
    snprintf(m.rungs[0].name, sizeof m.rungs[0].name, "a<b>&c");
    m.rungs[0].rows[MASU_PASS_TONEMAP].runs = m.rungs[0].sum.runs = true;
    bool (*const writers[])(const masu_model_sheet *, FILE *) = {masu_model_print, masu_model_csv,
                                                           masu_model_xhtml};
    for (size_t w = 0; w < 3; w++) {
        FILE *f = open_memstream(&text, &bytes);
        assert_non_null(f);
        assert_true(writers[w](&m, f));
        assert_int_equal(fclose(f), 0);
        assert_non_null(strstr(text, "COMPUTED"));
        assert_non_null(strstr(text, "tonemap"));
        if (w == 2) {
            assert_null(strstr(text, "a<b"));
            assert_non_null(strstr(text, "a&lt;b&gt;&amp;c"));
            assert_int_equal(strncmp(text, "<section", 8), 0);
        }
        free(text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(costs_are_those_counted_by_hand),
        cmocka_unit_test(what_constants_leave_out_is_not_counted),
        cmocka_unit_test(a_loop_that_compilers_unroll_counts_per_iteration),
        cmocka_unit_test(easu_costs_about_what_was_counted_by_hand),
        cmocka_unit_test(a_counted_shader_is_a_valid_one_that_counts_each_access),
        cmocka_unit_test(the_sheet_has_the_numbers_worked_out_by_hand),
        cmocka_unit_test(instructions_of_compilers_are_found_by_pass_and_stage),
        cmocka_unit_test(the_sheet_counts_the_compilers_instructions_where_it_was_asked),
        cmocka_unit_test(what_is_computed_says_so),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}
