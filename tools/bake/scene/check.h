/* check.h: a piece from another process, checked before any of its indices is followed. */
#ifndef MASU_BAKE_CHECK_H
#define MASU_BAKE_CHECK_H

#include "bake/scene/content.h"

/* NULL, or the first rule of blob.h that the piece breaks. */
const char *masu_bake_check(const masu_bake_content *piece);

#endif
