/* offers.c: see offers.h. */
#include "device/offers.h"

#include "base/error.h"

#include <stdio.h>

typedef struct offers {
    int blocks, anisotropy, ray_query, half_floats;
} offers;

/* Drivers leave structures that they do not support unchanged (specification, "Valid Usage for
 * Structure Pointer Chains"), so they remain 0. */
static int ask(const masu_device *m, offers *out) {
    const masu_vulkan *v = &m->plan->desc.vulkan;
    PFN_vkGetPhysicalDeviceFeatures2 get =
        (PFN_vkGetPhysicalDeviceFeatures2)v->get_instance_proc_addr(v->instance,
                                                                   "vkGetPhysicalDeviceFeatures2");
    if (!get) return 0;
    VkPhysicalDeviceShaderFloat16Int8Features half = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES};
    VkPhysicalDeviceRayQueryFeaturesKHR rays = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR, .pNext = &half};
    VkPhysicalDeviceFeatures2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                     .pNext = &rays};
    get(v->physical_device, &all);
    *out = (offers){.blocks = all.features.textureCompressionBC == VK_TRUE,
                    .anisotropy = all.features.samplerAnisotropy == VK_TRUE,
                    .ray_query = rays.rayQuery == VK_TRUE,
                    .half_floats = half.shaderFloat16 == VK_TRUE};
    return 1;
}

static void say(const masu_device *m, masu_log_level level, const char *field, const char *feature,
                const char *gain) {
    char text[256];
    snprintf(text, sizeof text, "vulkan.%s is 0, but the device offers %s: %s", field, feature,
             gain);
    masu_log(&m->plan->desc, level, text);
}

void masu_report_offers(const masu_device *m) {
    const masu_desc *d = &m->plan->desc;
    const masu_scene_data *s = &m->plan->scene;
    offers o;
    if (!d->log || !ask(m, &o)) return;
    if (o.blocks && !d->vulkan.texture_compression_bc && s->textures &&
        !d->deny.compressed_textures) {
        char gain[128];
        snprintf(gain, sizeof gain, "textures take %llu bytes, compressed %llu",
                 (unsigned long long)s->texture_bytes_decoded,
                 (unsigned long long)s->texture_bytes);
        say(m, MASU_LOG_WARNING, "texture_compression_bc", "textureCompressionBC", gain);
    }
    if (o.anisotropy && !(d->vulkan.max_anisotropy > 0.0f) && s->textures)
        say(m, MASU_LOG_INFO, "max_anisotropy", "samplerAnisotropy",
            "slanted textures would be sharper");
    VkPhysicalDeviceType type = m->vk.properties.deviceType;
    int gpu = type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
              type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    if (!gpu) return; /* software devices: the features bring nothing */
    int fast = 0;
    for (uint32_t r = 0; r < d->rung_count; r++) fast |= d->rungs[r].easu == MASU_EASU_FAST;
    if (o.ray_query && !d->vulkan.ray_query && m->plan->needs.traced)
        say(m, MASU_LOG_INFO, "ray_query", "VK_KHR_ray_query",
            "reflections are traced by the library's own tree");
    if (o.half_floats && !d->vulkan.shader_float16 && fast)
        say(m, MASU_LOG_INFO, "shader_float16", "shaderFloat16",
            "fast EASU weighs texels in 32 bits");
}
