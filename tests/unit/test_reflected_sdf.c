/* test_reflected_sdf.c: the plan of reflections whose rays can hit an SDF: only the SDF's pass, or
 * with the pass of polygons, or none; and no buffer of polygons if none is traced. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "plan/compile.h"
#include "support/desc.h"

#define PASS(p) ((uint64_t)1 << MASU_PASS_SPECULAR_##p)
#define COMMON (PASS(GUIDE) | PASS(RAYS) | PASS(SHADE) | PASS(COMPOSITE))

/* The reflecting passes of the first rung. */
static uint64_t passes(const masu_desc *d, masu_frame_plan *plan) {
    masu_detail detail;
    if (masu_compile(d, 256, 64, plan, &detail)) fail_msg("rejected: %s", detail.text);
    static const uint32_t all[] = {MASU_PASS_SPECULAR_GUIDE,     MASU_PASS_SPECULAR_RAYS,
                                   MASU_PASS_SPECULAR_SHADE,     MASU_PASS_SPECULAR_COMPOSITE,
                                   MASU_PASS_SPECULAR_TRACE,     MASU_PASS_SPECULAR_TRACE_SDF};
    uint64_t active = 0;
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        if (masu_has_pass(&plan->rungs[0].active, all[i])) active |= (uint64_t)1 << all[i];
    }
    return active;
}

static masu_desc mirrors(uint32_t parts) {
    masu_desc d = scene_desc(parts, 640, 360);
    support_scene.reflections = 1;
    support_scene.specular_cutoff = 0.5f;
    support_scene.trace_distance = 100;
    support_scene.trace_sdf = (parts & SDF) != 0;
    if (parts & RASTER) support_scene.trace_instances = support_scene.trace_nodes = 2;
    return d;
}

static void an_sdf_alone_has_its_pass_and_no_buffer_of_polygons(void **state) {
    (void)state;
    masu_frame_plan plan;
    masu_desc d = mirrors(SDF);
    assert_int_equal(passes(&d, &plan), COMMON | PASS(TRACE_SDF));
    assert_int_equal(plan.buffers[MASU_BUFFER_TRACE_FRAME].bytes, 0);
    assert_int_equal(plan.buffers[MASU_BUFFER_VERTICES].bytes, 0);
    assert_int_equal(plan.buffers[MASU_BUFFER_TEXCOORDS].bytes, 0);
    assert_true(plan.buffers[MASU_BUFFER_TRACE].bytes > 0); /* the noise */
    assert_true(plan.needs.velocity);
}

static void both_have_both(void **state) {
    (void)state;
    masu_frame_plan plan;
    masu_desc d = mirrors(SDF | RASTER);
    assert_int_equal(passes(&d, &plan), COMMON | PASS(TRACE_SDF) | PASS(TRACE));
    assert_true(plan.buffers[MASU_BUFFER_TRACE_FRAME].bytes > 0);
    support_scene.trace_instances = support_scene.trace_nodes = 0;
    assert_int_equal(passes(&d, &plan), COMMON | PASS(TRACE_SDF));
    assert_int_equal(plan.buffers[MASU_BUFFER_TRACE_FRAME].bytes, 0);
    d = mirrors(RASTER);
    assert_int_equal(passes(&d, &plan), COMMON | PASS(TRACE));
    assert_false(plan.buffers[MASU_BUFFER_VERTICES].usage == 0);
}

static void where_nothing_is_glossy_nothing_is_traced(void **state) {
    (void)state;
    masu_frame_plan plan;
    masu_desc d = mirrors(SDF);
    support_scene.glossiest = 0.5f;
    assert_int_equal(passes(&d, &plan), 0);
    assert_int_equal(plan.buffers[MASU_BUFFER_TRACE].bytes, 0);
    assert_int_equal(plan.buffers[MASU_BUFFER_SPECULAR_TILES].bytes, 0);
    assert_false(plan.needs.velocity);
    support_scene.glossiest = 0.49f;
    assert_int_equal(passes(&d, &plan), COMMON | PASS(TRACE_SDF));
    support_scene.reflections = 0;
    assert_int_equal(passes(&d, &plan), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_sdf_alone_has_its_pass_and_no_buffer_of_polygons),
        cmocka_unit_test(both_have_both),
        cmocka_unit_test(where_nothing_is_glossy_nothing_is_traced),
    };
    return cmocka_run_group_tests_name("reflected_sdf", tests, NULL, NULL);
}
