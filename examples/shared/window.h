/* window.h: the host's objects in the examples with a window: SDL's window, the Vulkan device, the
 * swapchain, two frames in flight. It provides what Masu's contract requires: a queue with graphics
 * and compute, images that are transfer destinations, the enabled features. */
#ifndef EXAMPLES_WINDOW_H
#define EXAMPLES_WINDOW_H

#include "masu.h"

#include <SDL.h>
#include <stdbool.h>
#include <vulkan/vulkan.h>

#define WINDOW_IMAGES 8
#define WINDOW_SLOTS 2 /* frames in flight */

typedef struct window {
    SDL_Window *sdl;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    int messages; /* of the validation layer */
    VkSurfaceKHR surface;
    VkPhysicalDevice gpu;
    VkPhysicalDeviceFeatures features; /* enabled in the device */
    float anisotropy; /* for the filtering of textures */
    uint32_t family;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    bool srgb, unpaced; /* set before window_open: prefer an sRGB format; do not wait for the
                         * display */
    bool rotated; /* the compositor rotates the images (surface.h) */
    VkFormat format;
    VkExtent2D size;
    VkSwapchainKHR swapchain, replaced;
    uint32_t count;
    VkImage images[WINDOW_IMAGES];
    VkSemaphore drawn[WINDOW_IMAGES], acquired[WINDOW_SLOTS];
    VkFence fences[WINDOW_SLOTS];
    VkCommandBuffer commands[WINDOW_SLOTS]; /* recorded by the host, submitted after the
                                             * library's */
    /* For masu_frame_times: when the slot's last frame was submitted (0: none since the window has
     * this size) and when it ended; frame_ms is its duration without the wait for the previous
     * frame. */
    uint64_t submit_ns[WINDOW_SLOTS], done_ns[WINDOW_SLOTS];
    double frame_ms;
} window;

/* All functions report errors on stderr. `validate` enables the validation layer. */
bool window_open(window *w, const char *title, int width, int height, bool validate);
void window_close(window *w);
/* The members of a description for this window. */
masu_vulkan window_vulkan(const window *w);
masu_targets window_targets(const window *w);
/* Recreates the swapchain with the window's current size; the device is idle. Returns false without
 * a message if the window has no size at present. The previous images exist until window_drop. */
bool window_swapchain(window *w);
void window_drop(window *w);
/* Waits for the slot's last frame and acquires the next image. VK_SUCCESS, or
 * VK_ERROR_OUT_OF_DATE_KHR: recreate the swapchain. */
VkResult window_begin(window *w, uint32_t slot, uint32_t *image);
/* Submits `count` command buffers and presents the image. Results as for window_begin, also
 * VK_SUBOPTIMAL_KHR. */
VkResult window_end(window *w, uint32_t slot, uint32_t image, const VkCommandBuffer *list,
                    uint32_t count);
bool window_run(window *w, VkCommandBuffer commands); /* submits and waits: for masu_load */
/* Device memory of a type; mapped if `mapped` is not NULL. */
bool window_memory(window *w, uint32_t type, VkDeviceSize bytes, VkDeviceMemory *memory,
                   void **mapped);
/* Allocates blocks of `bytes` for the roles of a plan, in its memory types: for
 * masu_desc.device_blocks. */
bool window_blocks(window *w, const masu_memory *need, const VkDeviceSize bytes[MASU_ROLE_COUNT],
                   masu_device_block out[MASU_ROLE_COUNT]);

#endif
