/* brdf.h: what a facet of the relief does with light, in double precision: GGX with
 * height-correlated Smith visibility (Heitz, JCGT 3-2, 2014) and Schlick's Fresnel over a diffuse
 * part that gets what the specular part leaves. The reference and the models that are held against
 * it shade with this one function, so their differences are those of the relief alone.
 *
 * Units as in the renderer: the sun's irradiance is pi, so a white Lambert surface facing it has
 * radiance 1. */
#ifndef MASU_MESO_BRDF_H
#define MASU_MESO_BRDF_H

#include "meso/patch.h"

#define MASU_MESO_F0 0.04

typedef struct masu_meso_lobes {
    double diffuse;  /* share of the albedo */
    double specular; /* without color */
} masu_meso_lobes;

/* pi times the BRDF; zero where light or view is below the surface. */
masu_meso_lobes masu_meso_brdf(masu_meso_vec3 n, masu_meso_vec3 v, masu_meso_vec3 l,
                               double roughness);

/* The same integrated over a uniform sky of radiance 1: how much of it the specular part returns
 * (Karis, SIGGRAPH 2013 course, the split sum for a constant environment). Made by quadrature once,
 * interpolated from then on; good to 0.002. */
typedef struct masu_meso_sky_table {
    float share[33][33]; /* cosine of the view, roughness */
} masu_meso_sky_table;

void masu_meso_sky_table_make(masu_meso_sky_table *table);
double masu_meso_sky_share(const masu_meso_sky_table *table, double n_v, double roughness);

#endif
