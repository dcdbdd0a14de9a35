/* null_device.h: a device that has a compiler and nothing else, for masu_init.
 *
 * RADV's null device and Mesa's no-op shims compile pipelines, but have no memory, images or queues that
 * work. What is behind this vkGetInstanceProcAddr lets layouts, render passes, shader modules, samplers and
 * pipelines through to the driver, and stands in for the rest: buffers and images have sizes, memory is the
 * host's, commands are forgotten; nothing is ever executed.
 *
 * Vulkan's functions carry no pointer of the host's, so the state is this process's: one device at a time. */
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

/* The first device there is, with statistics of pipelines; each pipeline's go to `rows`, named as the renderer
 * names it, so it must be opened before the renderer is made. `before` (or NULL): as in isa.h. */
bool masu_null_device_open(masu_null_device *device, void (*before)(const char *pass), masu_isa_rows *rows,
                           char *error, size_t error_size);
void masu_null_device_close(masu_null_device *device);

/* What the renderer is to use. */
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_null_get_instance_proc_addr(VkInstance instance,
                                                                          const char *name);

#endif
