/* test_host_pass.c: the host's own commands between the parts of a frame (masu_desc.split). Without
 * any, the image is bit-identical to the one without a split. Copies equal the images of
 * desc.readback. Geometry drawn by the host covers the pixels, at the depths, of rays through the
 * camera, and passes through the tone curve. */
#include "reference/tone.h"
#include "support/floats.h"
#include "support/support.h"

#include "host_pass_frag.spv.h"
#include "host_pass_vert.spv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 160, H = 90, BYTES = W * H * 4, RUNGS = 5, SLOTS = 2 };

static uint8_t pixels[2][BYTES];

static masu_desc desc_of(const masu_session *s, uint32_t split) {
    masu_desc d = s->desc;
    d.scene = &s->scene;
    d.output = (VkExtent2D){W, H};
    d.split = split;
    d.rung_count = RUNGS;
    d.rungs[0] = (masu_rung){.scale = 1.0f};
    d.rungs[1] = (masu_rung){.scale = 0.5f};
    d.rungs[2] = (masu_rung){.scale = 0.7f, .easu = MASU_EASU_FAST, .aa = MASU_AA_SMAA_LOW};
    d.rungs[3] = (masu_rung){.scale = 0.6f, .temporal = MASU_ON};
    d.rungs[4] = (masu_rung){.scale = 0.9f, .aa = MASU_AA_FXAA};
    return d;
}

static void open_scene(masu_session *s, const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.no_renderer = true;
    open_session(s, &d);
}

/* ---- A host ---------------------------------------------------------------------------------- */

/* A parallelogram, in the layout of host_pass.vert. */
typedef struct push {
    float clip_from_world[16];
    float corner[4], along[4], across[4];
    float color[4]; /* multiplied by its alpha */
} push;
_Static_assert(sizeof(push) == 128, "what every device has room for");

/* Draws into an image of a split point, with a depth test if the point has depth. */
typedef struct painter {
    masu_session *s;
    VkRenderPass pass;
    VkFramebuffer frame;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkExtent2D extent;
} painter;

static VkShaderModule module_of(VkDevice device, const uint32_t *words, size_t bytes) {
    VkShaderModule module;
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = bytes,
                                     .pCode = words};
    assert_int_equal(vkCreateShaderModule(device, &info, NULL, &module), VK_SUCCESS);
    return module;
}

static void make_pipeline(painter *p, int tested) {
    VkDevice device = p->s->host.device;
    VkShaderModule modules[] = {
        module_of(device, masu_spv_host_pass_vert, sizeof masu_spv_host_pass_vert),
        module_of(device, masu_spv_host_pass_frag, sizeof masu_spv_host_pass_frag)};
    VkPipelineShaderStageCreateInfo stages[2];
    for (int i = 0; i < 2; i++) {
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT,
            .module = modules[i],
            .pName = "main"};
    }
    VkPushConstantRange range = {VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                 sizeof(push)};
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &range};
    assert_int_equal(vkCreatePipelineLayout(device, &layout, NULL, &p->layout), VK_SUCCESS);
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
        .depthCompareOp = VK_COMPARE_OP_GREATER};
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
    assert_int_equal(
        vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &p->pipeline),
        VK_SUCCESS);
    for (int i = 0; i < 2; i++) vkDestroyShaderModule(device, modules[i], NULL);
}

static VkAttachmentDescription attachment_of(const masu_split_image *image) {
    return (VkAttachmentDescription){.format = image->format,
                                     .samples = VK_SAMPLE_COUNT_1_BIT,
                                     .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                     .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                     .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                     .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                     .initialLayout = image->layout,
                                     .finalLayout = image->layout};
}

static painter make_painter(masu_session *s, const masu_split *split, int tested) {
    painter p = {.s = s};
    VkAttachmentDescription attachments[] = {attachment_of(&split->color),
                                             attachment_of(&split->depth)};
    VkAttachmentReference color = {0, split->color.layout}, depth = {1, split->depth.layout};
    VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    .colorAttachmentCount = 1,
                                    .pColorAttachments = &color,
                                    .pDepthStencilAttachment = tested ? &depth : NULL};
    VkRenderPassCreateInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                   .attachmentCount = tested ? 2 : 1,
                                   .pAttachments = attachments,
                                   .subpassCount = 1,
                                   .pSubpasses = &subpass};
    assert_int_equal(vkCreateRenderPass(s->host.device, &pass, NULL, &p.pass), VK_SUCCESS);
    VkImageView views[] = {split->color.view, split->depth.view};
    VkFramebufferCreateInfo frame = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = p.pass,
                                     .attachmentCount = tested ? 2 : 1,
                                     .pAttachments = views,
                                     .width = split->color.image_width,
                                     .height = split->color.image_height,
                                     .layers = 1};
    assert_int_equal(vkCreateFramebuffer(s->host.device, &frame, NULL, &p.frame), VK_SUCCESS);
    make_pipeline(&p, tested);
    return p;
}

