/* kept.c: see kept.h. A description is serialized to a byte string, with handles in place of other
 * cached objects: equal strings, equal objects. */
#include "support/kept.h"

#include "support/files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

kept_counts kept;

/* ---- Keys ------------------------------------------------------------------------------------ */

typedef struct key {
    uint8_t *bytes;
    size_t count, room;
    bool whole; /* false: it contains something that the cache does not support */
} key;

static void add(key *k, const void *bytes, size_t count) {
    if (k->count + count > k->room) {
        k->room = 2 * (k->count + count);
        k->bytes = realloc(k->bytes, k->room);
        if (!k->bytes) abort();
    }
    if (count) memcpy(k->bytes + k->count, bytes, count);
    k->count += count;
}

static void add_array(key *k, const void *first, size_t count, size_t size) {
    add(k, &count, sizeof count);
    if (first) add(k, first, count * size);
}

static void add_text(key *k, const char *text) { add_array(k, text, text ? strlen(text) : 0, 1); }

/* Adds the members of a struct one by one, because padding has no defined content. */
#define ADD(k, member) add(k, &(member), sizeof(member))

static key key_of(VkStructureType type, VkDevice device, const void *next, const void *allocator) {
    key k = {.whole = !next && !allocator};
    ADD(&k, type);
    ADD(&k, device);
    return k;
}

#define HANDLE(h) ((uint64_t)(uintptr_t)(h))

/* ---- Cached objects -------------------------------------------------------------------------- */

typedef struct entry {
    struct entry *next;
    VkStructureType type;
    VkDevice device;
    uint64_t handle, hash;
    size_t count;
    uint8_t key[];
} entry;

static entry *entries; /* newest first */

static uint64_t hash_of(const key *k) {
    uint64_t h = HASH_START;
    hash_bytes(&h, k->bytes, k->count);
    return h;
}

static entry *find(const key *k) {
    uint64_t h = hash_of(k);
    entry *e = k->whole ? entries : NULL;
    while (e && (e->hash != h || e->count != k->count || memcmp(e->key, k->bytes, k->count)))
        e = e->next;
    return e;
}

/* Every handle is as wide as the number stored for it. */
static bool found(const key *k, void *out) {
    const entry *e = find(k);
    if (e) memcpy(out, &e->handle, sizeof e->handle);
    return e != NULL;
}

static entry *holder(VkStructureType type, uint64_t handle) {
    entry *e = entries;
    while (e && (e->type != type || e->handle != handle)) e = e->next;
    return e;
}

static void destroy_all(void);

static void keep(const key *k, VkStructureType type, VkDevice device, uint64_t handle) {
    /* Objects of an uncached device are destroyed with it, so they are not cached. */
    if (!k->whole || (device && !holder(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, HANDLE(device))))
        return;
    entry *e = malloc(sizeof *e + k->count);
    if (!e) abort();
    /* Registered again after kept_forget, which unloads the driver: handlers run in reverse order
     * of registration, so this one runs before the handler of the driver that is loaded next. */
    if (!entries) atexit(destroy_all);
    *e = (entry){entries, type, device, handle, hash_of(k), k->count};
    memcpy(e->key, k->bytes, k->count);
    entries = e;
}

/* The real functions, under the name that the linker gives them. */
#define REAL(name) __real_vk##name
#define OURS(name) __wrap_vk##name

/* ---- Objects that are compiled, or few ------------------------------------------------------- */

/* Whether a cached module, whose key ends in its code, declares the specialization constant:
 * renderers pass the constants of all modules to each. */
static bool declares(const entry *module, uint32_t id) {
    enum { OP_DECORATE = 71, SPEC_ID = 1, OP_FUNCTION = 54 };
    const size_t head = sizeof module->type + sizeof module->device +
                        sizeof(VkShaderModuleCreateFlags) + sizeof(size_t);
    for (size_t at = head + 5 * sizeof id; at + 4 * sizeof id <= module->count;) {
        uint32_t word[4];
        memcpy(word, module->key + at, sizeof word);
        if ((word[0] & 0xFFFF) == OP_DECORATE && word[2] == SPEC_ID && word[3] == id) return true;
        if ((word[0] & 0xFFFF) == OP_FUNCTION || !(word[0] >> 16)) return false;
        at += (word[0] >> 16) * sizeof id;
    }
    return false;
}

