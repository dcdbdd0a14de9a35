/* creases.h: normals of triangles that came without any. */
#ifndef MASU_BAKE_CREASES_H
#define MASU_BAKE_CREASES_H

#include "bake/mesh/triangles.h"

/* Writes the quantised normal of each of `count` corners, three per triangle. The corners are
 * indices into the vertices of t, all in range, and no triangle has zero area. Edges below 60
 * degrees are smooth; other faces are flat-shaded. */
void masu_bake_creased_normals(const masu_bake_triangles *t, const uint32_t *corners,
                               uint64_t count, int16_t (*out)[2]);

#endif
