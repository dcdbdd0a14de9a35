/* test_ladder.c: renderers with the measured ladder of their scene class: each rung renders as it
 * would if the host had given it; memory is planned once for all; and no object is created after
 * masu_init. The test supplies the times, so that every driver decides alike. */
#include "support/support.h"
#include "support/wrap.h"

#include "alloc_count.h"

#include <stdlib.h>
#include <string.h>

enum { W = 66, H = 48, BYTES = W * H * 4 };

/* Polygons and an SDF; shadows; traced reflections of both. */
static const char *const scenes[] = {"test_both", "test_shadows", "test_reflections"};
enum { SCENES = sizeof scenes / sizeof *scenes };

static masu_session_desc ladder_desc(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.governor.mode = MASU_GOVERNOR_ON; /* which enables the ladder */
    d.desc.governor.wall_only = 1;
    return d;
}

/* The rungs that the session's renderer uses if none are given. */
static uint32_t rungs_of(const masu_session *s, masu_plan_info *plan) {
    masu_desc ladder = {MASU_DESC};
    assert_int_equal(masu_ladder_of(&s->scene, &ladder, NULL, NULL), MASU_OK);
    masu_plan_of(s->m, plan);
    assert_int_equal(plan->rung_count, ladder.rung_count);
    for (uint32_t r = 0; r < plan->rung_count; r++) {
        assert_true(plan->rungs[r].ratio == ladder.governor.costs[r]);
        assert_true(plan->rungs[r].flip == ladder.flips[r]);
        assert_true(
            abs((int)(W * ladder.rungs[r].scale + 0.5f) - (int)plan->rungs[r].render_width) <= 1);
    }
    return plan->rung_count;
}

/* A frame that takes `load` ms at cost 1. */
static uint32_t step(masu_session *s, const masu_plan_info *plan, uint32_t rung, uint32_t i,
                     double load, uint64_t *heap) {
    masu_frame_desc f = {MASU_FRAME_DESC, .rung = rung, .time = 0.01 * i};
    masu_commands c;
    char error[ERROR_SIZE];
    uint64_t before = masu_allocs_of_thread();
    assert_int_equal(masu_frame(s->m, &f, &c, NULL), MASU_OK);
    *heap += masu_allocs_of_thread() - before;
    assert_ok(masu_headless_submit(&s->host, c.buffer, c.slot, error, sizeof error));
    assert_ok(masu_headless_wait(&s->host, c.slot, error, sizeof error));
    masu_frame_wall(s->m, c.slot,
                    load * (double)plan->rungs[c.rung].ratio * (1.0 + 0.001 * (i % 3)));
    return c.rung;
}

static void go_through(const char *scene, bool validate) {
    masu_session_desc d = ladder_desc(scene);
    masu_session s;
    masu_plan_info plan;
    uint64_t heap = 0;
    uint32_t drawn = 0, i = 0, rung = 99;
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.host.validate = validate;
    open_session(&s, &d);
    uint32_t count = rungs_of(&s, &plan);
    uint64_t setup = wrap.setup_calls;
    int64_t live = wrap.live;
    for (uint32_t k = 0; k < 30; k++) /* everything fits */
        rung = step(&s, &plan, MASU_RUNG_AUTO, i++, 8.0 / (double)plan.rungs[0].ratio, &heap);
    assert_int_equal(rung, 0);
    for (uint32_t r = 1; r < count; r++) { /* the rung before is just too slow, this one fits */
        double load = 1.02 * 16.67 / (double)plan.rungs[r - 1].ratio;
        for (uint32_t k = 0; k < 12; k++)
            drawn |= 1u << step(&s, &plan, MASU_RUNG_AUTO, i++, load, &heap);
    }
    for (uint32_t k = 0; k < 30; k++) /* nothing fits */
        rung = step(&s, &plan, MASU_RUNG_AUTO, i++, 100.0 / (double)plan.rungs[count - 1].ratio,
                    &heap);
    /* Rungs that save less than 5 % are not worth their loss. */
    assert_true(plan.rungs[rung].ratio <= 1.06f * plan.rungs[count - 1].ratio);
    if (count > 2) assert_true(rung >= count - 2);
    uint32_t by_itself = 0;
    for (uint32_t r = 0; r < count; r++) by_itself += drawn >> r & 1;
    assert_true(by_itself >= 2);
    for (uint32_t r = 0; r < 2 * count; r++)
        assert_int_equal(step(&s, &plan, r % count, i++, 16.0, &heap), r % count);
    assert_int_equal(wrap.setup_calls, setup);
    assert_int_equal(wrap.live, live);
    if (masu_alloc_counting() && !validate) assert_int_equal(heap, 0);
    print_message("%s: %u of %u rungs by the governor\n", scene, by_itself, count);
    close_session(&s);
    assert_int_equal(wrap.live, 0);
}

