/* devices.h: limits and optional features of real devices (devices.inc), to impose on another one.
 *
 * A renderer of a host whose get_instance_proc_addr is masu_device_row_proc_addr sees the device
 * with the limits of the row that masu_device_row_impose chose, which is process-wide. Limits that
 * the real device does not reach remain those of the real device. */
#ifndef MASU_PLATFORM_DEVICES_H
#define MASU_PLATFORM_DEVICES_H

#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

/* Members of VkPhysicalDeviceLimits that are largest values, and smallest alignments. */
#define MASU_DEVICE_MOST(X)                                                                        \
    X(maxImageDimension2D)                                                                         \
    X(maxImageArrayLayers)                                                                         \
    X(maxUniformBufferRange)                                                                       \
    X(maxStorageBufferRange)                                                                       \
    X(maxPushConstantsSize)                                                                        \
    X(maxBoundDescriptorSets)                                                                      \
    X(maxPerStageDescriptorSamplers)                                                               \
    X(maxPerStageDescriptorUniformBuffers)                                                         \
    X(maxPerStageDescriptorStorageBuffers)                                                         \
    X(maxPerStageDescriptorSampledImages)                                                          \
    X(maxPerStageDescriptorStorageImages)                                                          \
    X(maxPerStageResources)                                                                        \
    X(maxDescriptorSetStorageBuffers)                                                              \
    X(maxDescriptorSetStorageImages)                                                               \
    X(maxDescriptorSetSampledImages)                                                               \
    X(maxVertexInputAttributes)                                                                    \
    X(maxVertexOutputComponents)                                                                   \
    X(maxFragmentOutputAttachments)                                                                \
    X(maxFragmentCombinedOutputResources)                                                          \
    X(maxComputeSharedMemorySize)                                                                  \
    X(maxComputeWorkGroupCount[0])                                                                 \
    X(maxComputeWorkGroupInvocations)                                                              \
    X(maxComputeWorkGroupSize[0])                                                                  \
    X(maxFramebufferWidth)                                                                         \
    X(maxColorAttachments)
#define MASU_DEVICE_LEAST(X) X(minUniformBufferOffsetAlignment) X(minStorageBufferOffsetAlignment)
#define MASU_DEVICE_LIMITS(X) MASU_DEVICE_MOST(X) MASU_DEVICE_LEAST(X)
enum {
#define MASU_DEVICE_COUNT_LIMIT(...) +1
    MASU_DEVICE_LIMIT_COUNT = 0 MASU_DEVICE_LIMITS(MASU_DEVICE_COUNT_LIMIT)
#undef MASU_DEVICE_COUNT_LIMIT
};


typedef struct masu_device_row {
    const char *name, *title, *source;
    uint32_t minor;
    uint32_t limits[MASU_DEVICE_LIMIT_COUNT]; /* in the order of MASU_DEVICE_LIMITS */
    bool compressed, anisotropic, vertex_stores, fragment_stores, timestamps;
} masu_device_row;

/* The rows; NULL from the end on. */
const masu_device_row *masu_device_row_at(uint32_t i);

/* NULL: there is none of that name. */
const masu_device_row *masu_device_row_of(const char *name);

/* Imposes the row on what masu_device_row_proc_addr returns from now on; NULL: none. */
void masu_device_row_impose(const masu_device_row *row);

/* The limits and features of a device, reduced to those of the row. */
void masu_device_row_limit(const masu_device_row *row, VkPhysicalDeviceProperties *properties);
void masu_device_row_deny(const masu_device_row *row, VkPhysicalDeviceFeatures *features);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_device_row_proc_addr(VkInstance instance,
                                                                   const char *name);

#endif
