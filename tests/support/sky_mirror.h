/* sky_mirror.h: masu_ambient_mirror of shaders/light/ambient.glsl in double precision, for an
 * analytic sky: the sky's reflection by roughness. Directions are unit vectors. */
#ifndef MASU_TEST_SKY_MIRROR_H
#define MASU_TEST_SKY_MIRROR_H

#include "frame/sky.h"

void sky_mirror(const masu_sky *sky, const double direction[3], double roughness, double out[3]);

#endif
