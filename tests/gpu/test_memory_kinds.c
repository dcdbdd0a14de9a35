/* test_memory_kinds.c: memory types of other devices, and contents of recordings whose absence no
 * software driver would show: both observed through support_wrap. */
#include "renderer.h"
#include "support/support.h"
#include "support/wrap.h"

#include <stdlib.h>
#include <string.h>

enum { W = 96, H = 66, BYTES = W * H * 4 };

static uint8_t reference[BYTES], pixels[BYTES];

/* The sphere mesh is 6.5 MB: more than one staging buffer. */
static masu_session_desc sphere_desc(void) {
    masu_session_desc d = test_desc("test_sphere_mesh", W, H);
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    return d;
}

static void draw_reference(void) {
    masu_session_desc d = test_desc("test_sphere_mesh", W, H);
    masu_session s;
    open_session(&s, &d);
    draw_rung(&s, 0, reference);
    close_session(&s);
}

/* Draws with the memory types that `wrap` simulates; returns how often the scene had to be
 * copied. */
static uint32_t draw_with(masu_session *s, const masu_session_desc *d, masu_memory *need) {
    masu_session_desc without = *d;
    without.no_renderer = true;
    open_session(s, &without);
    assert_int_equal(masu_memory_query(&s->desc, need, NULL), MASU_OK);
    s->block = host_block(need->host_bytes);
    masu_detail detail;
    if (masu_init(&s->desc, s->block, need->host_bytes, &s->m, &detail))
        fail_msg("%s", detail.text);
    uint32_t copies = load_all(s, s->m);
    draw_rung(s, 0, pixels);
    return copies;
}

static void one_type_for_everything_is_one_allocation_without_copies(void **state) {
    (void)state;
    skip_unless_host_sees_all_memory();
    if (masu_session_denied()) skip(); /* no unified memory */
    masu_session_desc d = sphere_desc();
    masu_session s;
    masu_memory need;
    draw_reference();
    assert_int_equal(draw_with(&s, &d, &need), 0);
    assert_int_equal(need.unified, 1);
    assert_int_equal(wrap.allocate_calls, 1);
    assert_int_equal(max_difference(pixels, reference, BYTES), 0);
    close_session(&s);
    d.desc.deny.unified_memory = 1;
    wrap.allocate_calls = 0;
    assert_int_equal(draw_with(&s, &d, &need), 0); /* still host-visible: written directly */
    assert_int_equal(need.unified, 0);
    assert_int_equal(wrap.allocate_calls, 3);
    close_session(&s);
}

static void a_discrete_device_gets_the_scene_through_a_staging_buffer_in_chunks(void **state) {
    (void)state;
    skip_unless_host_sees_all_memory();
    masu_session_desc d = sphere_desc();
    masu_session s;
    masu_memory need;
    draw_reference();
    wrap.fake_memory = 1;
    /* 2.6 MB vertices, 3.9 MB indices, a material, the tables of surfaces */
    assert_int_equal(draw_with(&s, &d, &need), 4);
    assert_int_equal(need.unified, 0);
    assert_int_equal(wrap.allocate_calls, 3);
    assert_int_equal(need.roles[MASU_ROLE_DEVICE].host_visible, 0);
    assert_int_equal(max_difference(pixels, reference, BYTES), 0);
    close_session(&s);
    assert_int_equal(wrap.live, 0);
    wrap_reset();
}

/* The host cannot access the first device-local type of such a device: it must not be chosen. */
static void an_apu_gets_one_block_of_the_type_that_is_both(void **state) {
    (void)state;
    skip_unless_host_sees_all_memory();
    if (masu_session_denied()) skip(); /* no unified memory */
    masu_session_desc d = sphere_desc();
    masu_session s;
    masu_memory need;
    draw_reference();
    wrap.fake_memory = 2;
    assert_int_equal(draw_with(&s, &d, &need), 0);
    assert_int_equal(need.unified, 1);
    assert_int_equal(need.roles[MASU_ROLE_DEVICE].type, 2);
    assert_int_equal(wrap.allocate_calls, 1);
    assert_int_equal(max_difference(pixels, reference, BYTES), 0);
    close_session(&s);
    wrap_reset();
}

