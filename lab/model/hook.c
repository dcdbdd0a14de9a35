/* hook.c: see hook.h. */
#include "lab/model/hook.h"

#include "lab/model/spirv_reach.h"

#include "plan/frame_plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LAYOUTS = MASU_PASS_COUNT, MODULES = 256, PIPELINES = 256, SETS_MOST = 4 };

#define BUFFER_BYTES ((VkDeviceSize)MASU_HOOK_SHADERS * MASU_TALLY_WORDS * sizeof(uint32_t))

typedef struct module {
    VkShaderModule handle;
    uint32_t *words;
    size_t count;
} module;

static struct {
    masu_headless *host;
    uint32_t passes[MASU_PASS_COUNT], pass_count;
    masu_headless_buffer buffer;
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    VkCommandBuffer commands;
    struct {
        VkPipelineLayout handle;
        uint32_t set, pass;
    } layouts[LAYOUTS];
    struct {
        VkPipeline handle;
        uint32_t layout;
    } pipelines[PIPELINES];
    module modules[MODULES];
    masu_hook_shader shaders[MASU_HOOK_SHADERS];
    uint32_t layout_count, pipeline_count, module_count, shader_count;
    uint32_t bound; /* layout of the last bound pipeline */
    VkPipelineBindPoint point;
    char failed[160];
} hook;

#define REAL(name) ((PFN_vk##name)vkGetDeviceProcAddr(hook.host->device, "vk" #name))

static void fail(const char *what, uint32_t pass) {
    if (hook.failed[0]) return;
    snprintf(hook.failed, sizeof hook.failed, "%s%s%s", what,
             pass < MASU_PASS_COUNT ? " of pass " : "",
             pass < MASU_PASS_COUNT ? masu_passes[pass].name : "");
}

/* ---- Shaders --------------------------------------------------------------------------------- */

static VKAPI_ATTR VkResult VKAPI_CALL create_module(VkDevice device,
                                                    const VkShaderModuleCreateInfo *info,
                                                    const VkAllocationCallbacks *allocator,
                                                    VkShaderModule *out) {
    VkResult r = REAL(CreateShaderModule)(device, info, allocator, out);
    if (r) return r;
    module *m = hook.module_count < MODULES ? &hook.modules[hook.module_count] : NULL;
    uint32_t *words = m ? malloc(info->codeSize) : NULL;
    if (!words) {
        fail("too many shaders", MASU_PASS_COUNT);
        return r;
    }
    memcpy(words, info->pCode, info->codeSize);
    *m = (module){*out, words, info->codeSize / sizeof *words};
    hook.module_count++;
    return r;
}

/* Handles of destroyed modules are reused: the latest matches. */
static const module *module_of(VkShaderModule handle) {
    for (uint32_t i = hook.module_count; i-- > 0;) {
        if (hook.modules[i].handle == handle) return &hook.modules[i];
    }
    return NULL;
}

static uint32_t layout_of(VkPipelineLayout handle) {
    for (uint32_t i = 0; i < hook.layout_count; i++) {
        if (hook.layouts[i].handle == handle) return i;
    }
    return UINT32_MAX;
}

/* The same stage with counters; the caller destroys its module. VK_NULL_HANDLE: the stage is
 * unchanged. */
