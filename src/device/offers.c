/* offers.c: see offers.h. */
#include "device/offers.h"

#include "base/error.h"

#include <stdio.h>
#include <string.h>

/* Extensions of Vulkan 1.1. Later versions contain some of them, but devices list them still. */
static const uint32_t features_of[] = {
    MASU_FEATURE_RAY_QUERY, MASU_FEATURE_RAY_QUERY, MASU_FEATURE_RAY_QUERY, MASU_FEATURE_RAY_QUERY,
    MASU_FEATURE_RAY_QUERY, MASU_FEATURE_RAY_QUERY, MASU_FEATURE_RAY_QUERY,
    MASU_FEATURE_SHADER_FLOAT16,
};
static const char *const extensions[] = {
    VK_KHR_RAY_QUERY_EXTENSION_NAME,
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
    VK_KHR_BUFFER_DEVICE_ADDRESS_EXTENSION_NAME,
    VK_EXT_DESCRIPTOR_INDEXING_EXTENSION_NAME,
    VK_KHR_SPIRV_1_4_EXTENSION_NAME,
    VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME,
    VK_KHR_SHADER_FLOAT16_INT8_EXTENSION_NAME,
};
#define EXTENSIONS (sizeof extensions / sizeof *extensions)
_Static_assert(EXTENSIONS + MASU_VK_1_0_EXTENSIONS == MASU_MAX_EXTENSIONS, "MASU_MAX_EXTENSIONS");
_Static_assert(EXTENSIONS == sizeof features_of / sizeof *features_of, "features_of");

static int is_1_0(const masu_vk *vk) { return vk->properties.apiVersion < VK_API_VERSION_1_1; }

static uint32_t core_features(const VkPhysicalDeviceFeatures *f) {
    return (f->textureCompressionBC ? MASU_FEATURE_TEXTURE_COMPRESSION_BC : 0u) |
           (f->samplerAnisotropy ? MASU_FEATURE_SAMPLER_ANISOTROPY : 0u);
}

/* Drivers leave structures that they do not support unchanged (specification, "Valid Usage for
 * Structure Pointer Chains"), so they remain 0. */
uint32_t masu_query_offers(const masu_vk *vk, PFN_vkGetInstanceProcAddr get_proc) {
    if (is_1_0(vk)) {
        PFN_vkGetPhysicalDeviceFeatures get_core = (PFN_vkGetPhysicalDeviceFeatures)get_proc(
            vk->instance, "vkGetPhysicalDeviceFeatures");
        VkPhysicalDeviceFeatures core = {0};
        if (get_core) get_core(vk->physical, &core);
        return core_features(&core);
    }
    PFN_vkGetPhysicalDeviceFeatures2 get = (PFN_vkGetPhysicalDeviceFeatures2)get_proc(
        vk->instance, "vkGetPhysicalDeviceFeatures2");
    if (!get) return 0;
    VkPhysicalDeviceShaderFloat16Int8Features half = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES};
    VkPhysicalDeviceBufferDeviceAddressFeatures address = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES, .pNext = &half};
    VkPhysicalDeviceAccelerationStructureFeaturesKHR structure = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR,
        .pNext = &address};
    VkPhysicalDeviceRayQueryFeaturesKHR rays = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR, .pNext = &structure};
    VkPhysicalDeviceFeatures2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                     .pNext = &rays};
    get(vk->physical, &all);
    uint32_t has = core_features(&all.features);
    uint32_t found = masu_vk_find_extensions(vk, get_proc, extensions, EXTENSIONS);
    if (rays.rayQuery && structure.accelerationStructure && address.bufferDeviceAddress)
        has |= MASU_FEATURE_RAY_QUERY;
    if (half.shaderFloat16) has |= MASU_FEATURE_SHADER_FLOAT16;
    for (uint32_t e = 0; e < EXTENSIONS; e++)
        if (!(found >> e & 1u)) has &= ~features_of[e];
    return has;
}

void masu_list_extensions(const masu_vk *vk, masu_device_info *out) {
    out->extension_count = 0;
    for (uint32_t e = 0; e < MASU_VK_1_0_EXTENSIONS && is_1_0(vk); e++)
        out->extensions[out->extension_count++] = masu_vk_1_0_extensions[e];
    for (uint32_t e = 0; e < EXTENSIONS; e++) {
        if (out->used & features_of[e]) out->extensions[out->extension_count++] = extensions[e];
    }
}

static void log_offer(const masu_device *m, masu_log_level level, const char *field,
                      const char *feature, const char *gain) {
    char text[256];
    snprintf(text, sizeof text, "vulkan.%s is 0, but the device offers %s: %s", field, feature,
             gain);
    masu_log(&m->plan->desc, level, text);
}

void masu_report_offers(const masu_device *m) {
    const masu_desc *d = &m->plan->desc;
    const masu_scene_data *s = &m->plan->scene;
    if (!d->log) return;
    uint32_t has = masu_query_offers(&m->vk, d->vulkan.get_instance_proc_addr);
    if ((has & MASU_FEATURE_TEXTURE_COMPRESSION_BC) && !d->vulkan.texture_compression_bc &&
        s->textures && !d->deny.compressed_textures) {
        char gain[128];
        snprintf(gain, sizeof gain, "textures take %llu bytes, compressed %llu",
                 (unsigned long long)s->texture_bytes_decoded,
                 (unsigned long long)s->texture_bytes);
        log_offer(m, MASU_LOG_WARNING, "texture_compression_bc", "textureCompressionBC", gain);
    }
    if ((has & MASU_FEATURE_SAMPLER_ANISOTROPY) && !(d->vulkan.max_anisotropy > 0.0f) &&
        s->textures)
        log_offer(m, MASU_LOG_INFO, "max_anisotropy", "samplerAnisotropy",
                  "slanted textures would be sharper");
    VkPhysicalDeviceType type = m->vk.properties.deviceType;
    int gpu = type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
              type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    if (!gpu) return; /* software devices: the features bring nothing */
    int fast = 0;
    for (uint32_t r = 0; r < d->rung_count; r++) fast |= d->rungs[r].easu == MASU_EASU_FAST;
    if ((has & MASU_FEATURE_RAY_QUERY) && !d->vulkan.ray_query && m->plan->needs.traced)
        log_offer(m, MASU_LOG_INFO, "ray_query", "VK_KHR_ray_query",
                  "reflections are traced by the library's own tree");
    if ((has & MASU_FEATURE_SHADER_FLOAT16) && !d->vulkan.shader_float16 && fast)
        log_offer(m, MASU_LOG_INFO, "shader_float16", "shaderFloat16",
                  "fast EASU weighs texels in 32 bits");
}
