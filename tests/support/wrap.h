/* wrap.h: a vkGetInstanceProcAddr that stands between the renderer and the driver: counts
 * calls, checks that what is created is destroyed, fails the n-th call, and pretends that the
 * device lacks things.
 *
 * State is this process's: reset it before use. */
#ifndef MASU_TEST_SUPPORT_WRAP_H
#define MASU_TEST_SUPPORT_WRAP_H

#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

typedef struct wrap_state {
    /* Counts. `setup` is every vkCreate*, vkAllocate*, vkBegin/EndCommandBuffer, vkBind*,
     * vkMapMemory, vkResetCommandBuffer. */
    uint64_t setup_calls, creates, destroys;
    int64_t live; /* created objects and allocations that are not destroyed yet */
    uint64_t
        calls_after_loss; /* calls other than destroys and frees after a device loss was injected */
    bool lost;
    /* Injection: setup call number fail_at (from 1; 0: never) returns fail_with; with `persistent`
     * all later ones too. */
    uint64_t fail_at;
    VkResult fail_with;
    bool persistent;
    const char *failed_call; /* name of the first call that was made to fail */
    /* Pretences. */
    uint32_t api_version;    /* 0: the truth */
    VkFormat lacking_format; /* its features read as 0; 0: the truth */
    bool no_compute;         /* queue families without compute */
    bool no_timestamps;
    uint32_t max_image;           /* maxImageDimension2D; 0: the truth */
    uint32_t max_storage_buffers; /* maxPerStageDescriptorStorageBuffers; 0: the truth */
    uint32_t max_groups;          /* maxComputeWorkGroupCount along x; 0: the truth */
    uint32_t max_framebuffer;     /* maxFramebufferHeight; 0: the truth */
    const char *unknown_function; /* not found */
    bool no_features;   /* vkGetPhysicalDeviceFeatures2 has none of those that Masu can use */
    bool no_extensions; /* the device has no extensions, whatever its features */
    /* 1: a discrete GPU: device-local memory that the host cannot see, and memory that it can.
     * 2: an APU: as 1, and a third type that is both. Behind all stands the driver's type 0. */
    int fake_memory;
    uint32_t allocate_calls;
    uint32_t most_storage_buffers; /* in a stage of a set layout that was created */
    /* What the last recording began and ended with, and what is in between. */
    VkPipelineStageFlags first_barrier_from, first_barrier_to;
    bool host_barrier, counter_barrier;
    VkImageLayout last_layout;
    uint32_t labels, fills_of_poison;
    /* Called when a pass begins to be recorded, in front of its barriers; with debug.labels. */
    void (*on_label)(VkCommandBuffer cmd, const char *name);
    /* Called for each image of a barrier that is recorded. */
    void (*on_barrier)(VkCommandBuffer cmd, VkPipelineStageFlags from, VkPipelineStageFlags to,
                       const VkImageMemoryBarrier *image);
} wrap_state;

extern wrap_state wrap;

void wrap_reset(void);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL wrap_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name);

#endif
