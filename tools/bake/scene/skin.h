/* skin.h: clips and skins of models that move (CLIPS to SKIN_VERTICES of the blob), as they come
 * from a piece into a scene. The content owns all of it; nothing here can fail. */
#ifndef MASU_BAKE_SKIN_H
#define MASU_BAKE_SKIN_H

#include "bake/scene/content.h"

/* For a model that has just been added, whose nodes are those of the piece: its skins, each with
 * vertices of its own. A mesh that another model has taken before is copied. Joints are those of
 * the model that it is like. */
void masu_bake_add_skins(masu_bake_content *content, const masu_bake_content *piece,
                         uint32_t model);

/* And its clips, for it and all that will be like it. */
void masu_bake_add_clips(masu_bake_content *content, const masu_bake_content *piece,
                         uint32_t model);

/* Whether joints bend a mesh of the scene. */
bool masu_bake_is_skinned(const masu_bake_content *content, uint32_t mesh);

/* Moves the vertices of skins to the end, in their order. Before anything is kept by a vertex's
 * number. */
void masu_bake_gather_skins(masu_bake_content *content);

#endif