static void destroy_painter(painter *p) {
    VkDevice device = p->s->host.device;
    vkDestroyPipeline(device, p->pipeline, NULL);
    vkDestroyPipelineLayout(device, p->layout, NULL);
    vkDestroyFramebuffer(device, p->frame, NULL);
    vkDestroyRenderPass(device, p->pass, NULL);
}

static void paint(VkCommandBuffer cmd, const painter *p, const masu_split_image *into,
                  const push *what) {
    VkRect2D area = {{0, 0}, {into->width, into->height}};
    VkViewport viewport = {0, 0, (float)into->width, (float)into->height, 0, 1};
    VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = p->pass,
                                   .framebuffer = p->frame,
                                   .renderArea = area};
    vkCmdBeginRenderPass(cmd, &begin, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, p->pipeline);
    vkCmdSetViewport(cmd, 0, 1, &viewport);
    vkCmdSetScissor(cmd, 0, 1, &area);
    vkCmdPushConstants(cmd, p->layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                       sizeof *what, what);
    vkCmdDraw(cmd, 4, 1, 0, 0);
    vkCmdEndRenderPass(cmd);
}

/* Copies an image in the layout of the split point, and restores the layout. */
static void copy_out(VkCommandBuffer cmd, const masu_split_image *from, VkBuffer to) {
    VkImageAspectFlags aspect = from->format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                                     : VK_IMAGE_ASPECT_COLOR_BIT;
    VkImageMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                              .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                              .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
                              .oldLayout = from->layout,
                              .newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                              .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                              .image = from->image,
                              .subresourceRange = {aspect, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                         0, NULL, 0, NULL, 1, &b);
    VkBufferImageCopy copy = {.imageSubresource = {aspect, 0, 0, 1},
                              .imageExtent = {from->width, from->height, 1}};
    vkCmdCopyImageToBuffer(cmd, from->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to, 1, &copy);
    b.srcAccessMask = 0;
    b.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    b.newLayout = from->layout;
    b.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    VkMemoryBarrier read = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                            .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                            .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                         &read, 0, NULL, 1, &b);
}

static VkCommandBuffer begin_commands(masu_session *s) {
    VkCommandBuffer cmd;
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                        .commandPool = s->host.pool,
                                        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                        .commandBufferCount = 1};
    assert_int_equal(vkAllocateCommandBuffers(s->host.device, &info, &cmd), VK_SUCCESS);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    assert_int_equal(vkBeginCommandBuffer(cmd, &begin), VK_SUCCESS);
    return cmd;
}

/* Submits the parts of a frame with the host's commands between them: own[i] after part i, each
 * null or ended here. */
static void submit(masu_session *s, const masu_commands *commands,
                   VkCommandBuffer own[MASU_MAX_PARTS]) {
    VkCommandBuffer all[2 * MASU_MAX_PARTS];
    uint32_t n = 0;
    for (uint32_t i = 0; i < commands->part_count; i++) {
        all[n++] = commands->parts[i];
        if (!own || !own[i]) continue;
        assert_int_equal(vkEndCommandBuffer(own[i]), VK_SUCCESS);
        all[n++] = own[i];
    }
    VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = n, .pCommandBuffers = all};
    assert_int_equal(vkQueueSubmit(s->host.queue, 1, &info, VK_NULL_HANDLE), VK_SUCCESS);
}

static void finish(masu_session *s, VkCommandBuffer own[MASU_MAX_PARTS]) {
    assert_int_equal(vkQueueWaitIdle(s->host.queue), VK_SUCCESS);
    for (uint32_t i = 0; own && i < MASU_MAX_PARTS; i++) {
        if (own[i]) vkFreeCommandBuffers(s->host.device, s->host.pool, 1, &own[i]);
    }
}

static masu_commands next_frame(own_renderer *x, const masu_frame_desc *frame) {
    masu_commands commands;
    if (masu_frame(x->m, frame, &commands, &failure)) fail_msg("%s", failure.text);
    return commands;
}

static masu_split split_of(own_renderer *x, masu_split_bits which, uint32_t rung,
                           uint32_t viewport) {
    masu_split split;
    if (masu_split_of(x->m, which, rung, viewport, &split, &failure)) fail_msg("%s", failure.text);
    return split;
}

static masu_readback_image readback_of(own_renderer *x, uint32_t slot, masu_readback_bits which) {
    masu_readback_image image;
    assert_int_equal(masu_readback(x->m, slot, which, &image, &failure), MASU_OK);
    return image;
}

