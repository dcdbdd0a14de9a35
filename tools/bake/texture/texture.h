/* texture.h: the pictures that materials ask for become the blob's textures. */
#ifndef MASU_BAKE_TEXTURE_H
#define MASU_BAKE_TEXTURE_H

#include "bake/scene/content.h"

/* Fills TEXTURES, TEXTURE_SETS and TEXELS and points the materials at them; without any usable
 * picture takes TEXCOORDS away. A picture that cannot be used is a warning, and its materials
 * have their factors alone. `directories`: as masu_bake_read_image. False only when the textures
 * are more than a blob can hold; reported. */
bool masu_bake_make_textures(masu_bake_content *content, const char *directories);

#endif
