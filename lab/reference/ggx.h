/* ggx.h: the GGX microfacet lobe with height-correlated Smith masking, its directional albedo with
 * tables, and the random walk between its facets. Directions are in the surface's frame, z up. */
#ifndef LAB_REFERENCE_GGX_H
#define LAB_REFERENCE_GGX_H

#include "lab/reference/vec.h"

#include <stdbool.h>

/* Selects the microfacets of Blender's Cycles (Principled, metallic 1, distribution GGX), for
 * comparisons with it: uncorrelated masking G1(v) G1(l), no light between facets, and the Fresnel
 * term of a dielectric of index 1.5 scaled to start at f0. Call it before any table. */
void ref_ggx_use_cycles(bool on);
bool ref_ggx_is_cycles(void);

double ref_schlick(double cosine); /* (1 - cosine)^5 */
/* Heitz, JCGT 3-2, 2014: Lambda; also for directions below the horizon (negative). */
double ref_ggx_lambda(double alpha, double cosine);
/* D G2 / (4 v.z l.z) times l.z */
double ref_ggx_lobe(double alpha, ref_vec v, ref_vec l);
/* A normal visible from v: spherical caps (Dupuy, Benyoub 2023); v may point below the horizon. */
ref_vec ref_ggx_normal(double alpha, ref_vec v, double u1, double u2);
/* Density over l of the reflection of v at such a normal. */
double ref_ggx_pdf(double alpha, ref_vec v, ref_vec l);

/* For a direction, or averages 2 Int mu dmu: the lobe with Fresnel term 1 (white) and (1 - h.v)^5
 * (weight), and both times max((1 - v.z)^5, (1 - l.z)^5), the part covered by a clear coat
 * above. */
typedef struct ref_albedo {
    double white, weight, covered, covered_weight;
} ref_albedo;

/* Interpolated in the tables of ref_ggx_tables. roughness: perceptual, 0.045..1. */
void ref_ggx_tables(void);
ref_albedo ref_ggx_albedo(double roughness, double cosine);
ref_albedo ref_ggx_average(double roughness);
/* By quadrature, without a table. */
ref_albedo ref_ggx_integrate(double roughness, double cosine, int steps);
/* The line a + b (1 - mu)^5 that bounds the reflection of a coat of f0 0.04 and this roughness. */
void ref_ggx_coat_line(double roughness, double *a, double *b);

/* Fresnel term of a facet: f0 + (f90 - f0) (1 - h.v)^5. */
typedef struct ref_fresnel {
    ref_vec f0;
    double f90;
} ref_fresnel;
ref_vec ref_fresnel_at(const ref_fresnel *f, double cosine);

/* Random walk between facets (Heitz, Hanika, d'Eon, Dachsbacher 2016). One estimate of the light
 * from l that leaves towards v after two or more bounces, times l.z. */
ref_vec ref_walk_multiple(double alpha, const ref_fresnel *f, ref_vec v, ref_vec l, ref_random *r);
/* A direction in which a walk from v leaves, and its weight; false: it did not leave. */
bool ref_walk_sample(double alpha, const ref_fresnel *f, ref_vec v, ref_random *r, ref_vec *l,
                     ref_vec *weight);

#endif
