#!/bin/sh
# cdef.sh [INCLUDE]: the declarations of masu.h as plain C: preprocessed, without attributes, and with the types of
# Vulkan that they use instead of its headers. For generators of bindings that have no preprocessor (LuaJIT's ffi.cdef
# takes it as it is), and for package/abi.sh. The handles of Vulkan are those of 64-bit machines.
set -eu
include=${1:-include}
cat << 'END'
typedef struct VkInstance_T *VkInstance;
typedef struct VkPhysicalDevice_T *VkPhysicalDevice;
typedef struct VkDevice_T *VkDevice;
typedef struct VkCommandBuffer_T *VkCommandBuffer;
typedef struct VkDeviceMemory_T *VkDeviceMemory;
typedef struct VkImage_T *VkImage;
typedef struct VkImageView_T *VkImageView;
typedef struct VkPipelineCache_T *VkPipelineCache;
typedef int32_t VkResult;
typedef int32_t VkFormat;
typedef int32_t VkImageLayout;
typedef uint32_t VkImageUsageFlags;
typedef uint64_t VkDeviceSize;
typedef struct VkExtent2D { uint32_t width, height; } VkExtent2D;
typedef struct VkOffset2D { int32_t x, y; } VkOffset2D;
typedef struct VkRect2D { VkOffset2D offset; VkExtent2D extent; } VkRect2D;
typedef struct VkAllocationCallbacks VkAllocationCallbacks;
typedef void (*PFN_vkVoidFunction)(void);
typedef PFN_vkVoidFunction (*PFN_vkGetInstanceProcAddr)(VkInstance instance, const char *name);
END
${CC:-cc} -std=c11 -E -I"$include" "$include/masu.h" | awk '
    /^# [0-9]+ "/ { ours = $3 ~ /\/masu[a-z_]*\.h"$/; next }
    ours && NF { gsub(/__attribute__\(\([a-z_]+(\("default"\))?\)\) */, ""); gsub(/[ \t]+/, " "); print }'
