/* author.h: builds a material from a relief patch: its map of texels, the measurement of its
 * appearance by view angle, and the curves fitted to that measurement. Start with
 * masu_meso_author. */
#ifndef MASU_MESO_AUTHOR_H
#define MASU_MESO_AUTHOR_H

#include "meso/fit.h"

typedef struct masu_meso_options {
    uint32_t size; /* texels of an edge of the map; a power of two from 32 */
    uint32_t side; /* side^2 rays per view */
    uint32_t sky_rays;
    uint64_t seed;
} masu_meso_options;

typedef struct masu_meso_material {
    masu_meso_texel *texels; /* width and height of the map, texels; a power of two from 32 */
    uint32_t size;
    masu_meso_texel mean;
    double height; /* mean height of the visible surface, from above */
    masu_meso_setup setup;
    masu_meso_view views[MASU_MESO_VIEWS_MAX];
    masu_meso_curves curves;
    masu_meso_misfit misfit;
    masu_meso_sky_table table;
} masu_meso_material;

/* False after an error message. Free in both cases. */
bool masu_meso_author(const masu_meso_patch *patch, const masu_meso_options *options,
                      masu_meso_material *made);
void masu_meso_material_free(masu_meso_material *made);

/* The mip level of made->texels with width and height `size`; the caller frees it. */
masu_meso_texel *masu_meso_mip(const masu_meso_material *made, uint32_t size);

/* All combinations of these elevations and azimuths, in degrees. */
void masu_meso_set_lights(masu_meso_setup *s, const double *elevation, uint32_t elevations,
                          const double *azimuth, uint32_t azimuths);

/* Zeroed memory; exits with a message if there is none. */
void *masu_meso_allocated(size_t count, size_t bytes);

#endif
