/* upscale.c: see upscale.h. */
#include "lab/study/upscale.h"

#include "clock.h"
#include "plan/push.h"

#include <string.h>

#define CHECK(call)                                                                                \
    do {                                                                                           \
        VkResult r = (call);                                                                       \
        if (r != VK_SUCCESS) return masu_headless_fail(error, error_size, #call, r);               \
    } while (0)

#define COUNTER_BYTES (2 * MASU_COUNTER_COUNT * sizeof(uint32_t))

static bool make_layouts(masu_bench_chain *c, char *error, size_t error_size) {
    VkDevice device = c->host->device;
    VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    CHECK(vkCreateSampler(device, &sampler, NULL, &c->sampler));
    const VkShaderStageFlags compute = VK_SHADER_STAGE_COMPUTE_BIT;
    VkDescriptorSetLayoutBinding counters = {MASU_BIND_COUNTERS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                             1, compute, NULL};
    VkDescriptorSetLayoutBinding images[2] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, compute, &c->sampler},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1, compute, NULL}};
    VkDescriptorSetLayoutCreateInfo set = {.sType =
                                               VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                           .bindingCount = 1,
                                           .pBindings = &counters};
    CHECK(vkCreateDescriptorSetLayout(device, &set, NULL, &c->empty));
    set.bindingCount = 2;
    set.pBindings = images;
    CHECK(vkCreateDescriptorSetLayout(device, &set, NULL, &c->images));
    VkDescriptorSetLayout both[2] = {c->empty, c->images};
    VkPushConstantRange range = {compute, 0, sizeof(masu_push_block)};
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount = 2,
                                         .pSetLayouts = both,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &range};
    CHECK(vkCreatePipelineLayout(device, &layout, NULL, &c->layout));
    return true;
}

static bool make_pipeline(masu_bench_chain *c, const masu_bench_stage *stage, bool counting,
                          VkPipeline *pipeline, char *error, size_t error_size) {
    VkDevice device = c->host->device;
    VkShaderModuleCreateInfo code = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = stage->bytes,
                                     .pCode = stage->words};
    VkShaderModule module;
    VkBool32 constant = counting;
    VkSpecializationMapEntry entry = {0, 0, sizeof constant};
    VkSpecializationInfo special = {1, &entry, sizeof constant, &constant};
    CHECK(vkCreateShaderModule(device, &code, NULL, &module));
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &special},
        .layout = c->layout};
    VkResult r = vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, NULL, pipeline);
    vkDestroyShaderModule(device, module, NULL);
    return r == VK_SUCCESS || masu_headless_fail(error, error_size, "vkCreateComputePipelines", r);
}

static bool make_sets(masu_bench_chain *c, uint32_t stages, const VkDescriptorImageInfo reads[],
                      const VkDescriptorImageInfo writes[], char *error, size_t error_size) {
    VkDevice device = c->host->device;
    VkDescriptorPoolSize sizes[3] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1},
                                     {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, MASU_BENCH_STAGES},
                                     {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, MASU_BENCH_STAGES}};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = 1 + MASU_BENCH_STAGES,
                                       .poolSizeCount = 3,
                                       .pPoolSizes = sizes};
    CHECK(vkCreateDescriptorPool(device, &pool, NULL, &c->pool));
    VkDescriptorSetAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorPool = c->pool,
                                            .descriptorSetCount = 1,
                                            .pSetLayouts = &c->empty};
    CHECK(vkAllocateDescriptorSets(device, &allocate, &c->counters_set));
    VkDescriptorBufferInfo buffer = {c->counters.buffer, 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = c->counters_set,
                                  .dstBinding = MASU_BIND_COUNTERS,
                                  .descriptorCount = 1,
                                  .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                  .pBufferInfo = &buffer};
    vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    allocate.pSetLayouts = &c->images;
    for (uint32_t i = 0; i < stages; i++) {
        CHECK(vkAllocateDescriptorSets(device, &allocate, &c->sets[i]));
        for (uint32_t binding = 0; binding < 2; binding++) {
            write = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                           .dstSet = c->sets[i],
                                           .dstBinding = binding,
                                           .descriptorCount = 1,
                                           .descriptorType =
                                               binding ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                                                       : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                           .pImageInfo = binding ? &writes[i] : &reads[i]};
            vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
        }
    }
    return true;
}

static void to_layout(VkCommandBuffer cmd, VkImage image, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                              .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                              .dstAccessMask =
                                  VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                              .oldLayout = from,
                              .newLayout = to,
                              .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .image = image,
                              .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &b);
}

