/* texture.h: converts the images that materials use to the textures of the blob. */
#ifndef MASU_BAKE_TEXTURE_H
#define MASU_BAKE_TEXTURE_H

#include "bake/scene/content.h"

/* Fills TEXTURES, TEXTURE_SETS and TEXELS and sets the texture indices of the materials. Without
 * any usable image it removes TEXCOORDS. An unusable image is a warning, and its materials use only
 * their factors. `directories`: as for masu_bake_read_image. Returns false, after a message, only
 * if the textures exceed the limits of a blob. */
bool masu_bake_make_textures(masu_bake_content *content, const char *directories);

#endif
