/* pipelines.c: descriptor set layouts, shader modules, pipelines and render passes, derived from
 * the pass table. A shader module exists only while its pipeline is created. */
#include "device/pipelines.h"

#include "device/capabilities.h"
#include "device/pool.h"
#include "device/shaders.h"
#include "plan/buffer_plan.h"
#include "plan/push.h"

#include "base/error.h"
#include "device/bind.h"
#include "scene/code.h"
#include "scene/scene.h"
#include "scene/trace.h"
#include "shared/masu_shared.h"

#include <string.h>

/* Unpacks the shader into a mapped block that nothing else uses yet, or into host memory if frames
 * may use the block already. The driver keeps its own copy, so the memory can be used again. */
static masu_result create_module(masu_device *m, uint32_t pass, masu_code code,
                                 VkShaderModule *module, masu_detail *detail) {
    uint32_t *mapped = (uint32_t *)(void *)m->mapped[masu_code_role(m->plan)];
    const uint32_t *words =
        masu_code_read(m->plan, pass, &code, m->code_room ? m->code_room : mapped);
    if (!words)
        return masu_fail(detail, MASU_ERROR_DEVICE, "shader", code.bytes, 0,
                         "a shader of %llu bytes cannot be unpacked",
                         (unsigned long long)code.bytes);
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = (size_t)code.bytes,
                                     .pCode = words};
    VkResult r = m->vk.CreateShaderModule(m->vk.device, &info, m->vk.allocator, module);
    return MASU_FAILED(r, *module) ? masu_fail_vulkan(detail, r, "vkCreateShaderModule") : MASU_OK;
}

static uint64_t now(const masu_device *m) {
    return m->plan->desc.clock_ns ? m->plan->desc.clock_ns(m->plan->desc.clock_user) : 0;
}

/* Specialisation constants, by constant_id. A shader has those that it declares.
 *
 *    0  compute: counters are kept; other shaders: alpha test (or, for transparent surfaces,
 *       the multiplying pass of coloured transmission)
 *    1  the sky may be the analytic one         2  the scene has fog
 *    3  the sky is an environment map           4  reflections are traced
 *    5  tone curve                              6  encoding of the target
 *    7  the last pass dithers to its steps or swaps channels
 *    8  the output is a whole number of workgroups
 *    9  stack size of BVH traversal            10  the invocations of a tile share rays
 *   11  clear coats with their own maps or normals
 *   12  coloured transmission                  13  the output size is fixed
 *   14  temporal accumulation of reflections is stored as half floats
 *   15  albedo texels hold emission            16  G-buffer normals may be from normal maps
 *   17  capsule or rectangle lights            18  rays share the lighting of surfaces they hit
 *   19  bit 0: rays sample vertex colours; bit 1: maps on the second texture coordinates
 *   20  skins have morph targets           21  opaque materials have lobes (specular colour, sheen,
 *                                              anisotropy)
 *   22  orthographic cameras: few bits of depth are kept as those of 1 - depth
 *   23  materials may show live textures
 *   24  MASU_DRAWS_* of materials.h           25  frames change the environment
 *   26  few registers (masu_few_registers) */

