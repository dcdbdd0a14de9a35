/* device_objects.h: creates a renderer's Vulkan objects in masu_init and destroys them in
 * masu_destroy. */
#ifndef MASU_DEVICE_OBJECTS_H
#define MASU_DEVICE_OBJECTS_H

#include "base/arena.h"
#include "device/device.h"

/* Allocates the arrays in the host memory block. */
void masu_device_alloc(masu_device *m, masu_arena *arena, const masu_frame_plan *plan);

/* Copies the handles of the host's targets and points the plan's targets to the copies. */
void masu_set_targets(masu_device *m, const masu_targets *targets);

/* Creates all objects; m->vk, m->plan and m->objects must be set. If a step fails, the objects that
 * exist remain valid for masu_device_destroy. */
masu_result masu_device_create(masu_device *m, const masu_draws *draws, masu_detail *detail);
void masu_device_destroy(masu_device *m);

#endif
