/* material.h: what a scene changes of the materials of a model. */
#ifndef MASU_BAKE_MATERIAL_H
#define MASU_BAKE_MATERIAL_H

#include "bake/scene/json.h"
#include "bake/scene/scene.h"

/* Where a file that a scene names is; to be freed. */
char *masu_bake_resolve(const char *name, const char *directory, const char *models_directory);

/* "material" and "materials" of a model: to be released. */
bool masu_bake_read_overrides(const masu_bake_json *model, const char *directory,
                              const masu_bake_request *request, masu_bake_content *content,
                              masu_bake_overrides *out);
bool masu_bake_overrides_equal(const masu_bake_overrides *a, const masu_bake_overrides *b);
void masu_bake_overrides_release(masu_bake_overrides *overrides);

/* Whether one of them names a picture: the model then needs texture coordinates. */
bool masu_bake_overrides_map(const masu_bake_json *model);

#endif
