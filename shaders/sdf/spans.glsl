/*
 * spans.glsl: what of the field matters to a block of 4x4 pixels, in pieces of its rays.
 *
 * The pieces begin where the block's cone ends (cone.comp, which looks) and follow each other; each is three or four times
 * as long as the one before it, since what is hit is mostly near and what is passed by is left behind fast. The ball
 * around the middle of a piece holds that piece of all rays of the block. Behind the last one what matters to the
 * tile does.
 */
#ifndef MASU_SPANS_GLSL
#define MASU_SPANS_GLSL

#include "sdf/field.glsl"

#if MASU_SDF_BLOCK_WORDS > 0

/* Where the pieces end, the first of which begins at t. `pixel`: of the middle of the picture, where it is largest.
 * Tried: 8, 24, 72, 216 pixels' widths (a garden at grazing angles took 8 % more), a last one of 1000 or 2000, two or three
 * balls for each longer piece (1 to 4 % less for thin rods, 1 to 3 % more for a city). */
vec4 span_ends(float t, float pixel)
{
    return t * (1.0 + pixel * vec4(8.0, 32.0, 128.0, 512.0));
}

/* For a sample in the middle of a piece. */
float span_margin(ray r, float begin, float end)
{
    float across = 0.70711 * float(MASU_BLOCK_PIXELS) * r.pixel * end;
    vec3 p = abs(world_at(r.direction, end));
    float slack = 128.0 * ulp * (max(p.x, max(p.y, p.z)) + end); /* the samples around a hit, for its normal */
    return field_margin(r, 0.5 * (begin + end), 1.01 * length(vec2(0.5 * (end - begin), across)) + slack);
}

/* A block's words stand behind the lists: where its pieces begin, as a float, then the bits of each piece. */
uint span_place(uvec2 block, uvec2 size)
{
    uvec2 grid = masu_tile_grid(size);
    uint first = uint(MASU_TILES_HEADER) + grid.x * grid.y * (1u + masu_list_stride());
    uint at = block.y * ((size.x + 3u) / 4u) + block.x;
    return first + at * uint(1 + MASU_BLOCK_SPANS * MASU_SDF_BLOCK_WORDS);
}

#endif
#endif
