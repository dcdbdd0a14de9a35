/* barriers.h: barriers between passes, derived from the accesses in the pass table. */
#ifndef MASU_BARRIERS_H
#define MASU_BARRIERS_H

#include "device/recorder.h"

/* Stages, access and layout that an access of a pass needs. */
masu_use masu_use_of(masu_usage usage, masu_pass_kind kind);
/* The Vulkan image of an id in this recording; the target depends on the recording. */
VkImage masu_recorded_image(const masu_recorder *rec, masu_image_id id);
/* Barrier over all layers of an image. */
VkImageMemoryBarrier masu_image_barrier(const masu_recorder *rec, masu_image_id id,
                                        VkAccessFlags from, const masu_use *to,
                                        VkImageLayout old_layout);
/* Records the barrier that a pass needs, if any, and updates the state of its images and
 * buffers. */
void masu_barrier_before(masu_recorder *rec, uint32_t pass);
void masu_memory_barrier(masu_recorder *rec, VkPipelineStageFlags from, VkAccessFlags from_access,
                         VkPipelineStageFlags to, VkAccessFlags to_access);
/* Images that outlive the frame: set their initial state, and return them to the shader-read layout
 * at the end of the recording. */
void masu_find_persistent(masu_recorder *rec);
void masu_leave_persistent(masu_recorder *rec);

#endif
