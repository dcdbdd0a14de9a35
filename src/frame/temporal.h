/* temporal.h: what a rung with `temporal` knows of the frames before: where in its pixels each looks, and which
 * history the previous one has left. Host state of a few words; nothing here fails. */
#ifndef MASU_TEMPORAL_H
#define MASU_TEMPORAL_H

#include "frame/frame_data.h"

typedef struct masu_temporal {
    int kept;         /* the previous frame has written one, */
    uint32_t size[2]; /* at this render size */
} masu_temporal;

/* By how much beside the middle of its pixels the frame looks, in pixels of the render size, within half of one:
 * Halton's sequence of bases 2 and 3, of which 8 samples fall into each pixel of the output. 0 of a rung without. */
void masu_temporal_jitter(const masu_frame_data *f, float jitter[2]);

/* The history of a frame into its uniforms. */
void masu_temporal_read(masu_temporal *t, masu_frame_data *f);

#endif
