/* headless.h: a Vulkan host without a window: instance, device, one queue, target and source
 * images, submits that wait.
 *
 * A host with a window (tools/view) is one too: it says what it takes beside, and whether a device can
 * show its pictures.
 *
 * It is what a port's own host does, kept small: of optional features it enables those that serve
 * textures and 16-bit floats, where they are offered, and no other extension but the validation layer's own, for labels
 * VK_EXT_debug_utils, and what ray queries take where they are asked for. Every wait has a timeout,
 * except on CPU drivers: there work is slow, stops with the process, and never hangs.
 * Functions that can fail return false and write one line without a newline to `error`. */
#ifndef MASU_HEADLESS_H
#define MASU_HEADLESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

#define MASU_HEADLESS_SLOTS 3u
/* Longest wait for one submit, on devices that are no CPU. */
#define MASU_HEADLESS_TIMEOUT_NS ((uint64_t)120 * 1000000000u)

typedef struct masu_headless_desc {
    const char *device; /* index, or part of the name in any case; NULL: $MASU_DEVICE, else the
                           first that suits */
    bool validate;      /* Khronos validation with synchronisation validation */
    bool gpu_av;        /* Khronos validation with GPU-assisted shader checks instead */
    bool best;          /* with either: the layer's best practices too */
    bool labels;        /* VK_EXT_debug_utils for names and labels; validation turns it on too */
    bool ray_query;     /* ray queries, where they are offered */
    bool stores;        /* stores and atomics of vertex and fragment shaders, where they are offered */
    bool deny;          /* none of the optional features, whatever is offered or asked for */
    void (*message)(void *user,
                    const char *text); /* each validation warning or error; NULL: counted only */
    void *message_user;
    const VkAllocationCallbacks
        *allocator; /* for all objects of the host; NULL: the driver's own */
    PFN_vkGetInstanceProcAddr
        get_instance_proc_addr; /* what the renderer is to use; NULL: the loader's */
    /* Of a host with a window: extensions of the instance for its surfaces, at most 8; those that are not
     * there fail. Then VK_KHR_swapchain is enabled, and a device must have it. */
    const char *const *surface_extensions;
    uint32_t surface_extension_count;
    /* Whether the queue family can present; NULL: not asked. The first call may make the surface, which
     * surface_close destroys, after the device and before the instance. */
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
    bool validating;         /* the layer is really there */
    bool labels;             /* VK_EXT_debug_utils is enabled */
    bool ray_query;          /* so are VK_KHR_ray_query and what it takes */
    bool stores;             /* so are vertexPipelineStoresAndAtomics, fragmentStoresAndAtomics */
    bool compressed;         /* textureCompressionBC is enabled */
    bool float16;            /* shaderFloat16 is enabled, and VK_KHR_shader_float16_int8 */
    float most_anisotropy;   /* samplerAnisotropy is enabled: its limit; else 0 */
    float usual_anisotropy;  /* 8, or that limit; 0 on a CPU driver, where filtering takes 20 times as long */
    bool lost;               /* a wait has timed out or the device is gone: nothing is waited for */
    uint64_t wait_ns;        /* MASU_HEADLESS_TIMEOUT_NS, which tests replace */
    char first_message[512]; /* of the validation layer */
    char driver[1024]; /* "llvmpipe (...), lavapipe, Mesa 22.3.6 (LLVM 15.0.6), Vulkan 1.3.230" */
} masu_headless;

/* Opens what the description asks for. On false everything is closed again. */
bool masu_headless_open(const masu_headless_desc *desc, masu_headless *host, char *error,
                        size_t error_size);
/* Waits for what is pending, as long as any wait, and destroys everything; harmless on a zeroed
 * struct. */
void masu_headless_settle(masu_headless *host); /* only the waiting */
void masu_headless_close(masu_headless *host);

/* Submits; the slot's fence tells when it is done. The slot must not be pending. */
bool masu_headless_submit(masu_headless *host, VkCommandBuffer commands, uint32_t slot, char *error,
                          size_t error_size);
/* Waits for a fence, up to the timeout: VK_TIMEOUT. Time during which the process is stopped does
 * not count. */
VkResult masu_headless_wait_fence(const masu_headless *host, VkFence fence);
/* Waits until the slot is free; at once if nothing is pending. After a timeout `device` and
 * `instance` are null: nothing that the device may still use is destroyed, so the process can only
 * end. */
bool masu_headless_wait(masu_headless *host, uint32_t slot, char *error, size_t error_size);
/* Submit on slot 0 and wait. */
bool masu_headless_run(masu_headless *host, VkCommandBuffer commands, char *error,
                       size_t error_size);

/* Writes the one line about a Vulkan call that failed. Returns false, for `return`. */
bool masu_headless_fail(char *error, size_t error_size, const char *call, VkResult r);

/* A buffer that the host sees, in cached memory where there is such a type: reading write-combined
 * memory is slow. */
typedef struct masu_headless_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} masu_headless_buffer;

/* What has been made when it fails is destroyed by the call below, as is a zeroed struct. */
bool masu_headless_buffer_create(masu_headless *host, uint64_t bytes, VkBufferUsageFlags usage,
                                 masu_headless_buffer *buffer, char *error, size_t error_size);
void masu_headless_buffer_destroy(masu_headless *host, masu_headless_buffer *buffer);

/* An image the renderer draws into, and the way back to the host. */
typedef struct masu_headless_target {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
    masu_headless_buffer buffer;
    const uint8_t *mapped; /* what the buffer holds */
    VkCommandBuffer copy;
    uint32_t width, height;
} masu_headless_target;

/* format is one that masu_targets takes. Usage: TRANSFER_SRC and _DST; storage: also STORAGE, SAMPLED,
 * and COLOR_ATTACHMENT for what the host draws over a frame. */
bool masu_headless_target_create(masu_headless *host, uint32_t width, uint32_t height,
                                 VkFormat format, bool storage, masu_headless_target *target,
                                 char *error, size_t error_size);
/* Copies a finished frame out of the image, which is in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL. The
 * pixels lie at target->mapped, row after row without a gap, until the next call. */
bool masu_headless_target_read(masu_headless *host, masu_headless_target *target, char *error,
                               size_t error_size);
void masu_headless_target_destroy(masu_headless *host, masu_headless_target *target);

/* An RGBA8 image to sample from, in VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL. It may be larger than
 * the pixels given: what lies beyond them is filled with `beyond`. */
typedef struct masu_headless_source {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
} masu_headless_source;

bool masu_headless_source_create(masu_headless *host, const uint8_t *rgba, uint32_t width,
                                 uint32_t height, uint32_t image_width, uint32_t image_height,
                                 uint32_t beyond, masu_headless_source *source, char *error,
                                 size_t error_size);
/* The same of another format, of 4 or 8 bytes. */
bool masu_headless_source_of(masu_headless *host, VkFormat format, const void *texels,
                             uint32_t width, uint32_t height, uint32_t image_width,
                             uint32_t image_height, uint32_t beyond, masu_headless_source *source,
                             char *error, size_t error_size);
void masu_headless_source_destroy(masu_headless *host, masu_headless_source *source);

#endif