static void a_block_of_the_host_that_cannot_serve_is_refused(void **state) {
    (void)state;
    skip_unless_host_sees_all_memory();
    masu_session_desc d = sphere_desc();
    masu_session s;
    masu_memory need;
    masu_detail detail;
    masu_renderer *m;
    d.no_renderer = true;
    open_session(&s, &d);
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    const masu_role_need *role = &need.roles[MASU_ROLE_DEVICE];
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .allocationSize = role->bytes + 4096,
                                 .memoryTypeIndex = role->type};
    VkDeviceMemory memory;
    void *mapped = NULL, *block = host_block(need.host_bytes);
    assert_int_equal(vkAllocateMemory(s.host.device, &info, NULL, &memory), VK_SUCCESS);
    assert_int_equal(vkMapMemory(s.host.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
    masu_device_block *given = &s.desc.device_blocks[MASU_ROLE_DEVICE];
    const masu_device_block good = {memory, 0, role->bytes, mapped, role->type};
    *given = good, given->memory_type = 0xFFFFFFFF;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_MEMORY);
    assert_non_null(strstr(detail.text, "memory_type"));
    *given = good, given->memory_type = 31;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_MEMORY);
    *given = good, given->offset = 1;
    assert_int_equal(masu_init(&s.desc, block, need.host_bytes, &m, &detail), MASU_ERROR_MEMORY);
    assert_non_null(strstr(detail.text, "offset"));
    *given = good, given->mapped = NULL;
    assert_int_equal(masu_init(&s.desc, block, need.host_bytes, &m, &detail), MASU_ERROR_MEMORY);
    assert_non_null(strstr(detail.text, "mapped"));
    *given = good;
    assert_int_equal(masu_init(&s.desc, block, need.host_bytes, &m, &detail), MASU_OK);
    masu_destroy(m);
    free(block);
    vkFreeMemory(s.host.device, memory, NULL);
    close_session(&s);
}

