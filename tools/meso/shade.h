/* shade.h: shades texels like a renderer, with the facets' BRDF under a sun and a uniform sky, by
 * the three methods that are compared with the reference:
 *
 *   PLAIN     normal and roughness; bumps that a mip has lost become roughness
 *   OCCLUDED  PLAIN with the AO map for light of the sky
 *   CURVES    the relief's curves (model.h) */
#ifndef MASU_MESO_SHADE_H
#define MASU_MESO_SHADE_H

#include "meso/measure.h"
#include "meso/model.h"

enum { MASU_MESO_PLAIN, MASU_MESO_OCCLUDED, MASU_MESO_CURVES, MASU_MESO_WAYS };

/* Radiance of the sky relative to a white surface that faces the sun: a clear day. */
#define MASU_MESO_SKY 0.2

typedef struct masu_meso_shader {
    const masu_meso_sky_table *table;
    masu_meso_curves curves;
    int way;
    bool no_specular; /* only diffuse terms */
} masu_meso_shader;

/* The surface of a texel, viewed along v, on a polygon that faces up. */
masu_meso_surface masu_meso_seen(const masu_meso_shader *shader, const masu_meso_texel *texel,
                                 masu_meso_vec3 v);
/* Added to `radiance`. */
void masu_meso_add_sky(const masu_meso_shader *shader, const masu_meso_surface *surface,
                       masu_meso_vec3 v, double scale, double radiance[3]);
void masu_meso_add_sun(const masu_meso_shader *shader, const masu_meso_surface *surface,
                       masu_meso_vec3 v, masu_meso_vec3 l, double radiance[3]);

#endif
