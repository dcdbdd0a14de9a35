/* headless.c: instance, device, queue and submits of the headless host; headless_image.c has the
 * images. */
#define _POSIX_C_SOURCE 200809L
#include "headless.h"

#include "masu.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MANY 64u
#define SURFACE_EXTENSIONS 8u

bool masu_headless_fail(char *error, size_t size, const char *what, VkResult r) {
    snprintf(error, size, "%s failed with VkResult %d%s", what, (int)r,
             r == VK_ERROR_DEVICE_LOST             ? " (device lost)"
             : r == VK_ERROR_OUT_OF_DEVICE_MEMORY  ? " (out of device memory)"
             : r == VK_ERROR_OUT_OF_HOST_MEMORY    ? " (out of host memory)"
             : r == VK_ERROR_INCOMPATIBLE_DRIVER   ? " (no Vulkan driver found)"
             : r == VK_ERROR_INITIALIZATION_FAILED ? " (initialisation failed)"
                                                   : "");
    return false;
}

/* ---- Instance -------------------------------------------------------------------------------- */

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user) {
    masu_headless *host = user;
    (void)severity;
    /* The loader reports its search for drivers as "general"; a missing file or a second driver is
     * not an error here. The layers' findings are validation or performance. */
    if (!(types & VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT)) return VK_FALSE;
    const char *text = data->pMessage ? data->pMessage : "";
    if (host->messages++ == 0)
        snprintf(host->first_message, sizeof host->first_message, "%s", text);
    if (host->desc.message) host->desc.message(host->desc.message_user, text);
    return VK_FALSE;
}

static bool has_layer(const char *name) {
    VkLayerProperties layers[MANY];
    uint32_t n = MANY;
    VkResult r = vkEnumerateInstanceLayerProperties(&n, layers);
    if (r != VK_SUCCESS && r != VK_INCOMPLETE) return false;
    for (uint32_t i = 0; i < n; i++) {
        if (!strcmp(layers[i].layerName, name)) return true;
    }
    return false;
}

static bool has_instance_extension(const char *layer, const char *name) {
    VkExtensionProperties list[MANY];
    uint32_t n = MANY;
    VkResult r = vkEnumerateInstanceExtensionProperties(layer, &n, list);
    if (r != VK_SUCCESS && r != VK_INCOMPLETE) return false;
    for (uint32_t i = 0; i < n; i++) {
        if (!strcmp(list[i].extensionName, name)) return true;
    }
    return false;
}

static bool create_instance(masu_headless *host, char *error, size_t size) {
    static const char *const layer = "VK_LAYER_KHRONOS_validation";
    const char *extensions[2 + SURFACE_EXTENSIONS];
    uint32_t extension_count = 0;
    for (uint32_t i = 0; i < host->desc.surface_extension_count && i < SURFACE_EXTENSIONS; i++)
        extensions[extension_count++] = host->desc.surface_extensions[i];
    bool wants = host->desc.validate || host->desc.gpu_av;
    host->validating = wants && has_layer(layer);
    if (wants && !host->validating && host->desc.message) {
        host->desc.message(host->desc.message_user,
                           "the Khronos validation layer is not installed: validation is disabled");
    }
    host->labels =
        (host->validating || host->desc.labels) &&
        (has_instance_extension(NULL, VK_EXT_DEBUG_UTILS_EXTENSION_NAME) ||
         (host->validating && has_instance_extension(layer, VK_EXT_DEBUG_UTILS_EXTENSION_NAME)));
    if (host->labels) extensions[extension_count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    if (host->validating &&
        has_instance_extension(layer, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME)) {
        extensions[extension_count++] = VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME;
    }
    VkValidationFeatureEnableEXT enables[2];
    uint32_t enable_count = 0;
    if (host->desc.gpu_av) {
        enables[enable_count++] = VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT;
    } else {
        enables[enable_count++] = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    }
    if (host->desc.best) enables[enable_count++] = VK_VALIDATION_FEATURE_ENABLE_BEST_PRACTICES_EXT;
    VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                        .enabledValidationFeatureCount = enable_count,
                                        .pEnabledValidationFeatures = enables};
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = host};
    VkApplicationInfo app = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                             .pApplicationName = "masu",
                             .apiVersion =
                                 host->desc.vulkan_1_0 ? VK_API_VERSION_1_0 : VK_API_VERSION_1_1};
    VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                 .pNext = host->validating ? &features : NULL,
                                 .pApplicationInfo = &app,
                                 .enabledLayerCount = host->validating ? 1 : 0,
                                 .ppEnabledLayerNames = &layer,
                                 .enabledExtensionCount = extension_count,
                                 .ppEnabledExtensionNames = extensions};
    VkResult r = vkCreateInstance(&info, host->desc.allocator, &host->instance);
    if (r) return masu_headless_fail(error, size, "vkCreateInstance", r);
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(host->instance,
                                                                  "vkCreateDebugUtilsMessengerEXT");
    if (host->validating && create) {
        r = create(host->instance, &messenger, host->desc.allocator, &host->messenger);
        if (r) return masu_headless_fail(error, size, "vkCreateDebugUtilsMessengerEXT", r);
    }
    return true;
}

