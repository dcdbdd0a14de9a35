/* window.c: see window.h. */
#include "window.h"
#include "surface.h"

#include <SDL_vulkan.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MANY 16u
#define INFO(type) .sType = VK_STRUCTURE_TYPE_##type
#define TRY(call) if (!check(call, #call)) return false

static bool check(VkResult r, const char *what) {
    if (r < 0) fprintf(stderr, "%s failed: VkResult %d\n", what, (int)r);
    return r >= 0;
}

static bool sdl_failed(const char *what) {
    return fprintf(stderr, "%s: %s\n", what, SDL_GetError()), false;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user) {
    (void)severity, (void)types;
    ((window *)user)->messages++;
    fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

static bool create_instance(window *w, bool validate) {
    const char *names[MANY], *layer = "VK_LAYER_KHRONOS_validation";
    unsigned count = MANY - 1;
    if (!SDL_Vulkan_GetInstanceExtensions(w->sdl, &count, names)) return sdl_failed("no Vulkan");
    if (validate) names[count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkApplicationInfo app = {INFO(APPLICATION_INFO), .apiVersion = VK_API_VERSION_1_1};
    VkInstanceCreateInfo info = {INFO(INSTANCE_CREATE_INFO), .pApplicationInfo = &app,
                                 .enabledLayerCount = validate, .ppEnabledLayerNames = &layer,
                                 .enabledExtensionCount = count, .ppEnabledExtensionNames = names};
    TRY(vkCreateInstance(&info, NULL, &w->instance));
    if (!validate) return true;
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        INFO(DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT), .pfnUserCallback = on_message, .pUserData = w,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT};
    PFN_vkVoidFunction create =
        vkGetInstanceProcAddr(w->instance, "vkCreateDebugUtilsMessengerEXT");
    TRY(((PFN_vkCreateDebugUtilsMessengerEXT)create)(w->instance, &messenger, NULL, &w->messenger));
    return true;
}

/* The first device with a queue family for graphics, compute and presentation. */
static bool choose_device(window *w) {
    VkPhysicalDevice gpus[MANY];
    uint32_t n = MANY;
    TRY(vkEnumeratePhysicalDevices(w->instance, &n, gpus));
    for (uint32_t i = 0; i < n; i++) {
        VkQueueFamilyProperties families[MANY];
        uint32_t many = MANY;
        vkGetPhysicalDeviceQueueFamilyProperties(gpus[i], &many, families);
        for (uint32_t f = 0; f < many; f++) {
            VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
            VkBool32 shows = VK_FALSE;
            vkGetPhysicalDeviceSurfaceSupportKHR(gpus[i], f, w->surface, &shows);
            if (!shows || (families[f].queueFlags & wanted) != wanted) continue;
            w->gpu = gpus[i], w->family = f;
            return true;
        }
    }
    return fprintf(stderr, "no Vulkan device can present to this window\n"), false;
}

static bool create_device(window *w) {
    const char *swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    masu_desc ask = {MASU_DESC, .vulkan = window_vulkan(w)};
    masu_device_info can;
    masu_detail detail;
    VkPhysicalDeviceProperties gpu;
    if (masu_device_query(&ask, &can, &detail)) return fprintf(stderr, "%s\n", detail.text), false;
    vkGetPhysicalDeviceProperties(w->gpu, &gpu);
    w->features = (VkPhysicalDeviceFeatures){
        .textureCompressionBC = (can.used & MASU_FEATURE_TEXTURE_COMPRESSION_BC) != 0,
        .samplerAnisotropy = (can.used & MASU_FEATURE_SAMPLER_ANISOTROPY) != 0};
    if (gpu.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) /* 20 times as slow */
        w->anisotropy = fminf(8, can.max_anisotropy);
    VkDeviceQueueCreateInfo queue = {INFO(DEVICE_QUEUE_CREATE_INFO), .queueFamilyIndex = w->family,
                                     .queueCount = 1, .pQueuePriorities = (float[1]){1}};
    VkDeviceCreateInfo info = {INFO(DEVICE_CREATE_INFO), .pEnabledFeatures = &w->features,
                               .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue,
                               .enabledExtensionCount = 1, .ppEnabledExtensionNames = &swapchain};
    TRY(vkCreateDevice(w->gpu, &info, NULL, &w->device));
    vkGetDeviceQueue(w->device, w->family, 0, &w->queue);
    VkCommandPoolCreateInfo pool = {INFO(COMMAND_POOL_CREATE_INFO), .queueFamilyIndex = w->family,
                                    .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT};
    TRY(vkCreateCommandPool(w->device, &pool, NULL, &w->pool));
    VkCommandBufferAllocateInfo buffers = {INFO(COMMAND_BUFFER_ALLOCATE_INFO),
                                           .commandPool = w->pool,
                                           .commandBufferCount = WINDOW_SLOTS};
    TRY(vkAllocateCommandBuffers(w->device, &buffers, w->commands));
    VkFenceCreateInfo fence = {INFO(FENCE_CREATE_INFO), .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    VkSemaphoreCreateInfo semaphore = {INFO(SEMAPHORE_CREATE_INFO)};
    for (int i = 0; i < WINDOW_SLOTS; i++) {
        TRY(vkCreateFence(w->device, &fence, NULL, &w->fences[i]));
        TRY(vkCreateSemaphore(w->device, &semaphore, NULL, &w->acquired[i]));
    }
    for (int i = 0; i < WINDOW_IMAGES; i++)
        TRY(vkCreateSemaphore(w->device, &semaphore, NULL, &w->drawn[i]));
    return true;
}

static bool choose_format(window *w) {
    VkSurfaceFormatKHR formats[64];
    uint32_t n = 64;
    TRY(vkGetPhysicalDeviceSurfaceFormatsKHR(w->gpu, w->surface, &n, formats));
    w->format = surface_format(formats, n, w->srgb);
    return w->format || (fprintf(stderr, "the window's surface has no 8-bit format\n"), false);
}

bool window_open(window *w, const char *title, int width, int height, bool validate) {
    int any = SDL_WINDOWPOS_CENTERED;
    if (SDL_Init(SDL_INIT_VIDEO | SDL_INIT_GAMECONTROLLER)) return sdl_failed("SDL");
    w->sdl =
        SDL_CreateWindow(title, any, any, width, height, SDL_WINDOW_VULKAN | SDL_WINDOW_RESIZABLE);
    if (!w->sdl) return sdl_failed("no window");
    if (!create_instance(w, validate)) return false;
    if (!SDL_Vulkan_CreateSurface(w->sdl, w->instance, &w->surface))
        return sdl_failed("no surface");
    return choose_device(w) && create_device(w) && choose_format(w) && window_swapchain(w);
}

masu_vulkan window_vulkan(const window *w) {
    return (masu_vulkan){.get_instance_proc_addr = vkGetInstanceProcAddr,
                         .instance = w->instance,
                         .physical_device = w->gpu,
                         .device = w->device,
                         .queue_family = w->family,
                         .texture_compression_bc = w->features.textureCompressionBC,
                         .max_anisotropy = w->anisotropy};
}

masu_targets window_targets(const window *w) {
    return (masu_targets){.images = w->images, .count = w->count, .format = w->format};
}

bool window_swapchain(window *w) {
    VkSurfaceCapabilitiesKHR can;
    VkPresentModeKHR modes[MANY];
    uint32_t mode_count = MANY;
    int width, height;
    SDL_Vulkan_GetDrawableSize(w->sdl, &width, &height); /* if the surface does not set the size */
    TRY(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(w->gpu, w->surface, &can));
    TRY(vkGetPhysicalDeviceSurfacePresentModesKHR(w->gpu, w->surface, &mode_count, modes));
    VkExtent2D size = {(uint32_t)width, (uint32_t)height};
    if (can.currentExtent.width != UINT32_MAX) size = can.currentExtent;
    if (!size.width || !size.height) return false;
    uint32_t least = can.minImageCount > 3 ? can.minImageCount : 3;
    w->size = size, w->replaced = w->swapchain;
    VkSwapchainCreateInfoKHR info = {
        INFO(SWAPCHAIN_CREATE_INFO_KHR),
        .surface = w->surface,
        .oldSwapchain = w->replaced,
        .minImageCount = can.maxImageCount && least > can.maxImageCount ? can.maxImageCount : least,
        .imageFormat = w->format,
        .imageColorSpace = VK_COLOR_SPACE_SRGB_NONLINEAR_KHR,
        .imageExtent = size,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
        .preTransform = surface_transform(&can),
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = surface_mode(modes, mode_count, !w->unpaced),
        .clipped = VK_TRUE};
    w->rotated = info.preTransform != can.currentTransform;
    TRY(vkCreateSwapchainKHR(w->device, &info, NULL, &w->swapchain));
    memset(w->submit_ns, 0, sizeof w->submit_ns); /* the time between two sizes is not a frame
                                                   * time */
    w->count = WINDOW_IMAGES;
    TRY(vkGetSwapchainImagesKHR(w->device, w->swapchain, &w->count, w->images));
    return true;
}

void window_drop(window *w) {
    vkDestroySwapchainKHR(w->device, w->replaced, NULL);
    w->replaced = VK_NULL_HANDLE;
}

static uint64_t clock_ns(void) {
    return (uint64_t)(1e9 * (double)SDL_GetPerformanceCounter() /
                      (double)SDL_GetPerformanceFrequency());
}

VkResult window_begin(window *w, uint32_t slot, uint32_t *image) {
    VkResult r = vkWaitForFences(w->device, 1, &w->fences[slot], VK_TRUE, UINT64_MAX);
    uint64_t before = w->done_ns[!slot],
             from = w->submit_ns[slot] > before ? w->submit_ns[slot] : before;
    w->done_ns[slot] = clock_ns();
    w->frame_ms = (double)(w->done_ns[slot] - from) / 1e6;
    if (!r)
        r = vkAcquireNextImageKHR(w->device, w->swapchain, UINT64_MAX, w->acquired[slot],
                                  VK_NULL_HANDLE, image);
    if (r != VK_ERROR_OUT_OF_DATE_KHR) (void)check(r, "taking an image of the window");
    return r == VK_SUBOPTIMAL_KHR ? VK_SUCCESS : r; /* usable; window_end reports it */
}

VkResult window_end(window *w, uint32_t slot, uint32_t image, const VkCommandBuffer *list,
                    uint32_t count) {
    VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    VkSubmitInfo submit = {INFO(SUBMIT_INFO), NULL, 1, &w->acquired[slot], &stage, count, list, 1,
                           &w->drawn[image]};
    vkResetFences(w->device, 1, &w->fences[slot]);
    w->submit_ns[slot] = clock_ns();
    VkResult r = vkQueueSubmit(w->queue, 1, &submit, w->fences[slot]);
    VkPresentInfoKHR present = {INFO(PRESENT_INFO_KHR), NULL, 1, &w->drawn[image], 1, &w->swapchain,
                                &image, NULL};
    if (!r) r = vkQueuePresentKHR(w->queue, &present);
    if (r != VK_ERROR_OUT_OF_DATE_KHR) (void)check(r, "showing a frame");
    /* Presenting an unrotated image to a rotated surface is always suboptimal: do not recreate the
     * swapchain. */
    return r == VK_SUBOPTIMAL_KHR && w->rotated ? VK_SUCCESS : r;
}

bool window_run(window *w, VkCommandBuffer commands) {
    VkSubmitInfo submit = {INFO(SUBMIT_INFO), .commandBufferCount = 1,
                           .pCommandBuffers = &commands};
    TRY(vkQueueSubmit(w->queue, 1, &submit, VK_NULL_HANDLE));
    TRY(vkQueueWaitIdle(w->queue));
    return true;
}

bool window_memory(window *w, uint32_t type, VkDeviceSize bytes, VkDeviceMemory *memory,
                   void **mapped) {
    VkMemoryAllocateInfo info = {INFO(MEMORY_ALLOCATE_INFO), NULL, bytes, type};
    TRY(vkAllocateMemory(w->device, &info, NULL, memory));
    if (mapped) TRY(vkMapMemory(w->device, *memory, 0, VK_WHOLE_SIZE, 0, mapped));
    return true;
}

bool window_blocks(window *w, const masu_memory *need, const VkDeviceSize bytes[MASU_ROLE_COUNT],
                   masu_device_block out[MASU_ROLE_COUNT]) {
    for (int i = 0; i < MASU_ROLE_COUNT; i++) {
        const masu_role_need *role = &need->roles[i];
        if (!role->bytes) continue;
        out[i].bytes = bytes[i], out[i].memory_type = role->type;
        void **mapped = role->host_visible ? &out[i].mapped : NULL;
        if (!window_memory(w, role->type, bytes[i], &out[i].memory, mapped)) return false;
    }
    return true;
}

void window_close(window *w) {
    if (w->device) {
        vkDeviceWaitIdle(w->device);
        window_drop(w);
        vkDestroySwapchainKHR(w->device, w->swapchain, NULL);
        for (int i = 0; i < WINDOW_IMAGES; i++) vkDestroySemaphore(w->device, w->drawn[i], NULL);
        for (int i = 0; i < WINDOW_SLOTS; i++) {
            vkDestroySemaphore(w->device, w->acquired[i], NULL);
            vkDestroyFence(w->device, w->fences[i], NULL);
        }
        vkDestroyCommandPool(w->device, w->pool, NULL);
        vkDestroyDevice(w->device, NULL);
    }
    if (w->messenger)
        ((PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            w->instance, "vkDestroyDebugUtilsMessengerEXT"))(w->instance, w->messenger, NULL);
    if (w->surface) vkDestroySurfaceKHR(w->instance, w->surface, NULL);
    if (w->instance) vkDestroyInstance(w->instance, NULL);
    if (w->sdl) SDL_DestroyWindow(w->sdl);
    SDL_Quit();
}
