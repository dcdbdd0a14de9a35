/* vk.c: loads the function table and checks the device against the minimum requirements that masu.h
 * states. */
#include "device/vk.h"

#include "base/error.h"
#include "plan/output.h"
#include "shared/masu_shared.h"

#include <string.h>

typedef struct format_floor {
    VkFormat format;
    const char *name;
    VkFormatFeatureFlags features; /* with optimal tiling */
} format_floor;

/* All but the first are mandatory in Vulkan 1.1 (specification, "Required Format Support"). They
 * are checked nevertheless: a non-conformant driver would fail later with a less clear error. */
static const format_floor format_floors[] = {
    {VK_FORMAT_D32_SFLOAT, "VK_FORMAT_D32_SFLOAT",
     VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT},
    {VK_FORMAT_D16_UNORM, "VK_FORMAT_D16_UNORM",
     VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT},
    {VK_FORMAT_R8G8B8A8_UNORM, "VK_FORMAT_R8G8B8A8_UNORM",
     VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT |
         VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_BLIT_SRC_BIT},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, "VK_FORMAT_A2B10G10R10_UNORM_PACK32",
     VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT},
    {VK_FORMAT_R32_UINT, "VK_FORMAT_R32_UINT",
     VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT |
         VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT},
    {VK_FORMAT_R32_SFLOAT, "VK_FORMAT_R32_SFLOAT",
     VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT},
    {VK_FORMAT_R16G16B16A16_SFLOAT, "VK_FORMAT_R16G16B16A16_SFLOAT",
     VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT},
};

static masu_result check_formats(const masu_desc *desc, const masu_vk *vk, masu_detail *detail) {
    for (size_t i = 0; i < sizeof format_floors / sizeof *format_floors; i++) {
        VkFormatProperties p;
        memset(&p, 0, sizeof p);
        vk->GetPhysicalDeviceFormatProperties(vk->physical, format_floors[i].format, &p);
        VkFormatFeatureFlags missing = format_floors[i].features & ~p.optimalTilingFeatures;
        if (missing) {
            return masu_fail(detail, MASU_ERROR_DEVICE, format_floors[i].name,
                             format_floors[i].features, p.optimalTilingFeatures,
                             "device '%s' lacks features 0x%x of %s", vk->properties.deviceName,
                             missing, format_floors[i].name);
        }
    }
    VkFormat target = desc->targets.format ? desc->targets.format : VK_FORMAT_R8G8B8A8_UNORM;
    VkFormatProperties target_properties;
    memset(&target_properties, 0, sizeof target_properties);
    vk->GetPhysicalDeviceFormatProperties(vk->physical, target, &target_properties);
    /* Output with an sRGB format is copied, any other format is blitted. */
    VkFormatFeatureFlags into = masu_output_copies(desc) ? VK_FORMAT_FEATURE_TRANSFER_DST_BIT
                                                         : VK_FORMAT_FEATURE_BLIT_DST_BIT;
    if (!desc->targets.storage && !(target_properties.optimalTilingFeatures & into)) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "targets.format", into,
                         target_properties.optimalTilingFeatures,
                         "device '%s' cannot blit or copy to targets.format %d",
                         vk->properties.deviceName, (int)target);
    }
    return MASU_OK;
}

static masu_result check_sizes(const masu_desc *desc, const masu_vk *vk, masu_detail *detail) {
    const VkPhysicalDeviceLimits *limits = &vk->properties.limits;
    uint32_t widest =
        desc->output.width > desc->output.height ? desc->output.width : desc->output.height;
    uint32_t most = limits->maxImageDimension2D;
    if (most > limits->maxFramebufferWidth) most = limits->maxFramebufferWidth;
    if (most > limits->maxFramebufferHeight) most = limits->maxFramebufferHeight;
    if (widest > most) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "output", widest, most,
                         "output %ux%u is larger than the device's images may be (%u)",
                         desc->output.width, desc->output.height, most);
    }
    uint32_t groups = (widest + MASU_GROUP - 1) / MASU_GROUP;
    if (groups > limits->maxComputeWorkGroupCount[0] ||
        groups > limits->maxComputeWorkGroupCount[1]) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxComputeWorkGroupCount", groups,
                         limits->maxComputeWorkGroupCount[0],
                         "output %ux%u needs %u workgroups per axis, the device has %u",
                         desc->output.width, desc->output.height, groups,
                         limits->maxComputeWorkGroupCount[0]);
    }
    return MASU_OK;
}

/* SPIR-V with storage buffers; format features for transfers; image views with less usage than
 * their image. */
const char *const masu_vk_1_0_extensions[MASU_VK_1_0_EXTENSIONS] = {
    VK_KHR_STORAGE_BUFFER_STORAGE_CLASS_EXTENSION_NAME, VK_KHR_MAINTENANCE1_EXTENSION_NAME,
    VK_KHR_MAINTENANCE2_EXTENSION_NAME};

