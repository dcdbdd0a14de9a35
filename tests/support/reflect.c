/* reflect.c: see reflect.h. Each run creates all objects and destroys them. */
#include "support/reflect.h"

#include "headless.h"
#include "plan/push.h"
#include "support/support.h"

#include <string.h>

#define assert_vk(call) assert_int_equal(call, VK_SUCCESS)
#define COUNT(array) (sizeof(array) / sizeof *(array))

enum { IMAGES = 3, BUFFERS = 6, STAGING = BUFFERS };

typedef struct bench {
    masu_headless host;
    VkBuffer buffer[BUFFERS + 1];
    VkDeviceMemory buffer_memory[BUFFERS + 1], image_memory[IMAGES];
    void *mapped[BUFFERS + 1];
    VkImage image[IMAGES];
    VkImageView view[IMAGES];
    VkSampler sampler;
    VkDescriptorSetLayout set_layout[2];
    VkDescriptorPool pool;
    VkDescriptorSet set[2];
    VkPipelineLayout layout;
    VkShaderModule module;
    VkPipeline pipeline;
} bench;

static const VkFormat formats[IMAGES] = {VK_FORMAT_R32G32_UINT, VK_FORMAT_R32G32_UINT,
                                         VK_FORMAT_R32G32B32A32_UINT};
static const VkDeviceSize texel_bytes[IMAGES] = {8, 8, 16};

static VkDeviceMemory memory_for(const bench *b, VkMemoryRequirements needs,
                                 VkMemoryPropertyFlags wanted) {
    for (uint32_t i = 0; i < b->host.memory.memoryTypeCount; i++) {
        if (!(needs.memoryTypeBits & 1u << i)) continue;
        if ((b->host.memory.memoryTypes[i].propertyFlags & wanted) != wanted) continue;
        VkDeviceMemory memory;
        VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = needs.size,
                                     .memoryTypeIndex = i};
        assert_vk(vkAllocateMemory(b->host.device, &info, NULL, &memory));
        return memory;
    }
    fail_msg("no memory type");
    return VK_NULL_HANDLE;
}

