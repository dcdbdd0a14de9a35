/* test_resize.c: a resize renders into the existing images with another output size and other
 * targets. The images are bit-identical to those of a renderer made for that size. Nothing is
 * allocated, built or loaded, and the blob has been freed. A rejected resize changes nothing. A
 * hundred resizes use no more memory. */
#include "scene/scene.h"
#include "support/files.h"
#include "support/support.h"
#include "support/wrap.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 160, H = 90, BYTES = W * H * 4, RUNGS = 6, FRAMES = 3 };

static uint8_t pixels[2][BYTES];

static masu_desc desc_of(masu_session *s, uint32_t width, uint32_t height) {
    masu_desc d = s->desc;
    d.scene = &s->scene;
    d.output = (VkExtent2D){width, height};
    d.resizable = 1;
    d.rung_count = RUNGS;
    d.rungs[0] = (masu_rung){.scale = 1.0f, .aa = MASU_AA_SMAA_HIGH};
    d.rungs[1] = (masu_rung){.scale = 0.5f, .temporal = MASU_OFF};
    d.rungs[2] = (masu_rung){.scale = 0.7f, .easu = MASU_EASU_FAST, .aa = MASU_AA_FXAA};
    d.rungs[3] = (masu_rung){.scale = 0.6f, .temporal = MASU_ON};
    d.rungs[4] = (masu_rung){.scale = 0.9f};
    d.rungs[5] = (masu_rung){.scale = 1.0f, .temporal = MASU_ON};
    return d;
}

static masu_result resize(own_renderer *x, uint32_t width, uint32_t height, masu_detail *detail) {
    /* At another address than the previous arrays: the renderer must use the given images. */
    static VkImage images[2];
    static VkImageView views[2];
    static int turn;
    turn = !turn;
    images[turn] = x->target.image;
    views[turn] = x->target.view;
    masu_targets t = {.images = &images[turn], .views = &views[turn], .count = 1, .storage = 1};
    return masu_resize(x->m, (VkExtent2D){width, height}, &t, NULL, detail);
}

/* Renders frames of a rung; the number of the first determines the noise. cut: set by the host. */
static void draw_cut(masu_session *s, own_renderer *x, uint32_t rung, uint32_t frames, uint8_t *out,
                     int cut) {
    char error[ERROR_SIZE];
    masu_commands commands;
    for (uint32_t i = 0; i < frames; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .rung = rung, .time = 0.1 * i, .time_step = 0.1f,
                                 .cut = cut && i == 0};
        assert_int_equal(masu_frame(x->m, &frame, &commands, &failure), MASU_OK);
        assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
    }
    assert_ok(masu_headless_target_read(&s->host, &x->target, error, sizeof error));
    memcpy(out, x->target.mapped, (size_t)x->target.width * x->target.height * 4);
}

static void draw_frames(masu_session *s, own_renderer *x, uint32_t rung, uint32_t frames,
                        uint8_t *out) {
    draw_cut(s, x, rung, frames, out, 1);
}

static const uint32_t sizes[][2] = {{97, 61}, {160, 90}, {2, 90},  {1, 1},
                                    {160, 1}, {33, 20},  {112, 80}};

