/*
 * lobes.glsl: exact evaluation of the separate specular lobes of bsdf.glsl: for the reference,
 * which multiplies each ray by them instead of by their albedo. After brdf/bsdf.glsl.
 */
#ifndef MASU_SPECULAR_LOBES_GLSL
#define MASU_SPECULAR_LOBES_GLSL

#include "brdf/bsdf.glsl"

/* f * N.L * pi for light from l, unit, of the base and of its coat; without multiple scattering
 * between facets, which is part of the ambient light (masu_bsdf_diffuse). */
void masu_lobes(masu_bsdf b, vec3 l, out vec3 base, out float coat)
{
    base = vec3(0.0);
    coat = 0.0;
    float n_l, over;
    if (!masu_bsdf_lit(b, l, n_l, over)) {
        return;
    }
    vec3 sum = l + b.v;
    vec3 h = masu_normalize(sum, b.n);
    float s = masu_schlick(0.5 * masu_sqrt(dot(sum, sum)));
    base = (b.f0 + (b.f90 - b.f0) * s) * masu_ggx(b.n, h, b.alpha, n_l, b.n_v) * n_l;
#ifdef MASU_SURFACE
    if (b.coat > 0.0) {
        float steep = masu_schlick(min(over, b.coat_n_v));
        base *= max(1.0 - b.coat * (b.coat_line.x + b.coat_line.y * steep), 0.0);
        coat = b.coat * (0.04 + 0.96 * s) * masu_ggx(b.coat_n, h, b.coat_alpha, over, b.coat_n_v) *
               over;
    }
#endif
}

#endif
