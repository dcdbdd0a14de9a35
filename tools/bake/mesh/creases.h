/* creases.h: normals of triangles that came without any. */
#ifndef MASU_BAKE_CREASES_H
#define MASU_BAKE_CREASES_H

#include "bake/mesh/triangles.h"

/* The quantised normal of each of `count` corners, three a triangle: indices into the vertices
 * of t, all in range, no triangle without area. Smooth where faces meet at less than 60 degrees,
 * else each face has its own. */
void masu_bake_creased_normals(const masu_bake_triangles *t, const uint32_t *corners, uint64_t count, int16_t (*out)[2]);

#endif
