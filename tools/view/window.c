/* window.c: see window.h. */
#include "view/window.h"

#include <SDL_vulkan.h>
#include <stdio.h>
#include <string.h>

#define FORMATS_MAX 64u
#define MODES_MAX 16u

bool masu_window_open(masu_window *w, const char *title, VkExtent2D size, char *error, size_t n) {
    memset(w, 0, sizeof *w);
    if (SDL_InitSubSystem(SDL_INIT_VIDEO)) {
        snprintf(error, n, "no window: %s", SDL_GetError());
        return false;
    }
    (void)SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER); /* optional: keys and mouse are enough */
    w->sdl = SDL_CreateWindow(title, SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
                              (int)size.width, (int)size.height,
                              SDL_WINDOW_VULKAN | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
    if (w->sdl) return true;
    snprintf(error, n, "no window: %s", SDL_GetError());
    masu_window_close(w);
    return false;
}

void masu_window_close(masu_window *w) {
    if (w->sdl) SDL_DestroyWindow(w->sdl);
    w->sdl = NULL;
    SDL_Quit();
}

/* ---- Surface --------------------------------------------------------------------------------- */

static bool presents(void *user, VkInstance instance, VkPhysicalDevice device, uint32_t family) {
    masu_window *w = user;
    if (!w->surface && !w->surface_failed)
        w->surface_failed = !SDL_Vulkan_CreateSurface(w->sdl, instance, &w->surface);
    VkBool32 can = VK_FALSE;
    return w->surface &&
           !vkGetPhysicalDeviceSurfaceSupportKHR(device, family, w->surface, &can) && can;
}

static void surface_close(void *user, VkInstance instance) {
    masu_window *w = user;
    vkDestroySurfaceKHR(instance, w->surface, NULL);
    w->surface = VK_NULL_HANDLE;
}

bool masu_window_attach(masu_window *w, const masu_headless_desc *given, masu_headless *host,
                        char *error, size_t size) {
    const char *names[8];
    unsigned count = sizeof names / sizeof *names;
    if (!SDL_Vulkan_GetInstanceExtensions(w->sdl, &count, names)) {
        snprintf(error, size, "no window: %s", SDL_GetError());
        return false;
    }
    masu_headless_desc desc = *given;
    desc.surface_extensions = names;
    desc.surface_extension_count = count;
    desc.presents = presents;
    desc.surface_close = surface_close;
    desc.surface_user = w;
    w->surface_failed = false;
    if (!masu_headless_open(&desc, host, error, size)) {
        if (w->surface_failed) snprintf(error, size, "no window: %s", SDL_GetError());
        return false;
    }
    host->desc.surface_extensions = NULL; /* names is out of scope after this function */
    w->host = host;
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++) {
        VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        VkResult r = vkCreateSemaphore(host->device, &info, NULL, &w->acquired[i]);
        if (!r) continue;
        masu_headless_fail(error, size, "vkCreateSemaphore", r);
        masu_window_detach(w);
        masu_headless_close(host);
        return false;
    }
    return true;
}

/* ---- Swapchain ------------------------------------------------------------------------------- */

static void drop_images(masu_window *w) {
    for (uint32_t i = 0; i < MASU_WINDOW_IMAGES; i++) {
        vkDestroySemaphore(w->host->device, w->finished[i], NULL);
        w->finished[i] = VK_NULL_HANDLE;
    }
    w->count = 0;
}

void masu_window_detach(masu_window *w) {
    if (!w->host) return;
    drop_images(w);
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++) {
        vkDestroySemaphore(w->host->device, w->acquired[i], NULL);
        w->acquired[i] = VK_NULL_HANDLE;
    }
    vkDestroySwapchainKHR(w->host->device, w->swapchain, NULL);
    w->swapchain = VK_NULL_HANDLE;
    w->host = NULL;
}

static bool choose_format(masu_window *w, VkSurfaceFormatKHR *out, char *error, size_t size) {
    static const VkFormat wanted[] = {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM,
                                      VK_FORMAT_A8B8G8R8_UNORM_PACK32,
                                      VK_FORMAT_A2B10G10R10_UNORM_PACK32,
                                      VK_FORMAT_A2R10G10B10_UNORM_PACK32,
                                      VK_FORMAT_R5G6B5_UNORM_PACK16};
    VkSurfaceFormatKHR list[FORMATS_MAX];
    uint32_t n = FORMATS_MAX;
    VkResult r = vkGetPhysicalDeviceSurfaceFormatsKHR(w->host->physical, w->surface, &n, list);
    if (r && r != VK_INCOMPLETE)
        return masu_headless_fail(error, size, "vkGetPhysicalDeviceSurfaceFormatsKHR", r);
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
        for (uint32_t i = 0; i < n; i++) {
            VkFormatProperties p;
            if (list[i].format != wanted[k] ||
                list[i].colorSpace != VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
                continue;
            vkGetPhysicalDeviceFormatProperties(w->host->physical, wanted[k], &p);
            if (!(p.optimalTilingFeatures & VK_FORMAT_FEATURE_BLIT_DST_BIT)) continue;
            *out = list[i];
            return true;
        }
    }
    snprintf(error, size, "the window's surface has no UNORM format that supports blits");
    return false;
}

/* FIFO is always supported. Without vsync, frames are presented as fast as possible, so that the
 * display does not limit measurements. */
