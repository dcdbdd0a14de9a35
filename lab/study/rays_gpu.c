/* rays_gpu.c: the compute program of rays.h. Its buffers are visible to the host: only the
 * traversal is measured, and a software driver has no others. */
#include "lab/study/rays.h"

#include "clock.h"
#include "scene/scene.h"
#include "trace_rays_comp.spv.h"
#include "trace_rays_counted_comp.spv.h"

#include <string.h>

enum { STATIC, FRAME, VERTICES, RAYS, HITS, BUFFERS };

#define CHECK(call)                                                                                \
    do {                                                                                           \
        VkResult r = (call);                                                                       \
        if (r != VK_SUCCESS) return masu_headless_fail(error, error_size, #call, r);               \
    } while (0)

static bool make_pipelines(masu_bench_gpu *g, char *error, size_t error_size) {
    VkDevice device = g->host->device;
    VkDescriptorSetLayoutBinding bindings[BUFFERS];
    for (uint32_t i = 0; i < BUFFERS; i++) {
        bindings[i] =
            (VkDescriptorSetLayoutBinding){.binding = i,
                                           .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                           .descriptorCount = 1,
                                           .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    VkDescriptorSetLayoutCreateInfo set = {.sType =
                                               VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                           .bindingCount = BUFFERS,
                                           .pBindings = bindings};
    CHECK(vkCreateDescriptorSetLayout(device, &set, NULL, &g->set_layout));
    VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, 16};
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount = 1,
                                         .pSetLayouts = &g->set_layout,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &range};
    CHECK(vkCreatePipelineLayout(device, &layout, NULL, &g->layout));
    for (uint32_t i = 0; i < 2; i++) {
        VkShaderModuleCreateInfo code = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                         .codeSize = i ? sizeof masu_spv_trace_rays_counted_comp
                                                       : sizeof masu_spv_trace_rays_comp,
                                         .pCode = i ? masu_spv_trace_rays_counted_comp
                                                    : masu_spv_trace_rays_comp};
        VkShaderModule module;
        CHECK(vkCreateShaderModule(device, &code, NULL, &module));
        VkComputePipelineCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                      .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                      .module = module,
                      .pName = "main"},
            .layout = g->layout};
        VkResult r =
            vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &g->pipeline[i]);
        vkDestroyShaderModule(device, module, NULL);
        if (r != VK_SUCCESS)
            return masu_headless_fail(error, error_size, "vkCreateComputePipelines", r);
    }
    return true;
}

static bool make_set(masu_bench_gpu *g, char *error, size_t error_size) {
    VkDevice device = g->host->device;
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BUFFERS};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = 1,
                                       .poolSizeCount = 1,
                                       .pPoolSizes = &size};
    CHECK(vkCreateDescriptorPool(device, &pool, NULL, &g->pool));
    VkDescriptorSetAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorPool = g->pool,
                                            .descriptorSetCount = 1,
                                            .pSetLayouts = &g->set_layout};
    CHECK(vkAllocateDescriptorSets(device, &allocate, &g->set));
    for (uint32_t i = 0; i < BUFFERS; i++) {
        VkDescriptorBufferInfo info = {g->buffer[i].buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                      .dstSet = g->set,
                                      .dstBinding = i,
                                      .descriptorCount = 1,
                                      .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                      .pBufferInfo = &info};
        vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    }
    return true;
}

bool masu_bench_gpu_open(masu_headless *host, const masu_bench_rays *rays, uint32_t most,
                         masu_bench_gpu *g, char *error, size_t error_size) {
    *g = (masu_bench_gpu){.host = host};
    masu_trace_static layout =
        masu_trace_static_layout(masu_scene_data_of(&rays->scene)->trace_nodes,
                                 masu_scene_data_of(&rays->scene)->trace_triangles);
    const uint64_t bytes[BUFFERS] = {
        layout.bytes, masu_trace_frame_bytes(masu_scene_data_of(&rays->scene)->trace_instances),
        (uint64_t)masu_scene_data_of(&rays->scene)->vertices * sizeof(masu_blob_vertex),
        (uint64_t)most * sizeof(masu_bench_ray), (uint64_t)most * sizeof(masu_bench_hit)};
    for (uint32_t i = 0; i < BUFFERS; i++) {
        if (!masu_headless_buffer_create(host, bytes[i], VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                         &g->buffer[i], error, error_size)) {
            return false;
        }
    }
    unsigned char *out = g->buffer[STATIC].mapped;
    memcpy(out, layout.header, sizeof layout.header);
    memcpy(out + layout.nodes, rays->view.trace_nodes,
           masu_scene_data_of(&rays->scene)->trace_nodes * sizeof *rays->view.trace_nodes);
    memcpy(out + layout.triangles, rays->view.trace_triangles,
           masu_scene_data_of(&rays->scene)->trace_triangles * sizeof *rays->view.trace_triangles);
    masu_trace_top_write(&rays->top, g->buffer[FRAME].mapped);
    memcpy(g->buffer[VERTICES].mapped, rays->view.vertices, bytes[VERTICES]);
    return make_pipelines(g, error, error_size) && make_set(g, error, error_size);
}

void masu_bench_gpu_close(masu_bench_gpu *g) {
    if (!g->host) return;
    VkDevice device = g->host->device;
    masu_headless_settle(g->host);
    vkDestroyDescriptorPool(device, g->pool, NULL);
    for (uint32_t i = 0; i < 2; i++) vkDestroyPipeline(device, g->pipeline[i], NULL);
    vkDestroyPipelineLayout(device, g->layout, NULL);
    vkDestroyDescriptorSetLayout(device, g->set_layout, NULL);
    for (uint32_t i = 0; i < BUFFERS; i++) masu_headless_buffer_destroy(g->host, &g->buffer[i]);
    memset(g, 0, sizeof *g);
}

void masu_bench_gpu_rays(masu_bench_gpu *g, const masu_bench_ray *in, uint32_t count) {
    memcpy(g->buffer[RAYS].mapped, in, count * sizeof *in);
}

bool masu_bench_gpu_trace(masu_bench_gpu *g, uint32_t count, bool counted, double *seconds,
                          char *error, size_t error_size) {
    masu_headless *host = g->host;
    VkCommandBuffer commands;
    const uint32_t push[4] = {count, 0, 0, 0};
    VkCommandBufferAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                            .commandPool = host->pool,
                                            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                            .commandBufferCount = 1};
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkMemoryBarrier done = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                            .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                            .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    CHECK(vkAllocateCommandBuffers(host->device, &allocate, &commands));
    CHECK(vkBeginCommandBuffer(commands, &begin));
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, g->pipeline[counted]);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, g->layout, 0, 1, &g->set, 0,
                            NULL);
    vkCmdPushConstants(commands, g->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, push);
    vkCmdDispatch(commands, (count + 63) / 64, 1, 1);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                         0, 1, &done, 0, NULL, 0, NULL);
    CHECK(vkEndCommandBuffer(commands));
    uint64_t from = masu_clock_ns(NULL);
    bool good = masu_headless_run(host, commands, error, error_size);
    *seconds = (double)(masu_clock_ns(NULL) - from) * 1e-9;
    vkFreeCommandBuffers(host->device, host->pool, 1, &commands);
    return good;
}

const masu_bench_hit *masu_bench_gpu_hits(const masu_bench_gpu *g) {
    return g->buffer[HITS].mapped;
}
