/* parts.h: the parts of building a scene; see build.h. Only build.c calls them. Those that can fail
 * report it and return false. */
#ifndef MASU_BAKE_PARTS_H
#define MASU_BAKE_PARTS_H

#include "bake/description/description.h"

/* The models from `start` on. */
bool masu_bake_build_models(const masu_bake_description *d, size_t start,
                            masu_bake_textures textures, masu_bake_content *content);
bool masu_bake_build_lights(const masu_bake_description *d, masu_bake_content *content);

#endif
