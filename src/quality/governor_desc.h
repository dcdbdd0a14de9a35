/* governor_desc.h: whether the part of a description that speaks of the governor is in range, and its
 * defaults. */
#ifndef MASU_GOVERNOR_DESC_H
#define MASU_GOVERNOR_DESC_H

#include "masu.h"

#define MASU_GOVERNOR_TARGET_MS 16.67
#define MASU_GOVERNOR_HEADROOM 0.02
#define MASU_GOVERNOR_DWELL 24u

/* Fills what is 0 with defaults; without a governor nothing. */
void masu_governor_defaults(masu_governor_desc *desc, uint32_t rungs);
/* As the host gave it, for so many rungs: MASU_ERROR_ARGUMENT, and the detail names the field. */
masu_result masu_governor_check(const masu_governor_desc *desc, uint32_t rungs,
                                masu_detail *detail);

#endif
