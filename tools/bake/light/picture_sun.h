/* picture_sun.h: finds the sun of a panorama and removes it from the pixels. A spot of one degree
 * with most of the light is beyond what order-2 harmonics and prefiltered mips resolve; as a
 * directional light it is exact. */
#ifndef MASU_BAKE_PICTURE_SUN_H
#define MASU_BAKE_PICTURE_SUN_H

#include "bake/light/environment.h"

typedef struct masu_bake_picture_sun {
    double direction[3]; /* towards it, unit length */
    double color[3];     /* irradiance on a facing surface / pi */
} masu_bake_picture_sun;

/* False: the panorama has no sun, and is unchanged. */
bool masu_bake_cut_sun(masu_bake_panorama *p, masu_bake_picture_sun *out);

#endif
