/* recordings.c: the list of recordings. There is one per frame in flight, viewport, rung and
 * target. If a rung renders some shadow cascades less often than every frame, there is also one
 * variant per set of cascades. prepare.c records all; after masu_resize the first frame that needs
 * a recording records it. Recordings are submitted many times. */
#include "device/recordings.h"

#include "base/error.h"
#include "device/descriptors.h"
#include "device/load.h"
#include "device/record.h"
#include "plan/compile.h"

#include <string.h>

static masu_result create_command_buffers(masu_device *m, uint32_t frames, masu_detail *detail) {
    /* Command buffers are reset one by one, while others may be pending. */
    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = m->plan->desc.resizable
                     ? (VkCommandPoolCreateFlags)VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT
                     : 0,
        .queueFamilyIndex = m->plan->desc.vulkan.queue_family};
    VkResult r = m->vk.CreateCommandPool(m->vk.device, &pool, m->vk.allocator, &m->command_pool);
    if (MASU_FAILED(r, m->command_pool)) return masu_fail_vulkan(detail, r, "vkCreateCommandPool");
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = m->command_pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = frames};
    r = m->vk.AllocateCommandBuffers(m->vk.device, &info, m->frames);
    info.commandBufferCount = m->load_count;
    if (!r && m->load_count) r = m->vk.AllocateCommandBuffers(m->vk.device, &info, m->loads);
    return r ? masu_fail_vulkan(detail, r, "vkAllocateCommandBuffers") : MASU_OK;
}

static masu_result create_queries(masu_device *m, masu_detail *detail) {
    if (!masu_stamps(&m->plan->desc)) return MASU_OK;
    VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                  .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                  .queryCount =
                                      m->plan->desc.frames_in_flight * (MASU_PASS_COUNT + 1)};
    VkResult r = m->vk.CreateQueryPool(m->vk.device, &info, m->vk.allocator, &m->queries);
    return MASU_FAILED(r, m->queries) ? masu_fail_vulkan(detail, r, "vkCreateQueryPool") : MASU_OK;
}

/* Records all variants of a frame, one per set of cascades. `again`: some may be recorded
 * already. */
static masu_result record_variants(masu_device *m, const masu_draws *draws, masu_recording_id id,
                                   int again, masu_detail *detail) {
    masu_frame_plan *plan = m->plan;
    masu_rung_plan *rp = &plan->rungs[id.rung];
    uint32_t first = masu_recording_of(plan, id);
    VkDescriptorSet sets[MASU_PASS_COUNT] = {VK_NULL_HANDLE};
    masu_result result = MASU_OK;
    masu_find_pass_sets(m, id.rung, id.target, sets);
    masu_plan_select_viewport(plan, id.viewport);
    for (uint32_t v = 0; v < rp->variants && !result; v++) {
        VkCommandBuffer *parts = &m->frames[(first + v) * plan->parts];
        for (uint32_t p = 0; p < plan->parts && again && !result; p++) {
            VkResult r = m->vk.ResetCommandBuffer(parts[p], 0);
            if (r) result = masu_fail_vulkan(detail, r, "vkResetCommandBuffer");
        }
        masu_recorder rec = {.m = m,
                             .draws = draws,
                             .parts = parts,
                             .flight = id.flight,
                             .viewport = id.viewport,
                             .rung = id.rung,
                             .target = id.target,
                             .variant = v,
                             .rp = rp};
        if (!result) result = masu_record_frame(&rec, sets, detail);
        rp->barriers = rec.barriers; /* of the last variant, which runs all passes */
    }
    if (!result) m->recorded[first] = 1;
    return result;
}

/* All recordings of a rung. */
static masu_result record_rung(masu_device *m, const masu_draws *draws, uint32_t rung, int again,
                               masu_detail *detail) {
    const masu_desc *d = &m->plan->desc;
    uint32_t viewports = d->viewport_count ? d->viewport_count : 1, flights = d->frames_in_flight;
    masu_result result = MASU_OK;
    for (uint32_t i = 0; i < viewports * flights * d->targets.count && !result; i++) {
        masu_recording_id id = {.viewport = i / d->targets.count / flights,
                                .flight = i / d->targets.count % flights,
                                .rung = rung,
                                .target = i % d->targets.count};
        result = record_variants(m, draws, id, again, detail);
    }
    masu_plan_select_viewport(m->plan, 0);
    return result;
}

masu_result masu_record_rung(masu_device *m, const masu_draws *draws, uint32_t rung,
                             masu_detail *detail) {
    return record_rung(m, draws, rung, 0, detail);
}

masu_result masu_record_begin(masu_device *m, masu_detail *detail) {
    const masu_desc *d = &m->plan->desc;
    masu_result result = masu_create_sets(m, detail);
    if (!result) result = masu_create_pass_sets(m, detail);
    if (!result) result = create_queries(m, detail);
    if (!result)
        result = create_command_buffers(
            m, d->frames_in_flight * m->plan->recordings * m->plan->parts, detail);
    return result ? result : masu_load_record(m, detail);
}

masu_result masu_record_again(masu_device *m, const masu_draws *draws, uint32_t rung,
                              masu_detail *detail) {
    memset(m->recorded, 0, (size_t)m->plan->desc.frames_in_flight * m->plan->recordings);
    masu_write_pass_sets(m);
    return m->ready >> rung & 1u ? record_rung(m, draws, rung, 1, detail) : MASU_OK;
}

masu_result masu_record_missing(masu_device *m, const masu_draws *draws, masu_recording_id id,
                                masu_detail *detail) {
    if (m->recorded[masu_recording_of(m->plan, id)]) return MASU_OK;
    return record_variants(m, draws, id, 1, detail);
}
