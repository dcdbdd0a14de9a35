/* test_conform.c: suites of `masu conform`: parsing, rejected input and its messages, selection of
 * cases, verdicts, and reports that other programs can read. */
#include "cli/markup.h"
#include "conform/report.h"
#include "settings/knobs.h"
#include "image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static masu_suite suite;
static char error[1024];

static bool parse(const char *text) {
    error[0] = '\0';
    return masu_suite_parse("s.json", text, strlen(text), &suite, error, sizeof error);
}

/* A suite of one case with these members in addition to name, scene and size. */
static bool parse_case(const char *members) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "{\"format\": 1, \"cases\": [{\"name\": \"one\", \"scene\": \"s\", \"size\": [8, 4]%s%s}]}",
        members[0] ? ", " : "", members);
    return parse(text);
}

static void refuses(bool parsed, const char *part) {
    if (parsed) fail_msg("accepted, expected an error with '%s'", part);
    if (!strstr(error, part) || strncmp(error, "s.json", 6) || strchr(error, '\n'))
        fail_msg("'%s' is not in: %s", part, error);
    assert_null(suite.cases);
}

static void accepts(bool parsed) {
    if (!parsed) fail_msg("rejected: %s", error);
}

/* ---- Reading --------------------------------------------------------------------------------- */

static void a_whole_case_is_read(void **state) {
    (void)state;
    accepts(parse(
        "{\"format\": 1, \"about\": \"x\","
        " \"defaults\": {\"size\": [96, 64], \"budget\": {\"allocations\": 0}, \"frames\": 3},"
        " \"cases\": ["
        "  {\"name\": \"a\", \"scene\": \"city\", \"time\": 0.5, \"move\": 0.25, \"validate\": "
        "true,"
        "   \"exact_memory\": true, \"same\": [\"poison\", \"again\"], \"needs\": [\"float16\"],"
        "   \"flight\": 3,"
        "   \"rung\": {\"scale\": 0.8, \"aa\": \"smaa-high\", \"easu\": \"fast\","
        "             \"specular\": \"off\", \"ao_steps\": 5},"
        "   \"budget\": {\"host_bytes\": 1000, \"ms_ratio\": {\"warn\": 2, \"fail\": 3}},"
        "   \"counts\": {\"sdf_evals\": {\"warn\": 7}}, \"at_least\": {\"draws\": 2}},"
        "  {\"name\": \"b\", \"scene\": \"city\", \"sizes\": [[96, 64], [7, 5]],"
        "   \"error\": {\"against\": \"truth\", \"positions\": 4, \"rays\": 9, \"psnr\": 30}},"
        "  {\"name\": \"c\", \"scene\": \"city\", \"frames\": 9,"
        "   \"error\": {\"against\": \"a\", \"pixels\": 0}},"
        "  {\"name\": \"d\", \"scene\": \"city\", \"rung\": {\"march_steps\": 99},"
        "   \"governed\": {\"target_ms\": 5, \"best_rung\": 1, \"settles\": [2, 3], \"changes\": 4,"
        "     \"told\": {\"fixed_ms\": 1, \"load_ms\": 2}}}]}"));
    assert_int_equal(suite.count, 5);
    const masu_case *a = &suite.cases[0], *d = &suite.cases[4];
    assert_string_equal(a->name, "a");
    assert_string_equal(a->scene, "city");
    assert_true(a->width == 96 && a->height == 64 && a->frames == 3 && a->flight == 3);
    assert_true(a->time == 0.5 && a->move == 0.25 && a->validate && a->exact_memory);
    assert_int_equal(a->same, MASU_SAME_POISON | MASU_SAME_AGAIN);
    assert_int_equal(a->needs, MASU_NEEDS_FLOAT16);
    assert_true(a->rung_count == 1 && a->rungs[0].scale == 0.8f && a->rungs[0].ao_steps == 5);
    assert_int_equal(a->rungs[0].aa, MASU_AA_SMAA_HIGH);
    assert_int_equal(a->rungs[0].easu, MASU_EASU_FAST);
    assert_int_equal(a->rungs[0].specular, MASU_OFF);
    assert_true(a->bounds[MASU_MEASURE_HOST_BYTES].fail == 1000);
    assert_true(a->bounds[MASU_MEASURE_ALLOCATIONS].fail == 0); /* the default's */
    assert_true(a->bounds[MASU_MEASURE_MS_RATIO].warn == 2 &&
                a->bounds[MASU_MEASURE_MS_RATIO].fail == 3);
    assert_true(a->bounds[MASU_MEASURE_SDF_EVALS].warn == 7);
    assert_true(isnan(a->bounds[MASU_MEASURE_SDF_EVALS].fail));
    assert_true(a->least[MASU_MEASURE_DRAWS].fail == 2);
    assert_false(masu_bound_is_set(&a->bounds[MASU_MEASURE_DRAWS]));
    assert_true(suite.cases[2].width == 7 && suite.cases[2].height == 5 &&
                suite.cases[2].rays == 9);
    assert_int_equal(suite.cases[2].positions, 4);
    assert_int_equal(suite.cases[3].other, 0);
    assert_int_equal(suite.cases[3].frames, 9);
    assert_true(d->governed.on && d->governed.told && d->governed.best == 1 &&
                d->governed.worst == 7);
    assert_true(d->governed.settles[0] == 2 && d->governed.settles[1] == 3);
    assert_int_equal(d->rung_count, 8);
    assert_true(d->rungs[0].scale == 1.0f && fabsf(d->rungs[7].scale - 0.4f) < 1e-6f);
    assert_int_equal(d->rungs[7].march_steps, 99);
    masu_suite_free(&suite);
    assert_true(parse("{\"format\": 1, \"cases\": [{\"name\": \"m\", \"scene\": \"city\", \"size\": [8, 8],"
                      " \"ladder\": \"auto\", \"governed\": {\"target_ms\": 5}}]}"));
    assert_true(suite.cases[0].measured && !suite.cases[0].rung_count);
    masu_suite_free(&suite);
}

