/* buffer.c: see buffer.h. */
#include "bake/base/buffer.h"
#include "cli/cli.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- buffers ---- */

static void out_of_memory(void) {
    masu_cli_error("out of memory");
    exit(MASU_CLI_FAILURE); /* in an importing child, which must not return either, harmless */
}

void *masu_bake_allocate(size_t bytes) {
    void *memory = malloc(bytes ? bytes : 1);
    if (!memory) out_of_memory();
    return memory;
}

void *masu_bake_append(masu_bake_buffer *buffer, const void *data, size_t bytes) {
    if (bytes > SIZE_MAX / 2 - buffer->bytes) out_of_memory();
    size_t needed = buffer->bytes + bytes;
    if (needed > buffer->capacity || !buffer->data) {
        size_t capacity = buffer->capacity + buffer->capacity / 2;
        if (capacity < needed) capacity = needed;
        if (capacity < 256) capacity = 256;
        unsigned char *grown = realloc(buffer->data, capacity);
        if (!grown) out_of_memory();
        buffer->data = grown;
        buffer->capacity = capacity;
    }
    unsigned char *at = buffer->data + buffer->bytes;
    if (data)
        memcpy(at, data, bytes);
    else
        memset(at, 0, bytes);
    buffer->bytes = needed;
    return at;
}

void masu_bake_append_text(masu_bake_buffer *buffer, const char *text) {
    masu_bake_append(buffer, text, strlen(text));
}

void masu_bake_release(masu_bake_buffer *buffer) {
    free(buffer->data);
    *buffer = (masu_bake_buffer){0};
}

/* ---- pools ---- */

struct masu_bake_block {
    struct masu_bake_block *next;
    union {
        long double strictest;
        void *pointer;
        uint64_t number;
    } memory[]; /* aligned for anything */
};

void *masu_bake_take(masu_bake_pool *pool, size_t bytes) {
    struct masu_bake_block *block = masu_bake_allocate(sizeof *block + bytes);
    block->next = pool->blocks;
    pool->blocks = block;
    return memset(block->memory, 0, bytes);
}

const char *masu_bake_take_text(masu_bake_pool *pool, const char *text) {
    size_t bytes = strlen(text) + 1;
    return memcpy(masu_bake_take(pool, bytes), text, bytes);
}

void masu_bake_pool_release(masu_bake_pool *pool) {
    while (pool->blocks) {
        struct masu_bake_block *next = pool->blocks->next;
        free(pool->blocks);
        pool->blocks = next;
    }
}