static VkShaderModule tally(const VkPipelineShaderStageCreateInfo *stage, uint32_t layout) {
    const module *m = module_of(stage->module);
    uint32_t at = hook.shader_count, pass = hook.layouts[layout].pass;
    VkShaderModule made = VK_NULL_HANDLE;
    if (!m || at == MASU_HOOK_SHADERS) {
        fail("too many shaders", pass);
        return VK_NULL_HANDLE;
    }
    masu_hook_shader *s = &hook.shaders[at];
    *s = (masu_hook_shader){.pass = pass,
                            .counts = (uint32_t *)hook.buffer.mapped + at * MASU_TALLY_WORDS};
    if (!masu_tally_make(m->words, m->count, hook.layouts[layout].set, at * MASU_TALLY_WORDS,
                         &s->tally)) {
        fail("counters cannot be put into a shader", pass);
        return VK_NULL_HANDLE;
    }
    spirv_module read;
    if (spirv_from_words(m->words, m->count, &read)) {
        s->straight = masu_spirv_cost_reached(&read, stage->pSpecializationInfo).plain;
        spirv_free(&read);
    }
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = s->tally.word_count * sizeof(uint32_t),
                                     .pCode = s->tally.words};
    if (REAL(CreateShaderModule)(hook.host->device, &info, NULL, &made)) {
        fail("vkCreateShaderModule refuses a shader with counters", pass);
        made = VK_NULL_HANDLE;
    }
    hook.shader_count++;
    return made;
}

