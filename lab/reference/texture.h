/* texture.h: decodes one layer of a texture of a blob; ref_texture_at (scene.h) looks it up. */
#ifndef LAB_REFERENCE_TEXTURE_H
#define LAB_REFERENCE_TEXTURE_H

#include "lab/reference/scene.h"

/* Full size; free() rgba. False: out of memory. */
bool ref_texture_decode(const masu_blob_texture *t, const uint8_t *texels, uint32_t layer,
                        ref_texture *out);

#endif