static VkPresentModeKHR choose_mode(const masu_window *w, bool vsync) {
    VkPresentModeKHR list[MODES_MAX], best = VK_PRESENT_MODE_FIFO_KHR;
    uint32_t n = MODES_MAX;
    VkResult r = vkGetPhysicalDeviceSurfacePresentModesKHR(w->host->physical, w->surface, &n, list);
    if (vsync || (r && r != VK_INCOMPLETE)) return best;
    for (uint32_t i = 0; i < n; i++) {
        if (list[i] == VK_PRESENT_MODE_MAILBOX_KHR) return list[i];
        if (list[i] == VK_PRESENT_MODE_IMMEDIATE_KHR) best = list[i];
    }
    return best;
}

static VkExtent2D choose_extent(const masu_window *w, const VkSurfaceCapabilitiesKHR *caps) {
    VkExtent2D e = caps->currentExtent;
    if (e.width != UINT32_MAX) return e;
    int width = 0, height = 0;
    SDL_Vulkan_GetDrawableSize(w->sdl, &width, &height);
    VkExtent2D low = caps->minImageExtent, high = caps->maxImageExtent;
    e.width = (uint32_t)width < low.width ? low.width : (uint32_t)width;
    e.height = (uint32_t)height < low.height ? low.height : (uint32_t)height;
    e.width = e.width > high.width ? high.width : e.width;
    e.height = e.height > high.height ? high.height : e.height;
    return e;
}

static bool make_images(masu_window *w, char *error, size_t size) {
    w->count = MASU_WINDOW_IMAGES;
    VkResult r = vkGetSwapchainImagesKHR(w->host->device, w->swapchain, &w->count, w->images);
    if (r == VK_INCOMPLETE) {
        snprintf(error, size, "swapchain: expected at most %u images", MASU_WINDOW_IMAGES);
        return false;
    }
    if (r) return masu_headless_fail(error, size, "vkGetSwapchainImagesKHR", r);
    for (uint32_t i = 0; i < w->count; i++) {
        VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        r = vkCreateSemaphore(w->host->device, &info, NULL, &w->finished[i]);
        if (r) return masu_headless_fail(error, size, "vkCreateSemaphore", r);
    }
    return true;
}

bool masu_window_swapchain(masu_window *w, bool vsync, char *error, size_t size) {
    VkSurfaceCapabilitiesKHR caps;
    VkResult r = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(w->host->physical, w->surface, &caps);
    if (r) return masu_headless_fail(error, size, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR", r);
    w->extent = choose_extent(w, &caps);
    w->stale = false;
    if (!w->extent.width || !w->extent.height) {
        w->extent = (VkExtent2D){0, 0};
        w->stale = true;
        return true;
    }
    if (!(caps.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT)) {
        snprintf(error, size, "the window's surface does not support copies");
        return false;
    }
    VkSurfaceFormatKHR format = {VK_FORMAT_UNDEFINED, VK_COLOR_SPACE_SRGB_NONLINEAR_KHR};
    if (!choose_format(w, &format, error, size)) return false;
    uint32_t count = caps.minImageCount + 1;
    if (caps.maxImageCount && count > caps.maxImageCount) count = caps.maxImageCount;
    VkCompositeAlphaFlagBitsKHR alpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    if (!(caps.supportedCompositeAlpha & alpha)) alpha = VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    /* The image is not rotated: the compositor rotates it on a rotated display. */
    VkSurfaceTransformFlagBitsKHR transform = VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR;
    if (!(caps.supportedTransforms & transform)) transform = caps.currentTransform;
    w->rotated = transform != caps.currentTransform;
    VkSwapchainKHR old = w->swapchain;
    VkSwapchainCreateInfoKHR info = {.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                     .surface = w->surface,
                                     .minImageCount = count,
                                     .imageFormat = format.format,
                                     .imageColorSpace = format.colorSpace,
                                     .imageExtent = w->extent,
                                     .imageArrayLayers = 1,
                                     .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                     .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                     .preTransform = transform,
                                     .compositeAlpha = alpha,
                                     .presentMode = choose_mode(w, vsync),
                                     .clipped = VK_TRUE,
                                     .oldSwapchain = old};
    w->format = format.format;
    w->mode = info.presentMode;
    w->swapchain = VK_NULL_HANDLE;
    r = vkCreateSwapchainKHR(w->host->device, &info, NULL, &w->swapchain);
    drop_images(w);
    vkDestroySwapchainKHR(w->host->device, old, NULL);
    if (r) return masu_headless_fail(error, size, "vkCreateSwapchainKHR", r);
    return make_images(w, error, size);
}

VkResult masu_window_acquire(masu_window *w, uint32_t slot, uint32_t *image) {
    VkResult r = vkAcquireNextImageKHR(w->host->device, w->swapchain, MASU_HEADLESS_TIMEOUT_NS,
                                       w->acquired[slot], VK_NULL_HANDLE, image);
    if (r == VK_SUBOPTIMAL_KHR) { /* usable: the image can be drawn, and its semaphore will be
                                   * signalled */
        /* an unrotated swapchain on a rotated display is always suboptimal */
        w->stale |= !w->rotated;
        return VK_SUCCESS;
    }
    if (r == VK_ERROR_OUT_OF_DATE_KHR) w->stale = true;
    return r;
}

VkResult masu_window_present(masu_window *w, uint32_t image) {
    VkPresentInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                             .waitSemaphoreCount = 1,
                             .pWaitSemaphores = &w->finished[image],
                             .swapchainCount = 1,
                             .pSwapchains = &w->swapchain,
                             .pImageIndices = &image};
    VkResult r = vkQueuePresentKHR(w->host->queue, &info);
    if ((r == VK_SUBOPTIMAL_KHR && !w->rotated) || r == VK_ERROR_OUT_OF_DATE_KHR) w->stale = true;
    return r == VK_SUBOPTIMAL_KHR ? VK_SUCCESS : r;
}