/* halves: history in half floats, as on devices that do not filter unorm. */
static void compare_sizes(const char *scene, size_t count, int halves) {
    masu_session s;
    masu_session_desc d = test_desc(scene, W, H);
    d.no_renderer = true;
    open_session(&s, &d);
    own_renderer live;
    masu_desc own = desc_of(&s, W, H);
    own.debug.poison = 3; /* outside the image, too */
    own.deny.unorm16 = halves;
    make_own(&s, &live, &own);
    uint32_t drawn = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t w = sizes[i][0], h = sizes[i][1];
        masu_detail detail;
        /* The previous targets still exist, and must not be written. */
        own_renderer before = live, next = live;
        make_target(&s, &next, w, h, 1);
        if (resize(&next, w, h, &detail)) fail_msg("%s", detail.text);
        live = next;
        own_renderer fresh;
        masu_desc fit = desc_of(&s, w, h);
        fit.debug.poison = 3; /* its image must not depend on memory that it has not written */
        fit.deny.unorm16 = halves;
        make_own(&s, &fresh, &fit);
        if (drawn) draw_frames(&s, &fresh, 1, drawn, pixels[1]); /* up to the same frame number */
        /* Temporal rungs before and after another size: masu_resize ends their history itself. */
        static const uint32_t order[] = {3, 0, 1, 2, 4, 5, 3};
        for (uint32_t k = 0; k <= RUNGS; k++) {
            uint32_t r = order[k];
            draw_cut(&s, &live, r, FRAMES, pixels[0], k > 0);
            draw_frames(&s, &fresh, r, FRAMES, pixels[1]);
            uint32_t most = max_difference(pixels[0], pixels[1], (size_t)w * h * 4);
            /* For a single pixel, a new rung does not upscale, but a resized one does. The
             * history's linear fetches use a part of its size: drivers may round them
             * differently. */
            if (most > (w * h == 1 ? 2u : r == 3 || r == 5 ? 1u : 0u))
                fail_msg("%s, rung %u at %ux%u: error of %u", scene, r, w, h, most);
        }
        drawn += (RUNGS + 1) * FRAMES;
        unmake_own(&s, &fresh);
        masu_headless_target_destroy(&s.host, &before.target);
    }
    unmake_own(&s, &live);
    close_session(&s);
}

static void a_smaller_picture_is_that_of_its_size(void **state) {
    (void)state;
    const uint32_t all = sizeof sizes / sizeof *sizes;
    compare_sizes("test_both", trials(all, all, 4), 0); /* including an output of one pixel */
    compare_sizes("test_both", trials(all, 2, 1), 1);
}

static void the_same_with_reflections_shadows_textures(void **state) {
    (void)state;
    compare_sizes("test_live", trials(3, 3, 2), 0);
}

/* ---- Rejected resizes ------------------------------------------------------------------------ */

static void what_cannot_be_leaves_all_as_it_was(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("test_both", W, H);
    d.no_renderer = true;
    open_session(&s, &d);
    own_renderer x;
    masu_detail detail = {0};
    masu_desc own = desc_of(&s, W, H);
    make_own(&s, &x, &own);
    draw_frames(&s, &x, 1, 1, pixels[0]);
    assert_int_equal(resize(&x, W + 1, H, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "output");
    assert_int_equal(detail.needed, W + 1);
    assert_int_equal(detail.given, W);
    assert_int_equal(resize(&x, W, H + 9, &detail), MASU_ERROR_LIMIT);
    assert_int_equal(resize(&x, 0, H, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "output.width");
    masu_targets t = {.images = &x.target.image, .views = &x.target.view, .count = 1, .storage = 1};
    const VkExtent2D size = {W, H};
    t.count = 0;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "targets.count");
    t.count = MASU_MAX_TARGETS + 1;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    t.count = 1, t.white = (float)NAN;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "targets.white");
    t.white = 0, t.storage = 0;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "targets.storage");
    t.storage = 1, t.format = VK_FORMAT_R16G16B16A16_SFLOAT;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "targets.format");
    t.format = VK_FORMAT_R8G8B8A8_UNORM, t.views = NULL;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "targets.views");
    t.views = &x.target.view, t.final_layout = VK_IMAGE_LAYOUT_GENERAL;
    assert_int_equal(masu_resize(x.m, size, &t, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_resize(x.m, size, NULL, NULL, &detail), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_resize(NULL, size, &t, NULL, NULL), MASU_ERROR_ARGUMENT);
    draw_frames(&s, &x, 1, 1, pixels[1]);
    assert_memory_equal(pixels[0], pixels[1], BYTES);
    unmake_own(&s, &x);
    own.resizable = 0;
    make_own(&s, &x, &own);
    assert_int_equal(resize(&x, W, H, &detail), MASU_ERROR_STATE);
    assert_string_equal(detail.what, "resizable");
    unmake_own(&s, &x);
    close_session(&s);
}

/* ---- A hundred times ------------------------------------------------------------------------- */

/* 20 on drivers after the first: the library's own memory does not depend on them. */
static uint32_t times(void) { return trials(100, 100, 20); }