static VkSpecializationInfo specialise(const masu_device *m, VkBool32 first,
                                       VkBool32 constants[MASU_SPECIAL_COUNT]) {
#define ENTRY(n)                                                                                   \
    { n, (n) * sizeof *constants, sizeof *constants }
    static const VkSpecializationMapEntry entries[MASU_SPECIAL_COUNT] = {
        ENTRY(0),  ENTRY(1),  ENTRY(2),  ENTRY(3),  ENTRY(4),  ENTRY(5),  ENTRY(6),
        ENTRY(7),  ENTRY(8),  ENTRY(9),  ENTRY(10), ENTRY(11), ENTRY(12), ENTRY(13),
        ENTRY(14), ENTRY(15), ENTRY(16), ENTRY(17), ENTRY(18), ENTRY(19), ENTRY(20),
        ENTRY(21), ENTRY(22), ENTRY(23), ENTRY(24), ENTRY(25), ENTRY(26)};
#undef ENTRY
    constants[0] = first;
    constants[1] = m->plan->needs.sky != 0;
    constants[2] = m->plan->scene.fog != 0;
    constants[3] = m->plan->needs.environment != 0;
    constants[4] = m->plan->needs.reflections != 0;
    constants[5] = (uint32_t)m->plan->desc.tone;
    masu_encoding encoding = m->plan->desc.targets.encoding;
    constants[6] = encoding == MASU_ENCODING_LINEAR ? MASU_OUTPUT_LINEAR
                   : encoding == MASU_ENCODING_PQ   ? MASU_OUTPUT_PQ
                                                    : MASU_OUTPUT_SRGB;
    constants[7] = m->plan->output.steps[0] || (m->plan->output.flags & MASU_OUTPUT_SWAP);
    VkExtent2D output = m->plan->desc.output;
    int sized = !m->plan->desc.resizable && !m->plan->desc.viewport_count;
    constants[8] = sized && output.width % MASU_GROUP == 0 && output.height % MASU_GROUP == 0;
    /* The root is never pushed, and traversal of the lowest level pushes nothing: hence - 2. */
    const masu_scene_data *scene = &m->plan->scene;
    uint32_t levels = masu_trace_top_levels(scene->trace_instances) + scene->trace_levels - 2;
    constants[9] = (uint32_t)masu_align_up(
        levels, 4); /* rounded up so that scenes of similar size share pipelines */
    constants[10] = m->plan->desc.debug.share_rays == MASU_ON;
    constants[11] = scene->own_coats != 0;
    constants[12] = scene->tints;
    constants[13] = sized;
    constants[14] = (VkBool32)masu_has_half_means(m->plan);
    constants[15] = m->plan->needs.emission_packed != 0;
    constants[16] = m->plan->scene.reliefs != 0;
    constants[17] = m->plan->needs.area_lights != 0;
    constants[18] = m->plan->needs.shared_lights != 0;
    constants[19] = scene->vertex_colors | scene->second_texcoords << 1;
    constants[20] = scene->skin_targets != 0;
    constants[21] = scene->lobes;
    constants[22] = scene->flat_lens;
    constants[23] = m->plan->needs.texture_maps != 0;
    constants[24] = (m->plan->needs.looks ? MASU_DRAWS_LOOKS : 0u) |
                    (scene->depth_biases ? MASU_DRAWS_BIASES : 0u);
    constants[25] = m->plan->desc.live_environment != 0;
    constants[26] = (VkBool32)masu_few_registers(&m->vk.properties);
    return (VkSpecializationInfo){MASU_SPECIAL_COUNT, entries,
                                  MASU_SPECIAL_COUNT * sizeof *constants, constants};
}

/* Key of a pipeline in the pool; 0 without a pool. */
static uint64_t key_of(const masu_device *m, uint32_t pass, const masu_code codes[2], uint32_t form,
                       const VkBool32 constants[MASU_SPECIAL_COUNT]) {
    if (!m->plan->desc.vulkan.pipelines) return 0;
    return masu_pool_key(m, pass, codes, form, constants, MASU_SPECIAL_COUNT);
}

/* ---- Layouts --------------------------------------------------------------------------------- */

static masu_result create_set_layout(masu_device *m, const VkDescriptorSetLayoutBinding *bindings,
                                     uint32_t count, VkDescriptorSetLayout *out,
                                     masu_detail *detail) {
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = count,
                                            .pBindings = bindings};
    VkResult r = m->vk.CreateDescriptorSetLayout(m->vk.device, &info, m->vk.allocator, out);
    return MASU_FAILED(r, *out) ? masu_fail_vulkan(detail, r, "vkCreateDescriptorSetLayout")
                                : MASU_OK;
}

/* Set 2: the textures of a draw, and live textures. */
static masu_result create_texture_layout(masu_device *m, masu_detail *detail) {
    if (!m->plan->scene.texture_arrays) return MASU_OK;
    VkDescriptorSetLayoutBinding bindings[MASU_MAP_COUNT];
    for (uint32_t i = 0; i < MASU_MAP_COUNT; i++) {
        bindings[i] =
            (VkDescriptorSetLayoutBinding){i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
                                           VK_SHADER_STAGE_FRAGMENT_BIT, NULL};
    }
    return create_set_layout(m, bindings, MASU_MAP_COUNT, &m->texture_layout, detail);
}