static void keep_pipeline(VkPipeline handle, uint32_t layout) {
    if (hook.pipeline_count == PIPELINES) {
        fail("too many pipelines", MASU_PASS_COUNT);
        return;
    }
    hook.pipelines[hook.pipeline_count].handle = handle;
    hook.pipelines[hook.pipeline_count++].layout = layout;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_compute(VkDevice device, VkPipelineCache cache,
                                                     uint32_t n,
                                                     const VkComputePipelineCreateInfo *info,
                                                     const VkAllocationCallbacks *allocator,
                                                     VkPipeline *out) {
    VkComputePipelineCreateInfo changed = *info; /* the renderer creates one at a time */
    uint32_t layout = layout_of(info->layout);
    VkShaderModule made = layout != UINT32_MAX ? tally(&info->stage, layout) : VK_NULL_HANDLE;
    if (made) changed.stage.module = made;
    VkResult r = REAL(CreateComputePipelines)(device, cache, n, &changed, allocator, out);
    REAL(DestroyShaderModule)(device, made, NULL);
    if (!r) keep_pipeline(*out, layout);
    return r;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_graphics(VkDevice device, VkPipelineCache cache,
                                                      uint32_t n,
                                                      const VkGraphicsPipelineCreateInfo *info,
                                                      const VkAllocationCallbacks *allocator,
                                                      VkPipeline *out) {
    VkPipelineShaderStageCreateInfo stages[2];
    VkShaderModule made[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    VkGraphicsPipelineCreateInfo changed = *info;
    uint32_t layout = layout_of(info->layout), count = info->stageCount < 2 ? info->stageCount : 2;
    for (uint32_t i = 0; i < count; i++) {
        stages[i] = info->pStages[i];
        if (layout != UINT32_MAX) made[i] = tally(&stages[i], layout);
        if (made[i]) stages[i].module = made[i];
    }
    changed.pStages = stages;
    VkResult r = REAL(CreateGraphicsPipelines)(device, cache, n, &changed, allocator, out);
    for (uint32_t i = 0; i < 2; i++) REAL(DestroyShaderModule)(device, made[i], NULL);
    if (!r) keep_pipeline(*out, layout);
    return r;
}

/* Adds one descriptor set after those of the renderer. */
static VKAPI_ATTR VkResult VKAPI_CALL create_layout(VkDevice device,
                                                    const VkPipelineLayoutCreateInfo *info,
                                                    const VkAllocationCallbacks *allocator,
                                                    VkPipelineLayout *out) {
    VkDescriptorSetLayout sets[SETS_MOST];
    VkPipelineLayoutCreateInfo changed = *info;
    uint32_t n = info->setLayoutCount;
    if (n >= SETS_MOST || hook.layout_count >= hook.pass_count) {
        fail("more pipeline layouts than the frame table has rows", MASU_PASS_COUNT);
        return REAL(CreatePipelineLayout)(device, info, allocator, out);
    }
    memcpy(sets, info->pSetLayouts, n * sizeof *sets);
    sets[n] = hook.set_layout;
    changed.pSetLayouts = sets;
    changed.setLayoutCount = n + 1;
    VkResult r = REAL(CreatePipelineLayout)(device, &changed, allocator, out);
    if (r) return r;
    hook.layouts[hook.layout_count].handle = *out;
    hook.layouts[hook.layout_count].set = n;
    hook.layouts[hook.layout_count].pass = hook.passes[hook.layout_count];
    hook.layout_count++;
    return r;
}

/* ---- Commands -------------------------------------------------------------------------------- */

static VKAPI_ATTR void VKAPI_CALL bind_pipeline(VkCommandBuffer cmd, VkPipelineBindPoint point,
                                                VkPipeline pipeline) {
    hook.bound = UINT32_MAX;
    hook.point = point;
    for (uint32_t i = 0; i < hook.pipeline_count; i++) {
        if (hook.pipelines[i].handle == pipeline) hook.bound = hook.pipelines[i].layout;
    }
    REAL(CmdBindPipeline)(cmd, point, pipeline);
}

/* Bound immediately before use: sets bound by the renderer may disturb a set with a higher
 * number. */
static void bind_counters(VkCommandBuffer cmd) {
    if (hook.bound == UINT32_MAX) return;
    REAL(CmdBindDescriptorSets)
    (cmd, hook.point, hook.layouts[hook.bound].handle, hook.layouts[hook.bound].set, 1, &hook.set,
     0, NULL);
}

static VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer cmd, uint32_t x, uint32_t y,
                                           uint32_t z) {
    bind_counters(cmd);
    REAL(CmdDispatch)(cmd, x, y, z);
}

static VKAPI_ATTR void VKAPI_CALL dispatch_indirect(VkCommandBuffer cmd, VkBuffer buffer,
                                                    VkDeviceSize offset) {
    bind_counters(cmd);
    REAL(CmdDispatchIndirect)(cmd, buffer, offset);
}

static VKAPI_ATTR void VKAPI_CALL draw(VkCommandBuffer cmd, uint32_t vertices, uint32_t instances,
                                       uint32_t first, uint32_t first_instance) {
    bind_counters(cmd);
    REAL(CmdDraw)(cmd, vertices, instances, first, first_instance);
}

static VKAPI_ATTR void VKAPI_CALL draw_indirect(VkCommandBuffer cmd, VkBuffer buffer,
                                                VkDeviceSize offset, uint32_t count,
                                                uint32_t stride) {
    bind_counters(cmd);
    REAL(CmdDrawIndirect)(cmd, buffer, offset, count, stride);
}

static VKAPI_ATTR void VKAPI_CALL draw_indexed_indirect(VkCommandBuffer cmd, VkBuffer buffer,
                                                        VkDeviceSize offset, uint32_t count,
                                                        uint32_t stride) {
    bind_counters(cmd);
    REAL(CmdDrawIndexedIndirect)(cmd, buffer, offset, count, stride);
}

#define ANSWER(text, function)                                                                     \
    if (!strcmp(name, text)) return (PFN_vkVoidFunction)(function)

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device(VkDevice device, const char *name) {
    ANSWER("vkCreateShaderModule", create_module);
    ANSWER("vkCreatePipelineLayout", create_layout);
    ANSWER("vkCreateComputePipelines", create_compute);
    ANSWER("vkCreateGraphicsPipelines", create_graphics);
    ANSWER("vkCmdBindPipeline", bind_pipeline);
    ANSWER("vkCmdDispatch", dispatch);
    ANSWER("vkCmdDispatchIndirect", dispatch_indirect);
    ANSWER("vkCmdDraw", draw);
    ANSWER("vkCmdDrawIndirect", draw_indirect);
    ANSWER("vkCmdDrawIndexedIndirect", draw_indexed_indirect);
    return vkGetDeviceProcAddr(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_hook_get_instance_proc_addr(VkInstance instance,
                                                                          const char *name) {
    ANSWER("vkGetDeviceProcAddr", get_device);
    return vkGetInstanceProcAddr(instance, name);
}

/* ---- The buffer ------------------------------------------------------------------------------ */

#define CHECK(call)                                                                                \
    do {                                                                                           \
        VkResult r_ = (call);                                                                      \
        if (r_) return masu_headless_fail(error, error_size, #call, r_);                           \
    } while (0)

static bool make_set(char *error, size_t error_size) {
    VkDevice device = hook.host->device;
    VkDescriptorSetLayoutBinding binding = {
        0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
        VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT,
        NULL};
    VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = 1,
        .pBindings = &binding};
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = 1,
                                       .poolSizeCount = 1,
                                       .pPoolSizes = &size};
    CHECK(vkCreateDescriptorSetLayout(device, &layout, NULL, &hook.set_layout));
    CHECK(vkCreateDescriptorPool(device, &pool, NULL, &hook.pool));
    VkDescriptorSetAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorPool = hook.pool,
                                            .descriptorSetCount = 1,
                                            .pSetLayouts = &hook.set_layout};
    CHECK(vkAllocateDescriptorSets(device, &allocate, &hook.set));
    VkDescriptorBufferInfo buffer = {hook.buffer.buffer, 0, VK_WHOLE_SIZE};
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = hook.set,
                                  .descriptorCount = 1,
                                  .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                  .pBufferInfo = &buffer};
    vkUpdateDescriptorSets(device, 1, &write, 0, NULL);
    return true;
}

/* Records the barrier that makes device writes visible to the host. */
static bool make_commands(char *error, size_t error_size) {
    VkCommandBufferAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                            .commandPool = hook.host->pool,
                                            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                            .commandBufferCount = 1};
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                               .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                               .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    CHECK(vkAllocateCommandBuffers(hook.host->device, &allocate, &hook.commands));
    CHECK(vkBeginCommandBuffer(hook.commands, &begin));
    vkCmdPipelineBarrier(hook.commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, NULL, 0, NULL);
    CHECK(vkEndCommandBuffer(hook.commands));
    return true;
}

