/* test_init_steps.c: a renderer that is prepared in steps: its frames equal those of one prepared
 * at once by masu_init; a rung can be used before the others are ready; every step can be the last
 * one; and every call in it can fail. */
#include "support/files.h"
#include "support/support.h"
#include "support/wrap.h"

#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 66, H = 48, BYTES = W * H * 4, RUNGS = 3, FIRST = 1 };

static masu_session s;

static int open_scene(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    wrap_reset();
    d.no_renderer = true;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    open_session(&s, &d);
    s.desc.resizable = 1;
    s.desc.init_in_steps = 1;
    s.desc.first_rung = FIRST;
    s.desc.rung_count = RUNGS;
    s.desc.rungs[0] = (masu_rung){.scale = 1.0f, .aa = MASU_AA_SMAA_HIGH};
    s.desc.rungs[FIRST] = (masu_rung){.scale = 0.5f, .temporal = MASU_OFF};
    s.desc.rungs[2] = (masu_rung){.scale = 0.8f};
    s.desc.governor.mode = MASU_GOVERNOR_ON;
    return 0;
}

static int open_both(void **state) {
    (void)state;
    return open_scene("test_both");
}

static int close_scene(void **state) {
    (void)state;
    wrap_reset();
    close_session(&s);
    return 0;
}

static masu_result frame_in(own_renderer *x, uint32_t rung, masu_commands *commands) {
    masu_frame_desc frame = {MASU_FRAME_DESC, .rung = rung, .cut = 1};
    return masu_frame(x->m, &frame, commands, &failure);
}

/* Returns the rung that the frame was rendered in. */
static uint32_t draw_in(own_renderer *x, uint32_t rung, uint8_t *pixels) {
    char error[ERROR_SIZE];
    masu_commands commands;
    if (frame_in(x, rung, &commands)) fail_msg("%s", failure.text);
    assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    assert_ok(masu_headless_target_read(&s.host, &x->target, error, sizeof error));
    if (pixels) memcpy(pixels, x->target.mapped, BYTES);
    return commands.rung;
}

/* Both have rendered the same number of frames. */
static void compare_in(own_renderer *a, own_renderer *b, uint32_t rung) {
    static uint8_t pixels[2][BYTES];
    assert_int_equal(draw_in(a, rung, pixels[0]), rung);
    draw_in(b, rung, pixels[1]);
    assert_int_equal(max_difference(pixels[0], pixels[1], BYTES), 0);
}

static void rungs_become_ready_one_after_another(void **state) {
    (void)state;
    own_renderer x, whole;
    masu_desc at_once = s.desc;
    at_once.init_in_steps = at_once.first_rung = 0;
    make_own(&s, &whole, &at_once);
    masu_commands commands;
    masu_progress progress, before = {0};
    make_own(&s, &x, &s.desc);
    assert_int_equal(frame_in(&x, FIRST, &commands), MASU_ERROR_STATE);
    assert_string_equal(failure.what, "masu_init_step");
    assert_int_equal(frame_in(&x, MASU_RUNG_AUTO, &commands), MASU_ERROR_STATE);
    uint32_t steps = 0;
    masu_result result;
    do {
        result = masu_init_step(x.m, &progress, &failure);
        assert_true(result >= 0);
        steps++;
        assert_int_equal(progress.done, steps);
        assert_true(progress.total > 10 && (!before.total || progress.total == before.total));
        assert_int_equal(result == MASU_OK, progress.done == progress.total);
        assert_int_equal(result == MASU_OK, progress.rungs == 7);
        if (progress.rungs == before.rungs) continue;
        assert_int_equal(progress.rungs, !before.rungs ? 2 : before.rungs == 2 ? 3 : 7);
        /* first_rung does not need all */
        assert_true(before.rungs || steps + RUNGS < progress.total);
        for (uint32_t r = 0; r < RUNGS; r++) {
            if (progress.rungs >> r & 1u) {
                compare_in(&x, &whole, r);
            } else {
                assert_int_equal(frame_in(&x, r, &commands), MASU_ERROR_STATE);
                assert_int_equal(failure.needed, progress.total);
                assert_int_equal(failure.given, progress.done);
            }
        }
        uint32_t rung = draw_in(&x, MASU_RUNG_AUTO, NULL);
        assert_true(progress.rungs >> rung & 1u);
        draw_in(&whole, rung, NULL);
        before = progress;
    } while (result == MASU_INCOMPLETE);
    assert_int_equal(masu_init_step(x.m, &progress, &failure), MASU_OK); /* nothing is left */
    assert_int_equal(progress.done, steps);
    memset(s.blob, 0, 4096); /* from now on the blob is the host's */
    uint64_t calls = wrap.setup_calls;
    for (uint32_t r = 0; r < RUNGS; r++) compare_in(&x, &whole, r);
    assert_int_equal(wrap.setup_calls, calls);
    unmake_own(&s, &x);
    unmake_own(&s, &whole);
}

