/* rise.h: how far the smooth surface that vertex normals describe rises above the triangles. */
#ifndef MASU_BAKE_RISE_H
#define MASU_BAKE_RISE_H

#include "bake/scene/content.h"

/* Sets masu_blob_primitive.rise of all primitives, LODs included. */
void masu_bake_measure_rise(masu_bake_content *content);

#endif
