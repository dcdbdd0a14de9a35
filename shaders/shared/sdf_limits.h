/* sdf_limits.h: layout of the SDF's tile buffer, and bounds of SDF loops and arrays. */
#ifndef MASU_SHARED_SDF_LIMITS_H
#define MASU_SHARED_SDF_LIMITS_H

/* The buffer TILES, in 32-bit values. The pixels of a tile share one list of parts.
 *
 *   0..2                  arguments of the indirect dispatch: active tiles, 1, 1
 *   TILES_HEADER + k      number of the k-th active tile, in no particular order
 *   TILES_HEADER + tiles  lists of `stride` values. Up to TILE_MASKED_MAX parts in the scene: one
 *                         bit per part; otherwise a count and part numbers
 *   after the lists       per 4x4 pixel block, row by row: the distance at which its cone stopped,
 *                         a float, then the term masks of BLOCK_SPANS pieces of its rays
 *                         (shaders/sdf/spans.glsl). The scene says how many values a mask has;
 *                         none if the whole field is one term
 *
 * A list that would not fit is TILE_ALL: the tile evaluates all parts, with the same result. */
#define MASU_TILE_PARTS_MAX 63
#define MASU_TILE_MASKED_MAX 64
#define MASU_TILE_ALL 0xFFFFFFFFu
#define MASU_BLOCK_PIXELS 4
#define MASU_BLOCK_WORDS_MAX 2
#define MASU_BLOCK_SPANS 4
#define MASU_SDF_PARTS_MAX 4096

/* An SDF that extends further than ANCHOR_FROM metres from the origin is compiled with a floating
 * origin. The origin is at multiples of ANCHOR_GRID metres near a camera that is that far out. At
 * smaller distances fp32 resolves 0.5 mm or better. */
#define MASU_ANCHOR_FROM 4096
#define MASU_ANCHOR_GRID 64

/* SDF parameters that change at run time: floats, four per vec4. */
#define MASU_SDF_PARAM_VEC4S 64
#define MASU_SDF_PARAMS_MAX 256

/* Constant loop bounds: sphere-tracing steps of a primary, a shadow and a reflected ray. A rung may
 * use fewer. */
#define MASU_MARCH_STEPS_MAX 2048
#define MASU_SHADOW_STEPS_MAX 128
#define MASU_REFLECTED_STEPS_MAX 256

#endif
