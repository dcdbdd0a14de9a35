/* buffer.h: memory of masu-bake: arrays of bytes that grow, and pools of small things that are
 * released together. Whoever declares one owns it; all zeros is empty. Running out of memory ends
 * the program with a message, so nothing here can fail. */
#ifndef MASU_BAKE_BUFFER_H
#define MASU_BAKE_BUFFER_H

#include <stddef.h>

typedef struct masu_bake_buffer {
    unsigned char *data;
    size_t bytes, capacity;
} masu_bake_buffer;

/* Appends (data NULL: zeros) and returns the new bytes, valid until the next append. */
void *masu_bake_append(masu_bake_buffer *buffer, const void *data, size_t bytes);
void masu_bake_append_text(masu_bake_buffer *buffer, const char *text); /* without its NUL */
void masu_bake_release(masu_bake_buffer *buffer);
void *masu_bake_allocate(size_t bytes); /* never NULL; free() it */

typedef struct masu_bake_pool {
    struct masu_bake_block *blocks;
} masu_bake_pool;

/* Zeroed memory, aligned for anything; a copy of a text. Both live until the pool is released. */
void *masu_bake_take(masu_bake_pool *pool, size_t bytes);
const char *masu_bake_take_text(masu_bake_pool *pool, const char *text);
void masu_bake_pool_release(masu_bake_pool *pool);

#endif
