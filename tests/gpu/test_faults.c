/* test_faults.c: the whole life of a renderer with one failing call: query, init, load, frames,
 * run-time changes, resize, another scene with the pipelines of the first. For any Vulkan call and
 * any failure, the stage names it, later stages return errors, no object is leaked, and the next
 * life is good. Also: a device lost between any two frames; blocks and budgets a byte short.
 *
 * A call that can fail is one that returns a VkResult. After masu_init the library makes none
 * except in masu_resize, which this test checks too. */
#include "support/files.h"
#include "support/support.h"
#include "support/wrap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 44, H = 36, BYTES = W * H * 4, FRAMES = 3 };

typedef enum stage { QUERY, INIT, LOAD, DRAW, LIVE, SIZE, SCENE, DRAW_AGAIN, STAGES } stage;
static const char *const stage_names[] = {"query", "init",   "load",  "frames",
                                          "live",  "resize", "scene", "its frames"};

static masu_session s, other; /* each with its own device; other: for its scene */
static masu_headless_target target;
static void *block;
static size_t block_bytes;
static uint64_t calls_of[STAGES];
static uint8_t pixels[BYTES];

static masu_desc desc_of(const masu_scene *scene, masu_pipelines *pool) {
    masu_desc d = s.desc;
    d.scene = scene;
    d.vulkan.pipelines = pool;
    d.output = (VkExtent2D){W, H};
    d.targets.images = &target.image;
    d.targets.views = &target.view;
    d.targets.count = 1;
    d.resizable = 1;
    d.mutable_materials = masu_scene_count(scene, MASU_SCENE_MATERIAL) > 0;
    d.rung_count = 2;
    d.rungs[0] = (masu_rung){.scale = 0.8f, .aa = MASU_AA_SMAA_LOW};
    d.rungs[1] = (masu_rung){.scale = 0.7f, .temporal = MASU_ON};
    return d;
}

static int open_all(void **state) {
    char error[ERROR_SIZE];
    masu_session_desc d = test_desc("test_live", W, H), e = test_desc("test_velocity", W, H);
    (void)state;
    wrap_reset();
    d.no_renderer = e.no_renderer = true;
    d.host.validate = false; /* to save time: other tests run lives without a fault under the
                                layer */
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    open_session(&s, &d);
    open_session(&other, &e);
    assert_ok(masu_headless_target_create(&s.host, W, H, VK_FORMAT_R8G8B8A8_UNORM, 1, &target,
                                          error, sizeof error));
    const masu_scene *scenes[] = {&s.scene, &other.scene};
    for (int i = 0; i < 2; i++) {
        masu_memory need;
        masu_detail detail;
        static masu_pipelines pool; /* the slots for shared pipelines need host memory, too */
        masu_desc own = desc_of(scenes[i], &pool);
        if (masu_memory_query(&own, &need, &detail)) fail_msg("%s", detail.text);
        block_bytes = need.host_bytes > block_bytes ? need.host_bytes : block_bytes;
    }
    block = host_block(block_bytes);
    return 0;
}

static int close_all(void **state) {
    (void)state;
    free(block);
    masu_headless_target_destroy(&s.host, &target);
    close_session(&other);
    close_session(&s);
    return 0;
}

static masu_result load(masu_renderer *m) {
    char error[ERROR_SIZE];
    masu_commands commands;
    masu_result r;
    while ((r = masu_load(m, &commands, NULL)) == MASU_INCOMPLETE)
        assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    return r;
}

static masu_result frames(masu_renderer *m, uint32_t first, uint32_t count, bool submitted) {
    char error[ERROR_SIZE];
    masu_commands commands;
    for (uint32_t i = first; i < first + count; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .rung = i % 2, .time = 0.1 * i, .time_step = 0.1f,
                                 .cut = i == 0};
        masu_result r = masu_frame(m, &frame, &commands, NULL);
        if (r) return r;
        if (submitted) assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    }
    if (!submitted) return MASU_OK;
    assert_ok(masu_headless_target_read(&s.host, &target, error, sizeof error));
    memcpy(pixels, target.mapped, BYTES);
    return MASU_OK;
}

static masu_result live(masu_renderer *m) {
    masu_material_state state;
    masu_material material = masu_material_at(m, 0);
    const float rows[12] = {1, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1, 0};
    masu_result r = masu_material_get(m, material, &state, NULL);
    state.roughness = 0.4f;
    if (!r) r = masu_material_set(m, material, &state, NULL);
    if (!r) r = masu_model_show(m, masu_model_find(m, "truck"), 0, NULL);
    if (!r) r = masu_model_set_transform(m, masu_model_find(m, "pane"), rows, NULL);
    return r;
}

