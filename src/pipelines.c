/* pipelines.c: descriptor set layouts derived from the rows of the frame table, shader modules,
 * pipelines, and the render pass of the G-buffer. Modules live only while their pipeline is built.
 * */
#include "renderer.h"

#include "error.h"
#include "shared/masu_shared.h"

#include "easu_comp.spv.h"
#include "gbuffer_frag.spv.h"
#include "gbuffer_vert.spv.h"
#include "light_comp.spv.h"
#include "rcas_comp.spv.h"
#include "tonemap_comp.spv.h"

#include <string.h>

typedef struct spirv {
    const uint32_t *words;
    uint64_t bytes;
} spirv;

/* Compute code by pass; the march's comes with the scene. */
static spirv compute_code(const masu_renderer *m, uint32_t pass) {
    switch (pass) {
    case MASU_PASS_LIGHT: return (spirv){masu_spv_light_comp, sizeof masu_spv_light_comp};
    case MASU_PASS_TONEMAP: return (spirv){masu_spv_tonemap_comp, sizeof masu_spv_tonemap_comp};
    case MASU_PASS_EASU: return (spirv){masu_spv_easu_comp, sizeof masu_spv_easu_comp};
    case MASU_PASS_RCAS: return (spirv){masu_spv_rcas_comp, sizeof masu_spv_rcas_comp};
    case MASU_PASS_MARCH: {
        masu_scene_view v = masu_scene_look(m->plan.desc.scene);
        return (spirv){v.march_spirv, v.march_words * sizeof(uint32_t)};
    }
    default: return (spirv){NULL, 0};
    }
}

static masu_result make_module(masu_renderer *m, spirv code, VkShaderModule *module,
                               masu_detail *detail) {
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = (size_t)code.bytes,
                                     .pCode = code.words};
    VkResult r = m->vk.CreateShaderModule(m->vk.device, &info, m->vk.allocator, module);
    return MASU_FAILED(r, *module) ? masu_fail_vulkan(detail, r, "vkCreateShaderModule") : MASU_OK;
}

static uint64_t now(const masu_renderer *m) {
    return m->plan.desc.clock_ns ? m->plan.desc.clock_ns(m->plan.desc.clock_user) : 0;
}

/* ---- Layouts --------------------------------------------------------------------------------- */

static masu_result make_global_layout(masu_renderer *m, masu_detail *detail) {
    VkShaderStageFlags all =
        VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    VkDescriptorSetLayoutBinding bindings[] = {
        {MASU_BIND_FRAME, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, all, NULL},
        {MASU_BIND_INSTANCES, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_VERTEX_BIT,
         NULL},
        {MASU_BIND_MATERIALS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT,
         NULL},
        {MASU_BIND_COUNTERS, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT,
         NULL}};
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = sizeof bindings / sizeof *bindings,
                                            .pBindings = bindings};
    VkResult r =
        m->vk.CreateDescriptorSetLayout(m->vk.device, &info, m->vk.allocator, &m->global_layout);
    if (MASU_FAILED(r, m->global_layout))
        return masu_fail_vulkan(detail, r, "vkCreateDescriptorSetLayout");
    return MASU_OK;
}

/* Set 1: reads first, then writes, in the order of the row. Which images stand behind the bindings
 * may differ from rung to rung, their number and kind do not: the first rung that runs the pass
 * speaks for all. */
static masu_result make_pass_layout(masu_renderer *m, uint32_t pass, masu_detail *detail) {
    const masu_rung_plan *rp = NULL;
    for (uint32_t r = 0; r < m->plan.desc.rung_count && !rp; r++) {
        if (m->plan.rungs[r].active & 1u << pass) rp = &m->plan.rungs[r];
    }
    if (!rp) return MASU_OK;
    VkDescriptorSetLayoutBinding bindings[MASU_PASS_ACCESSES];
    uint32_t n = 0;
    int compute = masu_passes[pass].kind == MASU_PASS_COMPUTE;
    for (int writes = 0; writes < 2 && compute; writes++) {
        for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
            if (masu_usage_writes((masu_usage)rp->access[pass][a].usage) != writes) continue;
            bindings[n] = (VkDescriptorSetLayoutBinding){
                n,
                writes ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                       : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                1, VK_SHADER_STAGE_COMPUTE_BIT, writes ? NULL : &m->sampler};
            n++;
        }
    }
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = n,
                                            .pBindings = bindings};
    VkResult r = m->vk.CreateDescriptorSetLayout(m->vk.device, &info, m->vk.allocator,
                                                 &m->pass_layouts[pass]);
    if (MASU_FAILED(r, m->pass_layouts[pass]))
        return masu_fail_vulkan(detail, r, "vkCreateDescriptorSetLayout");
    VkDescriptorSetLayout sets[] = {m->global_layout, m->pass_layouts[pass]};
    VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(struct masu_push)};
    if (!compute) push.stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT;
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount = 2,
                                         .pSetLayouts = sets,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &push};
    r = m->vk.CreatePipelineLayout(m->vk.device, &layout, m->vk.allocator, &m->layouts[pass]);
    if (MASU_FAILED(r, m->layouts[pass]))
        return masu_fail_vulkan(detail, r, "vkCreatePipelineLayout");
    masu_name(m, VK_OBJECT_TYPE_PIPELINE_LAYOUT, MASU_HANDLE(m->layouts[pass]),
              masu_passes[pass].name);
    return MASU_OK;
}

