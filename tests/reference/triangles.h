/* triangles.h: the polygons of a baked scene in world space, in double precision, and ray
 * intersection: the reference for shadow maps. A BVH split at the median; triangles are
 * two-sided. */
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

/* The blob behind the scene must be readable; the result does not refer to it. Returns 0 without
 * memory. */
int masu_ref_triangles_open(const masu_scene *scene, masu_ref_triangles *out);
void masu_ref_triangles_close(masu_ref_triangles *t);

/* The first triangle with a distance (in units of `direction`) in (nearest, farthest): returns its
 * index, or -1 for none, and its distance in *t. */
int64_t masu_ref_hit(const masu_ref_triangles *scene, const double from[3],
                     const double direction[3], double nearest, double farthest, double *t);

/* Unit normal of a triangle, on the side of `towards`. Returns 0 if the triangle has no area. */
int masu_ref_normal(const masu_ref_triangle *triangle, const double towards[3], double out[3]);

/* Visible fraction of a sun disc with that tangent, from a surface point; 1 ray: to its centre.
 * `skip`: the triangle that contains the point. */
double masu_ref_sun_share(const masu_ref_triangles *scene, const double point[3], uint32_t skip,
                          const double sun[3], double tangent, int rays);

#endif
