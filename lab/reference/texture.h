/* texture.h: decodes one layer of a texture of a blob; ref_texture_at (scene.h) samples it. */
#ifndef LAB_REFERENCE_TEXTURE_H
#define LAB_REFERENCE_TEXTURE_H

#include "lab/reference/scene.h"

/* Decodes at full size; free() rgba. Returns false if out of memory. */
bool ref_texture_decode(const masu_blob_texture *t, const uint8_t *texels, uint32_t layer,
                        ref_texture *out);

#endif
