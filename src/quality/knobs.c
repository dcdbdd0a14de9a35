/* knobs.c: see knobs.h. */
#include "quality/knobs.h"

#include "base/error.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* ---- The table ------------------------------------------------------------------------------- */

#define WORD_ROW(name, value, word, text) {word, #name, text, value},
static const masu_word switch_words[] = {MASU_SWITCH_WORDS(WORD_ROW)};
#ifdef MASU_LAB
static const masu_word march_words[] = {MASU_MARCH_WORDS(WORD_ROW)};
#endif
static const masu_word easu_words[] = {MASU_EASU_WORDS(WORD_ROW)};
static const masu_word aa_words[] = {MASU_AA_WORDS(WORD_ROW)};

#define SAME_VALUE(name, value, ...)                                                               \
    _Static_assert(name == (value), #name " is not that of the table: make docs-tables");
MASU_SWITCH_WORDS(SAME_VALUE)
MASU_EASU_WORDS(SAME_VALUE)
MASU_AA_WORDS(SAME_VALUE)

/* Properties of a row that follow from its C type: kind, and the names of enum values. */
#define KIND_float MASU_KNOB_FLOAT
#define KIND_uint32_t MASU_KNOB_COUNT
#define KIND_masu_per_cascade MASU_KNOB_COUNT
#define WORDS_masu_switch switch_words
#define WORDS_masu_march march_words
#define WORDS_masu_easu easu_words
#define WORDS_masu_aa aa_words

#define USE_TEXTS(name, where, missing)                                                            \
    static const char where_##name[] = where, missing_##name[] = missing;
MASU_KNOB_USES(USE_TEXTS)

/* Every value has four bytes, independent of its type. */
#define FIELD(type, name)                                                                          \
    .offset = offsetof(masu_rung, name), .values = sizeof(((masu_rung *)0)->name) / 4
#define NUMBER_ROW(type, id, low, high, becomes, of, is, does, costs)                              \
    {.name = #id,                                                                                  \
     .kind = KIND_##type,                                                                          \
     FIELD(type, id),                                                                              \
     .min = (low),                                                                                 \
     .max = (high),                                                                                \
     .zero = (becomes),                                                                            \
     .use = MASU_USE_##of,                                                                         \
     .where = where_##of,                                                                          \
     .missing = missing_##of,                                                                      \
     .unit = is,                                                                                   \
     .text = does,                                                                                 \
     .cost = costs},
#define WORD_ROW_OF(type, id, becomes, of, does, costs)                                            \
    {.name = #id,                                                                                  \
     .kind = MASU_KNOB_WORD,                                                                       \
     FIELD(type, id),                                                                              \
     .max = sizeof(WORDS_##type) / sizeof *(WORDS_##type) - 1,                                     \
     .zero = (becomes),                                                                            \
     .use = MASU_USE_##of,                                                                         \
     .where = where_##of,                                                                          \
     .missing = missing_##of,                                                                      \
     .unit = "",                                                                                   \
     .text = does,                                                                                 \
     .cost = costs,                                                                                \
     .words = WORDS_##type,                                                                        \
     .word_count = sizeof(WORDS_##type) / sizeof *(WORDS_##type)},

/* masu_rung, which make_structs.c writes, has a member of the type of each row, in order. */
#define RUNG_MEMBER(type, name, ...) type name;
typedef struct rung_of_table {
    MASU_KNOBS(RUNG_MEMBER, RUNG_MEMBER)
} rung_of_table;
#define SAME_MEMBER(type, name, ...)                                                               \
    _Static_assert(offsetof(masu_rung, name) == offsetof(rung_of_table, name) &&                   \
                       _Generic(&((masu_rung *)0)->name, type *: 1, default: 0),                   \
                   "masu_rung." #name " is not that of the table: make docs-tables");
MASU_KNOBS(SAME_MEMBER, SAME_MEMBER)
_Static_assert(sizeof(masu_rung) == sizeof(rung_of_table), "masu_rung has members without a row");

static const masu_knob knobs[] = {MASU_KNOBS(NUMBER_ROW, WORD_ROW_OF){.name = NULL}};

/* The names as in masu_detail.what. */
#define WHAT(type, name, ...) "rungs[]." #name,
static const char *const whats[] = {MASU_KNOBS(WHAT, WHAT)};

const masu_knob *masu_knob_table(void) { return knobs; }

/* ---- Values ---------------------------------------------------------------------------------- */

/* Enums are read and written as 32-bit integers. */
_Static_assert(sizeof(float) == 4 && sizeof(masu_switch) == 4 && sizeof(masu_easu) == 4 &&
                   sizeof(masu_aa) == 4,
               "every value of a knob has four bytes");

double masu_knob_get(const masu_knob *k, const masu_rung *rung, uint32_t value) {
    if (!k || !k->name || !rung || value >= k->values) return 0.0;
    const char *at = (const char *)rung + k->offset + 4 * (size_t)value;
    uint32_t number;
    float real;
    memcpy(&number, at, sizeof number);
    memcpy(&real, at, sizeof real);
    return k->kind == MASU_KNOB_FLOAT ? (double)real : (double)number;
}

void masu_knob_set(const masu_knob *k, masu_rung *rung, uint32_t value, double to) {
    if (!k || !k->name || !rung || value >= k->values) return;
    char *at = (char *)rung + k->offset + 4 * (size_t)value;
    if (k->kind == MASU_KNOB_FLOAT) {
        float real = (float)to;
        memcpy(at, &real, sizeof real);
    } else {
        uint32_t number = to > 0.0 ? to < (double)UINT32_MAX ? (uint32_t)to : UINT32_MAX : 0;
        memcpy(at, &number, sizeof number);
    }
}

int masu_knob_accepts(const masu_knob *k, double to) {
    if (!k || !k->name) return 0;
    if (k->kind != MASU_KNOB_FLOAT && to != floor(to)) return 0;
    return (to >= k->min && to <= k->max) || to == 0.0;
}

/* ---- Rungs ----------------------------------------------------------------------------------- */

void masu_rung_defaults(masu_rung *rung) {
    for (const masu_knob *k = knobs; k->name; k++) {
        for (uint32_t i = 0; i < k->values; i++) {
            if (k->zero != 0.0 && masu_knob_get(k, rung, i) == 0.0)
                masu_knob_set(k, rung, i, k->zero);
        }
    }
}

/* The bound that a number violates, for integers. */
static masu_result refuse(const masu_knob *k, uint32_t r, uint32_t i, double is,
                          masu_detail *detail) {
    char one[16] = "";
    if (k->values > 1) snprintf(one, sizeof one, "[%u]", i);
    /* 0 is allowed in addition */
    int whole = k->kind != MASU_KNOB_FLOAT, gap = k->min > (whole ? 1.0 : 0.0);
    uint64_t given = whole ? (uint64_t)is : 0;
    uint64_t needed = !whole ? 0 : (uint64_t)(is < k->min ? k->min : k->max);
    return masu_fail(detail, MASU_ERROR_ARGUMENT, whats[k - knobs], needed, given,
                     "rungs[%u].%s%s is %.10g%s%s, allowed are %s%.6g to %.6g", r, k->name, one, is,
                     k->unit[0] ? " " : "", k->unit, gap ? "0 and " : "",
                     gap || k->min < 0.0 ? k->min : 0.0, k->max);
}

masu_result masu_rung_check(const masu_rung *rung, uint32_t r, masu_detail *detail) {
    for (const masu_knob *k = knobs; k->name; k++) {
        for (uint32_t i = 0; i < k->values; i++) {
            double is = masu_knob_get(k, rung, i);
            if (!masu_knob_accepts(k, is)) return refuse(k, r, i, is, detail);
        }
    }
    return MASU_OK;
}
