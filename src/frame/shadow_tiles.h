/* shadow_tiles.h: square tiles of a square atlas: which are free. Sizes are powers of two, and a tile lies at a
 * multiple of its size. Pure functions over the caller's memory. */
#ifndef MASU_SHADOW_TILES_H
#define MASU_SHADOW_TILES_H

#include <stdint.h>

#define MASU_SHADOW_CELLS 32u /* along an edge of the largest atlas, each as large as the smallest tile */

typedef struct masu_shadow_tile {
    uint16_t x, y, size; /* texels; size 0: none */
} masu_shadow_tile;

typedef struct masu_shadow_tiles {
    uint32_t size;                   /* texels along an edge of the atlas */
    uint32_t rows[MASU_SHADOW_CELLS]; /* a bit per cell: taken */
} masu_shadow_tiles;

/* Nothing is taken. size: a power of two from the smallest tile to MASU_SHADOW_CELLS of them. */
void masu_shadow_tiles_clear(masu_shadow_tiles *t, uint32_t size);

/* A free tile of that size, next to other tiles if there is a choice, so that large ones stay free; or one with size
 * 0. */
masu_shadow_tile masu_shadow_tile_take(masu_shadow_tiles *t, uint32_t size);
void masu_shadow_tile_give(masu_shadow_tiles *t, masu_shadow_tile *tile);

#endif
