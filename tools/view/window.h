/* window.h: the window (SDL2), its surface and its swapchain. Any video driver of SDL works: X11,
 * Wayland, or KMS/DRM without either.
 *
 * The window outlives devices: after a device is lost, the next one creates a new surface. The
 * swapchain's images are the destination of a blit and have a UNORM format, so that the bytes of an
 * image are unchanged. Functions that can fail return false and write one line to `error`; acquire
 * and present return the VkResult of the presentation engine. */
#ifndef MASU_VIEW_WINDOW_H
#define MASU_VIEW_WINDOW_H

#include "headless.h"

#include <SDL.h>

#define MASU_WINDOW_IMAGES 8u
#define MASU_WINDOW_FLIGHT 2u

typedef struct masu_window {
    SDL_Window *sdl;
    masu_headless *host; /* owner of surface and swapchain; NULL: none */
    VkSurfaceKHR surface;
    bool surface_failed; /* SDL could not create one; see SDL_GetError */
    VkSwapchainKHR swapchain;
    VkFormat format;
    VkPresentModeKHR mode;
    VkExtent2D extent; /* 0x0: minimised, nothing to draw to */
    uint32_t count;
    VkImage images[MASU_WINDOW_IMAGES];
    VkSemaphore acquired[MASU_WINDOW_FLIGHT]; /* per frame in flight */
    VkSemaphore finished[MASU_WINDOW_IMAGES]; /* per image: presenting waits for it */
    bool stale;                               /* the swapchain must be recreated */
    bool rotated;                             /* the compositor rotates the images */
} masu_window;

/* Opens the window. */
bool masu_window_open(masu_window *w, const char *title, VkExtent2D size, char *error,
                      size_t size_);
void masu_window_close(masu_window *w);

/* Opens a device that can present to the window. masu_headless_close destroys the surface; call
 * masu_window_detach first, for swapchain and semaphores. */
bool masu_window_attach(masu_window *w, const masu_headless_desc *desc, masu_headless *host,
                        char *error, size_t size);
void masu_window_detach(masu_window *w);

/* Creates the swapchain at the window's current size, from the old one if there is one. The device
 * is idle. True with an extent of 0x0: minimised. */
bool masu_window_swapchain(masu_window *w, bool vsync, char *error, size_t size);

/* VK_SUCCESS: draw to *image. Any other result except a lost device: recreate the swapchain. */
VkResult masu_window_acquire(masu_window *w, uint32_t slot, uint32_t *image);
VkResult masu_window_present(masu_window *w, uint32_t image);

#endif
