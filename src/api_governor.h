/* governed.h: what masu.c does with the governor of a renderer that has one: it is told of finished frames
 * and asked for the rung of the next. */
#ifndef MASU_GOVERNED_H
#define MASU_GOVERNED_H

#include "renderer.h"

/* The size that its rungs are parts of: that of the first viewport, or of the whole. */
VkExtent2D masu_governed_output(const masu_renderer *m);
void masu_governed_start(masu_renderer *m);
/* The governor learns of the frame whose slot comes free, and says at which rung the next is drawn where
 * the host leaves it open. */
void masu_governed_pick(masu_renderer *m, masu_frame_data *f);
/* The frame is handed out, at a rung that was picked or that the host gave. */
void masu_governed_begin(masu_renderer *m, const masu_frame_data *f, uint32_t given);

#endif
