/* governor_desc.h: defaults and ranges of the governor's fields in a description. */
#ifndef MASU_GOVERNOR_DESC_H
#define MASU_GOVERNOR_DESC_H

#include "masu.h"

#define MASU_GOVERNOR_TARGET_MS 16.67
#define MASU_GOVERNOR_HEADROOM 0.02
#define MASU_GOVERNOR_DWELL 24u

/* Replaces zeros by defaults; does nothing without a governor. */
void masu_governor_defaults(masu_governor_desc *desc, uint32_t rungs);
/* For a description as given, with `rungs` rungs. MASU_ERROR_ARGUMENT: `detail` names the field. */
masu_result masu_governor_check(const masu_governor_desc *desc, uint32_t rungs,
                                masu_detail *detail);

#endif