/* Set 1: reads first, then writes, in the order of the pass's row. */
static masu_result create_pass_layout(masu_device *m, uint32_t pass, masu_detail *detail) {
    const masu_rung_plan *rp = masu_first_rung(m->plan, pass);
    if (!rp) return MASU_OK;
    /* an access that reads and writes has two */
    VkDescriptorSetLayoutBinding bindings[2 * MASU_PASS_ACCESSES];
    uint32_t n = 0;
    int compute = masu_passes[pass].kind == MASU_PASS_COMPUTE;
    VkShaderStageFlags stages =
        compute ? VK_SHADER_STAGE_COMPUTE_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
    if (masu_passes[pass].geometry == MASU_GEOMETRY_SPRITES) stages |= VK_SHADER_STAGE_VERTEX_BIT;
    for (int writes = 0; writes < 2 && masu_has_set(pass); writes++) {
        for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
            if (!masu_access_binds(rp->access[pass][a], writes)) continue;
            bindings[n] = (VkDescriptorSetLayoutBinding){
                n,
                writes ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                       : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                1, stages,
                writes ? NULL
                : rp->access[pass][a].usage == MASU_READ ? &m->sampler
                                                         : &m->linear};
            n++;
        }
    }
    VkDescriptorSetLayoutBinding global[MASU_BIND_COUNT];
    uint32_t global_count = masu_global_bindings(m->plan, pass, global);
    masu_result result = create_set_layout(m, bindings, n, &m->pass_layouts[pass], detail);
    if (!result)
        result = create_set_layout(m, global, global_count, &m->global_layouts[pass], detail);
    if (result) return result;
    VkDescriptorSetLayout sets[] = {m->global_layouts[pass], m->pass_layouts[pass],
                                    m->texture_layout};
    VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(masu_push_block)};
    if (!compute) push.stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount =
                                             masu_draws_polygons(pass) && m->texture_layout ? 3 : 2,
                                         .pSetLayouts = sets,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &push};
    VkResult r =
        m->vk.CreatePipelineLayout(m->vk.device, &layout, m->vk.allocator, &m->layouts[pass]);
    if (MASU_FAILED(r, m->layouts[pass]))
        return masu_fail_vulkan(detail, r, "vkCreatePipelineLayout");
    masu_name(m, VK_OBJECT_TYPE_PIPELINE_LAYOUT, MASU_HANDLE(m->layouts[pass]),
              masu_passes[pass].name);
    return MASU_OK;
}

/* ---- Compute --------------------------------------------------------------------------------- */

/* If a pass has two pipelines, the one for rungs in which the pass is the last is named "NAME,
 * last". */
static void name_form(const masu_device *m, uint32_t pass, int last, VkPipeline pipeline) {
    static const char ending[] = ", last";
    const char *name = masu_passes[pass].name;
    char both[64];
    size_t length = strlen(name);
    int apart = 0;
    for (uint32_t r = 0; r < m->plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &m->plan->rungs[r];
        apart |= masu_has_pass(&rp->active, pass) && !masu_comes_last(rp, pass);
    }
    if (last && apart && length + sizeof ending <= sizeof both) {
        memcpy(both, name, length);
        memcpy(both + length, ending, sizeof ending);
        name = both;
    }
    masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(pipeline), name);
}

static masu_result create_compute(masu_device *m, uint32_t pass, int last, VkPipeline *out,
                                  masu_detail *detail) {
    VkShaderModule module = VK_NULL_HANDLE;
    VkBool32 constants[MASU_SPECIAL_COUNT];
    VkSpecializationInfo special = specialise(m, m->plan->desc.debug.counters != 0, constants);
    masu_code codes[2] = {masu_compute_code(m->plan, pass, last), {0}};
    uint64_t key = key_of(m, pass, codes, 0, constants);
    if (masu_pool_acquire(m, key, out)) return MASU_OK;
    masu_result result = create_module(m, pass, codes[0], &module, detail);
    if (result) return result;
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &special},
        .layout = m->layouts[pass]};
    uint64_t start = now(m);
    VkResult r = m->vk.CreateComputePipelines(m->vk.device, m->plan->desc.vulkan.pipeline_cache, 1,
                                              &info, m->vk.allocator, out);
    m->pipeline_ns[pass] += now(m) - start;
    m->vk.DestroyShaderModule(m->vk.device, module, m->vk.allocator);
    if (MASU_FAILED(r, *out)) return masu_fail_vulkan(detail, r, "vkCreateComputePipelines");
    masu_pool_add(m, out, key);
    name_form(m, pass, last, *out);
    return MASU_OK;
}

/* ---- Graphics -------------------------------------------------------------------------------- */

