/* surface.h: geometric queries on triangle surfaces, in double precision: distance to a point,
 * largest distance between two surfaces, closed parts, and inside tests. Validates simplified
 * meshes and occluders. */
#ifndef MASU_BAKE_SURFACE_H
#define MASU_BAKE_SURFACE_H

#include "bake/scene/content.h"

typedef struct masu_bake_surface {
    masu_bake_vec3 (*triangles)[3]; /* in the order of the tree's leaves */
    size_t count;
    struct masu_bake_surface_node *nodes;
} masu_bake_surface;

/* Copies the triangles; there may be none. */
masu_bake_surface masu_bake_surface_make(const masu_bake_vec3 (*triangles)[3], size_t count);
void masu_bake_surface_release(masu_bake_surface *surface);

/* Triangles of primitives [first, first + count) appended to `out` (masu_bake_vec3[3] each). */
void masu_bake_surface_collect(const masu_bake_content *content, uint32_t first, uint32_t count,
                               masu_bake_buffer *out);

/* Distance to a triangle, and to the surface; DBL_MAX: it is empty. `which`, if not NULL, is a
 * guess of the nearest triangle, any valid index, and becomes it. */
double masu_bake_triangle_distance(const masu_bake_vec3 t[3], masu_bake_vec3 p);
double masu_bake_surface_distance(const masu_bake_surface *surface, masu_bake_vec3 p,
                                  size_t *which);

/* An upper bound of the largest distance from any point of `from` to the closest point of `to`. It
 * is a bound, not a sample: a triangle is subdivided until its corners' distance to ONE triangle of
 * `to` (convex, so largest at a corner) is only slightly above the largest distance found at a
 * corner. DBL_MAX if the distance is found to be over `limit`. */
double masu_bake_surface_deviation(const masu_bake_surface *from, const masu_bake_surface *to,
                                   double limit);

/* Numbers the parts that hang together by equal corners: part[i] for triangle i. Returns how many.
 * closed[part]: each edge is passed as often one way as the other, so that the part bounds a
 * volume whichever way its triangles cross each other. Both arrays are of `count` elements. */
uint32_t masu_bake_surface_parts(const masu_bake_vec3 (*triangles)[3], size_t count, uint32_t *part,
                                 bool *closed);

/* How often closed triangles wrap around p: a whole number where p is not on them. */
double masu_bake_winding(const masu_bake_vec3 (*triangles)[3], size_t count, masu_bake_vec3 p);

/* True only if box and triangle are separated by at least `margin`. */
bool masu_bake_box_apart(const masu_bake_box *box, const masu_bake_vec3 t[3], double margin);

#endif
