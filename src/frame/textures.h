/* textures.h: live textures (desc.reserve.textures): the texels that the host writes between two
 * frames, which a pass of the next frame copies to the image. */
#ifndef MASU_TEXTURES_H
#define MASU_TEXTURES_H

#include "frame/frame_data.h"

/* Writes for the next frame, whose slot already holds them and the texels. */
typedef struct masu_textures {
    uint32_t count, words;  /* writes; texels */
    uint32_t width, height; /* of the largest rectangle */
} masu_textures;

/* masu_texture_write. */
masu_result masu_textures_add(masu_textures *t, const masu_device *device,
                              const masu_timeline *timeline, uint32_t texture, const VkRect2D *rect,
                              const void *texels, uint32_t row_bytes, masu_detail *detail);

/* Writes the number of writes to the slot, and begins with none for the frame after this one. */
void masu_textures_write_frame(masu_textures *t, const masu_frame_data *f);

#endif
