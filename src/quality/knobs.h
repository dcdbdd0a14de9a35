/* knobs.h: the knobs of a rung as a table, from MASU_KNOBS (masu_knobs.h): names, ranges and
 * defaults. All code that names, checks, reads or writes knobs uses the table, so a new row is
 * sufficient for a new knob.
 *
 * Constant tables and pure functions. */
#ifndef MASU_QUALITY_KNOBS_H
#define MASU_QUALITY_KNOBS_H

#include "masu.h"

/* Replaces zeros by the defaults of the rows. */
void masu_rung_defaults(masu_rung *rung);

/* MASU_ERROR_ARGUMENT: a knob of rungs[r] is out of range. */
masu_result masu_rung_check(const masu_rung *rung, uint32_t r, masu_detail *detail);

/* For a rung with defaults: RCAS sharpness in stops; below 0 means none. */
static inline float masu_rung_stops(const masu_rung *rung) {
    return rung->sharpness > 0.0f ? rung->sharpness : 0.0f;
}

#endif
