/* null_device.h: a device that can only compile shaders, for masu_init.
 *
 * RADV's null device and Mesa's no-op shims compile pipelines, but have no working memory, images
 * or queues. This vkGetInstanceProcAddr passes layouts, render passes, shader modules, samplers and
 * pipelines to the driver, and replaces everything else: buffers and images have sizes, memory is
 * host memory, commands are ignored; nothing is ever executed.
 *
 * Vulkan functions have no user pointer, so the state is global: one device at a time. */
#ifndef MASU_ISA_NULL_DEVICE_H
#define MASU_ISA_NULL_DEVICE_H

#include "lab/isa/isa.h"

#include <vulkan/vulkan.h>

typedef struct masu_null_device {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkPhysicalDeviceProperties properties;
    uint32_t family;
    bool compressed, float16;
    float most_anisotropy;
} masu_null_device;

/* Opens the first device, with pipeline statistics. The statistics of each pipeline are added to
 * `rows` under the renderer's name, so it must be opened before the renderer is created. `before`
 * (or NULL): as in isa.h. */
bool masu_null_device_open(masu_null_device *device, void (*before)(const char *pass),
                           masu_isa_rows *rows, char *error, size_t error_size);
void masu_null_device_close(masu_null_device *device);

/* The vkGetInstanceProcAddr for the renderer. */
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_null_get_instance_proc_addr(VkInstance instance,
                                                                          const char *name);

#endif
