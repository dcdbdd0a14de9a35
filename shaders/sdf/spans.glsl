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

#include "shared/sdf_limits.h"
#include "shared/types.h"
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
uint span_words;   /* where the first block's are */
uint span_columns; /* blocks in a row */

void span_locate(uvec2 size)
{
    uvec2 grid = masu_tile_grid(size);
    span_words = uint(MASU_TILES_HEADER) + grid.x * grid.y * (1u + masu_list_stride());
    span_columns = (size.x + 3u) / 4u;
}

uint span_place(uvec2 block)
{
    return span_words + (block.y * span_columns + block.x) * uint(1 + MASU_BLOCK_SPANS * MASU_SDF_BLOCK_WORDS);
}

#if MASU_BLOCK_PIXELS != 4
#error "blocks are of 4x4 pixels"
#endif
uint span_word(uvec2 at)
{
    return span_place(at >> 2u);
}

#endif

/* ---- Following a pixel's ray ------------------------------------------------------------------- */

/* MASU_SPAN_TILE: the number of its tile. MASU_SPAN_BEFORE: whether it may begin before the pieces do. */

#ifdef MASU_SPAN_TILE
#if MASU_SDF_BLOCK_WORDS > 0
#define MASU_WENT_BACK(t) span_to = (t) >= span_from ? span_to : -1.0;
uint span_first; /* of its block's pieces */
float span_pixel;
float span_start, span_from, span_to; /* of the block; of the piece that the ray is in: -1 if it has gone back before that */

float span_end(vec4 ends, uint i)
{
    return i == 0u ? ends.x : i == 1u ? ends.y : i == 2u ? ends.z : ends.w;
}

/* Before the pieces and behind them what the tile sees; of a scene of one part, that and all terms. */
void span_look_up(float t, uvec2 size)
{
    vec4 ends = span_ends(span_start, span_pixel);
    uvec4 past = uvec4(greaterThan(vec4(t), ends));
    uint now = past.x + past.y + past.z + past.w;
    bool before = MASU_SPAN_BEFORE && t < span_start;
    span_from = before || !MASU_SPAN_BEFORE && now == 0u ? 0.0 : now == 0u ? span_start : span_end(ends, now - 1u);
    span_to = before ? span_start : now == 4u ? 1e30 : span_end(ends, now);
    if (before || now == 4u) {
        masu_use_tile(MASU_SPAN_TILE, size);
        if (MASU_SDF_LISTED_COUNT == 1) {
            masu_list_bits = uint[](0xFFFFFFFFu, 0xFFFFFFFFu);
        }
        return;
    }
    uint place = span_first + now * uint(MASU_SDF_BLOCK_WORDS);
    for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
        masu_list_bits[w] = masu_tiles[place + uint(w)];
    }
}

void span_begin(uvec2 at, uvec2 size, float t)
{
    span_first = span_word(at) + 1u;
    span_start = uintBitsToFloat(masu_tiles[span_first - 1u]);
    /* Nearly all begin where the pieces do. */
    span_from = 0.0;
    span_to = span_start * (1.0 + span_pixel * 8.0);
    if (MASU_SPAN_BEFORE || !(t <= span_to)) {
        span_look_up(t, size);
        return;
    }
    for (int w = 0; w < MASU_SDF_BLOCK_WORDS; w++) {
        masu_list_bits[w] = masu_tiles[span_first + uint(w)];
    }
}

/* Once, before the first. */
void span_prepare(uvec2 size)
{
    span_locate(size);
    span_pixel = 2.0 * max(frame.up.w / float(size.y), frame.right.w / float(size.x));
}

/* Samples come one behind the other, or MASU_WENT_BACK has said where they do not: one comparison each. */
void span_follow(float t, uvec2 size)
{
    if (!(t <= span_to)) {
        span_look_up(t, size);
    }
}
#else
#define MASU_WENT_BACK(t)
void span_prepare(uvec2 size)
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
