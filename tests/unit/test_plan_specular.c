/* test_plan_specular.c: the cost of traced reflections in a plan: nothing if no surface is glossy
 * enough or if they are off; otherwise their passes and images. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "plan/compile.h"
#include "plan/push.h"
#include "plan/desc.h"
#include "support/desc.h"

static masu_frame_plan with, without;

static void compile(const masu_desc *d, masu_frame_plan *plan) {
    masu_detail detail;
    if (masu_compile(d, 256, 64, plan, &detail)) fail_msg("rejected: %s", detail.text);
}

/* Polygons and an SDF, with a reflecting material of roughness 0.1. */
static masu_desc mirrors(uint32_t parts) {
    masu_desc d = scene_desc(parts, 640, 360);
    masu_scene_data *s = &support_scene;
    s->reflections = 1;
    s->trace_instances = parts & RASTER ? 3 : 0;
    s->trace_nodes = s->trace_triangles = parts & RASTER ? 8 : 0;
    s->trace_sdf = parts & SDF ? 1 : 0;
    s->specular_cutoff = 0.5f;
    s->glossiest = 0.1f;
    s->trace_distance = 100;
    return d;
}

static int is_specular(uint32_t pass) {
    return pass >= MASU_PASS_SPECULAR_GUIDE && pass <= MASU_PASS_SPECULAR_COMPOSITE;
}

/* Passes, reads and writes, images, buffers, needs: all equal, except for the scene and the
 * description, which request the reflections. */
static void assert_same_plan(const masu_frame_plan *a, const masu_frame_plan *b) {
    assert_memory_equal(a->images, b->images, sizeof a->images);
    for (uint32_t r = 0; r < a->desc.rung_count; r++) {
        assert_memory_equal(&a->rungs[r].active, &b->rungs[r].active, sizeof a->rungs[r].active);
        assert_memory_equal(a->rungs[r].access, b->rungs[r].access, sizeof a->rungs[r].access);
        assert_memory_equal(a->rungs[r].access_count, b->rungs[r].access_count,
                            sizeof a->rungs[r].access_count);
    }
    for (uint32_t i = 0; i < MASU_BUFFER_COUNT; i++) {
        assert_int_equal(a->buffers[i].bytes, b->buffers[i].bytes);
        assert_int_equal(a->buffers[i].usage, b->buffers[i].usage);
        assert_int_equal(a->buffers[i].stride, b->buffers[i].stride);
    }
    assert_int_equal(a->needs.velocity, b->needs.velocity);
    assert_int_equal(a->needs.reflections, b->needs.reflections);
    assert_int_equal(a->needs.traced, b->needs.traced);
    assert_int_equal(a->needs.traced_sdf, b->needs.traced_sdf);
}

static void what_is_not_glossy_or_switched_off_costs_nothing(void **state) {
    (void)state;
    static const uint32_t parts[] = {RASTER, SDF, RASTER | SDF};
    for (int p = 0; p < 3; p++) {
        for (int how = 0; how < 4; how++) {
            masu_desc d = scene_desc(parts[p], 640, 360);
            d = masu_desc_resolved(&d);
            for (uint32_t r = 0; r < d.rung_count; r++) d.rungs[r].specular_cutoff = 0;
            compile(&d, &without);
            d = mirrors(parts[p]);
            d = masu_desc_resolved(&d);
            if (how == 0) support_scene.glossiest = 0.5f; /* the cut-off: not below it */
            if (how == 1) support_scene.glossiest = 1.0f;
            for (uint32_t r = 0; r < d.rung_count; r++) {
                if (how == 2) d.rungs[r].specular = MASU_OFF;
                if (how == 3) d.rungs[r].specular_cutoff = 0.1f;
            }
            compile(&d, &with);
            assert_same_plan(&with, &without);
            for (uint32_t i = 1; i < MASU_IMAGE_COUNT; i++)
                assert_false(masu_images[i].kept && with.images[i].used);
            for (uint32_t pass = 0; pass < MASU_PASS_COUNT; pass++)
                if (is_specular(pass)) assert_false(masu_has_pass(&with.rungs[0].active, pass));
            assert_int_equal(with.buffers[MASU_BUFFER_TRACE].bytes, 0);
            assert_int_equal(with.buffers[MASU_BUFFER_TRACE_FRAME].bytes, 0);
            assert_int_equal(with.buffers[MASU_BUFFER_SPECULAR_TILES].bytes, 0);
            assert_false(with.images[MASU_IMAGE_VELOCITY].used);
        }
    }
}

/* Only one rung of three has them, and only it runs their passes. */
static void a_rung_without_them_runs_none_of_their_passes(void **state) {
    (void)state;
    masu_desc d = mirrors(RASTER);
    d = masu_desc_resolved(&d);
    d.rungs[0].specular = d.rungs[2].specular = MASU_OFF;
    compile(&d, &with);
    for (uint32_t pass = 0; pass < MASU_PASS_COUNT; pass++) {
        if (!is_specular(pass)) continue;
        assert_false(masu_has_pass(&with.rungs[0].active, pass));
        assert_false(masu_has_pass(&with.rungs[2].active, pass));
    }
    assert_true(masu_has_pass(&with.rungs[1].active, MASU_PASS_SPECULAR_COMPOSITE));
}

