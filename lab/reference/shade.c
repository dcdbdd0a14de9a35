/* shade.c: light from the sun and the sky, air, and transparent surfaces, shared by both kinds of
 * paths; see tracer.h. */
#include "lab/reference/fog.h"
#include "lab/reference/tracer.h"

#include <string.h>

enum { LAYERS_MOST = 64 };
static const double sharp_glass = 0.05; /* glass up to this roughness is not blurred */

bool ref_is_unlit(const ref_surface *s) {
    return ref_max(s->emissive) > 0 && !(ref_max(s->albedo) > 0) && s->roughness >= 1 &&
           !(s->coat > 0);
}

void ref_add_lobes(ref_lobes *to, const ref_lobes *from, ref_vec color) {
    for (int i = 0; i < REF_LOBES; i++) to->of[i] = ref_add(to->of[i], ref_mul(from->of[i], color));
}

ref_pane ref_pane_of(const ref_look *look, const ref_bsdf *b) {
    ref_pane p = {ref_splat(1), look->opacity, 1, 1};
    ref_lobes albedo = ref_bsdf_albedo(b);
    ref_vec mirror = ref_add(albedo.of[REF_BASE], albedo.of[REF_COAT]);
    double mirrored = ref_clamp((mirror.x + mirror.y + mirror.z) / 3, 0, 1),
           through = 1 - look->opacity;
    ref_vec hue = ref_splat(1);
    if (look->flags & MASU_MATERIAL_IS_TINTED) {
        double most = ref_max(look->s.albedo);
        hue = ref_scale(look->s.albedo, 1 / fmax(most, 1e-6));
        through *= most;
    }
    p.taken = (1 - through * (1 - mirrored)) * look->cover;
    if (ref_is_unlit(&look->s)) p.taken = look->opacity * look->cover, p.mirror = 0;
    if (look->flags & MASU_MATERIAL_IS_ADDITIVE) p.taken = 0, p.mirror = 0;
    p.behind = ref_scale(ref_mix(ref_splat(1), hue, look->cover), 1 - p.taken);
    p.soft *= look->cover;
    p.mirror *= look->cover;
    return p;
}

ref_vec ref_pane_scatter(const ref_look *look, ref_vec d, ref_random *r) {
    double alpha = look->s.roughness * look->s.roughness;
    if (!(look->flags & MASU_MATERIAL_IS_TINTED) || !(look->s.roughness > sharp_glass)) return d;
    ref_vec n = ref_dot(look->s.normal, d) < 0 ? look->s.normal : ref_scale(look->s.normal, -1);
    ref_frame f = ref_frame_of(n);
    ref_vec v = ref_to(&f, ref_scale(d, -1));
    double u1 = ref_draw(r), u2 = ref_draw(r);
    ref_vec h = ref_ggx_normal(alpha, v, u1, u2);
    ref_vec l = ref_sub(ref_scale(h, 2 * ref_dot(v, h)), v);
    if (!(l.z > 0)) return d;
    return ref_from(&f, ref_v(l.x, l.y, -l.z));
}

ref_vec ref_unoccluded(const ref_tracer *t, ref_vec from, ref_vec l, double far, unsigned flags) {
    ref_vec left = ref_splat(1);
    if (!t->physics || !t->world->scene->blends)
        return ref_splat(!ref_world_occluded(t->world, from, l, far, flags | REF_RAY_NO_BLENDS));
    for (int i = 0; i < LAYERS_MOST; i++) {
        ref_hit next;
        ref_look look;
        if (!ref_world_trace(t->world, from, l, far, flags, &next)) return left;
        ref_vec v = ref_scale(l, -1);
        ref_world_look(t->world, &next, v, &look);
        if (!(look.flags & MASU_MATERIAL_IS_BLEND)) return ref_splat(0);
        ref_bsdf b;
        ref_bsdf_make(&b, &look.s, v, false);
        left = ref_mul(left, ref_pane_of(&look, &b).behind);
        from = ref_world_leave(t->world, &next, l);
        far -= next.t + ref_length(ref_sub(from, next.p));
    }
    return ref_splat(0);
}

ref_vec ref_light_visible(const ref_tracer *t, const ref_hit *hit, ref_vec l, double far,
                       bool shadows) {
    if (!shadows) return ref_splat(1);
    if (!(ref_dot(l, hit->ng) > 0)) return ref_splat(0);
    unsigned flags =
        (t->polygons_shadow ? 0u : REF_RAY_NO_TRIANGLES) | (t->field_shadows ? 0u : REF_RAY_NO_SDF);
    return ref_unoccluded(t, ref_world_leave(t->world, hit, l), l, far, flags);
}

/* Adds the sun's light, per lobe. */
void ref_sun_light(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                   ref_lobes *out) {
    ref_vec l = t->sun_direction;
    if (!(ref_max(t->sun_color) > 0)) return;
    if (t->sun_radius > 0) {
        ref_frame f = ref_frame_of(l);
        double u = ref_draw(r);
        double v = ref_draw(r);
        double z = 1 - u * (1 - cos(t->sun_radius)), flat = sqrt(fmax(1 - z * z, 0));
        l = ref_from(&f, ref_v(flat * cos(2 * REF_PI * v), flat * sin(2 * REF_PI * v), z));
    }
    ref_lobes f = ref_bsdf_eval(b, l, r);
    if (!(ref_max(ref_lobes_sum(&f)) > 0)) return;
    ref_vec seen = ref_light_visible(t, hit, l, HUGE_VAL, t->polygons_shadow || t->field_shadows);
    ref_add_lobes(out, &f, ref_scale(ref_mul(seen, t->sun_color), REF_PI));
}

/* ---- Air ------------------------------------------------------------------------------------- */

double ref_air_left(const ref_tracer *t, ref_vec from, ref_vec d, double far) {
    const masu_blob_environment *e = t->environment;
    if (!(e->fog_density > 0)) return 1;
    double start = fmax((double)e->fog_start - ref_length(ref_sub(from, t->eye)), 0);
    return ref_fog_left((double)e->fog_density, (double)e->fog_falloff,
                        from.y - (double)e->fog_height, d.y, start, far);
}

/* docs/scene.md: the fog's colour, or the sky's at the horizon below the ray, brighter towards the
 * sun. */
ref_vec ref_air_color(const ref_tracer *t, ref_vec d) {
    ref_vec own = ref_of(t->environment->fog_color);
    if (ref_max(own) > 0) return own;
    double towards = ref_clamp(ref_dot(d, t->sun_direction), 0, 1);
    return ref_along(ref_sky_at(t->sky, ref_unit(ref_v(d.x, 0, d.z))), 0.05 * pow(towards, 12),
                     t->sun_color);
}

/* Masu renders the sun as two glows of fixed size. */
ref_vec ref_sky_seen(const ref_tracer *t, ref_vec d) {
    ref_vec sky = ref_sky_at(t->sky, d);
    if (t->physics) return sky;
    double towards = ref_clamp(ref_dot(d, t->sun_direction), 0, 1);
    return ref_along(sky, 0.25 * pow(towards, 350) + 0.05 * pow(towards, 12), t->sun_color);
}

ref_vec ref_radiance(const ref_tracer *t, ref_vec d, ref_random *r) {
    return t->full ? ref_full(t, t->eye, d, r) : ref_direct(t, t->eye, d, r, 0);
}