static uint32_t color_attachments(const masu_device *m, uint32_t pass) {
    const masu_rung_plan *rp = masu_first_rung(m->plan, pass);
    uint32_t count = 0;
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        masu_usage usage = (masu_usage)rp->access[pass][a].usage;
        count +=
            usage == MASU_WRITE_COLOR || usage == MASU_BLEND_COLOR || usage == MASU_UPDATE_COLOR;
    }
    return count;
}

/* gbuffer.frag declares an emission output after all others, except with the surface image and
 * without emission (axis OUTPUTS). Without an emission attachment the output gets an unused
 * attachment reference; every device has as many attachments. */
static int has_unused_emission(const masu_device *m, uint32_t pass) {
    return masu_passes[pass].geometry == MASU_GEOMETRY_POLYGONS && !m->plan->needs.emissive &&
           !m->plan->needs.surface;
}

/* Initial and final layouts are those that the row's barriers set: the render pass transitions
 * nothing, so record.c is the only file that manages layouts. Only the render area is cleared:
 * rendering a cascade keeps the other cascades of the shadow map. Emitting materials have a second
 * subpass with one more attachment. The alternative, write masks per attachment, needs the
 * independentBlend feature, which hosts may not have enabled. */
static masu_result create_render_pass(masu_device *m, uint32_t pass, masu_detail *detail) {
    VkAttachmentDescription attachments[MASU_PASS_ACCESSES];
    VkAttachmentReference colors[MASU_PASS_ACCESSES], depth = {0, VK_IMAGE_LAYOUT_UNDEFINED};
    VkImageView views[MASU_PASS_ACCESSES];
    uint32_t n = 0, color_count = 0, emission = 0, width = 0, height = 0;
    const masu_rung_plan *rp = masu_first_rung(m->plan, pass);
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        masu_access access = rp->access[pass][a];
        int is_depth = access.usage == MASU_WRITE_DEPTH || access.usage == MASU_UPDATE_DEPTH ||
                       access.usage == MASU_KEEP_DEPTH;
        int kept = access.usage == MASU_BLEND_COLOR || access.usage == MASU_KEEP_DEPTH;
        int part = access.usage == MASU_UPDATE_COLOR;
        if (!is_depth && !kept && !part && access.usage != MASU_WRITE_COLOR) continue;
        emission += part;
        VkImageLayout layout = is_depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                        : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        if (is_depth) {
            depth = (VkAttachmentReference){n, layout};
        } else {
            colors[color_count++] = (VkAttachmentReference){n, layout};
        }
        attachments[n] =
            (VkAttachmentDescription){.format = masu_images[access.image].format,
                                      .samples = VK_SAMPLE_COUNT_1_BIT,
                                      .loadOp = kept ? VK_ATTACHMENT_LOAD_OP_LOAD
                                                : part ? VK_ATTACHMENT_LOAD_OP_DONT_CARE
                                                       : VK_ATTACHMENT_LOAD_OP_CLEAR,
                                      .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                      .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                      .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                      .initialLayout = layout,
                                      .finalLayout = layout};
        views[n++] = m->views[access.image];
        width = m->plan->images[access.image].width;
        height = m->plan->images[access.image].height;
    }
    VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    .colorAttachmentCount = color_count,
                                    .pColorAttachments = colors,
                                    .pDepthStencilAttachment =
                                        depth.layout == VK_IMAGE_LAYOUT_UNDEFINED ? NULL : &depth};
    int apart = emission && masu_has_emission_subpass(m->plan);
    VkAttachmentReference base[MASU_PASS_ACCESSES];
    memcpy(base, colors, sizeof base);
    VkSubpassDescription subpasses[] = {subpass, subpass};
    if (apart || (!emission && has_unused_emission(m, pass))) {
        base[apart ? color_count - 1 : color_count] =
            (VkAttachmentReference){VK_ATTACHMENT_UNUSED, VK_IMAGE_LAYOUT_UNDEFINED};
        subpasses[0].colorAttachmentCount = apart ? color_count : color_count + 1;
        subpasses[0].pColorAttachments = base;
    }
    const VkPipelineStageFlags drawn = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                       VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                       VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    const VkAccessFlags writes =
        VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    VkSubpassDependency order = {.srcSubpass = 0,
                                 .dstSubpass = 1,
                                 .srcStageMask = drawn,
                                 .dstStageMask = drawn,
                                 .srcAccessMask = writes,
                                 .dstAccessMask =
                                     writes | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
                                 .dependencyFlags = VK_DEPENDENCY_BY_REGION_BIT};
    VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                   .attachmentCount = n,
                                   .pAttachments = attachments,
                                   .subpassCount = apart ? 2 : 1,
                                   .pSubpasses = subpasses,
                                   .dependencyCount = apart ? 1 : 0,
                                   .pDependencies = &order};
    VkResult r =
        m->vk.CreateRenderPass(m->vk.device, &info, m->vk.allocator, &m->render_passes[pass]);
    if (MASU_FAILED(r, m->render_passes[pass]))
        return masu_fail_vulkan(detail, r, "vkCreateRenderPass");
    VkFramebufferCreateInfo frame = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = m->render_passes[pass],
                                     .attachmentCount = n,
                                     .pAttachments = views,
                                     .width = width,
                                     .height = height,
                                     .layers = 1};
    r = m->vk.CreateFramebuffer(m->vk.device, &frame, m->vk.allocator, &m->framebuffers[pass]);
    return MASU_FAILED(r, m->framebuffers[pass])
               ? masu_fail_vulkan(detail, r, "vkCreateFramebuffer")
               : MASU_OK;
}

