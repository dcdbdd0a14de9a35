/* ao.h: reference ambient occlusion at points of a scene, by ray tracing: polygons with Embree, in
 * single precision; the SDF by sphere tracing, in double precision.
 *
 * Visibility = mean over cosine-weighted directions about the normal of min(t / radius, 1), where t
 * is the distance to the nearest surface, from either side: a hit at t < radius occludes 1 - t /
 * radius. The SDF has the same definition (shaders/sdf/occlusion.glsl,
 * tests/reference/occlusion.h).
 *
 * Ray directions follow a sunflower spiral, rotated for each point by a hash of its number, so that
 * the error of too few rays is noise without a pattern. With 256 rays the error of one point is
 * about 0.01. The structure owns Embree's scene and does not refer to the blob. */
#ifndef SUPPORT_AO_H
#define SUPPORT_AO_H

#include "measure/truth.h"

typedef struct masu_ao_world {
    void *device, *scene; /* Embree's; NULL: no polygons */
    const masu_truth *field; /* NULL: no SDF */
    const masu_view *view;   /* for the field: parameters, time, bounds */
} masu_ao_world;

/* All instances of the scene at their baked transforms, in the most detailed LOD. The blob behind
 * the scene must be readable. On failure: false, and one line in `error` (no memory, or Embree's
 * reason). */
bool masu_ao_open(const masu_scene *scene, masu_ao_world *world, char *error, size_t error_size);
void masu_ao_close(masu_ao_world *world);

/* point: world space, on a surface. lift: distance from the surface at which rays start, metres. */
double masu_ao_seen(const masu_ao_world *world, const double point[3], const double normal[3],
                    double lift, double radius, uint32_t rays, uint32_t number);

#endif
