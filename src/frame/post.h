/* post.h: effects on the image (desc.post): the host's values and colour table of a frame, which
 * are written to the frame's slot. Empty without desc.post. */
#ifndef MASU_FRAME_POST_H
#define MASU_FRAME_POST_H

#include "frame/frame_data.h"

typedef struct masu_post_state {
    uint32_t *lut; /* the colour table, packed as the device reads it */
    uint32_t size; /* points per axis; 0: none */
    masu_post last; /* values of the previous frame */
    uint32_t lut_changes; /* times that the table was set */
    uint32_t changes;     /* of the image: times that values or table changed */
    uint32_t slot_changes[MASU_MAX_FLIGHT]; /* 1 + lut_changes of the table in the slot; 0: none */
} masu_post_state;

void masu_post_alloc(masu_post_state *s, masu_arena *arena, const masu_frame_plan *plan);

/* masu_lut_set of the public header. */
masu_result masu_post_set_lut(masu_post_state *s, const masu_frame_plan *plan, const float *colors,
                              uint32_t size, masu_detail *detail);

/* Checks the values of a frame. */
masu_result masu_post_read(const masu_frame_data *f, masu_detail *detail);
/* Writes them, and the table if it has changed. The camera must be in the uniforms. */
void masu_post_write(masu_post_state *s, const masu_frame_data *f);

#endif
