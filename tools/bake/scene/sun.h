/* sun.h: directional lights of model files. A blob has one sun: the scene's own, or the first of
 * these. */
#ifndef MASU_BAKE_SUN_H
#define MASU_BAKE_SUN_H

#include "bake/scene/content.h"

#define MASU_BAKE_SUN_NAME 128
#define MASU_BAKE_SUN_COLOR_MAX 1e6 /* as "sun.color" of a scene */

typedef struct masu_bake_sun {
    float direction[3]; /* towards it, unit length */
    float color[3];     /* irradiance on a facing surface / pi */
    char name[MASU_BAKE_SUN_NAME]; /* of its node */
} masu_bake_sun;

uint32_t masu_bake_sun_count(const masu_bake_content *content);
#define MASU_BAKE_SUNS(c) ((masu_bake_sun *)(void *)(c)->suns.data)

/* Nothing is added for a direction without a length, or for a light that is black. */
void masu_bake_add_sun(masu_bake_content *content, const char *name, masu_bake_vec3 direction,
                       const double color[3]);
/* NULL, or what is wrong with those of a piece from another process. */
const char *masu_bake_check_suns(const masu_bake_content *piece);
/* Those of a piece, in the scene's space; colours times `factor`. */
void masu_bake_place_suns(masu_bake_content *scene, const masu_bake_content *piece,
                          const masu_bake_affine *placement, double factor);

#endif
