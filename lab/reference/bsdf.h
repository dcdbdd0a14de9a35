/* bsdf.h: the scattering of light at a surface of the reference.
 *
 *   design   the closed-form model that Masu specifies: GGX; its lost energy by a product (Kulla
 *   and
 *            Conty 2017, coloured as in shaders/brdf); diffuse light below by a product (Kelemen
 *            and Szirmay-Kalos 2001); a clear coat that transmits 1 - c (a + b max(s(v), s(l)))
 *   physics  the same layers by random walks: between facets, through the layers, between layers
 *
 * The result is split into lobes, because Masu lights them differently: mirror of the base, mirror
 * of the coat, and soft, for all light without a direction. */
#ifndef LAB_REFERENCE_BSDF_H
#define LAB_REFERENCE_BSDF_H

#include "lab/reference/ggx.h"

typedef struct ref_surface {
    ref_vec albedo, emissive;
    double roughness, metallic, specular; /* specular: f0 / 0.08 */
    double coat, coat_roughness;
    ref_vec hue;                 /* colour of the dielectric's f0 = 0.08 specular hue; 0: white */
    ref_vec sheen;               /* colour, 0: none */
    double sheen_roughness;
    double anisotropy;           /* 0: none */
    ref_vec grain;               /* unit */
    double occlusion;            /* of the material's map */
    ref_vec normal, coat_normal; /* unit, towards the viewer */
} ref_surface;

enum { REF_BASE, REF_COAT, REF_SOFT, REF_LOBES };
typedef struct ref_lobes {
    ref_vec of[REF_LOBES];
} ref_lobes;

static inline ref_vec ref_lobes_sum(const ref_lobes *l) {
    return ref_add(ref_add(l->of[REF_BASE], l->of[REF_COAT]), l->of[REF_SOFT]);
}

typedef struct ref_returned {
    double white, weight, coat, lost;
} ref_returned;

typedef struct ref_bsdf {
    bool walk;
    ref_surface s;
    ref_frame base, over;
    ref_vec v, v_over; /* in the two frames */
    double alpha, coat_alpha, line[2];
    ref_fresnel mixed, metal, matte; /* mixed: for the single bounce of both parts */
    ref_returned all, seen;
    ref_vec rest_color; /* of metal and dielectric together */
    double matte_rest;
    bool grained;
    double along;         /* alpha along the grain, the x axis of `base` */
    double mean_rough;    /* roughness whose albedos the base uses */
    double sheen_alpha, sheen_most, bared; /* bared: fraction below a sheen, by v */
    double pick[REF_LOBES]; /* probability of sampling each */
} ref_bsdf;

/* v: towards the viewer, unit. */
void ref_bsdf_make(ref_bsdf *b, const ref_surface *s, ref_vec v, bool walk);
/* f times the cosine, for light from l. Only walks use `r`. */
ref_lobes ref_bsdf_eval(const ref_bsdf *b, ref_vec l, ref_random *r);
/* Physics mode: the same, and a direction in which a walk leaves, with f times the cosine over its
 * density, at most 1. */
ref_lobes ref_layers_eval(const ref_bsdf *b, ref_vec l, ref_random *r);
bool ref_layers_sample(const ref_bsdf *b, ref_random *r, ref_vec *l, ref_vec *weight);
/* Density of ref_bsdf_sample; for a walk an estimate, which is also valid as weight of two
 * strategies. */
double ref_bsdf_pdf(const ref_bsdf *b, ref_vec l);
/* A direction and f times the cosine over its density; false: no scattering in that direction. */
bool ref_bsdf_sample(const ref_bsdf *b, ref_random *r, ref_vec *l, ref_lobes *weight);
/* Fraction of uniform light that each lobe reflects. */
ref_lobes ref_bsdf_albedo(const ref_bsdf *b);

#endif
