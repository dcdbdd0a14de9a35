/* knobs.h: knobs as text: reads them from JSON and from names of settings, and writes JSON, C, help
 * and documents. Everything is derived from the library's table (masu_knob_table), so that no knob
 * is missing.
 *
 * Owns nothing; nothing allocates. */
#ifndef MASU_SETTINGS_KNOBS_H
#define MASU_SETTINGS_KNOBS_H

#include "masu.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The knob whose name is the first `length` characters, or NULL. */
const masu_knob *masu_knob_find(const char *name, size_t length);

bool masu_knob_differs(const masu_knob *k, const masu_rung *a, const masu_rung *b);
void masu_knob_copy(const masu_knob *k, masu_rung *to, const masu_rung *from);

/* A value as JSON (a number, "auto", [1, 2, 1, 1]), as a C expression (0.8f, 64, MASU_EASU_FAST,
 * {1, 2, 1, 1}), and as in names of settings (0.8, fast, 1-2-1-1): each reads back as the same
 * value. */
void masu_knob_json(const masu_knob *k, const masu_rung *rung, char *out, size_t size);
void masu_knob_c(const masu_knob *k, const masu_rung *rung, char *out, size_t size);
void masu_knob_text(const masu_knob *k, const masu_rung *rung, char *out, size_t size);

/* The accepted values: "a number from 0 to 1", "one of auto, off, on". */
void masu_knob_range(const masu_knob *k, char *out, size_t size);

/* A JSON value as text for messages: "3", "'high'", "an array", "nothing". Returns `out`. */
const char *masu_json_given(const json_t *value, char *out, size_t size);

/* Reads the format of masu_knob_json. On false `error` is "expected ..., found ..." and the rung is
 * unchanged. */
bool masu_knob_from_json(const masu_knob *k, const json_t *value, masu_rung *rung, char *error,
                         size_t error_size);

/* Reads the format of masu_knob_text. Returns the end of the value, or NULL if `text` does not
 * start with an accepted value. */
const char *masu_knob_from_text(const masu_knob *k, const char *text, masu_rung *rung);

/* Prints all knobs and limits, as a page for a terminal, or as docs/knobs.md. */
void masu_knobs_print(FILE *to);
void masu_knobs_document(FILE *to);

#endif
