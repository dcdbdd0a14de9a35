/* window.c: see window.h. Nothing here is particular to Masu but what its contract asks for: images that
 * can be copied to, one queue with graphics and compute, features told as they were enabled. */
#include "window.h"

#include <SDL_vulkan.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MANY 16u
#define INFO(type) .sType = VK_STRUCTURE_TYPE_##type
#define TRY(call) if (!check(call, #call)) return false
static const VkImageSubresourceRange whole = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

static bool check(VkResult r, const char *what) {
    if (r < 0) fprintf(stderr, "drive: %s failed: VkResult %d\n", what, (int)r);
    return r >= 0;
}

static bool sdl_failed(const char *what) {
    return fprintf(stderr, "drive: %s: %s\n", what, SDL_GetError()), false;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data,
                                                 void *user) {
    (void)severity, (void)types;
    ((window *)user)->messages++;
    fprintf(stderr, "drive: validation: %s\n", data->pMessage);
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
    PFN_vkVoidFunction create = vkGetInstanceProcAddr(w->instance, "vkCreateDebugUtilsMessengerEXT");
    TRY(((PFN_vkCreateDebugUtilsMessengerEXT)create)(w->instance, &messenger, NULL, &w->messenger));
    return true;
}

/* The first device with a queue family that draws, computes and shows. */
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
            vkGetPhysicalDeviceMemoryProperties(w->gpu, &w->memory);
            return true;
        }
    }
    return fprintf(stderr, "drive: no Vulkan device draws to this window\n"), false;
}

