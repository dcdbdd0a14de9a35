/* measure.h: measurements of a patch by ray tracing: its appearance from straight above, texel by
 * texel, and its radiance and statistics for a list of view angles. Everything else in masu-meso is
 * fitted to them or compared with them.
 *
 * A view looks down at `angle` from the vertical. Rays are spread evenly over the period and over
 * all azimuths, so the result belongs to a surface in random orientation. A light has an elevation
 * and an azimuth relative to the viewer's: 0 is light from behind the viewer, 180 from the front;
 * both sides of an azimuth have equal weight.
 *
 *   reference  sun: pi f (n.l) if the shadow ray is free; sky: the same BRDF over cosine-weighted
 *              rays that leave the relief, radiance 1. No interreflection between facets. */
#ifndef MASU_MESO_MEASURE_H
#define MASU_MESO_MEASURE_H

#include "meso/brdf.h"
#include "meso/trace.h"

#define MASU_MESO_VIEWS_MAX 16
#define MASU_MESO_LIGHTS_MAX 96

typedef struct masu_meso_light {
    double elevation, azimuth; /* degrees */
} masu_meso_light;

typedef struct masu_meso_setup {
    double view[MASU_MESO_VIEWS_MAX]; /* degrees from the vertical */
    masu_meso_light light[MASU_MESO_LIGHTS_MAX];
    uint32_t view_count, light_count;
    uint32_t side;     /* side * side rays per view */
    uint32_t sky_rays; /* per hit */
    uint64_t seed;
} masu_meso_setup;

typedef struct masu_meso_view {
    double angle;
    double toward, up; /* mean visible normal: towards the viewer along the ground, and up */
    double length;     /* of the mean normal: 1 means no spread */
    double ao, color[3];
    double sky[3];                       /* radiance under a sky of radiance 1 */
    double sun[MASU_MESO_LIGHTS_MAX][3]; /* radiance under each light */
    double lit[MASU_MESO_LIGHTS_MAX];    /* fraction of the visible surface that the light
                                          * reaches */
} masu_meso_view;

/* Returns false if no ray hit the patch. */
bool masu_meso_measure(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                       const masu_meso_setup *setup, masu_meso_view *views);

/* The patch from straight above: size * size texels, `samples`^2 rays each. */
typedef struct masu_meso_texel {
    double color[3];  /* linear albedo */
    double normal[3]; /* unit: x, y up, z */
    double roughness; /* with the spread within the texel */
    double ao;
} masu_meso_texel;

void masu_meso_look_down(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                         uint32_t size, uint32_t samples, uint32_t sky_rays, uint64_t seed,
                         masu_meso_texel *texels, double *mean_height);

/* Radiance of `size * size` texels of the plane at `height`, viewed from one azimuth under each
 * light of the setup and a sky of radiance `sky`: size * size * lights * 3 numbers. Does not read
 * setup->view; traces setup->side^2 rays per texel. Parts above or below the plane appear shifted,
 * as in an image. */
void masu_meso_look_along(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                          const masu_meso_setup *setup, double angle, double azimuth, double height,
                          double sky, uint32_t size, double *radiance);

/* The mean texel of a mip chain: the mean normal, with its lost length converted to roughness. */
masu_meso_texel masu_meso_mean_texel(const masu_meso_texel *texels, size_t count);

/* Unit vectors. */
masu_meso_vec3 masu_meso_from_above(double angle, double azimuth);
masu_meso_vec3 masu_meso_light_direction(const masu_meso_light *light, double view_azimuth,
                                         int hand);

/* Low-discrepancy samples: the n-th point of a lattice (Roberts' R2), and a direction around n with
 * density cosine / pi. */
void masu_meso_point(uint64_t n, uint64_t seed, double *u, double *v);
masu_meso_vec3 masu_meso_cosine_ray(masu_meso_vec3 n, double u, double v);

#endif
