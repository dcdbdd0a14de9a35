/* knobs.h: the knobs of a rung as a table: name, place, range, words. What names, writes or reads
 * knobs goes by it, so that none is forgotten.
 *
 * Owns nothing; nothing allocates. */
#ifndef MASU_BENCH_KNOBS_H
#define MASU_BENCH_KNOBS_H

#include "masu.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum masu_knob_kind {
    MASU_KNOB_SCALAR,
    MASU_KNOB_NUMBER,
    MASU_KNOB_WORD,
    MASU_KNOB_REFRESH /* a number for each cascade */
} masu_knob_kind;

/* What a scene must have for a knob to change anything. */
typedef enum masu_knob_use {
    MASU_USE_ALWAYS,
    MASU_USE_SDF,
    MASU_USE_AO,
    MASU_USE_SPECULAR,
    MASU_USE_SHADOWS,
    MASU_USE_LODS,
    MASU_USE_OCCLUDERS,
    MASU_USE_POLYGONS,
    MASU_USE_LIGHTS,
    MASU_USE_UPSCALED,
    MASU_USE_SHARPENED,
    MASU_USE_SHARPEN
} masu_knob_use;

/* Values of a WORD: its place in the list is the enumerator's value. */
typedef struct masu_knob_words {
    const char *prefix; /* of the enumerators, "MASU_EASU_" */
    uint32_t count;
    const char *words[8];
} masu_knob_words;

typedef struct masu_knob {
    const char *name;
    size_t offset;
    masu_knob_kind kind;
    masu_knob_use use;
    const masu_knob_words *words; /* of a WORD */
    double low, high;             /* what masu_init takes, of SCALAR, NUMBER and REFRESH */
    double least;                 /* above 0: from low to it only low */
} masu_knob;

/* Every knob of masu_rung, "scale" first. */
enum { MASU_KNOBS = 30 };
extern const masu_knob masu_knobs[MASU_KNOBS];

size_t masu_knob_bytes(const masu_knob *knob);
bool masu_knob_differs(const masu_knob *knob, const masu_rung *a, const masu_rung *b);
void masu_knob_copy(const masu_knob *knob, masu_rung *to, const masu_rung *from);

double masu_knob_scalar(const masu_knob *knob, const masu_rung *rung);
uint32_t masu_knob_number(const masu_knob *knob, const masu_rung *rung);

/* Its name, and its value as JSON text (a number, "auto", [1, 2, 1, 1]) that reads back as the same
 * value. NULL: there are no more. */
const char *masu_knob_name(uint32_t knob);
void masu_knob_json(uint32_t knob, const masu_rung *rung, char *out, size_t size);

/* The same as a C expression: 0.8f, 64, MASU_EASU_FAST, {1, 2, 1, 1}. */
void masu_knob_c(uint32_t knob, const masu_rung *rung, char *out, size_t size);

#endif