/* Heap growth of the process between 10 and 100 new targets, with or without resizes and frames.
 * Memory for frames is the driver's. */
static int64_t grown(masu_session *s, own_renderer *x, int resizes, int frames) {
    size_t before = 0;
    for (uint32_t i = 0; i < times(); i++) {
        uint32_t w = 1 + (i * 37) % W, h = 1 + (i * 53) % H;
        masu_detail detail;
        if (resizes || !frames) {
            masu_headless_target_destroy(&s->host, &x->target);
            make_target(s, x, w, h, 1);
        }
        uint64_t setup = wrap.creates;
        if (resizes && resize(x, w, h, &detail)) fail_msg("%s", detail.text);
        assert_int_equal(wrap.creates, setup);
        if (frames) draw_frames(s, x, MASU_RUNG_AUTO, 2, pixels[0]);
        if (i == 9) before = mallinfo2().uordblks;
    }
    return (int64_t)mallinfo2().uordblks - (int64_t)before;
}

static void a_hundred_resizes_take_nothing(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("test_live", W, H);
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.host.validate = false; /* the layer allocates for itself */
    d.no_renderer = true;
    open_session(&s, &d);
    own_renderer x;
    masu_desc own = desc_of(&s, W, H);
    own.governor.mode = MASU_GOVERNOR_ON;
    make_own(&s, &x, &own);
    memset(s.blob, 0xEE,
           (size_t)masu_scene_data_of(&s.scene)->blob_bytes); /* the blob must not be read again */
    /* A leak occurs in every round; the driver's heap may retain some kilobytes at random. So one
     * of four rounds must be without growth, less than the smallest object that could leak each
     * time. */
    const int64_t most = 45 * (int64_t)(times() - 10);
    int64_t frames = grown(&s, &x, 0, 1), targets = 0, own_too = INT64_MAX / 2;
    for (int i = 0; i < 4 && own_too > targets + most; i++)
        targets = grown(&s, &x, 0, 0), own_too = grown(&s, &x, 1, 0);
    int64_t all = grown(&s, &x, 1, 1);
    printf("  heap growth after %u times: new targets %lld, with resizes %lld;\n"
           "  2 frames of one size %lld, of each size %lld\n",
           times() - 10, (long long)targets, (long long)own_too, (long long)frames, (long long)all);
    assert_true(own_too <= targets + most);
    masu_stats_info stats;
    assert_int_equal(masu_stats(x.m, 0, &stats, &failure), MASU_OK);
    /* its estimates were kept */
    assert_true(stats.governor.samples > times() * 3 / 2 || masu_session_denied());
    unmake_own(&s, &x);
    close_session(&s);
}

/* ---- In any state ---------------------------------------------------------------------------- */

/* A session without a renderer through the counting wrapper, and a description. */
static masu_desc open_wrapped(masu_session *s, const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.no_renderer = true;
    open_session(s, &d);
    return desc_of(s, W, H);
}

static uint64_t setups_of_a_frame(masu_session *s, own_renderer *x, uint32_t rung, uint32_t target,
                                  uint8_t *out) {
    char error[ERROR_SIZE];
    masu_commands commands;
    uint64_t before = wrap.setup_calls;
    assert_int_equal(masu_frame(x->m,
                                &(masu_frame_desc){MASU_FRAME_DESC, .rung = rung, .target = target},
                                &commands, &failure),
                     MASU_OK);
    uint64_t calls = wrap.setup_calls - before;
    assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
    if (!out) return calls;
    assert_ok(masu_headless_target_read(&s->host, &x->target, error, sizeof error));
    memcpy(out, x->target.mapped, (size_t)x->target.width * x->target.height * 4);
    return calls;
}

/* masu_resize records the rung in use; another rung is recorded by its first frame in each slot,
 * and then no more. */
