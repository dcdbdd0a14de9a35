/* skin.h: copies clips and skins of animated models (CLIPS to SKIN_VERTICES of the blob) from a
 * piece to a scene. The content owns all data; no function here can fail. */
#ifndef MASU_BAKE_SKIN_H
#define MASU_BAKE_SKIN_H

#include "bake/scene/content.h"

/* Adds the skins of a model that has just been added, with the nodes of the piece. Each skin has
 * separate vertices; a mesh that another model already uses is copied. The joints belong to the
 * first model of its kind. */
void masu_bake_add_skins(masu_bake_content *content, const masu_bake_content *piece,
                         uint32_t model);

/* Adds the clips, for this model and later ones of its kind. */
void masu_bake_add_clips(masu_bake_content *content, const masu_bake_content *piece,
                         uint32_t model);

/* True if a mesh of the scene is skinned. */
bool masu_bake_is_skinned(const masu_bake_content *content, uint32_t mesh);

/* Moves the vertices of skins to the end, in their order. Call it before any vertex index is
 * stored. */
void masu_bake_gather_skins(masu_bake_content *content);

#endif
