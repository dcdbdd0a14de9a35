/* governor_desc.h: whether the part of a description that speaks of the governor is in range. */
#ifndef MASU_GOVERNOR_DESC_H
#define MASU_GOVERNOR_DESC_H

#include "masu.h"

/* As the host gave it, for so many rungs: MASU_ERROR_ARGUMENT, and the detail names the field. */
masu_result masu_governor_check(const masu_governor_desc *desc, uint32_t rungs,
                                masu_detail *detail);

#endif
