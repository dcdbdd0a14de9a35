/* test_pool.c: pipelines that outlive their renderer. Another scene, another size, and the first
 * again create only pipelines that no renderer before had; images are bit-identical; whatever
 * fails, none is lost, destroyed twice or leaked. */
#include "device/pool.h"
#include "support/support.h"
#include "support/wrap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 88, H = 72, BYTES = W * H * 4 };

static masu_pipelines pool;

static masu_pipelines_info told(void) {
    masu_pipelines_info info;
    masu_pipelines_info_of(&pool, &info);
    return info;
}
static uint8_t pixels[2][BYTES];

static masu_session_desc desc_of(const char *scene, uint32_t width, uint32_t height, int pooled) {
    masu_session_desc d = test_desc(scene, width, height);
    d.desc.rung_count = 2;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.rungs[1] = (masu_rung){.scale = 0.5f, .aa = MASU_AA_SMAA_LOW};
    d.desc.vulkan.pipelines = pooled ? &pool : NULL;
    return d;
}

/* With the device of an open session without a renderer. */
static void draw_scene(masu_session *s, const char *scene, uint32_t w, uint32_t h, int pooled,
                       uint8_t *out) {
    masu_session_desc d = desc_of(scene, w, h, pooled);
    masu_session other;
    d.no_renderer = true;
    (void)s;
    open_session(&other, &d);
    masu_desc desc = s->desc;
    desc.scene = &other.scene;
    desc.output = (VkExtent2D){w, h};
    desc.vulkan.pipelines = pooled ? &pool : NULL;
    uint8_t *rungs[] = {out, out};
    draw_rungs_of(s, &desc, rungs, NULL);
    close_session(&other);
}

static void what_is_known_is_not_made_again(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_live", W, H, 0);
    d.no_renderer = true;
    memset(&pool, 0, sizeof pool);
    open_session(&s, &d);
    static const char *const scenes[] = {"test_live", "test_live_moved", "test_live",
                                         "test_both", "test_live_moved", "test_reserve"};
    const uint32_t sizes[][2] = {{W, H}, {W, H}, {80, 56}, {W, H}, {W, H}, {W, H}};
    for (uint32_t i = 0; i < 6; i++) {
        masu_pipelines_info before = told();
        uint32_t w = sizes[i][0], h = sizes[i][1];
        draw_scene(&s, scenes[i], w, h, 0, pixels[0]);
        draw_scene(&s, scenes[i], w, h, 1, pixels[1]);
        assert_memory_equal(pixels[0], pixels[1], (size_t)w * h * 4);
        printf("  %s: %u pipelines created, %u reused\n", scenes[i],
               told().created - before.created, told().reused - before.reused);
        uint32_t made = told().created - before.created;
        if (i == 0) assert_int_equal(told().reused, 0);
        if (i == 1 || i == 2 || i == 4) assert_int_equal(made, 0); /* all pipelines exist */
        if (i == 5) assert_true(made <= 7); /* for its other features; shared pipelines exist */
    }
    assert_int_equal(told().count, told().created);
    masu_pipelines_destroy(&s.desc.vulkan, &pool);
    assert_int_equal(told().count, 0);
    masu_pipelines_destroy(&s.desc.vulkan, NULL);
    masu_pipelines_destroy(NULL, &pool);
    close_session(&s);
}

/* A session of test_both without a renderer, with counted objects and the pool. Returns the number
 * of live objects. */
static int64_t open_counted(masu_session *s) {
    masu_session_desc d = desc_of("test_both", W, H, 1);
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.no_renderer = true;
    open_session(s, &d);
    s->desc.scene = &s->scene;
    s->desc.vulkan.pipelines = &pool;
    return wrap.live;
}

/* A full pool evicts the unused pipeline that has been unused for the longest time. If all are in
 * use, nothing is added. */
static void a_full_pool_makes_room(void **state) {
    (void)state;
    enum { USED = 10 };
    masu_session s;
    masu_memory need;
    masu_renderer *m;
    masu_detail detail;
    int64_t live = open_counted(&s);
    s.desc.rung_count = 1;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_OK);
    void *block = host_block(need.host_bytes);
    for (uint32_t all_used = 0; all_used < 2; all_used++) {
        memset(&pool, 0, sizeof pool);
        masu_pool *in = (masu_pool *)(void *)&pool;
        in->info.count = MASU_MAX_PIPELINES;
        in->clock = MASU_MAX_PIPELINES;
        for (uint32_t i = 0; i < MASU_MAX_PIPELINES;
             i++) /* of no pipeline, so it can be destroyed */
            in->rows[i] = (masu_pool_row){
                .key = 1 + i, .users = i < USED || all_used, .used = MASU_MAX_PIPELINES - i};
        for (uint32_t again = 0; again < 2; again++) {
            if (masu_init(&s.desc, block, need.host_bytes, &m, &detail))
                fail_msg("%s", detail.text);
            masu_destroy(m);
        }
        uint32_t made = told().created / (all_used ? 2 : 1);
        assert_true(made > 3);
        assert_int_equal(told().reused, all_used ? 0 : made);
        assert_int_equal(told().evicted, all_used ? 0 : made);
        assert_int_equal(told().count, MASU_MAX_PIPELINES);
        assert_int_equal(told().used, all_used ? MASU_MAX_PIPELINES : USED);
        for (uint32_t i = 0; i < MASU_MAX_PIPELINES; i++)
            assert_int_equal(in->rows[i].key <= MASU_MAX_PIPELINES,
                             all_used || i < MASU_MAX_PIPELINES - made);
        assert_int_equal(wrap.live - live, (all_used ? 0 : made) + 2);
        masu_pipelines_destroy(&s.desc.vulkan, &pool);
        assert_int_equal(wrap.live, live);
    }
    free(block);
    close_session(&s);
}

/* Every call of masu_init fails once: taken pipelines are returned, and only the pool's objects
 * live. */
static void failures_lose_nothing(void **state) {
    (void)state;
    masu_session s;
    masu_memory need;
    masu_renderer *m;
    masu_detail detail;
    memset(&pool, 0, sizeof pool);
    int64_t live = open_counted(&s);
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_OK);
    void *block = host_block(need.host_bytes);
    assert_int_equal(masu_init(&s.desc, block, need.host_bytes, &m, &detail), MASU_OK);
    masu_destroy(m);
    uint32_t all = told().count;
    assert_true(all > 8);
    int64_t pooled = wrap.live - live; /* pipelines, and two samplers */
    assert_int_equal(pooled, all + 2);
    uint64_t from = wrap.setup_calls;
    assert_int_equal(masu_init(&s.desc, block, need.host_bytes, &m, &detail), MASU_OK);
    uint64_t calls = wrap.setup_calls - from;
    masu_destroy(m);
    for (uint64_t k = 1; k <= calls; k += 7) {
        wrap.fail_at = wrap.setup_calls + k;
        wrap.fail_with = VK_ERROR_OUT_OF_HOST_MEMORY;
        assert_int_not_equal(masu_init(&s.desc, block, need.host_bytes, &m, &detail), MASU_OK);
        wrap.fail_at = 0;
        assert_int_equal(told().count, all);
        assert_int_equal(wrap.live - live, pooled);
    }
    printf("  %u pipelines, %llu calls of masu_init without making any\n", all,
           (unsigned long long)calls);
    masu_pipelines_destroy(&s.desc.vulkan, &pool);
    assert_int_equal(wrap.live, live);
    free(block);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_known_is_not_made_again),
        cmocka_unit_test(a_full_pool_makes_room),
        cmocka_unit_test(failures_lose_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