static void add_shader(key *k, const VkPipelineShaderStageCreateInfo *s) {
    k->whole &= !s->pNext;
    ADD(k, s->flags);
    ADD(k, s->stage);
    ADD(k, s->module);
    add_text(k, s->pName);
    const VkSpecializationInfo *special = s->pSpecializationInfo;
    const entry *module = holder(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, HANDLE(s->module));
    add_array(k, special, special != NULL, 0);
    if (!special) return;
    for (uint32_t i = 0; i < special->mapEntryCount; i++) {
        const VkSpecializationMapEntry *m = &special->pMapEntries[i];
        if (module && !declares(module, m->constantID)) continue;
        ADD(k, m->constantID);
        add_array(k, (const uint8_t *)special->pData + m->offset, m->size, 1);
    }
}

static void describe_ShaderModule(key *k, const VkShaderModuleCreateInfo *info) {
    ADD(k, info->flags);
    add_array(k, info->pCode, info->codeSize, 1);
}

static void describe_Sampler(key *k, const VkSamplerCreateInfo *info) {
    /* From the first member after pNext on, all members have 4 bytes. */
    add(k, &info->flags, sizeof *info - offsetof(VkSamplerCreateInfo, flags));
}

static void describe_DescriptorSetLayout(key *k, const VkDescriptorSetLayoutCreateInfo *info) {
    ADD(k, info->flags);
    ADD(k, info->bindingCount);
    for (uint32_t i = 0; i < info->bindingCount; i++) {
        const VkDescriptorSetLayoutBinding *b = &info->pBindings[i];
        ADD(k, b->binding);
        ADD(k, b->descriptorType);
        ADD(k, b->stageFlags);
        ADD(k, b->descriptorCount);
        add_array(k, b->pImmutableSamplers, b->pImmutableSamplers ? b->descriptorCount : 0,
                  sizeof(VkSampler));
    }
}

static void describe_PipelineLayout(key *k, const VkPipelineLayoutCreateInfo *info) {
    ADD(k, info->flags);
    add_array(k, info->pSetLayouts, info->setLayoutCount, sizeof *info->pSetLayouts);
    add_array(k, info->pPushConstantRanges, info->pushConstantRangeCount,
              sizeof *info->pPushConstantRanges);
}

static void add_references(key *k, const VkAttachmentReference *first, uint32_t count) {
    add_array(k, first, first ? count : 0, sizeof *first);
}

static void describe_RenderPass(key *k, const VkRenderPassCreateInfo *info) {
    ADD(k, info->flags);
    add_array(k, info->pAttachments, info->attachmentCount, sizeof *info->pAttachments);
    add_array(k, info->pDependencies, info->dependencyCount, sizeof *info->pDependencies);
    ADD(k, info->subpassCount);
    for (uint32_t i = 0; i < info->subpassCount; i++) {
        const VkSubpassDescription *s = &info->pSubpasses[i];
        ADD(k, s->flags);
        ADD(k, s->pipelineBindPoint);
        add_references(k, s->pInputAttachments, s->inputAttachmentCount);
        add_references(k, s->pColorAttachments, s->colorAttachmentCount);
        add_references(k, s->pResolveAttachments, s->colorAttachmentCount);
        add_references(k, s->pDepthStencilAttachment, 1);
        add_array(k, s->pPreserveAttachments, s->preserveAttachmentCount, sizeof(uint32_t));
    }
}

static void describe_Compute(key *k, const VkComputePipelineCreateInfo *info) {
    ADD(k, info->flags);
    add_shader(k, &info->stage);
    ADD(k, info->layout);
}

/* Absent states and states with an extension are not supported. */
#define KNOWN(k, state) ((k)->whole = (k)->whole && (state) && !(state)->pNext, (k)->whole)

