/* shadow_tiles.c: see shadow_tiles.h. */
#include "frame/shadow_tiles.h"

#include "shared/masu_shared.h"

#include <string.h>

void masu_shadow_tiles_clear(masu_shadow_tiles *t, uint32_t size) {
    memset(t, 0, sizeof *t);
    t->size = size;
}

/* How many cells of a square of cells are taken. */
static uint32_t taken(const masu_shadow_tiles *t, uint32_t x, uint32_t y, uint32_t edge) {
    uint32_t mask = edge == 32 ? UINT32_MAX : ((1u << edge) - 1u) << x, count = 0;
    for (uint32_t row = y; row < y + edge; row++) {
        for (uint32_t bits = t->rows[row] & mask; bits; bits &= bits - 1) count++;
    }
    return count;
}

static void mark(masu_shadow_tiles *t, masu_shadow_tile tile) {
    uint32_t cell = MASU_LOCAL_TILE_LEAST, edge = tile.size / cell;
    uint32_t mask = edge == 32 ? UINT32_MAX : ((1u << edge) - 1u) << tile.x / cell;
    for (uint32_t row = tile.y / cell; row < tile.y / cell + edge; row++) t->rows[row] ^= mask;
}

masu_shadow_tile masu_shadow_tile_take(masu_shadow_tiles *t, uint32_t size) {
    uint32_t cells = t->size / MASU_LOCAL_TILE_LEAST, edge = size / MASU_LOCAL_TILE_LEAST, best = 0;
    masu_shadow_tile found = {0, 0, 0};
    for (uint32_t y = 0; edge && y + edge <= cells; y += edge) {
        for (uint32_t x = 0; x + edge <= cells; x += edge) {
            if (taken(t, x, y, edge)) continue;
            /* The smallest of the squares around it that is not empty: the smaller, the better. */
            uint32_t around = 2 * edge;
            while (around < cells && !taken(t, x / around * around, y / around * around, around))
                around *= 2;
            if (found.size && around >= best) continue;
            best = around;
            found = (masu_shadow_tile){(uint16_t)(x * MASU_LOCAL_TILE_LEAST),
                                       (uint16_t)(y * MASU_LOCAL_TILE_LEAST), (uint16_t)size};
        }
    }
    if (found.size) mark(t, found);
    return found;
}

void masu_shadow_tile_give(masu_shadow_tiles *t, masu_shadow_tile *tile) {
    if (tile->size) mark(t, *tile);
    *tile = (masu_shadow_tile){0, 0, 0};
}

uint32_t masu_shadow_tile_order(masu_shadow_tile tile) {
    uint32_t x = tile.x / MASU_LOCAL_TILE_LEAST, y = tile.y / MASU_LOCAL_TILE_LEAST, order = 0;
    for (uint32_t k = 0; k < 8; k++) order |= (x >> k & 1u) << 2 * k | (y >> k & 1u) << (2 * k + 1);
    return order;
}

masu_shadow_tile masu_shadow_tile_before(const masu_shadow_tiles *t, masu_shadow_tile tile) {
    uint32_t cell = MASU_LOCAL_TILE_LEAST, edge = tile.size / cell,
             best = masu_shadow_tile_order(tile);
    masu_shadow_tile found = {0, 0, 0};
    for (uint32_t y = 0; edge && y + tile.size <= t->size; y += tile.size) {
        for (uint32_t x = 0; x + tile.size <= t->size; x += tile.size) {
            masu_shadow_tile at = {(uint16_t)x, (uint16_t)y, tile.size};
            uint32_t order = masu_shadow_tile_order(at);
            if (order >= best || taken(t, x / cell, y / cell, edge)) continue;
            best = order;
            found = at;
        }
    }
    return found;
}

void masu_shadow_tile_move(masu_shadow_tiles *t, masu_shadow_tile *tile) {
    masu_shadow_tile to = masu_shadow_tile_before(t, *tile);
    if (!to.size) return;
    masu_shadow_tile_give(t, tile);
    mark(t, to);
    *tile = to;
}

void masu_shadow_sizes_fit(uint32_t *sizes, const uint32_t *faces, const double *scores,
                           uint32_t count, uint32_t size) {
    uint64_t area = 0, room = (uint64_t)size * size;
    for (uint32_t i = 0; i < count; i++) area += (uint64_t)sizes[i] * sizes[i] * faces[i];
    while (area > room) {
        uint32_t least = count;
        for (uint32_t i = 0; i < count; i++) {
            if (sizes[i] <= MASU_LOCAL_TILE_LEAST || !faces[i]) continue;
            if (least == count || sizes[i] > sizes[least] ||
                (sizes[i] == sizes[least] && scores[i] < scores[least]))
                least = i;
        }
        if (least == count) return;
        sizes[least] /= 2;
        area -= (uint64_t)3 * sizes[least] * sizes[least] * faces[least];
    }
}
