/* shadow_tiles.h: allocates square tiles of a square atlas. Sizes are powers of two, and a
 * tile's position is a multiple of its size. Pure functions over the caller's memory. */
#ifndef MASU_SHADOW_TILES_H
#define MASU_SHADOW_TILES_H

#include <stdint.h>

/* along an edge of the largest atlas, each as large as the smallest tile */
#define MASU_SHADOW_CELLS 32u

typedef struct masu_shadow_tile {
    uint16_t x, y, size; /* texels; size 0: none */
} masu_shadow_tile;

typedef struct masu_shadow_tiles {
    uint32_t size;                   /* texels along an edge of the atlas */
    uint32_t rows[MASU_SHADOW_CELLS]; /* a bit per cell: taken */
} masu_shadow_tiles;

/* All tiles are free. size: a power of two from the smallest tile to MASU_SHADOW_CELLS smallest
 * tiles. */
void masu_shadow_tiles_clear(masu_shadow_tiles *t, uint32_t size);

/* Allocates a tile of that size, next to other tiles if there is a choice, so that large ones
 * remain free; size 0: none is free. */
masu_shadow_tile masu_shadow_tile_take(masu_shadow_tiles *t, uint32_t size);
void masu_shadow_tile_give(masu_shadow_tiles *t, masu_shadow_tile *tile);

/* A tile's index along a Z-order curve. */
uint32_t masu_shadow_tile_order(masu_shadow_tile tile);
/* The first free tile of the same size before this one in that order; size 0: there is none.
 * When no tile has one, the free area is contiguous except for less than two of the largest
 * tiles. */
masu_shadow_tile masu_shadow_tile_before(const masu_shadow_tiles *t, masu_shadow_tile tile);
/* There, if there is one. */
void masu_shadow_tile_move(masu_shadow_tiles *t, masu_shadow_tile *tile);

/* Sizes that have room together in an atlas of size^2 texels: as long as they do not, of the
 * largest ones that with the lowest score is halved. A light has faces[i] tiles of sizes[i]. */
void masu_shadow_sizes_fit(uint32_t *sizes, const uint32_t *faces, const double *scores,
                           uint32_t count, uint32_t size);

#endif
