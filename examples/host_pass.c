/* host_pass.c SCENE.masu OUT.png: the host's own passes within a frame. Before the tone curve it
 * draws a glowing sheet through the camera's target, depth-tested against the scene; after
 * upscaling a bar over the image. platform/headless.h provides device and image; both passes use
 * the same shaders, host_pass.vert and .frag. */
#include "headless.h"
#include "image.h"
#include "masu.h"

#include "host_pass_frag.spv.h"
#include "host_pass_vert.spv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define WIDTH 1280
#define HEIGHT 720
#define GRAPHICS (VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT)
#define CHECK(call)                                                                                \
    if (!(call)) return fprintf(stderr, "host_pass: %s%s\n", error, detail.text), 1

/* A parallelogram, as in the shaders' push constants. */
typedef struct sheet {
    float clip_from_world[16], corner[4], along[4], across[4], color[4];
} sheet;

/* Pipeline and targets to draw a sheet into the images of a split point. */
typedef struct painter {
    VkRenderPass pass;
    VkFramebuffer frame;
    VkPipelineLayout layout;
    VkPipeline pipeline;
} painter;

/* An attachment keeps the layout in which the library provides it. */
static VkAttachmentDescription attachment(const masu_split_image *image) {
    return (VkAttachmentDescription){.format = image->format,
                                     .samples = VK_SAMPLE_COUNT_1_BIT,
                                     .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                     .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                     .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                     .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                     .initialLayout = image->layout,
                                     .finalLayout = image->layout};
}

static VkResult make_targets(VkDevice device, const masu_split *split, painter *p) {
    uint32_t count = split->depth.view ? 2 : 1;
    VkAttachmentDescription attachments[] = {attachment(&split->color), attachment(&split->depth)};
    VkAttachmentReference color = {0, split->color.layout}, depth = {1, split->depth.layout};
    VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &color,
                                    .pDepthStencilAttachment = count > 1 ? &depth : NULL};
    VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                   .attachmentCount = count,
                                   .pAttachments = attachments,
                                   .subpassCount = 1,
                                   .pSubpasses = &subpass};
    VkImageView views[] = {split->color.view, split->depth.view};
    VkFramebufferCreateInfo frame = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .attachmentCount = count,
                                     .pAttachments = views,
                                     .width = split->color.image_width,
                                     .height = split->color.image_height,
                                     .layers = 1};
    VkResult r = vkCreateRenderPass(device, &pass, NULL, &p->pass);
    frame.renderPass = p->pass;
    return r ? r : vkCreateFramebuffer(device, &frame, NULL, &p->frame);
}

static VkResult make_pipeline(VkDevice device, const VkShaderModule modules[2], int tested,
                              painter *p) {
    VkPushConstantRange range = {GRAPHICS, 0, sizeof(sheet)};
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &range};
    VkResult r = vkCreatePipelineLayout(device, &layout, NULL, &p->layout);
    VkPipelineShaderStageCreateInfo stages[] = {
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_VERTEX_BIT,
         .module = modules[0],
         .pName = "main"},
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
         .module = modules[1],
         .pName = "main"}};
    VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP};
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1.0f};
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = tested ? VK_TRUE : VK_FALSE,
        .depthCompareOp = VK_COMPARE_OP_GREATER}; /* reversed depth: larger is closer */
    VkPipelineColorBlendAttachmentState blend = {.blendEnable = VK_TRUE,
                                                 .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
                                                 .dstColorBlendFactor =
                                                     VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                 .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                                 .colorWriteMask = 15};
    VkPipelineColorBlendStateCreateInfo blending = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = &blend};
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
                                         .layout = p->layout,
                                         .renderPass = p->pass};
    return r ? r : vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &p->pipeline);
}

