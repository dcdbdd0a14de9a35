/* vk.h: the Vulkan functions the library calls, loaded through the host's vkGetInstanceProcAddr.
 *
 * One table per renderer: no global loader that could collide with the host's, and a test can put
 * its own wrappers in between. Every function is Vulkan 1.0 core but the debug labels, which are
 * NULL where the extension is off, and those of ray queries, which are NULL where the host does not
 * offer them or the description does not want them. */
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

/* All of them or none. */
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
    VkPhysicalDeviceAccelerationStructurePropertiesKHR rays; /* where the functions are there */
} masu_vk;

/* Loads the table and checks the device floor: API version, queue family, formats, limits. */
masu_result masu_vk_load(const masu_desc *desc, masu_vk *vk, masu_detail *detail);

#endif
