/* test_split.c: frames in parts (masu_desc.split): the plan with a split, and no cost without
 * one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "plan/compile.h"
#include "support/desc.h"

#define TONE MASU_SPLIT_BEFORE_TONE
#define OUTPUT MASU_SPLIT_AFTER_UPSCALE
#define VELOCITY MASU_SPLIT_VELOCITY
#define KEEP MASU_SPLIT_KEEP

static masu_frame_plan plan, other;

static void compile(const masu_desc *d, masu_frame_plan *out) {
    masu_detail detail;
    if (masu_compile(d, 256, 64, out, &detail)) fail_msg("rejected: %s", detail.text);
}

static void assert_refused(masu_desc *d, uint32_t split, const char *text) {
    masu_detail detail;
    d->split = split;
    assert_int_equal(masu_compile(d, 256, 64, &plan, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "split");
    assert_int_equal(detail.given, split);
    if (!strstr(detail.text, text)) fail_msg("\"%s\" is not in \"%s\"", text, detail.text);
}

static int runs(const masu_frame_plan *p, uint32_t pass) {
    return masu_first_rung(p, pass) != NULL;
}

static int has_access(const masu_frame_plan *p, uint32_t pass, uint32_t image, masu_usage usage) {
    const masu_rung_plan *rp = masu_first_rung(p, pass);
    int found = 0;
    for (uint32_t a = 0; rp && a < rp->access_count[pass]; a++)
        found |= rp->access[pass][a].image == image && rp->access[pass][a].usage == usage;
    return found;
}

static void what_makes_no_sense_is_refused(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 64, 36);
    assert_refused(&d, 16, "split is 16, allowed are 0 to 15");
    assert_refused(&d, UINT32_MAX, "allowed are 0 to 15");
    assert_refused(&d, KEEP, "MASU_SPLIT_KEEP keeps for MASU_SPLIT_AFTER_UPSCALE");
    assert_refused(&d, TONE | KEEP, "MASU_SPLIT_KEEP keeps for MASU_SPLIT_AFTER_UPSCALE");
    assert_refused(&d, VELOCITY,
                   "MASU_SPLIT_VELOCITY takes MASU_SPLIT_BEFORE_TONE or MASU_SPLIT_KEEP");
    assert_refused(&d, OUTPUT | VELOCITY, "MASU_SPLIT_VELOCITY takes");
    masu_desc source = source_desc(64, 36);
    assert_refused(&source, TONE, "without a scene there is MASU_SPLIT_AFTER_UPSCALE alone");
    assert_refused(&source, OUTPUT | KEEP, "without a scene");
    source.split = OUTPUT;
    compile(&source, &plan);
    assert_int_equal(plan.parts, 2);
}

/* Everything except the numbers of rows, which do not depend on the plan. */
static void without_a_split_nothing_is_planned(void **state) {
    (void)state;
    for (uint32_t parts = RASTER; parts <= (RASTER | SDF); parts++) {
        masu_desc d = scene_desc(parts, 640, 360);
        compile(&d, &plan);
        assert_int_equal(plan.parts, 1);
        assert_false(runs(&plan, MASU_PASS_SPLIT_DEPTH));
        assert_false(runs(&plan, MASU_PASS_SPLIT_TONE));
        assert_false(runs(&plan, MASU_PASS_SPLIT_OUTPUT));
        assert_false(plan.images[MASU_IMAGE_SPLIT_DEPTH].used);
        assert_string_equal(plan.why[MASU_PASS_SPLIT_TONE], "desc.split does not request it");
        for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
            const masu_image_plan *image = &plan.images[i];
            if (!image->used) continue;
            int attached = i == MASU_IMAGE_DEPTH || i == MASU_IMAGE_ALBEDO ||
                           i == MASU_IMAGE_NORMAL || i == MASU_IMAGE_SHADOW_MAP ||
                           i == MASU_IMAGE_OCCLUDERS || i == MASU_IMAGE_VELOCITY ||
                           i == MASU_IMAGE_SURFACE;
            if (!attached) assert_int_equal(image->usage & VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0);
            assert_int_equal(image->usage & VK_IMAGE_USAGE_TRANSFER_SRC_BIT, 0);
        }
    }
}

static void assert_usage(uint32_t image, VkImageUsageFlags usage) {
    assert_true(plan.images[image].used);
    assert_int_equal(plan.images[image].usage & usage, usage);
}

