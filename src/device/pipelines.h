/* pipelines.h: layouts, samplers, pipelines, render passes and framebuffers for all passes of a
 * plan. */
#ifndef MASU_PIPELINES_H
#define MASU_PIPELINES_H

#include "device/device.h"

/* If a function fails, the caller destroys the objects created so far. */

/* Creates the layouts of all passes, and the samplers. */
masu_result masu_create_layouts(masu_device *m, masu_detail *detail);

/* Creates the pipelines of a pass. A graphics pass also gets its render pass and framebuffer: image
 * views must exist. A compute pass gets the pipeline for rungs in which it writes the final image
 * (`last`), or the one for the other rungs. Cascades share the objects of MASU_PASS_CASCADE_0. */
masu_result masu_create_pipelines(masu_device *m, uint32_t pass, int last, masu_detail *detail);

#endif