/* ---- Device ---------------------------------------------------------------------------------- */

static bool contains(const char *text, const char *part) {
    size_t n = strlen(part);
    for (; *text; text++) {
        size_t i = 0;
        while (i < n && text[i] &&
               tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
            i++;
        if (i == n) return true;
    }
    return n == 0;
}

static bool find_family(VkPhysicalDevice device, uint32_t *family) {
    VkQueueFamilyProperties list[MANY];
    uint32_t n = MANY;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &n, list);
    VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < n; i++) {
        if ((list[i].queueFlags & wanted) == wanted) {
            *family = i;
            return true;
        }
    }
    return false;
}

static bool is_index(const char *s, uint32_t *index) {
    char *end;
    unsigned long v = strtoul(s, &end, 10);
    if (!isdigit((unsigned char)*s) || *end || v >= MANY) return false;
    *index = (uint32_t)v;
    return true;
}

static bool has_extensions(VkPhysicalDevice device, const char *const *names, uint32_t count) {
    uint32_t n = 0, found = 0;
    if (vkEnumerateDeviceExtensionProperties(device, NULL, &n, NULL)) return false;
    VkExtensionProperties *list = malloc((n + 1) * sizeof *list);
    VkResult r = list ? vkEnumerateDeviceExtensionProperties(device, NULL, &n, list) : VK_NOT_READY;
    for (uint32_t e = 0; e < count && r == VK_SUCCESS; e++) {
        for (uint32_t i = 0; i < n; i++) found += !strcmp(list[i].extensionName, names[e]);
    }
    free(list);
    return found == count;
}

static const char *const swapchain_extension[] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};

/* Always true for a host without a window. */
static bool can_present(masu_headless *host, VkPhysicalDevice device) {
    const masu_headless_desc *d = &host->desc;
    if (d->surface_extension_count && !has_extensions(device, swapchain_extension, 1)) return false;
    return !d->presents || d->presents(d->surface_user, host->instance, device, host->family);
}

static bool choose_device(masu_headless *host, char *error, size_t size) {
    VkPhysicalDevice devices[MANY];
    uint32_t n = MANY, wanted_index = 0;
    const char *wanted = host->desc.device ? host->desc.device : getenv("MASU_DEVICE");
    bool by_index = wanted && is_index(wanted, &wanted_index);
    VkResult r = vkEnumeratePhysicalDevices(host->instance, &n, devices);
    if (r && r != VK_INCOMPLETE)
        return masu_headless_fail(error, size, "vkEnumeratePhysicalDevices", r);
    size_t used = (size_t)snprintf(error, size, "no Vulkan device%s%s; available:",
                                   wanted ? " matches " : " is suitable", wanted ? wanted : "");
    for (uint32_t i = 0; i < n; i++) {
        VkPhysicalDeviceProperties p;
        vkGetPhysicalDeviceProperties(devices[i], &p);
        if (used < size)
            used += (size_t)snprintf(error + used, size - used, " %u '%s'", i, p.deviceName);
        if (by_index ? i != wanted_index : wanted && !contains(p.deviceName, wanted)) continue;
        if (!find_family(devices[i], &host->family)) continue;
        if (!can_present(host, devices[i])) continue;
        host->physical = devices[i];
        host->properties = p;
        if (host->desc.vulkan_1_0) host->properties.apiVersion = VK_API_VERSION_1_0;
        return true;
    }
    if (!n && used < size) snprintf(error + used, size - used, " none");
    return false;
}

