/* bump.h: converts height maps to normal maps. A model's "bump map" may contain heights (grey) or
 * normals, regardless of the name; the texels decide. Pure functions on arrays of the caller;
 * they cannot fail. */
#ifndef MASU_BAKE_BUMP_H
#define MASU_BAKE_BUMP_H

#include "bake/scene/content.h"

/* The height difference between black and white, as a share of the texture's longer side, at
 * strength 1. It suits textures of bricks or skin, which usually show a surface ten to a hundred
 * times wider than deep. */
#define MASU_BUMP_HEIGHT 0.01

/* The steepest slope. Without this limit, adjacent black and white texels would become walls that
 * have no colour. */
#define MASU_BUMP_SLOPE_MAX 4.0

/* True if these texels, 4 bytes each, contain heights; relief: MASU_BAKE_RELIEF_*. */
bool masu_bump_is_height(const uint8_t *rgba, uint32_t width, uint32_t height, int relief);

/* Converts heights (the luminance of the texels) to normals: 4 floats per texel, +y towards the top
 * of the texture, the fourth float is 1. clamped: for u and for v, whether the texture is clamped
 * at its edge instead of repeated. */
void masu_bump_normals(const uint8_t *rgba, uint32_t width, uint32_t height, double strength,
                       const bool clamped[2], float *normals);

#endif
