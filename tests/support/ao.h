/* ao.h: the true ambient occlusion of points of a scene, by rays: polygons by Embree, in single
 * precision, the SDF by marching its field in double.
 *
 * Seen part = mean over cosine-weighted directions about the normal of min(t / radius, 1), t the
 * distance of the nearest surface from either side: something at t < radius hides 1 - t / radius. The
 * same words define it for the SDF (shaders/sdf/occlusion.glsl, tests/reference/occlusion.h).
 *
 * Rays are spread by the sunflower's spiral, turned for each point by a hash of its number, so that an
 * error of too few rays is noise and no pattern. With 256 rays a point's own error is some 0.01. The
 * structure owns Embree's scene; nothing of the blob is kept. */
#ifndef SUPPORT_AO_H
#define SUPPORT_AO_H

#include "measure/truth.h"

typedef struct masu_ao_world {
    void *device, *scene; /* Embree's; NULL: no polygons */
    const masu_truth *field; /* NULL: no SDF */
    const masu_view *view;   /* of the field: parameters, time, bounds */
} masu_ao_world;

/* All instances of the scene where it places them, in the finest form. The blob behind the scene must
 * be readable. False, with one line in `error`: no memory, or Embree's reason. */
bool masu_ao_open(const masu_scene *scene, masu_ao_world *world, char *error, size_t error_size);
void masu_ao_close(masu_ao_world *world);

/* point: world space, on a surface; `lift`: how far off it rays start, metres. */
double masu_ao_seen(const masu_ao_world *world, const double point[3], const double normal[3],
                    double lift, double radius, uint32_t rays, uint32_t number);

#endif