static void read_target(masu_session *s, own_renderer *x, uint8_t *out) {
    char error[ERROR_SIZE];
    assert_ok(masu_headless_target_read(&s->host, &x->target, error, sizeof error));
    memcpy(out, x->target.mapped, (size_t)x->target.width * x->target.height * 4);
}

/* ---- Nothing between the parts --------------------------------------------------------------- */

static void compare_pictures(const char *scene, uint32_t storage, uint32_t split, uint32_t parts) {
    masu_session s;
    open_scene(&s, scene);
    own_renderer x[2];
    for (uint32_t i = 0; i < 2; i++) {
        masu_desc d = desc_of(&s, i ? split : 0);
        d.targets.storage = storage;
        d.debug.timestamps = i;
        make_own(&s, &x[i], &d);
    }
    for (uint32_t r = 0; r < RUNGS; r++) {
        for (uint32_t k = 0; k < 3; k++) {
            for (uint32_t i = 0; i < 2; i++) {
                masu_frame_desc frame = {MASU_FRAME_DESC, .rung = r, .time = 0.1 * k,
                                         .time_step = 0.1f, .cut = k == 0};
                masu_commands commands = next_frame(&x[i], &frame);
                assert_int_equal(commands.part_count, i ? parts : 1);
                assert_ptr_equal(commands.buffer, commands.parts[0]);
                submit(&s, &commands, NULL);
                finish(&s, NULL);
                read_target(&s, &x[i], pixels[i]);
                masu_stats_info stats;
                assert_int_equal(masu_stats(x[i].m, commands.slot, &stats, &failure), MASU_OK);
                if (i) assert_true(stats.timed && stats.gpu_ns > 0);
            }
            uint32_t most = max_difference(pixels[0], pixels[1], BYTES);
            if (most)
                fail_msg("%s, storage %u, split %u, rung %u, frame %u: error of %u",
                         scene, storage, split, r, k, most);
        }
    }
    for (uint32_t i = 0; i < 2; i++) unmake_own(&s, &x[i]);
    close_session(&s);
}

static void with_nothing_between_the_picture_is_the_same(void **state) {
    (void)state;
    compare_pictures("test_both", 1, MASU_SPLIT_ALL, 3);
    compare_pictures("test_both", 0, MASU_SPLIT_BEFORE_TONE, 2);
    compare_pictures("test_both", 0, MASU_SPLIT_AFTER_UPSCALE, 2);
    compare_pictures("test_live", 0, MASU_SPLIT_ALL, 3);
}

/* ---- Reading the images ---------------------------------------------------------------------- */

static void assert_same_image(const masu_split_image *image, const void *copied,
                              masu_readback_image read, const char *what) {
    if (image->width != read.width || image->height != read.height ||
        memcmp(copied, read.pixels, read.row_bytes * read.height) != 0)
        fail_msg("%s: %ux%u differs from the readback, %ux%u",
                 what, image->width, image->height, read.width, read.height);
}

static void compare_copies(const char *scene) {
    masu_session s;
    char error[ERROR_SIZE];
    open_scene(&s, scene);
    own_renderer x;
    masu_desc d = desc_of(&s, MASU_SPLIT_ALL);
    d.targets.storage = 0;
    d.dither = MASU_OFF;
    d.readback = MASU_READBACK_DEPTH | MASU_READBACK_HDR | MASU_READBACK_VELOCITY;
    make_own(&s, &x, &d);
    masu_headless_buffer copies[7];
    for (uint32_t i = 0; i < 7; i++)
        assert_ok(masu_headless_buffer_create(&s.host, W * H * 8, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                              &copies[i], error, sizeof error));
    for (uint32_t k = 0; k < 2 * RUNGS; k++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .rung = k % RUNGS, .time = 0.1 * k,
                                 .time_step = 0.1f};
        masu_commands commands = next_frame(&x, &frame);
        masu_split tone = split_of(&x, MASU_SPLIT_BEFORE_TONE, commands.rung, 0);
        masu_split output = split_of(&x, MASU_SPLIT_AFTER_UPSCALE, commands.rung, 0);
        assert_int_equal(tone.part, 0);
        assert_int_equal(output.part, 1);
        VkCommandBuffer own[MASU_MAX_PARTS] = {begin_commands(&s), begin_commands(&s)};
        const masu_split_image images[] = {tone.depth,     tone.color, tone.velocity, output.depth,
                                           output.hdr, output.velocity, output.color};
        for (uint32_t i = 0; i < 7; i++) copy_out(own[i < 3 ? 0 : 1], &images[i], copies[i].buffer);
        submit(&s, &commands, own);
        finish(&s, own);
        for (uint32_t i = 0; i < 6; i++) {
            static const masu_readback_bits bits[] = {MASU_READBACK_DEPTH, MASU_READBACK_HDR,
                                                      MASU_READBACK_VELOCITY};
            char what[80];
            snprintf(what, sizeof what, "%s, rung %u, image %u", scene, commands.rung, i);
            assert_same_image(&images[i], copies[i].mapped,
                              readback_of(&x, commands.slot, bits[i % 3]), what);
        }
        read_target(&s, &x, pixels[0]);
        assert_int_equal(output.color.format, VK_FORMAT_R8G8B8A8_UNORM);
        assert_memory_equal(copies[6].mapped, pixels[0], BYTES);
    }
    for (uint32_t i = 0; i < 7; i++) masu_headless_buffer_destroy(&s.host, &copies[i]);
    unmake_own(&s, &x);
    close_session(&s);
}