static void extreme_input_is_read(void **state) {
    (void)state;
    accepts(parse(
        "{\"format\": 1, \"defaults\": {\"scene\": \"city\", \"size\": [8, 8]}, \"cases\": ["
        "{\"name\": \"a\", \"input\": \"far | away\", \"extreme\": {\"camera\": {\"position\": [1e7, 2, 3],"
        " \"forward\": [0, 1, 0], \"up\": [0, 0, 1], \"fov\": 90, \"near\": 0.5}, \"other_camera\": {\"fov\": 10},"
        " \"light\": {\"sun\": [0, -1, 0], \"exposure\": 2, \"turbidity\": 3}, \"step\": -1e9, \"cut\": true,"
        " \"settle\": 4, \"transform\": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12], \"instance\": 3,"
        " \"material\": {\"index\": 2, \"roughness\": [1, -1e-4], \"emissive\": 1e6}},"
        " \"field\": {\"hitmiss_pct\": 1}, \"counts\": {\"non_finite\": 0}},"
        "{\"name\": \"b\", \"ladder\": [{}, {\"scale\": 0.5}], \"extreme\": {\"cycle\": true}}]}"));
    const masu_extreme *x = &suite.cases[0].extreme;
    assert_string_equal(x->input, "far | away");
    assert_true(x->has_camera && x->camera.position[0] == 1e7 && x->camera.forward[1] == 1.0f);
    assert_true(x->camera.up[2] == 1.0f && fabsf(x->camera.fov_y - 1.5707964f) < 1e-6f);
    assert_true(x->camera.near_distance == 0.5f && x->has_other && x->other.fov_y < 0.18f);
    assert_true(x->has_light && x->light.sun_direction[1] == -1.0f && x->light.exposure == 2.0f);
    assert_true(x->light.turbidity == 3.0f && x->has_step && x->step == -1e9f && x->cut);
    assert_true(x->settle == 4 && x->has_transform && x->transform[11] == 12.0f && x->instance == 3);
    assert_true(x->has_material && x->material == 2 && x->roughness[1] == -1e-4);
    assert_true(x->has_emissive && x->emissive == 1e6);
    assert_true(masu_case_field(&suite.cases[0]) && !masu_case_field(&suite.cases[1]));
    assert_true(suite.cases[1].extreme.cycle && suite.cases[1].rung_count == 2);
    masu_suite_free(&suite);
#define ONE(more) "{\"format\": 1, \"cases\": [{\"name\": \"a\", \"scene\": \"s\", \"size\": [8, 8], " more "}]}"
    static const char *const bad[][2] = {
        {ONE("\"extreme\": 1"), "extreme: expected an object"},
        {ONE("\"extreme\": {\"more\": 1}"), "extreme.more: unknown key"},
        {ONE("\"extreme\": {\"camera\": {\"fov\": 180}}"), "camera.fov: expected a number"},
        {ONE("\"extreme\": {\"camera\": {\"position\": [1, 2]}}"),
         "expected an array of 3 numbers"},
        {ONE("\"extreme\": {\"camera\": {\"far\": 1}}"), "camera.far: unknown key"},
        {ONE("\"extreme\": {\"light\": {\"moon\": 1}}"), "light.moon: unknown key"},
        {ONE("\"extreme\": {\"material\": {\"gloss\": 1}}"), "material.gloss: unknown key"},
        {ONE("\"extreme\": {\"transform\": [0]}"), "expected an array of 12 numbers"},
        {ONE("\"extreme\": {\"cycle\": true}"), "extreme.cycle: expected a ladder"},
        {ONE("\"extreme\": {\"other_camera\": {}}"), "other_camera: expected a 'camera' as well"},
        {ONE("\"field\": {\"lost_pct\": 0}"), "field: expected extreme.camera"},
        {ONE("\"extreme\": {\"camera\": {}}, \"move\": 1, \"field\": {\"lost_pct\": 0}"),
         "without 'move'"},
        {ONE("\"extreme\": {\"cut\": true}, \"governed\": {\"target_ms\": 5}"),
         "extreme: cannot be combined with 'governed'"},
        {ONE("\"extreme\": {\"material\": {}}, \"error\": {\"against\": \"truth\", \"flip\": 1}"),
         "no ground truth"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) refuses(parse(bad[i][0]), bad[i][1]);
}

/* Two rows, with arbitrary bytes in the gap after each. */
static void what_is_not_finite_is_counted(void **state) {
    (void)state;
    const float depths[8] = {0.0f, 1.0f, NAN, NAN, -0.001f, 1.001f, INFINITY, NAN};
    const uint16_t halves[16] = {0x0000, 0x7BFF, 0x7C00, 0xFC00, 0x7E00, 0xFFFF, 0x7C01, 0x7C00,
                                 0x0001, 0xFBFF, 0x3C00, 0x7C00, 0x7C00, 0x7C00, 0x7C00, 0x7C00};
    masu_readback_image image = {.pixels = depths, .width = 3, .height = 2, .row_bytes = 16};
    assert_true(masu_extreme_count(&image, true) == 4);
    image = (masu_readback_image){.pixels = halves, .width = 1, .height = 2, .row_bytes = 16};
    assert_true(masu_extreme_count(&image, false) == 3);
}

static void what_is_no_suite_is_refused(void **state) {
    (void)state;
    refuses(parse("{\"format\": 1,"), "s.json:1:");
    refuses(parse(""), "s.json:");
    refuses(parse("[1]"), "expected an object, found an array");
    refuses(parse("{\"format\": 1, \"cases\": [], \"a\\nb\\u001b\": 1}"), "a?b?: unknown key");
    refuses(parse("{\"cases\": []}"),
            "format: expected a whole number from 1 to 1, found nothing");
    refuses(parse("{\"format\": 2, \"cases\": []}"), "found 2");
    refuses(parse("{\"format\": 1}"), "cases: expected an array");
    refuses(parse("{\"format\": 1, \"cases\": []}"), "cases: expected an array");
    refuses(parse("{\"format\": 1, \"cases\": {\"a\": 1}}"), "cases: expected an array");
    refuses(parse("{\"format\": 1, \"cases\": [3]}"), "cases[0]: expected an object, found 3");
    refuses(parse("{\"format\": 1, \"cases\": [{}]}"),
            "cases[0]': name: expected a non-empty string");
    refuses(parse("{\"format\": 1, \"casse\": []}"), "casse: unknown key");
    refuses(parse("{\"format\": 1, \"format\": 1, \"cases\": []}"), "duplicate");
    refuses(parse("{\"format\": 1, \"defaults\": {\"frames\": 0}, \"cases\": []}"),
            "case 'defaults': frames: expected a whole number from 1 to 100000, found 0");
    refuses(parse("{\"format\": 1, \"defaults\": 7, \"cases\": []}"), "found 7");
}

static void a_bad_case_is_named_with_its_key(void **state) {
    (void)state;
    static const char *const bad[][2] = {
        {"\"scale\": 1", "case 'one': scale: unknown key"},
        {"\"rung\": {\"scael\": 1}", "case 'one': rung.scael: unknown key"},
        {"\"rung\": {\"scale\": 1.5}", "rung.scale: expected a number from 0 to 1, found 1.5"},
        {"\"rung\": {\"scale\": \"half\"}",
         "rung.scale: expected a number from 0 to 1, found 'half'"},
        {"\"rung\": {\"aa\": \"smaa\"}",
         "rung.aa: expected one of auto, off, fxaa, smaa-low, smaa-medium, smaa-high, smaa-ultra, "
         "found 'smaa'"},
        {"\"rung\": {\"ao\": true}", "rung.ao: expected one of auto, off, on, found true"},
        {"\"rung\": {\"march_steps\": 4.5}", "rung.march_steps: expected a whole number"},
        {"\"rung\": {\"shadow_distance\": 2e9}", "expected a number from 0 to 1e+09"},
        {"\"rung\": {\"shadow_refresh\": [1, 2]}", "expected an array of 4 whole numbers"},
        {"\"rung\": 3", "rung: expected an object, found 3"},
        {"\"frames\": -1", "frames: expected a whole number from 1 to 100000, found -1"},
        {"\"time\": null", "time: expected a number from -1000000000 to 1000000000, found null"},
        {"\"validate\": 1", "validate: expected true or false, found 1"},
        {"\"flight\": 4", "flight: expected a whole number from 1 to 3, found 4"},
        {"\"same\": \"again\"", "same: expected an array, found 'again'"},
        {"\"same\": [\"always\"]", "same: expected one of again, poison"},
        {"\"needs\": [\"rtx\"]", "needs: expected one of ray-query"},
        {"\"budget\": {\"bytes\": 1}", "budget.bytes: unknown key"},
        {"\"budget\": {\"sdf_evals\": 1}", "budget.sdf_evals: unknown key"},
        {"\"at_least\": {\"host_bytes\": 1}", "at_least.host_bytes: unknown key"},
        {"\"budget\": {\"host_bytes\": \"1 MB\"}", "budget.host_bytes: expected a number"},
        {"\"budget\": {\"host_bytes\": {}}", "budget.host_bytes: expected warn, fail, or both"},
        {"\"budget\": {\"host_bytes\": {\"most\": 1}}", "budget.host_bytes.most: unknown key"},
        {"\"budget\": {\"host_bytes\": {\"warn\": 5, \"fail\": 4}}",
         "warn is 5, beyond fail, which is 4"},
        {"\"at_least\": {\"draws\": {\"warn\": 4, \"fail\": 5}}",
         "warn is 4, beyond fail, which is 5"},
        {"\"error\": {\"flip\": 1}",
         "error.against: expected 'truth', 'reference' or the name of a case"},
        {"\"error\": {\"against\": \"truth\"}", "expected a limit with 'against'"},
        {"\"error\": {\"against\": \"reference\", \"mean_off\": 1}", "error.golden: expected"},
        {"\"error\": {\"against\": \"truth\", \"golden\": \"a.ref\", \"flip\": 1}",
         "error.golden: expected"},
        {"\"error\": {\"against\": \"reference\", \"golden\": \"a.jpg\", \"flip\": 1}",
         ".exr or .png, found 'a.jpg'"},
        {"\"error\": {\"against\": \"reference\", \"golden\": \"a.ref\", \"flip\": 1}",
         "flip needs an image of 8 bits"},
        {"\"error\": {\"against\": \"truth\", \"patch_p95\": 1}", "patch_p95 needs a golden file"},
        {"\"error\": {\"against\": \"one\", \"flip\": 1}", "found 'one'"},
        {"\"error\": {\"against\": \"none\", \"flip\": 1}", "found 'none'"},
        {"\"error\": {\"against\": \"truth\", \"psnr\": {\"warn\": 20, \"fail\": 30}}",
         "beyond fail"},
        {"\"error\": {\"against\": \"truth\", \"positions\": 0, \"flip\": 1}", "error.positions"},
        {"\"governed\": {}", "governed.target_ms: expected a number from 1 to 1000, found nothing"},
        {"\"governed\": {\"target_ms\": 9, \"speed\": 1}", "governed.speed: unknown key"},
        {"\"governed\": {\"target_ms\": 9, \"worst_rung\": 1, \"best_rung\": 2}",
         "governed.worst_rung"},
        {"\"governed\": {\"target_ms\": 9, \"settles\": [3, 2]}", "the lower rung first"},
        {"\"governed\": {\"target_ms\": 9, \"told\": {\"ms\": 2}}", "governed.told.ms"},
        {"\"governed\": {\"target_ms\": 9}, \"same\": [\"again\"]",
         "cannot be combined with error, same and ms_ratio"},
        {"\"ladder\": [{}, {}]", "ladder: expected 'governed'"},
        {"\"ladder\": \"auto\"", "ladder: expected 'governed'"},
        {"\"ladder\": \"best\"", "ladder: expected 'auto' or an array of 1 to 12 rungs"},
        {"\"ladder\": \"auto\", \"governed\": {\"target_ms\": 9, \"worst_rung\": 1, "
         "\"best_rung\": 2}",
         "governed.worst_rung: expected 2 to 11, found 1"},
        {"\"ladder\": []", "ladder: expected 'auto' or an array of 1 to 12 rungs, found 0"},
        {"\"ladder\": [{},{},{},{},{},{},{},{},{},{},{},{},{}]", "found 13"},
        {"\"sizes\": [[1, 2]]", "sizes: cannot be combined with 'size'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) refuses(parse_case(bad[i][0]), bad[i][1]);
    refuses(parse("{\"format\": 1, \"cases\": [{\"name\": \"a:b\", \"scene\": \"s\", \"size\": [1, "
                  "1]}]}"),
            "without ':'");
    refuses(parse("{\"format\": 1, \"cases\": [{\"name\": \"a\\nb\", \"scene\": \"s\", \"size\": "
                  "[1, 1]}]}"),
            "control character");
    refuses(parse("{\"format\": 1, \"cases\": [{\"name\": \"a\", \"size\": [1, 1]}]}"),
            "scene: expected");
    refuses(parse("{\"format\": 1, \"cases\": [{\"name\": \"a\", \"scene\": \"../a\", \"size\": "
                  "[1, 1]}]}"),
            "folder of scenes");
    refuses(parse("{\"format\": 1, \"cases\": [{\"name\": \"a\", \"scene\": \"s\"}]}"),
            "size: expected");
    refuses(
        parse(
            "{\"format\": 1, \"cases\": [{\"name\": \"a\", \"scene\": \"s\", \"size\": [0, 1]}]}"),
        "size: expected a whole number from 1 to 16384, found 0");
    refuses(
        parse("{\"format\": 1, \"cases\": [{\"name\": \"a\", \"scene\": \"s\", \"size\": [4, 1]},"
              "{\"name\": \"a\", \"scene\": \"s\", \"size\": [4, 1]}]}"),
        "two cases have this name at 4x1");
    accepts(parse_case(""));
    masu_suite_free(&suite);
}

/* Every prefix of a suite is rejected, and no read goes beyond its end. */
static void a_suite_that_is_cut_is_refused(void **state) {
    (void)state;
    static const char text[] =
        "{\"format\": 1, \"cases\": [{\"name\": \"a\", \"scene\": \"s\", \"size\": "
        "[4, 1], \"rung\": {\"aa\": \"smaa-low\"}}]}";
    for (size_t n = 0; n < sizeof text - 1; n++) {
        char *copy = malloc(n ? n : 1);
        memcpy(copy, text, n);
        assert_false(masu_suite_parse("s.json", copy, n, &suite, error, sizeof error));
        free(copy);
    }
    accepts(parse(text));
    masu_suite_free(&suite);
}

/* ---- Verdicts -------------------------------------------------------------------------------- */

static void limits_make_verdicts(void **state) {
    (void)state;
    masu_bound both = {10, 20}, warn = {10, MASU_UNKNOWN}, fails = {MASU_UNKNOWN, 20},
               none = {MASU_UNKNOWN, MASU_UNKNOWN}, psnr = {30, 20};
    assert_int_equal(masu_bound_judge(&both, 10, false), MASU_VERDICT_PASS);
    assert_int_equal(masu_bound_judge(&both, 10.1, false), MASU_VERDICT_WARNING);
    assert_int_equal(masu_bound_judge(&both, 20, false), MASU_VERDICT_WARNING);
    assert_int_equal(masu_bound_judge(&both, 20.1, false), MASU_VERDICT_FAIL);
    assert_int_equal(masu_bound_judge(&both, MASU_UNKNOWN, false), MASU_VERDICT_FAIL);
    assert_int_equal(masu_bound_judge(&both, (double)INFINITY, false), MASU_VERDICT_FAIL);
    assert_int_equal(masu_bound_judge(&warn, 1e9, false), MASU_VERDICT_WARNING);
    assert_int_equal(masu_bound_judge(&warn, MASU_UNKNOWN, false), MASU_VERDICT_WARNING);
    assert_int_equal(masu_bound_judge(&fails, 15, false), MASU_VERDICT_PASS);
    assert_int_equal(masu_bound_judge(&none, MASU_UNKNOWN, false), MASU_VERDICT_PASS);
    assert_int_equal(masu_bound_judge(&psnr, 30, true), MASU_VERDICT_PASS);
    assert_int_equal(masu_bound_judge(&psnr, (double)INFINITY, true), MASU_VERDICT_PASS);
    assert_int_equal(masu_bound_judge(&psnr, 29, true), MASU_VERDICT_WARNING);
    assert_int_equal(masu_bound_judge(&psnr, 19, true), MASU_VERDICT_FAIL);
    assert_int_equal(masu_bound_judge(&psnr, MASU_UNKNOWN, true), MASU_VERDICT_FAIL);
    assert_true(masu_verdict_failed(MASU_VERDICT_FAIL) &&
                masu_verdict_failed(MASU_VERDICT_RESOURCE));
    assert_false(masu_verdict_failed(MASU_VERDICT_PASS) ||
                 masu_verdict_failed(MASU_VERDICT_WARNING) ||
                 masu_verdict_failed(MASU_VERDICT_UNSUPPORTED));
}

/* Every limit of every measure: its value passes, one step beyond it does not, and a suite whose
 * warning is beyond its failure is rejected. */
static void every_measure_has_a_right_and_a_wrong_side(void **state) {
    (void)state;
#define MEASURE_GROUP(name, key, group, more) group,
    static const char *const groups[] = {MASU_MEASURES(MEASURE_GROUP)};
#undef MEASURE_GROUP
    for (int i = 0; i < 2 * MASU_MEASURE_COUNT; i++) {
        const masu_measure m = (masu_measure)(i / 2);
        const char *name = masu_measure_name(m), *group = groups[m];
        const bool least = i % 2;
        if (least && strcmp(group, "counts") != 0) continue;
        const double more = least || !strcmp(name, "psnr") || !strcmp(name, "ssim") ? -1 : 1;
        masu_case of = {.scene = "s"};
        for (int k = 0; k < MASU_MEASURE_COUNT; k++)
            of.bounds[k] = of.least[k] = (masu_bound){MASU_UNKNOWN, MASU_UNKNOWN};
        *(least ? &of.least[m] : &of.bounds[m]) = (masu_bound){8, 8 + more};
        static const masu_verdict verdicts[] = {MASU_VERDICT_PASS, MASU_VERDICT_WARNING, MASU_VERDICT_FAIL};
        for (int step = -1; step <= 2; step++) {
            masu_conform_result r;
            masu_conform_not_run(&of, "", &r);
            r.verdict = MASU_VERDICT_PASS;
            r.values[m] = 8 + more * step;
            masu_conform_judge(&r, true);
            if (r.verdict != verdicts[step < 0 ? 0 : step])
                fail_msg("%s %g with warn 8, fail %g: %s", name, r.values[m], 8 + more,
                         masu_verdict_name(r.verdict));
            assert_true(!r.why[0] == (step < 1));
        }
        for (int turned = 0; turned < 2; turned++) {
            char text[200];
            snprintf(text, sizeof text, "\"%s\": {%s\"%s\": {\"warn\": 8, \"fail\": %g}}",
                     least ? "at_least" : group,
                     !strcmp(group, "error") ? "\"against\": \"reference\", \"golden\": \"a.ref\", " : "",
                     name, 8 + (turned ? -more : more));
            bool right = parse_case(text);
            if (right == turned && (right || strstr(error, "beyond fail")))
                fail_msg("%s: %s", text, right ? "accepted" : error);
            if (right) masu_suite_free(&suite);
        }
    }
}

/* ---- Selection ------------------------------------------------------------------------------- */

static const char *five =
    "{\"format\": 1, \"defaults\": {\"scene\": \"s\", \"size\": [8, 4]}, \"cases\": [{\"name\": "
    "\"a.1\"},"
    "{\"name\": \"a.2\"}, {\"name\": \"b.1\"}, {\"name\": \"a.3\", \"sizes\": [[8, 4], [9, 4]]}]}";

static void globs_and_fractions_choose(void **state) {
    (void)state;
    bool marks[5];
    uint32_t parts[5] = {0};
    accepts(parse(five));
    assert_int_equal(masu_suite_select(&suite, NULL, 0, 1, marks), 5);
    assert_int_equal(masu_suite_select(&suite, "a.*", 0, 1, marks), 4);
    assert_false(marks[2]);
    assert_int_equal(masu_suite_select(&suite, "a.*", 1, 2, marks), 2);
    assert_true(marks[1] && marks[4]); /* the second and the fourth of the matching cases */
    assert_int_equal(masu_suite_select(&suite, "?.1", 0, 1, marks), 2);
    assert_int_equal(masu_suite_select(&suite, "c*", 0, 1, marks), 0);
    for (uint32_t i = 0; i < 3; i++) { /* the shards add up to the whole */
        masu_suite_select(&suite, NULL, i, 3, marks);
        for (int k = 0; k < 5; k++) parts[k] += marks[k];
    }
    for (int k = 0; k < 5; k++) assert_int_equal(parts[k], 1);
    masu_suite_free(&suite);
}

static void a_token_finds_its_case_and_no_other(void **state) {
    (void)state;
    char token[200], other[200];
    accepts(parse(five));
    for (uint32_t i = 0; i < suite.count; i++) {
        assert_true(masu_replay_token(&suite, &suite.cases[i], token, sizeof token));
        assert_int_equal(masu_replay_find(&suite, token, error, sizeof error), (int)i);
    }
    assert_false(masu_replay_token(&suite, &suite.cases[0], token, 10));
    assert_true(masu_replay_token(&suite, &suite.cases[0], token, sizeof token));
    snprintf(other, sizeof other, "%.9sa.1:8x5", token);
    assert_int_equal(masu_replay_find(&suite, other, error, sizeof error), -1);
    assert_non_null(strstr(error, "no case 'a.1:8x5'"));
    snprintf(other, sizeof other, "%08x:a.1:8x4", suite.hash + 1);
    assert_int_equal(masu_replay_find(&suite, other, error, sizeof error), -1);
    assert_non_null(strstr(error, "token of another suite"));
    static const char *const bad[] = {"", "a", "1234:a.1:8x4", "zzzzzzzz:a:1x1", "12345678"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(masu_replay_find(&suite, bad[i], error, sizeof error), -1);
        assert_non_null(strstr(error, "expected a token"));
    }
    uint32_t hash = suite.hash;
    masu_suite_free(&suite);
    accepts(parse_case(""));
    assert_int_not_equal(suite.hash, hash);
    masu_suite_free(&suite);
}

/* ---- Reports --------------------------------------------------------------------------------- */

static char text[8192];

static void escaped(const char *from, const char *to) {
    FILE *f = fmemopen(text, sizeof text, "w");
    assert_non_null(f);
    masu_markup_text(f, from);
    fclose(f);
    assert_string_equal(text, to);
}

static void quoted(const char *from, const char *to) {
    FILE *f = fmemopen(text, sizeof text, "w");
    assert_non_null(f);
    masu_shell_quote(f, from);
    fclose(f);
    assert_string_equal(text, to);
}

static void names_are_escaped(void **state) {
    (void)state;
    escaped("plain", "plain");
    escaped("a<b>&\"c'", "a&lt;b&gt;&amp;&quot;c&apos;");
    escaped("a\nb\tc\x01\x1f", "a&#10;b&#9;c??");
    escaped("\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8d\x9a", "\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8d\x9a");
    escaped("\xc0\xaf|\xed\xa0\x80|\xf4\x90\x80\x80|\xef\xbf\xbe", "??|???|????|???");
    escaped("\xe2\x82", "??"); /* cut short */
    quoted("12345678:a.b:8x4", "12345678:a.b:8x4");
    quoted("a b", "'a b'");
    quoted("it's $HOME", "'it'\\''s $HOME'");
    quoted("", "''");
}

/* Tags close in the reverse order of opening; one root and nothing outside it; no markup or quotes
 * that would end something early. Only the subset of XML that the reports use. */
static void well_formed(const char *p) {
    char open[16][32];
    size_t depth = 0, roots = 0;
    assert_int_equal(strncmp(p, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n", 39), 0);
    for (p += 39; *p;) {
        if (*p != '<') {
            assert_true(depth || *p == '\n');
            assert_true(*p != '>' && (unsigned char)*p != 1);
            if (*p == '&') assert_true(strcspn(p, ";") < 7);
            p++;
            continue;
        }
        bool closing = p[1] == '/';
        char name[32];
        size_t n = strcspn(p += 1 + closing, " />");
        assert_true(n && n < sizeof name);
        snprintf(name, sizeof name, "%.*s", (int)n, p);
        for (p += n; *p == ' ';) { /* name="value" */
            p += 1 + strspn(p + 1, "abcdefghijklmnopqrstuvwxyz");
            assert_int_equal(strncmp(p, "=\"", 2), 0);
            n = strcspn(p + 2, "\"<>");
            p += 2 + n;
            assert_int_equal(*p++, '"');
        }
        bool empty = *p == '/';
        p += empty;
        assert_int_equal(*p++, '>');
        if (closing) {
            assert_true(depth > 0);
            assert_string_equal(open[--depth], name);
        } else if (!empty) {
            assert_true(depth < 16);
            roots += depth == 0;
            memcpy(open[depth++], name, sizeof name);
        }
    }
    assert_int_equal(depth, 0);
    assert_int_equal(roots, 1);
}

static void reports_count_what_there_is(void **state) {
    (void)state;
    static masu_conform_result r[5];
    accepts(parse("{\"format\": 1, \"defaults\": {\"scene\": \"s\", \"size\": [8, 4]}, \"cases\": "
                  "[{\"name\": "
                  "\"a<&\\\"b\"}, {\"name\": \"2\"}, {\"name\": \"3\"}, {\"name\": \"4\"}, "
                  "{\"name\": \"5\"}]}"));
    for (int i = 0; i < 5; i++) {
        r[i].of = &suite.cases[i];
        r[i].verdict = (masu_verdict)i;
        r[i].seconds = 0.5;
        if (i) strcpy(r[i].why, "because \"1 < 2\"");
        for (int m = 0; m < MASU_MEASURE_COUNT; m++) r[i].values[m] = MASU_UNKNOWN;
    }
    r[0].values[MASU_MEASURE_DRAWS] = 17;
    FILE *f = fmemopen(text, sizeof text, "w");
    masu_conform_junit(f, &suite, r, 5, "driver & co");
    fclose(f);
    well_formed(text);
    static const char *const parts[] = {
        "tests=\"5\" failures=\"1\" errors=\"1\" skipped=\"1\" time=\"2.500\"",
        "name=\"a&lt;&amp;&quot;b (8x4)\"",
        "value=\"driver &amp; co\"",
        "<skipped message=\"because &quot;1 &lt; 2&quot;\"/>",
        "<error message=\"because &quot;1 &lt; 2&quot;\" type=\"resource error\"/>",
        "<failure message=\"because &quot;1 &lt; 2&quot;\" type=\"fail\"/>",
        "<system-out>quality warning: because",
        "\ndraws 17\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (!strstr(text, parts[i])) fail_msg("not there: %s in\n%s", parts[i], text);
    }
    f = fmemopen(text, sizeof text, "w");
    masu_conform_csv(f, &suite, r, 5, "d");
    fclose(f);
    size_t lines = 0, commas = 0, first = 0;
    for (const char *p = text; *p; p++) lines += *p == '\n';
    assert_int_equal(lines, 6);
    for (const char *p = text; *p != '\n'; p++) first += *p == ',';
    for (const char *p = strchr(text, '\n') + 1; *p != '\n'; p++) commas += *p == ',';
    assert_int_equal(first, commas);
    assert_non_null(strstr(text, "\n\"a<&\"\"b\",\"s\",8,4,pass,0.500,"));
    f = fmemopen(text, sizeof text, "w");
    masu_conform_sum(f, r, 5);
    masu_conform_print(f, &suite, &r[4], "masu conform");
    masu_conform_print(f, &suite, &r[0], "masu conform");
    fclose(f);
    assert_non_null(
        strstr(text, "5 cases: 1 passed, 1 quality warning, 1 not supported, 1 resource error, "
                     "1 failed in 2.5 s\n"));
    char line[64];
    snprintf(line, sizeof line, "    replay: masu conform --replay %08x:5:8x4\n", suite.hash);
    assert_non_null(strstr(text, line));
    const char *replay = strstr(text, "replay");
    assert_null(strstr(replay + 1, "replay:")); /* passed cases have none */
    masu_suite_free(&suite);
}

/* The suites of the tree can be read. */
static void the_shipped_suites_are_good(void **state) {
    (void)state;
    static const char *const files[] = {"suites/smoke.json", "suites/full.json"};
    for (size_t i = 0; i < 2; i++) {
        static char bytes[1 << 17];
        FILE *f = fopen(files[i], "rb");
        assert_non_null(f);
        size_t n = fread(bytes, 1, sizeof bytes, f);
        fclose(f);
        assert_true(n < sizeof bytes);
        if (!masu_suite_parse(files[i], bytes, n, &suite, error, sizeof error))
            fail_msg("%s", error);
        assert_true(suite.count >= 20);
        /* each case can fail because of an allocation */
        for (uint32_t k = 0; k < suite.count; k++) {
            assert_true(suite.cases[k].bounds[MASU_MEASURE_ALLOCATIONS].fail == 0);
        }
        masu_suite_free(&suite);
    }
}

/* Generated from the table, so that a new knob is not forgotten: every switch and every other
 * choice is set by a case. */
static void every_choice_is_in_a_suite(void **state) {
    (void)state;
    static const char *const files[] = {"suites/smoke.json", "suites/full.json",
                                        "suites/extreme.json"};
    masu_suite suites[3];
    for (int i = 0; i < 3; i++) {
        uint8_t *text;
        size_t bytes;
        assert_true(masu_file_read(files[i], (size_t)4 << 20, &text, &bytes, error, sizeof error));
        if (!masu_suite_parse(files[i], (const char *)text, bytes, &suites[i], error, sizeof error))
            fail_msg("%s", error);
        free(text);
    }
    const masu_rung none = {0};
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        uint32_t cases = 0;
        for (int i = 0; i < 3 && k->words; i++) {
            for (uint32_t c = 0; c < suites[i].count; c++) {
                const masu_case *of = &suites[i].cases[c];
                for (uint32_t r = 0; r < of->rung_count; r++)
                    cases += masu_knob_differs(k, &of->rungs[r], &none);
            }
        }
        if (k->words && !cases) fail_msg("no case of a suite sets %s", k->name);
    }
    for (int i = 0; i < 3; i++) masu_suite_free(&suites[i]);
}

/* A case that was not run is an error in every report, with its reason, and the file is
 * complete. */
static void a_case_that_was_not_run_is_an_error(void **state) {
    (void)state;
    char *text = NULL;
    size_t bytes = 0;
    masu_conform_result results[2];
    accepts(parse(
        "{\"format\": 1, \"defaults\": {\"scene\": \"s\", \"size\": [8, 4]}, \"cases\": [{\"name\": \"a\"}, {\"name\": \"b\"}]}"));
    masu_conform_not_run(&suite.cases[0], "the program ended\nduring this case", &results[0]);
    masu_conform_not_run(&suite.cases[1], "", &results[1]);
    results[1].verdict = MASU_VERDICT_PASS;
    assert_true(masu_verdict_failed(MASU_VERDICT_NOT_RUN));
    FILE *f = open_memstream(&text, &bytes);
    masu_conform_junit(f, &suite, results, 2, "d");
    masu_conform_csv(f, &suite, results, 2, "d");
    masu_conform_sum(f, results, 2);
    fclose(f);
    assert_non_null(strstr(text, "tests=\"2\" failures=\"0\" errors=\"1\" skipped=\"0\""));
    assert_non_null(
        strstr(text, "<error message=\"the program ended during this case\" type=\"not run\"/>"));
    assert_non_null(strstr(text, "\"a\",\"s\",8,4,not run,"));
    assert_non_null(strstr(
        text,
        "2 cases: 1 passed, 0 quality warnings, 0 not supported, 0 resource errors, 0 failed, 1 not run"));
    free(text);
    masu_suite_free(&suite);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_whole_case_is_read),
        cmocka_unit_test(extreme_input_is_read),
        cmocka_unit_test(what_is_not_finite_is_counted),
        cmocka_unit_test(what_is_no_suite_is_refused),
        cmocka_unit_test(a_bad_case_is_named_with_its_key),
        cmocka_unit_test(a_suite_that_is_cut_is_refused),
        cmocka_unit_test(limits_make_verdicts),
        cmocka_unit_test(every_measure_has_a_right_and_a_wrong_side),
        cmocka_unit_test(globs_and_fractions_choose),
        cmocka_unit_test(a_token_finds_its_case_and_no_other),
        cmocka_unit_test(names_are_escaped),
        cmocka_unit_test(reports_count_what_there_is),
        cmocka_unit_test(the_shipped_suites_are_good),
        cmocka_unit_test(every_choice_is_in_a_suite),
        cmocka_unit_test(a_case_that_was_not_run_is_an_error),
    };
    return cmocka_run_group_tests_name("conform", tests, NULL, NULL);
}
