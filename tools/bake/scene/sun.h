/* sun.h: directional lights of model files. A blob has one sun: the scene's own, or the first
 * directional light of its models. */
#ifndef MASU_BAKE_SUN_H
#define MASU_BAKE_SUN_H

#include "bake/scene/content.h"

#define MASU_BAKE_SUN_NAME 128
#define MASU_BAKE_SUN_COLOR_MAX 1e6 /* as "sun.color" of a scene */

typedef struct masu_bake_sun {
    float direction[3]; /* towards the light, unit length */
    float color[3];     /* irradiance on a facing surface / pi */
    char name[MASU_BAKE_SUN_NAME]; /* name of its node */
} masu_bake_sun;

uint32_t masu_bake_sun_count(const masu_bake_content *content);
#define MASU_BAKE_SUNS(c) ((masu_bake_sun *)(void *)(c)->suns.data)

/* Adds nothing if the direction has no length or the light is black. */
void masu_bake_add_sun(masu_bake_content *content, const char *name, masu_bake_vec3 direction,
                       const double color[3]);
/* NULL, or the error in a piece's lights from another process. */
const char *masu_bake_check_suns(const masu_bake_content *piece);
/* Adds a piece's lights, in the scene's space; colours times `factor`. */
void masu_bake_place_suns(masu_bake_content *scene, const masu_bake_content *piece,
                          const masu_bake_affine *placement, double factor);

#endif