static void what_is_copied_is_what_is_read_back(void **state) {
    (void)state;
    compare_copies("test_both");
    compare_copies("test_sphere_sdf");
    compare_copies("test_live");
}

/* ---- Drawing --------------------------------------------------------------------------------- */

static void multiply(const float a[16], const float b[16], float out[16]) {
    for (int i = 0; i < 16; i++) {
        double sum = 0.0;
        for (int k = 0; k < 4; k++) sum += (double)a[i / 4 * 4 + k] * (double)b[4 * k + i % 4];
        out[i] = (float)sum;
    }
}

/* Through the centre of the scenes, occluding a part of it, and partly occluded. */
static const push leaning = {.corner = {-1.6f, -0.7f, 0.5f, 0},
                             .along = {3.1f, 0.2f, -0.9f, 0},
                             .across = {0.2f, 1.7f, -0.4f, 0},
                             .color = {0.75f, 0.25f, 0.125f, 1}};

static const masu_camera oblique = {.position = {1.2, 0.9, 3.2},
                                    .forward = {-1.2f, -0.8f, -3.2f},
                                    .fov_y = 0.75f,
                                    .near_distance = 0.07f};

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void unit(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++) v[i] /= length;
}

/* Intersection of a ray through an image position with the parallelogram: 1 and the depth, 0 for a
 * miss, -1 near its rim. */
static int meets(const push *q, const masu_camera *c, double ndc_x, double ndc_y, double aspect,
                 double *depth) {
    double forward[3], right[3], up[3] = {0, 1, 0}, ray[3], to[3], normal[3], u[3], v[3], at[3];
    for (int i = 0; i < 3; i++) {
        forward[i] = (double)c->forward[i];
        u[i] = (double)q->along[i];
        v[i] = (double)q->across[i];
        to[i] = (double)q->corner[i] - c->position[i];
    }
    unit(forward);
    cross(forward, up, right);
    unit(right);
    cross(right, forward, up);
    double tan_y = tan(0.5 * (double)c->fov_y);
    for (int i = 0; i < 3; i++)
        ray[i] = forward[i] + right[i] * tan_y * aspect * ndc_x - up[i] * tan_y * ndc_y;
    cross(u, v, normal);
    double t = dot(to, normal) / dot(ray, normal);
    for (int i = 0; i < 3; i++) at[i] = ray[i] * t - to[i];
    double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), au = dot(at, u), av = dot(at, v);
    double a = (au * vv - av * uv) / (uu * vv - uv * uv),
           b = (av * uu - au * uv) / (uu * vv - uv * uv);
    *depth = (double)c->near_distance / t;
    double rim = fmin(fmin(a, 1 - a), fmin(b, 1 - b));
    return t > 0 && rim > 0.03 ? 1 : t <= 0 || rim < -0.03 ? 0 : -1;
}

/* Numbers of pixels: visible and occluded ones of the parallelogram, and others. */
typedef struct drawn {
    uint32_t seen, hidden, beside;
} drawn;

/* A frame with the parallelogram; copies the HDR image at that point to `hdr`. */
static masu_commands draw_leaning(masu_session *s, own_renderer *x, const painter *p,
                                  const masu_frame_desc *frame, const masu_headless_buffer *hdr) {
    masu_commands commands = next_frame(x, frame);
    masu_split split = split_of(x, MASU_SPLIT_BEFORE_TONE, commands.rung, frame->viewport);
    masu_frame_view view;
    assert_int_equal(masu_frame_view_of(x->m, &view, &failure), MASU_OK);
    assert_int_equal(view.frame, commands.frame);
    assert_int_equal(view.render_width, split.color.width);
    push q = leaning;
    multiply(view.projection, view.view, q.clip_from_world);
    VkCommandBuffer own[MASU_MAX_PARTS] = {begin_commands(s)};
    paint(own[0], p, &split.color, &q);
    copy_out(own[0], &split.color, hdr->buffer);
    submit(s, &commands, own);
    finish(s, own);
    return commands;
}