static void describe_Graphics(key *k, const VkGraphicsPipelineCreateInfo *info) {
    ADD(k, info->flags);
    ADD(k, info->layout);
    ADD(k, info->renderPass);
    ADD(k, info->subpass);
    k->whole &= !info->pTessellationState;
    ADD(k, info->stageCount);
    for (uint32_t i = 0; i < info->stageCount; i++) add_shader(k, &info->pStages[i]);

    const VkPipelineVertexInputStateCreateInfo *input = info->pVertexInputState;
    if (KNOWN(k, input)) {
        add_array(k, input->pVertexBindingDescriptions, input->vertexBindingDescriptionCount,
                  sizeof *input->pVertexBindingDescriptions);
        add_array(k, input->pVertexAttributeDescriptions, input->vertexAttributeDescriptionCount,
                  sizeof *input->pVertexAttributeDescriptions);
    }
    const VkPipelineInputAssemblyStateCreateInfo *assembly = info->pInputAssemblyState;
    if (KNOWN(k, assembly)) {
        ADD(k, assembly->topology);
        ADD(k, assembly->primitiveRestartEnable);
    }
    const VkPipelineViewportStateCreateInfo *viewport = info->pViewportState;
    if (KNOWN(k, viewport)) {
        ADD(k, viewport->viewportCount);
        ADD(k, viewport->scissorCount);
        k->whole &= !viewport->pViewports && !viewport->pScissors;
    }
    const VkPipelineRasterizationStateCreateInfo *raster = info->pRasterizationState;
    if (KNOWN(k, raster)) {
        ADD(k, raster->depthClampEnable);
        ADD(k, raster->rasterizerDiscardEnable);
        ADD(k, raster->polygonMode);
        ADD(k, raster->cullMode);
        ADD(k, raster->frontFace);
        ADD(k, raster->depthBiasEnable);
        ADD(k, raster->depthBiasConstantFactor);
        ADD(k, raster->depthBiasClamp);
        ADD(k, raster->depthBiasSlopeFactor);
        ADD(k, raster->lineWidth);
    }
    const VkPipelineMultisampleStateCreateInfo *samples = info->pMultisampleState;
    if (KNOWN(k, samples)) {
        k->whole &= samples->rasterizationSamples == VK_SAMPLE_COUNT_1_BIT &&
                    !samples->sampleShadingEnable && !samples->pSampleMask &&
                    !samples->alphaToCoverageEnable && !samples->alphaToOneEnable;
    }
    const VkPipelineDepthStencilStateCreateInfo *depth = info->pDepthStencilState;
    if (KNOWN(k, depth)) {
        ADD(k, depth->depthTestEnable);
        ADD(k, depth->depthWriteEnable);
        ADD(k, depth->depthCompareOp);
        k->whole &= !depth->depthBoundsTestEnable && !depth->stencilTestEnable;
    }
    const VkPipelineColorBlendStateCreateInfo *blend = info->pColorBlendState;
    if (KNOWN(k, blend)) {
        ADD(k, blend->logicOpEnable);
        ADD(k, blend->logicOp);
        ADD(k, blend->blendConstants);
        add_array(k, blend->pAttachments, blend->attachmentCount, sizeof *blend->pAttachments);
    }
    const VkPipelineDynamicStateCreateInfo *dynamic = info->pDynamicState;
    if (KNOWN(k, dynamic))
        add_array(k, dynamic->pDynamicStates, dynamic->dynamicStateCount,
                  sizeof *dynamic->pDynamicStates);
}

/* Number of objects that a session must destroy before its device, cached ones included. */
static int64_t held;

