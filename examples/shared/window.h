/* window.h: what a host owns, as the examples with a window have it: SDL's window, the Vulkan device, the
 * swapchain, two frames in flight. It knows of Masu what its contract asks for: a queue with graphics and
 * compute, images that can be copied to, features told as they were enabled. */
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
    VkPhysicalDeviceFeatures features; /* that the device was created with */
    float anisotropy; /* that textures are to be filtered with */
    uint32_t family;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    bool srgb, unpaced; /* set before window_open: prefer an sRGB format; do not wait for the display */
    bool rotated; /* the compositor rotates the images (surface.h) */
    VkFormat format;
    VkExtent2D size;
    VkSwapchainKHR swapchain, replaced;
    uint32_t count;
    VkImage images[WINDOW_IMAGES];
    VkSemaphore drawn[WINDOW_IMAGES], acquired[WINDOW_SLOTS];
    VkFence fences[WINDOW_SLOTS];
    VkCommandBuffer commands[WINDOW_SLOTS]; /* the host's own, behind the library's */
    /* For masu_frame_times: when the slot's last frame was submitted (0: none since the window had this size) and
     * when it had ended; and how long that was, without what it waited for the frame before, ms. */
    uint64_t submit_ns[WINDOW_SLOTS], done_ns[WINDOW_SLOTS];
    double frame_ms;
} window;

/* All of these say on stderr what went wrong. Without `validate` no layer is asked for. */
bool window_open(window *w, const char *title, int width, int height, bool validate);
void window_close(window *w);
/* What a description says of these. */
masu_vulkan window_vulkan(const window *w);
masu_targets window_targets(const window *w);
/* The swapchain anew, as large as the window is now; the device is idle. False without a word: the window has
 * no size at present. The images of the one before are there until window_drop. */
bool window_swapchain(window *w);
void window_drop(window *w);
/* Waits for the slot's last frame and takes the next image. VK_SUCCESS, or VK_ERROR_OUT_OF_DATE_KHR: make the
 * swapchain anew. */
VkResult window_begin(window *w, uint32_t slot, uint32_t *image);
/* Submits `count` command buffers and shows the image. Results as of window_begin, VK_SUBOPTIMAL_KHR too. */
VkResult window_end(window *w, uint32_t slot, uint32_t image, const VkCommandBuffer *list, uint32_t count);
bool window_run(window *w, VkCommandBuffer commands); /* and waits: for masu_load */
/* Device memory of a type; mapped if `mapped` is not NULL. */
bool window_memory(window *w, uint32_t type, VkDeviceSize bytes, VkDeviceMemory *memory, void **mapped);
/* Blocks of so many bytes for the roles that a plan has, of its types: for masu_desc.device_blocks. */
bool window_blocks(window *w, const masu_memory *need, const VkDeviceSize bytes[MASU_ROLE_COUNT],
                   masu_device_block out[MASU_ROLE_COUNT]);

#endif