static bool create_device(window *w) {
    const char *swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    VkPhysicalDeviceFeatures has;
    VkPhysicalDeviceProperties gpu;
    vkGetPhysicalDeviceFeatures(w->gpu, &has);
    vkGetPhysicalDeviceProperties(w->gpu, &gpu);
    w->features = (VkPhysicalDeviceFeatures){.textureCompressionBC = has.textureCompressionBC,
                                             .samplerAnisotropy = has.samplerAnisotropy};
    if (has.samplerAnisotropy && gpu.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) /* 20 times as long */
        w->anisotropy = fminf(8, gpu.limits.maxSamplerAnisotropy);
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
    VkCommandBufferAllocateInfo buffers = {INFO(COMMAND_BUFFER_ALLOCATE_INFO), .commandPool = w->pool,
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

bool window_allocate(window *w, uint32_t type, VkDeviceSize bytes, VkDeviceMemory *memory) {
    VkMemoryAllocateInfo info = {INFO(MEMORY_ALLOCATE_INFO), NULL, bytes, type};
    TRY(vkAllocateMemory(w->device, &info, NULL, memory));
    return true;
}

static bool create_photo(window *w) {
    VkBufferCreateInfo info = {INFO(BUFFER_CREATE_INFO), .size = PHOTO_BYTES,
                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    TRY(vkCreateBuffer(w->device, &info, NULL, &w->photo));
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(w->device, w->photo, &need);
    VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = 0; /* Vulkan promises that there is one */
    while (!(need.memoryTypeBits >> type & 1) ||
           (w->memory.memoryTypes[type].propertyFlags & wanted) != wanted) type++;
    if (!window_allocate(w, type, need.size, &w->photo_memory)) return false;
    TRY(vkBindBufferMemory(w->device, w->photo, w->photo_memory, 0));
    TRY(vkMapMemory(w->device, w->photo_memory, 0, VK_WHOLE_SIZE, 0, &w->photo_pixels));
    return true;
}

/* Between the library's commands and what copies or shows the image. */
static bool create_pass(window *w) {
    VkSurfaceFormatKHR formats[64];
    uint32_t n = 64;
    TRY(vkGetPhysicalDeviceSurfaceFormatsKHR(w->gpu, w->surface, &n, formats));
    for (uint32_t i = 0; i < n && !w->format; i++) {
        VkFormat f = formats[i].format; /* photos are read as four bytes */
        if (f == VK_FORMAT_B8G8R8A8_UNORM || f == VK_FORMAT_R8G8B8A8_UNORM) w->format = f;
    }
    if (!w->format) return fprintf(stderr, "drive: the window has no format of 8 bits\n"), false;
    VkAttachmentDescription color = {0, w->format, VK_SAMPLE_COUNT_1_BIT,
                                     VK_ATTACHMENT_LOAD_OP_LOAD, VK_ATTACHMENT_STORE_OP_STORE,
                                     VK_ATTACHMENT_LOAD_OP_DONT_CARE, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                     VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
    VkAttachmentReference reference = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {.colorAttachmentCount = 1, .pColorAttachments = &reference};
    VkPipelineStageFlags draws = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    VkAccessFlags reads = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT;
    VkAccessFlags writes = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    VkSubpassDependency around[2] = {
        {VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, draws, VK_ACCESS_MEMORY_WRITE_BIT,
         reads | writes, 0},
        {0, VK_SUBPASS_EXTERNAL, draws, VK_PIPELINE_STAGE_TRANSFER_BIT, writes,
         VK_ACCESS_TRANSFER_READ_BIT, 0}};
    VkRenderPassCreateInfo info = {INFO(RENDER_PASS_CREATE_INFO), .attachmentCount = 1,
                                   .pAttachments = &color, .subpassCount = 1, .pSubpasses = &subpass,
                                   .dependencyCount = 2, .pDependencies = around};
    TRY(vkCreateRenderPass(w->device, &info, NULL, &w->pass));
    return true;
}

bool window_open(window *w, int width, int height, bool validate) {
    if (SDL_Init(SDL_INIT_VIDEO | SDL_INIT_GAMECONTROLLER)) return sdl_failed("SDL");
    int where = SDL_WINDOWPOS_CENTERED;
    w->sdl = SDL_CreateWindow("Masu: drive", where, where, width, height,
                              SDL_WINDOW_VULKAN | SDL_WINDOW_RESIZABLE);
    if (!w->sdl) return sdl_failed("no window");
    if (!create_instance(w, validate)) return false;
    if (!SDL_Vulkan_CreateSurface(w->sdl, w->instance, &w->surface)) return sdl_failed("no surface");
    return choose_device(w) && create_device(w) && create_photo(w) && create_pass(w) &&
           window_swapchain(w);
}

static void forget_images(window *w) {
    for (uint32_t i = 0; i < w->count; i++) {
        vkDestroyFramebuffer(w->device, w->framebuffers[i], NULL);
        vkDestroyImageView(w->device, w->views[i], NULL);
    }
    w->count = 0;
}

bool window_swapchain(window *w) {
    VkSurfaceCapabilitiesKHR can;
    TRY(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(w->gpu, w->surface, &can));
    if (can.currentExtent.width != UINT32_MAX) w->size = can.currentExtent;
    forget_images(w);
    w->replaced = w->swapchain;
    uint32_t least = can.minImageCount > 3 ? can.minImageCount : 3;
    VkSwapchainCreateInfoKHR info = {
        INFO(SWAPCHAIN_CREATE_INFO_KHR), .surface = w->surface, .oldSwapchain = w->replaced,
        .minImageCount = can.maxImageCount && least > can.maxImageCount ? can.maxImageCount : least,
        .imageFormat = w->format, .imageColorSpace = VK_COLOR_SPACE_SRGB_NONLINEAR_KHR,
        .imageExtent = w->size, .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                      VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
        .preTransform = can.currentTransform, .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR, .clipped = VK_TRUE};
    TRY(vkCreateSwapchainKHR(w->device, &info, NULL, &w->swapchain));
    uint32_t n = WINDOW_IMAGES;
    TRY(vkGetSwapchainImagesKHR(w->device, w->swapchain, &n, w->images));
    for (; w->count < n; w->count++) {
        VkImageViewCreateInfo view = {INFO(IMAGE_VIEW_CREATE_INFO), .image = w->images[w->count],
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = w->format,
                                      .subresourceRange = whole};
        TRY(vkCreateImageView(w->device, &view, NULL, &w->views[w->count]));
        VkFramebufferCreateInfo frame = {INFO(FRAMEBUFFER_CREATE_INFO), NULL, 0, w->pass, 1,
                                         &w->views[w->count], w->size.width, w->size.height, 1};
        TRY(vkCreateFramebuffer(w->device, &frame, NULL, &w->framebuffers[w->count]));
    }
    return true;
}

void window_drop(window *w) {
    vkDestroySwapchainKHR(w->device, w->replaced, NULL);
    w->replaced = VK_NULL_HANDLE;
}

bool window_wait(window *w, uint32_t slot) {
    TRY(vkWaitForFences(w->device, 1, &w->fences[slot], VK_TRUE, UINT64_MAX));
    return true;
}

VkResult window_acquire(window *w, uint32_t slot, uint32_t *image) {
    VkResult r = vkAcquireNextImageKHR(w->device, w->swapchain, UINT64_MAX, w->acquired[slot],
                                       VK_NULL_HANDLE, image);
    return r == VK_SUBOPTIMAL_KHR ? VK_SUCCESS : r;
}

VkResult window_show(window *w, uint32_t slot, uint32_t image, VkCommandBuffer library) {
    VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    VkCommandBuffer both[2] = {library, w->commands[slot]};
    VkSubmitInfo submit = {INFO(SUBMIT_INFO), NULL, 1, &w->acquired[slot], &stage, 2, both, 1,
                           &w->drawn[image]};
    vkResetFences(w->device, 1, &w->fences[slot]);
    VkResult r = vkQueueSubmit(w->queue, 1, &submit, w->fences[slot]);
    VkPresentInfoKHR present = {INFO(PRESENT_INFO_KHR), NULL, 1, &w->drawn[image], 1, &w->swapchain,
                                &image, NULL};
    return r ? r : vkQueuePresentKHR(w->queue, &present);
}

bool window_run(window *w, VkCommandBuffer commands) {
    VkSubmitInfo submit = {INFO(SUBMIT_INFO), .commandBufferCount = 1, .pCommandBuffers = &commands};
    TRY(vkQueueSubmit(w->queue, 1, &submit, VK_NULL_HANDLE));
    TRY(vkQueueWaitIdle(w->queue));
    return true;
}

void window_copy_photo(window *w, VkCommandBuffer to, uint32_t image) {
    VkImageLayout shown = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, read = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    VkPipelineStageFlags transfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    VkImageMemoryBarrier barrier = {INFO(IMAGE_MEMORY_BARRIER), NULL, 0, VK_ACCESS_TRANSFER_READ_BIT,
                                    shown, read, VK_QUEUE_FAMILY_IGNORED, VK_QUEUE_FAMILY_IGNORED,
                                    w->images[image], whole};
    VkBufferImageCopy region = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                .imageExtent = {w->size.width, w->size.height, 1}};
    vkCmdPipelineBarrier(to, transfer, transfer, 0, 0, NULL, 0, NULL, 1, &barrier);
    vkCmdCopyImageToBuffer(to, w->images[image], read, w->photo, 1, &region);
    barrier.oldLayout = read, barrier.newLayout = shown, barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(to, transfer, VK_PIPELINE_STAGE_HOST_BIT | transfer, 0, 0, NULL, 0, NULL, 1,
                         &barrier);
}

void window_close(window *w) {
    if (w->device) {
        forget_images(w);
        window_drop(w);
        vkDestroySwapchainKHR(w->device, w->swapchain, NULL);
        for (int i = 0; i < WINDOW_IMAGES; i++) vkDestroySemaphore(w->device, w->drawn[i], NULL);
        for (int i = 0; i < WINDOW_SLOTS; i++) {
            vkDestroySemaphore(w->device, w->acquired[i], NULL);
            vkDestroyFence(w->device, w->fences[i], NULL);
        }
        vkDestroyBuffer(w->device, w->photo, NULL);
        vkFreeMemory(w->device, w->photo_memory, NULL);
        vkDestroyRenderPass(w->device, w->pass, NULL);
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
