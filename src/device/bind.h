/* bind.h: binds device memory to the planned images and buffers, creates views, and returns host
 * pointers. */
#ifndef MASU_BIND_H
#define MASU_BIND_H

#include "device/device.h"

/* Allocates the memory blocks or accepts the host's. On failure `detail` names the block or
 * object. */
masu_result masu_bind_memory(masu_device *m, masu_detail *detail);
masu_result masu_create_views(masu_device *m, masu_detail *detail);

/* Host pointer to the first byte of a buffer, or of its slot `slot` if it has one per frame in
 * flight. NULL if the memory is not host-visible. */
unsigned char *masu_buffer_pointer(const masu_device *m, masu_buffer_id buffer, uint32_t slot);

/* Gives a Vulkan object its table row's name if debug labels are enabled. */
void masu_name(const masu_device *m, VkObjectType type, uint64_t handle, const char *name);
/* Handles are pointers on 64-bit targets and integers on 32-bit targets. */
#define MASU_HANDLE(h) ((uint64_t)(h))

#endif
