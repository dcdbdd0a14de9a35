/* test_load.c: a scene that is loaded in steps while another renders. No step writes more than
 * desc.load_step. Meanwhile the images are bit-identical to those of the rendering scene, and
 * afterwards to those of the new one loaded at once. A third scene uses the blocks that the first
 * has left; pipelines are shared. */
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 96, H = 66, BYTES = W * H * 4, RUNGS = 2, AFTER = 3 };
#define STEP ((uint64_t)MASU_LOAD_STEP_MIN)

static uint8_t picture[BYTES], live[BYTES];

/* Keeps a blob for as long as it is needed. */
static void open_scene(masu_session *x, const char *name) {
    masu_session_desc d = test_desc(name, W, H);
    d.no_renderer = true;
    open_session(x, &d);
}

static masu_desc desc_of(const masu_session *s, const masu_session *x, const masu_desc *more) {
    masu_desc d = *more;
    d.bytes = sizeof d;
    d.vulkan = s->desc.vulkan;
    d.targets = s->desc.targets;
    d.scene = &x->scene;
    d.output = (VkExtent2D){W, H};
    d.rung_count = RUNGS;
    d.rungs[0] = (masu_rung){.scale = 1.0f};
    d.rungs[1] = (masu_rung){.scale = 0.6f, .temporal = MASU_ON};
    return d;
}

static masu_frame_desc frame_of(uint32_t n) {
    return (masu_frame_desc){MASU_FRAME_DESC, .rung = n % RUNGS, .time = 0.05 * n,
                             .time_step = 0.05f};
}

/* A separate renderer of the rendering scene; returns the image of its next frame, the n-th. */
static own_renderer alone;
static void draw_alone(masu_session *s, uint32_t n) {
    char error[ERROR_SIZE];
    masu_commands commands;
    masu_frame_desc frame = frame_of(n);
    assert_int_equal(masu_frame(alone.m, &frame, &commands, NULL), MASU_OK);
    assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
    assert_ok(masu_headless_target_read(&s->host, &alone.target, error, sizeof error));
    memcpy(picture, alone.target.mapped, BYTES);
}

/* A step, if there is one, and a frame in one submit. */
static void submit(masu_session *s, const masu_commands *step, const masu_commands *frame) {
    VkCommandBuffer all[2];
    uint32_t count = 0;
    if (step && step->part_count) all[count++] = step->buffer;
    all[count++] = frame->buffer;
    VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                         .commandBufferCount = count,
                         .pCommandBuffers = all};
    assert_int_equal(vkQueueSubmit(s->host.queue, 1, &info, VK_NULL_HANDLE), VK_SUCCESS);
    assert_int_equal(vkQueueWaitIdle(s->host.queue), VK_SUCCESS);
}

/* The n-th frame of x, in one submit with a step of another renderer, equals the n-th of its scene
 * alone. */
static void draw_next(masu_session *s, own_renderer *x, uint32_t n, const masu_commands *step) {
    char error[ERROR_SIZE];
    masu_commands commands;
    masu_frame_desc frame = frame_of(n);
    draw_alone(s, n);
    assert_int_equal(masu_frame(x->m, &frame, &commands, NULL), MASU_OK);
    submit(s, step, &commands);
    assert_ok(masu_headless_target_read(&s->host, &x->target, error, sizeof error));
    memcpy(live, x->target.mapped, BYTES);
    if (memcmp(live, picture, BYTES) != 0)
        fail_msg("frame %u: error of %u", n, max_difference(live, picture, BYTES));
}

/* masu_init in the given host memory, without a step yet. */
static void begin(masu_session *s, own_renderer *x, const masu_desc *desc, void *block,
                  uint64_t bytes) {
    masu_desc d = *desc;
    masu_detail detail;
    make_target(s, x, W, H, 1);
    d.targets.images = &x->target.image;
    d.targets.views = &x->target.view;
    if (masu_init(&d, block, bytes, &x->m, &detail)) fail_msg("%s", detail.text);
}

static void end(masu_session *s, own_renderer *x) {
    masu_destroy(x->m);
    masu_headless_target_destroy(&s->host, &x->target);
}

static uint64_t host_bytes_of(const masu_desc *d) {
    masu_memory need;
    masu_detail detail;
    if (masu_memory_query(d, &need, &detail)) fail_msg("%s", detail.text);
    return need.host_bytes;
}

/* All steps of x, each in the submit of a frame of `now`, whose next frame is number *n. Returns
 * the number of submitted steps without a byte. */
