/* null_device.c: see null_device.h. */
#define _POSIX_C_SOURCE 200809L /* dup2, fileno */
#include "lab/isa/null_device.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PIPELINES = 256, EXECUTABLES = 8, STATISTICS = 64 };

/* Image sizes like a driver's: aligned rows, and 16 bytes per texel. */
#define TEXEL_BYTES 16u
#define ALIGNMENT 4096u

static struct {
    masu_null_device *device;
    masu_isa_rows *rows;
    void (*before)(const char *pass);
    /* Rows wait for their pipeline's name, which is set after creation. */
    struct {
        VkPipeline handle;
        uint32_t first, count;
    } pipelines[PIPELINES];
    uint32_t pipeline_count;
    uint64_t handles;
    PFN_vkCreateComputePipelines create_compute;
    PFN_vkCreateGraphicsPipelines create_graphics;
    PFN_vkGetPipelineExecutablePropertiesKHR executables;
    PFN_vkGetPipelineExecutableStatisticsKHR statistics;
} null;

static void fail(const char *what) {
    if (!null.rows->failed[0]) snprintf(null.rows->failed, sizeof null.rows->failed, "%s", what);
}

/* ---- Statistics ------------------------------------------------------------------------------ */

enum { NAME_SETS = 4 };
static const char *const field_names[MASU_ISA_FIELD_COUNT][NAME_SETS] = {
#define NAMES(ID, name, what, ...) {__VA_ARGS__},
    MASU_ISA_FIELDS(NAMES)
#undef NAMES
};

static double number(const VkPipelineExecutableStatisticKHR *s) {
    switch (s->format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_FLOAT64_KHR: return s->value.f64;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR: return (double)s->value.i64;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR: return s->value.b32 ? 1 : 0;
    default: return (double)s->value.u64;
    }
}

static void read_values(VkPipeline pipeline, uint32_t executable, masu_isa_row *row) {
    VkPipelineExecutableInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR,
                                        .pipeline = pipeline,
                                        .executableIndex = executable};
    VkPipelineExecutableStatisticKHR list[STATISTICS] = {{0}};
    uint32_t n = STATISTICS;
    for (uint32_t i = 0; i < STATISTICS; i++)
        list[i].sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR;
    if (null.statistics(null.device->device, &info, &n, list) < 0) {
        fail("vkGetPipelineExecutableStatisticsKHR fails");
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < MASU_ISA_FIELD_COUNT; k++) {
            for (uint32_t d = 0; d < NAME_SETS; d++) {
                if (field_names[k][d] && !strcmp(field_names[k][d], list[i].name))
                    row->value[k] = number(&list[i]);
            }
        }
    }
}

static masu_isa_row *add_row(const char *stage) {
    masu_isa_row *row = &null.rows->row[null.rows->count++];
    snprintf(row->pipeline, sizeof row->pipeline, "(no name)");
    snprintf(row->stage, sizeof row->stage, "%.*s", MASU_ISA_TEXT - 1, stage);
    for (uint32_t k = 0; k < MASU_ISA_FIELD_COUNT; k++) row->value[k] = (double)NAN;
    return row;
}

/* PanVK prints its statistics to standard error. */
static bool is_printed(void) { return getenv("BIFROST_MESA_DEBUG") != NULL; }

static void read_line(const char *line) {
    if (null.rows->count == MASU_ISA_ROWS) fail("too many pipelines");
    else masu_isa_read_printed(line, add_row(""));
}

/* Redirects standard error to a file; returns the descriptor to restore, or -1. */
static int capture(FILE **file) {
    int was = -1;
    *file = NULL;
    if (!is_printed() || !(*file = tmpfile())) return -1;
    fflush(stderr);
    was = dup(2);
    if (was >= 0) dup2(fileno(*file), 2);
    return was;
}

/* Restores standard error, reads statistics of the file and prints its other lines. */
static void read_captured(int was, FILE *file) {
    char line[1024];
    fflush(stderr);
    if (was >= 0) {
        dup2(was, 2);
        close(was);
    }
    if (!file) return;
    rewind(file);
    while (fgets(line, sizeof line, file)) {
        if (masu_isa_is_printed(line)) read_line(line);
        else fputs(line, stderr);
    }
    fclose(file);
}

