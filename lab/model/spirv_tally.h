/* spirv_tally.h: puts counters into a shader: what each invocation executes is added up by block
 * and written to a buffer when it ends. The shader does the same as before.
 *
 * Every block of every function adds what its instructions cost (spirv_cost.h), the bytes of
 * storage buffers that they load and store, and the texels that they fetch and write, by
 * binding, to private variables; where the invocation ends, these are added to the buffer by
 * atomics. Loops and branches are thus counted as they run, of invocations by themselves: lanes
 * of a wave that wait for others are not.
 *
 * The buffer is binding 0 of a descriptor set that the host adds. From `base` on it has
 * MASU_TALLY_WORDS words of a module: invocations; the most plain operations of one; then two
 * words for each number: the sum of its low ten bits, and of the others. */
#ifndef MASU_SPIRV_TALLY_H
#define MASU_SPIRV_TALLY_H

#include "spirv/spirv.h"

#include <stdbool.h>

#define MASU_TALLY_WORDS 64u
#define MASU_TALLY_NUMBERS 31u

typedef enum masu_tally_kind {
    MASU_TALLY_PLAIN,    /* operations */
    MASU_TALLY_WEIGHTED, /* the same in units of the peak */
    MASU_TALLY_LOADED,   /* bytes of a storage buffer */
    MASU_TALLY_STORED,
    MASU_TALLY_FETCHED, /* texels of an image; a gather is four */
    MASU_TALLY_WRITTEN
} masu_tally_kind;

typedef struct masu_tally_number {
    masu_tally_kind kind;
    uint32_t set, binding; /* of the last four kinds */
} masu_tally_number;

typedef struct masu_tally {
    uint32_t model; /* 0: vertex, 4: fragment, 5: compute */
    bool late;      /* a fragment shader that discards: the depth test comes after it */
    uint32_t count;
    masu_tally_number numbers[MASU_TALLY_NUMBERS]; /* the first two: plain, weighted */
    uint32_t *words;
    size_t word_count;
} masu_tally;

/* False: no module, one without an entry point, or of more numbers than there is room for.
 * `words` is freed by free(). */
bool masu_tally_make(const uint32_t *words, size_t count, uint32_t set, uint32_t base,
                     masu_tally *out);

/* What the buffer has found, of one number. `from` points to the words of the module. */
uint64_t masu_tally_sum(const uint32_t *from, uint32_t number);

#endif
