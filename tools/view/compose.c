/* compose.c: see compose.h. */
#include "view/compose.h"

#include "compose_comp.spv.h"
#include "view/ui.h"

#include <stdio.h>
#include <string.h>

enum { BINDINGS = 4, TILE = 8 };

typedef struct masu_compose_push {
    int32_t width, height, split, map;
} masu_compose_push;

/* ---- Once per device ------------------------------------------------------------------------- */

static VkResult make_layouts(masu_compose *c) {
    VkDescriptorSetLayoutBinding bindings[BINDINGS];
    for (uint32_t i = 0; i < BINDINGS; i++) {
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType =
                i < 3 ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    VkDescriptorSetLayoutCreateInfo set = {.sType =
                                               VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                           .bindingCount = BINDINGS,
                                           .pBindings = bindings};
    VkResult r = vkCreateDescriptorSetLayout(c->host->device, &set, NULL, &c->set_layout);
    if (r) return r;
    VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(masu_compose_push)};
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount = 1,
                                         .pSetLayouts = &c->set_layout,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &range};
    return vkCreatePipelineLayout(c->host->device, &layout, NULL, &c->layout);
}

static VkResult make_pipeline(masu_compose *c, VkPipelineCache cache) {
    VkShaderModuleCreateInfo code = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = sizeof masu_spv_compose_comp,
                                     .pCode = masu_spv_compose_comp};
    VkShaderModule module;
    VkResult r = vkCreateShaderModule(c->host->device, &code, NULL, &module);
    if (r) return r;
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = c->layout};
    r = vkCreateComputePipelines(c->host->device, cache, 1, &info, NULL, &c->pipeline);
    vkDestroyShaderModule(c->host->device, module, NULL);
    return r;
}

static VkResult make_sets(masu_compose *c) {
    VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 3 * MASU_WINDOW_FLIGHT},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, (BINDINGS - 3) * MASU_WINDOW_FLIGHT}};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = MASU_WINDOW_FLIGHT,
                                       .poolSizeCount = 2,
                                       .pPoolSizes = sizes};
    VkResult r = vkCreateDescriptorPool(c->host->device, &pool, NULL, &c->pool);
    VkDescriptorSetLayout layouts[MASU_WINDOW_FLIGHT];
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++) layouts[i] = c->set_layout;
    VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                        .descriptorPool = c->pool,
                                        .descriptorSetCount = MASU_WINDOW_FLIGHT,
                                        .pSetLayouts = layouts};
    return r ? r : vkAllocateDescriptorSets(c->host->device, &info, c->sets);
}

/* The headless host's pool does not allow resets: command buffers are freed and allocated in each
 * frame. */
bool masu_compose_open(masu_compose *c, masu_headless *host, VkPipelineCache cache, char *error,
                       size_t size) {
    memset(c, 0, sizeof *c);
    c->host = host;
    VkResult r = make_layouts(c);
    if (!r) r = make_pipeline(c, cache);
    if (!r) r = make_sets(c);
    return r ? masu_headless_fail(error, size, "the pipeline of the window", r) : true;
}

/* ---- Once per size --------------------------------------------------------------------------- */

static void drop_size(masu_compose *c) {
    masu_headless_buffer_destroy(c->host, &c->map);
    masu_headless_target_destroy(c->host, &c->shown);
}

bool masu_compose_resize(masu_compose *c, VkExtent2D output, char *error, size_t size) {
    uint64_t bytes = (uint64_t)4 * output.width * output.height;
    drop_size(c);
    if (!masu_headless_buffer_create(c->host, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &c->map,
                                     error, size)) {
        return false;
    }
    memset(c->map.mapped, 0, (size_t)bytes);
    return masu_headless_target_create(c->host, output.width, output.height,
                                       VK_FORMAT_R8G8B8A8_UNORM, true, &c->shown, error, size);
}

void masu_compose_close(masu_compose *c) {
    if (!c->host) return;
    VkDevice d = c->host->device;
    drop_size(c);
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++) {
        if (c->commands[i]) vkFreeCommandBuffers(d, c->host->pool, 1, &c->commands[i]);
    }
    vkDestroyDescriptorPool(d, c->pool, NULL);
    vkDestroyPipeline(d, c->pipeline, NULL);
    vkDestroyPipelineLayout(d, c->layout, NULL);
    vkDestroyDescriptorSetLayout(d, c->set_layout, NULL);
    memset(c, 0, sizeof *c);
}

/* ---- Once per frame -------------------------------------------------------------------------- */

static void write_set(masu_compose *c, uint32_t slot, const masu_composition *what) {
    const masu_headless_target *b = what->b ? what->b : what->a;
    VkDescriptorImageInfo images[3] = {
        {.imageView = what->a->view, .imageLayout = VK_IMAGE_LAYOUT_GENERAL},
        {.imageView = b->view, .imageLayout = VK_IMAGE_LAYOUT_GENERAL},
        {.imageView = c->shown.view, .imageLayout = VK_IMAGE_LAYOUT_GENERAL}};
    VkDescriptorBufferInfo map = {c->map.buffer, 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet writes[BINDINGS];
    for (uint32_t i = 0; i < BINDINGS; i++) {
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = c->sets[slot],
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType =
                i < 3 ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            .pImageInfo = i < 3 ? &images[i] : NULL,
            .pBufferInfo = i < 3 ? NULL : &map};
    }
    vkUpdateDescriptorSets(c->host->device, BINDINGS, writes, 0, NULL);
}