static void destroy_painter(VkDevice device, const painter *p) {
    vkDestroyPipeline(device, p->pipeline, NULL);
    vkDestroyPipelineLayout(device, p->layout, NULL);
    vkDestroyFramebuffer(device, p->frame, NULL);
    vkDestroyRenderPass(device, p->pass, NULL);
}

static VkResult record(VkCommandBuffer to, const painter *p, const masu_split_image *image,
                       const sheet *what) {
    VkRect2D area = {{0, 0}, {image->width, image->height}};
    VkViewport viewport = {0, 0, (float)image->width, (float)image->height, 0, 1};
    VkCommandBufferBeginInfo again = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = p->pass,
                                   .framebuffer = p->frame,
                                   .renderArea = area};
    VkResult r = vkBeginCommandBuffer(to, &again);
    if (r) return r;
    vkCmdBeginRenderPass(to, &begin, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, p->pipeline);
    vkCmdSetViewport(to, 0, 1, &viewport);
    vkCmdSetScissor(to, 0, 1, &area);
    vkCmdPushConstants(to, p->layout, GRAPHICS, 0, sizeof *what, what);
    vkCmdDraw(to, 4, 1, 0, 0);
    vkCmdEndRenderPass(to);
    return vkEndCommandBuffer(to);
}

/* A slanted sheet through the camera's target: one part is in front of the scene, one behind. */
static sheet slanting(const masu_frame_view *view, double distance) {
    sheet s = {.color = {0.1f, 0.5f, 0.8f, 0.4f}}; /* linear radiance, premultiplied by alpha */
    for (int i = 0; i < 16; i++) {
        for (int k = 0; k < 4; k++)
            s.clip_from_world[i] += view->projection[i / 4 * 4 + k] * view->view[4 * k + i % 4];
    }
    for (int i = 0; i < 3; i++) { /* rows of the view: right, up, backward */
        double right = (double)view->view[i], up = (double)view->view[4 + i],
               back = (double)view->view[8 + i];
        double along = distance * (0.9 * right - 0.3 * back), across = 0.25 * distance * up;
        s.corner[i] = (float)(view->position[i] - distance * back - 0.5 * along - 0.5 * across);
        s.along[i] = (float)along;
        s.across[i] = (float)across;
    }
    return s;
}

