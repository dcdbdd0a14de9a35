/* desc.h: defaults and ranges of the description. masu_desc_resolved replaces zeros by defaults;
 * masu_desc_check requires its result. The ranges of knobs are in quality/knobs.h, the
 * limits in plan/limits.h.
 *
 * Pure functions: no Vulkan calls, no allocation, no state. */
#ifndef MASU_DESC_H
#define MASU_DESC_H

#include "masu.h"

/* masu_desc_resolve (masu.h) without its check of `bytes`. NULL gives all defaults. */
masu_desc masu_desc_resolved(const masu_desc *desc);

/* For a resolved description: the render size of a rung, and whether the rung uses temporal
 * upscaling. */
VkExtent2D masu_render_size(const masu_desc *d, uint32_t r);
int masu_rung_resolves(const masu_desc *d, uint32_t r);
/* Whether some surface of the scene is glossy enough for the rung to trace its reflections. */
int masu_could_trace(const masu_scene *scene, const masu_rung *rung);

/* For a description as given by the host, not resolved. MASU_ERROR_ARGUMENT: a member would
 * silently have no effect, because another one is 0. */
masu_result masu_desc_check_given(const masu_desc *given, masu_detail *detail);
/* MASU_ERROR_ARGUMENT: a field is missing or out of range; `detail` names it. */
masu_result masu_desc_check(const masu_desc *d, masu_detail *detail);

#endif
