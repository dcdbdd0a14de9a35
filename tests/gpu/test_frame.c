/* test_frame.c: frames do not depend on irrelevant conditions: poison, memory split by role, the
 * owner of the memory, frames in flight, the previous rung, the way to the target. */
#include "support/kept.h"
#include "support/support.h"

#include <stdlib.h>
#include <string.h>

enum { W = 160, H = 90, BYTES = W * H * 4 };

static uint8_t reference[3][BYTES], pixels[BYTES];

static int draw_references(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    open_session(&s, &d);
    for (uint32_t r = 0; r < 3; r++) draw_rung(&s, r, reference[r]);
    close_session(&s);
    return 0;
}

static void compare_all_rungs(const masu_session_desc *d) {
    masu_session s;
    open_session(&s, d);
    for (uint32_t r = 0; r < 3; r++) {
        draw_rung(&s, r, pixels);
        assert_int_equal(max_difference(pixels, reference[r], BYTES), 0);
    }
    close_session(&s);
}

static void the_picture_shows_both_worlds(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    masu_stats_info stats;
    open_session(&s, &d);
    draw_rung(&s, 0, pixels);
    assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
    assert_true(stats.sdf_hits > W * H / 100);      /* the SDF is visible */
    assert_true(stats.sdf_hits < W * H * 95 / 100); /* and not everywhere */
    assert_true(stats.triangles > 0);
    assert_int_equal(stats.replaced, 0);
    /* Not one flat colour: a quarter of the image differs from its first pixel. */
    uint32_t different = 0;
    for (uint32_t i = 0; i < W * H; i++) different += memcmp(pixels, pixels + 4 * i, 3) != 0;
    assert_true(different > W * H / 4);
    for (uint32_t i = 0; i < W * H; i++) assert_int_equal(pixels[4 * i + 3], 255);
    close_session(&s);
}

static void a_second_run_gives_the_same_bits(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    compare_all_rungs(&d);
}

/* Software drivers split work over threads: results must not depend on the split. (Other drivers
 * ignore the variable.) */
static void the_number_of_worker_threads_changes_nothing(void **state) {
    (void)state;
    static const char *const counts[] = {"0", "1", "2"};
    for (size_t i = 0; i < 3; i++) {
        setenv("LP_NUM_THREADS", counts[i], 1);
        kept_forget(); /* the variable is read at device creation */
        masu_session_desc d = test_desc("test_both", W, H);
        uint32_t compiled = kept.compiled;
        compare_all_rungs(&d);
        assert_true(kept.compiled > compiled);
    }
    unsetenv("LP_NUM_THREADS");
    kept_forget();
}

/* The guarantees of support/kept.h: equal pipelines are not compiled again, different ones are. */
static void sessions_share_what_is_compiled_and_nothing_else(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    kept_forget();
    kept_counts before = kept;
    compare_all_rungs(&d);
    uint32_t asked = kept.asked - before.asked;
    print_message("%u pipelines requested, %u compiled\n", asked, kept.compiled - before.compiled);
    assert_true(asked >= 8 && kept.compiled > before.compiled &&
                kept.compiled - before.compiled <= asked);
    before = kept;
    compare_all_rungs(&d);
    assert_int_equal(kept.asked - before.asked, asked);
    assert_int_equal(kept.compiled, before.compiled);
    /* Another tone curve is a constant of one pass, which has one pipeline for rungs that it ends
     * and one for others. */
    masu_session s;
    d.desc.tone = MASU_TONE_NEUTRAL;
    open_session(&s, &d);
    draw_rung(&s, 0, pixels);
    assert_true(max_difference(pixels, reference[0], BYTES) > 0);
    close_session(&s);
    assert_int_equal(kept.compiled - before.compiled, 2);
}

static void nan_poison_in_all_transient_memory_changes_nothing(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.debug.poison = 1;
    compare_all_rungs(&d);
}

static void infinity_poison_changes_nothing(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.debug.poison = 2;
    compare_all_rungs(&d);
}

static void poison_that_is_half_numbers_changes_nothing(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.debug.poison = 3;
    compare_all_rungs(&d);
}

static void separate_memory_per_role_changes_nothing(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.deny.unified_memory = 1;
    compare_all_rungs(&d);
}

static void one_and_three_frames_in_flight_change_nothing(void **state) {
    (void)state;
    for (uint32_t flights = 1; flights <= 3; flights += 2) {
        masu_session_desc d = test_desc("test_both", W, H);
        d.desc.frames_in_flight = flights;
        compare_all_rungs(&d);
    }
}

