/*
 * ggx.glsl: what bsdf.glsl, which evaluates the lobe, and vndf.glsl, which samples it, have in
 * common, so that the two cannot drift apart: alpha, D, G2. Scalars only.
 */
#ifndef MASU_GGX_GLSL
#define MASU_GGX_GLSL

#include "shared/lookup_tables.h"

/* Below 0.045 the square of alpha leaves what half floats can hold (Filament, section 4.4); the
 * tables begin there. */
float masu_alpha(float roughness)
{
    float r = max(roughness, MASU_TABLE_SMOOTHEST);
    return r * r;
}

/* sqrt(pi D) of a half vector of cosine n_h and squared sine sine2. The sine form keeps its
 * precision for smooth surfaces, where 1 - n_h^2 cancels (Filament, section 4.4.1). */
float masu_ggx_peak(float n_h, float sine2, float alpha)
{
    float a = n_h * alpha;
    return alpha / (sine2 + a * a);
}

/* Smith's function of one direction: G1 = 2 n_v / (n_v + this). */
float masu_ggx_root(float alpha2, float cosine)
{
    return sqrt(alpha2 + (1.0 - alpha2) * cosine * cosine);
}

/* Height-correlated G2 = 2 n_l n_v / this (Heitz, JCGT 3-2, 2014). Never below 1e-12. */
float masu_ggx_masking(float alpha, float n_l, float n_v)
{
    float a2 = alpha * alpha;
    return max(n_l * masu_ggx_root(a2, n_v) + n_v * masu_ggx_root(a2, n_l), 1e-12);
}

#endif
