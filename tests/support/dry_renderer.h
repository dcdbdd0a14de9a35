/* dry_renderer.h: a renderer without a GPU: ordinary memory replaces mapped device memory, and
 * handles are numbers to compare. Tests can read back the data that the host writes for the GPU. */
#ifndef SUPPORT_RENDERER_H
#define SUPPORT_RENDERER_H

#include "renderer.h"
#include "support/blob.h"

#define ROOM (1u << 21)
#define NOISE 0xA5 /* initial content of the buffers */

extern masu_renderer m;
extern masu_scene scene; /* the scene that the renderer was made from */
extern VkCommandBuffer *frames, *loads;
extern unsigned char memory[MASU_ROLE_COUNT][ROOM];
extern masu_blob_camera_key keys[4]; /* the renderer's copy */

/* A blob with these parts (blob.h), 1280x720, two frames in flight, two targets, default rungs.
 * masu_load has not been called. staging 0: resident memory is mapped. */
void make_renderer(uint32_t parts, uint64_t staging);
/* The same with the given rungs; none: the defaults. */
void make_renderer_with(uint32_t parts, uint64_t staging, const masu_rung *rungs, uint32_t count);

/* Bytes and uniforms that the GPU would read. */
const unsigned char *slot_bytes(masu_buffer_id buffer, uint32_t slot);
struct masu_frame_uniforms uniforms(uint32_t slot);

/* Begins the next frame, but in this slot. */
masu_frame_data begin_frame(const masu_frame_desc *frame, uint32_t slot);
masu_result write_frame(const masu_frame_desc *frame, uint32_t slot, masu_detail *detail);
/* Asserts that the frame is written; returns the mask of cascades that it renders. */
uint32_t write_good(const masu_frame_desc *frame, uint32_t slot);

#endif