static void timestamps_change_nothing_and_name_the_passes_that_ran(void **state) {
    (void)state;
    if (masu_session_denied()) skip(); /* no timestamps */
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.debug.timestamps = 1;
    compare_all_rungs(&d);
    masu_session s;
    masu_stats_info stats;
    open_session(&s, &d);
    assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_INCOMPLETE);
    assert_true(stats.frame == UINT64_MAX);
    draw_rung(&s, 2, NULL);
    assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
    assert_int_equal(stats.timed, 1);
    assert_int_equal(stats.frame, 0);
    assert_int_equal(stats.rung, 2);
    for (uint32_t p = 0; p < stats.pass_count; p++) {
        if (!strcmp(stats.pass_names[p], "present")) assert_int_equal(stats.pass_ns[p], 0);
    }
    assert_int_equal(masu_stats(s.m, 7, &stats, NULL), MASU_ERROR_ARGUMENT);
    close_session(&s);
}

/* A reused slot does not report the times of its last frame as the next frame's. */
static void a_frame_that_has_not_ended_has_no_times(void **state) {
    (void)state;
    if (masu_session_denied()) skip(); /* no timestamps */
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.debug.timestamps = 1;
    d.desc.frames_in_flight = 1;
    d.desc.readback = MASU_READBACK_DEPTH;
    masu_session s;
    masu_stats_info stats;
    masu_readback_image image;
    masu_commands commands;
    char error[ERROR_SIZE];
    const masu_frame_desc frame = {MASU_FRAME_DESC, .rung = 1};
    open_session(&s, &d);
    for (uint32_t n = 0; n < 4; n++) {
        assert_int_equal(masu_frame(s.m, &frame, &commands, NULL), MASU_OK);
        assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_INCOMPLETE);
        assert_int_equal(stats.frame, n);
        assert_int_equal(stats.rung, 1);
        assert_int_equal(stats.timed, 0);
        assert_int_equal(stats.gpu_ns, 0);
        assert_int_equal(masu_readback(s.m, 0, MASU_READBACK_DEPTH, &image, NULL), MASU_INCOMPLETE);
        if (n == 2) continue; /* and one frame that is never submitted */
        assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
        assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
        assert_int_equal(stats.frame, n);
        assert_int_equal(stats.timed, 1);
        assert_true(stats.gpu_ns > 0);
        assert_int_equal(masu_readback(s.m, 0, MASU_READBACK_DEPTH, &image, NULL), MASU_OK);
    }
    close_session(&s);
}

/* Smaller rungs render into a corner of larger images: remains of an earlier frame outside must not
 * be visible. */
static void a_rung_does_not_see_what_larger_rungs_left(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    open_session(&s, &d);
    static const uint32_t order[] = {0, 2, 1, 2, 0, 1, 1, 2, 2, 0};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
        draw_rung(&s, order[i], pixels);
        assert_int_equal(max_difference(pixels, reference[order[i]], BYTES), 0);
    }
    close_session(&s);
}

static void a_blitted_bgra_target_has_the_same_colours(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.desc.targets.storage = 0;
    d.desc.targets.format = VK_FORMAT_B8G8R8A8_UNORM;
    d.desc.dither = MASU_OFF; /* such targets are dithered by default */
    masu_session s;
    open_session(&s, &d);
    for (uint32_t r = 0; r < 3; r++) {
        draw_rung(&s, r, pixels);
        for (uint32_t i = 0; i < W * H; i++) {
            uint8_t blue = pixels[4 * i];
            pixels[4 * i] = pixels[4 * i + 2];
            pixels[4 * i + 2] = blue;
        }
        assert_int_equal(max_difference(pixels, reference[r], BYTES), 0);
    }
    close_session(&s);
}

static void each_of_several_targets_gets_the_picture(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    d.target_count = 3;
    masu_session s;
    masu_commands commands;
    open_session(&s, &d);
    for (uint32_t i = 0; i < 9; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .rung = i / 3, .target = i % 3};
        draw(&s, &frame, &commands, pixels);
        assert_int_equal(commands.slot, i % 2);
        assert_int_equal(commands.frame, i);
        assert_int_equal(max_difference(pixels, reference[frame.rung], BYTES), 0);
    }
    close_session(&s);
}

