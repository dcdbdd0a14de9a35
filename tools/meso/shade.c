/* shade.c: see shade.h. */
#include "meso/shade.h"

masu_meso_surface masu_meso_seen(const masu_meso_shader *shader, const masu_meso_texel *texel,
                                 masu_meso_vec3 v) {
    masu_meso_surface s = {{texel->normal[0], texel->normal[1], texel->normal[2]},
                           {texel->color[0], texel->color[1], texel->color[2]},
                           texel->roughness,
                           texel->ao,
                           shader->no_specular ? 0.0 : 1.0,
                           1};
    if (shader->way == MASU_MESO_PLAIN) s.ao = 1;
    if (shader->way == MASU_MESO_CURVES) {
        masu_meso_bend(&shader->curves, v, masu_bake_v3(0, 1, 0), &s);
        if (shader->no_specular) s.specular = 0;
    }
    /* As masu_seen_normal of maps.glsl: a normal that points away is rotated until it is nearly
     * edge-on. */
    double turn = fmax(0.1 - masu_bake_dot(s.normal, v), 0);
    s.normal = masu_bake_mad(s.normal, v, turn);
    if (!masu_bake_normalize(&s.normal)) s.normal = v;
    return s;
}

void masu_meso_add_sky(const masu_meso_shader *shader, const masu_meso_surface *surface,
                       masu_meso_vec3 v, double scale, double radiance[3]) {
    double share =
        masu_meso_sky_share(shader->table, masu_bake_dot(surface->normal, v), surface->roughness) *
        surface->specular;
    for (int k = 0; k < 3; k++) {
        radiance[k] += scale * surface->ao * (surface->color[k] * (1 - share) + share);
    }
}

void masu_meso_add_sun(const masu_meso_shader *shader, const masu_meso_surface *surface,
                       masu_meso_vec3 v, masu_meso_vec3 l, double radiance[3]) {
    double n_l = masu_bake_dot(surface->normal, l);
    if (!(n_l > 0)) return;
    if (shader->way == MASU_MESO_CURVES) {
        n_l *= masu_meso_shadow(surface, v, l);
    }
    masu_meso_lobes lobes = masu_meso_brdf(surface->normal, v, l, surface->roughness);
    for (int k = 0; k < 3; k++) {
        radiance[k] +=
            n_l * (surface->color[k] * lobes.diffuse + surface->specular * lobes.specular);
    }
}
