/* surface.h: selects format, transform and present mode of a swapchain whose images are targets of
 * Masu, from the values that the surface supports. docs/embedding.md (Swapchain) has the reasons.
 * Pure functions: the caller queries the surface. */
#ifndef EXAMPLES_SURFACE_H
#define EXAMPLES_SURFACE_H

#include <stdbool.h>
#include <vulkan/vulkan_core.h>

/* An 8-bit format of the list: UNORM, or sRGB if there is no UNORM or `srgb` is set. Both receive
 * the same bytes; sRGB costs one more image. VK_FORMAT_UNDEFINED: none. */
static inline VkFormat surface_format(const VkSurfaceFormatKHR *list, uint32_t count, bool srgb) {
    static const VkFormat unorm[] = {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM};
    static const VkFormat encoded[] = {VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_SRGB};
    for (int round = 0; round < 2; round++) {
        const VkFormat *wanted = (round == 0) != srgb ? unorm : encoded;
        for (uint32_t k = 0; k < 2; k++)
            for (uint32_t i = 0; i < count; i++)
                if (list[i].format == wanted[k] &&
                    list[i].colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
                    return wanted[k];
    }
    return VK_FORMAT_UNDEFINED;
}

/* Masu renders unrotated images: identity, so that the compositor rotates them. If the surface
 * supports only its current transform, the host must rotate the image itself. */
static inline VkSurfaceTransformFlagBitsKHR surface_transform(const VkSurfaceCapabilitiesKHR *can) {
    VkSurfaceTransformFlagBitsKHR identity = VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR;
    return can->supportedTransforms & identity ? identity : can->currentTransform;
}

/* With `paced` FIFO, which every surface has; else the mode with the lowest latency: MAILBOX,
 * IMMEDIATE (tears). */
static inline VkPresentModeKHR surface_mode(const VkPresentModeKHR *list, uint32_t count,
                                            bool paced) {
    VkPresentModeKHR best = VK_PRESENT_MODE_FIFO_KHR;
    for (uint32_t i = 0; i < count && !paced; i++) {
        if (list[i] == VK_PRESENT_MODE_MAILBOX_KHR) return list[i];
        if (list[i] == VK_PRESENT_MODE_IMMEDIATE_KHR) best = list[i];
    }
    return best;
}

#endif
