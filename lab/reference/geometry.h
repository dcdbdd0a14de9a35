/* geometry.h: ray intersections of the reference: triangles by Embree, and the signed distance
 * field. */
#ifndef LAB_REFERENCE_GEOMETRY_H
#define LAB_REFERENCE_GEOMETRY_H

#include "lab/reference/field.h"
#include "lab/reference/scene.h"

#include <embree3/rtcore.h>

enum ref_ray_flags {
    REF_RAY_NO_BLENDS = 1, /* ignore transparent surfaces */
    REF_RAY_ONE_SIDED = 2, /* ignore single-sided ones from behind */
    REF_RAY_NO_SDF = 4,
    REF_RAY_NO_TRIANGLES = 8
};

typedef struct ref_world {
    const ref_scene *scene;
    const ref_field *field; /* NULL: none */
    RTCDevice device;
    RTCScene embree;
    float *positions; /* relative to `center` */
    ref_vec center;
} ref_world;

#define REF_SDF UINT32_MAX
typedef struct ref_hit {
    double t, u, v;
    ref_vec p, ng;     /* ng: unit, towards the ray's origin */
    uint32_t triangle; /* REF_SDF: the field's */
    bool back;         /* of a triangle: viewed clockwise */
} ref_hit;

/* center: Embree's floats are most precise near it; use the camera. */
bool ref_world_open(const ref_scene *scene, const ref_field *field, ref_vec center, ref_world *out,
                    char *error, size_t error_size);
void ref_world_close(ref_world *w);

/* The nearest surface within `far`; holes of alpha-tested surfaces are ignored. */
bool ref_world_trace(const ref_world *w, ref_vec from, ref_vec direction, double far,
                     unsigned flags, ref_hit *hit);
bool ref_world_occluded(const ref_world *w, ref_vec from, ref_vec direction, double far,
                        unsigned flags);
/* Start of a ray in direction d from the surface. */
ref_vec ref_world_leave(const ref_world *w, const ref_hit *hit, ref_vec d);

/* The material at a hit, with normals on the side of v, the direction back along the ray. cover:
 * alpha of the map. */
typedef struct ref_look {
    ref_surface s;
    uint32_t flags;
    double cover, opacity;
} ref_look;
void ref_world_look(const ref_world *w, const ref_hit *hit, ref_vec v, ref_look *out);
/* The emitted radiance at a point of a triangle, in both directions. */
ref_vec ref_world_emission(const ref_world *w, uint32_t triangle, double u, double v);

#endif