static uint32_t load_in_steps(masu_session *s, own_renderer *x, own_renderer *now, uint32_t *n) {
    masu_commands step;
    masu_result result;
    uint64_t sum = 0, left = UINT64_MAX;
    uint32_t steps = 0, submitted = 0, built = 0;
    do {
        result = masu_load(x->m, &step, NULL);
        assert_true(result == MASU_OK || result == MASU_INCOMPLETE);
        assert_true(step.load_bytes <= STEP);
        sum += step.load_bytes;
        if (steps) assert_int_equal(step.load_left, left - step.load_bytes);
        left = step.load_left;
        steps++;
        submitted += step.part_count;
        /* acceleration structures; the first layout of persistent images */
        built += step.part_count && !step.load_bytes;
        draw_next(s, now, (*n)++, &step);
    } while (result == MASU_INCOMPLETE);
    assert_int_equal(left, 0);
    assert_true(steps > 1 && steps >= sum / STEP);
    printf("  %llu bytes in %u steps, %u submitted, %u without any\n",
           (unsigned long long)sum, steps, submitted, built);
    return built;
}

/* Three scenes one after the other in two blocks, with a frame per step. */
static void change_scenes(masu_session *device, const char *const names[3], const masu_desc *more) {
    masu_session scenes[3];
    masu_desc all[3];
    own_renderer x[3];
    static masu_pipelines pool;
    masu_pipelines_info info;
    uint64_t bytes = 0;
    memset(&pool, 0, sizeof pool);
    for (uint32_t i = 0; i < 3; i++) open_scene(&scenes[i], names[i]);
    for (uint32_t i = 0; i < 3; i++) {
        all[i] = desc_of(device, &scenes[i], more);
        all[i].vulkan.pipelines = &pool;
        all[i].load_step = STEP;
        uint64_t own = host_bytes_of(&all[i]);
        if (bytes < own) bytes = own;
    }
    void *blocks[2] = {host_block(bytes), host_block(bytes)};
    begin(device, &x[0], &all[0], blocks[0], bytes);
    load_all(device, x[0].m);
    for (uint32_t i = 0; i < 3; i++) {
        masu_desc at_once = all[i];
        at_once.load_step = 0;
        at_once.vulkan.pipelines = NULL;
        make_own(device, &alone, &at_once);
        uint32_t n = 0;
        while (n < AFTER) draw_next(device, &x[i], n++, NULL);
        if (i) end(device, &x[i - 1]); /* its block is free for the next */
        draw_next(device, &x[i], n++, NULL);
        if (i == 2) break;
        masu_pipelines_info before, now;
        masu_pipelines_info_of(&pool, &before);
        begin(device, &x[i + 1], &all[i + 1], blocks[(i + 1) % 2], bytes);
        masu_pipelines_info_of(&pool, &now);
        printf("  %s after %s: %u pipelines created, %u reused\n", names[i + 1], names[i],
               now.created - before.created, now.reused - before.reused);
        draw_next(device, &x[i], n++, NULL);
        uint32_t built = load_in_steps(device, &x[i + 1], &x[i], &n);
        if (more->ray_query == MASU_ON && !i) assert_true(built > 1);
        unmake_own(device, &alone);
    }
    unmake_own(device, &alone);
    masu_pipelines_info_of(&pool, &info);
    assert_true(info.reused > 15 && info.used > 0);
    end(device, &x[2]);
    free(blocks[0]);
    free(blocks[1]);
    masu_pipelines_info_of(&pool, &info);
    assert_int_equal(info.used, 0);
    masu_pipelines_destroy(&device->desc.vulkan, &pool);
    for (uint32_t i = 0; i < 3; i++) close_session(&scenes[i]);
}

static const char *const names[3] = {"test_live", "test_live_moved", "test_both"};

static void change_on_device(const masu_desc *more) {
    masu_session device;
    masu_session_desc d = test_desc(NULL, 8, 8);
    d.no_renderer = true;
    d.host.ray_query = more->ray_query == MASU_ON;
    open_session(&device, &d);
    if (!d.host.ray_query || device.host.ray_query) change_scenes(&device, names, more);
    close_session(&device);
}

static void in_memory_that_the_host_writes(void **state) {
    (void)state;
    masu_desc more = {0};
    change_on_device(&more);
}

static void through_a_staging_buffer(void **state) {
    (void)state;
    masu_desc more = {.deny.unified_memory = 1};
    change_on_device(&more);
}

/* Acceleration structures are built in steps, too. */
static void with_ray_queries(void **state) {
    (void)state;
    masu_desc more = {.ray_query = MASU_ON};
    change_on_device(&more);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_memory_that_the_host_writes),
        cmocka_unit_test(through_a_staging_buffer),
        cmocka_unit_test(with_ray_queries),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