/* Whether the pass blends over the existing image. */
static int blends_color(const masu_device *m, uint32_t pass) {
    const masu_rung_plan *rp = masu_first_rung(m->plan, pass);
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        if (rp->access[pass][a].usage == MASU_BLEND_COLOR) return 1;
    }
    return 0;
}

/* textured: with texture coordinates. masked: with the alpha test; for transparent surfaces, the
 * pass that multiplies the image by the colour of the transmission. culled: with back-face culling.
 * emitting: in the second subpass. */
static VkResult create_graphics_pipeline(masu_device *m, uint32_t pass,
                                         const VkShaderModule modules[2], int textured,
                                         VkBool32 masked, int culled, int emitting,
                                         VkPipeline *out) {
    masu_geometry geometry = masu_passes[pass].geometry;
    int polygons = masu_draws_polygons(pass); /* else the vertex shader generates the vertices */
    int blends = blends_color(m, pass);
    int depths = geometry == MASU_GEOMETRY_POLYGONS || geometry == MASU_GEOMETRY_CASCADE ||
                 geometry == MASU_GEOMETRY_BOXES || geometry == MASU_GEOMETRY_PICK ||
                 geometry == MASU_GEOMETRY_DEPTHS || geometry == MASU_GEOMETRY_CASTERS ||
                 geometry == MASU_GEOMETRY_TILES;
    VkBool32 constants[MASU_SPECIAL_COUNT];
    VkSpecializationInfo special = specialise(m, masked, constants);
    VkPipelineShaderStageCreateInfo stages[2];
    for (uint32_t i = 0; i < 2; i++) {
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT,
            .module = modules[i],
            .pName = "main",
            .pSpecializationInfo = &special};
    }
    VkVertexInputBindingDescription bindings[] = {
        {0, sizeof(masu_blob_vertex), VK_VERTEX_INPUT_RATE_VERTEX},
        {1, 2 * sizeof(float), VK_VERTEX_INPUT_RATE_VERTEX},
        {2, m->plan->scene.second_texcoords ? 2 * sizeof(float) : 0, VK_VERTEX_INPUT_RATE_VERTEX},
        {3, m->plan->scene.vertex_colors ? sizeof(uint32_t) : 0, VK_VERTEX_INPUT_RATE_VERTEX}};
    int shaded = geometry == MASU_GEOMETRY_POLYGONS || geometry == MASU_GEOMETRY_BLENDED;
    int attributed = textured && shaded && masu_has_attributes(&m->plan->scene);
    VkVertexInputAttributeDescription attributes[] = {
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(masu_blob_vertex, position)},
        {1, 0, VK_FORMAT_R16G16_SNORM, offsetof(masu_blob_vertex, normal)},
        {2, 1, VK_FORMAT_R32G32_SFLOAT, 0},
        {3, 2, VK_FORMAT_R32G32_SFLOAT, 0},
        {4, 3, VK_FORMAT_R8G8B8A8_UNORM, 0}};
    VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = attributed ? 4 : textured ? 2 : polygons ? 1 : 0,
        .pVertexBindingDescriptions = bindings,
        .vertexAttributeDescriptionCount = attributed ? 5 : textured ? 3 : polygons ? 2 : 0,
        .pVertexAttributeDescriptions = attributes};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    /* Back faces are culled only for single-sided materials: CAD data has inconsistent winding, and
     * shaders turn the normal towards the camera. */
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = culled ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE,
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
        .lineWidth = 1.0f};
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = depths ? VK_TRUE : VK_FALSE,
        .depthWriteEnable = depths ? VK_TRUE : VK_FALSE,
        .depthCompareOp =
            geometry == MASU_GEOMETRY_TILES ? VK_COMPARE_OP_ALWAYS : VK_COMPARE_OP_GREATER};
    VkPipelineColorBlendAttachmentState blend[5];
    memset(blend, 0, sizeof blend);
    for (uint32_t i = 0; i < 5; i++) {
        blend[i].colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                  VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    }
    if (blends) { /* premultiplied alpha; the alpha of the image is kept */
        blend[0].blendEnable = VK_TRUE;
        blend[0].srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
        blend[0].dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        blend[0].srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
        blend[0].dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
        if (geometry == MASU_GEOMETRY_BLENDED && masked) {
            blend[0].srcColorBlendFactor = VK_BLEND_FACTOR_ZERO;
            blend[0].dstColorBlendFactor = VK_BLEND_FACTOR_SRC_COLOR;
        }
    }
    VkPipelineColorBlendStateCreateInfo blending = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = color_attachments(m, pass) + (uint32_t)has_unused_emission(m, pass),
        .pAttachments = blend};
    VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamics = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = dynamic};
    VkGraphicsPipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                         .stageCount = modules[1] ? 2 : 1,
                                         .pStages = stages,
                                         .pVertexInputState = &input,
                                         .pInputAssemblyState = &assembly,
                                         .pViewportState = &viewport,
                                         .pRasterizationState = &raster,
                                         .pMultisampleState = &samples,
                                         .pDepthStencilState = &depth,
                                         .pColorBlendState = &blending,
                                         .pDynamicState = &dynamics,
                                         .layout = m->layouts[pass],
                                         .renderPass = m->render_passes[pass],
                                         .subpass = emitting ? 1 : 0};
    return m->vk.CreateGraphicsPipelines(m->vk.device, m->plan->desc.vulkan.pipeline_cache, 1,
                                         &info, m->vk.allocator, out);
}

