/* load.h: uploads the scene to the device, in chunks of at most the size of the staging buffer,
 * which desc.load_step bounds.
 *
 *   resident buffers    copied from the staging buffer; if host-visible, written directly, all at
 *                       once or in steps of desc.load_step bytes
 *   textures            copied, some rows of texel blocks per chunk (src/scene/texture.h)
 *   structures          ray queries only: bottom-level structures, built from the copied data,
 *                       some meshes per chunk
 *   persistent images   transitioned to the layout that frames expect
 *
 * Each chunk has a command buffer, recorded in masu_init. masu_load fills the staging buffer and
 * returns the command buffers one by one. Only the recording can fail. */
#ifndef MASU_LOAD_H
#define MASU_LOAD_H

#include "device/device.h"

/* Number of chunks that a plan needs. */
uint32_t masu_load_chunks(const masu_frame_plan *plan);

/* Chunk `index`: `bytes` bytes from `offset` on, of a buffer with `whole` bytes. All 0 for chunks
 * that copy no buffer. */
typedef struct masu_chunk {
    masu_buffer_id buffer;
    uint64_t offset, bytes, whole;
} masu_chunk;
masu_chunk masu_load_chunk(const masu_frame_plan *plan, uint32_t index);

/* Records all chunks into m->loads, which are allocated already. */
masu_result masu_load_record(masu_device *m, masu_detail *detail);

typedef struct masu_load_step {
    VkCommandBuffer commands; /* to submit, or NULL */
    uint64_t bytes;           /* written in this step */
    int more;                 /* whether another step follows */
} masu_load_step;

/* Next step: writes resident buffers directly, or fills the staging buffer with the next chunk. */
masu_load_step masu_load_next(masu_device *m);

/* Total bytes over all steps. */
uint64_t masu_load_bytes(const masu_device *m);

#endif
