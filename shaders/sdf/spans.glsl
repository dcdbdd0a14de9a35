/*
 * spans.glsl: the parts and terms of the SDF that can affect a block of 4x4 pixels, per piece
 * (span) of its rays.
 *
 * The pieces begin at the end of the block's cone (cone.comp selects the terms) and follow each
 * other; each is three or four times as long as the one before, since most hits are close and most
 * occluders are passed early. The ball around the centre of a piece contains that piece of all rays
 * of the block. Behind the last piece the list of the tile is used.
 */
#ifndef MASU_SPANS_GLSL
#define MASU_SPANS_GLSL

#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "sdf/field.glsl"

#if MASU_SDF_BLOCK_WORDS > 0

/* The ends of the pieces, the first of which begins at t. `pixel`: pixel width at the centre of the
 * image, where it is largest. Rejected: 8, 24, 72, 216 pixel widths (a garden at grazing angles
 * took 8 % more), a last piece of 1000 or 2000, two or three balls for each longer piece (1 to 4 %
 * less for thin rods, 1 to 3 % more for a city). */
vec4 span_ends(float t, float pixel)
{
    return t * (1.0 + pixel * vec4(8.0, 32.0, 128.0, 512.0));
}

/* The margin for a sample at the centre of a piece. */
float span_margin(ray r, float begin, float end)
{
    float across = 0.70711 * float(MASU_BLOCK_PIXELS) * r.pixel * end;
    vec3 p = abs(world_at(r.direction, end));
    float slack = 128.0 * ulp * (max(p.x, max(p.y, p.z)) + end); /* includes the samples around a
                                                                  * hit, for its normal */
    return field_margin(r, 0.5 * (begin + end),
                        1.01 * length(vec2(0.5 * (end - begin), across)) + slack);
}

/* Offset of a block's data, which follow the tile lists: the start of the first piece as a float,
 * then the bits of each piece. Not kept: in a march it would take registers. */
uint span_place(uvec2 block, uvec2 size)
{
    uvec2 grid = masu_tile_grid(size);
    uint first = uint(MASU_TILES_HEADER) + grid.x * grid.y * (1u + masu_list_stride());
    uint columns = (size.x + 3u) / 4u;
    return first +
           (block.y * columns + block.x) * uint(1 + MASU_BLOCK_SPANS * MASU_SDF_BLOCK_WORDS);
}

#if MASU_BLOCK_PIXELS != 4
#error "blocks are of 4x4 pixels"
#endif
uint span_word(uvec2 at, uvec2 size)
{
    return span_place(at >> 2u, size);
}

#endif

/* ---- Following a pixel's ray ----------------------------------------------------------------- */

/* MASU_SPAN_TILE: index of the tile. MASU_SPAN_BEFORE: whether the ray may begin before the
 * pieces. */

#ifdef MASU_SPAN_TILE
#if MASU_SDF_BLOCK_WORDS > 0
#define MASU_WENT_BACK(t) span_to = (t) >= span_from ? span_to : -1.0;
uint span_first; /* offset of the bits of the block */
float span_from, span_to; /* of the current piece: span_to is -1 if the ray went back before it */

float span_start()
{
    return uintBitsToFloat(masu_tiles[span_first - 1u]);
}

float span_pixel(uvec2 size)
{
    return 2.0 * max(frame.up.w / float(size.y), frame.right.w / float(size.x));
}

float span_end(vec4 ends, uint i)
{
    return i == 0u ? ends.x : i == 1u ? ends.y : i == 2u ? ends.z : ends.w;
}

/* Outside the pieces the list of the tile is used; with all terms in a scene of one part. */
void span_look_up(float t, uvec2 size)
{
    float start = span_start();
    vec4 ends = span_ends(start, span_pixel(size));
    uvec4 past = uvec4(greaterThan(vec4(t), ends));
    uint now = past.x + past.y + past.z + past.w;
    bool before = MASU_SPAN_BEFORE && t < start;
    span_from = before || !MASU_SPAN_BEFORE && now == 0u ? 0.0
                : now == 0u                              ? start
                                                         : span_end(ends, now - 1u);
    span_to = before ? start : now == 4u ? 1e30 : span_end(ends, now);
    if (before || now == 4u) {
        masu_use_tile(MASU_SPAN_TILE, size);
        if (MASU_SDF_LISTED_COUNT == 1) {
            masu_list_bits = uint[](0xFFFFFFFFu, 0xFFFFFFFFu);
        }
    } else {
        uint place = span_first + now * uint(MASU_SDF_BLOCK_WORDS);
        for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
            masu_list_bits[w] = masu_tiles[place + uint(w)];
        }
    }
}

/* For code that calls span_begin() only on some paths: values of an earlier ray would take
 * registers. */
void span_begin_none()
{
    span_first = 0u;
    span_from = span_to = 0.0;
}

void span_begin(uvec2 at, uvec2 size, float t)
{
    span_first = span_word(at, size) + 1u;
    /* Nearly all rays begin at the first piece. */
    span_from = 0.0;
    span_to = span_start() * (1.0 + span_pixel(size) * 8.0);
    if (MASU_SPAN_BEFORE || !(t <= span_to)) {
        span_look_up(t, size);
    } else {
        for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
            masu_list_bits[w] = masu_tiles[span_first + uint(w)];
        }
    }
}

/* Samples advance, or MASU_WENT_BACK has reported a step back: one comparison each. */
void span_follow(float t, uvec2 size)
{
    if (!(t <= span_to)) {
        span_look_up(t, size);
    }
}
#else
#define MASU_WENT_BACK(t)
void span_begin_none()
{
}

void span_begin(uvec2 at, uvec2 size, float t)
{
}

void span_follow(float t, uvec2 size)
{
}
#endif
#endif
#endif
