/* bind.h: device memory under the planned images and buffers, their views, and where the host sees
 * them. */
#ifndef MASU_BIND_H
#define MASU_BIND_H

#include "device/device.h"

/* Memory is allocated or taken from the host; what fails is named. */
masu_result masu_bind_memory(masu_device *m, masu_detail *detail);
masu_result masu_create_views(masu_device *m, masu_detail *detail);

/* Host pointer to a buffer's first byte, of a slot where it has slots. NULL where it is not
 * host-visible. */
unsigned char *masu_buffer_pointer(const masu_device *m, masu_buffer_id buffer, uint32_t slot);

/* Gives a Vulkan object the name of its row, where labels are on. */
void masu_name(const masu_device *m, VkObjectType type, uint64_t handle, const char *name);
/* Handles are pointers on 64-bit targets and integers on 32-bit ones; both convert through this. */
#define MASU_HANDLE(h) ((uint64_t)(h))

#endif
