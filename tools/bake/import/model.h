/* model.h: the readers of models, as the child process calls them (assimp.c). */
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

/* What of a file is wanted. */
typedef struct masu_bake_wanted {
    masu_bake_textures textures;
    bool moving;         /* with its clips and skins, and the nodes they need, where it has any */
    bool plays;          /* the same, but only if the file has clips */
    const char *variant; /* of a glTF file's materials, or NULL */
} masu_bake_wanted;

/* Fills `piece`, which is not to be believed before it has been checked. Leaves warnings, one
 * per line, and on failure an error. */
void masu_bake_read_model(const char *path, const masu_bake_wanted *wanted, masu_bake_content *piece,
                          masu_bake_buffer *warnings, masu_bake_buffer *error);

#endif
