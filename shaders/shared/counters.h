/* counters.h: counters of a frame, pairs of uint32 (low, high), which masu_stats reads back. */
#ifndef MASU_SHARED_COUNTERS_H
#define MASU_SHARED_COUNTERS_H

#define MASU_COUNTER_SDF_EVALS 0
#define MASU_COUNTER_SDF_HITS 1
#define MASU_COUNTER_SDF_UNCONVERGED 2
#define MASU_COUNTER_REPLACED 3 /* non-finite values replaced in stores */
#define MASU_COUNTER_SHADOW_EVALS 4
#define MASU_COUNTER_OCCLUSION_EVALS 5
#define MASU_COUNTER_SHADOW_UNCONVERGED 6
#define MASU_COUNTER_OCCLUSION_TESTS 7
/* After occlusion culling, per view: instances, triangles. */
#define MASU_COUNTER_VISIBLE 8
/* Pairs of punctual light and pixel: tested, lit; tiles that evaluate all lights. */
#define MASU_COUNTER_LIGHT_TESTS 18
#define MASU_COUNTER_LIGHT_SHADED 19
#define MASU_COUNTER_LIGHT_TILES_FULL 20
/* Reflections: tiles, rays, rays that hit polygons and the SDF, BVH nodes visited, SDF
 * evaluations. */
#define MASU_COUNTER_SPECULAR_TILES 21
#define MASU_COUNTER_SPECULAR_RAYS 22
#define MASU_COUNTER_SPECULAR_HITS 23
#define MASU_COUNTER_SPECULAR_SDF_HITS 24
#define MASU_COUNTER_SPECULAR_NODES 25
#define MASU_COUNTER_SPECULAR_EVALS 26
/* Groups of easu_fast in which every pixel took the early exit. */
#define MASU_COUNTER_EASU_TILES_EARLY 27
#define MASU_COUNTER_SMAA_TILES 28
/* The metered exposure, a float. */
#define MASU_COUNTER_EXPOSURE 29
#define MASU_COUNTER_COUNT 30

#endif