/* The creation time is added to that of the pass. */
static masu_result create_pipeline(masu_device *m, uint32_t pass, int textured, VkBool32 masked,
                                   int culled, int emitting, VkPipeline *out, masu_detail *detail) {
    masu_draw_code code = masu_draw_code_of(m->plan, pass, textured);
    const masu_code codes[2] = {code.vertex, code.fragment};
    VkBool32 constants[MASU_SPECIAL_COUNT];
    (void)specialise(m, masked, constants);
    uint32_t form =
        (uint32_t)textured | (culled ? 2u : 0u) | (masked ? 4u : 0u) | (emitting ? 8u : 0u);
    if (masu_passes[pass].geometry == MASU_GEOMETRY_POLYGONS && masu_has_emission_subpass(m->plan))
        form |= 16u;
    uint64_t key = key_of(m, pass, codes, form, constants);
    if (masu_pool_acquire(m, key, out)) return MASU_OK;
    VkShaderModule modules[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    masu_result result = create_module(m, pass, code.vertex, &modules[0], detail);
    if (!result && code.fragment.bytes)
        result = create_module(m, pass, code.fragment, &modules[1], detail);
    if (!result) {
        uint64_t start = now(m);
        VkResult r =
            create_graphics_pipeline(m, pass, modules, textured, masked, culled, emitting, out);
        m->pipeline_ns[pass] += now(m) - start;
        if (MASU_FAILED(r, *out))
            result = masu_fail_vulkan(detail, r, "vkCreateGraphicsPipelines");
        else
            masu_pool_add(m, out, key);
    }
    for (uint32_t i = 0; i < 2; i++)
        m->vk.DestroyShaderModule(m->vk.device, modules[i], m->vk.allocator);
    return result;
}

/* Pipelines for textured and for alpha-tested materials. */
static masu_result create_textured(masu_device *m, uint32_t pass, masu_detail *detail) {
    masu_result result = MASU_OK;
    for (uint32_t i = 0; i < MASU_TEXTURED_COUNT && !result; i++) {
        if (i == MASU_TEXTURED_MASK && !m->plan->scene.masks) continue;
        result =
            create_pipeline(m, pass, 1, i == MASU_TEXTURED_MASK, 0, 0, &m->textured[i], detail);
        masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->textured[i]),
                  i == MASU_TEXTURED_MASK ? "gbuffer, masks" : "gbuffer, textured");
    }
    return result;
}

