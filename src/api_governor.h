/* api_governor.h: how api.c uses the governor of a renderer: it passes on the times of finished
 * frames and requests the rung of the next frame. */
#ifndef MASU_API_GOVERNOR_H
#define MASU_API_GOVERNOR_H

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
