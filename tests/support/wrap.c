/* wrap.c: see wrap.h. The outputs of a call that is made to fail are filled with garbage, because
 * the specification allows a driver to do so. */
#include "support/wrap.h"

#include <string.h>

wrap_state wrap;

void wrap_reset(void) { memset(&wrap, 0, sizeof wrap); }

/* True if this call must fail. */
static bool fails(const char *name) {
    wrap.setup_calls++;
    if (wrap.lost) wrap.calls_after_loss++;
    bool now = wrap.fail_at && (wrap.persistent ? wrap.setup_calls >= wrap.fail_at
                                                : wrap.setup_calls == wrap.fail_at);
    if (!now) return false;
    if (!wrap.failed_call) wrap.failed_call = name;
    if (wrap.fail_with == VK_ERROR_DEVICE_LOST) wrap.lost = true;
    return true;
}

#define REAL(name) ((PFN_vk##name)vkGetDeviceProcAddr(device, "vk" #name))

static void made(uint64_t n) {
    wrap.creates += n;
    wrap.live += (int64_t)n;
}

static void unmade(uint64_t n) {
    wrap.destroys += n;
    wrap.live -= (int64_t)n;
}

#define WRAP_CREATE(Name, Info, Handle)                                                            \
    static VKAPI_ATTR VkResult VKAPI_CALL create_##Name(                                           \
        VkDevice device, const Info *info, const VkAllocationCallbacks *allocator, Handle *out) {  \
        if (fails("vkCreate" #Name)) {                                                             \
            memset(out, 0xA5, sizeof *out);                                                        \
            return wrap.fail_with;                                                                 \
        }                                                                                          \
        VkResult r = REAL(Create##Name)(device, info, allocator, out);                             \
        if (!r) made(1);                                                                           \
        return r;                                                                                  \
    }                                                                                              \
    static VKAPI_ATTR void VKAPI_CALL destroy_##Name(VkDevice device, Handle handle,               \
                                                     const VkAllocationCallbacks *allocator) {     \
        if (handle) unmade(1);                                                                     \
        REAL(Destroy##Name)(device, handle, allocator);                                            \
    }

#define CREATES(X)                                                                                 \
    X(AccelerationStructureKHR, VkAccelerationStructureCreateInfoKHR, VkAccelerationStructureKHR)  \
    X(Buffer, VkBufferCreateInfo, VkBuffer)                                                        \
    X(CommandPool, VkCommandPoolCreateInfo, VkCommandPool)                                         \
    X(DescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)                                \
    X(DescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)                 \
    X(Framebuffer, VkFramebufferCreateInfo, VkFramebuffer)                                         \
    X(Image, VkImageCreateInfo, VkImage)                                                           \
    X(ImageView, VkImageViewCreateInfo, VkImageView)                                               \
    X(PipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)                                \
    X(QueryPool, VkQueryPoolCreateInfo, VkQueryPool)                                               \
    X(RenderPass, VkRenderPassCreateInfo, VkRenderPass)                                            \
    X(Sampler, VkSamplerCreateInfo, VkSampler)                                                     \
    X(ShaderModule, VkShaderModuleCreateInfo, VkShaderModule)

CREATES(WRAP_CREATE)

/* Descriptors of a set layout, per stage: vertex, fragment, compute. */
typedef struct layout_count {
    VkDescriptorSetLayout layout;
    struct {
        uint32_t uniform_buffers, storage_buffers, sampled_images, storage_images, all;
    } stage[3];
} layout_count;

static layout_count counts[512];
static uint32_t count_count;

static const VkShaderStageFlags counted_stages[3] = {
    VK_SHADER_STAGE_VERTEX_BIT, VK_SHADER_STAGE_FRAGMENT_BIT, VK_SHADER_STAGE_COMPUTE_BIT};

static VKAPI_ATTR VkResult VKAPI_CALL
create_counted_set_layout(VkDevice device, const VkDescriptorSetLayoutCreateInfo *info,
                          const VkAllocationCallbacks *allocator, VkDescriptorSetLayout *out) {
    layout_count c = {0};
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < info->bindingCount; i++) {
            const VkDescriptorSetLayoutBinding *b = &info->pBindings[i];
            uint32_t n = b->stageFlags & counted_stages[k] ? b->descriptorCount : 0;
            c.stage[k].all += n;
            if (b->descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER)
                c.stage[k].uniform_buffers += n;
            if (b->descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)
                c.stage[k].storage_buffers += n;
            if (b->descriptorType == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER)
                c.stage[k].sampled_images += n;
            if (b->descriptorType == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE)
                c.stage[k].storage_images += n;
        }
    }
    VkResult r = create_DescriptorSetLayout(device, info, allocator, out);
    if (r) return r;
    c.layout = *out;
    for (uint32_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        if (i < count_count && counts[i].layout != *out) continue; /* handles come again */
        counts[i] = c;
        if (i == count_count) count_count++;
        break;
    }
    return r;
}

