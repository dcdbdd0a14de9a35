/* blob.h: the finished content as the bytes of a .masu blob (src/scene/blob.h, docs/blob.md). */
#ifndef MASU_BAKE_BLOB_H
#define MASU_BAKE_BLOB_H

#include "bake/scene/content.h"

/* Lays out header, section table and payloads in `out`, which is empty before. The same content
 * gives the same bytes. */
void masu_bake_make_blob(const masu_bake_content *content, masu_bake_buffer *out);

const char *masu_bake_kind_name(uint32_t kind); /* "vertices"; for statistics */

#endif
