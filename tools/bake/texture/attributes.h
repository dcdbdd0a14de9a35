/* attributes.h: colours and second texture coordinates of vertices (content.h), which depend on
 * what textures the materials of a scene have. Neither function can fail. */
#ifndef MASU_BAKE_ATTRIBUTES_H
#define MASU_BAKE_ATTRIBUTES_H

#include "bake/scene/content.h"

/* Before textures are made: vertices have colours only together with textures (blob.h), so that
 * what has colours and no picture gets a white one. */
void masu_bake_whiten(masu_bake_content *content);
/* After them: as many as vertices, or none where no material has a use for them. */
void masu_bake_finish_attributes(masu_bake_content *content);

#endif
