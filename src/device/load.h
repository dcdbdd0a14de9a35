/* load.h: the scene on its way to the device: once, in chunks of at most the staging buffer's size.
 *
 *   resident buffers    copied out of the staging buffer; written in place where the host can
 *   textures            copied, a chunk some rows of blocks (src/scene/texture.h)
 *   structures          of ray queries: built of what has been copied
 *   kept images         those that frames leave to each other get their layout
 *
 * A command buffer for each chunk is recorded beforehand; masu_load fills the staging buffer and hands
 * them out one after the other. Only making them can fail. */
#ifndef MASU_LOAD_H
#define MASU_LOAD_H

#include "device/device.h"

/* How many chunks a plan needs. */
uint32_t masu_load_chunks(const masu_frame_plan *plan);

/* One chunk of a buffer: `bytes` of it, which has `whole`, from `offset`; none beyond those of
 * buffers. */
typedef struct masu_chunk {
    masu_buffer_id buffer;
    uint64_t offset, bytes, whole;
} masu_chunk;
masu_chunk masu_load_chunk(const masu_frame_plan *plan, uint32_t index);

/* Records all chunks; their command buffers are allocated. */
masu_result masu_load_record(masu_device *m, masu_detail *detail);

/* Fills the staging buffer with the next chunk and returns what copies it; NULL: it was the last. */
VkCommandBuffer masu_load_next(masu_device *m);

#endif
