/* window.h: the window (SDL2), its surface and its swapchain. Whatever video driver SDL finds will do:
 * X11, Wayland, or KMS/DRM without either.
 *
 * The window outlives devices: after a device is lost, another one makes a new surface for it. The
 * swapchain's images are filled by a blit (transfer destination) and have a UNORM format, so that the
 * bytes of a picture stay what they are. Functions that can fail return false and write one line to
 * `error`; those that talk to the presentation engine return its VkResult. */
#ifndef MASU_VIEW_WINDOW_H
#define MASU_VIEW_WINDOW_H

#include "headless.h"

#include <SDL.h>

#define MASU_WINDOW_IMAGES 8u
#define MASU_WINDOW_FLIGHT 2u

typedef struct masu_window {
    SDL_Window *sdl;
    masu_headless *host; /* that the surface and the swapchain belong to; NULL: none */
    VkSurfaceKHR surface;
    bool surface_failed; /* SDL could not make one; its message is SDL_GetError's */
    VkSwapchainKHR swapchain;
    VkFormat format;
    VkPresentModeKHR mode;
    VkExtent2D extent; /* 0x0: it is minimised, there is nothing to draw to */
    uint32_t count;
    VkImage images[MASU_WINDOW_IMAGES];
    VkSemaphore acquired[MASU_WINDOW_FLIGHT]; /* of each frame in flight */
    VkSemaphore finished[MASU_WINDOW_IMAGES]; /* of each image: presenting waits for it */
    bool stale;                               /* the swapchain must be made again */
    bool rotated;                             /* the compositor rotates the pictures */
} masu_window;

/* Opens the window itself. */
bool masu_window_open(masu_window *w, const char *title, VkExtent2D size, char *error, size_t size_);
void masu_window_close(masu_window *w);

/* A device that can show pictures in the window. masu_headless_close ends its surface, too; swapchain
 * and semaphores go before, by masu_window_detach. */
bool masu_window_attach(masu_window *w, const masu_headless_desc *desc, masu_headless *host, char *error,
                        size_t size);
void masu_window_detach(masu_window *w);

/* Makes the swapchain, or makes it anew from the old one, at the size that the window has now. The
 * device is idle. True with an extent of 0x0: minimised. */
bool masu_window_swapchain(masu_window *w, bool vsync, char *error, size_t size);

/* VK_SUCCESS: *image is to be drawn. Anything else but a lost device: make the swapchain anew. */
VkResult masu_window_acquire(masu_window *w, uint32_t slot, uint32_t *image);
VkResult masu_window_present(masu_window *w, uint32_t image);

#endif