#define EXTENSIONS_READ 512u
uint32_t masu_vk_find_extensions(const masu_vk *vk, PFN_vkGetInstanceProcAddr get_proc,
                                 const char *const *names, uint32_t count) {
    PFN_vkEnumerateDeviceExtensionProperties enumerate =
        (PFN_vkEnumerateDeviceExtensionProperties)get_proc(vk->instance,
                                                           "vkEnumerateDeviceExtensionProperties");
    VkExtensionProperties list[EXTENSIONS_READ];
    uint32_t n = EXTENSIONS_READ, found = 0;
    VkResult r = enumerate ? enumerate(vk->physical, NULL, &n, list) : VK_NOT_READY;
    if (r != VK_SUCCESS && r != VK_INCOMPLETE) n = 0;
    for (uint32_t e = 0; e < count; e++) {
        for (uint32_t i = 0; i < n; i++)
            found |= (uint32_t)!strcmp(list[i].extensionName, names[e]) << e;
    }
    return found;
}

/* Name of an extension that a Vulkan 1.0 device lacks; NULL: none. */
static const char *missing_extension(const masu_desc *desc, const masu_vk *vk) {
    if (vk->properties.apiVersion >= VK_API_VERSION_1_1) return NULL;
    uint32_t found = masu_vk_find_extensions(vk, desc->vulkan.get_instance_proc_addr,
                                             masu_vk_1_0_extensions, MASU_VK_1_0_EXTENSIONS);
    for (uint32_t e = 0; e < MASU_VK_1_0_EXTENSIONS; e++)
        if (!(found >> e & 1u)) return masu_vk_1_0_extensions[e];
    return NULL;
}

static masu_result check_floor(const masu_desc *desc, const masu_vk *vk, masu_detail *detail) {
    const char *missing = missing_extension(desc, vk);
    if (missing) {
        return masu_fail(detail, MASU_ERROR_DEVICE, missing, 1, 0,
                         "device '%s' with Vulkan 1.0 lacks the extension %s",
                         vk->properties.deviceName, missing);
    }
    VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    if ((vk->queue_family.queueFlags & wanted) != wanted) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "queue family with graphics and compute",
                         wanted, vk->queue_family.queueFlags,
                         "queue family %u of '%s' lacks graphics or compute (flags 0x%x)",
                         desc->vulkan.queue_family, vk->properties.deviceName,
                         vk->queue_family.queueFlags);
    }
    masu_result result = check_formats(desc, vk, detail);
    if (result) return result;
    if (desc->debug.timestamps && vk->queue_family.timestampValidBits == 0) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "debug.timestamps", 1, 0,
                         "queue family %u of '%s' has no timestamps; leave debug.timestamps at 0",
                         desc->vulkan.queue_family, vk->properties.deviceName);
    }
    return check_sizes(desc, vk, detail);
}

masu_result masu_vk_load_ray_limits(const masu_desc *desc, masu_vk *vk, masu_detail *detail) {
    PFN_vkGetPhysicalDeviceProperties2 get = (PFN_vkGetPhysicalDeviceProperties2)
        desc->vulkan.get_instance_proc_addr(vk->instance, "vkGetPhysicalDeviceProperties2");
    if (!get) {
        return masu_fail(
            detail, MASU_ERROR_DEVICE, "vkGetPhysicalDeviceProperties2", 1, 0,
            "the host's get_instance_proc_addr knows no vkGetPhysicalDeviceProperties2");
    }
    vk->rays.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR;
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &vk->rays};
    get(vk->physical, &properties);
    vk->rays.pNext = NULL;
    return MASU_OK;
}

/* Loads the ray query functions. The host states that they are enabled, so a missing one is an
 * error. */
