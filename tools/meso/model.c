/* model.c: see model.h. */
#include "meso/model.h"

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

static double poly(const double c[3], double y) { return y * (c[0] + y * (c[1] + y * c[2])); }

masu_meso_curves masu_meso_identity(double facet) {
    masu_meso_curves c = {0};
    c.facet = facet;
    c.specular[0] = 1;
    c.offset = 1;
    return c;
}

void masu_meso_bend(const masu_meso_curves *curves, masu_meso_vec3 v, masu_meso_vec3 n,
                    masu_meso_surface *surface) {
    double y = 1 - clamp(masu_bake_dot(v, n), 0, 1), r = surface->roughness;
    double r2 = r * r, f2 = curves->facet * curves->facet;
    double lost = 0.5 * fmax(r2 * r2 - f2 * f2, 0);
    double spread = curves->spread + y * (curves->spread1 + y * curves->spread2);
    double fade = 1 / clamp(1 + spread * lost, MASU_MESO_FADE_MIN, 1 / MASU_MESO_FADE_MIN);
    masu_meso_vec3 was = surface->normal;
    double k = poly(curves->tilt, y);
    double n_v = masu_bake_dot(was, v);
    surface->normal = masu_bake_v3(was.x + k * (v.x - was.x * n_v), was.y + k * (v.y - was.y * n_v),
                                   was.z + k * (v.z - was.z * n_v));
    if (!masu_bake_normalize(&surface->normal)) surface->normal = was;
    surface->roughness = clamp(r * (1 + poly(curves->rough, y)), curves->facet, 1);
    double open = clamp(surface->ao + (1 - surface->ao) * poly(curves->ao, y), 0, 1);
    double sun = fmax(1 + poly(curves->gain, y), 0.05) * fade;
    for (int i = 0; i < 3; i++) {
        surface->color[i] = clamp(surface->color[i] * (1 + y * y * curves->tint[i]) * sun, 0, 1);
    }
    surface->ao = fmin(open / sun, 1);
    surface->shadow = clamp(curves->offset - curves->alpha * (1 - open), 0, 1);
    const double *s = curves->specular;
    surface->specular = clamp(s[0] + y * (s[1] + y * s[2]), 0, 1);
}

double masu_meso_shadow(const masu_meso_surface *surface, masu_meso_vec3 v, masu_meso_vec3 l) {
    double along = masu_bake_dot(v, l);
    return clamp(surface->shadow * (1 + 0.3 * along * along * along), 0, 1);
}
