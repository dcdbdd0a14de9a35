/* test_marches.c: the marches that only the lab build has, in the frame plan: the passes of
 * each, its settings for the shaders, and that a blob without its code is an error. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "plan/compile.h"
#include "plan/push.h"
#include "support/desc.h"

static masu_frame_plan plan;
static masu_detail detail;

static void compile(const masu_desc *d) {
    if (masu_compile(d, 256, 64, &plan, &detail)) fail_msg("refused: %s", detail.text);
}

#define BIT(march) (1u << MASU_MARCH_##march)

static int runs(masu_pass_id pass) { return masu_has_pass(&plan.rungs[0].active, pass); }

static masu_desc desc_of(uint32_t parts, masu_march march) {
    masu_desc d = scene_desc(parts, 64, 64);
    support_scene.sdf_march = BIT(AUTO) | BIT(PLAIN) | BIT(SEED) | BIT(CHECKERBOARD);
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.march = march, .march_steps = 77};
    return d;
}

static void each_march_has_its_passes(void **state) {
    (void)state;
    static const struct {
        masu_march march;
        int tiles, blocks; /* classify and cone8; cone4 and the product's march */
        masu_pass_id pass;
    } cases[] = {{MASU_MARCH_AUTO, 1, 1, MASU_PASS_MARCH},
                 {MASU_MARCH_CHECKERBOARD, 1, 0, MASU_PASS_MARCH_CHECKERBOARD},
                 {MASU_MARCH_PLAIN, 0, 0, MASU_PASS_MARCH_PLAIN},
                 {MASU_MARCH_SEED, 0, 0, MASU_PASS_MARCH_SEED}};
    for (uint32_t parts = SDF; parts <= (RASTER | SDF); parts++) {
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            masu_desc d = desc_of(parts, cases[i].march);
            compile(&d);
            assert_int_equal(runs(MASU_PASS_CLASSIFY), cases[i].tiles);
            assert_int_equal(runs(MASU_PASS_CONE8), cases[i].tiles);
            assert_int_equal(runs(MASU_PASS_CONE4), cases[i].blocks);
            assert_int_equal(runs(MASU_PASS_MARCH), cases[i].blocks);
            assert_int_equal(runs(MASU_PASS_MARCH_CHECKERBOARD),
                             cases[i].pass == MASU_PASS_MARCH_CHECKERBOARD);
            assert_int_equal(runs(MASU_PASS_MARCH_PLAIN), cases[i].pass == MASU_PASS_MARCH_PLAIN);
            assert_int_equal(runs(MASU_PASS_MARCH_SEED), cases[i].pass == MASU_PASS_MARCH_SEED);
            assert_int_equal(masu_push_of(&plan, 0, cases[i].pass, 0).own.word[0], 77);
        }
    }
}

static void a_march_without_code_in_the_blob_is_a_scene_error(void **state) {
    (void)state;
    static const masu_march marches[] = {MASU_MARCH_PLAIN, MASU_MARCH_SEED,
                                         MASU_MARCH_CHECKERBOARD};
    for (size_t i = 0; i < sizeof marches / sizeof *marches; i++) {
        masu_desc d = desc_of(SDF, marches[i]);
        support_scene.sdf_march = BIT(AUTO);
        assert_int_equal(masu_compile(&d, 256, 64, &plan, &detail), MASU_ERROR_SCENE);
        assert_string_equal(detail.what, "rungs[].march");
        assert_non_null(strstr(detail.text, "--variants"));
        d.rungs[0].march = MASU_MARCH_AUTO;
        compile(&d);
    }
    masu_desc d = desc_of(RASTER, MASU_MARCH_SEED); /* without an SDF there is nothing to march */
    support_scene.sdf_march = 0;
    compile(&d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_march_has_its_passes),
        cmocka_unit_test(a_march_without_code_in_the_blob_is_a_scene_error),
    };
    return cmocka_run_group_tests_name("marches", tests, NULL, NULL);
}
