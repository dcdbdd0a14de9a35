/* sprites.h: particles, debug lines and decals of a frame, in one buffer of vec4. */
#ifndef MASU_SHARED_SPRITES_H
#define MASU_SHARED_SPRITES_H

/* Head of the buffer; all values are integers:
 *
 *   SPRITE_DISPATCH   xyz arguments of the dispatch over the screen rectangle of decals, w decals
 *   SPRITE_PLACE      xy first pixel of that rectangle
 *   SPRITE_LINES      arguments of the line draw
 *   SPRITE_DRAWS + k  arguments of the particle draw before the k-th transparent draw; the last one
 *                     comes after all of them. Six vertices per particle
 *
 * Arrays, at offsets that are push constants:
 *
 *   particle   PARTICLE_VEC4S: camera-relative centre, depth of the soft edge in m; half width,
 *              half height, cosine and sine of the rotation; colour, opacity; flags (integer),
 *              edge, 0, 0. With textures or trails TEXTURED_PARTICLE_VEC4S: texture (integer) and
 *              share of the second cell for 0, 0; first corner of the cell, and its opposite one;
 *              first corner of the second cell, 0, 0; 0; 0
 *   segment    (of a trail) as large, flag SPRITE_SEGMENT: start, camera-relative, depth of the
 *              soft edge; end, texture coordinate along the trail at the start; colour, opacity;
 *              flags (integer), coordinate at the end, texture (integer), 0; corners of the cell;
 *              left side of the start relative to it, edge; of the end, 0; colour and opacity of
 *              the end
 *   line end   LINE_VEC4S per line: x and y in -1..1, depth, colour of 8 bits per channel and
 *              flags above it (integer)
 *   decal      DECAL_VEC4S: three rows of the matrix camera-relative -> box; colour, opacity;
 *              roughness, metallic, edge, flags (integer); unit z axis, 0; first and last pixel, 16
 *              bits per coordinate (integers), cos(outer), 1 / (cos(inner) - cos(outer)). With
 *              textures or trails TEXTURED_DECAL_VEC4S: corners of the cell; texture (integer),
 *              emission, 0, 0 */
#define MASU_SPRITE_DISPATCH 0u
#define MASU_SPRITE_PLACE 1u
#define MASU_SPRITE_LINES 2u
#define MASU_SPRITE_DRAWS 3u
#define MASU_PARTICLE_VEC4S 4u
#define MASU_TEXTURED_PARTICLE_VEC4S 8u
#define MASU_LINE_VEC4S 2u
#define MASU_DECAL_VEC4S 7u
#define MASU_TEXTURED_DECAL_VEC4S 9u
#define MASU_PARTICLES_MAX 65536
#define MASU_LINES_MAX 65536
#define MASU_DECALS_MAX 1024
/* Flags, with the values of masu.h. */
#define MASU_SPRITE_LIT 1u
#define MASU_SPRITE_ADDITIVE 2u
#define MASU_SPRITE_SEGMENT 4u
#define MASU_SPRITE_ROUND 1u
#define MASU_SPRITE_KEEP_COLOR 2u
#define MASU_SPRITE_ON_TOP 1u

/* Head of a slot of the texels that a frame writes, in 32-bit values: xyz arguments of the
 * dispatch, number of writes; then MASU_TEXTURE_WRITE_WORDS per write: x, y, width, height, layer,
 * first texel in the buffer, 0, 0. The texels follow. */
#define MASU_LIVE_TEXTURES_MAX 256
#define MASU_TEXTURE_WRITES 64
#define MASU_TEXTURE_WRITE_WORDS 8
#define MASU_TEXELS_HEAD 4
#define MASU_TEXELS_FIRST (MASU_TEXELS_HEAD + MASU_TEXTURE_WRITES * MASU_TEXTURE_WRITE_WORDS)

#endif