static void every_rung_is_drawn_and_nothing_is_made(void **state) {
    (void)state;
    for (uint32_t i = 0; i < SCENES; i++) go_through(scenes[i], i % 2);
}

/* Frames with the same numbers, each after a cut, so that other rungs have no influence. */
static void draw_all(masu_session *s, uint32_t count, uint8_t *pixels) {
    for (uint32_t r = 0; r < count; r++) {
        masu_frame_desc f = {MASU_FRAME_DESC, .rung = r, .time = 0.5, .cut = 1};
        masu_commands c;
        draw(s, &f, &c, pixels + r * BYTES);
    }
}

static void a_rung_is_the_picture_of_that_rung_given_by_hand(void **state) {
    (void)state;
    static uint8_t baked[MASU_MAX_RUNGS * BYTES], given[MASU_MAX_RUNGS * BYTES];
    for (uint32_t i = 0; i < SCENES; i++) {
        masu_session_desc d = ladder_desc(scenes[i]);
        masu_session s;
        masu_plan_info plan;
        open_session(&s, &d);
        uint32_t count = rungs_of(&s, &plan);
        masu_desc own = {MASU_DESC};
        assert_int_equal(masu_ladder_of(&s.scene, &own, NULL, NULL), MASU_OK);
        draw_all(&s, count, baked);
        close_session(&s);
        d = test_desc(scenes[i], W, H);
        d.desc.rung_count = count;
        memcpy(d.desc.rungs, own.rungs, sizeof own.rungs);
        open_session(&s, &d);
        draw_all(&s, count, given);
        close_session(&s);
        assert_int_equal(max_difference(baked, given, count * BYTES), 0);
        /* The best and the cheapest give different images, and neither is empty. */
        uint8_t *last = baked + (count - 1) * BYTES;
        assert_true(count > 1 && max_difference(baked, last, BYTES) > 8);
        /* And as the only rung, which shares with no other. */
        for (uint32_t r = 0; r < count && !i; r += count - 1) {
            d.desc.rung_count = 1;
            d.desc.rungs[0] = own.rungs[r];
            open_session(&s, &d);
            /* Temporal jitter depends on the frame's number. */
            for (uint32_t k = 0; k <= r; k++) draw_all(&s, 1, given);
            close_session(&s);
            assert_int_equal(max_difference(baked + r * BYTES, given, BYTES), 0);
        }
    }
}

/* Eight equal rungs need the memory of one; different ones that of the largest. */
static void memory_is_planned_once_for_all_rungs(void **state) {
    (void)state;
    for (uint32_t i = 0; i + 1 < SCENES; i++) {
        masu_session_desc d = ladder_desc(scenes[i]);
        masu_session s;
        masu_memory need, one, eight;
        masu_desc own = {MASU_DESC};
        d.no_renderer = true;
        open_session(&s, &d);
        assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
        void *block = host_block(need.host_bytes);
        masu_renderer *m = NULL;
        masu_peak_info peaks;
        assert_int_equal(masu_init(&s.desc, block, need.host_bytes, &m, NULL), MASU_OK);
        masu_peaks(m, &peaks);
        assert_int_equal(peaks.host_bytes, need.host_bytes);
        assert_int_equal(peaks.device_bytes, need.device_bytes);
        masu_destroy(m);
        free(block);
        assert_int_equal(masu_ladder_of(&s.scene, &own, NULL, NULL), MASU_OK);
        masu_desc q = s.desc;
        uint64_t most = 0;
        for (uint32_t r = 0; r < own.rung_count; r++) {
            q.rung_count = 1;
            q.rungs[0] = own.rungs[r];
            assert_int_equal(masu_memory_query(&q, &one, NULL), MASU_OK);
            q.rung_count = MASU_MAX_RUNGS;
            for (uint32_t k = 1; k < MASU_MAX_RUNGS; k++) q.rungs[k] = own.rungs[r];
            assert_int_equal(masu_memory_query(&q, &eight, NULL), MASU_OK);
            assert_int_equal(eight.device_bytes, one.device_bytes);
            assert_int_equal(eight.transient_aliased, one.transient_aliased);
            if (one.transient_lower_bound > most) most = one.transient_lower_bound;
        }
        /* At least the memory of the largest rung, and far less than the sum. */
        assert_true(need.transient_lower_bound >= most);
        assert_true(need.transient_aliased <= need.transient_unaliased);
        close_session(&s);
    }
}

/* ---- The costs of rungs on GPUs of a class --------------------------------------------------- */

static PFN_vkGetInstanceProcAddr real_proc;
static VkPhysicalDeviceProperties pretended;

