/* test_fixed_memory.c: the fixed memory block: its size is fixed in advance, it never grows, and
 * nothing is allocated outside. */
#include "support/support.h"
#include "support/random.h"
#include "support/wrap.h"

#include "alloc_count.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 66, H = 48 };

/* The library's own heap allocations are counted without the validation layer, which allocates
 * inside the calls it wraps. */
static void three_hundred_frames(const char *scene, const char *instance, bool validate) {
    masu_session_desc d = test_desc(scene, W, H);
    masu_session s;
    char error[ERROR_SIZE];
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.host.validate = validate;
    d.desc.debug.timestamps = 1;
    d.desc.governor.mode = MASU_GOVERNOR_ON;
    d.desc.readback = MASU_READBACK_DEPTH;
    d.desc.rung_count = 3;
    for (uint32_t r = 0; r < 3; r++) { /* the last two alternate their cascades, if any */
        d.desc.rungs[r].scale = r == 0 ? 1.0f : r == 1 ? 0.8f : 0.4f;
        d.desc.rungs[r].shadow_resolution = 128 >> r;
        d.desc.rungs[r].temporal = r == 2 ? MASU_OFF : MASU_AUTO; /* AUTO is on */
        d.desc.rungs[r].shadow_refresh[1] = d.desc.rungs[r].shadow_refresh[2] = 1 + 2 * r;
    }
    open_session(&s, &d);
    uint64_t setup = wrap.setup_calls, heap = 0;
    int64_t live = wrap.live;
    assert_true(setup > 50); /* the wrapper is active */
    masu_instance box = masu_instance_find(s.m, instance);
    assert_int_not_equal(box.id, 0);
    for (uint32_t i = 0; i < 300; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC,
                                 .rung = i % 50 < 25 ? (i * 7 + i / 3) % 3 : MASU_RUNG_AUTO,
                                 .time = 0.01 * i};
        masu_commands commands;
        masu_stats_info stats;
        masu_readback_image depth;
        masu_camera camera;
        assert_ok(masu_headless_wait(&s.host, i % 2, error, sizeof error));
        float rows[12] = {1, 0, 0, 0.001f * (float)i, 0, 1, 0, 0, 0, 0, 1, 0};
        uint64_t before = masu_allocs_of_thread();
        if (i >= 2) {
            assert_int_equal(masu_stats(s.m, i % 2, &stats, &failure), MASU_OK);
            assert_int_equal(masu_readback(s.m, i % 2, MASU_READBACK_DEPTH, &depth, &failure),
                             MASU_OK);
            assert_int_equal(stats.frame, i - 2);
        }
        masu_frame_wall(s.m, i % 2, 1.0 + i % 40);
        assert_int_equal(masu_camera_at(s.m, frame.time, &camera, &failure), MASU_OK);
        assert_int_equal(masu_instance_set_transform(s.m, box, rows, &failure), MASU_OK);
        assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_OK);
        heap += masu_allocs_of_thread() - before;
        assert_ok(
            masu_headless_submit(&s.host, commands.buffer, commands.slot, error, sizeof error));
    }
    for (uint32_t i = 0; i < 2; i++) assert_ok(masu_headless_wait(&s.host, i, error, sizeof error));
    assert_int_equal(wrap.setup_calls, setup);
    assert_int_equal(wrap.live, live);
    if (masu_alloc_counting() && !validate) assert_int_equal(heap, 0);
    close_session(&s);
    assert_int_equal(wrap.live, 0);
}

static void three_hundred_frames_with_rung_changes_allocate_nothing(void **state) {
    (void)state;
    three_hundred_frames("test_both", "box", false);
    three_hundred_frames("test_shadows", "box", false);
    three_hundred_frames("test_texture_mask", "disc", false);
}

static void three_hundred_frames_with_rung_changes_create_nothing_and_validate(void **state) {
    (void)state;
    three_hundred_frames("test_both", "box", true);
    three_hundred_frames("test_shadows", "box", true);
}

static void the_counter_counts(void **state) {
    (void)state;
    if (!masu_alloc_counting()) skip();
    uint64_t before = masu_allocs_of_thread();
    void *volatile p = malloc(100);
    assert_int_equal(masu_allocs_of_thread(), before + 1);
    free(p);
}

/* A block of noise between canaries: the renderer assumes nothing about its content and writes
 * nothing outside. */
