/* window.h: what a host owns: SDL's window, the Vulkan device, the swapchain, the submits. */
#ifndef DRIVE_WINDOW_H
#define DRIVE_WINDOW_H

#include <SDL.h>
#include <stdbool.h>
#include <vulkan/vulkan.h>

#define WINDOW_IMAGES 8
#define WINDOW_SLOTS 2 /* frames in flight */
#define PHOTO_BYTES (2560 * 1440 * 4)

typedef struct window {
    SDL_Window *sdl;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    int messages; /* of the validation layer */
    VkSurfaceKHR surface;
    VkPhysicalDevice gpu;
    VkPhysicalDeviceMemoryProperties memory;
    VkPhysicalDeviceFeatures features; /* that the device was created with */
    float anisotropy; /* that textures are to be filtered with */
    uint32_t family;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkRenderPass pass; /* draws over what is there, and leaves it to be shown */
    VkFormat format;
    VkSwapchainKHR swapchain, replaced;
    VkExtent2D size;
    uint32_t count;
    VkImage images[WINDOW_IMAGES];
    VkImageView views[WINDOW_IMAGES];
    VkFramebuffer framebuffers[WINDOW_IMAGES];
    VkSemaphore drawn[WINDOW_IMAGES];
    VkSemaphore acquired[WINDOW_SLOTS];
    VkFence fences[WINDOW_SLOTS];
    VkCommandBuffer commands[WINDOW_SLOTS]; /* the host's own, behind the library's */
    VkBuffer photo;
    VkDeviceMemory photo_memory;
    void *photo_pixels; /* of the last frame that was submitted with `photo` */
} window;

/* All of these say on stderr what went wrong. */
bool window_open(window *w, int width, int height, bool validate);
void window_close(window *w);
/* The swapchain anew, as large as the window is now; the device is idle. The images of the one before are
 * there until window_drop. */
bool window_swapchain(window *w);
void window_drop(window *w);
bool window_allocate(window *w, uint32_t type, VkDeviceSize bytes, VkDeviceMemory *memory);
/* The next image; VK_SUCCESS, or VK_ERROR_OUT_OF_DATE_KHR: make the swapchain anew. */
VkResult window_acquire(window *w, uint32_t slot, uint32_t *image);
/* Submits the library's commands and the host's of the slot, and shows the image. */
VkResult window_show(window *w, uint32_t slot, uint32_t image, VkCommandBuffer library);
bool window_run(window *w, VkCommandBuffer commands); /* and waits */
bool window_wait(window *w, uint32_t slot);
void window_copy_photo(window *w, VkCommandBuffer to, uint32_t image);

#endif