static void read_executables(VkPipeline pipeline) {
    VkPipelineInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = pipeline};
    VkPipelineExecutablePropertiesKHR list[EXECUTABLES] = {{0}};
    uint32_t n = EXECUTABLES;
    for (uint32_t i = 0; i < EXECUTABLES; i++)
        list[i].sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR;
    if (null.executables(null.device->device, &info, &n, list) < 0) {
        fail("vkGetPipelineExecutablePropertiesKHR fails");
        return;
    }
    if (null.rows->count + n > MASU_ISA_ROWS) {
        fail("too many pipelines");
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        masu_isa_row *row = add_row(list[i].name);
        row->lanes = list[i].subgroupSize;
        read_values(pipeline, i, row);
    }
}

/* Adds the rows of a pipeline; those from `first` on are its captured ones. */
static void read_pipeline(VkPipeline pipeline, uint32_t first) {
    if (null.pipeline_count == PIPELINES) {
        fail("too many pipelines");
        return;
    }
    if (!is_printed()) read_executables(pipeline);
    null.pipelines[null.pipeline_count].handle = pipeline;
    null.pipelines[null.pipeline_count].first = first;
    null.pipelines[null.pipeline_count++].count = null.rows->count - first;
}

/* Neither gives the renderer's cache to the driver: a cached shader has no statistics. */
static VKAPI_ATTR VkResult VKAPI_CALL create_compute(VkDevice device, VkPipelineCache cache,
                                                     uint32_t n,
                                                     const VkComputePipelineCreateInfo *info,
                                                     const VkAllocationCallbacks *allocator,
                                                     VkPipeline *out) {
    VkComputePipelineCreateInfo changed = *info; /* the renderer creates one at a time */
    uint32_t first = null.rows->count;
    FILE *file;
    int was = capture(&file);
    (void)cache;
    changed.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    VkResult r = null.create_compute(device, VK_NULL_HANDLE, n, &changed, allocator, out);
    read_captured(was, file);
    if (!r) read_pipeline(*out, first);
    return r;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_graphics(VkDevice device, VkPipelineCache cache,
                                                      uint32_t n,
                                                      const VkGraphicsPipelineCreateInfo *info,
                                                      const VkAllocationCallbacks *allocator,
                                                      VkPipeline *out) {
    VkGraphicsPipelineCreateInfo changed = *info;
    uint32_t first = null.rows->count;
    FILE *file;
    int was = capture(&file);
    (void)cache;
    changed.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    VkResult r = null.create_graphics(device, VK_NULL_HANDLE, n, &changed, allocator, out);
    read_captured(was, file);
    if (!r) read_pipeline(*out, first);
    return r;
}

static VKAPI_ATTR VkResult VKAPI_CALL set_name(VkDevice device,
                                               const VkDebugUtilsObjectNameInfoEXT *info) {
    (void)device;
    if (info->objectType == VK_OBJECT_TYPE_PIPELINE_LAYOUT && null.before)
        null.before(info->pObjectName);
    for (uint32_t i = null.pipeline_count;
         i-- > 0 && info->objectType == VK_OBJECT_TYPE_PIPELINE;) {
        if ((uint64_t)(uintptr_t)null.pipelines[i].handle != info->objectHandle) continue;
        for (uint32_t k = 0; k < null.pipelines[i].count; k++) {
            masu_isa_row *row = &null.rows->row[null.pipelines[i].first + k];
            snprintf(row->pipeline, sizeof row->pipeline, "%s", info->pObjectName);
        }
        break; /* handles of destroyed pipelines are reused: the latest matches */
    }
    return VK_SUCCESS;
}

/* ---- Stand-ins ------------------------------------------------------------------------------- */

/* The object of a buffer or image handle. */
typedef struct thing {
    uint64_t bytes;
} thing;

static thing *make_thing(uint64_t bytes) {
    thing *t = malloc(sizeof *t);
    if (t) t->bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    return t;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo *info,
                                                    const VkAllocationCallbacks *allocator,
                                                    VkBuffer *out) {
    (void)device, (void)allocator;
    *out = (VkBuffer)(uintptr_t)make_thing(info->size);
    return *out ? VK_SUCCESS : VK_ERROR_OUT_OF_HOST_MEMORY;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_image(VkDevice device, const VkImageCreateInfo *info,
                                                   const VkAllocationCallbacks *allocator,
                                                   VkImage *out) {
    (void)device, (void)allocator;
    uint64_t texels = (uint64_t)info->extent.width * info->extent.height * info->extent.depth;
    *out = (VkImage)(uintptr_t)make_thing(texels * info->arrayLayers *
                                          (info->mipLevels > 1 ? 2 : 1) * TEXEL_BYTES);
    return *out ? VK_SUCCESS : VK_ERROR_OUT_OF_HOST_MEMORY;
}

static VKAPI_ATTR void VKAPI_CALL destroy_buffer(VkDevice device, VkBuffer buffer,
                                                 const VkAllocationCallbacks *allocator) {
    (void)device, (void)allocator;
    free((void *)(uintptr_t)buffer);
}

static VKAPI_ATTR void VKAPI_CALL destroy_image(VkDevice device, VkImage image,
                                                const VkAllocationCallbacks *allocator) {
    (void)device, (void)allocator;
    free((void *)(uintptr_t)image);
}

static VKAPI_ATTR void VKAPI_CALL buffer_needs(VkDevice device, VkBuffer buffer,
                                               VkMemoryRequirements *out) {
    (void)device;
    *out = (VkMemoryRequirements){((const thing *)(uintptr_t)buffer)->bytes, ALIGNMENT, 1};
}

static VKAPI_ATTR void VKAPI_CALL image_needs(VkDevice device, VkImage image,
                                              VkMemoryRequirements *out) {
    (void)device;
    *out = (VkMemoryRequirements){((const thing *)(uintptr_t)image)->bytes, ALIGNMENT, 1};
}

static VKAPI_ATTR VkResult VKAPI_CALL bind_buffer(VkDevice device, VkBuffer buffer,
                                                  VkDeviceMemory memory, VkDeviceSize offset) {
    (void)device, (void)buffer, (void)memory, (void)offset;
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL bind_image(VkDevice device, VkImage image,
                                                 VkDeviceMemory memory, VkDeviceSize offset) {
    (void)device, (void)image, (void)memory, (void)offset;
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device,
                                                      const VkMemoryAllocateInfo *info,
                                                      const VkAllocationCallbacks *allocator,
                                                      VkDeviceMemory *out) {
    (void)device, (void)allocator;
    size_t bytes = (size_t)((info->allocationSize + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT);
    *out = (VkDeviceMemory)(uintptr_t)aligned_alloc(ALIGNMENT, bytes);
    return *out ? VK_SUCCESS : VK_ERROR_OUT_OF_HOST_MEMORY;
}

static VKAPI_ATTR void VKAPI_CALL free_memory(VkDevice device, VkDeviceMemory memory,
                                              const VkAllocationCallbacks *allocator) {
    (void)device, (void)allocator;
    free((void *)(uintptr_t)memory);
}

static VKAPI_ATTR VkResult VKAPI_CALL map_memory(VkDevice device, VkDeviceMemory memory,
                                                 VkDeviceSize offset, VkDeviceSize size,
                                                 VkMemoryMapFlags flags, void **out) {
    (void)device, (void)size, (void)flags;
    *out = (char *)(uintptr_t)memory + offset;
    return VK_SUCCESS;
}

static VKAPI_ATTR void VKAPI_CALL memory_of(VkPhysicalDevice physical,
                                            VkPhysicalDeviceMemoryProperties *out) {
    (void)physical;
    memset(out, 0, sizeof *out);
    out->memoryTypeCount = out->memoryHeapCount = 1;
    out->memoryTypes[0].propertyFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                        VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    out->memoryHeaps[0] = (VkMemoryHeap){(VkDeviceSize)8 << 30, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
}

/* Objects of which only the handle is used: a number, not destroyed. */
#define NUMBERED(create, destroy, type, info_type)                                                 \
    static VKAPI_ATTR VkResult VKAPI_CALL create(VkDevice device, const info_type *info,           \
                                                 const VkAllocationCallbacks *allocator,           \
                                                 type *out) {                                      \
        (void)device, (void)info, (void)allocator;                                                 \
        *out = (type)(uintptr_t)(null.handles += ALIGNMENT);                                       \
        return VK_SUCCESS;                                                                         \
    }                                                                                              \
    static VKAPI_ATTR void VKAPI_CALL destroy(VkDevice device, type handle,                        \
                                              const VkAllocationCallbacks *allocator) {            \
        (void)device, (void)handle, (void)allocator;                                               \
    }
NUMBERED(create_view, destroy_view, VkImageView, VkImageViewCreateInfo)
NUMBERED(create_pool, destroy_pool, VkDescriptorPool, VkDescriptorPoolCreateInfo)
NUMBERED(create_command_pool, destroy_command_pool, VkCommandPool, VkCommandPoolCreateInfo)
NUMBERED(create_query_pool, destroy_query_pool, VkQueryPool, VkQueryPoolCreateInfo)
NUMBERED(create_framebuffer, destroy_framebuffer, VkFramebuffer, VkFramebufferCreateInfo)
#undef NUMBERED

static VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device,
                                                    const VkDescriptorSetAllocateInfo *info,
                                                    VkDescriptorSet *out) {
    (void)device;
    for (uint32_t i = 0; i < info->descriptorSetCount; i++)
        out[i] = (VkDescriptorSet)(uintptr_t)(null.handles += ALIGNMENT);
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_commands(VkDevice device,
                                                        const VkCommandBufferAllocateInfo *info,
                                                        VkCommandBuffer *out) {
    (void)device;
    for (uint32_t i = 0; i < info->commandBufferCount; i++)
        out[i] = (VkCommandBuffer)(uintptr_t)(null.handles += ALIGNMENT);
    return VK_SUCCESS;
}

static VKAPI_ATTR void VKAPI_CALL update_sets(VkDevice device, uint32_t n,
                                              const VkWriteDescriptorSet *writes,
                                              uint32_t copy_count,
                                              const VkCopyDescriptorSet *copies) {
    (void)device, (void)n, (void)writes, (void)copy_count, (void)copies;
}

static VKAPI_ATTR VkResult VKAPI_CALL begin_commands(VkCommandBuffer buffer,
                                                     const VkCommandBufferBeginInfo *info) {
    (void)buffer, (void)info;
    return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL end_commands(VkCommandBuffer buffer) {
    (void)buffer;
    return VK_SUCCESS;
}

/* All vkCmd*: recording is ignored. One function for all: the caller cleans up the arguments on
 * every platform of these drivers. */
static VKAPI_ATTR void VKAPI_CALL nothing(void) {}

/* ---- Looking up ------------------------------------------------------------------------------ */

static PFN_vkVoidFunction stand_in(const char *name) {
    static const struct {
        const char *name;
        PFN_vkVoidFunction function;
    } list[] = {{"vkCreateComputePipelines", (PFN_vkVoidFunction)create_compute},
                {"vkCreateGraphicsPipelines", (PFN_vkVoidFunction)create_graphics},
                {"vkSetDebugUtilsObjectNameEXT", (PFN_vkVoidFunction)set_name},
                {"vkCreateBuffer", (PFN_vkVoidFunction)create_buffer},
                {"vkDestroyBuffer", (PFN_vkVoidFunction)destroy_buffer},
                {"vkCreateImage", (PFN_vkVoidFunction)create_image},
                {"vkDestroyImage", (PFN_vkVoidFunction)destroy_image},
                {"vkGetBufferMemoryRequirements", (PFN_vkVoidFunction)buffer_needs},
                {"vkGetImageMemoryRequirements", (PFN_vkVoidFunction)image_needs},
                {"vkBindBufferMemory", (PFN_vkVoidFunction)bind_buffer},
                {"vkBindImageMemory", (PFN_vkVoidFunction)bind_image},
                {"vkAllocateMemory", (PFN_vkVoidFunction)allocate_memory},
                {"vkFreeMemory", (PFN_vkVoidFunction)free_memory},
                {"vkMapMemory", (PFN_vkVoidFunction)map_memory},
                {"vkGetPhysicalDeviceMemoryProperties", (PFN_vkVoidFunction)memory_of},
                {"vkCreateImageView", (PFN_vkVoidFunction)create_view},
                {"vkDestroyImageView", (PFN_vkVoidFunction)destroy_view},
                {"vkCreateDescriptorPool", (PFN_vkVoidFunction)create_pool},
                {"vkDestroyDescriptorPool", (PFN_vkVoidFunction)destroy_pool},
                {"vkCreateCommandPool", (PFN_vkVoidFunction)create_command_pool},
                {"vkDestroyCommandPool", (PFN_vkVoidFunction)destroy_command_pool},
                {"vkCreateQueryPool", (PFN_vkVoidFunction)create_query_pool},
                {"vkDestroyQueryPool", (PFN_vkVoidFunction)destroy_query_pool},
                {"vkCreateFramebuffer", (PFN_vkVoidFunction)create_framebuffer},
                {"vkDestroyFramebuffer", (PFN_vkVoidFunction)destroy_framebuffer},
                {"vkAllocateDescriptorSets", (PFN_vkVoidFunction)allocate_sets},
                {"vkAllocateCommandBuffers", (PFN_vkVoidFunction)allocate_commands},
                {"vkUpdateDescriptorSets", (PFN_vkVoidFunction)update_sets},
                {"vkBeginCommandBuffer", (PFN_vkVoidFunction)begin_commands},
                {"vkEndCommandBuffer", (PFN_vkVoidFunction)end_commands}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        if (!strcmp(list[i].name, name)) return list[i].function;
    return strncmp(name, "vkCmd", 5) ? NULL : (PFN_vkVoidFunction)nothing;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device(VkDevice device, const char *name) {
    PFN_vkVoidFunction mine = stand_in(name);
    return mine ? mine : vkGetDeviceProcAddr(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_null_get_instance_proc_addr(VkInstance instance,
                                                                          const char *name) {
    PFN_vkVoidFunction mine = stand_in(name);
    if (!strcmp(name, "vkGetDeviceProcAddr")) mine = (PFN_vkVoidFunction)get_device;
    return mine ? mine : vkGetInstanceProcAddr(instance, name);
}

/* ---- The device ------------------------------------------------------------------------------ */

static bool complain(char *error, size_t size, const char *what) {
    snprintf(error, size, "%s", what);
    return false;
}

static bool open_physical(masu_null_device *d, char *error, size_t size) {
    VkApplicationInfo app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                             .apiVersion = VK_API_VERSION_1_1};
    VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                 .pApplicationInfo = &app};
    uint32_t n = 1, families = 16;
    VkQueueFamilyProperties list[16];
    if (vkCreateInstance(&info, NULL, &d->instance))
        return complain(error, size, "there is no Vulkan driver");
    VkResult r = vkEnumeratePhysicalDevices(d->instance, &n, &d->physical);
    if (r < 0 || !n) return complain(error, size, "the driver has no device");
    vkGetPhysicalDeviceProperties(d->physical, &d->properties);
    vkGetPhysicalDeviceQueueFamilyProperties(d->physical, &families, list);
    for (uint32_t i = 0; i < families; i++) {
        VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        d->family = i;
        if ((list[i].queueFlags & both) == both) return true;
    }
    return complain(error, size, "the device has no queue family for graphics and compute");
}

static bool open_device(masu_null_device *d, char *error, size_t size) {
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR statistics = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};
    VkPhysicalDeviceShaderFloat16Int8Features halves = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES,
        .pNext = &statistics};
    VkPhysicalDeviceFeatures2 has = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                     .pNext = &halves};
    const char *const extensions[] = {VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME,
                                      VK_KHR_SHADER_FLOAT16_INT8_EXTENSION_NAME};
    float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                     .queueFamilyIndex = d->family,
                                     .queueCount = 1,
                                     .pQueuePriorities = &priority};
    vkGetPhysicalDeviceFeatures2(d->physical, &has);
    if (!statistics.pipelineExecutableInfo)
        return complain(error, size, "the driver has no VK_KHR_pipeline_executable_properties");
    d->compressed = has.features.textureCompressionBC;
    d->float16 = halves.shaderFloat16;
    d->most_anisotropy =
        has.features.samplerAnisotropy ? d->properties.limits.maxSamplerAnisotropy : 0.0f;
    VkPhysicalDeviceFeatures features = {.samplerAnisotropy = has.features.samplerAnisotropy,
                                         .textureCompressionBC = has.features.textureCompressionBC};
    halves.shaderInt8 = VK_FALSE;
    VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                               .pNext = d->float16 ? (void *)&halves : (void *)&statistics,
                               .queueCreateInfoCount = 1,
                               .pQueueCreateInfos = &queue,
                               .enabledExtensionCount = d->float16 ? 2 : 1,
                               .ppEnabledExtensionNames = extensions,
                               .pEnabledFeatures = &features};
    if (vkCreateDevice(d->physical, &info, NULL, &d->device))
        return complain(error, size, "the driver makes no device");
    return true;
}

bool masu_null_device_open(masu_null_device *device, void (*before)(const char *pass),
                           masu_isa_rows *rows, char *error, size_t error_size) {
    memset(device, 0, sizeof *device);
    memset(&null, 0, sizeof null);
    if (!open_physical(device, error, error_size) || !open_device(device, error, error_size)) {
        masu_null_device_close(device);
        return false;
    }
    null.device = device;
    null.rows = rows;
    null.before = before;
#define REAL(name) (PFN_vk##name)(void (*)(void))vkGetDeviceProcAddr(device->device, "vk" #name)
    null.create_compute = REAL(CreateComputePipelines);
    null.create_graphics = REAL(CreateGraphicsPipelines);
    null.executables = REAL(GetPipelineExecutablePropertiesKHR);
    null.statistics = REAL(GetPipelineExecutableStatisticsKHR);
#undef REAL
    return true;
}

void masu_null_device_close(masu_null_device *device) {
    if (device->device) vkDestroyDevice(device->device, NULL);
    if (device->instance) vkDestroyInstance(device->instance, NULL);
    memset(device, 0, sizeof *device);
}