static void check_drawn(own_renderer *x, const masu_commands *commands,
                        const masu_frame_desc *frame, const uint16_t *hdr, const uint8_t *shown,
                        uint32_t shown_width, const char *what) {
    masu_readback_image depths = readback_of(x, commands->slot, MASU_READBACK_DEPTH);
    masu_readback_image before = readback_of(x, commands->slot, MASU_READBACK_HDR);
    masu_split split = split_of(x, MASU_SPLIT_BEFORE_TONE, commands->rung, frame->viewport);
    masu_frame_view view;
    assert_int_equal(masu_frame_view_of(x->m, &view, &failure), MASU_OK);
    uint32_t w = split.color.width, h = split.color.height;
    assert_int_equal(w, depths.width);
    assert_int_equal(h, depths.height);
    double expected[3], aspect = (double)view.output_width / view.output_height;
    for (int i = 0; i < 3; i++) expected[i] = (double)leaning.color[i] * (double)view.exposure;
    masu_ref_tone(MASU_TONE_ACES, 1.0, expected, expected);
    drawn n = {0, 0, 0};
    for (uint32_t i = 0; i < w * h; i++) {
        double depth, scene = (double)((const float *)depths.pixels)[i];
        double px = i % w + 0.5 + (double)view.jitter[0], py = i / w + 0.5 + (double)view.jitter[1];
        int met = meets(&leaning, frame->camera, px / w * 2 - 1, py / h * 2 - 1, aspect, &depth);
        if (met < 0 || (met && fabs(depth - scene) < 1e-4 * depth)) continue;
        if (met && depth > scene) {
            n.seen++;
            for (int c = 0; c < 3; c++) {
                double got = half_float(hdr[4 * i + (uint32_t)c]);
                if (got != (double)leaning.color[c])
                    fail_msg("%s: %u, %u: not drawn: %g", what, i % w, i / w, got);
                if (!shown) continue;
                double code = 255.0 * masu_ref_srgb_encode(expected[c]);
                double is = shown[4 * (i / w * shown_width + i % w) + (uint32_t)c];
                if (fabs(is - code) > 1.0)
                    fail_msg("%s: %u, %u shows %g, not %g", what, i % w, i / w, is, code);
            }
        } else {
            n.hidden += met;
            n.beside += !met;
            if (memcmp(&hdr[4 * i], (const uint16_t *)before.pixels + 4 * i, 8) != 0)
                fail_msg("%s: %u, %u: drawn over a closer surface, or outside", what, i % w, i / w);
        }
    }
    if (n.seen < w * h / 50 || n.hidden < w * h / 50 || n.beside < w * h / 50)
        fail_msg("%s: %u visible, %u occluded, %u outside", what, n.seen, n.hidden, n.beside);
}

static masu_desc drawing_desc(const masu_session *s) {
    masu_desc d = desc_of(s, MASU_SPLIT_BEFORE_TONE);
    d.readback = MASU_READBACK_DEPTH | MASU_READBACK_HDR;
    d.tone = MASU_TONE_ACES;
    return d;
}

static void check_drawing(const char *scene) {
    masu_session s;
    char error[ERROR_SIZE], what[80];
    open_scene(&s, scene);
    own_renderer x;
    masu_desc d = drawing_desc(&s);
    make_own(&s, &x, &d);
    masu_split split = split_of(&x, MASU_SPLIT_BEFORE_TONE, 0, 0);
    painter p = make_painter(&s, &split, 1);
    masu_headless_buffer hdr;
    assert_ok(masu_headless_buffer_create(&s.host, W * H * 8, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                          &hdr, error, sizeof error));
    masu_camera shaken = oblique;
    shaken.jitter[0] = 0.4f;
    shaken.jitter[1] = -0.3f;
    masu_light light;
    assert_int_equal(masu_light_of(x.m, &light, &failure), MASU_OK);
    light.exposure = 1.5f;
    for (uint32_t k = 0; k < 3 * RUNGS; k++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = k < 2 * RUNGS ? &oblique : &shaken,
                                 .light = &light, .rung = k % RUNGS};
        masu_commands commands = draw_leaning(&s, &x, &p, &frame, &hdr);
        read_target(&s, &x, pixels[0]);
        snprintf(what, sizeof what, "%s, rung %u, frame %u", scene, commands.rung, k);
        check_drawn(&x, &commands, &frame, hdr.mapped, commands.rung ? NULL : pixels[0], W, what);
    }
    masu_headless_buffer_destroy(&s.host, &hdr);
    destroy_painter(&p);
    unmake_own(&s, &x);
    close_session(&s);
}

static void what_is_drawn_is_tested_against_the_scene(void **state) {
    (void)state;
    check_drawing("test_both");
    check_drawing("test_sphere_sdf");
    check_drawing("test_live_bare");
}