static void raise(uint32_t *most, uint32_t n) {
    if (n > *most) *most = n;
}

static VKAPI_ATTR VkResult VKAPI_CALL
create_counted_pipeline_layout(VkDevice device, const VkPipelineLayoutCreateInfo *info,
                               const VkAllocationCallbacks *allocator, VkPipelineLayout *out) {
    wrap_most *most = &wrap.most;
    for (uint32_t k = 0; k < 3; k++) {
        wrap_most here = {0};
        for (uint32_t s = 0; s < info->setLayoutCount; s++) {
            for (uint32_t i = 0; i < count_count; i++) {
                if (counts[i].layout != info->pSetLayouts[s]) continue;
                here.uniform_buffers += counts[i].stage[k].uniform_buffers;
                here.storage_buffers += counts[i].stage[k].storage_buffers;
                here.sampled_images += counts[i].stage[k].sampled_images;
                here.storage_images += counts[i].stage[k].storage_images;
                here.all += counts[i].stage[k].all;
            }
        }
        raise(&most->uniform_buffers, here.uniform_buffers);
        raise(&most->storage_buffers, here.storage_buffers);
        raise(&most->sampled_images, here.sampled_images);
        raise(&most->storage_images, here.storage_images);
        raise(&most->all, here.all);
    }
    raise(&most->sets, info->setLayoutCount);
    for (uint32_t i = 0; i < info->pushConstantRangeCount; i++)
        raise(&most->push_bytes,
              info->pPushConstantRanges[i].offset + info->pPushConstantRanges[i].size);
    return create_PipelineLayout(device, info, allocator, out);
}

static VKAPI_ATTR VkResult VKAPI_CALL
create_counted_render_pass(VkDevice device, const VkRenderPassCreateInfo *info,
                           const VkAllocationCallbacks *allocator, VkRenderPass *out) {
    for (uint32_t i = 0; i < info->subpassCount; i++)
        raise(&wrap.most.attachments, info->pSubpasses[i].colorAttachmentCount);
    return create_RenderPass(device, info, allocator, out);
}

