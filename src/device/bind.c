/* bind.c: allocates device memory (one vkAllocateMemory per block) or accepts the host's, maps it
 * for the lifetime of the renderer, and binds the planned images and buffers at their offsets. */
#include "device/bind.h"

#include "base/error.h"

static const char *const role_names[MASU_ROLE_COUNT] = {"device_blocks[MASU_ROLE_DEVICE]",
                                                        "device_blocks[MASU_ROLE_UPLOAD]",
                                                        "device_blocks[MASU_ROLE_READBACK]"};

/* The memory block that serves a role. */
static uint32_t block_of(const masu_frame_plan *plan, masu_role role) {
    return plan->unified ? (uint32_t)MASU_ROLE_DEVICE : (uint32_t)role;
}

unsigned char *masu_buffer_pointer(const masu_device *m, masu_buffer_id buffer, uint32_t slot) {
    const masu_buffer_plan *b = &m->plan->buffers[buffer];
    unsigned char *base = m->mapped[block_of(m->plan, b->role)];
    return base && b->bytes ? base + b->offset + slot * b->stride : NULL;
}

void masu_name(const masu_device *m, VkObjectType type, uint64_t handle, const char *name) {
    if (!m->vk.SetDebugUtilsObjectNameEXT || !handle) return;
    VkDebugUtilsObjectNameInfoEXT info = {.sType =
                                              VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                          .objectType = type,
                                          .objectHandle = handle,
                                          .pObjectName = name};
    /* a missing debug name is harmless */
    (void)m->vk.SetDebugUtilsObjectNameEXT(m->vk.device, &info);
}

static masu_result bind_host_block(masu_device *m, uint32_t role, masu_detail *detail) {
    const masu_device_block *given = &m->plan->desc.device_blocks[role];
    const masu_block_plan *need = &m->plan->blocks[role];
    const char *name = role_names[role];
    if (given->offset % need->alignment) {
        return masu_fail(detail, MASU_ERROR_MEMORY, name, need->alignment, given->offset,
                         "%s: offset %llu is no multiple of %llu", name,
                         (unsigned long long)given->offset, (unsigned long long)need->alignment);
    }
    if (given->bytes > UINT64_MAX - given->offset) {
        return masu_fail(detail, MASU_ERROR_MEMORY, name, UINT64_MAX - given->offset, given->bytes,
                         "%s: offset %llu and %llu bytes are more than 64 bits can address", name,
                         (unsigned long long)given->offset, (unsigned long long)given->bytes);
    }
    if (given->bytes < need->bytes) {
        return masu_fail(detail, MASU_ERROR_MEMORY, name, need->bytes, given->bytes,
                         "%s: %llu bytes are needed, %llu are given", name,
                         (unsigned long long)need->bytes, (unsigned long long)given->bytes);
    }
    VkMemoryPropertyFlags visible =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkMemoryPropertyFlags flags = m->vk.memory.memoryTypes[given->memory_type].propertyFlags;
    if (need->host_visible && (!given->mapped || (flags & visible) != visible)) {
        return masu_fail(detail, MASU_ERROR_MEMORY, name, visible, flags,
                         "%s must be mapped, of a host-visible and coherent type", name);
    }
    /* guaranteed alignment of vkMapMemory */
    uint64_t alignment = need->alignment < 64 ? need->alignment : 64;
    if (need->host_visible && (uintptr_t)given->mapped % alignment) {
        return masu_fail(detail, MASU_ERROR_MEMORY, name, alignment, (uintptr_t)given->mapped,
                         "%s: mapped is not aligned to %llu bytes", name,
                         (unsigned long long)alignment);
    }
    m->memory[role] = given->memory;
    m->mapped[role] = need->host_visible ? given->mapped : NULL;
    return MASU_OK;
}

static masu_result allocate_block(masu_device *m, uint32_t role, masu_detail *detail) {
    const masu_block_plan *need = &m->plan->blocks[role];
    VkMemoryAllocateFlagsInfo flags = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                       .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .pNext = need->address ? &flags : NULL,
                                 .allocationSize = need->bytes,
                                 .memoryTypeIndex = need->type};
    VkResult r = m->vk.AllocateMemory(m->vk.device, &info, m->vk.allocator, &m->memory[role]);
    if (r) {
        masu_result result = masu_fail_vulkan(detail, r, "vkAllocateMemory");
        if (detail) detail->needed = need->bytes;
        return result;
    }
    m->memory_owned[role] = 1;
    masu_name(m, VK_OBJECT_TYPE_DEVICE_MEMORY, MASU_HANDLE(m->memory[role]), role_names[role]);
    if (!need->host_visible) return MASU_OK;
    void *mapped = NULL;
    r = m->vk.MapMemory(m->vk.device, m->memory[role], 0, VK_WHOLE_SIZE, 0, &mapped);
    if (r) return masu_fail_vulkan(detail, r, "vkMapMemory");
    m->mapped[role] = mapped;
    return MASU_OK;
}