static void the_same_in_viewports_and_after_a_resize(void **state) {
    (void)state;
    masu_session s;
    char error[ERROR_SIZE], what[80];
    open_scene(&s, "test_both");
    own_renderer x;
    masu_desc d = drawing_desc(&s);
    d.targets.storage = 0;
    d.dither = MASU_OFF;
    d.resizable = 1;
    d.viewport_count = 2;
    d.viewports[0] = (masu_viewport){0, 0, 81, 90};
    d.viewports[1] = (masu_viewport){81, 0, 79, 66};
    make_own(&s, &x, &d);
    masu_split split = split_of(&x, MASU_SPLIT_BEFORE_TONE, 0, 1);
    assert_int_equal(split.color.image_width, W);
    assert_int_equal(split.color.width, 79);
    painter p = make_painter(&s, &split, 1);
    masu_headless_buffer hdr;
    assert_ok(masu_headless_buffer_create(&s.host, W * H * 8, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                          &hdr, error, sizeof error));
    for (uint32_t k = 0; k < 8; k++) {
        if (k == 4) {
            static const masu_viewport stacked[] = {{0, 0, 140, 40}, {3, 41, 130, 38}};
            masu_targets t = {.images = &x.target.image, .count = 1};
            masu_detail detail;
            masu_headless_target_destroy(&s.host, &x.target);
            make_target(&s, &x, 140, 80, 0);
            if (masu_resize(x.m, (VkExtent2D){140, 80}, &t, stacked, &detail))
                fail_msg("%s", detail.text);
            masu_split again = split_of(&x, MASU_SPLIT_BEFORE_TONE, 0, 1);
            assert_true(again.color.view == split.color.view &&
                        again.depth.view == split.depth.view);
            assert_int_equal(again.color.image_width, W);
            assert_int_equal(again.color.width, 130);
        }
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &oblique, .rung = k % 4 < 2 ? 0 : 3,
                                 .viewport = k % 2};
        masu_commands commands = draw_leaning(&s, &x, &p, &frame, &hdr);
        snprintf(what, sizeof what, "frame %u", k);
        check_drawn(&x, &commands, &frame, hdr.mapped, NULL, 0, what);
    }
    masu_headless_buffer_destroy(&s.host, &hdr);
    destroy_painter(&p);
    unmake_own(&s, &x);
    close_session(&s);
}

/* Mean relative error of the depths of the unit sphere at the origin, at the rays of a projection
 * that hit it. */
static double sphere_error(const masu_frame_view *v, const float p[16],
                           masu_readback_image depths) {
    double sum = 0.0;
    uint32_t n = 0, w = depths.width, h = depths.height;
    for (uint32_t i = 0; i < w * h; i++) {
        double x = (i % w + 0.5) / w * 2 - 1, y = (i / w + 0.5) / h * 2 - 1, ray[3];
        double in_view[3] = {(x + (double)p[2]) / (double)p[0], (y + (double)p[6]) / (double)p[5],
                             -1.0};
        for (int k = 0; k < 3; k++) {
            ray[k] = 0.0;
            for (int r = 0; r < 3; r++) ray[k] += in_view[r] * (double)v->view[4 * r + k];
        }
        double a = dot(ray, ray), b = dot(ray, v->position),
               c = dot(v->position, v->position) - 1.0;
        double root = b * b - a * c, depth = (double)((const float *)depths.pixels)[i];
        if (root < 0.05 * b * b || depth <= 0.0) continue;
        double expected = (double)v->near_distance * a / (-b - sqrt(root));
        sum += fabs(depth / expected - 1.0);
        n++;
    }
    assert_true(n > w * h / 20);
    return sum / n;
}

static void matrices_are_those_of_the_picture(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, "test_sphere_sdf");
    own_renderer x;
    masu_desc d = drawing_desc(&s);
    make_own(&s, &x, &d);
    masu_camera shaken = oblique;
    shaken.jitter[0] = 0.4f;
    shaken.jitter[1] = -0.3f;
    for (uint32_t k = 0; k < 12; k++) {
        const uint32_t rung = k % 2 ? 3 : 0;
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = k < 4 ? &oblique : &shaken,
                                 .rung = rung};
        masu_commands commands = next_frame(&x, &frame);
        submit(&s, &commands, NULL);
        finish(&s, NULL);
        masu_frame_view view;
        assert_int_equal(masu_frame_view_of(x.m, &view, &failure), MASU_OK);
        masu_readback_image depths = readback_of(&x, commands.slot, MASU_READBACK_DEPTH);
        double own = sphere_error(&view, view.projection, depths);
        double other = sphere_error(&view, view.output_projection, depths);
        if (!(own < 1e-4)) fail_msg("frame %u: depths have an error of %g", k, own);
        int resolves = rung == 3, shifted = fabsf(view.jitter[0]) + fabsf(view.jitter[1]) > 0.1f;
        if (resolves && shifted && !(other > 5.0 * own))
            fail_msg("frame %u: %g without jitter, %g with", k, other, own);
        if (!resolves)
            assert_memory_equal(view.projection, view.output_projection, sizeof view.projection);
        if (resolves)
            assert_true(fabsf(view.output_projection[2]) < 1e-6f &&
                        fabsf(view.output_projection[6]) < 1e-6f);
        if (rung == 0) assert_true(view.jitter[0] == frame.camera->jitter[0]);
        assert_true(view.position[2] == oblique.position[2]);
        assert_int_equal(view.output_width, W);
    }
    unmake_own(&s, &x);
    close_session(&s);
}

