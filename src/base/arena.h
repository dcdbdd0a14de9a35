/* arena.h: the host block.
 *
 *   base                                                   base + size
 *   | renderer | instance rows | dirty flags | sets | ... |
 *
 * One walk of masu_arena_alloc calls (src/api.c, alloc_host) serves both the size query and init:
 * with base NULL the walk only counts, so the two cannot disagree. Nothing is ever given back: the
 * block is the caller's and ends as a whole. */
#ifndef MASU_ARENA_H
#define MASU_ARENA_H

#include "masu.h"

#define MASU_ARENA_ALIGNMENT 64u
#define MASU_ARENA_ROWS 52u

typedef struct masu_arena_row {
    const char *name;
    uint64_t count, element_bytes, alignment, offset;
} masu_arena_row;

typedef struct masu_arena {
    unsigned char *base; /* NULL: count only */
    uint64_t size;       /* of the block; ignored when counting */
    uint64_t used;       /* bytes the walk has asked for, also behind the end of the block */
    uint32_t row_count;
    masu_arena_row rows[MASU_ARENA_ROWS];
} masu_arena;

/* Starts a walk. base must be aligned to MASU_ARENA_ALIGNMENT. */
void masu_arena_begin(masu_arena *arena, void *base, uint64_t size);

/* Takes count elements, zeroed. Returns NULL when counting, when the block is too small (used then
 * tells the whole need at the end of the walk), or when count * element_bytes overflows (used is
 * then UINT64_MAX for good). Zero elements take no bytes and give a non-NULL pointer while the
 * block lasts. */
void *masu_arena_alloc(masu_arena *arena, const char *name, uint64_t count, uint64_t element_bytes,
                       uint64_t alignment);

#endif
