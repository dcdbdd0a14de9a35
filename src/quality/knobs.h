/* knobs.h: the knobs of a rung as data, out of MASU_KNOBS (masu_knobs.h): what is there to be turned, within
 * what, and what a 0 becomes. Whatever names, checks, reads or writes knobs walks the table, so that a
 * new row is known everywhere.
 *
 * Owns nothing; a table of constants, and pure functions of it. */
#ifndef MASU_QUALITY_KNOBS_H
#define MASU_QUALITY_KNOBS_H

#include "masu.h"

/* Fills in what the rows say that a 0 becomes. */
void masu_rung_defaults(masu_rung *rung);

/* MASU_ERROR_ARGUMENT: a knob of rungs[r] has a value that it does not take. */
masu_result masu_rung_check(const masu_rung *rung, uint32_t r, masu_detail *detail);

/* Of a rung with its defaults: below 0 is none. */
static inline float masu_rung_stops(const masu_rung *rung) {
    return rung->sharpness > 0.0f ? rung->sharpness : 0.0f;
}

#endif
