/* knobs.h: knobs as text: out of JSON and names of settings, into JSON, C, help and documents. What
 * there is to be written is the library's table (masu_knob_table), so that none is forgotten.
 *
 * Owns nothing; nothing allocates. */
#ifndef MASU_SETTINGS_KNOBS_H
#define MASU_SETTINGS_KNOBS_H

#include "masu.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The one whose name is the first `length` characters, or NULL. */
const masu_knob *masu_knob_find(const char *name, size_t length);

bool masu_knob_differs(const masu_knob *k, const masu_rung *a, const masu_rung *b);
void masu_knob_copy(const masu_knob *k, masu_rung *to, const masu_rung *from);

/* A value as JSON (a number, "auto", [1, 2, 1, 1]), as a C expression (0.8f, 64, MASU_EASU_FAST,
 * {1, 2, 1, 1}), and as names of settings have it (0.8, fast, 1-2-1-1): each reads back as the same
 * value. */
void masu_knob_json(const masu_knob *k, const masu_rung *rung, char *out, size_t size);
void masu_knob_c(const masu_knob *k, const masu_rung *rung, char *out, size_t size);
void masu_knob_text(const masu_knob *k, const masu_rung *rung, char *out, size_t size);

/* What it takes: "a number from 0 to 1", "one of auto, off, on". */
void masu_knob_range(const masu_knob *k, char *out, size_t size);

/* What a JSON value is, as messages say it: "3", "'high'", "an array", "nothing". Returns `out`. */
const char *masu_json_given(const json_t *value, char *out, size_t size);

/* One knob as masu_knob_json writes it. False: `error` says "expected ..., found ..."; the rung is
 * as before. */
bool masu_knob_from_json(const masu_knob *k, const json_t *value, masu_rung *rung, char *error,
                         size_t error_size);

/* The same as masu_knob_text writes it. The end of the value, or NULL: `text` begins with none that
 * the knob takes. */
const char *masu_knob_from_text(const masu_knob *k, const char *text, masu_rung *rung);

/* All knobs and limits, as a page to read in a terminal, or as docs/knobs.md. */
void masu_knobs_print(FILE *to);
void masu_knobs_document(FILE *to);

#endif
