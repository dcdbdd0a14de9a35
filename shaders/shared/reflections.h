/* reflections.h: bounds of the reflection filters. The buffer SPECULAR_TILES lists the tiles with
 * traced pixels as types.h describes. */
#ifndef MASU_SHARED_REFLECTIONS_H
#define MASU_SHARED_REFLECTIONS_H

#define MASU_REUSE_TAPS_MAX 16       /* neighbours of specular_reuse */
#define MASU_FILTER_TAPS_MAX 32      /* neighbours of specular_filter */
#define MASU_SPECULAR_FRAMES_MAX 240 /* longest temporal accumulation, in 1/60 s */

#endif
