/* sky_mirror.h: masu_ambient_mirror of shaders/light/ambient.glsl once more, in double, for an analytic sky: how
 * surfaces mirror it by their roughness. Of unit directions. */
#ifndef MASU_TEST_SKY_MIRROR_H
#define MASU_TEST_SKY_MIRROR_H

#include "frame/sky.h"

void sky_mirror(const masu_sky *sky, const double direction[3], double roughness, double out[3]);

#endif
