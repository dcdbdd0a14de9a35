/* barriers.h: the barriers between passes, derived from what the rows of the table read and write. */
#ifndef MASU_BARRIERS_H
#define MASU_BARRIERS_H

#include "device/recorder.h"

/* What a row's access asks for. */
masu_use masu_use_of(masu_usage usage, masu_pass_kind kind);
/* The image behind an id, in this recording. */
VkImage masu_recorded_image(const masu_recorder *rec, masu_image_id id);
/* Of all of an image. */
VkImageMemoryBarrier masu_image_barrier(const masu_recorder *rec, masu_image_id id,
                                        VkAccessFlags from, const masu_use *to,
                                        VkImageLayout old_layout);
/* Records what a pass has to wait for, and notes what it does. */
void masu_barrier_before(masu_recorder *rec, uint32_t pass);
void masu_memory_barrier(masu_recorder *rec, VkPipelineStageFlags from, VkAccessFlags from_access,
                         VkPipelineStageFlags to, VkAccessFlags to_access);
/* Images that outlive the frame: as it finds them, and as it has to leave them. */
void masu_find_persistent(masu_recorder *rec);
void masu_leave_persistent(masu_recorder *rec);

#endif
