/* attributes.h: colours and second texture coordinates of vertices (content.h), which depend on the
 * textures of the scene's materials. Neither function can fail. */
#ifndef MASU_BAKE_ATTRIBUTES_H
#define MASU_BAKE_ATTRIBUTES_H

#include "bake/scene/content.h"

/* Call it before textures are made. Vertices have colours only together with textures (blob.h), so
 * a material with vertex colours and no texture gets a white one. */
void masu_bake_whiten(masu_bake_content *content);
/* Call it after textures are made. Each attribute then has as many elements as there are vertices,
 * or none if no material uses it. */
void masu_bake_finish_attributes(masu_bake_content *content);

#endif