static void make_buffer(bench *b, uint32_t i, size_t bytes, VkBufferUsageFlags usage,
                        const void *data) {
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
    assert_vk(vkCreateBuffer(b->host.device, &info, NULL, &b->buffer[i]));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(b->host.device, b->buffer[i], &needs);
    b->buffer_memory[i] = memory_for(
        b, needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    assert_vk(vkBindBufferMemory(b->host.device, b->buffer[i], b->buffer_memory[i], 0));
    assert_vk(vkMapMemory(b->host.device, b->buffer_memory[i], 0, VK_WHOLE_SIZE, 0, &b->mapped[i]));
    if (data)
        memcpy(b->mapped[i], data, bytes);
    else
        memset(b->mapped[i], 0, bytes);
}

static void make_image(bench *b, uint32_t i, uint32_t width, uint32_t height) {
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = formats[i],
                              .extent = {width, height, 1},
                              .mipLevels = 1,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
                                       VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                       VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    assert_vk(vkCreateImage(b->host.device, &info, NULL, &b->image[i]));
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(b->host.device, b->image[i], &needs);
    b->image_memory[i] = memory_for(b, needs, 0);
    assert_vk(vkBindImageMemory(b->host.device, b->image[i], b->image_memory[i], 0));
    VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                  .image = b->image[i],
                                  .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                  .format = formats[i],
                                  .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    assert_vk(vkCreateImageView(b->host.device, &view, NULL, &b->view[i]));
}

/* Bindings of set 0, in the order of bench.buffer, and whether each is a uniform buffer. */
static const struct {
    uint32_t binding;
    VkDescriptorType type;
} globals[BUFFERS] = {{MASU_BIND_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
                      {MASU_BIND_PREVIOUS, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
                      {MASU_BIND_COUNTERS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                      {MASU_BIND_TILES, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                      {MASU_BIND_SLOTS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                      {MASU_BIND_SPECULAR_TILES, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER}};

static void make_sets(bench *b) {
    VkDescriptorSetLayoutBinding first[BUFFERS], second[IMAGES];
    for (uint32_t i = 0; i < BUFFERS; i++)
        first[i] = (VkDescriptorSetLayoutBinding){globals[i].binding, globals[i].type, 1,
                                                  VK_SHADER_STAGE_COMPUTE_BIT, NULL};
    for (uint32_t i = 0; i < IMAGES; i++)
        second[i] = (VkDescriptorSetLayoutBinding){
            i, i < 2 ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
            1, VK_SHADER_STAGE_COMPUTE_BIT, NULL};
    VkDescriptorSetLayoutCreateInfo infos[2] = {
        {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
         .bindingCount = BUFFERS,
         .pBindings = first},
        {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
         .bindingCount = IMAGES,
         .pBindings = second}};
    for (int i = 0; i < 2; i++)
        assert_vk(vkCreateDescriptorSetLayout(b->host.device, &infos[i], NULL, &b->set_layout[i]));
    VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 2},
                                    {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BUFFERS - 2},
                                    {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2},
                                    {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1}};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = 2,
                                       .poolSizeCount = COUNT(sizes),
                                       .pPoolSizes = sizes};
    assert_vk(vkCreateDescriptorPool(b->host.device, &pool, NULL, &b->pool));
    VkDescriptorSetAllocateInfo sets = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                        .descriptorPool = b->pool,
                                        .descriptorSetCount = 2,
                                        .pSetLayouts = b->set_layout};
    assert_vk(vkAllocateDescriptorSets(b->host.device, &sets, b->set));
    for (uint32_t i = 0; i < BUFFERS + IMAGES; i++) {
        uint32_t k = i < BUFFERS ? i : i - BUFFERS;
        VkDescriptorBufferInfo buffer = {b->buffer[k], 0, VK_WHOLE_SIZE};
        VkDescriptorImageInfo image = {b->sampler, b->view[k < IMAGES ? k : 0],
                                       VK_IMAGE_LAYOUT_GENERAL};
        VkWriteDescriptorSet write = {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = b->set[i < BUFFERS ? 0 : 1],
            .dstBinding = i < BUFFERS ? globals[k].binding : k,
            .descriptorCount = 1,
            .descriptorType = i < BUFFERS ? globals[k].type : second[k].descriptorType,
            .pBufferInfo = i < BUFFERS ? &buffer : NULL,
            .pImageInfo = i < BUFFERS ? NULL : &image};
        vkUpdateDescriptorSets(b->host.device, 1, &write, 0, NULL);
    }
}

static void make_pipeline(bench *b, const reflect_job *job) {
    VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(masu_push_block)};
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount = 2,
                                         .pSetLayouts = b->set_layout,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &range};
    assert_vk(vkCreatePipelineLayout(b->host.device, &layout, NULL, &b->layout));
    VkShaderModuleCreateInfo module = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                       .codeSize = 4 * job->words,
                                       .pCode = job->spirv};
    assert_vk(vkCreateShaderModule(b->host.device, &module, NULL, &b->module));
    const VkBool32 counting = VK_TRUE;
    VkSpecializationMapEntry entry = {0, 0, sizeof counting};
    VkSpecializationInfo special = {1, &entry, sizeof counting, &counting};
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = b->module,
                  .pName = "main",
                  .pSpecializationInfo = &special},
        .layout = b->layout};
    assert_vk(
        vkCreateComputePipelines(b->host.device, VK_NULL_HANDLE, 1, &info, NULL, &b->pipeline));
}

static void barrier(VkCommandBuffer cmd, const bench *b, VkImageLayout from) {
    VkImageMemoryBarrier images[IMAGES];
    for (uint32_t i = 0; i < IMAGES; i++)
        images[i] = (VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .srcAccessMask = from ? VK_ACCESS_MEMORY_WRITE_BIT : 0,
            .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
            .oldLayout = from,
            .newLayout = VK_IMAGE_LAYOUT_GENERAL,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = b->image[i],
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, IMAGES, images);
}

static void run(bench *b, const reflect_job *job, const VkDeviceSize at[IMAGES]) {
    char error[ERROR_SIZE];
    VkCommandBuffer cmd;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = b->host.pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    assert_vk(vkAllocateCommandBuffers(b->host.device, &info, &cmd));
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    assert_vk(vkBeginCommandBuffer(cmd, &begin));
    barrier(cmd, b, VK_IMAGE_LAYOUT_UNDEFINED);
    VkBufferImageCopy copy[IMAGES];
    for (uint32_t i = 0; i < IMAGES; i++) {
        copy[i] = (VkBufferImageCopy){.bufferOffset = at[i],
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {job->width, job->height, 1}};
        vkCmdCopyBufferToImage(cmd, b->buffer[STAGING], b->image[i], VK_IMAGE_LAYOUT_GENERAL, 1,
                               &copy[i]);
    }
    barrier(cmd, b, VK_IMAGE_LAYOUT_GENERAL);
    masu_push_block push = {.sizes = {.render_width = 2 * job->width,
                                      .render_height = 2 * job->height,
                                      .output_width = job->width,
                                      .output_height = job->height}};
    struct masu_push_specular_trace_sdf own = {
        .steps = job->steps, .traced_size = 2};
    memcpy(&push.own, &own, sizeof own);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, b->pipeline);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, b->layout, 0, 2, b->set, 0, NULL);
    vkCmdPushConstants(cmd, b->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    vkCmdDispatch(cmd, job->width / MASU_GROUP * (job->height / MASU_GROUP), 1, 1);
    barrier(cmd, b, VK_IMAGE_LAYOUT_GENERAL);
    vkCmdCopyImageToBuffer(cmd, b->image[2], VK_IMAGE_LAYOUT_GENERAL, b->buffer[STAGING], 1,
                           &copy[2]);
    VkMemoryBarrier done = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                            .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                            .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &done, 0, NULL, 0, NULL);
    assert_vk(vkEndCommandBuffer(cmd));
    assert_ok(masu_headless_run(&b->host, cmd, error, sizeof error));
}

