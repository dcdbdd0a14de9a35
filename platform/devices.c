/* devices.c: see devices.h. */
#include "devices.h"

#include <string.h>

#define DEVICE(name, title, source, minor, ...) {#name, title, source, minor, FIELDS(__VA_ARGS__)},
#define FIELDS(a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17,     \
               a18, a19, a20, a21, a22, a23, a24, a25, a26, ...)                                   \
    {a0,  a1,  a2,  a3,  a4,  a5,  a6,  a7,  a8,  a9,  a10, a11, a12, a13,                         \
     a14, a15, a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26},                             \
        __VA_ARGS__
static const masu_device_row rows[] = {
#include "devices.inc"
};
#undef DEVICE

const masu_device_row *masu_device_row_at(uint32_t i) {
    return i < sizeof rows / sizeof *rows ? &rows[i] : NULL;
}

const masu_device_row *masu_device_row_of(const char *name) {
    for (uint32_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!strcmp(rows[i].name, name)) return &rows[i];
    }
    return NULL;
}

void masu_device_row_limit(const masu_device_row *row, VkPhysicalDeviceProperties *properties) {
    VkPhysicalDeviceLimits *l = &properties->limits;
    uint32_t i = 0, api = VK_MAKE_VERSION(1, row->minor, 0);
    if (properties->apiVersion > api) properties->apiVersion = api;
#define MOST(member)                                                                               \
    if (l->member > row->limits[i]) l->member = row->limits[i];                                    \
    i++;
#define LEAST(member)                                                                              \
    if (l->member < row->limits[i]) l->member = row->limits[i];                                    \
    i++;
    MASU_DEVICE_MOST(MOST)
    MASU_DEVICE_LEAST(LEAST)
#undef MOST
#undef LEAST
    if (l->maxFramebufferHeight > l->maxFramebufferWidth)
        l->maxFramebufferHeight = l->maxFramebufferWidth;
    for (uint32_t axis = 1; axis < 3; axis++) {
        if (l->maxComputeWorkGroupCount[axis] > l->maxComputeWorkGroupCount[0])
            l->maxComputeWorkGroupCount[axis] = l->maxComputeWorkGroupCount[0];
    }
}

void masu_device_row_deny(const masu_device_row *row, VkPhysicalDeviceFeatures *features) {
    features->textureCompressionBC &= row->compressed;
    features->samplerAnisotropy &= row->anisotropic;
    features->vertexPipelineStoresAndAtomics &= row->vertex_stores;
    features->fragmentStoresAndAtomics &= row->fragment_stores;
}

/* ---- Replaced functions ---------------------------------------------------------------------- */

static const masu_device_row *_Atomic imposed_row; /* sessions in several threads set it */

void masu_device_row_impose(const masu_device_row *row) { imposed_row = row; }

static VKAPI_ATTR void VKAPI_CALL get_properties(VkPhysicalDevice device,
                                                 VkPhysicalDeviceProperties *out) {
    vkGetPhysicalDeviceProperties(device, out);
    const masu_device_row *imposed = imposed_row;
    if (imposed) masu_device_row_limit(imposed, out);
}

static VKAPI_ATTR void VKAPI_CALL get_features(VkPhysicalDevice device,
                                               VkPhysicalDeviceFeatures2 *out) {
    vkGetPhysicalDeviceFeatures2(device, out);
    const masu_device_row *imposed = imposed_row;
    if (imposed) masu_device_row_deny(imposed, &out->features);
}

/* The same of a Vulkan 1.0 device. */
static VKAPI_ATTR void VKAPI_CALL get_core_features(VkPhysicalDevice device,
                                                    VkPhysicalDeviceFeatures *out) {
    vkGetPhysicalDeviceFeatures(device, out);
    const masu_device_row *imposed = imposed_row;
    if (imposed) masu_device_row_deny(imposed, out);
}

static VKAPI_ATTR void VKAPI_CALL get_families(VkPhysicalDevice device, uint32_t *n,
                                               VkQueueFamilyProperties *out) {
    vkGetPhysicalDeviceQueueFamilyProperties(device, n, out);
    const masu_device_row *imposed = imposed_row;
    for (uint32_t i = 0; imposed && !imposed->timestamps && out && i < *n; i++)
        out[i].timestampValidBits = 0;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_device_row_proc_addr(VkInstance instance,
                                                                   const char *name) {
    if (!strcmp(name, "vkGetPhysicalDeviceProperties")) return (PFN_vkVoidFunction)get_properties;
    if (!strcmp(name, "vkGetPhysicalDeviceFeatures2")) return (PFN_vkVoidFunction)get_features;
    if (!strcmp(name, "vkGetPhysicalDeviceFeatures")) return (PFN_vkVoidFunction)get_core_features;
    if (!strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties"))
        return (PFN_vkVoidFunction)get_families;
    return vkGetInstanceProcAddr(instance, name);
}