static void the_block_is_used_to_the_byte(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_memory_query(&s.desc, &s.need, NULL), MASU_OK);
    size_t bytes = (size_t)s.need.host_bytes, room = (bytes + 3 * 64) / 64 * 64;
    unsigned char *outer = aligned_alloc(64, room + 64), *block = outer + 64;
    uint64_t noise = 12345;
    for (size_t i = 0; i < room + 64; i++) {
        outer[i] = (unsigned char)random_word(&noise);
    }
    unsigned char *copy = malloc(room + 64);
    memcpy(copy, outer, room + 64);
    masu_detail detail;
    masu_renderer *m = NULL;
    assert_int_equal(masu_init(&s.desc, block, bytes - 1, &m, &detail), MASU_ERROR_MEMORY);
    assert_null(m);
    assert_int_equal(detail.needed, bytes);
    assert_int_equal(detail.given, bytes - 1);
    assert_memory_equal(copy, outer, room + 64); /* not a byte has been written */
    assert_int_equal(masu_init(&s.desc, block, bytes / 2, &m, &detail), MASU_ERROR_MEMORY);
    assert_int_equal(masu_init(&s.desc, block, 0, &m, &detail), MASU_ERROR_MEMORY);
    assert_int_equal(masu_init(&s.desc, NULL, bytes, &m, &detail), MASU_ERROR_MEMORY);
    assert_int_equal(masu_init(&s.desc, block + 8, bytes, &m, &detail), MASU_ERROR_MEMORY);
    assert_memory_equal(copy, outer, room + 64);
    assert_int_equal(masu_init(&s.desc, block, bytes, &m, &detail), MASU_OK);
    masu_commands commands;
    char error[ERROR_SIZE];
    masu_frame_desc frame = {MASU_FRAME_DESC};
    assert_int_equal(masu_frame(m, &frame, &commands, &failure),
                     MASU_ERROR_STATE); /* not loaded yet */
    assert_non_null(strstr(failure.text, "masu_load"));
    load_all(&s, m);
    assert_int_equal(masu_frame(m, &frame, &commands, &failure), MASU_OK);
    assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    assert_memory_equal(copy, outer, 64);
    assert_memory_equal(copy + 64 + bytes, block + bytes, room - bytes);
    masu_peak_info peaks;
    masu_peaks(m, &peaks);
    assert_int_equal(peaks.host_bytes, bytes);
    assert_int_equal(peaks.device_bytes, s.need.device_bytes);
    masu_destroy(m);
    free(copy);
    free(outer);
    close_session(&s);
}

static void query_and_use(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    masu_session s;
    d.no_renderer = true;
    open_session(&s, &d);
    uint64_t seed = 7;
    for (uint32_t i = 0; i < 24; i++) {
        uint32_t random = random_word(&seed);
        masu_desc q = s.desc;
        q.frames_in_flight = 1 + (random >> 8) % 3;
        q.rung_count = 1 + (random >> 12) % 4;
        for (uint32_t r = 0; r < q.rung_count; r++) {
            q.rungs[r] = (masu_rung){.scale = 0.25f + 0.25f * (float)((random >> (14 + r)) % 4)};
        }
        q.readback = (random >> 20) % 16;
        q.debug.timestamps = (random >> 25) & 1;
        q.deny.unified_memory = (random >> 26) & 1;
        q.deny.compressed_textures = (random >> 27) & 1;
        q.deny.unorm16 = (random >> 28) & 1;
        masu_memory need;
        masu_renderer *m = NULL;
        assert_int_equal(masu_memory_query(&q, &need, NULL), MASU_OK);
        assert_true(need.transient_lower_bound <= need.transient_aliased);
        assert_true(need.transient_aliased <= need.transient_unaliased);
        void *block = host_block(need.host_bytes);
        assert_int_equal(masu_init(&q, block, need.host_bytes, &m, NULL), MASU_OK);
        masu_peak_info peaks;
        masu_peaks(m, &peaks);
        assert_int_equal(peaks.host_bytes, need.host_bytes);
        assert_int_equal(peaks.device_bytes, need.device_bytes);
        /* The report's host rows fill the block to its last byte; device rows are inside their
         * blocks. */
        masu_memory_row rows[MEMORY_ROWS];
        uint32_t n = memory_rows(m, rows);
        uint64_t end = 0;
        for (uint32_t k = 0; k < n; k++) {
            uint64_t row_end = rows[k].offset + rows[k].bytes;
            if (!strcmp(rows[k].kind, "host")) {
                if (row_end > end) end = row_end;
            } else {
                assert_true(row_end <= need.roles[rows[k].role].bytes);
            }
        }
        assert_int_equal(end, need.host_bytes);
        masu_destroy(m);
        free(block);
    }
    close_session(&s);
}

static void the_query_equals_the_use_for_many_descriptions(void **state) {
    (void)state;
    query_and_use("test_both");
    query_and_use("test_texture_mask");
}

static void budgets_and_limits_are_refused_by_name(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    masu_detail detail;
    masu_memory need;
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    masu_desc q = s.desc;
    q.host_budget = need.host_bytes;
    q.device_budget = need.device_bytes;
    assert_int_equal(masu_memory_query(&q, &need, &detail), MASU_OK); /* exactly enough */
    q.device_budget--;
    assert_int_equal(masu_memory_query(&q, &need, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "device_budget");
    assert_int_equal(detail.needed, detail.given + 1);
    q.device_budget = 0;
    q.host_budget--;
    assert_int_equal(masu_memory_query(&q, &need, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "host_budget");
    q.host_budget = 0;
    q.limits.vertices = masu_scene_data_of(&s.scene)->vertices;
    assert_int_equal(masu_memory_query(&q, &need, &detail), MASU_OK);
    q.limits.vertices--;
    assert_int_equal(masu_memory_query(&q, &need, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "limits.vertices");
    assert_int_equal(detail.needed, masu_scene_data_of(&s.scene)->vertices);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_counter_counts),
        cmocka_unit_test(three_hundred_frames_with_rung_changes_allocate_nothing),
        cmocka_unit_test(three_hundred_frames_with_rung_changes_create_nothing_and_validate),
        cmocka_unit_test(the_block_is_used_to_the_byte),
        cmocka_unit_test(the_query_equals_the_use_for_many_descriptions),
        cmocka_unit_test(budgets_and_limits_are_refused_by_name),
    };
    return cmocka_run_group_tests_name("fixed_memory", tests, NULL, NULL);
}
