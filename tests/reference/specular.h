/* specular.h: reflections at the pixels of a baked scene, in double precision: the reference of
 * `masu render --reference`.
 *
 * Integrates the incoming light over all directions, times the GGX lobe of the surface, by Monte
 * Carlo. Independent of the shaders where possible: half vectors are sampled from the distribution
 * of normals itself, not of the visible ones, by a plain random generator; Smith's masking is
 * written with Lambda; rays intersect triangles in world space, in a separate BVH
 * (reference/triangles.h); shading is from tools/measure/shade.h. Shared are the formulas that
 * define the surface (shaders/brdf/bsdf.glsl), and the ray origin: an eighth of the pixel's width
 * off the surface.
 *
 * Limits: no textures, no punctual lights, and a sky of two colours; masu_ref_mirror_open rejects
 * other scenes. No shadow map: the sun is visible everywhere. Light from more than one bounce
 * between facets is not included (`rest`, a part of the ambient light). A coat is included on the
 * mirror, but not on the surfaces that it reflects: coated objects must not reflect each other. */
#ifndef MASU_REF_SPECULAR_H
#define MASU_REF_SPECULAR_H

#include "measure/view_uniforms.h"
#include "triangles.h"

typedef struct masu_ref_mirror {
    masu_ref_triangles world;
    masu_view view;
    double (*normals)[3][3]; /* at each triangle's corners, world space, unit */
    double (*looks)[8];      /* per triangle, as masu_shade_exact takes them */
    double reach;            /* longest ray */
} masu_ref_mirror;

/* Keeps no reference to the blob. On failure: false, and one line in `error` (no memory, or the
 * unsupported feature). */
bool masu_ref_mirror_open(const masu_scene *scene, const masu_camera *camera, uint32_t width,
                          uint32_t height, masu_ref_mirror *out, char *error, size_t error_size);
void masu_ref_mirror_close(masu_ref_mirror *m);

/* The surface under a pixel, from texels of the readback images. */
typedef struct masu_ref_surface {
    double at[3], normal[3], direction[3]; /* direction: from the camera */
    double width;                          /* of the pixel, at the surface */
    double look[8];
    double coat, coat_roughness;
} masu_ref_surface;

/* False: the sky, or an emitter. No readback image has the coat: 0. */
bool masu_ref_surface_of(const masu_ref_mirror *m, uint32_t x, uint32_t y, float depth,
                         const uint8_t albedo[4], uint32_t normal, masu_ref_surface *out);

/* Over the rays: mean, and variance of a single ray. */
typedef struct masu_ref_estimate {
    double mean[3], variance[3];
} masu_ref_estimate;

masu_ref_estimate masu_ref_mirrored(const masu_ref_mirror *m, const masu_ref_surface *s,
                                    uint32_t rays, uint64_t seed);

/* Radiance along a ray; false: no hit, and the radiance is the sky's. */
bool masu_ref_seen(const masu_ref_mirror *m, const double from[3], const double direction[3],
                   double out[3]);

#endif
