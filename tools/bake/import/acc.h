/* acc.h: TORCS's dialect of AC3D, which Assimp does not know. */
#ifndef MASU_BAKE_ACC_H
#define MASU_BAKE_ACC_H

#include "bake/base/buffer.h"

#include <stdbool.h>

/* Whether a file is of that dialect, by its name. */
bool masu_bake_is_acc(const char *path);
/* Its text without what Assimp would misread. */
void masu_bake_strip_acc(const char *text, size_t bytes, masu_bake_buffer *out);

#endif