static void the_rung_in_use_is_recorded_first(void **state) {
    (void)state;
    masu_session s;
    masu_desc own = open_wrapped(&s, "test_both");
    own_renderer x;
    masu_detail detail;
    make_own(&s, &x, &own);
    for (uint32_t i = 0; i < 4; i++) assert_int_equal(setups_of_a_frame(&s, &x, 2, 0, NULL), 0);
    uint64_t before = wrap.setup_calls;
    assert_int_equal(resize(&x, 80, 44, &detail), MASU_OK);
    assert_int_equal(wrap.setup_calls - before, 2 * 3); /* slots; reset, begin, end */
    for (uint32_t i = 0; i < 4; i++) assert_int_equal(setups_of_a_frame(&s, &x, 2, 0, NULL), 0);
    for (uint32_t i = 0; i < 4; i++)
        assert_int_equal(setups_of_a_frame(&s, &x, 0, 0, NULL), i < 2 ? 3 : 0);
    for (uint32_t i = 0; i < 2; i++) assert_int_equal(setups_of_a_frame(&s, &x, 2, 0, NULL), 0);
    unmake_own(&s, &x);
    close_session(&s);
}

/* Before a load, between its steps and after it, to more targets and to fewer, larger than the
 * rendered area: the image equals that of a renderer made for that size. */
static void a_resize_is_allowed_in_any_state(void **state) {
    (void)state;
    enum { SMALL_W = 80, SMALL_H = 44 };
    masu_session s;
    masu_desc own = open_wrapped(&s, "test_texture_mask");
    own_renderer fresh, x = {.m = NULL};
    masu_detail detail;
    masu_memory need;
    masu_commands commands;
    char error[ERROR_SIZE];
    masu_desc fit = own;
    fit.output = (VkExtent2D){SMALL_W, SMALL_H};
    make_own(&s, &fresh, &fit);
    (void)setups_of_a_frame(&s, &fresh, 1, 0, pixels[1]);
    unmake_own(&s, &fresh);
    for (uint32_t when = 0; when < 3; when++) {
        make_target(&s, &x, W, H, 1);
        masu_headless_target others[4];
        VkImage images[5] = {x.target.image};
        VkImageView views[5] = {x.target.view};
        for (uint32_t t = 0; t < 4; t++) {
            assert_ok(masu_headless_target_create(&s.host, W + t, H, VK_FORMAT_R8G8B8A8_UNORM, 1,
                                                  &others[t], error, sizeof error));
            images[1 + t] = others[t].image, views[1 + t] = others[t].view;
        }
        masu_desc d = own;
        d.load_step = MASU_LOAD_STEP_MIN;
        d.deny.unified_memory = 1;
        d.targets.images = images, d.targets.views = views, d.targets.count = 2;
        assert_int_equal(masu_memory_query(&d, &need, NULL), MASU_OK);
        x.block = host_block(need.host_bytes);
        if (masu_init(&d, x.block, need.host_bytes, &x.m, &detail)) fail_msg("%s", detail.text);
        masu_targets t = {.images = images, .views = views, .count = 5, .storage = 1};
        const VkExtent2D small = {SMALL_W, SMALL_H};
        uint32_t steps = 0;
        if (when == 0) assert_int_equal(masu_resize(x.m, small, &t, NULL, &detail), MASU_OK);
        while (masu_load(x.m, &commands, &failure) == MASU_INCOMPLETE) {
            if (commands.part_count)
                assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
            if (when == 1 && ++steps == 3)
                assert_int_equal(masu_resize(x.m, small, &t, NULL, &detail), MASU_OK);
        }
        if (when == 1) assert_true(steps > 3);
        if (when == 2) assert_int_equal(masu_resize(x.m, small, &t, NULL, &detail), MASU_OK);
        memset(images, 0, sizeof images),
            memset(views, 0, sizeof views); /* read only during the call */
        assert_int_equal(setups_of_a_frame(&s, &x, 1, 4, NULL), 3);
        assert_ok(masu_headless_target_read(&s.host, &others[3], error, sizeof error));
        for (uint32_t y = 0; y < SMALL_H; y++)
            assert_memory_equal((uint8_t *)others[3].mapped + (size_t)4 * y * (W + 3),
                                pixels[1] + (size_t)4 * y * SMALL_W, 4 * SMALL_W);
        images[0] = others[2].image, views[0] = others[2].view;
        t.count = 1;
        assert_int_equal(masu_resize(x.m, small, &t, NULL, &detail), MASU_OK);
        assert_int_equal(
            masu_frame(x.m, &(masu_frame_desc){MASU_FRAME_DESC, .target = 1}, &commands, &failure),
            MASU_ERROR_ARGUMENT);
        (void)setups_of_a_frame(&s, &x, 1, 0, NULL);
        assert_ok(masu_headless_target_read(&s.host, &others[2], error, sizeof error));
        unmake_own(&s, &x);
        for (uint32_t i = 0; i < 4; i++) masu_headless_target_destroy(&s.host, &others[i]);
    }
    assert_int_equal(s.host.messages, 0);
    close_session(&s);
}

