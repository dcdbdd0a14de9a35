/* device_objects.h: creates the Vulkan objects of a renderer in masu_init and destroys them in
 * masu_destroy. */
#ifndef MASU_DEVICE_OBJECTS_H
#define MASU_DEVICE_OBJECTS_H

#include "base/arena.h"
#include "device/device.h"

/* Arrays in the host block. */
void masu_device_alloc(masu_device *m, masu_arena *arena, const masu_frame_plan *plan);

/* Copies the handles of the host's targets, and points the plan's targets at the copies. */
void masu_set_targets(masu_device *m, const masu_targets *targets);

/* vk, plan and objects are there; all else is made of them. What has been made when a step fails
 * stays for masu_device_destroy. */
masu_result masu_device_create(masu_device *m, const masu_draws *draws, masu_detail *detail);
void masu_device_destroy(masu_device *m);

#endif
