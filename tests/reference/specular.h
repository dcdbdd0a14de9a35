/* specular.h: what the pixels of a baked scene mirror, in double precision: the truth of `masu render
 * --reference`.
 *
 * The sum over all directions of the light that comes from there, times the GGX lobe of the surface, by
 * Monte Carlo. Apart from the shaders in what can be: half vectors are drawn from the distribution of
 * normals itself, not from that of the visible ones, by a plain random generator; Smith's masking is
 * written by its Lambda; rays meet triangles in world space, in a tree of their own
 * (reference/triangles.h); light is that of tools/measure/shade.h. Alike are the formulas that
 * define the surface (shaders/brdf/bsdf.glsl), and where a ray begins: an eighth of the pixel's
 * width off its surface.
 *
 * Of scenes without textures and punctual lights, under a sky of two colours: masu_ref_mirror_open refuses
 * others. No shadow map either: the sun arrives everywhere. What leaves after more than one bounce between
 * facets is no part of it (`rest`, a part of the ambient light). A coat counts where the mirror has one, and
 * not on what is seen in it: coated things must not see each other. */
#ifndef MASU_REF_SPECULAR_H
#define MASU_REF_SPECULAR_H

#include "measure/view_uniforms.h"
#include "triangles.h"

typedef struct masu_ref_mirror {
    masu_ref_triangles world;
    masu_view view;
    double (*normals)[3][3]; /* of each triangle's corners, world space, unit */
    double (*looks)[8];      /* of each triangle, as masu_shade_exact takes them */
    double reach;            /* longest ray */
} masu_ref_mirror;

/* Nothing of the blob is kept. False, with one line in `error`: no memory, or what it does not know. */
bool masu_ref_mirror_open(const masu_scene *scene, const masu_camera *camera, uint32_t width,
                          uint32_t height, masu_ref_mirror *out, char *error, size_t error_size);
void masu_ref_mirror_close(masu_ref_mirror *m);

/* The surface under a pixel, from texels of the readback images. */
typedef struct masu_ref_surface {
    double at[3], normal[3], direction[3]; /* direction: from the eye */
    double width;                          /* of the pixel, there */
    double look[8];
    double coat, coat_roughness;
} masu_ref_surface;

/* False: the sky, or something that emits. The coat is in no image that can be read back: 0. */
bool masu_ref_surface_of(const masu_ref_mirror *m, uint32_t x, uint32_t y, float depth,
                         const uint8_t albedo[4], uint32_t normal, masu_ref_surface *out);

/* Over the rays: mean and variance of one. */
typedef struct masu_ref_estimate {
    double mean[3], variance[3];
} masu_ref_estimate;

masu_ref_estimate masu_ref_mirrored(const masu_ref_mirror *m, const masu_ref_surface *s,
                                    uint32_t rays, uint64_t seed);

/* Light of a ray; false: it meets nothing, and the light is the sky's. */
bool masu_ref_seen(const masu_ref_mirror *m, const double from[3], const double direction[3],
                   double out[3]);

#endif
