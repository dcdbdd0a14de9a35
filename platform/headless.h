/* headless.h: a Vulkan host without a window: instance, device, one queue, target and source
 * images, submits that wait.
 *
 * A host with a window (tools/view) uses it too: it adds its extensions, and a test whether a
 * device can present.
 *
 * It is a small form of a port's host. If the device supports them, it enables the
 * optional features for textures and 16-bit floats. The only extensions are the validation layer's,
 * VK_EXT_debug_utils for labels, and those for ray queries if requested. Every wait has a timeout,
 * except on CPU drivers, which are slow, stop with the process, and never hang. Functions that can
 * fail return false and write one line without a newline to `error`. */
#ifndef MASU_HEADLESS_H
#define MASU_HEADLESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

#define MASU_HEADLESS_SLOTS 3u
/* Longest wait for one submit, except on CPU drivers. */
#define MASU_HEADLESS_TIMEOUT_NS ((uint64_t)120 * 1000000000u)

typedef struct masu_headless_desc {
    const char *device; /* index, or part of the name in any case; NULL: $MASU_DEVICE, else the
                         * first suitable one */
    bool validate;      /* Khronos validation with synchronisation validation */
    bool gpu_av;        /* Khronos validation with GPU-assisted shader checks instead */
    bool best;          /* with either: also the layer's best practices */
    bool labels;        /* VK_EXT_debug_utils for names and labels; validation enables it too */
    bool ray_query;     /* ray queries, if supported */
    bool stores;        /* stores and atomics of vertex and fragment shaders, if supported */
    bool deny;          /* no optional features, even if supported and requested */
    bool vulkan_1_0; /* use the device as one of Vulkan 1.0: an instance of 1.0, no later calls */
    void (*message)(void *user,
                    const char *text); /* each validation warning or error; NULL: only counted */
    void *message_user;
    const VkAllocationCallbacks
        *allocator; /* for all objects of the host; NULL: the driver's */
    PFN_vkGetInstanceProcAddr
        get_instance_proc_addr; /* for the renderer; NULL: the loader's */
    /* For a host with a window: instance extensions for its surfaces, at most 8; a missing one is
     * an error. VK_KHR_swapchain is then enabled, and the device must support it. */
    const char *const *surface_extensions;
    uint32_t surface_extension_count;
    /* Whether the queue family can present; NULL: not checked. The first call may create the
     * surface; surface_close destroys it, after the device and before the instance. */
    bool (*presents)(void *user, VkInstance instance, VkPhysicalDevice device, uint32_t family);
    void (*surface_close)(void *user, VkInstance instance);
    void *surface_user;
} masu_headless_desc;

typedef struct masu_headless {
    masu_headless_desc desc;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
    VkCommandPool pool;
    VkFence fences[MASU_HEADLESS_SLOTS];
    bool pending[MASU_HEADLESS_SLOTS];
    uint32_t messages;       /* validation warnings and errors so far */
    bool validating;         /* the layer is loaded */
    bool labels;             /* VK_EXT_debug_utils is enabled */
    bool ray_query;          /* VK_KHR_ray_query and its dependencies are enabled */
    bool stores;             /* vertexPipelineStoresAndAtomics and fragmentStoresAndAtomics are
                              * enabled */
    bool compressed;         /* textureCompressionBC is enabled */
    bool float16;            /* shaderFloat16 is enabled, and VK_KHR_shader_float16_int8 */
    float most_anisotropy;   /* limit of samplerAnisotropy if enabled; else 0 */
    float usual_anisotropy;  /* 8, or that limit; 0 on a CPU driver, where filtering costs 20 times
                              * as much */
    bool lost;               /* a wait has timed out or the device is lost: no more waits */
    uint64_t wait_ns;        /* MASU_HEADLESS_TIMEOUT_NS; tests replace it */
    char first_message[512]; /* of the validation layer */
    char driver[1024]; /* "llvmpipe (...), lavapipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230" */
} masu_headless;

/* Opens a host by the description. On false everything is closed again. */
bool masu_headless_open(const masu_headless_desc *desc, masu_headless *host, char *error,
                        size_t error_size);
/* Waits for pending submits, with the timeout, and destroys everything; harmless on a zeroed
 * struct. */
void masu_headless_settle(masu_headless *host); /* only waits */
void masu_headless_close(masu_headless *host);

/* Submits; the slot's fence signals completion. The slot must not be pending. */
bool masu_headless_submit(masu_headless *host, VkCommandBuffer commands, uint32_t slot, char *error,
                          size_t error_size);
/* Waits for a fence; VK_TIMEOUT after the timeout. Time during which the process is stopped is
 * excluded. */
VkResult masu_headless_wait_fence(const masu_headless *host, VkFence fence);
/* Waits until the slot is free; returns immediately if nothing is pending. After a timeout `device`
 * and `instance` are null: objects that the device may still use are not destroyed, so the process
 * can only end. */
bool masu_headless_wait(masu_headless *host, uint32_t slot, char *error, size_t error_size);
/* Submits on slot 0 and waits. */
bool masu_headless_run(masu_headless *host, VkCommandBuffer commands, char *error,
                       size_t error_size);

/* Writes one line about a failed Vulkan call. Returns false, for `return`. */
bool masu_headless_fail(char *error, size_t error_size, const char *call, VkResult r);

/* A host-visible buffer, in cached memory if there is such a type: reads from write-combined memory
 * are slow. */
typedef struct masu_headless_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} masu_headless_buffer;

/* Destroy it by the function below even after a failure; a zeroed struct is allowed. */
bool masu_headless_buffer_create(masu_headless *host, uint64_t bytes, VkBufferUsageFlags usage,
                                 masu_headless_buffer *buffer, char *error, size_t error_size);
void masu_headless_buffer_destroy(masu_headless *host, masu_headless_buffer *buffer);

/* A target image of the renderer, with a buffer for readback. */
typedef struct masu_headless_target {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
    masu_headless_buffer buffer;
    const uint8_t *mapped; /* contents of the buffer */
    VkCommandBuffer copy;
    uint32_t width, height;
} masu_headless_target;

/* format: one of the formats of masu_targets. Usage: TRANSFER_SRC and _DST; storage: also STORAGE,
 * SAMPLED, and COLOR_ATTACHMENT for the host's drawing over a frame. */
bool masu_headless_target_create(masu_headless *host, uint32_t width, uint32_t height,
                                 VkFormat format, bool storage, masu_headless_target *target,
                                 char *error, size_t error_size);
/* Copies a finished frame from the image, which is in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL. The
 * pixels are at target->mapped, rows tightly packed, until the next call. */
bool masu_headless_target_read(masu_headless *host, masu_headless_target *target, char *error,
                               size_t error_size);
void masu_headless_target_destroy(masu_headless *host, masu_headless_target *target);

/* An RGBA8 image to sample from, in VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL. It may be larger than
 * the given pixels; the rest is filled with `beyond`. */
typedef struct masu_headless_source {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
} masu_headless_source;

bool masu_headless_source_create(masu_headless *host, const uint8_t *rgba, uint32_t width,
                                 uint32_t height, uint32_t image_width, uint32_t image_height,
                                 uint32_t beyond, masu_headless_source *source, char *error,
                                 size_t error_size);
/* The same for another format of 4 or 8 bytes. */
bool masu_headless_source_of(masu_headless *host, VkFormat format, const void *texels,
                             uint32_t width, uint32_t height, uint32_t image_width,
                             uint32_t image_height, uint32_t beyond, masu_headless_source *source,
                             char *error, size_t error_size);
void masu_headless_source_destroy(masu_headless *host, masu_headless_source *source);

#endif
