/* load.h: the scene on its way to the device: once, in chunks of at most the staging buffer's size, which
 * desc.load_step bounds.
 *
 *   resident buffers    copied out of the staging buffer; written in place where the host can, all at once or in
 *                       steps of desc.load_step bytes
 *   textures            copied, a chunk some rows of blocks (src/scene/texture.h)
 *   structures          of ray queries: built of what has been copied, some meshes in a chunk
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

typedef struct masu_load_step {
    VkCommandBuffer commands; /* to be submitted; NULL: nothing is */
    uint64_t bytes;           /* written in this step */
    int more;                 /* another step is to follow */
} masu_load_step;

/* The next step: what is written in place, or the staging buffer filled with a chunk. */
masu_load_step masu_load_next(masu_device *m);

/* Bytes of all steps. */
uint64_t masu_load_bytes(const masu_device *m);

#endif
