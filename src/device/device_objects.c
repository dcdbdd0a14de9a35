/* device_objects.c: see device_objects.h. */
#include "device/device_objects.h"

#include "device/bind.h"
#include "device/load.h"
#include "device/pipelines.h"
#include "device/pool.h"
#include "device/prepare.h"
#include "device/ray_query.h"
#include "device/recordings.h"
#include "device/shaders.h"

void masu_device_alloc(masu_device *m, masu_arena *arena, const masu_frame_plan *plan) {
    uint64_t frames = (uint64_t)plan->desc.frames_in_flight * plan->recordings * plan->parts;
    m->frames = masu_arena_alloc(arena, "command buffers", frames, sizeof *m->frames, 8);
    m->recorded = masu_arena_alloc(arena, "recorded",
                                   (uint64_t)plan->desc.frames_in_flight * plan->recordings,
                                   sizeof *m->recorded, 1);
    m->loads = masu_arena_alloc(arena, "load command buffers", masu_load_chunks(plan),
                                sizeof *m->loads, 8);
    m->pass_sets =
        masu_arena_alloc(arena, "descriptor sets", plan->pass_sets, sizeof *m->pass_sets, 8);
    m->texture_sets = masu_arena_alloc(arena, "texture sets", plan->scene.texture_sets,
                                       sizeof *m->texture_sets, 8);
    m->pool_keys =
        masu_arena_alloc(arena, "pipeline keys", plan->desc.vulkan.pipelines ? MASU_POOL_KEYS : 0,
                         sizeof *m->pool_keys, 8);
    uint64_t room = plan->desc.init_in_steps ? masu_code_room(plan) : 0;
    m->code_room = masu_arena_alloc(arena, "shader code", room, 1, 8);
    if (!room) m->code_room = NULL;
    m->ray_meshes =
        masu_arena_alloc(arena, "bottom levels", plan->needs.query ? plan->scene.meshes : 0,
                         sizeof *m->ray_meshes, 8);
}

void masu_set_targets(masu_device *m, const masu_targets *targets) {
    masu_targets to = *targets;
    for (uint32_t t = 0; t < targets->count; t++) {
        m->target_images[t] = targets->images[t];
        m->target_views[t] = targets->views ? targets->views[t] : VK_NULL_HANDLE;
    }
    to.images = m->target_images;
    to.views = m->target_views;
    m->plan->desc.targets = to;
}

masu_result masu_device_create(masu_device *m, const masu_draws *draws, masu_detail *detail) {
    m->load_count = masu_load_chunks(m->plan);
    masu_result result = masu_bind_memory(m, detail);
    if (!result) result = masu_create_views(m, detail);
    if (!result) result = masu_ray_create(m, detail);
    if (!result) result = masu_create_layouts(m, detail);
    if (!result) result = masu_record_begin(m, detail);
    if (!result) masu_prepare_begin(m);
    if (!result && !m->plan->desc.init_in_steps) {
        do result = masu_prepare_step(m, draws, detail);
        while (result == MASU_INCOMPLETE);
    }
    return result;
}

void masu_device_destroy(masu_device *m) {
    const masu_vk *vk = &m->vk;
    VkDevice device = vk->device;
    masu_pool_release(m);
    vk->DestroyQueryPool(device, m->queries, vk->allocator);
    vk->DestroyCommandPool(device, m->command_pool, vk->allocator);
    vk->DestroyDescriptorPool(device, m->descriptor_pool, vk->allocator);
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        vk->DestroyPipeline(device, m->pipelines[p], vk->allocator);
        vk->DestroyPipeline(device, m->last[p], vk->allocator);
        vk->DestroyFramebuffer(device, m->framebuffers[p], vk->allocator);
        vk->DestroyRenderPass(device, m->render_passes[p], vk->allocator);
        vk->DestroyPipelineLayout(device, m->layouts[p], vk->allocator);
        vk->DestroyDescriptorSetLayout(device, m->pass_layouts[p], vk->allocator);
        vk->DestroyDescriptorSetLayout(device, m->global_layouts[p], vk->allocator);
    }
    vk->DestroySampler(device, m->sampler, vk->allocator);
    vk->DestroySampler(device, m->linear, vk->allocator);
    for (uint32_t i = 0; i < MASU_TEXTURED_COUNT; i++)
        vk->DestroyPipeline(device, m->textured[i], vk->allocator);
    for (uint32_t i = 0; i < MASU_CULLED_COUNT; i++)
        vk->DestroyPipeline(device, m->culled[i], vk->allocator);
    for (uint32_t i = 0; i < 2 * MASU_CULLED_COUNT; i++)
        vk->DestroyPipeline(device, m->emitting[i], vk->allocator);
    vk->DestroyPipeline(device, m->masked_casters, vk->allocator);
    vk->DestroyPipeline(device, m->masked_faces, vk->allocator);
    vk->DestroyPipeline(device, m->masked_picks, vk->allocator);
    vk->DestroyPipeline(device, m->tints, vk->allocator);
    vk->DestroyDescriptorSetLayout(device, m->texture_layout, vk->allocator);
    for (uint32_t i = 0; i < MASU_SAMPLER_COUNT; i++)
        vk->DestroySampler(device, m->samplers[i], vk->allocator);
    for (uint32_t i = 0; i < m->plan->scene.texture_arrays; i++)
        vk->DestroyImageView(device, m->plan->textures[i].view, vk->allocator);
    for (uint32_t i = 0; i < MASU_IMAGE_SOURCE; i++) {
        vk->DestroyImageView(device, m->views[i], vk->allocator);
        vk->DestroyImageView(device, m->stores[i], vk->allocator);
    }
    masu_ray_destroy(m);
    masu_objects_destroy(vk, m->plan, &m->objects);
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++) {
        if (m->memory_owned[role])
            vk->FreeMemory(device, m->memory[role], vk->allocator); /* also unmaps */
    }
}
