/* descriptors.c: the descriptor pool, set 0 (buffers) and set 1 (images) of each pass, and set 2
 * (textures). */
#include "device/descriptors.h"

#include "plan/buffer_plan.h"

#include "base/error.h"
#include "device/barriers.h"
#include "device/ray_query.h"
#include "device/shaders.h"
#include "scene/scene.h"

int masu_has_global_sets(const masu_frame_plan *plan) {
    return plan->needs.scene || plan->needs.smoothing;
}

static masu_result create_pool(masu_device *m, masu_detail *detail) {
    uint32_t flights = m->plan->desc.frames_in_flight, sets = m->plan->pass_sets;
    uint32_t uniforms = 0, buffers = 0, structures = 0, globals = 0;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        VkDescriptorSetLayoutBinding bindings[MASU_BIND_COUNT];
        uint32_t count = m->global_layouts[p] ? masu_global_bindings(m->plan, p, bindings) : 0;
        globals += m->global_layouts[p] != VK_NULL_HANDLE;
        for (uint32_t i = 0; i < count; i++) {
            uniforms += bindings[i].descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
            buffers += bindings[i].descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
            structures +=
                bindings[i].descriptorType == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
        }
    }
    /* No count may be 0. The last entry exists only with ray queries. */
    VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1 + uniforms * flights},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1 + buffers * flights},
        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
         MASU_PASS_ACCESSES * sets + MASU_MAP_COUNT * m->plan->scene.texture_sets},
        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, MASU_PASS_ACCESSES * sets},
        {VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1 + structures * flights}};
    VkDescriptorPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets =
                                           flights * globals + sets + m->plan->scene.texture_sets,
                                       .poolSizeCount = m->plan->needs.query ? 5 : 4,
                                       .pPoolSizes = sizes};
    VkResult r =
        m->vk.CreateDescriptorPool(m->vk.device, &info, m->vk.allocator, &m->descriptor_pool);
    return MASU_FAILED(r, m->descriptor_pool)
               ? masu_fail_vulkan(detail, r, "vkCreateDescriptorPool")
               : MASU_OK;
}

static masu_result allocate_set(masu_device *m, VkDescriptorSetLayout layout,
                                VkDescriptorSet *set, masu_detail *detail) {
    VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                        .descriptorPool = m->descriptor_pool,
                                        .descriptorSetCount = 1,
                                        .pSetLayouts = &layout};
    VkResult r = m->vk.AllocateDescriptorSets(m->vk.device, &info, set);
    return r ? masu_fail_vulkan(detail, r, "vkAllocateDescriptorSets") : MASU_OK;
}

/* Writes one buffer binding for one frame in flight. A shader may declare a uniform buffer that the
 * plan does not have, if the code that reads the buffer is compiled away. The binding must be valid
 * nevertheless, so the frame's uniform buffer is bound. */
static void write_binding(masu_device *m, uint32_t flight, VkDescriptorSet set,
                          const masu_binding *row) {
    const masu_buffer_plan *b = &m->plan->buffers[row->buffer];
    VkDescriptorBufferInfo buffer = {m->objects.buffers[row->buffer],
                                     flight * b->stride + (row->previous ? b->stride / 2 : 0),
                                     row->range};
    if (!b->bytes && row->type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER) {
        b = &m->plan->buffers[MASU_BUFFER_FRAME];
        buffer = (VkDescriptorBufferInfo){m->objects.buffers[MASU_BUFFER_FRAME], flight * b->stride,
                                          sizeof(struct masu_frame_uniforms)};
    }
    if (!b->bytes) return; /* no pass of this plan uses it */
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = set,
                                  .dstBinding = row->binding,
                                  .descriptorCount = 1,
                                  .descriptorType = row->type,
                                  .pBufferInfo = &buffer};
    m->vk.UpdateDescriptorSets(m->vk.device, 1, &write, 0, NULL);
}

/* One set per pass, with the buffers that its shaders declare. */
static masu_result create_global_sets(masu_device *m, uint32_t pass, masu_detail *detail) {
    masu_binding rows[MASU_BIND_COUNT];
    VkDescriptorSetLayoutBinding bindings[MASU_BIND_COUNT];
    uint32_t count = masu_global_bindings(m->plan, pass, bindings);
    masu_bindings(m->plan, rows);
    for (uint32_t f = 0; f < m->plan->desc.frames_in_flight; f++) {
        VkDescriptorSet *set = &m->global_sets[f][pass];
        masu_result result = allocate_set(m, m->global_layouts[pass], set, detail);
        if (result) return result;
        for (uint32_t i = 0; i < count; i++) {
            const masu_binding *row = rows;
            while (row->binding != bindings[i].binding) row++;
            if (row->previous && !m->plan->needs.velocity) continue;
            if (row->type == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR)
                masu_ray_bind(m, *set);
            else
                write_binding(m, f, *set, row);
        }
    }
    return MASU_OK;
}

/* An unused texture slot gets another slot's texture. So does the last slot, for live textures, if
 * the plan has none. The shader does not sample it, but every binding of a set must be valid. */