static void recordings_hold_the_barriers_that_only_real_devices_need(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_both", W, H);
    masu_session s;
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.desc.targets.final_layout = VK_IMAGE_LAYOUT_GENERAL;
    d.desc.readback = MASU_READBACK_DEPTH;
    d.desc.debug.labels = 1;
    d.desc.debug.poison = 1;
    open_session(&s, &d);
    assert_int_equal(wrap.first_barrier_from, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
    assert_int_equal(wrap.first_barrier_to, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
    assert_true(wrap.counter_barrier);
    assert_true(wrap.host_barrier);
    assert_int_equal(wrap.last_layout, VK_IMAGE_LAYOUT_GENERAL);
    masu_plan_info plan;
    masu_plan_of(s.m, &plan);
    uint32_t passes = 0;
    for (uint32_t r = 0; r < plan.rung_count; r++) passes += plan.rungs[r].dispatches;
    assert_int_equal(wrap.labels, passes * 2);       /* two frames in flight */
    assert_int_equal(wrap.fills_of_poison, 3u * 2u); /* each recording */
    assert_true(plan.rungs[0].barriers > 4);
    close_session(&s);
    wrap_reset();
}

/* NaN, infinity, and half floats of NaN and 1. */
static void each_kind_of_poison_is_another(void **state) {
    (void)state;
    static const uint32_t words[] = {0x7FC07FC0u, 0x7C007C00u, 0x3C007FC0u};
    for (uint32_t kind = 1; kind <= 3; kind++) {
        masu_session_desc d = test_desc("test_velocity_mesh", 16, 16);
        masu_session s;
        wrap_reset();
        d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
        d.desc.rung_count = 1;
        d.desc.debug.poison = kind;
        open_session(&s, &d);
        assert_int_equal(wrap.poison, words[kind - 1]);
        close_session(&s);
        wrap_reset();
    }
}

/* ---- Images that share memory ---------------------------------------------------------------- */

typedef struct noted {
    VkCommandBuffer cmd;
    VkPipelineStageFlags from, to;
    VkImageMemoryBarrier image;
} noted;

enum { NOTED = 8192 };
static noted all_noted[NOTED];
static uint32_t noted_count;

static void note(VkCommandBuffer cmd, VkPipelineStageFlags from, VkPipelineStageFlags to,
                 const VkImageMemoryBarrier *image) {
    if (noted_count < NOTED) all_noted[noted_count] = (noted){cmd, from, to, *image};
    noted_count++;
}

/* 0: not an image of the renderer. */
static uint32_t image_of(const masu_session *s, VkImage image) {
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        if (image && s->m->device.objects.images[i] == image) return i;
    }
    return 0;
}

/* The first use of an image waits for everything that the same recording has done in its memory,
 * and for what was written there: no software driver would show a missing wait. */
static void an_image_waits_for_those_that_had_its_bytes(void **state) {
    (void)state;
    const VkAccessFlags writes = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT |
                                 VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                                 VK_ACCESS_TRANSFER_WRITE_BIT;
    masu_session s;
    masu_session_desc d = test_desc("test_live", W, H);
    d.desc.rung_count = 2;
    d.desc.rungs[0] = (masu_rung){.scale = 0.7f, .aa = MASU_AA_SMAA_HIGH};
    d.desc.rungs[1] = (masu_rung){.scale = 0.5f, .temporal = MASU_ON};
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    wrap.on_barrier = note;
    noted_count = 0;
    open_session(&s, &d);
    assert_in_range(noted_count, 50, NOTED);
    uint32_t waits = 0, written = 0;
    for (uint32_t i = 0; i < noted_count; i++) {
        const noted *n = &all_noted[i];
        uint32_t own = image_of(&s, n->image.image);
        if (!own || n->image.oldLayout != VK_IMAGE_LAYOUT_UNDEFINED) continue;
        const masu_image_plan *here = &s.m->plan.images[own];
        uint8_t seen[MASU_IMAGE_SOURCE] = {0};
        for (uint32_t j = i; j-- > 0;) { /* the last barrier of each image */
            const noted *before = &all_noted[j];
            uint32_t other = image_of(&s, before->image.image);
            if (before->cmd != n->cmd || !other || other == own || seen[other]) continue;
            const masu_image_plan *there = &s.m->plan.images[other];
            if (here->offset >= there->offset + there->bytes ||
                there->offset >= here->offset + here->bytes)
                continue;
            seen[other] = 1;
            waits++;
            if (!(n->from & before->to))
                fail_msg("image %u does not wait for image %u", own, other);
            if (!(before->image.dstAccessMask & writes)) continue;
            written++;
            if (!(n->image.srcAccessMask & before->image.dstAccessMask & writes))
                fail_msg("image %u does not wait for the writes to image %u", own, other);
        }
    }
    print_message("%u waits for images that used the memory before, of which %u were written "
                  "last\n",
                  waits, written);
    assert_true(waits > 10);
    close_session(&s);
    wrap_reset();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_type_for_everything_is_one_allocation_without_copies),
        cmocka_unit_test(a_discrete_device_gets_the_scene_through_a_staging_buffer_in_chunks),
        cmocka_unit_test(an_apu_gets_one_block_of_the_type_that_is_both),
        cmocka_unit_test(a_block_of_the_host_that_cannot_serve_is_refused),
        cmocka_unit_test(recordings_hold_the_barriers_that_only_real_devices_need),
        cmocka_unit_test(each_kind_of_poison_is_another),
        cmocka_unit_test(an_image_waits_for_those_that_had_its_bytes),
    };
    return cmocka_run_group_tests_name("memory_kinds", tests, NULL, NULL);
}
