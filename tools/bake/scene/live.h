/* live.h: the models of a scene that the host can move, show and hide as a unit: MODELS and
 * MODEL_NODES of the blob. The content owns all data; no function here can fail. */
#ifndef MASU_BAKE_LIVE_H
#define MASU_BAKE_LIVE_H

#include "bake/scene/content.h"

/* Makes a model of the instances from `first` on, which have just been placed from `piece` by
 * `placement`. Each instance is a node below its parent's node; if the piece has nodes, these are
 * used. translation: from the model's own space to the world. `like`: the index of the first model
 * of its kind, or MASU_BLOB_NONE: this is the first, and the piece's clips become its own. Returns
 * its index. */
uint32_t masu_bake_add_model(masu_bake_content *content, const masu_bake_content *piece,
                             uint64_t first, const masu_bake_affine *placement,
                             masu_bake_vec3 translation, const char *name, bool hidden,
                             uint32_t like);

/* The model's lights without an instance, those from `first` on, are attached to its first
 * instance: they move and hide with it. */
void masu_bake_carry_lights(masu_bake_content *content, uint64_t first_light,
                            uint64_t first_instance);

/* Updates the models after instances have been renumbered: place[old] = new. */
void masu_bake_renumber_models(masu_bake_content *content, const uint32_t *place);

/* One byte for each instance: 1 if it is hidden at first. The caller frees it. */
unsigned char *masu_bake_hidden(const masu_bake_content *content);

#endif
