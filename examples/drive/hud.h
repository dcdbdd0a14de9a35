/* hud.h: words over the picture, by the host's own command buffer. */
#ifndef DRIVE_HUD_H
#define DRIVE_HUD_H

#include "car.h"
#include "window.h"

/* Records a whole render pass over the image. paused: says so in the middle. */
void hud_record(const window *w, VkCommandBuffer to, uint32_t image, const race *r, bool paused, uint32_t rung);

#endif
