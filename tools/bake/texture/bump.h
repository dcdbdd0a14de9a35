/* bump.h: heights become normals. What a model calls a bump map may be heights (grey) or, in
 * spite of its name, normals, and the other way round: the texels say which. Pure functions on
 * arrays of the caller's; nothing can fail. */
#ifndef MASU_BAKE_BUMP_H
#define MASU_BAKE_BUMP_H

#include "bake/scene/content.h"

/* Black to white is as high as this share of the picture's longer side, times the strength: what
 * a picture of bricks or of skin wants, which mostly shows something ten to a hundred times as
 * wide as it is deep. */
#define MASU_BUMP_HEIGHT 0.01

/* Steeper is not made: neighbours of black and white would else be walls without a colour of
 * their own. */
#define MASU_BUMP_SLOPE_MAX 4.0

/* Whether these texels, 4 bytes each, are to be read as heights; relief: MASU_BAKE_RELIEF_*. */
bool masu_bump_is_height(const uint8_t *rgba, uint32_t width, uint32_t height, int relief);

/* Heights (the luminance of what is in the picture) to normals, 4 floats a texel, +y up the
 * picture, the fourth 1. clamped: along u, along v: whether the picture ends at its edge instead
 * of being repeated. */
void masu_bump_normals(const uint8_t *rgba, uint32_t width, uint32_t height, double strength,
                       const bool clamped[2], float *normals);

#endif
