/* stl.h: ASCII STL with keywords in capitals, which Assimp mistakes for binary. */
#ifndef MASU_BAKE_STL_H
#define MASU_BAKE_STL_H

#include "bake/base/buffer.h"

#include <stdbool.h>

/* True if a file is an STL, by its name. */
bool masu_bake_is_stl(const char *path);
/* Its text with keywords in lower case. False: they already are, or the file is binary. */
bool masu_bake_lower_stl(const char *text, size_t bytes, masu_bake_buffer *out);

#endif
