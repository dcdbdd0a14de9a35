/* dry_renderer.h: a renderer without a GPU: plain memory stands where device memory would be
 * mapped, and handles are numbers to compare. What the host writes for the GPU can be read back. */
#ifndef SUPPORT_RENDERER_H
#define SUPPORT_RENDERER_H

#include "renderer.h"
#include "support/blob.h"

#define ROOM (1u << 21)
#define NOISE 0xA5 /* what they are filled with */

extern masu_renderer m;
extern masu_scene scene; /* what it was made from */
extern VkCommandBuffer *frames, *loads;
extern unsigned char memory[MASU_ROLE_COUNT][ROOM];
extern masu_blob_camera_key keys[4]; /* the renderer's copy */

/* A blob of those parts (blob.h), 1280x720, two frames in flight, two targets, default
 * rungs; masu_load has not been called. staging 0: resident memory is mapped. */
void make_renderer(uint32_t parts, uint64_t staging);
/* The same with rungs of its own; none: the defaults. */
void make_renderer_with(uint32_t parts, uint64_t staging, const masu_rung *rungs, uint32_t count);

/* Bytes and uniforms as the GPU would see them. */
const unsigned char *slot_bytes(masu_buffer_id buffer, uint32_t slot);
struct masu_frame_uniforms uniforms(uint32_t slot);

/* The next frame, but in that slot. */
masu_frame_data begin_frame(const masu_frame_desc *frame, uint32_t slot);
masu_result write_frame(const masu_frame_desc *frame, uint32_t slot, masu_detail *detail);
/* Asserts that it is written; which cascades it draws. */
uint32_t write_good(const masu_frame_desc *frame, uint32_t slot);

#endif