static bool create_device(masu_headless *host, char *error, size_t size) {
    float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                     .queueFamilyIndex = host->family,
                                     .queueCount = 1,
                                     .pQueuePriorities = &priority};
    VkPhysicalDeviceFeatures offered;
    vkGetPhysicalDeviceFeatures(host->physical, &offered);
    masu_device_info can;
    masu_detail detail;
    masu_desc ask = {MASU_DESC,
                     .vulkan = {.get_instance_proc_addr = host->desc.get_instance_proc_addr,
                                .instance = host->instance,
                                .physical_device = host->physical,
                                .queue_family = host->family},
                     .ray_query = host->desc.ray_query ? MASU_AUTO : MASU_OFF};
    if (masu_device_query(&ask, &can, &detail))
        return snprintf(error, size, "%s", detail.text), false;
    if (host->desc.deny) {
        can.used = 0, can.max_anisotropy = 0.0f, offered = (VkPhysicalDeviceFeatures){0};
        if (host->properties.apiVersion >= VK_API_VERSION_1_1) can.extension_count = 0;
    }
    host->compressed = (can.used & MASU_FEATURE_TEXTURE_COMPRESSION_BC) != 0;
    host->ray_query = (can.used & MASU_FEATURE_RAY_QUERY) != 0;
    host->float16 = (can.used & MASU_FEATURE_SHADER_FLOAT16) != 0;
    host->most_anisotropy = can.max_anisotropy;
    host->stores = host->desc.stores && offered.vertexPipelineStoresAndAtomics &&
                   offered.fragmentStoresAndAtomics;
    VkPhysicalDeviceFeatures features = {.samplerAnisotropy = host->most_anisotropy > 0.0f,
                                         .textureCompressionBC = host->compressed,
                                         .vertexPipelineStoresAndAtomics = host->stores,
                                         .fragmentStoresAndAtomics = host->stores};
    if (host->properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU)
        host->usual_anisotropy = host->most_anisotropy < 8.0f ? host->most_anisotropy : 8.0f;
    VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                               .queueCreateInfoCount = 1,
                               .pQueueCreateInfos = &queue,
                               .pEnabledFeatures = &features};
    VkPhysicalDeviceBufferDeviceAddressFeatures address = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES,
        .bufferDeviceAddress = VK_TRUE};
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structure = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
        .pNext = &address,
        .accelerationStructure = VK_TRUE};
    VkPhysicalDeviceRayQueryFeaturesKHR rays = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR,
        .pNext = &structure,
        .rayQuery = VK_TRUE};
    VkPhysicalDeviceShaderFloat16Int8Features halves = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES,
        .shaderFloat16 = VK_TRUE};
    if (host->ray_query) info.pNext = &rays;
    if (host->float16) halves.pNext = (void *)info.pNext, info.pNext = &halves;
    const char *names[MASU_MAX_EXTENSIONS + 1];
    info.enabledExtensionCount = can.extension_count;
    memcpy(names, can.extensions, sizeof can.extensions);
    if (host->desc.surface_extension_count)
        names[info.enabledExtensionCount++] = swapchain_extension[0];
    info.ppEnabledExtensionNames = names;
    VkResult r = vkCreateDevice(host->physical, &info, host->desc.allocator, &host->device);
    if (r) return masu_headless_fail(error, size, "vkCreateDevice", r);
    vkGetDeviceQueue(host->device, host->family, 0, &host->queue);
    VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                    .queueFamilyIndex = host->family};
    r = vkCreateCommandPool(host->device, &pool, host->desc.allocator, &host->pool);
    if (r) return masu_headless_fail(error, size, "vkCreateCommandPool", r);
    for (uint32_t i = 0; i < MASU_HEADLESS_SLOTS; i++) {
        VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        r = vkCreateFence(host->device, &fence, host->desc.allocator, &host->fences[i]);
        if (r) return masu_headless_fail(error, size, "vkCreateFence", r);
    }
    return true;
}

static void describe_driver(masu_headless *host) {
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 p = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                     .pNext = &driver};
    if (host->properties.apiVersion < VK_API_VERSION_1_2)
        p.pNext = NULL; /* the struct is core from 1.2 on */
    else
        vkGetPhysicalDeviceProperties2(host->physical, &p);
    snprintf(host->driver, sizeof host->driver, "%s, %s, %s, Vulkan %u.%u.%u",
             host->properties.deviceName, p.pNext ? driver.driverName : "unnamed driver",
             p.pNext ? driver.driverInfo : "unknown version",
             VK_VERSION_MAJOR(host->properties.apiVersion),
             VK_VERSION_MINOR(host->properties.apiVersion),
             VK_VERSION_PATCH(host->properties.apiVersion));
}