static void close(bench *b) {
    VkDevice device = b->host.device;
    for (uint32_t i = 0; i < BUFFERS + 1; i++) {
        vkDestroyBuffer(device, b->buffer[i], NULL);
        vkFreeMemory(device, b->buffer_memory[i], NULL);
    }
    for (uint32_t i = 0; i < IMAGES; i++) {
        vkDestroyImageView(device, b->view[i], NULL);
        vkDestroyImage(device, b->image[i], NULL);
        vkFreeMemory(device, b->image_memory[i], NULL);
    }
    vkDestroySampler(device, b->sampler, NULL);
    vkDestroyDescriptorPool(device, b->pool, NULL);
    vkDestroyPipeline(device, b->pipeline, NULL);
    vkDestroyShaderModule(device, b->module, NULL);
    vkDestroyPipelineLayout(device, b->layout, NULL);
    for (int i = 0; i < 2; i++) vkDestroyDescriptorSetLayout(device, b->set_layout[i], NULL);
    masu_headless_close(&b->host);
    if (b->host.messages)
        fail_msg("%u validation messages, first: %s", b->host.messages, b->host.first_message);
}

static uint64_t counter(const bench *b, uint32_t i) {
    const uint32_t *words = b->mapped[2];
    return words[2 * i] | (uint64_t)words[2 * i + 1] << 32;
}

void reflect_run(reflect_job *job) {
    static bench b;
    char error[ERROR_SIZE];
    memset(&b, 0, sizeof b);
    masu_headless_desc desc = test_desc(NULL, 1, 1).host;
    assert_ok(masu_headless_open(&desc, &b.host, error, sizeof error));
    assert_true(b.host.validating);
    VkDeviceSize pixels = (VkDeviceSize)job->width * job->height, at[IMAGES], bytes = 0;
    const void *from[IMAGES] = {job->guide, job->ray, job->hit};
    for (uint32_t i = 0; i < IMAGES; i++) {
        at[i] = bytes;
        bytes += pixels * texel_bytes[i];
        make_image(&b, i, job->width, job->height);
    }
    uint32_t tiles[MASU_TILES_HEADER + 1024] = {0}, count = (uint32_t)(pixels / 64);
    assert_true(count <= 1024);
    for (uint32_t i = 0; i < count; i++) tiles[MASU_TILES_HEADER + i] = count - 1 - i;
    VkBufferUsageFlags storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    for (uint32_t i = 0; i < 2; i++)
        make_buffer(&b, i, sizeof job->frame, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, &job->frame);
    make_buffer(&b, 2, 8 * MASU_COUNTER_COUNT, storage, NULL);
    make_buffer(&b, 3, 64, storage, NULL);
    make_buffer(&b, 4, job->slot_count * sizeof(float), storage, job->slots);
    make_buffer(&b, 5, sizeof tiles, storage, tiles);
    make_buffer(&b, STAGING, (size_t)bytes,
                VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, NULL);
    for (uint32_t i = 0; i < IMAGES; i++)
        memcpy((char *)b.mapped[STAGING] + at[i], from[i], (size_t)(pixels * texel_bytes[i]));
    VkSamplerCreateInfo nearest = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    assert_vk(vkCreateSampler(b.host.device, &nearest, NULL, &b.sampler));
    make_sets(&b);
    make_pipeline(&b, job);
    run(&b, job, at);
    memcpy(job->hit, (char *)b.mapped[STAGING] + at[2], (size_t)(pixels * texel_bytes[2]));
    job->evals = counter(&b, MASU_COUNTER_SPECULAR_EVALS);
    job->sdf_hits = counter(&b, MASU_COUNTER_SPECULAR_SDF_HITS);
    job->unconverged = counter(&b, MASU_COUNTER_SDF_UNCONVERGED);
    close(&b);
}
