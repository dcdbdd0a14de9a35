/* triangles.h: the polygons of a baked scene in world space, in double precision, and the first of
 * them along a ray: the truth of shadow maps. A tree of boxes, split at the median; a triangle
 * counts from both sides. */
#ifndef MASU_REF_TRIANGLES_H
#define MASU_REF_TRIANGLES_H

#include "masu.h"

typedef struct masu_ref_triangle {
    double a[3], b[3], c[3];
    uint32_t instance, primitive;
    uint32_t vertex[3]; /* of the blob */
} masu_ref_triangle;

typedef struct masu_ref_node {
    double low[3], high[3];
    uint32_t first, count; /* triangles of a leaf; count 0: children at first and first + 1 */
} masu_ref_node;

typedef struct masu_ref_triangles {
    masu_ref_triangle *triangles;
    uint32_t count;
    masu_ref_node *nodes;
} masu_ref_triangles;

/* The blob behind the scene must be readable; nothing of it is kept. Returns 0 without memory. */
int masu_ref_triangles_open(const masu_scene *scene, masu_ref_triangles *out);
void masu_ref_triangles_close(masu_ref_triangles *t);

/* The first triangle with distance (in units of `direction`) in (nearest, farthest): its index, its
 * distance in *t. -1: none. */
int64_t masu_ref_hit(const masu_ref_triangles *scene, const double from[3],
                     const double direction[3], double nearest, double farthest, double *t);

/* Unit normal of a triangle, on the side of `towards`. 0: it has no area. */
int masu_ref_normal(const masu_ref_triangle *triangle, const double towards[3], double out[3]);

/* Share of a sun's disc of that tangent that is seen from a surface point; 1 ray: of its middle.
 * `skip`: the triangle that the point is on. */
double masu_ref_sun_share(const masu_ref_triangles *scene, const double point[3], uint32_t skip,
                          const double sun[3], double tangent, int rays);

#endif
