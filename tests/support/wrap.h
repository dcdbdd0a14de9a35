/* wrap.h: a vkGetInstanceProcAddr between renderer and driver. It counts calls, checks that created
 * objects are destroyed, makes the n-th call fail, and simulates missing device features.
 *
 * The state is global to the process: reset it before use. */
#ifndef MASU_TEST_SUPPORT_WRAP_H
#define MASU_TEST_SUPPORT_WRAP_H

#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

#include "devices.h"

/* Largest numbers in one stage of a pipeline layout that was created, or of a render pass. */
typedef struct wrap_most {
    uint32_t uniform_buffers, storage_buffers, sampled_images, storage_images;
    uint32_t all, sets, push_bytes, attachments;
} wrap_most;

typedef struct wrap_state {
    /* Counts. `setup` is every vkCreate*, vkAllocate*, vkBegin/EndCommandBuffer, vkBind*,
     * vkMapMemory, vkResetCommandBuffer. */
    uint64_t setup_calls, creates, destroys;
    int64_t live; /* created objects and allocations that are not yet destroyed */
    uint64_t
        calls_after_loss; /* calls after an injected device loss, without destroys and frees */
    bool lost;
    /* Injection: set-up call number fail_at (from 1; 0: never) returns fail_with; with
     * `persistent`, all later ones too. */
    uint64_t fail_at;
    VkResult fail_with;
    bool persistent;
    const char *failed_call; /* name of the first call that failed by injection */
    /* Simulated limitations. */
    uint32_t api_version;    /* 0: the real one */
    VkFormat lacking_format; /* its features read as 0; 0: none */
    bool no_compute;         /* queue families without compute */
    bool no_timestamps;
    uint32_t max_image;           /* maxImageDimension2D; 0: the real one */
    uint32_t max_storage_buffers; /* maxPerStageDescriptorStorageBuffers; 0: the real one */
    uint32_t max_groups;          /* maxComputeWorkGroupCount along x; 0: the real one */
    uint32_t max_framebuffer;     /* maxFramebufferHeight; 0: the real one */
    const masu_device_row *row;   /* its limits and features; NULL: those of the device */
    const char *unknown_function; /* not found */
    bool no_features;   /* vkGetPhysicalDeviceFeatures2 has none of the features that Masu can
                           use */
    bool no_extensions; /* the device has no extensions, despite its features */
    /* 1: a discrete GPU: device-local memory that the host cannot access, and memory that it can.
     * 2: an APU: as 1, with a third type that is both. The driver's type 0 is the backing of
     * all. */
    int fake_memory;
    uint32_t allocate_calls;
    wrap_most most;
    /* The barriers that the last recording began and ended with, and those in between. */
    VkPipelineStageFlags first_barrier_from, first_barrier_to;
    bool host_barrier, counter_barrier;
    VkImageLayout last_layout;
    uint32_t labels, fills_of_poison, poison; /* the last fill's */
    /* Called when recording of a pass begins, before its barriers; with debug.labels. */
    void (*on_label)(VkCommandBuffer cmd, const char *name);
    /* Called for each image of a recorded barrier. */
    void (*on_barrier)(VkCommandBuffer cmd, VkPipelineStageFlags from, VkPipelineStageFlags to,
                       const VkImageMemoryBarrier *image);
} wrap_state;

extern wrap_state wrap;

void wrap_reset(void);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL wrap_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name);

#endif