static VkImageMemoryBarrier change(VkImage image, VkImageLayout from, VkImageLayout to,
                                   VkAccessFlags done, VkAccessFlags next) {
    return (VkImageMemoryBarrier){.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                  .srcAccessMask = done,
                                  .dstAccessMask = next,
                                  .oldLayout = from,
                                  .newLayout = to,
                                  .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                  .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                  .image = image,
                                  .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
}

/* The first barrier waits for all earlier commands: the library's frame, and the previous frame's
 * blit from `shown`. */
static void draw(masu_compose *c, VkCommandBuffer cmd, uint32_t slot,
                 const masu_composition *what) {
    const VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                        general = VK_IMAGE_LAYOUT_GENERAL;
    const VkAccessFlags written = VK_ACCESS_MEMORY_WRITE_BIT, read = VK_ACCESS_SHADER_READ_BIT;
    VkImageMemoryBarrier before[3] = {
        change(c->shown.image, VK_IMAGE_LAYOUT_UNDEFINED, general, 0, VK_ACCESS_SHADER_WRITE_BIT),
        change(what->a->image, source, general, written, read)};
    VkImageMemoryBarrier after[2] = {
        change(what->a->image, general, source, 0, VK_ACCESS_TRANSFER_READ_BIT)};
    uint32_t count = what->b ? 3 : 2;
    if (what->b) {
        before[2] = change(what->b->image, source, general, written, read);
        after[1] = change(what->b->image, general, source, 0, VK_ACCESS_TRANSFER_READ_BIT);
    }
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, NULL, 0, NULL, count, before);
    uint32_t width = c->shown.width, height = c->shown.height;
    masu_compose_push push = {(int32_t)width, (int32_t)height,
                              (int32_t)(what->b && what->split < width ? what->split : width),
                              what->map};
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, c->pipeline);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, c->layout, 0, 1, &c->sets[slot], 0,
                            NULL);
    vkCmdPushConstants(cmd, c->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    vkCmdDispatch(cmd, (width + TILE - 1) / TILE, (height + TILE - 1) / TILE, 1);
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         0, 0, NULL, 0, NULL, count - 1, after);
}

/* Without a renderer the window has one background colour. */
static void clear(masu_compose *c, VkCommandBuffer cmd) {
    const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
    const VkClearColorValue dark = {.float32 = {0.06f, 0.07f, 0.09f, 1.0f}};
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImageMemoryBarrier before =
        change(c->shown.image, VK_IMAGE_LAYOUT_UNDEFINED, general, 0, VK_ACCESS_TRANSFER_WRITE_BIT);
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                         0, NULL, 0, NULL, 1, &before);
    vkCmdClearColorImage(cmd, c->shown.image, general, &dark, 1, &all);
}

/* Transitions `shown` for the user interface, which leaves it ready for the blit. */
static void draw_ui(masu_compose *c, VkCommandBuffer cmd) {
    VkImageMemoryBarrier before =
        change(c->shown.image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
               VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
               VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT);
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, 0, 0, NULL, 0, NULL, 1,
                         &before);
    masu_ui_record(cmd);
}

/* The submit waits for the swapchain image at the transfer stage, as the first barrier does. */
static void show(masu_compose *c, VkCommandBuffer cmd, VkImage image, VkExtent2D extent) {
    const VkImageLayout to = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    VkImageMemoryBarrier before =
        change(image, VK_IMAGE_LAYOUT_UNDEFINED, to, 0, VK_ACCESS_TRANSFER_WRITE_BIT);
    VkImageMemoryBarrier after =
        change(image, to, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_ACCESS_TRANSFER_WRITE_BIT, 0);
    VkImageBlit blit = {
        .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .srcOffsets = {{0, 0, 0}, {(int32_t)c->shown.width, (int32_t)c->shown.height, 1}},
        .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .dstOffsets = {{0, 0, 0}, {(int32_t)extent.width, (int32_t)extent.height, 1}}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         NULL, 0, NULL, 1, &before);
    vkCmdBlitImage(cmd, c->shown.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image, to, 1, &blit,
                   VK_FILTER_NEAREST);
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                         0, 0, NULL, 0, NULL, 1, &after);
}

bool masu_compose_record(masu_compose *c, uint32_t slot, const masu_composition *what,
                         VkImage image, VkExtent2D extent, char *error, size_t size) {
    VkCommandBuffer *cmd = &c->commands[slot];
    if (*cmd) vkFreeCommandBuffers(c->host->device, c->host->pool, 1, cmd);
    *cmd = VK_NULL_HANDLE;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = c->host->pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    VkResult r = vkAllocateCommandBuffers(c->host->device, &info, cmd);
    if (r) return masu_headless_fail(error, size, "vkAllocateCommandBuffers", r);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    r = vkBeginCommandBuffer(*cmd, &begin);
    if (r) return masu_headless_fail(error, size, "vkBeginCommandBuffer", r);
    if (what->a) {
        write_set(c, slot, what);
        draw(c, *cmd, slot, what);
    } else {
        clear(c, *cmd);
    }
    draw_ui(c, *cmd);
    show(c, *cmd, image, extent);
    r = vkEndCommandBuffer(*cmd);
    return r ? masu_headless_fail(error, size, "vkEndCommandBuffer", r) : true;
}
