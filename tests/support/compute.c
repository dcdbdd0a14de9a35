/* compute.c: see compute.h. */
#include "support/compute.h"

#include "headless.h"
#include "support/support.h"

#include <string.h>

#define assert_vk(call) assert_int_equal(call, VK_SUCCESS)

typedef struct bound {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} bound;

static uint32_t host_visible(const masu_headless *host, uint32_t types) {
    VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (uint32_t i = 0; i < host->memory.memoryTypeCount; i++) {
        if (!(types & 1u << i)) continue;
        if ((host->memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    }
    fail_msg("no memory type that the host sees");
    return 0;
}

static bound bind(const masu_headless *host, const compute_buffer *b) {
    bound out;
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = b->bytes,
                               .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    assert_vk(vkCreateBuffer(host->device, &info, NULL, &out.buffer));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(host->device, out.buffer, &needs);
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = needs.size,
                                     .memoryTypeIndex = host_visible(host, needs.memoryTypeBits)};
    assert_vk(vkAllocateMemory(host->device, &allocate, NULL, &out.memory));
    assert_vk(vkBindBufferMemory(host->device, out.buffer, out.memory, 0));
    assert_vk(vkMapMemory(host->device, out.memory, 0, VK_WHOLE_SIZE, 0, &out.mapped));
    memcpy(out.mapped, b->data, b->bytes);
    return out;
}

static VkCommandBuffer record(const masu_headless *host, VkPipelineLayout layout,
                              VkPipeline pipeline, VkDescriptorSet set, const uint32_t push[4],
                              uint32_t groups) {
    VkCommandBuffer cmd;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = host->pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    assert_vk(vkAllocateCommandBuffers(host->device, &info, &cmd));
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    assert_vk(vkBeginCommandBuffer(cmd, &begin));
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, 1, &set, 0, NULL);
    vkCmdPushConstants(cmd, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, 16, push);
    vkCmdDispatch(cmd, groups, 1, 1);
    VkMemoryBarrier done = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                            .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                            .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0,
                         1, &done, 0, NULL, 0, NULL);
    assert_vk(vkEndCommandBuffer(cmd));
    return cmd;
}

void compute_run(const uint32_t *spirv, size_t spirv_bytes, const compute_buffer *buffers,
                 uint32_t count, const uint32_t push[4], uint32_t groups) {
    char error[ERROR_SIZE];
    masu_headless host;
    masu_headless_desc desc = test_desc(NULL, 1, 1).host;
    assert_ok(masu_headless_open(&desc, &host, error, sizeof error));
    assert_true(host.validating);
    assert_true(count <= COMPUTE_BUFFERS_MAX);

    bound bounds[COMPUTE_BUFFERS_MAX];
    VkDescriptorSetLayoutBinding bindings[COMPUTE_BUFFERS_MAX];
    for (uint32_t i = 0; i < count; i++) {
        bounds[i] = bind(&host, &buffers[i]);
        bindings[i] =
            (VkDescriptorSetLayoutBinding){.binding = buffers[i].binding,
                                           .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                           .descriptorCount = 1,
                                           .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    VkDescriptorSetLayout set_layout;
    VkDescriptorSetLayoutCreateInfo set_info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = count,
        .pBindings = bindings};
    assert_vk(vkCreateDescriptorSetLayout(host.device, &set_info, NULL, &set_layout));
    VkPipelineLayout layout;
    VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, 16};
    VkPipelineLayoutCreateInfo layout_info = {.sType =
                                                  VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                              .setLayoutCount = 1,
                                              .pSetLayouts = &set_layout,
                                              .pushConstantRangeCount = 1,
                                              .pPushConstantRanges = &range};
    assert_vk(vkCreatePipelineLayout(host.device, &layout_info, NULL, &layout));
    VkShaderModule module;
    VkShaderModuleCreateInfo module_info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = spirv_bytes,
                                            .pCode = spirv};
    assert_vk(vkCreateShaderModule(host.device, &module_info, NULL, &module));
    VkPipeline pipeline;
    VkComputePipelineCreateInfo pipeline_info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = layout};
    assert_vk(
        vkCreateComputePipelines(host.device, VK_NULL_HANDLE, 1, &pipeline_info, NULL, &pipeline));

    VkDescriptorPool pool;
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count};
    VkDescriptorPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .maxSets = 1,
                                            .poolSizeCount = 1,
                                            .pPoolSizes = &size};
    assert_vk(vkCreateDescriptorPool(host.device, &pool_info, NULL, &pool));
    VkDescriptorSet set;
    VkDescriptorSetAllocateInfo set_allocate = {.sType =
                                                    VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                                .descriptorPool = pool,
                                                .descriptorSetCount = 1,
                                                .pSetLayouts = &set_layout};
    assert_vk(vkAllocateDescriptorSets(host.device, &set_allocate, &set));
    for (uint32_t i = 0; i < count; i++) {
        VkDescriptorBufferInfo info = {bounds[i].buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                      .dstSet = set,
                                      .dstBinding = buffers[i].binding,
                                      .descriptorCount = 1,
                                      .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                      .pBufferInfo = &info};
        vkUpdateDescriptorSets(host.device, 1, &write, 0, NULL);
    }
    VkCommandBuffer cmd = record(&host, layout, pipeline, set, push, groups);
    assert_ok(masu_headless_run(&host, cmd, error, sizeof error));

    for (uint32_t i = 0; i < count; i++) {
        memcpy(buffers[i].data, bounds[i].mapped, buffers[i].bytes);
        vkDestroyBuffer(host.device, bounds[i].buffer, NULL);
        vkFreeMemory(host.device, bounds[i].memory, NULL);
    }
    vkDestroyDescriptorPool(host.device, pool, NULL);
    vkDestroyPipeline(host.device, pipeline, NULL);
    vkDestroyShaderModule(host.device, module, NULL);
    vkDestroyPipelineLayout(host.device, layout, NULL);
    vkDestroyDescriptorSetLayout(host.device, set_layout, NULL);
    masu_headless_close(&host);
    if (host.messages)
        fail_msg("%u validation messages, first: %s", host.messages, host.first_message);
}
