/* api_governor.h: the use of the governor in api.c: passes on the times of finished frames and
 * requests the rung of the next frame. */
#ifndef MASU_API_GOVERNOR_H
#define MASU_API_GOVERNOR_H

#include "renderer.h"

/* The output size to which scales of rungs refer: of the first viewport, or of the whole output. */
VkExtent2D masu_governed_output(const masu_renderer *m);
void masu_governed_start(masu_renderer *m);
/* Passes the times of the frame that last used the slot to the governor, and chooses the rung of
 * the next frame unless the host has. */
void masu_governed_pick(masu_renderer *m, masu_frame_data *f);
/* Notifies the governor that the frame is submitted at its rung, chosen by the governor or by the
 * host. */
void masu_governed_begin(masu_renderer *m, const masu_frame_data *f, uint32_t given);

#endif
