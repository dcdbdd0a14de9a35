/* picture_light.h: irradiance of a panorama, as the coefficients of masu_blob_environment_map:
 * spherical harmonics of order 2, one lobe, and a function of the elevation. */
#ifndef MASU_BAKE_PICTURE_LIGHT_H
#define MASU_BAKE_PICTURE_LIGHT_H

#include "bake/light/environment.h"

/* Sets out->sh. */
void masu_bake_fit_irradiance(const masu_bake_panorama *p, masu_blob_environment_map *out);

/* Irradiance / pi of a unit normal, as shaders/light/ambient.glsl computes it. */
void masu_bake_irradiance_at(const masu_blob_environment_map *map, const double normal[3],
                             double out[3]);

#endif