/* The result of a stage; *at: the stage 0 .. STAGES - 1 that ended the life, STAGES: none. */
static masu_result life(stage *at, masu_detail *detail) {
    masu_pipelines *pool = calloc(1, sizeof *pool);
    masu_desc first = desc_of(&s.scene, pool), second = desc_of(&other.scene, pool);
    const masu_targets targets = {
        .images = &target.image, .views = &target.view, .count = 1, .storage = 1};
    masu_memory need;
    masu_renderer *m = NULL;
    masu_result r = MASU_OK;
    memset(detail, 0, sizeof *detail);
    for (*at = QUERY; *at < STAGES && !r; (*at)++) {
        uint64_t before = wrap.setup_calls;
        switch (*at) {
        case QUERY: r = masu_memory_query(&first, &need, detail); break;
        case INIT: r = masu_init(&first, block, block_bytes, &m, detail); break;
        case LOAD: r = load(m); break;
        case DRAW: r = frames(m, 0, FRAMES, true); break;
        case LIVE: r = live(m); break;
        case SIZE:
            r = masu_resize(m, (VkExtent2D){W - 5, H - 3}, &targets, NULL, detail);
            if (!r) r = masu_resize(m, (VkExtent2D){W, H}, &targets, NULL, detail);
            break;
        case SCENE:
            masu_destroy(m);
            m = NULL;
            r = masu_init(&second, block, block_bytes, &m, detail);
            if (!r) r = load(m);
            break;
        default: r = frames(m, 0, FRAMES, true); break;
        }
        calls_of[*at] = wrap.setup_calls - before;
        if (r) break;
    }
    if (r && *at == SIZE) { /* without a device only masu_destroy is possible */
        masu_commands commands;
        masu_result next = masu_frame(m, &(masu_frame_desc){MASU_FRAME_DESC}, &commands, NULL);
        assert_true(r == MASU_ERROR_DEVICE_LOST ? next != MASU_OK : next == MASU_OK || next == r);
    }
    if (r && (*at == INIT || *at == SCENE)) assert_null(m);
    masu_destroy(m);
    masu_pipelines_destroy(&s.desc.vulkan, pool);
    free(pool);
    return r;
}

static uint64_t good_life(void) {
    masu_detail detail;
    stage at;
    wrap_reset();
    masu_result r = life(&at, &detail);
    if (r) fail_msg("%s: %s", stage_names[at], detail.text);
    assert_int_equal(wrap.live, 0);
    return wrap.setup_calls;
}

static void any_call_of_a_life_may_fail(void **state) {
    (void)state;
    static const struct {
        VkResult with;
        bool persistent;
    } ways[] = {{VK_ERROR_OUT_OF_DEVICE_MEMORY, false}, {VK_ERROR_OUT_OF_HOST_MEMORY, true},
                {VK_ERROR_DEVICE_LOST, true},           {VK_ERROR_INITIALIZATION_FAILED, false}};
    uint64_t calls = good_life(), points = 0, of[STAGES] = {0};
    static uint8_t good[BYTES];
    memcpy(good, pixels, BYTES);
    printf("  calls that can fail:");
    for (int i = 0; i < STAGES; i++)
        printf(" %s %llu%s", stage_names[i], (unsigned long long)calls_of[i],
               i < STAGES - 1 ? "," : "\n");
    /* After masu_init no object is created: no call can fail. */
    assert_true(calls_of[LOAD] == 0 && calls_of[DRAW] == 0 && calls_of[LIVE] == 0);
    assert_true(calls_of[DRAW_AGAIN] == 0 && calls_of[SIZE] > 5 && calls_of[INIT] > 100);
    uint64_t step = trials(1, 9, 31);
    /* Resizes have few calls: each is tested. */
    uint64_t size_from = calls_of[QUERY] + calls_of[INIT], size_to = size_from + calls_of[SIZE];
    for (size_t w = 0; w < sizeof ways / sizeof *ways; w++) {
        for (uint64_t k = 1 + w, next; k <= calls; k = next) {
            next = k + (k >= size_from && k < size_to ? 1 : step);
            if (k < size_from && next > size_from) next = size_from;
            masu_detail detail;
            stage at;
            wrap_reset();
            wrap.fail_at = k;
            wrap.fail_with = ways[w].with;
            wrap.persistent = ways[w].persistent;
            masu_result r = life(&at, &detail);
            masu_result wanted =
                ways[w].with == VK_ERROR_DEVICE_LOST ? MASU_ERROR_DEVICE_LOST : MASU_ERROR_VULKAN;
            if (r != wanted || detail.result != r || detail.vulkan != ways[w].with ||
                strcmp(detail.what, wrap.failed_call))
                fail_msg("call %llu, %s, in %s: %d, '%s'", (unsigned long long)k, wrap.failed_call,
                         at < STAGES ? stage_names[at] : "nothing", r, detail.text);
            if (wrap.live || wrap.calls_after_loss)
                fail_msg("call %llu, %s: %lld objects are left, %llu calls after the loss",
                         (unsigned long long)k, wrap.failed_call, (long long)wrap.live,
                         (unsigned long long)wrap.calls_after_loss);
            points++;
            of[at]++;
        }
        good_life();
        assert_memory_equal(pixels, good, BYTES);
    }
    printf("  %llu lives with a fault:", (unsigned long long)points);
    for (int i = 0; i < STAGES; i++)
        if (of[i]) printf(" %s %llu", stage_names[i], (unsigned long long)of[i]);
    printf("\n");
    assert_true(of[QUERY] > 0 || !calls_of[QUERY]);
    assert_true(of[INIT] > 5 && of[SIZE] > 5 && of[SCENE] > 5);
}

