/* model.h: the model readers, as called by the child process (assimp.c). */
#ifndef MASU_BAKE_MODEL_H
#define MASU_BAKE_MODEL_H

#include "bake/scene/content.h"

/* Whether texture coordinates and textures are imported. FORCED: coordinates even if the file's
 * materials have no textures, because the scene adds some. */
typedef enum masu_bake_textures {
    MASU_BAKE_TEXTURES_WANTED,
    MASU_BAKE_TEXTURES_FORCED,
    MASU_BAKE_TEXTURES_OFF
} masu_bake_textures;

/* The parts of a file to import. */
typedef struct masu_bake_wanted {
    masu_bake_textures textures;
    bool moving;         /* with its clips and skins and their nodes, if it has any */
    bool plays;          /* the same, but only if the file has clips */
    const char *variant; /* of a glTF file's materials, or NULL */
} masu_bake_wanted;

/* Fills `piece`, which must be checked before use. Writes warnings, one per line, and on failure an
 * error. */
void masu_bake_read_model(const char *path, const masu_bake_wanted *wanted,
                          masu_bake_content *piece, masu_bake_buffer *warnings,
                          masu_bake_buffer *error);

#endif