/* ---- Compute --------------------------------------------------------------------------------- */

static masu_result make_compute(masu_renderer *m, uint32_t pass, masu_detail *detail) {
    VkShaderModule module = VK_NULL_HANDLE;
    masu_result result = make_module(m, compute_code(m, pass), &module, detail);
    if (result) return result;
    /* Constant 0: whether counters are kept. */
    VkBool32 counters = m->plan.desc.debug.counters != 0;
    VkSpecializationMapEntry entry = {0, 0, sizeof counters};
    VkSpecializationInfo special = {1, &entry, sizeof counters, &counters};
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &special},
        .layout = m->layouts[pass]};
    uint64_t start = now(m);
    VkResult r = m->vk.CreateComputePipelines(m->vk.device, m->plan.desc.vulkan.pipeline_cache, 1,
                                              &info, m->vk.allocator, &m->pipelines[pass]);
    m->pipeline_ns[pass] = now(m) - start;
    m->vk.DestroyShaderModule(m->vk.device, module, m->vk.allocator);
    if (MASU_FAILED(r, m->pipelines[pass]))
        return masu_fail_vulkan(detail, r, "vkCreateComputePipelines");
    return MASU_OK;
}

/* ---- G-buffer -------------------------------------------------------------------------------- */

/* Attachments come in the layouts that the row's barriers put them in, and stay there: the render
 * pass itself does no transition, so that record.c remains the only place that thinks about them.
 * */
static masu_result make_render_pass(masu_renderer *m, masu_detail *detail) {
    const masu_image_id ids[3] = {MASU_IMAGE_ALBEDO, MASU_IMAGE_NORMAL, MASU_IMAGE_DEPTH};
    VkAttachmentDescription attachments[3];
    VkImageView views[3];
    uint32_t width = m->plan.images[MASU_IMAGE_DEPTH].width;
    uint32_t height = m->plan.images[MASU_IMAGE_DEPTH].height;
    for (uint32_t i = 0; i < 3; i++) {
        VkImageLayout layout = i == 2 ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                      : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        attachments[i] =
            (VkAttachmentDescription){.format = masu_images[ids[i]].format,
                                      .samples = VK_SAMPLE_COUNT_1_BIT,
                                      .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                      .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                      .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                      .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                      .initialLayout = layout,
                                      .finalLayout = layout};
        views[i] = m->views[ids[i]];
    }
    VkAttachmentReference colors[2] = {{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                                       {1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL}};
    VkAttachmentReference depth = {2, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    .colorAttachmentCount = 2,
                                    .pColorAttachments = colors,
                                    .pDepthStencilAttachment = &depth};
    VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                   .attachmentCount = 3,
                                   .pAttachments = attachments,
                                   .subpassCount = 1,
                                   .pSubpasses = &subpass};
    VkResult r = m->vk.CreateRenderPass(m->vk.device, &info, m->vk.allocator, &m->render_pass);
    if (MASU_FAILED(r, m->render_pass)) return masu_fail_vulkan(detail, r, "vkCreateRenderPass");
    VkFramebufferCreateInfo frame = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = m->render_pass,
                                     .attachmentCount = 3,
                                     .pAttachments = views,
                                     .width = width,
                                     .height = height,
                                     .layers = 1};
    r = m->vk.CreateFramebuffer(m->vk.device, &frame, m->vk.allocator, &m->framebuffer);
    return MASU_FAILED(r, m->framebuffer) ? masu_fail_vulkan(detail, r, "vkCreateFramebuffer")
                                          : MASU_OK;
}

