/* ray_buffers.c: see ray_buffers.h. */
#include "plan/ray_buffers.h"

uint32_t masu_ray_masks(const masu_scene *scene) {
    return scene->trace_colors && scene->masks ? 1 : 0;
}

void masu_ray_buffers(masu_frame_plan *plan) {
    masu_buffer_plan *b = plan->buffers;
    VkBufferUsageFlags address = VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    VkBufferUsageFlags input =
        address | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
    VkBufferUsageFlags structure = address | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR;
    VkBufferUsageFlags scratch = address | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    b[MASU_BUFFER_BOTTOM_LEVELS] = (masu_buffer_plan){.name = "bottom levels", .usage = structure};
    b[MASU_BUFFER_TOP_LEVEL] = (masu_buffer_plan){.name = "top level", .usage = structure};
    b[MASU_BUFFER_TOP_SCRATCH] = (masu_buffer_plan){.name = "top level scratch", .usage = scratch};
    b[MASU_BUFFER_RAY_INSTANCES] =
        (masu_buffer_plan){.name = "top level instances", .role = MASU_ROLE_UPLOAD, .usage = input};
    b[MASU_BUFFER_RAY_INDICES] = (masu_buffer_plan){
        .name = "bottom level indices", .usage = input | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    b[MASU_BUFFER_RAY_SCRATCH] =
        (masu_buffer_plan){.name = "bottom level scratch", .usage = scratch};
    if (plan->needs.query) b[MASU_BUFFER_VERTICES].usage |= input;
}