/* Each call of masu_resize, and of the frame that records the rest, fails once. Every other call
 * then works or fails; once no call fails, the next frame is correct. */
static void what_fails_half_way_is_made_good(void **state) {
    (void)state;
    masu_session s;
    masu_desc own = open_wrapped(&s, "test_both");
    own_renderer x;
    masu_detail detail;
    masu_commands commands;
    make_own(&s, &x, &own);
    memset(s.blob, 0xEE, (size_t)masu_scene_data_of(&s.scene)->blob_bytes);
    (void)setups_of_a_frame(&s, &x, 0, 0, NULL);
    for (uint32_t k = 1; k <= 9; k++) {
        masu_headless_target_destroy(&s.host, &x.target);
        make_target(&s, &x, 96, 54, 1);
        wrap.failed_call = NULL;
        wrap.fail_at = wrap.setup_calls + k;
        wrap.fail_with = VK_ERROR_OUT_OF_HOST_MEMORY;
        masu_result result = resize(&x, 96, 54, &detail);
        assert_int_equal(result, k <= 6 ? MASU_ERROR_VULKAN : MASU_OK);
        if (result) assert_string_equal(detail.what, wrap.failed_call);
        assert_int_equal(masu_load(x.m, &commands, &failure), MASU_OK); /* the blob was freed */
        result =
            masu_frame(x.m, &(masu_frame_desc){MASU_FRAME_DESC, .rung = 1}, &commands, &failure);
        assert_int_equal(result, k > 6 ? MASU_ERROR_VULKAN : MASU_OK);
        if (result) assert_int_equal(failure.vulkan, VK_ERROR_OUT_OF_HOST_MEMORY);
        wrap.fail_at = 0;
        (void)setups_of_a_frame(&s, &x, 0, 0, pixels[k > 1]);
        if (k > 1) assert_memory_equal(pixels[0], pixels[1], 96 * 54 * 4);
        (void)setups_of_a_frame(&s, &x, 0, 0, NULL);
        assert_int_equal(setups_of_a_frame(&s, &x, 0, 0, NULL), 0);
    }
    wrap.fail_at = wrap.setup_calls + 2;
    wrap.fail_with = VK_ERROR_DEVICE_LOST;
    wrap.persistent = true;
    assert_int_equal(resize(&x, 96, 54, &detail), MASU_ERROR_DEVICE_LOST);
    assert_int_equal(resize(&x, 96, 54, &detail), MASU_ERROR_DEVICE_LOST);
    assert_int_equal(detail.vulkan, VK_ERROR_DEVICE_LOST);
    assert_int_equal(masu_load(x.m, &commands, &failure), MASU_ERROR_DEVICE_LOST);
    assert_int_equal(
        masu_frame(x.m, &(masu_frame_desc){MASU_FRAME_DESC, .rung = 0}, &commands, &failure),
        MASU_ERROR_DEVICE_LOST);
    assert_int_equal(wrap.calls_after_loss, 0);
    wrap.fail_at = 0, wrap.persistent = false;
    unmake_own(&s, &x);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_smaller_picture_is_that_of_its_size),
        cmocka_unit_test(the_same_with_reflections_shadows_textures),
        cmocka_unit_test(what_cannot_be_leaves_all_as_it_was),
        cmocka_unit_test(a_hundred_resizes_take_nothing),
        cmocka_unit_test(the_rung_in_use_is_recorded_first),
        cmocka_unit_test(a_resize_is_allowed_in_any_state),
        cmocka_unit_test(what_fails_half_way_is_made_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