static void images_are_there_for_the_host_and_alive(void **state) {
    (void)state;
    const VkImageUsageFlags read = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const VkImageUsageFlags drawn = read | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    const VkImageUsageFlags tested = read | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    for (uint32_t parts = RASTER; parts <= (RASTER | SDF); parts++) {
        uint32_t depth = parts & SDF ? MASU_IMAGE_SPLIT_DEPTH : MASU_IMAGE_DEPTH;
        masu_desc d = scene_desc(parts, 640, 360);
        d.targets.storage = 0;
        d.split = TONE;
        compile(&d, &plan);
        assert_int_equal(plan.parts, 2);
        assert_int_equal(runs(&plan, MASU_PASS_SPLIT_DEPTH), (parts & SDF) != 0);
        assert_int_equal(plan.images[MASU_IMAGE_SPLIT_DEPTH].used, (parts & SDF) != 0);
        assert_usage(MASU_IMAGE_HDR, drawn | VK_IMAGE_USAGE_STORAGE_BIT);
        assert_usage(depth, tested);
        assert_false(plan.images[MASU_IMAGE_VELOCITY].used);
        assert_in_range(plan.images[depth].last, MASU_PASS_SPLIT_TONE, MASU_PASS_SPLIT_OUTPUT - 1);
        assert_true(has_access(&plan, MASU_PASS_SPLIT_TONE, MASU_IMAGE_HDR, MASU_HOST_COLOR));
        assert_true(has_access(&plan, MASU_PASS_SPLIT_TONE, depth, MASU_HOST_DEPTH));

        d.split = OUTPUT;
        compile(&d, &plan);
        assert_int_equal(plan.parts, 2);
        assert_false(runs(&plan, MASU_PASS_SPLIT_DEPTH));
        assert_usage(MASU_IMAGE_FINAL, drawn);
        assert_true(has_access(&plan, MASU_PASS_SPLIT_OUTPUT, MASU_IMAGE_FINAL, MASU_HOST_COLOR));
        assert_int_equal(plan.rungs[0].access_count[MASU_PASS_SPLIT_OUTPUT], 1);
        assert_true(plan.images[MASU_IMAGE_HDR].last < MASU_PASS_SPLIT_OUTPUT);
        assert_int_equal(plan.images[MASU_IMAGE_HDR].usage & VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                         0);

        d.split = MASU_SPLIT_ALL;
        compile(&d, &plan);
        assert_int_equal(plan.parts, 3);
        assert_usage(MASU_IMAGE_VELOCITY, read);
        assert_int_equal(plan.images[MASU_IMAGE_HDR].last, MASU_PASS_SPLIT_OUTPUT);
        assert_int_equal(plan.images[MASU_IMAGE_VELOCITY].last, MASU_PASS_SPLIT_OUTPUT);
        assert_int_equal(plan.images[depth].last, MASU_PASS_SPLIT_OUTPUT);
        assert_true(has_access(&plan, MASU_PASS_SPLIT_OUTPUT, MASU_IMAGE_HDR, MASU_READ_HOST));
    }
}

/* A storage target is the host's own image. */
static void the_last_pass_stays_the_last(void **state) {
    (void)state;
    for (uint32_t storage = 0; storage < 2; storage++) {
        masu_desc d = scene_desc(RASTER, 640, 360);
        d.targets.storage = storage;
        compile(&d, &other);
        d.split = TONE | OUTPUT;
        compile(&d, &plan);
        for (uint32_t r = 0; r < plan.desc.rung_count; r++) {
            for (uint32_t p = 0; p < MASU_PASS_COUNT; p++)
                assert_int_equal(masu_comes_last(&plan.rungs[r], p),
                                 masu_comes_last(&other.rungs[r], p));
        }
        uint32_t shown = storage ? MASU_IMAGE_TARGET : MASU_IMAGE_FINAL;
        assert_true(has_access(&plan, MASU_PASS_SPLIT_OUTPUT, shown, MASU_HOST_COLOR));
        assert_int_equal(plan.recordings, other.recordings);
        assert_int_equal(plan.pass_sets, other.pass_sets);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(without_a_split_nothing_is_planned),
        cmocka_unit_test(images_are_there_for_the_host_and_alive),
        cmocka_unit_test(the_last_pass_stays_the_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
