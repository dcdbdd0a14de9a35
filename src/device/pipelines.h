/* pipelines.h: layouts, samplers, pipelines, render passes and framebuffers of all passes of a plan. */
#ifndef MASU_PIPELINES_H
#define MASU_PIPELINES_H

#include "device/device.h"

/* Views come before. What has been made when a step fails is the caller's to destroy. */
masu_result masu_create_pipelines(masu_device *m, masu_detail *detail);

#endif