static VkResult create_gbuffer_pipeline(masu_renderer *m, const VkShaderModule modules[2]) {
    VkPipelineShaderStageCreateInfo stages[2];
    for (uint32_t i = 0; i < 2; i++) {
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT,
            .module = modules[i],
            .pName = "main"};
    }
    VkVertexInputBindingDescription binding = {0, sizeof(masu_blob_vertex),
                                               VK_VERTEX_INPUT_RATE_VERTEX};
    VkVertexInputAttributeDescription attributes[] = {
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(masu_blob_vertex, position)},
        {1, 0, VK_FORMAT_R16G16_SNORM, offsetof(masu_blob_vertex, normal)}};
    VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = 1,
        .pVertexBindingDescriptions = &binding,
        .vertexAttributeDescriptionCount = 2,
        .pVertexAttributeDescriptions = attributes};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    /* No back-face culling: CAD data is not consistently wound, and the normal is turned towards
     * the viewer. */
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = VK_CULL_MODE_NONE,
        .lineWidth = 1.0f};
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = VK_COMPARE_OP_GREATER};
    VkPipelineColorBlendAttachmentState blend[2] = {
        {.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                           VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT},
        {.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                           VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT}};
    VkPipelineColorBlendStateCreateInfo blending = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 2,
        .pAttachments = blend};
    VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamics = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = dynamic};
    VkGraphicsPipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                         .stageCount = 2,
                                         .pStages = stages,
                                         .pVertexInputState = &input,
                                         .pInputAssemblyState = &assembly,
                                         .pViewportState = &viewport,
                                         .pRasterizationState = &raster,
                                         .pMultisampleState = &samples,
                                         .pDepthStencilState = &depth,
                                         .pColorBlendState = &blending,
                                         .pDynamicState = &dynamics,
                                         .layout = m->layouts[MASU_PASS_GBUFFER],
                                         .renderPass = m->render_pass};
    return m->vk.CreateGraphicsPipelines(m->vk.device, m->plan.desc.vulkan.pipeline_cache, 1, &info,
                                         m->vk.allocator, &m->pipelines[MASU_PASS_GBUFFER]);
}

static masu_result make_gbuffer(masu_renderer *m, masu_detail *detail) {
    masu_result result = make_render_pass(m, detail);
    if (result || !m->plan.needs.raster) return result; /* an empty scene only clears */
    VkShaderModule modules[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    result = make_module(m, (spirv){masu_spv_gbuffer_vert, sizeof masu_spv_gbuffer_vert},
                         &modules[0], detail);
    if (!result) {
        result = make_module(m, (spirv){masu_spv_gbuffer_frag, sizeof masu_spv_gbuffer_frag},
                             &modules[1], detail);
    }
    if (!result) {
        uint64_t start = now(m);
        VkResult r = create_gbuffer_pipeline(m, modules);
        m->pipeline_ns[MASU_PASS_GBUFFER] = now(m) - start;
        if (MASU_FAILED(r, m->pipelines[MASU_PASS_GBUFFER])) {
            result = masu_fail_vulkan(detail, r, "vkCreateGraphicsPipelines");
        }
    }
    for (uint32_t i = 0; i < 2; i++)
        m->vk.DestroyShaderModule(m->vk.device, modules[i], m->vk.allocator);
    return result;
}

masu_result masu_make_pipelines(masu_renderer *m, masu_detail *detail) {
    VkSamplerCreateInfo nearest = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = VK_FILTER_NEAREST,
                                   .minFilter = VK_FILTER_NEAREST,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    VkResult r = m->vk.CreateSampler(m->vk.device, &nearest, m->vk.allocator, &m->sampler);
    if (MASU_FAILED(r, m->sampler)) return masu_fail_vulkan(detail, r, "vkCreateSampler");
    masu_result result = make_global_layout(m, detail);
    for (uint32_t p = 0; p < MASU_PASS_COUNT && !result; p++) {
        if (masu_passes[p].kind == MASU_PASS_TRANSFER) continue;
        result = make_pass_layout(m, p, detail);
        if (result || !m->layouts[p]) continue;
        result = p == MASU_PASS_GBUFFER ? make_gbuffer(m, detail) : make_compute(m, p, detail);
        if (!result)
            masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->pipelines[p]),
                      masu_passes[p].name);
    }
    return result;
}
