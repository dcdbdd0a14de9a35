/* measure.h: what ray tracing says of a patch: its look from straight above, texel by texel,
 * and its light and statistics from a list of view angles. Everything else in masu-meso is fitted to
 * this or held against it.
 *
 * A view looks down at `angle` from the vertical; rays are spread evenly over the period and over all
 * azimuths, so what comes out belongs to a surface that is turned at random. A light has an elevation
 * and an azimuth from the viewer's: 0 is light from behind the viewer, 180 against him; both hands of
 * an azimuth are used alike.
 *
 *   reference  sun: pi f (n.l) where the shadow ray is free; sky: the same BRDF over cosine-weighted
 *              rays that leave the relief, radiance 1. No light between facets. */
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
    uint32_t sky_rays; /* of each hit */
    uint64_t seed;
} masu_meso_setup;

typedef struct masu_meso_view {
    double angle;
    double toward, up; /* mean visible normal: towards the viewer along the ground, and up */
    double length;     /* of the mean normal: 1 is no spread */
    double ao, color[3];
    double sky[3];                       /* radiance under a sky of radiance 1 */
    double sun[MASU_MESO_LIGHTS_MAX][3]; /* radiance under each light */
    double lit[MASU_MESO_LIGHTS_MAX];    /* share of the visible that the light reaches */
} masu_meso_view;

/* false: no ray met the patch */
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

/* Radiance of `size * size` texels of the plane at `height` under each light of the setup and a sky of
 * radiance `sky`, seen from one azimuth: size * size * lights * 3 numbers. setup->view is not read;
 * setup->side^2 rays go through a texel. What lies above or below the plane is seen shifted, as it
 * would be in a picture. */
void masu_meso_look_along(const masu_meso_tracer *tracer, const masu_meso_patch *patch,
                          const masu_meso_setup *setup, double angle, double azimuth, double height,
                          double sky, uint32_t size, double *radiance);

/* The mean texel as a mip chain would make it: mean of the normals, what it lacks in length made into
 * roughness. */
masu_meso_texel masu_meso_mean_texel(const masu_meso_texel *texels, size_t count);

/* Unit vectors. */
masu_meso_vec3 masu_meso_from_above(double angle, double azimuth);
masu_meso_vec3 masu_meso_light_direction(const masu_meso_light *light, double view_azimuth,
                                         int hand);

/* Low-discrepancy numbers and rays for all who sample: the n-th point of a lattice (Roberts' R2), and
 * a direction about n with density cosine / pi. */
void masu_meso_point(uint64_t n, uint64_t seed, double *u, double *v);
masu_meso_vec3 masu_meso_cosine_ray(masu_meso_vec3 n, double u, double v);

#endif
