/* smaa.h: layout of the buffers of SMAA (shaders/smaa). */
#ifndef MASU_SHARED_SMAA_H
#define MASU_SHARED_SMAA_H

/* Tiles with an edge in or next to them, in 32-bit values:
 *
 *   0..2                  arguments of the indirect dispatch: tiles, 1, 1
 *   TILES_HEADER + k      number of the k-th tile, in no particular order
 *   TILES_HEADER + tiles  SMAA_WORDS values per tile: one per row of pixels, then one per column.
 *                         Bits 0..15 of a row: the edge above each pixel; 16..31: the edge on its
 *                         left. Of a column the reverse
 *
 * The table of areas (tools/generate/make_smaa_area.c) has texels of two bytes:
 *
 *   straight edges   4x4 patterns, by the code of the left end, then of the right end. Each has
 *                    STRAIGHT rows (square root of the distance to the right) of STRAIGHT values:
 *                    a texel and its right neighbour
 *   diagonals        4x4 patterns of DIAGONAL rows of DIAGONAL texels, two per value */
#define MASU_SMAA_WORDS 32
#define MASU_SMAA_STRAIGHT 10
#define MASU_SMAA_STRAIGHT_WORDS 1600
#define MASU_SMAA_DIAGONAL 17
#define MASU_SMAA_AREA_WORDS 3912
/* Longest searches: 2 pixels per step along an edge, 1 along a diagonal. */
#define MASU_SMAA_STEPS_MAX 32
#define MASU_SMAA_DIAGONAL_STEPS_MAX 16

#endif
