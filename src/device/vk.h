/* vk.h: the Vulkan functions that the library calls, loaded by the host's vkGetInstanceProcAddr.
 *
 * Each renderer has its own table: no global loader can conflict with the host's, and a test can
 * insert wrappers. All functions are Vulkan 1.0 or 1.1 core, except the debug labels, which are
 * NULL if the extension is disabled, and the ray query functions, which are NULL if the host does
 * not enable them or the description does not use them. */
#ifndef MASU_VK_H
#define MASU_VK_H

#include "masu.h"

#define MASU_VK_INSTANCE(X)                                                                        \
    X(GetDeviceProcAddr)                                                                           \
    X(GetPhysicalDeviceProperties)                                                                 \
    X(GetPhysicalDeviceMemoryProperties)                                                           \
    X(GetPhysicalDeviceFormatProperties)                                                           \
    X(GetPhysicalDeviceQueueFamilyProperties)

#define MASU_VK_DEVICE(X)                                                                          \
    X(AllocateCommandBuffers)                                                                      \
    X(AllocateDescriptorSets)                                                                      \
    X(AllocateMemory)                                                                              \
    X(BeginCommandBuffer)                                                                          \
    X(BindBufferMemory)                                                                            \
    X(BindImageMemory)                                                                             \
    X(CmdBeginRenderPass)                                                                          \
    X(CmdBindDescriptorSets)                                                                       \
    X(CmdBindIndexBuffer)                                                                          \
    X(CmdBindPipeline)                                                                             \
    X(CmdBindVertexBuffers)                                                                        \
    X(CmdBlitImage)                                                                                \
    X(CmdClearColorImage)                                                                          \
    X(CmdCopyBuffer)                                                                               \
    X(CmdCopyBufferToImage)                                                                        \
    X(CmdCopyImage)                                                                                \
    X(CmdCopyImageToBuffer)                                                                        \
    X(CmdCopyQueryPoolResults)                                                                     \
    X(CmdDispatch)                                                                                 \
    X(CmdDispatchIndirect)                                                                         \
    X(CmdDraw)                                                                                     \
    X(CmdDrawIndirect)                                                                             \
    X(CmdDrawIndexedIndirect)                                                                      \
    X(CmdEndRenderPass)                                                                            \
    X(CmdFillBuffer)                                                                               \
    X(CmdNextSubpass)                                                                              \
    X(CmdPipelineBarrier)                                                                          \
    X(CmdPushConstants)                                                                            \
    X(CmdResetQueryPool)                                                                           \
    X(CmdSetScissor)                                                                               \
    X(CmdSetViewport)                                                                              \
    X(CmdWriteTimestamp)                                                                           \
    X(CreateBuffer)                                                                                \
    X(CreateCommandPool)                                                                           \
    X(CreateComputePipelines)                                                                      \
    X(CreateDescriptorPool)                                                                        \
    X(CreateDescriptorSetLayout)                                                                   \
    X(CreateFramebuffer)                                                                           \
    X(CreateGraphicsPipelines)                                                                     \
    X(CreateImage)                                                                                 \
    X(CreateImageView)                                                                             \
    X(CreatePipelineLayout)                                                                        \
    X(CreateQueryPool)                                                                             \
    X(CreateRenderPass)                                                                            \
    X(CreateSampler)                                                                               \
    X(CreateShaderModule)                                                                          \
    X(DestroyBuffer)                                                                               \
    X(DestroyCommandPool)                                                                          \
    X(DestroyDescriptorPool)                                                                       \
    X(DestroyDescriptorSetLayout)                                                                  \
    X(DestroyFramebuffer)                                                                          \
    X(DestroyImage)                                                                                \
    X(DestroyImageView)                                                                            \
    X(DestroyPipeline)                                                                             \
    X(DestroyPipelineLayout)                                                                       \
    X(DestroyQueryPool)                                                                            \
    X(DestroyRenderPass)                                                                           \
    X(DestroySampler)                                                                              \
    X(DestroyShaderModule)                                                                         \
    X(EndCommandBuffer)                                                                            \
    X(FreeMemory)                                                                                  \
    X(GetBufferMemoryRequirements)                                                                 \
    X(GetImageMemoryRequirements)                                                                  \
    X(MapMemory)                                                                                   \
    X(ResetCommandBuffer)                                                                          \
    X(UpdateDescriptorSets)

#define MASU_VK_OPTIONAL(X)                                                                        \
    X(CmdBeginDebugUtilsLabelEXT)                                                                  \
    X(CmdEndDebugUtilsLabelEXT)                                                                    \
    X(SetDebugUtilsObjectNameEXT)

/* Either all are loaded or none. */
#define MASU_VK_RAYS(X)                                                                            \
    X(CmdBuildAccelerationStructuresKHR)                                                           \
    X(CreateAccelerationStructureKHR)                                                              \
    X(DestroyAccelerationStructureKHR)                                                             \
    X(GetAccelerationStructureBuildSizesKHR)                                                       \
    X(GetAccelerationStructureDeviceAddressKHR)                                                    \
    X(GetBufferDeviceAddressKHR)

typedef struct masu_vk {
#define MASU_VK_MEMBER(name) PFN_vk##name name;
    MASU_VK_INSTANCE(MASU_VK_MEMBER)
    MASU_VK_DEVICE(MASU_VK_MEMBER)
    MASU_VK_OPTIONAL(MASU_VK_MEMBER)
    MASU_VK_RAYS(MASU_VK_MEMBER)
#undef MASU_VK_MEMBER
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    const VkAllocationCallbacks *allocator;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkQueueFamilyProperties queue_family;
    /* if the ray query functions are loaded */
    VkPhysicalDeviceAccelerationStructurePropertiesKHR rays;
} masu_vk;

/* Extensions that a Vulkan 1.0 device needs: parts of Vulkan 1.1. */
#define MASU_VK_1_0_EXTENSIONS 3u
extern const char *const masu_vk_1_0_extensions[MASU_VK_1_0_EXTENSIONS];

/* Bit e is set if names[e] is among the first 512 extensions of the device; count <= 32. */
uint32_t masu_vk_find_extensions(const masu_vk *vk, PFN_vkGetInstanceProcAddr get_proc,
                                 const char *const *names, uint32_t count);

/* Loads the functions of the instance and checks the device floor: API version, queue family,
 * formats, limits. Needs no device. */
masu_result masu_vk_load_physical(const masu_desc *desc, masu_vk *vk, masu_detail *detail);
/* Sets vk->rays: limits of acceleration structures. Needs no device. */
masu_result masu_vk_load_ray_limits(const masu_desc *desc, masu_vk *vk, masu_detail *detail);
/* The same as masu_vk_load_physical, and the functions of the device. */
masu_result masu_vk_load(const masu_desc *desc, masu_vk *vk, masu_detail *detail);

#endif