masu_result masu_bind_memory(masu_device *m, masu_detail *detail) {
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++) {
        if (!m->plan->blocks[role].bytes) continue;
        masu_result result = m->plan->desc.device_blocks[role].memory
                                 ? bind_host_block(m, role, detail)
                                 : allocate_block(m, role, detail);
        if (result) return result;
    }
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        const masu_buffer_plan *buffer = &m->plan->buffers[b];
        if (!m->objects.buffers[b]) continue;
        uint32_t block = block_of(m->plan, buffer->role);
        uint64_t base = m->memory_owned[block] ? 0 : m->plan->desc.device_blocks[block].offset;
        VkResult r = m->vk.BindBufferMemory(m->vk.device, m->objects.buffers[b], m->memory[block],
                                            base + buffer->offset);
        if (r) return masu_fail_vulkan(detail, r, "vkBindBufferMemory");
        masu_name(m, VK_OBJECT_TYPE_BUFFER, MASU_HANDLE(m->objects.buffers[b]), buffer->name);
    }
    uint64_t base = m->memory_owned[MASU_ROLE_DEVICE]
                        ? 0
                        : m->plan->desc.device_blocks[MASU_ROLE_DEVICE].offset;
    for (uint32_t i = 0; i < MASU_IMAGE_COUNT; i++) {
        if (!m->objects.images[i]) continue;
        VkResult r =
            m->vk.BindImageMemory(m->vk.device, m->objects.images[i], m->memory[MASU_ROLE_DEVICE],
                                  base + m->plan->images[i].offset);
        if (r) return masu_fail_vulkan(detail, r, "vkBindImageMemory");
        masu_name(m, VK_OBJECT_TYPE_IMAGE, MASU_HANDLE(m->objects.images[i]), masu_images[i].name);
    }
    for (uint32_t i = 0; i < m->plan->scene.texture_arrays; i++) {
        masu_texture_plan *t = &m->plan->textures[i];
        VkResult r = m->vk.BindImageMemory(m->vk.device, t->image, m->memory[MASU_ROLE_DEVICE],
                                           base + t->offset);
        if (r) return masu_fail_vulkan(detail, r, "vkBindImageMemory");
        masu_name(m, VK_OBJECT_TYPE_IMAGE, MASU_HANDLE(t->image), "texture");
    }
    return MASU_OK;
}

static masu_result create_texture_views(masu_device *m, masu_detail *detail) {
    for (uint32_t i = 0; i < m->plan->scene.texture_arrays; i++) {
        masu_texture_plan *t = &m->plan->textures[i];
        VkImageViewCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = t->image,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                      .format = t->format,
                                      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0,
                                                           VK_REMAINING_MIP_LEVELS, 0,
                                                           VK_REMAINING_ARRAY_LAYERS}};
        VkResult r = m->vk.CreateImageView(m->vk.device, &info, m->vk.allocator, &t->view);
        if (MASU_FAILED(r, t->view)) return masu_fail_vulkan(detail, r, "vkCreateImageView");
        masu_name(m, VK_OBJECT_TYPE_IMAGE_VIEW, MASU_HANDLE(t->view), "texture");
    }
    return MASU_OK;
}

/* An image whose usage flags include none that needs a view must not have one (VUID 04441). */
static masu_result create_view(masu_device *m, uint32_t image, VkFormat format,
                               VkImageUsageFlags usage, VkImageView *view, masu_detail *detail) {
    const VkImageUsageFlags copies =
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    if (!(usage & ~copies)) return MASU_OK;
    int depth = masu_is_depth(format);
    VkImageViewUsageCreateInfo only = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO,
                                       .usage = usage};
    VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .pNext = usage == m->plan->images[image].usage ? NULL : &only,
        .image = m->objects.images[image],
        .viewType =
            masu_images[image].layers != 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
        .format = format,
        .subresourceRange = {.aspectMask =
                                 depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
                             .levelCount = 1,
                             .layerCount = VK_REMAINING_ARRAY_LAYERS}};
    VkResult r = m->vk.CreateImageView(m->vk.device, &info, m->vk.allocator, view);
    if (MASU_FAILED(r, *view)) return masu_fail_vulkan(detail, r, "vkCreateImageView");
    masu_name(m, VK_OBJECT_TYPE_IMAGE_VIEW, MASU_HANDLE(*view), masu_images[image].name);
    return MASU_OK;
}

masu_result masu_create_views(masu_device *m, masu_detail *detail) {
    for (uint32_t i = 0; i < MASU_IMAGE_COUNT; i++) {
        if (!m->objects.images[i]) continue;
        VkFormat format = masu_plan_format(m->plan, i), stored = masu_plan_store_format(m->plan, i);
        VkImageUsageFlags usage = m->plan->images[i].usage;
        VkImageUsageFlags apart = format == stored ? 0 : usage & VK_IMAGE_USAGE_STORAGE_BIT;
        masu_result result = create_view(m, i, format, usage & ~apart, &m->views[i], detail);
        if (!result && apart) result = create_view(m, i, stored, apart, &m->stores[i], detail);
        if (result) return result;
    }
    m->views[MASU_IMAGE_SOURCE] = m->plan->desc.source.view;
    return create_texture_views(m, detail);
}