/* The same pipelines with back-face culling, for single-sided materials. */
static masu_result create_culled(masu_device *m, uint32_t pass, int textures, masu_detail *detail) {
    static const char *const names[MASU_CULLED_COUNT] = {
        "gbuffer, culled", "gbuffer, textured, culled", "gbuffer, masks, culled"};
    masu_result result = MASU_OK;
    for (uint32_t i = 0; i < MASU_CULLED_COUNT && !result && m->plan->scene.singles; i++) {
        int mask = i == 1 + MASU_TEXTURED_MASK;
        if ((i && !textures) || (mask && !m->plan->scene.masks)) continue;
        result =
            create_pipeline(m, pass, i > 0, mask ? VK_TRUE : VK_FALSE, 1, 0, &m->culled[i], detail);
        masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->culled[i]), names[i]);
    }
    return result;
}

/* The same pipelines in the emission subpass, for those draw kinds that have emitting materials. */
static masu_result create_emitting(masu_device *m, uint32_t pass, masu_detail *detail) {
    masu_result result = MASU_OK;
    uint32_t sides = m->plan->scene.singles ? 2 : 1;
    for (uint32_t i = 0;
         i < sides * MASU_CULLED_COUNT && !result && masu_has_emission_subpass(m->plan); i++) {
        uint32_t kind = i % MASU_CULLED_COUNT;
        if (!(m->plan->scene.emissions >> kind & 1u)) continue;
        VkBool32 mask = kind == 1 + MASU_TEXTURED_MASK ? VK_TRUE : VK_FALSE;
        result = create_pipeline(m, pass, kind > 0, mask, i >= MASU_CULLED_COUNT, 1,
                                 &m->emitting[i], detail);
        masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->emitting[i]), "gbuffer, emitting");
    }
    return result;
}

/* Sunlight passes through the holes of alpha-tested materials, so their shadows need textures. */
static masu_result create_masked_casters(masu_device *m, uint32_t pass, masu_detail *detail) {
    if (!m->plan->scene.masks) return MASU_OK;
    masu_result result = create_pipeline(m, pass, 1, VK_TRUE, 0, 0, &m->masked_casters, detail);
    masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->masked_casters), "cascades, masks");
    return result;
}

/* The same for the shadows of local lights. */
static masu_result create_masked_faces(masu_device *m, uint32_t pass, masu_detail *detail) {
    if (!m->plan->scene.masks) return MASU_OK;
    masu_result result = create_pipeline(m, pass, 1, VK_TRUE, 0, 0, &m->masked_faces, detail);
    masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->masked_faces), "local_shadow, masks");
    return result;
}

/* Picking ignores the holes of alpha-tested materials, and transparent surfaces where their opacity
 * is below one half. */
static masu_result create_masked_picks(masu_device *m, uint32_t pass, masu_detail *detail) {
    masu_result result = create_pipeline(m, pass, 1, VK_TRUE, 0, 0, &m->masked_picks, detail);
    masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->masked_picks), "pick, masks");
    return result;
}

static masu_result create_graphics(masu_device *m, uint32_t pass, masu_detail *detail) {
    masu_geometry geometry = masu_passes[pass].geometry;
    int textures = m->texture_layout != VK_NULL_HANDLE;
    masu_result result = create_render_pass(m, pass, detail);
    /* Without polygons the pass only clears its attachments. */
    if (geometry == MASU_GEOMETRY_POLYGONS && !m->plan->needs.raster) return result;
    /* One pipeline for all transparent surfaces. In scenes with textures, surfaces without textures
     * use it too and skip the sampling. */
    int textured = geometry == MASU_GEOMETRY_BLENDED && textures;
    if (!result)
        result = create_pipeline(m, pass, textured, VK_FALSE, 0, 0, &m->pipelines[pass], detail);
    if (!result && geometry == MASU_GEOMETRY_BLENDED && m->plan->scene.tints) {
        result = create_pipeline(m, pass, textured, VK_TRUE, 0, 0, &m->tints, detail);
        masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->tints), "transparents, tints");
    }
    if (!result && geometry == MASU_GEOMETRY_POLYGONS && textures)
        result = create_textured(m, pass, detail);
    if (!result && geometry == MASU_GEOMETRY_POLYGONS)
        result = create_culled(m, pass, textures, detail);
    if (!result && geometry == MASU_GEOMETRY_POLYGONS)
        result = create_emitting(m, pass, detail);
    if (!result && geometry == MASU_GEOMETRY_CASCADE && textures)
        result = create_masked_casters(m, pass, detail);
    if (!result && geometry == MASU_GEOMETRY_CASTERS && textures)
        result = create_masked_faces(m, pass, detail);
    if (!result && geometry == MASU_GEOMETRY_PICK && textures)
        result = create_masked_picks(m, pass, detail);
    return result;
}