static masu_result load_rays(const masu_desc *desc, masu_vk *vk, masu_detail *detail) {
    if (!desc->vulkan.ray_query || desc->ray_query == MASU_OFF) return MASU_OK;
#define MASU_VK_LOAD_RAYS(name)                                                                    \
    vk->name = (PFN_vk##name)vk->GetDeviceProcAddr(vk->device, "vk" #name);
    MASU_VK_RAYS(MASU_VK_LOAD_RAYS)
#undef MASU_VK_LOAD_RAYS
    /* A device may have enabled the Vulkan 1.2 feature instead of the extension; then only the core
     * name exists. */
    if (!vk->GetBufferDeviceAddressKHR) {
        vk->GetBufferDeviceAddressKHR = (PFN_vkGetBufferDeviceAddressKHR)vk->GetDeviceProcAddr(
            vk->device, "vkGetBufferDeviceAddress");
    }
#define MASU_VK_CHECK_RAYS(name)                                                                   \
    if (!vk->name) {                                                                               \
        return masu_fail(detail, MASU_ERROR_DEVICE, "vk" #name, 1, 0,                              \
                         "vulkan.ray_query is set, but the device knows no vk" #name);             \
    }
    MASU_VK_RAYS(MASU_VK_CHECK_RAYS)
#undef MASU_VK_CHECK_RAYS
    return masu_vk_load_ray_limits(desc, vk, detail);
}

/* Vulkan's requirements on the host's allocation callbacks. Drivers call them without checks. */
static masu_result check_allocator(const VkAllocationCallbacks *a, masu_detail *detail) {
    if (!a) return MASU_OK;
    if (!a->pfnAllocation) return masu_fail_null(detail, "vulkan.allocator.pfnAllocation");
    if (!a->pfnReallocation) return masu_fail_null(detail, "vulkan.allocator.pfnReallocation");
    if (!a->pfnFree) return masu_fail_null(detail, "vulkan.allocator.pfnFree");
    if (!a->pfnInternalAllocation == !a->pfnInternalFree) return MASU_OK;
    const char *what = a->pfnInternalFree ? "vulkan.allocator.pfnInternalAllocation"
                                          : "vulkan.allocator.pfnInternalFree";
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 1, 0,
                     "%s is NULL, and the other one is not", what);
}

static masu_result check_handles(const masu_vulkan *host, masu_detail *detail) {
    if (!host->get_instance_proc_addr)
        return masu_fail_null(detail, "vulkan.get_instance_proc_addr");
    if (!host->instance) return masu_fail_null(detail, "vulkan.instance");
    if (!host->physical_device) return masu_fail_null(detail, "vulkan.physical_device");
    return MASU_OK;
}

masu_result masu_vk_load_physical(const masu_desc *desc, masu_vk *vk, masu_detail *detail) {
    const masu_vulkan *host = &desc->vulkan;
    memset(vk, 0, sizeof *vk);
    masu_result result = check_handles(host, detail);
    if (result) return result;
    vk->instance = host->instance;
    vk->physical = host->physical_device;
#define MASU_VK_LOAD_INSTANCE(name)                                                                \
    vk->name = (PFN_vk##name)host->get_instance_proc_addr(host->instance, "vk" #name);             \
    if (!vk->name) {                                                                               \
        return masu_fail(detail, MASU_ERROR_DEVICE, "vk" #name, 1, 0,                              \
                         "the host's get_instance_proc_addr knows no vk" #name);                   \
    }
    MASU_VK_INSTANCE(MASU_VK_LOAD_INSTANCE)
#undef MASU_VK_LOAD_INSTANCE
    vk->GetPhysicalDeviceProperties(vk->physical, &vk->properties);
    vk->GetPhysicalDeviceMemoryProperties(vk->physical, &vk->memory);
    uint32_t families = 0;
    vk->GetPhysicalDeviceQueueFamilyProperties(vk->physical, &families, NULL);
    if (host->queue_family >= families) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "vulkan.queue_family", families,
                         host->queue_family, "queue_family is %u, the device has %u families",
                         host->queue_family, families);
    }
    VkQueueFamilyProperties list[32];
    uint32_t listed = families < 32 ? families : 32;
    vk->GetPhysicalDeviceQueueFamilyProperties(vk->physical, &listed, list);
    if (host->queue_family >= listed) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "vulkan.queue_family", listed,
                         host->queue_family, "queue_family %u is not among the first %u",
                         host->queue_family, listed);
    }
    vk->queue_family = list[host->queue_family];
    return check_floor(desc, vk, detail);
}

masu_result masu_vk_load(const masu_desc *desc, masu_vk *vk, masu_detail *detail) {
    const masu_vulkan *host = &desc->vulkan;
    masu_result result = check_handles(host, detail);
    if (!result && !host->device) result = masu_fail_null(detail, "vulkan.device");
    if (!result) result = check_allocator(host->allocator, detail);
    if (!result) result = masu_vk_load_physical(desc, vk, detail);
    if (result) return result;
    vk->device = host->device;
    vk->allocator = host->allocator;
#define MASU_VK_LOAD_DEVICE(name)                                                                  \
    vk->name = (PFN_vk##name)vk->GetDeviceProcAddr(host->device, "vk" #name);                      \
    if (!vk->name) {                                                                               \
        return masu_fail(detail, MASU_ERROR_DEVICE, "vk" #name, 1, 0,                              \
                         "the device knows no vk" #name);                                          \
    }
    MASU_VK_DEVICE(MASU_VK_LOAD_DEVICE)
#undef MASU_VK_LOAD_DEVICE
    if (desc->debug.labels) {
#define MASU_VK_LOAD_OPTIONAL(name)                                                                \
    vk->name = (PFN_vk##name)host->get_instance_proc_addr(host->instance, "vk" #name);
        MASU_VK_OPTIONAL(MASU_VK_LOAD_OPTIONAL)
#undef MASU_VK_LOAD_OPTIONAL
    }
    return load_rays(desc, vk, detail);
}