static void sizes_change_between_steps(void **state) {
    (void)state;
    static uint8_t out[BYTES], whole[RUNGS][BYTES];
    uint8_t *all[RUNGS] = {whole[0], whole[1], whole[2]};
    masu_desc small = s.desc;
    small.init_in_steps = small.first_rung = 0;
    small.output = (VkExtent2D){W / 2, H / 2};
    draw_rungs_of(&s, &small, all, NULL);
    own_renderer x;
    make_own(&s, &x, &s.desc);
    own_renderer before = x;
    make_target(&s, &x, W / 2, H / 2, 1);
    masu_targets to = {
        .images = &x.target.image, .views = &x.target.view, .count = 1, .storage = 1};
    masu_progress progress;
    for (uint32_t i = 0; i < 5; i++)
        assert_int_equal(masu_init_step(x.m, NULL, &failure), MASU_INCOMPLETE);
    assert_int_equal(masu_resize(x.m, small.output, &to, NULL, &failure), MASU_OK);
    while (masu_init_step(x.m, &progress, &failure) == MASU_INCOMPLETE) continue;
    assert_int_equal(progress.rungs, 7);
    for (uint32_t r = 0; r < RUNGS; r++) {
        char error[ERROR_SIZE];
        masu_commands commands;
        assert_int_equal(frame_in(&x, r, &commands), MASU_OK);
        assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
        assert_ok(masu_headless_target_read(&s.host, &x.target, error, sizeof error));
        memcpy(out, x.target.mapped, BYTES / 4);
        assert_int_equal(max_difference(out, whole[r], BYTES / 4), 0);
    }
    masu_headless_target_destroy(&s.host, &before.target);
    unmake_own(&s, &x);
}

static void each_step_can_be_the_last(void **state) {
    (void)state;
    masu_progress progress = {0, 1, 0};
    for (uint32_t last = 0; last < progress.total; last += trials(1, 3, 7)) {
        own_renderer x;
        int64_t live = wrap.live;
        make_own(&s, &x, &s.desc);
        for (uint32_t i = 0; i <= last; i++) assert_true(masu_init_step(x.m, &progress, NULL) >= 0);
        unmake_own(&s, &x);
        assert_int_equal(wrap.live, live);
    }
}

static void each_call_in_a_step_can_fail(void **state) {
    (void)state;
    own_renderer x;
    masu_commands commands;
    masu_progress progress;
    uint64_t first = wrap.setup_calls;
    make_own(&s, &x, &s.desc);
    uint64_t init = wrap.setup_calls - first;
    while (masu_init_step(x.m, NULL, &failure) == MASU_INCOMPLETE) continue;
    uint64_t calls = wrap.setup_calls - first - init;
    unmake_own(&s, &x);
    assert_true(calls > 20);
    for (uint64_t k = 1; k <= calls; k += trials(1, 3, 7)) {
        int64_t live = wrap.live;
        make_own(&s, &x, &s.desc);
        wrap.fail_at = wrap.setup_calls + k;
        wrap.fail_with = VK_ERROR_OUT_OF_DEVICE_MEMORY;
        masu_result result;
        while ((result = masu_init_step(x.m, &progress, &failure)) == MASU_INCOMPLETE) continue;
        wrap.fail_at = 0;
        assert_int_equal(result, MASU_ERROR_VULKAN);
        assert_string_equal(failure.what, wrap.failed_call);
        assert_true(progress.done < progress.total);
        assert_int_equal(masu_init_step(x.m, NULL, &failure), MASU_ERROR_STATE);
        assert_int_equal(frame_in(&x, FIRST, &commands), MASU_ERROR_STATE);
        unmake_own(&s, &x);
        if (wrap.live != live) fail_msg("call %llu leaks", (unsigned long long)k);
        wrap.failed_call = NULL;
    }
}

static void without_steps_there_is_nothing_to_do(void **state) {
    (void)state;
    own_renderer x;
    masu_progress progress;
    masu_desc at_once = s.desc;
    at_once.init_in_steps = 0;
    make_own(&s, &x, &at_once);
    assert_int_equal(masu_init_step(x.m, &progress, &failure), MASU_OK);
    assert_int_equal(progress.done, progress.total);
    assert_int_equal(progress.rungs, 7);
    assert_int_equal(masu_init_step(NULL, &progress, &failure), MASU_ERROR_ARGUMENT);
    unmake_own(&s, &x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(rungs_become_ready_one_after_another, open_both,
                                        close_scene),
        cmocka_unit_test_setup_teardown(sizes_change_between_steps, open_both, close_scene),
        cmocka_unit_test_setup_teardown(each_step_can_be_the_last, open_both, close_scene),
        cmocka_unit_test_setup_teardown(each_call_in_a_step_can_fail, open_both, close_scene),
        cmocka_unit_test_setup_teardown(without_steps_there_is_nothing_to_do, open_both,
                                        close_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
