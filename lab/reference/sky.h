/* sky.h: light from outside the scene: a gradient, the blob's environment map, or a panorama; and
 * importance sampling of the last two. */
#ifndef LAB_REFERENCE_SKY_H
#define LAB_REFERENCE_SKY_H

#include "lab/reference/vec.h"
#include "scene/blob.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct ref_sky {
    ref_vec zenith, horizon, ambient;
    /* A map: radiance over the octahedron (texels of the blob's mip 0), or over latitude and
     * longitude; neither: the gradient */
    const uint32_t *octahedron;
    uint32_t size;
    const float *panorama; /* rows from the zenith down, 3 floats per pixel */
    uint32_t width, height;
    double turn, factor; /* azimuth of the panorama's centre, radians; factor on its radiance */
    /* Distribution over cells of equal latitude and longitude steps: by row, then by column */
    double *rows, *columns;
    uint32_t grid_width, grid_height;
} ref_sky;

static inline bool ref_sky_is_map(const ref_sky *s) { return s->octahedron || s->panorama; }

/* Builds the distribution of a map. Returns false if out of memory. */
bool ref_sky_prepare(ref_sky *s);
void ref_sky_close(ref_sky *s);

/* Radiance from a direction, without the sun. */
ref_vec ref_sky_at(const ref_sky *s, ref_vec d);
/* The same, but `ambient` without a map: the light of diffuse surfaces in Masu. */
ref_vec ref_sky_soft(const ref_sky *s, ref_vec d);

/* Samples an environment map: a direction, and its probability density. */
ref_vec ref_sky_sample(const ref_sky *s, ref_random *r, double *pdf);
double ref_sky_pdf(const ref_sky *s, ref_vec d);

#endif