/* ---- Over the final image -------------------------------------------------------------------- */

/* Half transparent, on the left half of the output, and again with frames in flight, without waits
 * between them. */
static void what_is_drawn_over_the_picture_is_shown(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, "test_velocity_mesh"); /* no surface has noise of each frame */
    own_renderer x;
    masu_desc d = desc_of(&s, MASU_SPLIT_AFTER_UPSCALE);
    d.targets.storage = 0;
    d.dither = MASU_OFF;
    make_own(&s, &x, &d);
    masu_split split = split_of(&x, MASU_SPLIT_AFTER_UPSCALE, 0, 0);
    assert_int_equal(split.part, 0);
    assert_true(!split.depth.image && !split.hdr.image && !split.velocity.image);
    painter p = make_painter(&s, &split, 0);
    push q = {.clip_from_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
              .corner = {-1, -1, 0.5f, 0},
              .along = {1, 0, 0, 0},
              .across = {0, 2, 0, 0},
              .color = {0.4f, 0.2f, 0.0f, 0.5f}};
    for (uint32_t flying = 0; flying < 2; flying++) {
        for (uint32_t r = 0; r < RUNGS; r++) {
            masu_frame_desc frame = {MASU_FRAME_DESC, .rung = r, .cut = 1};
            VkCommandBuffer own[2][MASU_MAX_PARTS] = {{VK_NULL_HANDLE}};
            for (uint32_t i = 0; i < 2; i++) {
                masu_commands commands = next_frame(&x, &frame);
                if (i || flying) own[i][0] = begin_commands(&s);
                if (i || flying) paint(own[i][0], &p, &split.color, &q);
                submit(&s, &commands, own[i]);
                if (i || !flying) finish(&s, own[i]);
                if (i || !flying) read_target(&s, &x, pixels[i]);
            }
            if (flying) {
                finish(&s, own[0]);
                continue;
            }
            uint32_t off = 0;
            for (uint32_t i = 0; i < BYTES; i++) {
                double expected = pixels[0][i];
                if (i / 4 % W < W / 2 && i % 4 < 3)
                    expected = expected * 0.5 + 255.0 * (double)q.color[i % 4];
                off += fabs(pixels[1][i] - expected) > 1.5;
            }
            /* In the second frame, reflections have other noise, and a rung with temporal has other
             * jitter too. */
            if (off > (r == 3 ? BYTES / 4 : BYTES / 50))
                fail_msg("rung %u: %u bytes are not as expected", r, off);
            double sum = 0;
            for (uint32_t i = 0; i < BYTES; i += 4)
                sum += abs(pixels[1][i] - pixels[0][i]) * (i / 4 % W < W / 2);
            assert_true(sum > 5.0 * W * H / 2);
        }
    }
    destroy_painter(&p);
    unmake_own(&s, &x);
    close_session(&s);
}

