/*
 * tiles.glsl: the buffer of SMAA: the list of tiles with edges, and the edges, a bit each.
 *
 * Edges are stored as bits, once by rows and once by columns, so that the end of a line is found by
 * counting bits of a 32-bit value instead of by fetching two pixels at a time. shared/smaa.h has
 * the layout.
 */
#ifndef MASU_SMAA_TILES_GLSL
#define MASU_SMAA_TILES_GLSL

#include "shared/smaa.h"
#include "shared/types.h"
#include "shared/globals.glsl"

#ifndef MASU_SMAA_TILES_ACCESS
#define MASU_SMAA_TILES_ACCESS readonly
#endif
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SMAA_TILES, std430)
    MASU_SMAA_TILES_ACCESS buffer SmaaTiles
{
    uint smaa_tiles[];
};

uvec2 masu_smaa_grid()
{
    uvec2 size = uvec2(pc.render_width, pc.render_height);
    return (size + uint(MASU_TILE) - 1u) / uint(MASU_TILE);
}

/* Offset of the edges of a tile. */
uint masu_smaa_words(uvec2 tile, uvec2 grid)
{
    return uint(MASU_TILES_HEADER) + grid.x * grid.y +
           uint(MASU_SMAA_WORDS) * (tile.y * grid.x + tile.x);
}

#endif
