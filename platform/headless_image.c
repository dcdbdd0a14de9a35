/* headless_image.c: target and source images of the headless host. Each has a separate allocation,
 * because they belong to the host, not to the renderer's memory block. */
#include "headless.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool allocate(masu_headless *host, VkMemoryRequirements need, VkMemoryPropertyFlags wanted,
                     VkDeviceMemory *memory, char *error, size_t size) {
    uint32_t type = UINT32_MAX;
    for (uint32_t i = 0; i < host->memory.memoryTypeCount && type == UINT32_MAX; i++) {
        bool fits = (need.memoryTypeBits & 1u << i) != 0;
        if (fits && (host->memory.memoryTypes[i].propertyFlags & wanted) == wanted) type = i;
    }
    if (type == UINT32_MAX) {
        snprintf(error, size, "no memory type with properties 0x%x", (unsigned)wanted);
        return false;
    }
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .allocationSize = need.size,
                                 .memoryTypeIndex = type};
    VkResult r = vkAllocateMemory(host->device, &info, host->desc.allocator, memory);
    return r ? masu_headless_fail(error, size, "vkAllocateMemory", r) : true;
}

bool masu_headless_buffer_create(masu_headless *host, uint64_t bytes, VkBufferUsageFlags usage,
                                 masu_headless_buffer *b, char *error, size_t size) {
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    memset(b, 0, sizeof *b);
    VkResult r = vkCreateBuffer(host->device, &info, host->desc.allocator, &b->buffer);
    if (r) return masu_headless_fail(error, size, "vkCreateBuffer", r);
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(host->device, b->buffer, &need);
    VkMemoryPropertyFlags visible =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    char ignored[128];
    if (!allocate(host, need, visible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, &b->memory, ignored,
                  sizeof ignored) &&
        !allocate(host, need, visible, &b->memory, error, size)) {
        return false;
    }
    r = vkBindBufferMemory(host->device, b->buffer, b->memory, 0);
    if (!r) r = vkMapMemory(host->device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped);
    return r ? masu_headless_fail(error, size, "vkMapMemory", r) : true;
}

void masu_headless_buffer_destroy(masu_headless *host, masu_headless_buffer *b) {
    if (!host->device) return;
    vkDestroyBuffer(host->device, b->buffer, host->desc.allocator);
    vkFreeMemory(host->device, b->memory, host->desc.allocator);
    memset(b, 0, sizeof *b);
}

static bool make_image(masu_headless *host, uint32_t width, uint32_t height, VkFormat format,
                       VkImageUsageFlags usage, VkImage *image, VkImageView *view,
                       VkDeviceMemory *memory, char *error, size_t size) {
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = format,
                              .extent = {width, height, 1},
                              .mipLevels = 1,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .tiling = VK_IMAGE_TILING_OPTIMAL,
                              .usage = usage};
    VkResult r = vkCreateImage(host->device, &info, host->desc.allocator, image);
    if (r) return masu_headless_fail(error, size, "vkCreateImage", r);
    VkMemoryRequirements need;
    vkGetImageMemoryRequirements(host->device, *image, &need);
    char ignored[128];
    if (!allocate(host, need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, memory, ignored,
                  sizeof ignored) &&
        !allocate(host, need, 0, memory, error, size)) {
        return false;
    }
    r = vkBindImageMemory(host->device, *image, *memory, 0);
    if (r) return masu_headless_fail(error, size, "vkBindImageMemory", r);
    VkImageUsageFlags viewable = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
    if (!(usage & viewable)) return true;
    VkImageViewCreateInfo v = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                               .image = *image,
                               .viewType = VK_IMAGE_VIEW_TYPE_2D,
                               .format = format,
                               .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    r = vkCreateImageView(host->device, &v, host->desc.allocator, view);
    return r ? masu_headless_fail(error, size, "vkCreateImageView", r) : true;
}

static bool begin_commands(masu_headless *host, VkCommandBuffer *cmd, char *error, size_t size) {
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = host->pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    VkResult r = vkAllocateCommandBuffers(host->device, &info, cmd);
    if (r) return masu_headless_fail(error, size, "vkAllocateCommandBuffers", r);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    r = vkBeginCommandBuffer(*cmd, &begin);
    return r ? masu_headless_fail(error, size, "vkBeginCommandBuffer", r) : true;
}

static VkBufferImageCopy whole(uint32_t width, uint32_t height) {
    return (VkBufferImageCopy){.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                               .imageExtent = {width, height, 1}};
}

/* ---- Target ---------------------------------------------------------------------------------- */

/* Recorded once, so that reading a frame allocates and records nothing. */
static bool record_copy(masu_headless *host, masu_headless_target *t, char *error, size_t size) {
    if (!begin_commands(host, &t->copy, error, size)) return false;
    VkMemoryBarrier before = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                              .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                              .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT};
    vkCmdPipelineBarrier(t->copy, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &before, 0, NULL, 0, NULL);
    VkBufferImageCopy copy = whole(t->width, t->height);
    vkCmdCopyImageToBuffer(t->copy, t->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           t->buffer.buffer, 1, &copy);
    VkMemoryBarrier after = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                             .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(t->copy, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &after, 0, NULL, 0, NULL);
    VkResult r = vkEndCommandBuffer(t->copy);
    return r ? masu_headless_fail(error, size, "vkEndCommandBuffer", r) : true;
}