#define KEPT(Name)                                                                                 \
    VkResult REAL(Create##Name)(VkDevice, const Vk##Name##CreateInfo *, const VkAllocationCallbacks *, Vk##Name *); \
    void REAL(Destroy##Name)(VkDevice, Vk##Name, const VkAllocationCallbacks *);                   \
    VkResult OURS(Create##Name)(VkDevice device, const Vk##Name##CreateInfo *info,                 \
                                const VkAllocationCallbacks *allocator, Vk##Name *out) {           \
        key k = key_of(info->sType, device, info->pNext, allocator);                               \
        describe_##Name(&k, info);                                                                 \
        VkResult r = VK_SUCCESS;                                                                   \
        if (!found(&k, out)) {                                                                     \
            r = REAL(Create##Name)(device, info, allocator, out);                                  \
            if (!r) keep(&k, info->sType, device, HANDLE(*out));                                   \
        }                                                                                          \
        held += !r;                                                                                \
        free(k.bytes);                                                                             \
        return r;                                                                                  \
    }                                                                                              \
    void OURS(Destroy##Name)(VkDevice device, Vk##Name object, const VkAllocationCallbacks *allocator) { \
        held -= object != VK_NULL_HANDLE;                                                          \
        if (!holder(TYPE_##Name, HANDLE(object))) REAL(Destroy##Name)(device, object, allocator);  \
    }

#define TYPE_ShaderModule VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO
#define TYPE_Sampler VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO
#define TYPE_DescriptorSetLayout VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO
#define TYPE_PipelineLayout VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO
#define TYPE_RenderPass VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO

#define KINDS(X) X(ShaderModule) X(Sampler) X(DescriptorSetLayout) X(PipelineLayout) X(RenderPass)

KINDS(KEPT)

#define KEPT_PIPELINES(Kind)                                                                       \
    VkResult REAL(Create##Kind##Pipelines)(VkDevice, VkPipelineCache, uint32_t,                    \
                                           const Vk##Kind##PipelineCreateInfo *,                   \
                                           const VkAllocationCallbacks *, VkPipeline *);           \
    VkResult OURS(Create##Kind##Pipelines)(VkDevice device, VkPipelineCache cache, uint32_t count, \
                                           const Vk##Kind##PipelineCreateInfo *info,               \
                                           const VkAllocationCallbacks *allocator, VkPipeline *out) { \
        VkResult r = VK_SUCCESS;                                                                   \
        for (uint32_t i = 0; i < count; i++) {                                                     \
            key k = key_of(info[i].sType, device, info[i].pNext, allocator);                       \
            describe_##Kind(&k, &info[i]);                                                         \
            VkResult one = VK_SUCCESS;                                                             \
            kept.asked++;                                                                          \
            if (!found(&k, &out[i])) {                                                             \
                one = REAL(Create##Kind##Pipelines)(device, cache, 1, &info[i], allocator, &out[i]); \
                if (!one) keep(&k, TYPE_PIPELINE, device, HANDLE(out[i]));                         \
                kept.compiled += !one;                                                             \
            }                                                                                      \
            held += !one;                                                                          \
            r = r ? r : one;                                                                       \
            free(k.bytes);                                                                         \
        }                                                                                          \
        return r;                                                                                  \
    }

/* One type for both kinds of pipelines, because they share a destroy function. */
#define TYPE_PIPELINE VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO

KEPT_PIPELINES(Compute)
KEPT_PIPELINES(Graphics)

void REAL(DestroyPipeline)(VkDevice, VkPipeline, const VkAllocationCallbacks *);
void OURS(DestroyPipeline)(VkDevice device, VkPipeline pipeline,
                           const VkAllocationCallbacks *allocator) {
    held -= pipeline != VK_NULL_HANDLE;
    if (!holder(TYPE_PIPELINE, HANDLE(pipeline)))
        REAL(DestroyPipeline)(device, pipeline, allocator);
}

/* ---- Objects that are only counted ----------------------------------------------------------- */

#define COUNTED(Create, Destroy, Info, Handle)                                                     \
    VkResult REAL(Create)(VkDevice, const Info *, const VkAllocationCallbacks *, Handle *);        \
    void REAL(Destroy)(VkDevice, Handle, const VkAllocationCallbacks *);                           \
    VkResult OURS(Create)(VkDevice device, const Info *info, const VkAllocationCallbacks *allocator, \
                          Handle *out) {                                                           \
        VkResult r = REAL(Create)(device, info, allocator, out);                                   \
        held += !r;                                                                                \
        return r;                                                                                  \
    }                                                                                              \
    void OURS(Destroy)(VkDevice device, Handle object, const VkAllocationCallbacks *allocator) {   \
        held -= object != VK_NULL_HANDLE;                                                          \
        REAL(Destroy)(device, object, allocator);                                                  \
    }

#define COUNTED_ALL(X)                                                                             \
    X(CreateBuffer, DestroyBuffer, VkBufferCreateInfo, VkBuffer)                                   \
    X(CreateCommandPool, DestroyCommandPool, VkCommandPoolCreateInfo, VkCommandPool)               \
    X(CreateDescriptorPool, DestroyDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)   \
    X(CreateFence, DestroyFence, VkFenceCreateInfo, VkFence)                                       \
    X(CreateFramebuffer, DestroyFramebuffer, VkFramebufferCreateInfo, VkFramebuffer)               \
    X(CreateImage, DestroyImage, VkImageCreateInfo, VkImage)                                       \
    X(CreateImageView, DestroyImageView, VkImageViewCreateInfo, VkImageView)                       \
    X(CreateQueryPool, DestroyQueryPool, VkQueryPoolCreateInfo, VkQueryPool)                       \
    X(AllocateMemory, FreeMemory, VkMemoryAllocateInfo, VkDeviceMemory)

COUNTED_ALL(COUNTED)

/* ---- Instances and devices ------------------------------------------------------------------- */

static void add_names(key *k, const char *const *names, uint32_t count) {
    ADD(k, count);
    for (uint32_t i = 0; i < count; i++) add_text(k, names[i]);
}

/* The extension structs that hosts and tests here use: their members that are not pointers. */
static bool add_next(key *k, const VkBaseInStructure *next) {
    for (; next; next = next->pNext) {
        ADD(k, next->sType);
        size_t size = 0, from = sizeof *next;
        switch (next->sType) {
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES:
                size = sizeof(VkPhysicalDeviceShaderFloat16Int8Features);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR:
                size = sizeof(VkPhysicalDeviceRayQueryFeaturesKHR);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR:
                size = sizeof(VkPhysicalDeviceAccelerationStructureFeaturesKHR);
                break;
            case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES:
                size = sizeof(VkPhysicalDeviceBufferDeviceAddressFeatures);
                break;
            case VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT: {
                const VkValidationFeaturesEXT *v = (const VkValidationFeaturesEXT *)next;
                add_array(k, v->pEnabledValidationFeatures, v->enabledValidationFeatureCount,
                          sizeof *v->pEnabledValidationFeatures);
                add_array(k, v->pDisabledValidationFeatures, v->disabledValidationFeatureCount,
                          sizeof *v->pDisabledValidationFeatures);
                continue;
            }
            default: return false;
        }
        add(k, (const uint8_t *)next + from, size - from);
    }
    return true;
}

VkResult REAL(CreateInstance)(const VkInstanceCreateInfo *, const VkAllocationCallbacks *,
                              VkInstance *);
void REAL(DestroyInstance)(VkInstance, const VkAllocationCallbacks *);
VkResult REAL(CreateDevice)(VkPhysicalDevice, const VkDeviceCreateInfo *,
                            const VkAllocationCallbacks *, VkDevice *);
void REAL(DestroyDevice)(VkDevice, const VkAllocationCallbacks *);

VkResult OURS(CreateInstance)(const VkInstanceCreateInfo *info,
                              const VkAllocationCallbacks *allocator, VkInstance *out) {
    key k = key_of(info->sType, NULL, NULL, allocator);
    k.whole = k.whole && add_next(&k, info->pNext) && info->pApplicationInfo;
    if (k.whole) ADD(&k, info->pApplicationInfo->apiVersion);
    add_names(&k, info->ppEnabledLayerNames, info->enabledLayerCount);
    add_names(&k, info->ppEnabledExtensionNames, info->enabledExtensionCount);
    VkResult r = VK_SUCCESS;
    if (!found(&k, out)) {
        r = REAL(CreateInstance)(info, allocator, out);
        if (!r) keep(&k, info->sType, NULL, HANDLE(*out));
    }
    free(k.bytes);
    return r;
}

void OURS(DestroyInstance)(VkInstance instance, const VkAllocationCallbacks *allocator) {
    if (!holder(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, HANDLE(instance)))
        REAL(DestroyInstance)(instance, allocator);
}

static uint32_t open_devices;

VkResult OURS(CreateDevice)(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                            const VkAllocationCallbacks *allocator, VkDevice *out) {
    key k = key_of(info->sType, NULL, NULL, allocator);
    k.whole = k.whole && add_next(&k, info->pNext) && info->pEnabledFeatures;
    ADD(&k, physical);
    for (uint32_t i = 0; i < info->queueCreateInfoCount; i++) {
        ADD(&k, info->pQueueCreateInfos[i].queueFamilyIndex);
        ADD(&k, info->pQueueCreateInfos[i].queueCount);
    }
    add_names(&k, info->ppEnabledExtensionNames, info->enabledExtensionCount);
    if (k.whole) ADD(&k, *info->pEnabledFeatures);
    VkResult r = VK_SUCCESS;
    if (!found(&k, out)) {
        r = REAL(CreateDevice)(physical, info, allocator, out);
        if (!r) keep(&k, info->sType, NULL, HANDLE(*out));
    }
    open_devices += !r;
    free(k.bytes);
    return r;
}

void OURS(DestroyDevice)(VkDevice device, const VkAllocationCallbacks *allocator) {
    open_devices -= device != NULL;
    if (!open_devices && held) {
        fprintf(stderr, "%lld objects more than were destroyed have been made on the device\n",
                (long long)held);
        abort();
    }
    if (!holder(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, HANDLE(device)))
        REAL(DestroyDevice)(device, allocator);
}

/* The newest are first, so no object is destroyed before the ones made from it. If a failed test
 * has left a session open, its objects still use the device: then nothing is destroyed. */
static void destroy_all(void) {
    for (entry *e = entries, *next; e; e = next) {
        next = e->next;
#define DESTROY(Name)                                                                              \
    case TYPE_##Name: REAL(Destroy##Name)(e->device, (Vk##Name)(uintptr_t)e->handle, NULL); break;
        switch (open_devices ? VK_STRUCTURE_TYPE_MAX_ENUM : e->type) {
            KINDS(DESTROY)
        case TYPE_PIPELINE:
            REAL(DestroyPipeline)(e->device, (VkPipeline)(uintptr_t)e->handle, NULL);
            break;
        case VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO:
            REAL(DestroyDevice)((VkDevice)(uintptr_t)e->handle, NULL);
            break;
        case VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO:
            REAL(DestroyInstance)((VkInstance)(uintptr_t)e->handle, NULL);
            break;
        default: break;
        }
        free(e);
    }
    entries = NULL;
}

void kept_forget(void) {
    if (open_devices) { /* the session would continue with destroyed objects */
        fprintf(stderr, "a session is still open: its device cannot be forgotten\n");
        abort();
    }
    destroy_all();
}

/* ---- Look-up --------------------------------------------------------------------------------- */

PFN_vkVoidFunction REAL(GetInstanceProcAddr)(VkInstance, const char *);
PFN_vkVoidFunction REAL(GetDeviceProcAddr)(VkDevice, const char *);
PFN_vkVoidFunction OURS(GetInstanceProcAddr)(VkInstance instance, const char *name);
PFN_vkVoidFunction OURS(GetDeviceProcAddr)(VkDevice device, const char *name);

static PFN_vkVoidFunction ours(const char *name) {
#define ROW(Function) {"vk" #Function, (PFN_vkVoidFunction)OURS(Function)},
#define ROWS(Name) ROW(Create##Name) ROW(Destroy##Name)
#define ROWS_COUNTED(Create, Destroy, Info, Handle) ROW(Create) ROW(Destroy)
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } rows[] = {KINDS(ROWS) COUNTED_ALL(ROWS_COUNTED) ROW(CreateComputePipelines)
                    ROW(CreateGraphicsPipelines) ROW(DestroyPipeline) ROW(CreateInstance)
                        ROW(DestroyInstance) ROW(CreateDevice) ROW(DestroyDevice)
                            ROW(GetInstanceProcAddr) ROW(GetDeviceProcAddr)};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!strcmp(name, rows[i].name)) return rows[i].function;
    }
    return NULL;
}

/* Functions that the driver or loader does not have are not offered here. */
PFN_vkVoidFunction OURS(GetInstanceProcAddr)(VkInstance instance, const char *name) {
    PFN_vkVoidFunction real = REAL(GetInstanceProcAddr)(instance, name),
                       our = real ? ours(name) : NULL;
    return our ? our : real;
}

PFN_vkVoidFunction OURS(GetDeviceProcAddr)(VkDevice device, const char *name) {
    PFN_vkVoidFunction real = REAL(GetDeviceProcAddr)(device, name), our = real ? ours(name) : NULL;
    return our ? our : real;
}