/* Without a scene, and with a storage target, which is the host's. */
static void an_upscaled_source_and_a_storage_target_have_the_point_too(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, "test_live_bare");
    own_renderer x;
    masu_desc d = desc_of(&s, MASU_SPLIT_AFTER_UPSCALE);
    make_own(&s, &x, &d);
    masu_split split = split_of(&x, MASU_SPLIT_AFTER_UPSCALE, 1, 0);
    assert_true(!split.color.image && !split.color.view);
    assert_int_equal(split.color.layout, VK_IMAGE_LAYOUT_GENERAL);
    assert_int_equal(split.color.width, W);
    masu_commands commands = next_frame(&x, &(masu_frame_desc){MASU_FRAME_DESC, .rung = 1});
    char error[ERROR_SIZE];
    masu_headless_buffer copy;
    assert_ok(masu_headless_buffer_create(&s.host, BYTES, VK_BUFFER_USAGE_TRANSFER_DST_BIT, &copy,
                                          error, sizeof error));
    split.color.image = x.target.image;
    VkCommandBuffer own[MASU_MAX_PARTS] = {begin_commands(&s)};
    copy_out(own[0], &split.color, copy.buffer);
    submit(&s, &commands, own);
    finish(&s, own);
    read_target(&s, &x, pixels[0]);
    assert_memory_equal(copy.mapped, pixels[0], BYTES);
    unmake_own(&s, &x);
    masu_headless_source source;
    assert_ok(masu_headless_source_create(&s.host, pixels[0], W, H, W, H, 0, &source, error,
                                          sizeof error));
    d.scene = NULL;
    d.targets.storage = 0;
    d.source = (masu_source){.view = source.view, .width = W / 2, .height = H / 2};
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.scale = 1.0f};
    d.debug.counters = 0;
    make_own(&s, &x, &d);
    split = split_of(&x, MASU_SPLIT_AFTER_UPSCALE, 0, 0);
    commands = next_frame(&x, &(masu_frame_desc){MASU_FRAME_DESC});
    assert_int_equal(commands.part_count, 2);
    own[0] = begin_commands(&s);
    copy_out(own[0], &split.color, copy.buffer);
    submit(&s, &commands, own);
    finish(&s, own);
    read_target(&s, &x, pixels[0]);
    assert_memory_equal(copy.mapped, pixels[0], BYTES);
    masu_frame_view view;
    assert_int_equal(masu_frame_view_of(x.m, &view, &failure), MASU_ERROR_STATE);
    unmake_own(&s, &x);
    masu_headless_source_destroy(&s.host, &source);
    masu_headless_buffer_destroy(&s.host, &copy);
    close_session(&s);
}

/* ---- Missing objects ------------------------------------------------------------------------- */

static void what_is_not_there_is_named(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, "test_live_bare");
    own_renderer x;
    masu_desc d = desc_of(&s, MASU_SPLIT_BEFORE_TONE);
    make_own(&s, &x, &d);
    masu_split split;
    masu_frame_view view;
    assert_int_equal(masu_frame_view_of(x.m, &view, &failure), MASU_ERROR_STATE); /* no frame yet */
    assert_int_equal(masu_split_of(x.m, MASU_SPLIT_AFTER_UPSCALE, 0, 0, &split, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "which");
    assert_int_equal(masu_split_of(x.m, MASU_SPLIT_ALL, 0, 0, &split, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_split_of(x.m, MASU_SPLIT_BEFORE_TONE, RUNGS, 0, &split, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "rung 5 does not exist, the last one is 4");
    assert_int_equal(masu_split_of(x.m, MASU_SPLIT_BEFORE_TONE, 0, 1, &split, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "viewport 1 does not exist, the last one is 0");
    unmake_own(&s, &x);
    close_session(&s);
}

/* The plan reports the bytes of a split; without a split there are none. */
static void memory_is_what_it_was_without(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, "test_both");
    masu_detail detail;
    masu_memory plain, with, keeping;
    VkImage image = s.images[0];
    VkImageView target_view = s.views[0];
    masu_desc d = desc_of(&s, 0);
    d.targets.images = &image;
    d.targets.views = &target_view;
    d.targets.count = 1;
    /* The peak is at upscaling; the split keeps images across it that otherwise share their
     * memory. */
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.scale = 0.5f};
    assert_int_equal(masu_memory_query(&d, &plain, &detail), MASU_OK);
    d.split = MASU_SPLIT_BEFORE_TONE | MASU_SPLIT_AFTER_UPSCALE;
    assert_int_equal(masu_memory_query(&d, &with, &detail), MASU_OK);
    d.split |= MASU_SPLIT_KEEP | MASU_SPLIT_VELOCITY;
    assert_int_equal(masu_memory_query(&d, &keeping, &detail), MASU_OK);
    assert_true(with.transient_unaliased > plain.transient_unaliased);   /* split_depth */
    assert_true(keeping.transient_aliased > with.transient_aliased);
    assert_true(with.host_bytes > plain.host_bytes); /* two more command buffers for each */
    d.split = 0;
    masu_memory again;
    assert_int_equal(masu_memory_query(&d, &again, &detail), MASU_OK);
    assert_memory_equal(&again, &plain, sizeof plain);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_nothing_between_the_picture_is_the_same),
        cmocka_unit_test(what_is_copied_is_what_is_read_back),
        cmocka_unit_test(what_is_drawn_is_tested_against_the_scene),
        cmocka_unit_test(matrices_are_those_of_the_picture),
        cmocka_unit_test(the_same_in_viewports_and_after_a_resize),
        cmocka_unit_test(what_is_drawn_over_the_picture_is_shown),
        cmocka_unit_test(an_upscaled_source_and_a_storage_target_have_the_point_too),
        cmocka_unit_test(what_is_not_there_is_named),
        cmocka_unit_test(memory_is_what_it_was_without),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