static uint64_t texel_bytes(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R5G6B5_UNORM_PACK16:
    case VK_FORMAT_B5G6R5_UNORM_PACK16: return 2;
    case VK_FORMAT_R16G16B16A16_UNORM:
    case VK_FORMAT_R16G16B16A16_SFLOAT: return 8;
    default: return 4;
    }
}

bool masu_headless_target_create(masu_headless *host, uint32_t width, uint32_t height,
                                 VkFormat format, bool storage, masu_headless_target *t,
                                 char *error, size_t error_size) {
    memset(t, 0, sizeof *t);
    t->width = width;
    t->height = height;
    VkImageUsageFlags usage =
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
        VK_IMAGE_USAGE_TRANSFER_DST_BIT |
        (storage ? VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT
                 : 0);
    if (!make_image(host, width, height, format, usage, &t->image, &t->view, &t->memory, error,
                    error_size) ||
        !masu_headless_buffer_create(host, texel_bytes(format) * width * height,
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT, &t->buffer, error,
                                     error_size) ||
        !record_copy(host, t, error, error_size)) {
        masu_headless_target_destroy(host, t);
        return false;
    }
    t->mapped = t->buffer.mapped;
    return true;
}

bool masu_headless_target_read(masu_headless *host, masu_headless_target *t, char *error,
                               size_t error_size) {
    return masu_headless_run(host, t->copy, error, error_size);
}

void masu_headless_target_destroy(masu_headless *host, masu_headless_target *t) {
    if (!host->device) return;
    if (t->copy) vkFreeCommandBuffers(host->device, host->pool, 1, &t->copy);
    masu_headless_buffer_destroy(host, &t->buffer);
    vkDestroyImageView(host->device, t->view, host->desc.allocator);
    vkDestroyImage(host->device, t->image, host->desc.allocator);
    vkFreeMemory(host->device, t->memory, host->desc.allocator);
    memset(t, 0, sizeof *t);
}

/* ---- Source ---------------------------------------------------------------------------------- */

static bool upload(masu_headless *host, VkImage image, VkBuffer buffer, uint32_t width,
                   uint32_t height, char *error, size_t size) {
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    if (!begin_commands(host, &cmd, error, size)) return false;
    VkImageMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                              .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                              .newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                              .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .image = image,
                              .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                         0, NULL, 0, NULL, 1, &b);
    VkBufferImageCopy copy = whole(width, height);
    vkCmdCopyBufferToImage(cmd, buffer, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    b.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    b.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
    b.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    b.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0,
                         0, NULL, 0, NULL, 1, &b);
    VkResult r = vkEndCommandBuffer(cmd);
    bool done = r ? masu_headless_fail(error, size, "vkEndCommandBuffer", r)
                  : masu_headless_run(host, cmd, error, size);
    vkFreeCommandBuffers(host->device, host->pool, 1, &cmd);
    return done;
}

bool masu_headless_source_create(masu_headless *host, const uint8_t *rgba, uint32_t width,
                                 uint32_t height, uint32_t image_width, uint32_t image_height,
                                 uint32_t beyond, masu_headless_source *source, char *error,
                                 size_t error_size) {
    return masu_headless_source_of(host, VK_FORMAT_R8G8B8A8_UNORM, rgba, width, height, image_width,
                                   image_height, beyond, source, error, error_size);
}

bool masu_headless_source_of(masu_headless *host, VkFormat format, const void *texels,
                             uint32_t width, uint32_t height, uint32_t image_width,
                             uint32_t image_height, uint32_t beyond, masu_headless_source *source,
                             char *error, size_t error_size) {
    size_t texel = (size_t)texel_bytes(format);
    uint64_t bytes = (uint64_t)texel * image_width * image_height;
    memset(source, 0, sizeof *source);
    masu_headless_buffer buffer;
    memset(&buffer, 0, sizeof buffer);
    bool made =
        make_image(host, image_width, image_height, format,
                   VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, &source->image,
                   &source->view, &source->memory, error, error_size) &&
        masu_headless_buffer_create(host, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, &buffer, error,
                                    error_size);
    if (made) {
        uint8_t *to = buffer.mapped;
        for (uint64_t i = 0; i < bytes / 4; i++) memcpy(to + 4 * i, &beyond, 4);
        for (uint32_t y = 0; y < height; y++) {
            memcpy(to + texel * image_width * y, (const uint8_t *)texels + texel * width * y,
                   texel * width);
        }
        made = upload(host, source->image, buffer.buffer, image_width, image_height, error,
                      error_size);
    }
    masu_headless_buffer_destroy(host, &buffer);
    if (!made) masu_headless_source_destroy(host, source);
    return made;
}

void masu_headless_source_destroy(masu_headless *host, masu_headless_source *source) {
    if (!host->device) return;
    vkDestroyImageView(host->device, source->view, host->desc.allocator);
    vkDestroyImage(host->device, source->image, host->desc.allocator);
    vkFreeMemory(host->device, source->memory, host->desc.allocator);
    memset(source, 0, sizeof *source);
}