#define WRAP_PIPELINES(Kind)                                                                       \
    static VKAPI_ATTR VkResult VKAPI_CALL create_##Kind##Pipelines(                                \
        VkDevice device, VkPipelineCache cache, uint32_t n,                                        \
        const Vk##Kind##PipelineCreateInfo *info, const VkAllocationCallbacks *allocator,          \
        VkPipeline *out) {                                                                         \
        if (fails("vkCreate" #Kind "Pipelines")) {                                                 \
            memset(out, 0,                                                                         \
                   n * sizeof *out); /* except pipelines: null if they failed */                   \
            return wrap.fail_with;                                                                 \
        }                                                                                          \
        VkResult r = REAL(Create##Kind##Pipelines)(device, cache, n, info, allocator, out);        \
        if (!r) made(n);                                                                           \
        return r;                                                                                  \
    }

WRAP_PIPELINES(Compute)
WRAP_PIPELINES(Graphics)

static VKAPI_ATTR void VKAPI_CALL destroy_Pipeline(VkDevice device, VkPipeline handle,
                                                   const VkAllocationCallbacks *allocator) {
    if (handle) unmade(1);
    REAL(DestroyPipeline)(device, handle, allocator);
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_Memory(VkDevice device,
                                                      const VkMemoryAllocateInfo *info,
                                                      const VkAllocationCallbacks *allocator,
                                                      VkDeviceMemory *out) {
    if (fails("vkAllocateMemory")) {
        memset(out, 0xA5, sizeof *out);
        return wrap.fail_with;
    }
    VkMemoryAllocateInfo real = *info;
    if (wrap.fake_memory) real.memoryTypeIndex = 0;
    wrap.allocate_calls++;
    VkResult r = REAL(AllocateMemory)(device, &real, allocator, out);
    if (!r) made(1);
    return r;
}

static VKAPI_ATTR void VKAPI_CALL free_Memory(VkDevice device, VkDeviceMemory memory,
                                              const VkAllocationCallbacks *allocator) {
    if (memory) unmade(1);
    REAL(FreeMemory)(device, memory, allocator);
}

/* Command buffers and descriptor sets are freed with their pools. */
static VKAPI_ATTR VkResult VKAPI_CALL allocate_CommandBuffers(
    VkDevice device, const VkCommandBufferAllocateInfo *info, VkCommandBuffer *out) {
    if (fails("vkAllocateCommandBuffers")) {
        memset(out, 0, info->commandBufferCount * sizeof *out);
        return wrap.fail_with;
    }
    return REAL(AllocateCommandBuffers)(device, info, out);
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_DescriptorSets(
    VkDevice device, const VkDescriptorSetAllocateInfo *info, VkDescriptorSet *out) {
    if (fails("vkAllocateDescriptorSets")) {
        memset(out, 0, info->descriptorSetCount * sizeof *out);
        return wrap.fail_with;
    }
    return REAL(AllocateDescriptorSets)(device, info, out);
}

static VKAPI_ATTR VkResult VKAPI_CALL bind_BufferMemory(VkDevice device, VkBuffer buffer,
                                                        VkDeviceMemory memory,
                                                        VkDeviceSize offset) {
    if (fails("vkBindBufferMemory")) return wrap.fail_with;
    return REAL(BindBufferMemory)(device, buffer, memory, offset);
}

static VKAPI_ATTR VkResult VKAPI_CALL bind_ImageMemory(VkDevice device, VkImage image,
                                                       VkDeviceMemory memory, VkDeviceSize offset) {
    if (fails("vkBindImageMemory")) return wrap.fail_with;
    return REAL(BindImageMemory)(device, image, memory, offset);
}

static VKAPI_ATTR VkResult VKAPI_CALL map_Memory(VkDevice device, VkDeviceMemory memory,
                                                 VkDeviceSize offset, VkDeviceSize size,
                                                 VkMemoryMapFlags flags, void **out) {
    if (fails("vkMapMemory")) {
        memset(out, 0xA5, sizeof *out);
        return wrap.fail_with;
    }
    return REAL(MapMemory)(device, memory, offset, size, flags, out);
}

static VKAPI_ATTR void VKAPI_CALL buffer_requirements(VkDevice device, VkBuffer buffer,
                                                      VkMemoryRequirements *out) {
    REAL(GetBufferMemoryRequirements)(device, buffer, out);
    if (wrap.fake_memory) out->memoryTypeBits = wrap.fake_memory == 2 ? 7 : 3;
}

static VKAPI_ATTR void VKAPI_CALL image_requirements(VkDevice device, VkImage image,
                                                     VkMemoryRequirements *out) {
    REAL(GetImageMemoryRequirements)(device, image, out);
    if (wrap.fake_memory) out->memoryTypeBits = wrap.fake_memory == 2 ? 7 : 3;
}

/* Dispatchable objects without a device parameter: the real functions are stored at look-up. */
static PFN_vkBeginCommandBuffer real_begin;
static PFN_vkEndCommandBuffer real_end;
static PFN_vkResetCommandBuffer real_reset;
static PFN_vkCmdPipelineBarrier real_barrier;
static PFN_vkCmdFillBuffer real_fill;
static PFN_vkCmdBeginDebugUtilsLabelEXT real_label;

static VKAPI_ATTR void VKAPI_CALL cmd_barrier(VkCommandBuffer cmd, VkPipelineStageFlags from,
                                              VkPipelineStageFlags to, VkDependencyFlags flags,
                                              uint32_t memory_count, const VkMemoryBarrier *memory,
                                              uint32_t buffer_count,
                                              const VkBufferMemoryBarrier *buffers,
                                              uint32_t image_count,
                                              const VkImageMemoryBarrier *images) {
    if (!wrap.first_barrier_to) {
        wrap.first_barrier_from = from;
        wrap.first_barrier_to = to;
    }
    for (uint32_t i = 0; i < memory_count; i++) {
        VkAccessFlags a = memory[i].srcAccessMask, b = memory[i].dstAccessMask;
        wrap.host_barrier |= to == VK_PIPELINE_STAGE_HOST_BIT &&
                             (a & VK_ACCESS_TRANSFER_WRITE_BIT) && (b & VK_ACCESS_HOST_READ_BIT);
        wrap.counter_barrier |= to == VK_PIPELINE_STAGE_TRANSFER_BIT &&
                                (a & VK_ACCESS_SHADER_WRITE_BIT) &&
                                (b & VK_ACCESS_TRANSFER_READ_BIT);
    }
    for (uint32_t i = 0; i < image_count; i++) wrap.last_layout = images[i].newLayout;
    for (uint32_t i = 0; i < image_count && wrap.on_barrier; i++)
        wrap.on_barrier(cmd, from, to, &images[i]);
    real_barrier(cmd, from, to, flags, memory_count, memory, buffer_count, buffers, image_count,
                 images);
}

static VKAPI_ATTR void VKAPI_CALL cmd_fill(VkCommandBuffer cmd, VkBuffer buffer,
                                           VkDeviceSize offset, VkDeviceSize size, uint32_t word) {
    bool poison = word == 0x7FC07FC0u || word == 0x7C007C00u || word == 0x3C007FC0u;
    wrap.fills_of_poison += poison;
    if (poison) wrap.poison = word;
    real_fill(cmd, buffer, offset, size, word);
}

static VKAPI_ATTR void VKAPI_CALL cmd_label(VkCommandBuffer cmd,
                                            const VkDebugUtilsLabelEXT *label) {
    wrap.labels++;
    real_label(cmd, label);
    if (wrap.on_label) wrap.on_label(cmd, label->pLabelName);
}

static VKAPI_ATTR VkResult VKAPI_CALL begin_CommandBuffer(VkCommandBuffer cmd,
                                                          const VkCommandBufferBeginInfo *info) {
    return fails("vkBeginCommandBuffer") ? wrap.fail_with : real_begin(cmd, info);
}

static VKAPI_ATTR VkResult VKAPI_CALL end_CommandBuffer(VkCommandBuffer cmd) {
    return fails("vkEndCommandBuffer") ? wrap.fail_with : real_end(cmd);
}

static VKAPI_ATTR VkResult VKAPI_CALL reset_CommandBuffer(VkCommandBuffer cmd,
                                                          VkCommandBufferResetFlags flags) {
    return fails("vkResetCommandBuffer") ? wrap.fail_with : real_reset(cmd, flags);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device,
                                                                     const char *name) {
    if (wrap.unknown_function && !strcmp(name, wrap.unknown_function)) return NULL;
    if (!strcmp(name, "vkCreateDescriptorSetLayout"))
        return (PFN_vkVoidFunction)create_counted_set_layout;
    if (!strcmp(name, "vkCreatePipelineLayout"))
        return (PFN_vkVoidFunction)create_counted_pipeline_layout;
    if (!strcmp(name, "vkCreateRenderPass")) return (PFN_vkVoidFunction)create_counted_render_pass;
#define RETURN_CREATE(Name, Info, Handle)                                                          \
    if (!strcmp(name, "vkCreate" #Name)) return (PFN_vkVoidFunction)create_##Name;                 \
    if (!strcmp(name, "vkDestroy" #Name)) return (PFN_vkVoidFunction)destroy_##Name;
    CREATES(RETURN_CREATE)
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } others[] = {{"vkCreateComputePipelines", (PFN_vkVoidFunction)create_ComputePipelines},
                  {"vkCreateGraphicsPipelines", (PFN_vkVoidFunction)create_GraphicsPipelines},
                  {"vkDestroyPipeline", (PFN_vkVoidFunction)destroy_Pipeline},
                  {"vkAllocateMemory", (PFN_vkVoidFunction)allocate_Memory},
                  {"vkFreeMemory", (PFN_vkVoidFunction)free_Memory},
                  {"vkAllocateCommandBuffers", (PFN_vkVoidFunction)allocate_CommandBuffers},
                  {"vkAllocateDescriptorSets", (PFN_vkVoidFunction)allocate_DescriptorSets},
                  {"vkBindBufferMemory", (PFN_vkVoidFunction)bind_BufferMemory},
                  {"vkBindImageMemory", (PFN_vkVoidFunction)bind_ImageMemory},
                  {"vkMapMemory", (PFN_vkVoidFunction)map_Memory},
                  {"vkBeginCommandBuffer", (PFN_vkVoidFunction)begin_CommandBuffer},
                  {"vkEndCommandBuffer", (PFN_vkVoidFunction)end_CommandBuffer},
                  {"vkResetCommandBuffer", (PFN_vkVoidFunction)reset_CommandBuffer},
                  {"vkGetBufferMemoryRequirements", (PFN_vkVoidFunction)buffer_requirements},
                  {"vkGetImageMemoryRequirements", (PFN_vkVoidFunction)image_requirements},
                  {"vkCmdPipelineBarrier", (PFN_vkVoidFunction)cmd_barrier},
                  {"vkCmdFillBuffer", (PFN_vkVoidFunction)cmd_fill}};
    real_barrier = REAL(CmdPipelineBarrier);
    real_fill = REAL(CmdFillBuffer);
    real_begin = REAL(BeginCommandBuffer);
    real_end = REAL(EndCommandBuffer);
    real_reset = REAL(ResetCommandBuffer);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (!strcmp(name, others[i].name)) return others[i].function;
    }
    return vkGetDeviceProcAddr(device, name);
}

/* ---- Simulated limitations ------------------------------------------------------------------- */

static VKAPI_ATTR void VKAPI_CALL get_properties(VkPhysicalDevice device,
                                                 VkPhysicalDeviceProperties *out) {
    vkGetPhysicalDeviceProperties(device, out);
    if (wrap.row) masu_device_row_limit(wrap.row, out);
    if (wrap.api_version) out->apiVersion = wrap.api_version;
    if (wrap.max_image) out->limits.maxImageDimension2D = wrap.max_image;
    if (wrap.max_storage_buffers)
        out->limits.maxPerStageDescriptorStorageBuffers = wrap.max_storage_buffers;
    if (wrap.max_groups) out->limits.maxComputeWorkGroupCount[0] = wrap.max_groups;
    if (wrap.max_framebuffer) out->limits.maxFramebufferHeight = wrap.max_framebuffer;
    if (wrap.fake_memory) {
        out->deviceType = wrap.fake_memory == 1 ? VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU
                                                : VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    }
}

static VKAPI_ATTR void VKAPI_CALL get_memory(VkPhysicalDevice device,
                                             VkPhysicalDeviceMemoryProperties *out) {
    vkGetPhysicalDeviceMemoryProperties(device, out);
    if (!wrap.fake_memory) return;
    VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    VkMemoryPropertyFlags visible =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    out->memoryTypeCount = wrap.fake_memory == 2 ? 3 : 2;
    out->memoryTypes[0] = (VkMemoryType){local, 0};
    out->memoryTypes[1] = (VkMemoryType){visible, 0};
    out->memoryTypes[2] = (VkMemoryType){local | visible, 0};
}

static VKAPI_ATTR void VKAPI_CALL get_format(VkPhysicalDevice device, VkFormat format,
                                             VkFormatProperties *out) {
    vkGetPhysicalDeviceFormatProperties(device, format, out);
    if (format == wrap.lacking_format) memset(out, 0, sizeof *out);
}

static VKAPI_ATTR void VKAPI_CALL get_families(VkPhysicalDevice device, uint32_t *n,
                                               VkQueueFamilyProperties *out) {
    vkGetPhysicalDeviceQueueFamilyProperties(device, n, out);
    for (uint32_t i = 0; out && i < *n; i++) {
        if (wrap.no_compute) out[i].queueFlags &= ~(VkQueueFlags)VK_QUEUE_COMPUTE_BIT;
        if (wrap.no_timestamps || (wrap.row && !wrap.row->timestamps))
            out[i].timestampValidBits = 0;
    }
}

static VKAPI_ATTR void VKAPI_CALL get_features(VkPhysicalDevice device,
                                               VkPhysicalDeviceFeatures2 *out) {
    vkGetPhysicalDeviceFeatures2(device, out);
    if (wrap.row) masu_device_row_deny(wrap.row, &out->features);
    if (wrap.no_features) memset(&out->features, 0, sizeof out->features);
    for (VkBaseOutStructure *s = wrap.no_features ? out->pNext : NULL; s; s = s->pNext) {
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR)
            ((VkPhysicalDeviceRayQueryFeaturesKHR *)(void *)s)->rayQuery = VK_FALSE;
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES)
            ((VkPhysicalDeviceShaderFloat16Int8Features *)(void *)s)->shaderFloat16 = VK_FALSE;
    }
}

static VKAPI_ATTR void VKAPI_CALL get_core_features(VkPhysicalDevice device,
                                                    VkPhysicalDeviceFeatures *out) {
    vkGetPhysicalDeviceFeatures(device, out);
    if (wrap.row) masu_device_row_deny(wrap.row, out);
    if (wrap.no_features) memset(out, 0, sizeof *out);
}

static VKAPI_ATTR VkResult VKAPI_CALL get_extensions(VkPhysicalDevice device, const char *layer,
                                                     uint32_t *n, VkExtensionProperties *out) {
    if (!wrap.no_extensions) return vkEnumerateDeviceExtensionProperties(device, layer, n, out);
    *n = 0;
    return VK_SUCCESS;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL wrap_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name) {
    if (wrap.unknown_function && !strcmp(name, wrap.unknown_function)) return NULL;
    if (!strcmp(name, "vkGetDeviceProcAddr")) return (PFN_vkVoidFunction)get_device_proc_addr;
    if (!strcmp(name, "vkGetPhysicalDeviceProperties")) return (PFN_vkVoidFunction)get_properties;
    if (!strcmp(name, "vkGetPhysicalDeviceMemoryProperties")) {
        return (PFN_vkVoidFunction)get_memory;
    }
    if (!strcmp(name, "vkCmdBeginDebugUtilsLabelEXT")) {
        real_label = (PFN_vkCmdBeginDebugUtilsLabelEXT)vkGetInstanceProcAddr(instance, name);
        return real_label ? (PFN_vkVoidFunction)cmd_label : NULL;
    }
    if (!strcmp(name, "vkGetPhysicalDeviceFeatures2")) return (PFN_vkVoidFunction)get_features;
    if (!strcmp(name, "vkGetPhysicalDeviceFeatures")) return (PFN_vkVoidFunction)get_core_features;
    if (!strcmp(name, "vkEnumerateDeviceExtensionProperties"))
        return (PFN_vkVoidFunction)get_extensions;
    if (!strcmp(name, "vkGetPhysicalDeviceFormatProperties")) return (PFN_vkVoidFunction)get_format;
    if (!strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties"))
        return (PFN_vkVoidFunction)get_families;
    return vkGetInstanceProcAddr(instance, name);
}
