/* model.h: the reader of models, as the child process calls it (assimp.c). */
#ifndef MASU_BAKE_MODEL_H
#define MASU_BAKE_MODEL_H

#include "bake/scene/content.h"

/* Whether texture coordinates and textures are wanted. FORCED: coordinates even where the file's
 * materials have no textures, because the scene gives some. */
typedef enum masu_bake_textures {
    MASU_BAKE_TEXTURES_WANTED,
    MASU_BAKE_TEXTURES_FORCED,
    MASU_BAKE_TEXTURES_OFF
} masu_bake_textures;

/* Fills `piece`, which is not to be believed before it has been checked. Leaves warnings, one per line,
 * and on failure an error. moving: where the file has clips or skins, with these and the nodes they need. */
void masu_bake_read_model(const char *path, masu_bake_textures textures, bool moving,
                          masu_bake_content *piece, masu_bake_buffer *warnings,
                          masu_bake_buffer *error);

#endif
