/* arena.h: bump allocator in the host memory block.
 *
 *   base                                                   base + size
 *   | renderer | instance rows | dirty flags | sets | ... |
 *
 * One sequence of masu_arena_alloc calls (src/api.c, alloc_host) serves both the size query and
 * init. With base NULL the calls only count, so the two cannot disagree. Nothing is freed: the
 * caller owns the block and frees it as a whole. */
#ifndef MASU_ARENA_H
#define MASU_ARENA_H

#include "masu.h"

#define MASU_ARENA_ALIGNMENT 64u
#define MASU_ARENA_ROWS 60u

typedef struct masu_arena_row {
    const char *name;
    uint64_t count, element_bytes, alignment, offset;
} masu_arena_row;

typedef struct masu_arena {
    unsigned char *base; /* NULL: only count */
    uint64_t size;       /* of the block; ignored when counting */
    uint64_t used;       /* bytes requested so far, including those beyond the end of the block */
    uint32_t row_count;
    masu_arena_row rows[MASU_ARENA_ROWS];
} masu_arena;

/* Starts a sequence. base must be aligned to MASU_ARENA_ALIGNMENT. */
void masu_arena_begin(masu_arena *arena, void *base, uint64_t size);

/* Allocates `count` zeroed elements. Returns NULL when only counting, when the block is too small
 * (`used` is then the total requirement at the end of the sequence), or when count * element_bytes
 * overflows (`used` is then UINT64_MAX and does not change any more). Zero elements need no bytes;
 * the result is then a non-NULL pointer unless the block is exhausted. */
void *masu_arena_alloc(masu_arena *arena, const char *name, uint64_t count, uint64_t element_bytes,
                       uint64_t alignment);

#endif