bool masu_headless_open(const masu_headless_desc *desc, masu_headless *host, char *error,
                        size_t error_size) {
    memset(host, 0, sizeof *host);
    host->desc = *desc;
    host->wait_ns = MASU_HEADLESS_TIMEOUT_NS;
    if (!host->desc.get_instance_proc_addr)
        host->desc.get_instance_proc_addr = vkGetInstanceProcAddr;
    if (!create_instance(host, error, error_size) || !choose_device(host, error, error_size) ||
        !create_device(host, error, error_size)) {
        masu_headless_close(host);
        return false;
    }
    vkGetPhysicalDeviceMemoryProperties(host->physical, &host->memory);
    describe_driver(host);
    return true;
}

void masu_headless_close(masu_headless *host) {
    if (host->device) {
        masu_headless_settle(host);
        for (uint32_t i = 0; i < MASU_HEADLESS_SLOTS; i++) {
            vkDestroyFence(host->device, host->fences[i], host->desc.allocator);
        }
        vkDestroyCommandPool(host->device, host->pool, host->desc.allocator);
        vkDestroyDevice(host->device, host->desc.allocator);
    }
    if (host->instance) {
        if (host->desc.surface_close)
            host->desc.surface_close(host->desc.surface_user, host->instance);
        PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
                host->instance, "vkDestroyDebugUtilsMessengerEXT");
        if (host->messenger && destroy)
            destroy(host->instance, host->messenger, host->desc.allocator);
        vkDestroyInstance(host->instance, host->desc.allocator);
    }
    host->device = VK_NULL_HANDLE;
    host->instance = VK_NULL_HANDLE;
}

/* ---- Submits --------------------------------------------------------------------------------- */

void masu_headless_settle(masu_headless *host) {
    char ignored[128];
    for (uint32_t i = 0; i < MASU_HEADLESS_SLOTS && host->device && !host->lost; i++) {
        (void)masu_headless_wait(host, i, ignored, sizeof ignored);
    }
}

#define WAITS 120u /* per timeout: a stopped process loses at most one of them */

VkResult masu_headless_wait_fence(const masu_headless *host, VkFence fence) {
    bool cpu = host->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    VkResult r = VK_TIMEOUT;
    for (uint32_t i = 0; r == VK_TIMEOUT && (i < WAITS || cpu); i += i < WAITS)
        r = vkWaitForFences(host->device, 1, &fence, VK_TRUE, host->wait_ns / WAITS);
    return r;
}

bool masu_headless_wait(masu_headless *host, uint32_t slot, char *error, size_t error_size) {
    if (!host->pending[slot] || !host->device) return true;
    VkResult r = masu_headless_wait_fence(host, host->fences[slot]);
    if (r) host->lost = true;
    if (r == VK_TIMEOUT) {
        snprintf(error, error_size, "the GPU did not finish within %u s",
                 (unsigned)(host->wait_ns / 1000000000u));
        host->device = VK_NULL_HANDLE;
        host->instance = VK_NULL_HANDLE;
        return false;
    }
    if (r) return masu_headless_fail(error, error_size, "vkWaitForFences", r);
    host->pending[slot] = false;
    r = vkResetFences(host->device, 1, &host->fences[slot]);
    return r ? masu_headless_fail(error, error_size, "vkResetFences", r) : true;
}

bool masu_headless_submit(masu_headless *host, VkCommandBuffer commands, uint32_t slot, char *error,
                          size_t error_size) {
    VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                           .commandBufferCount = 1,
                           .pCommandBuffers = &commands};
    if (!host->device) {
        snprintf(error, error_size, "the GPU did not finish earlier work");
        return false;
    }
    VkResult r = vkQueueSubmit(host->queue, 1, &submit, host->fences[slot]);
    if (r) return masu_headless_fail(error, error_size, "vkQueueSubmit", r);
    host->pending[slot] = true;
    return true;
}

bool masu_headless_run(masu_headless *host, VkCommandBuffer commands, char *error,
                       size_t error_size) {
    return masu_headless_wait(host, 0, error, error_size) &&
           masu_headless_submit(host, commands, 0, error, error_size) &&
           masu_headless_wait(host, 0, error, error_size);
}
