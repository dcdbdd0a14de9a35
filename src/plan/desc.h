/* desc.h: the description that a host gives: its defaults and its ranges. masu_desc_resolved turns
 * zeros into defaults; the check takes what it returns. Knobs have theirs in quality/knobs.h,
 * limits in plan/limits.h.
 *
 * Pure functions: no Vulkan call, no allocation, nothing kept. */
#ifndef MASU_DESC_H
#define MASU_DESC_H

#include "masu.h"

/* masu_desc_resolve (masu.h) without a check of `bytes`; NULL: all defaults. */
masu_desc masu_desc_resolved(const masu_desc *desc);

/* Of a resolved description: what a rung is shaded at, and whether it is resolved over frames. */
VkExtent2D masu_render_size(const masu_desc *d, uint32_t r);
int masu_rung_resolves(const masu_desc *d, uint32_t r);
/* Whether a surface of the scene is glossy enough for a rung to trace its reflections. */
int masu_could_trace(const masu_scene *scene, const masu_rung *rung);

/* Of a description as the host gives it, not resolved. MASU_ERROR_ARGUMENT: a member would silently
 * have no effect, because another one is 0. */
masu_result masu_desc_check_given(const masu_desc *given, masu_detail *detail);
/* MASU_ERROR_ARGUMENT: a field is missing or out of its range, and the detail names it. */
masu_result masu_desc_check(const masu_desc *d, masu_detail *detail);

#endif
