/* ray_buffers.h: what a plan holds for VK_KHR_ray_query; src/device/ray_query.h says what for. */
#ifndef MASU_RAY_BUFFERS_H
#define MASU_RAY_BUFFERS_H

#include "plan/plan.h"

/* 1: some of what is traced has holes: the permutation of the shader that looks them up. */
uint32_t masu_ray_masks(const masu_scene *scene);

/* The rows of the buffers, but for the sizes that only the driver knows. */
void masu_ray_buffers(masu_frame_plan *plan);

#endif