/* The scene in memory provided by the host, in blocks at odd offsets of larger allocations. */
static void memory_of_the_host_works(void **state) {
    (void)state;
    for (uint32_t split = 0; split < 2; split++) {
        masu_session_desc d = test_desc("test_both", W, H);
        masu_session s;
        char error[ERROR_SIZE];
        d.no_renderer = true;
        d.desc.deny.unified_memory = split;
        open_session(&s, &d);
        assert_int_equal(masu_memory_query(&s.desc, &s.need, NULL), MASU_OK);
        VkDeviceMemory memory[MASU_ROLE_COUNT] = {VK_NULL_HANDLE};
        for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) {
            const masu_role_need *need = &s.need.roles[r];
            if (!need->bytes) continue;
            VkDeviceSize offset = (70000 / need->alignment + 1) * need->alignment;
            VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                         .allocationSize = offset + need->bytes,
                                         .memoryTypeIndex = need->type};
            assert_int_equal(vkAllocateMemory(s.host.device, &info, NULL, &memory[r]), VK_SUCCESS);
            unsigned char *mapped = NULL;
            if (need->host_visible) {
                void *p = NULL;
                assert_int_equal(vkMapMemory(s.host.device, memory[r], 0, VK_WHOLE_SIZE, 0, &p),
                                 VK_SUCCESS);
                mapped = (unsigned char *)p + offset;
            }
            s.desc.device_blocks[r] =
                (masu_device_block){memory[r], offset, need->bytes, mapped, need->type};
        }
        /* One byte too few is rejected with the member's name. */
        masu_detail detail;
        masu_renderer *none = NULL;
        s.desc.device_blocks[MASU_ROLE_DEVICE].bytes--;
        void *block = host_block(s.need.host_bytes);
        assert_int_equal(masu_init(&s.desc, block, s.need.host_bytes, &none, &detail),
                         MASU_ERROR_MEMORY);
        assert_null(none);
        assert_int_equal(detail.needed, detail.given + 1);
        assert_non_null(strstr(detail.text, "device_blocks[MASU_ROLE_DEVICE]"));
        free(block);
        s.desc.device_blocks[MASU_ROLE_DEVICE].bytes++;
        assert_ok(masu_session_start(&s, error, sizeof error));
        for (uint32_t r = 0; r < 3; r++) {
            draw_rung(&s, r, pixels);
            assert_int_equal(max_difference(pixels, reference[r], BYTES), 0);
        }
        masu_destroy(s.m);
        s.m = NULL;
        for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) vkFreeMemory(s.host.device, memory[r], NULL);
        close_session(&s);
    }
}

static void sizes_from_one_pixel_up_draw(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {1, 9}, {7, 1}, {8, 8}, {9, 17}, {33, 5}, {65, 31}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        masu_session_desc d = test_desc("test_both", sizes[i][0], sizes[i][1]);
        masu_session s;
        masu_stats_info stats;
        open_session(&s, &d);
        for (uint32_t r = 0; r < 3; r++) {
            draw_rung(&s, r, pixels);
            assert_int_equal(masu_stats(s.m, r % 2, &stats, NULL), MASU_OK);
            assert_int_equal(stats.replaced, 0);
        }
        close_session(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_shows_both_worlds),
        cmocka_unit_test(a_second_run_gives_the_same_bits),
        cmocka_unit_test(the_number_of_worker_threads_changes_nothing),
        cmocka_unit_test(sessions_share_what_is_compiled_and_nothing_else),
        cmocka_unit_test(nan_poison_in_all_transient_memory_changes_nothing),
        cmocka_unit_test(infinity_poison_changes_nothing),
        cmocka_unit_test(poison_that_is_half_numbers_changes_nothing),
        cmocka_unit_test(separate_memory_per_role_changes_nothing),
        cmocka_unit_test(one_and_three_frames_in_flight_change_nothing),
        cmocka_unit_test(timestamps_change_nothing_and_name_the_passes_that_ran),
        cmocka_unit_test(a_frame_that_has_not_ended_has_no_times),
        cmocka_unit_test(a_rung_does_not_see_what_larger_rungs_left),
        cmocka_unit_test(a_blitted_bgra_target_has_the_same_colours),
        cmocka_unit_test(each_of_several_targets_gets_the_picture),
        cmocka_unit_test(memory_of_the_host_works),
        cmocka_unit_test(sizes_from_one_pixel_up_draw),
    };
    return cmocka_run_group_tests_name("frame", tests, draw_references, NULL);
}
