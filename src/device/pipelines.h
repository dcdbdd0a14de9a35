/* pipelines.h: layouts, samplers, pipelines, render passes and framebuffers for all passes of a
 * plan. */
#ifndef MASU_PIPELINES_H
#define MASU_PIPELINES_H

#include "device/device.h"

/* Image views must exist. If a step fails, the caller destroys the objects created so far. */
masu_result masu_create_pipelines(masu_device *m, masu_detail *detail);

#endif