bool masu_hook_begin(masu_headless *host, const uint32_t *passes, uint32_t count, char *error,
                     size_t error_size) {
    memset(&hook, 0, sizeof hook);
    hook.host = host;
    hook.bound = UINT32_MAX;
    hook.pass_count = count;
    memcpy(hook.passes, passes, count * sizeof *passes);
    if (masu_headless_buffer_create(host, BUFFER_BYTES, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                    &hook.buffer, error, error_size) &&
        make_set(error, error_size) &&
        make_commands(error, error_size))
        return true;
    masu_hook_end();
    return false;
}

void masu_hook_end(void) {
    if (!hook.host) return;
    VkDevice device = hook.host->device;
    masu_headless_settle(hook.host);
    if (hook.commands) vkFreeCommandBuffers(device, hook.host->pool, 1, &hook.commands);
    vkDestroyDescriptorPool(device, hook.pool, NULL);
    vkDestroyDescriptorSetLayout(device, hook.set_layout, NULL);
    masu_headless_buffer_destroy(hook.host, &hook.buffer);
    for (uint32_t i = 0; i < hook.module_count; i++) free(hook.modules[i].words);
    for (uint32_t i = 0; i < hook.shader_count; i++) free(hook.shaders[i].tally.words);
    memset(&hook, 0, sizeof hook);
}

void masu_hook_clear(void) { memset(hook.buffer.mapped, 0, (size_t)BUFFER_BYTES); }

bool masu_hook_read(char *error, size_t error_size) {
    return masu_headless_run(hook.host, hook.commands, error, error_size);
}

const masu_hook_shader *masu_hook_shaders(uint32_t *count) {
    *count = hook.shader_count;
    return hook.shaders;
}

bool masu_hook_good(char *error, size_t error_size) {
    if (!hook.failed[0] && hook.layout_count != hook.pass_count)
        fail("fewer pipeline layouts than the frame table has rows", MASU_PASS_COUNT);
    if (!hook.failed[0]) return true;
    snprintf(error, error_size, "%s", hook.failed);
    return false;
}
