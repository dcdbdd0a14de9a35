/* geometry.h: what rays of the reference meet: triangles by Embree and the signed distance
 * field. */
#ifndef LAB_REFERENCE_GEOMETRY_H
#define LAB_REFERENCE_GEOMETRY_H

#include "lab/reference/field.h"
#include "lab/reference/scene.h"

#include <embree3/rtcore.h>

enum ref_ray_flags {
    REF_RAY_NO_BLENDS = 1, /* transparent surfaces are not there */
    REF_RAY_ONE_SIDED = 2, /* nor are single-sided ones from behind */
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
    ref_vec p, ng;     /* ng: unit, towards where the ray comes from */
    uint32_t triangle; /* REF_SDF: the field's */
    bool back;         /* of a triangle: clockwise */
} ref_hit;

/* center: floats of Embree are exact near it; the camera. */
bool ref_world_open(const ref_scene *scene, const ref_field *field, ref_vec center, ref_world *out,
                    char *error, size_t error_size);
void ref_world_close(ref_world *w);

/* The nearest surface within `far`; alpha-tested ones are not there in their holes. */
bool ref_world_trace(const ref_world *w, ref_vec from, ref_vec direction, double far,
                     unsigned flags, ref_hit *hit);
bool ref_world_occluded(const ref_world *w, ref_vec from, ref_vec direction, double far,
                        unsigned flags);
/* Where a ray towards d leaves the surface from. */
ref_vec ref_world_leave(const ref_world *w, const ref_hit *hit, ref_vec d);

/* The material at a hit, its normals on the side that the ray v (away from the surface) comes
 * from. cover: alpha of the map. */
typedef struct ref_look {
    ref_surface s;
    uint32_t flags;
    double cover, opacity;
} ref_look;
void ref_world_look(const ref_world *w, const ref_hit *hit, ref_vec v, ref_look *out);
/* A point of an emitting triangle and its radiance, towards both sides. */
ref_vec ref_world_emission(const ref_world *w, uint32_t triangle, double u, double v);

#endif
