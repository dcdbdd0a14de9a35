/* brdf.h: the BRDF of a facet of the relief, in double precision: GGX with height-correlated Smith
 * visibility (Heitz, JCGT 3-2, 2014) and Schlick's Fresnel over a diffuse part that receives the
 * light not reflected by the specular part. The reference and the compared models use the same
 * function, so that they differ only in the relief.
 *
 * Units as in the renderer: the sun's irradiance is pi, so a white Lambert surface facing it has
 * radiance 1. */
#ifndef MASU_MESO_BRDF_H
#define MASU_MESO_BRDF_H

#include "meso/patch.h"

#define MASU_MESO_F0 0.04

typedef struct masu_meso_lobes {
    double diffuse;  /* fraction of the albedo */
    double specular; /* without color */
} masu_meso_lobes;

/* pi times the BRDF; zero if light or view is below the surface. */
masu_meso_lobes masu_meso_brdf(masu_meso_vec3 n, masu_meso_vec3 v, masu_meso_vec3 l,
                               double roughness);

/* The BRDF integrated over a uniform sky of radiance 1: the fraction that the specular part
 * reflects (Karis, SIGGRAPH 2013 course, the split sum for a constant environment). Computed once
 * by quadrature, then interpolated; accurate to 0.002. */
typedef struct masu_meso_sky_table {
    float share[33][33]; /* cosine of the view, roughness */
} masu_meso_sky_table;

void masu_meso_sky_table_make(masu_meso_sky_table *table);
double masu_meso_sky_share(const masu_meso_sky_table *table, double n_v, double roughness);

#endif
