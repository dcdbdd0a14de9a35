/* test_viewports.c: several views of one scene in one renderer. Each part of the target is
 * bit-identical to the image of a renderer of that size with that camera and rung, and the rest is
 * unchanged. */
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 160, H = 90, VIEWS = 3 };

static const masu_viewport left_right_map[VIEWS] = {
    {0, 0, 81, 90}, {81, 0, 79, 90}, {97, 7, 40, 24}};
static const masu_camera cameras[VIEWS] = {
    {.position = {0, 2.5, 7}, .forward = {0, -0.2f, -1}, .fov_y = 0.9f, .near_distance = 0.05f},
    {.position = {6, 2, 3}, .forward = {-1, -0.2f, -0.5f}, .fov_y = 1.1f, .near_distance = 0.05f},
    {.position = {0, 14, 0},
     .forward = {0, -1, 0},
     .up = {0, 0, -1},
     .fov_y = 0.8f,
     .near_distance = 0.05f}};
static const uint32_t rungs[VIEWS] = {0, 1, 2};

static uint8_t shown[W * H * 4], alone[W * H * 4];

static masu_desc desc_of(const masu_session *s, uint32_t width, uint32_t height) {
    masu_desc d = s->desc;
    d.scene = &s->scene;
    d.output = (VkExtent2D){width, height};
    d.targets.storage = 0;
    d.dither = MASU_OFF;
    d.rung_count = 3;
    d.rungs[0] = (masu_rung){.scale = 1.0f, .aa = MASU_AA_SMAA_LOW};
    d.rungs[1] = (masu_rung){.scale = 0.6f};
    d.rungs[2] = (masu_rung){.scale = 1.0f, .specular = MASU_OFF};
    return d;
}

/* cut: whether the host requests a cut; between different views it is not needed. */
static masu_commands frame_of(masu_session *s, own_renderer *x, uint32_t view, uint32_t viewport,
                              int cut) {
    char error[ERROR_SIZE];
    masu_commands commands;
    masu_frame_desc frame = {
        MASU_FRAME_DESC,
        .camera = &cameras[view], .rung = rungs[view], .viewport = viewport, .cut = (uint32_t)cut};
    assert_int_equal(masu_frame(x->m, &frame, &commands, &failure), MASU_OK);
    assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
    return commands;
}

static void read_target(masu_session *s, own_renderer *x, uint8_t *out) {
    char error[ERROR_SIZE];
    assert_ok(masu_headless_target_read(&s->host, &x->target, error, sizeof error));
    memcpy(out, x->target.mapped, (size_t)x->target.width * x->target.height * 4);
}

/* Whether view k is visible at a pixel: the last one that covers it. */
static uint32_t view_at(const masu_viewport *views, uint32_t x, uint32_t y) {
    uint32_t found = 0;
    for (uint32_t k = 0; k < VIEWS; k++) {
        const masu_viewport *v = &views[k];
        if (x >= v->x && y >= v->y && x - v->x < v->width && y - v->y < v->height) found = k;
    }
    return found;
}

static void compare(masu_session *s, own_renderer *x, const masu_viewport *views, uint32_t first) {
    for (uint32_t k = 0; k < VIEWS; k++) {
        masu_commands commands = frame_of(s, x, k, k, 0);
        masu_readback_image depth;
        assert_int_equal(masu_readback(x->m, commands.slot, MASU_READBACK_DEPTH, &depth, &failure),
                         MASU_OK);
        if (rungs[k] != 1) assert_int_equal(depth.width, views[k].width);
        if (rungs[k] == 1) assert_int_equal(depth.height, (uint32_t)(views[k].height * 0.6 + 0.5));
    }
    read_target(s, x, shown);
    for (uint32_t k = 0; k < VIEWS; k++) {
        own_renderer fresh;
        masu_desc d = desc_of(s, views[k].width, views[k].height);
        make_own(s, &fresh, &d);
        /* to the same frame number */
        for (uint32_t i = 0; i < first + k; i++) (void)frame_of(s, &fresh, k, 0, 1);
        (void)frame_of(s, &fresh, k, 0, 1);
        read_target(s, &fresh, alone);
        uint32_t off = 0, seen = 0;
        for (uint32_t y = 0; y < views[k].height; y++) {
            for (uint32_t i = 0; i < views[k].width; i++) {
                uint32_t px = views[k].x + i, py = views[k].y + y;
                if (view_at(views, px, py) != k) continue;
                seen++;
                off +=
                    memcmp(shown + 4 * (py * W + px), alone + 4 * (y * views[k].width + i), 4) != 0;
            }
        }
        unmake_own(s, &fresh);
        if (off || seen < 500) fail_msg("view %u: %u of %u pixels differ", k, off, seen);
    }
}