/* A submit returns VK_ERROR_DEVICE_LOST to the host, which destroys the renderer and creates a new
 * one. The image equals that of a renderer without a loss. */
static void a_device_lost_before_any_frame_leaves_a_good_renderer(void **state) {
    (void)state;
    static uint8_t good[BYTES];
    masu_detail detail;
    masu_renderer *m;
    masu_desc d = desc_of(&s.scene, NULL);
    wrap_reset();
    for (uint32_t lost_at = 0; lost_at <= 2 * FRAMES; lost_at++) {
        assert_int_equal(masu_init(&d, block, block_bytes, &m, &detail), MASU_OK);
        if (lost_at != 1) assert_int_equal(load(m), MASU_OK); /* 1: lost during the load */
        if (lost_at != 1) assert_int_equal(frames(m, 0, lost_at, false), MASU_OK);
        masu_destroy(m);
        assert_int_equal(wrap.live, 0);
        assert_int_equal(masu_init(&d, block, block_bytes, &m, &detail), MASU_OK);
        assert_int_equal(load(m), MASU_OK);
        assert_int_equal(frames(m, 0, FRAMES, true), MASU_OK);
        masu_destroy(m);
        if (!lost_at) memcpy(good, pixels, BYTES);
        assert_memory_equal(pixels, good, BYTES);
    }
    assert_int_equal(wrap.live, 0);
}

static void a_byte_less_is_refused_at_each_stage(void **state) {
    (void)state;
    masu_detail detail;
    masu_memory need, again;
    masu_renderer *m = NULL;
    masu_desc d = desc_of(&s.scene, NULL);
    wrap_reset();
    assert_int_equal(masu_memory_query(&d, &need, &detail), MASU_OK);
    enum { GUARD = 64 };
    unsigned char *guarded = host_block(need.host_bytes + 2 * GUARD);
    const uint64_t short_by[] = {
        1, 8, 64, need.host_bytes / 2, need.host_bytes - 1, need.host_bytes};
    for (size_t i = 0; i < sizeof short_by / sizeof *short_by; i++) {
        memset(guarded, 0xC5, need.host_bytes + 2 * GUARD);
        m = (masu_renderer *)block;
        uint64_t bytes = need.host_bytes - short_by[i];
        assert_int_equal(masu_init(&d, guarded + GUARD, bytes, &m, &detail), MASU_ERROR_MEMORY);
        assert_null(m);
        for (uint64_t k = 0; k < GUARD; k++) assert_int_equal(guarded[k], 0xC5);
        for (uint64_t k = GUARD + bytes; k < need.host_bytes + 2 * GUARD; k++)
            assert_int_equal(guarded[k], 0xC5);
    }
    memset(guarded, 0xC5, need.host_bytes + 2 * GUARD);
    assert_int_equal(masu_init(&d, guarded + GUARD, need.host_bytes, &m, &detail), MASU_OK);
    assert_int_equal(load(m), MASU_OK);
    assert_int_equal(frames(m, 0, FRAMES, true), MASU_OK);
    masu_destroy(m);
    for (uint64_t k = 0; k < GUARD; k++) {
        assert_int_equal(guarded[k], 0xC5);
        assert_int_equal(guarded[GUARD + need.host_bytes + k], 0xC5);
    }
    assert_int_equal(masu_init(&d, guarded + 1, need.host_bytes + 1, &m, &detail),
                     MASU_ERROR_MEMORY);
    assert_int_equal(masu_init(&d, NULL, need.host_bytes, &m, &detail), MASU_ERROR_MEMORY);
    uint64_t *budgets[] = {&d.host_budget, &d.device_budget};
    const uint64_t needs[] = {need.host_bytes, need.device_bytes};
    for (int i = 0; i < 2; i++) {
        *budgets[i] = needs[i] - 1;
        assert_int_equal(masu_memory_query(&d, &again, &detail), MASU_ERROR_LIMIT);
        assert_int_equal(masu_init(&d, guarded + GUARD, need.host_bytes, &m, &detail),
                         MASU_ERROR_LIMIT);
        *budgets[i] = needs[i];
        assert_int_equal(masu_memory_query(&d, &again, &detail), MASU_OK);
        *budgets[i] = 0;
    }
    assert_int_equal(wrap.live, 0);
    free(guarded);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_call_of_a_life_may_fail),
        cmocka_unit_test(a_device_lost_before_any_frame_leaves_a_good_renderer),
        cmocka_unit_test(a_byte_less_is_refused_at_each_stage),
    };
    return cmocka_run_group_tests_name("faults", tests, open_all, close_all);
}
