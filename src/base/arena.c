/* arena.c: see arena.h. */
#include "base/arena.h"

#include <string.h>

void masu_arena_begin(masu_arena *arena, void *base, uint64_t size) {
    memset(arena, 0, sizeof *arena);
    arena->base = base;
    arena->size = size;
}

void *masu_arena_alloc(masu_arena *arena, const char *name, uint64_t count, uint64_t element_bytes,
                       uint64_t alignment) {
    if (arena->used == UINT64_MAX) return NULL;
    uint64_t offset = (arena->used + alignment - 1) & ~(alignment - 1);
    if (offset < arena->used || (element_bytes && count > (UINT64_MAX - offset) / element_bytes)) {
        arena->used = UINT64_MAX;
        return NULL;
    }
    uint64_t bytes = count * element_bytes;
    if (arena->row_count < MASU_ARENA_ROWS) {
        arena->rows[arena->row_count++] =
            (masu_arena_row){name, count, element_bytes, alignment, offset};
    }
    arena->used = offset + bytes;
    if (!arena->base || arena->used > arena->size) return NULL;
    memset(arena->base + offset, 0, (size_t)bytes);
    return arena->base + offset;
}