static bool record(masu_bench_chain *c, const masu_bench_stage *stages, uint32_t count,
                   VkExtent2D from, const masu_headless_target *target, char *error,
                   size_t error_size) {
    VkDevice device = c->host->device;
    VkQueryPoolCreateInfo queries = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                     .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                     .queryCount = 2};
    CHECK(vkCreateQueryPool(device, &queries, NULL, &c->queries));
    VkCommandBufferAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                            .commandPool = c->host->pool,
                                            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                            .commandBufferCount = 1};
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    CHECK(vkAllocateCommandBuffers(device, &allocate, &c->commands));
    VkCommandBuffer cmd = c->commands;
    CHECK(vkBeginCommandBuffer(cmd, &begin));
    vkCmdResetQueryPool(cmd, c->queries, 0, 2);
    to_layout(cmd, target->image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    if (count > 1)
        to_layout(cmd, c->middle.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, c->queries, 0);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, c->layout, MASU_SET_GLOBAL, 1,
                            &c->counters_set, 0, NULL);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t block = stages[i].block ? stages[i].block : MASU_GROUP;
        masu_push_block push = {.sizes = {.render_width = i ? target->width : from.width,
                                          .render_height = i ? target->height : from.height,
                                          .output_width = target->width,
                                          .output_height = target->height}};
        struct masu_push_rcas rcas = {stages[i].lobe, 1.0f / stages[i].lobe, target->width - 1,
                                      target->height - 1};
        struct masu_push_easu easu = {
            (float)push.sizes.render_width * (1.0f / (float)target->width),
            (float)push.sizes.render_height * (1.0f / (float)target->height)};
        if (i) memcpy(&push.own, &rcas, sizeof rcas);
        else memcpy(&push.own, &easu, sizeof easu);
        if (i) to_layout(cmd, c->middle.image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, c->pipelines[i]);
        vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, c->layout, MASU_SET_PASS, 1,
                                &c->sets[i], 0, NULL);
        vkCmdPushConstants(cmd, c->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
        vkCmdDispatch(cmd, (target->width + block - 1) / block,
                      (target->height + block - 1) / block, 1);
    }
    to_layout(cmd, target->image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, c->queries, 1);
    CHECK(vkEndCommandBuffer(cmd));
    return true;
}

static bool build(masu_bench_chain *c, const masu_bench_stage *stages,
                  const masu_headless_source *source, VkExtent2D from,
                  const masu_headless_target *target, bool counting, char *error,
                  size_t error_size) {
    uint32_t count = 0;
    while (count < MASU_BENCH_STAGES && stages[count].words) count++;
    if (count > 1 &&
        !masu_headless_target_create(c->host, target->width, target->height,
                                     VK_FORMAT_R8G8B8A8_UNORM, true, &c->middle, error, error_size))
        return false;
    if (!masu_headless_buffer_create(c->host, COUNTER_BYTES, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                     &c->counters, error, error_size) ||
        !make_layouts(c, error, error_size)) {
        return false;
    }
    VkDescriptorImageInfo reads[MASU_BENCH_STAGES], writes[MASU_BENCH_STAGES];
    for (uint32_t i = 0; i < count; i++) {
        if (!make_pipeline(c, &stages[i], counting, &c->pipelines[i], error, error_size))
            return false;
        reads[i] = (VkDescriptorImageInfo){c->sampler, i ? c->middle.view : source->view,
                                           i ? VK_IMAGE_LAYOUT_GENERAL
                                             : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        writes[i] = (VkDescriptorImageInfo){
            VK_NULL_HANDLE, i + 1 < count ? c->middle.view : target->view, VK_IMAGE_LAYOUT_GENERAL};
    }
    return make_sets(c, count, reads, writes, error, error_size) &&
           record(c, stages, count, from, target, error, error_size);
}

bool masu_bench_chain_open(masu_headless *host, const masu_bench_stage stages[MASU_BENCH_STAGES],
                           const masu_headless_source *source, VkExtent2D from,
                           const masu_headless_target *target, bool counting,
                           masu_bench_chain *chain, char *error, size_t error_size) {
    *chain = (masu_bench_chain){.host = host};
    if (build(chain, stages, source, from, target, counting, error, error_size)) return true;
    masu_bench_chain_close(chain);
    return false;
}

void masu_bench_chain_close(masu_bench_chain *c) {
    if (!c->host) return;
    VkDevice device = c->host->device;
    masu_headless_settle(c->host);
    if (c->commands) vkFreeCommandBuffers(device, c->host->pool, 1, &c->commands);
    vkDestroyQueryPool(device, c->queries, NULL);
    vkDestroyDescriptorPool(device, c->pool, NULL);
    for (uint32_t i = 0; i < MASU_BENCH_STAGES; i++)
        vkDestroyPipeline(device, c->pipelines[i], NULL);
    vkDestroyPipelineLayout(device, c->layout, NULL);
    vkDestroyDescriptorSetLayout(device, c->images, NULL);
    vkDestroyDescriptorSetLayout(device, c->empty, NULL);
    vkDestroySampler(device, c->sampler, NULL);
    masu_headless_buffer_destroy(c->host, &c->counters);
    if (c->middle.image) masu_headless_target_destroy(c->host, &c->middle);
    memset(c, 0, sizeof *c);
}

bool masu_bench_chain_run(masu_bench_chain *c, double *wall, double *gpu, char *error,
                          size_t error_size) {
    uint64_t stamps[2] = {0, 0};
    memset(c->counters.mapped, 0, COUNTER_BYTES);
    uint64_t from = masu_clock_ns(NULL);
    if (!masu_headless_run(c->host, c->commands, error, error_size)) return false;
    *wall = (double)(masu_clock_ns(NULL) - from) * 1e-9;
    VkResult r = vkGetQueryPoolResults(c->host->device, c->queries, 0, 2, sizeof stamps, stamps,
                                       sizeof *stamps, VK_QUERY_RESULT_64_BIT);
    *gpu = r ? 0
             : (double)(stamps[1] - stamps[0]) *
                   (double)c->host->properties.limits.timestampPeriod * 1e-9;
    return true;
}

uint64_t masu_bench_chain_count(const masu_bench_chain *c, uint32_t counter) {
    const uint32_t *counted = c->counters.mapped; /* pairs: low 32 bits, high 32 bits */
    return counted[2 * counter] | (uint64_t)counted[2 * counter + 1] << 32;
}