static VKAPI_ATTR void VKAPI_CALL pretend(VkPhysicalDevice physical,
                                          VkPhysicalDeviceProperties *out) {
    vkGetPhysicalDeviceProperties(physical, out);
    out->vendorID = pretended.vendorID, out->deviceID = pretended.deviceID,
    out->deviceType = pretended.deviceType;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL pretending_proc(VkInstance instance,
                                                                const char *name) {
    if (!strcmp(name, "vkGetPhysicalDeviceProperties")) return (PFN_vkVoidFunction)pretend;
    return real_proc(instance, name);
}

static void a_gpu_of_a_class_begins_with_what_was_computed_for_it(void **state) {
    (void)state;
    static const struct {
        uint32_t vendor, device;
        VkPhysicalDeviceType type;
        const char *name;
    } devices[] = {{0x1002, 0x163F, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, "Deck"},
                   {0x8086, 0x5917, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, "UHD620"},
                   {0x10DE, 0x1C03, VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, ""},
                   {0x1002, 0x163F, VK_PHYSICAL_DEVICE_TYPE_CPU, ""}};
    masu_session_desc d = ladder_desc("test_both");
    masu_session s;
    masu_desc own = {MASU_DESC};
    static masu_plan_info plan;
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_ladder_of(&s.scene, &own, NULL, NULL), MASU_OK);
    real_proc = s.desc.vulkan.get_instance_proc_addr;
    s.desc.vulkan.get_instance_proc_addr = pretending_proc;
    s.desc.governor.costs[2] = 0.123f; /* a value from the host is kept */
    for (size_t i = 0; i < sizeof devices / sizeof *devices; i++) {
        pretended.vendorID = devices[i].vendor, pretended.deviceID = devices[i].device;
        pretended.deviceType = devices[i].type;
        assert_int_equal(masu_plan(&s.desc, &plan, NULL), MASU_OK);
        assert_string_equal(plan.computed_for, devices[i].name);
        assert_int_equal(plan.rung_count, own.rung_count);
        assert_true(plan.rungs[2].ratio == 0.123f);
        uint32_t last = plan.rung_count - 1;
        assert_true((plan.rungs[last].ratio == own.governor.costs[last]) == !*devices[i].name);
        /* Rungs of the host's own have only the costs scale^2. */
        masu_desc given = s.desc;
        given.rung_count = own.rung_count;
        memcpy(given.rungs, own.rungs, sizeof given.rungs);
        assert_int_equal(masu_plan(&given, &plan, NULL), MASU_OK);
        assert_string_equal(plan.computed_for, "");
        assert_true(plan.rungs[last].ratio == 0.0f);
    }
    s.desc.vulkan.get_instance_proc_addr = real_proc;
    close_session(&s);
}

/* easu_twice exceeds the registers of GPUs of Arm and Broadcom. */
static void twice_the_size_takes_the_pass_that_fits_the_vendor(void **state) {
    (void)state;
    static const struct {
        uint32_t vendor, twice;
    } vendors[] = {{0x1002, 1}, {0x8086, 1}, {0x5143, 1}, {0x10005, 1}, {0x13B5, 0}, {0x14E4, 0}};
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    static masu_plan_info plan;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 0.5f};
    d.no_renderer = true;
    open_session(&s, &d);
    real_proc = s.desc.vulkan.get_instance_proc_addr;
    s.desc.vulkan.get_instance_proc_addr = pretending_proc;
    pretended.deviceType = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    for (size_t i = 0; i < sizeof vendors / sizeof *vendors; i++) {
        uint32_t seen = 0;
        pretended.vendorID = vendors[i].vendor;
        assert_int_equal(masu_plan(&s.desc, &plan, NULL), MASU_OK);
        for (uint32_t p = 0; p < plan.pass_count; p++) {
            int twice = !strcmp(plan.passes[p].name, "easu_twice");
            if (!twice && strcmp(plan.passes[p].name, "easu") != 0) continue;
            assert_int_equal(plan.passes[p].active != 0, twice == (int)vendors[i].twice);
            seen++;
        }
        assert_int_equal(seen, 2);
    }
    s.desc.vulkan.get_instance_proc_addr = real_proc;
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_rung_is_drawn_and_nothing_is_made),
        cmocka_unit_test(a_rung_is_the_picture_of_that_rung_given_by_hand),
        cmocka_unit_test(memory_is_planned_once_for_all_rungs),
        cmocka_unit_test(a_gpu_of_a_class_begins_with_what_was_computed_for_it),
        cmocka_unit_test(twice_the_size_takes_the_pass_that_fits_the_vendor),
    };
    return cmocka_run_group_tests_name("ladder", tests, NULL, NULL);
}