static void what_is_glossy_is_traced_in_polygons_in_the_sdf_or_in_both(void **state) {
    (void)state;
    static const uint32_t parts[] = {RASTER, SDF, RASTER | SDF};
    for (int p = 0; p < 3; p++) {
        masu_desc d = mirrors(parts[p]);
        compile(&d, &with);
        masu_pass_set active = with.rungs[0].active;
        assert_true(masu_has_pass(&active, MASU_PASS_SPECULAR_GUIDE));
        assert_true(masu_has_pass(&active, MASU_PASS_SPECULAR_RAYS));
        assert_true(masu_has_pass(&active, MASU_PASS_SPECULAR_SHADE));
        assert_true(masu_has_pass(&active, MASU_PASS_SPECULAR_COMPOSITE));
        assert_int_equal(masu_has_pass(&active, MASU_PASS_SPECULAR_TRACE),
                         (parts[p] & RASTER) != 0);
        assert_int_equal(masu_has_pass(&active, MASU_PASS_SPECULAR_TRACE_SDF),
                         (parts[p] & SDF) != 0);
        assert_false(masu_has_pass(&active, MASU_PASS_SPECULAR_ACCUMULATE));
        assert_true(with.images[MASU_IMAGE_VELOCITY].used);
        assert_int_equal(with.images[MASU_IMAGE_SPECULAR_LIGHT].width, 320);
        assert_int_equal(with.images[MASU_IMAGE_SPECULAR_LIGHT].height, 180);
    }
}

/* With temporal upscaling, spatial reuse and the last temporal filter are off unless they are
 * requested. */
static void many_samples_from_one_go_without_two_means(void **state) {
    (void)state;
    for (int asked = 0; asked < 2; asked++) {
        masu_desc d = mirrors(RASTER);
        d.rung_count = 2;
        d.rungs[1] = d.rungs[0];
        d.rungs[1].temporal = MASU_ON;
        if (asked) d.rungs[1].specular_reuse = d.rungs[1].specular_taa = MASU_ON;
        compile(&d, &with);
        for (uint32_t r = 0; r < 2; r++) {
            const masu_pass_set *active = &with.rungs[r].active;
            const masu_push_block push = masu_push_of(&with, r, MASU_PASS_SPECULAR_FILTER, 0);
            float width; /* after `taps`; then the length of the history */
            memcpy(&width, &push.own.word[1], sizeof width);
            assert_true(width == (r ? 0.5f : 2.0f));
            assert_int_equal(push.own.word[2], r ? 8 : 32);
            assert_int_equal(masu_has_pass(active, MASU_PASS_SPECULAR_REUSE), !r || asked);
            assert_int_equal(masu_has_pass(active, MASU_PASS_SPECULAR_TAA), !r || asked);
            assert_true(masu_has_pass(active, MASU_PASS_SPECULAR_TEMPORAL));
            assert_true(masu_has_pass(active, MASU_PASS_SPECULAR_FINE));
            assert_true(masu_has_pass(active, MASU_PASS_SPECULAR_FILTER));
        }
    }
}

static int composes(uint32_t rung, uint32_t image, uint32_t usage) {
    const masu_rung_plan *rp = &with.rungs[rung];
    for (uint32_t a = 0; a < rp->access_count[MASU_PASS_SPECULAR_COMPOSITE]; a++) {
        masu_access access = rp->access[MASU_PASS_SPECULAR_COMPOSITE][a];
        if (access.image == image && access.usage == usage) return 1;
    }
    return 0;
}

/* Velocities of reflections are for rungs with temporal upscaling. If one rung has it, all share
 * its descriptors. */
static void velocities_of_mirrors_are_for_rungs_with_a_past(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) { /* bit 0: a rung has temporal upscaling, bit 1: it has
                                     specular_fine */
        masu_desc d = mirrors(RASTER);
        d.rung_count = 2;
        d.rungs[1] = d.rungs[0];
        d.rungs[1].temporal = k & 1 ? MASU_ON : MASU_OFF;
        d.rungs[1].specular_fine = k & 2 ? MASU_ON : MASU_OFF;
        compile(&d, &with);
        for (uint32_t r = 0; r < 2; r++) {
            assert_int_equal(composes(r, MASU_IMAGE_VELOCITY, MASU_UPDATE), k == 3);
            assert_int_equal(composes(r, MASU_IMAGE_SPECULAR_LENGTH, MASU_READ), k == 3);
        }
    }
}

static void the_reference_is_of_full_size_and_keeps_its_sum(void **state) {
    (void)state;
    masu_desc d = mirrors(RASTER);
    d.debug.reference = 1;
    compile(&d, &with);
    assert_true(masu_has_pass(&with.rungs[0].active, MASU_PASS_SPECULAR_ACCUMULATE));
    assert_true(with.images[MASU_IMAGE_SPECULAR_SUM].used);
    assert_true(masu_images[MASU_IMAGE_SPECULAR_SUM].kept);
    assert_int_equal(with.images[MASU_IMAGE_SPECULAR_SUM].width, 640);
    assert_int_equal(with.images[MASU_IMAGE_SPECULAR_LIGHT].height, 360);
    d = scene_desc(RASTER, 640, 360); /* without reflections the setting has no effect */
    d.debug.reference = 1;
    compile(&d, &with);
    d.debug.reference = 0;
    compile(&d, &without);
    assert_same_plan(&with, &without);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_glossy_or_switched_off_costs_nothing),
        cmocka_unit_test(a_rung_without_them_runs_none_of_their_passes),
        cmocka_unit_test(what_is_glossy_is_traced_in_polygons_in_the_sdf_or_in_both),
        cmocka_unit_test(many_samples_from_one_go_without_two_means),
        cmocka_unit_test(velocities_of_mirrors_are_for_rungs_with_a_past),
        cmocka_unit_test(the_reference_is_of_full_size_and_keeps_its_sum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