static void each_part_is_its_own_picture(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc session = test_desc("test_live", W, H);
    session.no_renderer = true;
    open_session(&s, &session);
    own_renderer x;
    masu_desc d = desc_of(&s, W, H);
    d.readback = MASU_READBACK_DEPTH;
    d.resizable = 1;
    d.viewport_count = VIEWS;
    memcpy(d.viewports, left_right_map, sizeof left_right_map);
    make_own(&s, &x, &d);
    compare(&s, &x, left_right_map, 0);
    /* Stacked instead of side by side. */
    static const masu_viewport stacked[VIEWS] = {{0, 0, 160, 40}, {3, 41, 150, 49}, {1, 1, 40, 30}};
    masu_targets t = {.images = &x.target.image, .views = &x.target.view, .count = 1};
    masu_detail detail;
    if (masu_resize(x.m, (VkExtent2D){W, H}, &t, stacked, &detail)) fail_msg("%s", detail.text);
    compare(&s, &x, stacked, VIEWS);
    unmake_own(&s, &x);
    close_session(&s);
}

static void what_is_no_part_is_refused(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc session = test_desc("test_both", W, H);
    session.no_renderer = true;
    open_session(&s, &session);
    masu_memory need;
    masu_detail detail;
    own_renderer x;
    masu_desc d = desc_of(&s, W, H);
    make_own(&s, &x, &d); /* for its target */
    d.targets.images = &x.target.image;
    d.viewport_count = 5;
    assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "viewport_count");
    static const masu_viewport wrong[] = {{0, 0, 0, 9}, {0, 0, 9, 0}, {1, 0, W, 9}, {0, 1, 9, H},
                                          {UINT32_MAX, 0, 2, 2}, {0, 0, UINT32_MAX, 2}};
    d.viewport_count = 1;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        d.viewports[0] = wrong[i];
        assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_ERROR_ARGUMENT);
        assert_string_equal(detail.what, "viewports");
    }
    d.viewports[0] = (masu_viewport){8, 0, 16, 16};
    assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_OK);
    d.targets.storage = 1;
    VkImageView view = s.views[0];
    d.targets.views = &view;
    assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_non_null(strstr(detail.text, "of storage targets they begin at 0, 0"));
    masu_commands commands;
    assert_int_equal(
        masu_frame(x.m, &(masu_frame_desc){MASU_FRAME_DESC, .viewport = 1}, &commands, &failure),
        MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "viewport 1 does not exist, the last one is 0");
    unmake_own(&s, &x);
    d = desc_of(&s, W, H);
    d.governor.mode = MASU_GOVERNOR_ON;
    d.viewport_count = VIEWS;
    memcpy(d.viewports, left_right_map, sizeof left_right_map);
    make_own(&s, &x, &d);
    const masu_frame_desc by_itself = {MASU_FRAME_DESC, .viewport = 1, .rung = MASU_RUNG_AUTO};
    assert_int_equal(masu_frame(x.m, &by_itself, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "rung");
    static masu_plan_info before, after; /* a rejected description has not been read */
    masu_plan_of(x.m, &before);
    assert_int_equal(masu_frame(x.m, &(masu_frame_desc){MASU_FRAME_DESC, .viewport = VIEWS},
                                &commands, &failure),
                     MASU_ERROR_ARGUMENT);
    masu_plan_of(x.m, &after);
    assert_memory_equal(before.rungs, after.rungs, sizeof before.rungs);
    for (uint32_t i = 0; i < 12; i++) (void)frame_of(&s, &x, 0, i % VIEWS, 1);
    masu_stats_info stats;
    assert_int_equal(masu_stats(x.m, 0, &stats, &failure), MASU_OK);
    assert_in_range(stats.governor.samples + stats.governor.rejected, 1, 4); /* only of the first */
    unmake_own(&s, &x);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_part_is_its_own_picture),
        cmocka_unit_test(what_is_no_part_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