/* Creates the samplers that the scene's texture sets use: trilinear, and anisotropic if the device
 * was created with samplerAnisotropy. */
static masu_result create_samplers(masu_device *m, masu_detail *detail) {
    static const VkSamplerAddressMode modes[] = {VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                                 VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                                 VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT};
    if (!m->plan->scene.texture_sets) return MASU_OK;
    masu_scene_view v = masu_scene_data_view(&m->plan->scene);
    float most = m->vk.properties.limits.maxSamplerAnisotropy;
    float anisotropy = m->plan->desc.vulkan.max_anisotropy;
    for (uint32_t i = 0; i < m->plan->scene.texture_sets; i++) {
        const uint32_t *wrap = v.texture_sets[i].wrap;
        VkSampler *sampler = &m->samplers[masu_sampler_of(wrap)];
        if (*sampler) continue;
        VkSamplerCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                    .magFilter =
                                        wrap[0] & 4u ? VK_FILTER_NEAREST : VK_FILTER_LINEAR,
                                    .minFilter = VK_FILTER_LINEAR,
                                    .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                    .addressModeU = modes[wrap[0] & 3u],
                                    .addressModeV = modes[wrap[1]],
                                    .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .anisotropyEnable = anisotropy > 1.0f,
                                    .maxAnisotropy = anisotropy < most ? anisotropy : most,
                                    .maxLod = VK_LOD_CLAMP_NONE};
        VkResult r = m->vk.CreateSampler(m->vk.device, &info, m->vk.allocator, sampler);
        if (MASU_FAILED(r, *sampler)) return masu_fail_vulkan(detail, r, "vkCreateSampler");
    }
    return MASU_OK;
}

/* Takes the sampler from the pool, if there is one: pipeline layouts are compatible only if their
 * immutable samplers are the same. */
static masu_result create_sampler(masu_device *m, uint32_t number, const VkSamplerCreateInfo *info,
                                  VkSampler *out, masu_detail *detail) {
    VkSampler pooled = masu_pool_sampler(m, number);
    if (pooled) {
        *out = pooled;
        return MASU_OK;
    }
    VkResult r = m->vk.CreateSampler(m->vk.device, info, m->vk.allocator, out);
    if (MASU_FAILED(r, *out)) return masu_fail_vulkan(detail, r, "vkCreateSampler");
    masu_pool_add_sampler(m, number, *out);
    return MASU_OK;
}

masu_result masu_create_layouts(masu_device *m, masu_detail *detail) {
    VkSamplerCreateInfo nearest = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = VK_FILTER_NEAREST,
                                   .minFilter = VK_FILTER_NEAREST,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    VkSamplerCreateInfo linear = nearest;
    linear.magFilter = linear.minFilter = VK_FILTER_LINEAR;
    masu_result result = create_sampler(m, 0, &nearest, &m->sampler, detail);
    if (!result) result = create_sampler(m, 1, &linear, &m->linear, detail);
    if (!result) result = create_texture_layout(m, detail);
    if (!result) result = create_samplers(m, detail);
    for (uint32_t p = 0; p < MASU_PASS_COUNT && !result; p++) {
        if (masu_passes[p].kind == MASU_PASS_GRAPHICS || masu_passes[p].kind == MASU_PASS_COMPUTE)
            result = create_pass_layout(m, p, detail);
    }
    return result;
}

masu_result masu_create_pipelines(masu_device *m, uint32_t pass, int last, masu_detail *detail) {
    if (masu_passes[pass].kind == MASU_PASS_COMPUTE)
        return create_compute(m, pass, last, last ? &m->last[pass] : &m->pipelines[pass], detail);
    masu_result result = create_graphics(m, pass, detail);
    if (!result)
        masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->pipelines[pass]),
                  masu_passes[pass].name);
    return result;
}