int main(int argc, char **argv) {
    masu_headless host;
    masu_headless_target image;
    masu_detail detail = {0};
    char error[512] = "";
    uint8_t *blob;
    size_t size, room = sizeof error;
    if (argc != 3) return fprintf(stderr, "usage: host_pass SCENE.masu OUT.png\n"), 2;
    CHECK(masu_file_read(argv[1], 1 << 30, &blob, &size, error, room));
    CHECK(masu_headless_open(&(masu_headless_desc){.validate = true}, &host, error, room));
    CHECK(masu_headless_target_create(&host, WIDTH, HEIGHT, VK_FORMAT_R8G8B8A8_UNORM, false, &image,
                                      error, room));
    masu_scene scene;
    CHECK(masu_scene_bind(blob, size, &scene, &detail) == MASU_OK);
    masu_desc desc = {MASU_DESC,
                      .vulkan = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                                 .instance = host.instance,
                                 .physical_device = host.physical,
                                 .device = host.device,
                                 .queue_family = host.family},
                      .scene = &scene,
                      .output = {WIDTH, HEIGHT},
                      .targets = {.images = &image.image, .views = &image.view, .count = 1},
                      .split = MASU_SPLIT_BEFORE_TONE | MASU_SPLIT_AFTER_UPSCALE};
    masu_memory need;
    CHECK(masu_memory_query(&desc, &need, &detail) == MASU_OK);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    masu_renderer *m;
    masu_commands commands;
    CHECK(masu_init(&desc, block, need.host_bytes, &m, &detail) == MASU_OK);
    while (masu_load(m, &commands, &detail) == MASU_INCOMPLETE) {
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }

    /* Images, views, formats and layouts are the same in every frame: everything is created
     * once. */
    static const masu_split_bits points[2] = {MASU_SPLIT_BEFORE_TONE, MASU_SPLIT_AFTER_UPSCALE};
    masu_split split[2];
    painter painters[2] = {{0}};
    VkShaderModule modules[2];
    VkCommandBuffer own[2];
    VkShaderModuleCreateInfo code[] = {{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = sizeof masu_spv_host_pass_vert,
                                        .pCode = masu_spv_host_pass_vert},
                                       {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                        .codeSize = sizeof masu_spv_host_pass_frag,
                                        .pCode = masu_spv_host_pass_frag}};
    for (int i = 0; i < 2; i++)
        CHECK(!vkCreateShaderModule(host.device, &code[i], NULL, &modules[i]));
    for (int i = 0; i < 2; i++) {
        CHECK(masu_split_of(m, points[i], 0, 0, &split[i], &detail) == MASU_OK);
        CHECK(!make_targets(host.device, &split[i], &painters[i]));
        CHECK(!make_pipeline(host.device, modules, split[i].depth.view != VK_NULL_HANDLE,
                             &painters[i]));
    }
    VkCommandPool pool; /* recorded in each frame */
    VkCommandPoolCreateInfo reset = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     .queueFamilyIndex = host.family};
    CHECK(!vkCreateCommandPool(host.device, &reset, NULL, &pool));
    VkCommandBufferAllocateInfo buffers = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 2};
    CHECK(!vkAllocateCommandBuffers(host.device, &buffers, own));

    const sheet bar = {.clip_from_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                       .corner = {-0.9f, 0.8f}, .along = {0.6f, 0}, .across = {0, 0.06f},
                       .color = {0.72f, 0.54f, 0.09f, 0.9f}}; /* display-encoded; premultiplied */
    for (int i = 0; i < 4; i++) {
        masu_camera camera;
        masu_frame_view view;
        CHECK(masu_camera_at(m, 0.0, &camera, &detail) == MASU_OK);
        /* Both rungs are upscaled. */
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .rung = i < 3 ? 2 : 1};
        CHECK(masu_frame(m, &frame, &commands, &detail) == MASU_OK);
        CHECK(masu_frame_view_of(m, &view, &detail) == MASU_OK);
        for (int k = 0; k < 2; k++) /* the rendered part of the images depends on the rung */
            CHECK(masu_split_of(m, points[k], commands.rung, 0, &split[k], &detail) == MASU_OK);
        const float *f = camera.forward; /* for a scene's camera its length is the distance to the
                                          * target */
        sheet glowing = slanting(&view, sqrt((double)(f[0] * f[0] + f[1] * f[1] + f[2] * f[2])));
        CHECK(!record(own[0], &painters[0], &split[0].color, &glowing));
        CHECK(!record(own[1], &painters[1], &split[1].color, &bar));
        VkCommandBuffer all[] = {commands.parts[0], own[0], commands.parts[1], own[1],
                                 commands.parts[2]};
        VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .commandBufferCount = 5,
                               .pCommandBuffers = all};
        CHECK(!vkQueueSubmit(host.queue, 1, &submit, VK_NULL_HANDLE) &&
              !vkQueueWaitIdle(host.queue));
    }
    CHECK(masu_headless_target_read(&host, &image, error, room));
    CHECK(masu_image_save_png(argv[2], image.mapped, WIDTH, HEIGHT, 0, error, room));
    printf("%u parts, rendered at %ux%u, validation %u\n", commands.part_count,
           split[0].color.width, split[0].color.height, host.messages);
    for (int i = 0; i < 2; i++) {
        destroy_painter(host.device, &painters[i]);
        vkDestroyShaderModule(host.device, modules[i], NULL);
    }
    vkDestroyCommandPool(host.device, pool, NULL);
    masu_destroy(m);
    masu_headless_target_destroy(&host, &image);
    masu_headless_close(&host);
    free(block);
    free(blob);
    return 0;
}
