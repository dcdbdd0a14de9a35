/* lookup_tables.h: layout of the tables in the buffer TABLES. */
#ifndef MASU_SHARED_LOOKUP_TABLES_H
#define MASU_SHARED_LOOKUP_TABLES_H

/* Directional albedos of the specular lobe (shaders/brdf/tables.glsl, written by
 * tools/generate/make_split_sum.c). A table has TABLE_SIZE nodes over sqrt(N.V) from 0 to 1, and
 * TABLE_ROWS rows over perceptual roughness from TABLE_SMOOTHEST to 1. Offsets are in 32-bit
 * values, each of which holds two unorm16 numbers unless noted:
 *
 *   TABLE_LOSS           energy lost by a white lobe; weight of (1 - h.v)^5
 *   TABLE_AVERAGE        2 floats per row: the hemispherical averages of both
 *   TABLE_COAT           white lobe times the larger (1 - N.w)^5 of both directions w; the same
 *                        times (1 - h.v)^5. From here on only for scenes with clear coat
 *   TABLE_COAT_AVERAGE   4 floats per row: the averages of both; a and b of the coat
 *   TABLE_TRANSFORM      only for scenes with area lights: two 32-bit values of two snorm16 numbers
 *                        each for every node: a, b, c / alpha, d / (2 alpha) (light/source.glsl,
 *                        fitted by tools/generate/make_cosines.c). TRANSFORM_COLUMNS nodes over
 *                        sqrt(1 - N.V), TRANSFORM_ROWS rows over roughness, interpolated in both */
#define MASU_TABLE_SIZE 64
#define MASU_TABLE_ROWS 256
#define MASU_TABLE_SMOOTHEST 0.045
#define MASU_TABLE_LOSS 0
#define MASU_TABLE_AVERAGE 16384
#define MASU_TABLE_COAT 16896
#define MASU_TABLE_COAT_AVERAGE 33280
#define MASU_TABLE_WORDS 16896 /* 32-bit values without coat */
#define MASU_TABLE_TRANSFORM 34304
#define MASU_TABLE_WORDS_COAT 34304
#define MASU_TABLE_WORDS_ALL 38400
#define MASU_TRANSFORM_COLUMNS 64
#define MASU_TRANSFORM_ROWS 32

/* The blue-noise tile (shaders/noise/sequence.glsl, written by tools/generate/make_blue_noise.c): a
 * square of 32-bit values, row by row. */
#define MASU_BLUE_NOISE_SIZE 64
#define MASU_BLUE_NOISE_WORDS 4096

#endif