static masu_result create_texture_sets(masu_device *m, masu_detail *detail) {
    masu_scene_view v = {0};
    if (m->plan->scene.texture_sets) v = masu_scene_data_view(&m->plan->scene);
    for (uint32_t i = 0; i < m->plan->scene.texture_sets; i++) {
        const masu_blob_texture_set *from = &v.texture_sets[i];
        masu_result result = allocate_set(m, m->texture_layout, &m->texture_sets[i], detail);
        if (result) return result;
        uint32_t any = 0;
        while (from->texture[any] == MASU_BLOB_NONE) any++;
        for (uint32_t slot = 0; slot < MASU_MAP_COUNT; slot++) {
            uint32_t given = slot < MASU_SLOT_COUNT ? from->texture[slot] : MASU_BLOB_NONE;
            int live = slot == MASU_SLOT_COUNT && m->plan->needs.texture_maps;
            if (given == MASU_BLOB_NONE) given = from->texture[any];
            VkDescriptorImageInfo image = {.sampler =
                                               m->samplers[masu_sampler_of(from->wrap)],
                                           .imageView = live ? m->views[MASU_IMAGE_TEXTURES]
                                                             : m->plan->textures[given].view,
                                           .imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
            VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                          .dstSet = m->texture_sets[i],
                                          .dstBinding = slot,
                                          .descriptorCount = 1,
                                          .descriptorType =
                                              VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                          .pImageInfo = &image};
            m->vk.UpdateDescriptorSets(m->vk.device, 1, &write, 0, NULL);
        }
    }
    return MASU_OK;
}

static int writes_target(const masu_rung_plan *rp, uint32_t pass) {
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        if (rp->access[pass][a].image == MASU_IMAGE_TARGET) return 1;
    }
    return 0;
}

static void write_pass_set(masu_device *m, const masu_rung_plan *rp, uint32_t pass,
                           uint32_t target, VkDescriptorSet set) {
    uint32_t binding = 0;
    for (int writes = 0; writes < 2; writes++) {
        for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
            if (!masu_access_binds(rp->access[pass][a], writes)) continue;
            uint32_t id = rp->access[pass][a].image;
            VkDescriptorImageInfo image = {
                .imageView = id == MASU_IMAGE_TARGET   ? m->plan->desc.targets.views[target]
                             : writes && m->stores[id] ? m->stores[id]
                                                       : m->views[id],
                .imageLayout =
                    masu_use_of((masu_usage)rp->access[pass][a].usage, masu_passes[pass].kind)
                        .layout};
            VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                          .dstSet = set,
                                          .dstBinding = binding++,
                                          .descriptorCount = 1,
                                          .descriptorType =
                                              writes ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                                                     : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                          .pImageInfo = &image};
            m->vk.UpdateDescriptorSets(m->vk.device, 1, &write, 0, NULL);
        }
    }
}

/* Iterates over the sets in allocation order: `next` is the first set of a pass, `count` its number
 * of sets. */
typedef struct set_cursor {
    uint32_t rung, pass, next, count;
} set_cursor;

static int next_pass(const masu_frame_plan *plan, set_cursor *at) {
    at->next += at->count;
    for (; at->rung < plan->desc.rung_count; at->rung++, at->pass = 0) {
        const masu_rung_plan *rp = &plan->rungs[at->rung];
        while (at->pass < MASU_PASS_COUNT) {
            uint32_t p = at->pass++;
            if (!masu_has_pass(&rp->active, p) || !masu_has_set(p)) continue;
            at->count = writes_target(rp, p) ? plan->targets_max : 1;
            return 1;
        }
    }
    return 0;
}

masu_result masu_create_pass_sets(masu_device *m, masu_detail *detail) {
    for (set_cursor at = {0}; next_pass(m->plan, &at);) {
        for (uint32_t t = 0; t < at.count; t++) {
            masu_result result =
                allocate_set(m, m->pass_layouts[at.pass - 1], &m->pass_sets[at.next + t], detail);
            if (result) return result;
        }
    }
    masu_write_pass_sets(m);
    return MASU_OK;
}

void masu_write_pass_sets(masu_device *m) {
    for (set_cursor at = {0}; next_pass(m->plan, &at);) {
        for (uint32_t t = 0; t < at.count && t < m->plan->desc.targets.count; t++)
            write_pass_set(m, &m->plan->rungs[at.rung], at.pass - 1, t, m->pass_sets[at.next + t]);
    }
}

void masu_find_pass_sets(const masu_device *m, uint32_t rung, uint32_t target,
                         VkDescriptorSet sets[MASU_PASS_COUNT]) {
    for (set_cursor at = {0}; next_pass(m->plan, &at);) {
        if (at.rung > rung) break;
        if (at.rung == rung)
            sets[at.pass - 1] = m->pass_sets[at.next + (at.count > 1 ? target : 0)];
    }
}

masu_result masu_create_sets(masu_device *m, masu_detail *detail) {
    masu_result result = create_pool(m, detail);
    for (uint32_t p = 0; p < MASU_PASS_COUNT && !result; p++) {
        if (m->global_layouts[p] && masu_has_global_sets(m->plan))
            result = create_global_sets(m, p, detail);
    }
    if (!result) result = create_texture_sets(m, detail);
    return result;
}
