/* spirv_tally.h: inserts counters into a shader: the work of each invocation is added up by block
 * and written to a buffer at its end. The shader's results do not change.
 *
 * Every block of every function adds the costs of its instructions (spirv_cost.h), the bytes of
 * storage buffers that they load and store, and the texels that they fetch and write, per binding,
 * to private variables. At the end of the invocation these are added to the buffer by atomics.
 * Loops and branches are counted as they execute, per invocation: lanes of a wave that wait for
 * others are not counted.
 *
 * The buffer is binding 0 of a descriptor set that the host adds. A module has MASU_TALLY_WORDS
 * 32-bit values from `base` on: invocations; the largest number of plain operations of an
 * invocation; then two values per number: the sum of its low ten bits, and of its other bits. */
#ifndef MASU_SPIRV_TALLY_H
#define MASU_SPIRV_TALLY_H

#include "spirv/spirv.h"

#include <stdbool.h>

#define MASU_TALLY_WORDS 64u
#define MASU_TALLY_NUMBERS 31u

typedef enum masu_tally_kind {
    MASU_TALLY_PLAIN,    /* operations */
    MASU_TALLY_WEIGHTED, /* the same in peak units */
    MASU_TALLY_LOADED,   /* bytes of a storage buffer */
    MASU_TALLY_STORED,
    MASU_TALLY_FETCHED, /* texels of an image; a gather is four */
    MASU_TALLY_WRITTEN
} masu_tally_kind;

typedef struct masu_tally_number {
    masu_tally_kind kind;
    uint32_t set, binding; /* for the last four kinds */
} masu_tally_number;

typedef struct masu_tally {
    uint32_t model; /* 0: vertex, 4: fragment, 5: compute */
    bool late;      /* a fragment shader that discards: the depth test is after it */
    uint32_t count;
    masu_tally_number numbers[MASU_TALLY_NUMBERS]; /* the first two: plain, weighted */
    uint32_t *words;
    size_t word_count;
} masu_tally;

/* Returns false for an invalid module, one without an entry point, or one with too many numbers.
 * `words` is freed by free(). */
bool masu_tally_make(const uint32_t *words, size_t count, uint32_t set, uint32_t base,
                     masu_tally *out);

/* The sum of one number in the buffer. `from` points to the values of the module. */
uint64_t masu_tally_sum(const uint32_t *from, uint32_t number);

#endif
