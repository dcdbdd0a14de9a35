/* direct.c: the light paths that Masu specifies; see tracer.h. */
#include "lab/reference/tracer.h"

#include <string.h>

enum { LAYERS_MOST = 64 };

/* docs/scene.md, "Reflections": fully traced up to 3/4 of the cut-off, not at all from the cut-off
 * on. */
static double traced_share(double roughness, double cutoff) {
    double x = cutoff > 0 ? ref_clamp((roughness - 0.75 * cutoff) / (0.25 * cutoff), 0, 1) : 1;
    return 1 - x * x * (3 - 2 * x);
}

enum { OCCLUSION_RAYS = 16 };

/* Visibility along a ray: an occluder at the distance t within the radius has the weight 1 - t /
 * radius. */
static double open_along(const ref_tracer *t, ref_vec from, ref_vec d, double radius,
                         unsigned flags) {
    ref_hit by;
    bool met =
        radius > 0 && ref_world_trace(t->world, from, d, radius, flags | REF_RAY_NO_BLENDS, &by);
    return met ? by.t / radius : 1;
}

/* docs/scene.md, "Ambient occlusion": the smaller of two visibilities, of all surfaces within one
 * radius and of the field within the other, by cosine-weighted rays. If the field's radius is not
 * larger, its occluders are among all surfaces. Otherwise the smaller one varies from point to
 * point: a single ray each cannot decide it, so several are averaged first. */
static double open_to_sky(const ref_tracer *t, const ref_hit *hit, const ref_surface *s,
                          ref_random *r) {
    double all = t->occlusion_radius, field = t->world->field ? t->field_occlusion_radius : 0;
    if (field <= all) field = 0;
    if (!(all > 0) && !(field > 0)) return 1;
    ref_frame f = ref_frame_of(s->normal);
    int rays = all > 0 && field > 0 ? OCCLUSION_RAYS : 1;
    double open_all = 0, open_field = 0;
    for (int i = 0; i < rays; i++) {
        double u = ref_draw(r);
        double v = ref_draw(r);
        ref_vec d = ref_from(&f, ref_cosine_sample(u, v));
        if (!(ref_dot(d, hit->ng) > 0)) continue;
        ref_vec from = ref_world_leave(t->world, hit, d);
        open_all += open_along(t, from, d, all, 0);
        open_field += open_along(t, from, d, field, REF_RAY_NO_TRIANGLES);
    }
    open_field = 1 - t->field_occlusion_strength * (1 - open_field / rays);
    /* Rays below the surface are blocked; without a radius none is. */
    return fmin(all > 0 ? open_all / rays : 1, field > 0 ? open_field : 1);
}

/* Mirror reflection for `roughness` without a traced ray. */
static ref_vec untraced_sky(const ref_tracer *t, ref_vec l, double roughness) {
    if (ref_sky_is_map(t->sky)) return ref_sky_at(t->sky, l);
    return ref_mix(ref_sky_at(t->sky, l), t->sky->ambient, roughness);
}

typedef struct around {
    double share[2]; /* fraction traced, of base and coat */
    double open;     /* of the sky: ambient occlusion and the material's map */
} around;

/* Light of the sky and of traced reflections from l, by the lobes of w. */
static void add_around(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, const around *a,
                       ref_vec l, const ref_lobes *w, double mis, ref_random *r, ref_lobes *out) {
    ref_vec soft = ref_scale(ref_sky_soft(t->sky, l), a->open * mis);
    double roughness[2] = {b->s.roughness, b->s.coat_roughness};
    out->of[REF_SOFT] = ref_add(out->of[REF_SOFT], ref_mul(w->of[REF_SOFT], soft));
    for (int i = 0; i < 2; i++) {
        if (!(ref_max(w->of[i]) > 0) || a->share[i] >= 1) continue;
        ref_vec sky =
            ref_scale(untraced_sky(t, l, roughness[i]), a->open * mis * (1 - a->share[i]));
        out->of[i] = ref_add(out->of[i], ref_mul(w->of[i], sky));
    }
    ref_vec traced =
        ref_add(ref_scale(w->of[REF_BASE], a->share[0]), ref_scale(w->of[REF_COAT], a->share[1]));
    if (!(ref_max(traced) > 0)) return;
    ref_vec from = ref_world_leave(t->world, hit, l), seen;
    if (mis < 1) { /* two strategies for the sky, one for surfaces in front of it */
        ref_hit by;
        if (!ref_world_trace(t->world, from, l, HUGE_VAL, REF_RAY_NO_BLENDS | REF_RAY_ONE_SIDED,
                             &by)) {
            double left = ref_air_left(t, from, l, HUGE_VAL);
            seen = ref_scale(ref_through_air(t, ref_sky_at(t->sky, l), l, left, 1), mis);
        } else {
            seen = ref_direct(t, from, l, r, 1);
        }
    } else {
        seen = ref_direct(t, from, l, r, 1);
    }
    out->of[REF_BASE] = ref_add(out->of[REF_BASE], ref_mul(traced, seen));
}

/* Samples the sky's map, in addition to sampling the BSDF. */
static void sample_map(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, const around *a,
                       ref_random *r, ref_lobes *out) {
    double pdf;
    ref_vec l = ref_sky_sample(t->sky, r, &pdf);
    ref_lobes f = ref_bsdf_eval(b, l, r);
    if (!(ref_max(ref_lobes_sum(&f)) > 0) || !(pdf > 0)) return;
    double other = t->bsdf_samples ? ref_bsdf_pdf(b, l) : 0;
    double mis = pdf * pdf / (pdf * pdf + other * other);
    ref_vec sky = ref_scale(ref_sky_at(t->sky, l), mis / pdf);
    bool any = a->share[0] > 0 || a->share[1] > 0, seen = false;
    if (any && ref_dot(l, hit->ng) > 0)
        seen = !ref_world_occluded(t->world, ref_world_leave(t->world, hit, l), l, HUGE_VAL,
                                   REF_RAY_NO_BLENDS | REF_RAY_ONE_SIDED);
    out->of[REF_SOFT] =
        ref_add(out->of[REF_SOFT], ref_scale(ref_mul(f.of[REF_SOFT], sky), a->open));
    for (int i = 0; i < 2; i++) {
        double part = (1 - a->share[i]) * a->open + a->share[i] * seen;
        out->of[i] = ref_add(out->of[i], ref_scale(ref_mul(f.of[i], sky), part));
    }
}

static ref_lobes shade(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                       int depth, bool pane) {
    ref_lobes out, w;
    around a = {{0, 0}, b->s.occlusion};
    ref_vec l;
    memset(&out, 0, sizeof out);
    ref_sun_light(t, hit, b, r, &out);
    if (!depth && !pane) {
        a.share[0] = traced_share(b->s.roughness, t->cutoff);
        a.share[1] = traced_share(b->s.coat_roughness, t->cutoff);
        a.open *= open_to_sky(t, hit, &b->s, r);
    }
    ref_local_lights(t, hit, b, r, a.share, &out);
    bool map = ref_sky_is_map(t->sky) && t->sky_samples;
    if (map) sample_map(t, hit, b, &a, r, &out);
    if (t->bsdf_samples && ref_bsdf_sample(b, r, &l, &w)) {
        double p = ref_bsdf_pdf(b, l), q = map ? ref_sky_pdf(t->sky, l) : 0;
        add_around(t, hit, b, &a, l, &w, p * p / (p * p + q * q), r, &out);
    }
    return out;
}

ref_vec ref_direct(const ref_tracer *t, ref_vec from, ref_vec d, ref_random *r, int depth) {
    ref_vec sum = ref_splat(0), left = ref_splat(1), start = from, v = ref_scale(d, -1);
    unsigned flags = REF_RAY_ONE_SIDED | (depth ? REF_RAY_NO_BLENDS : 0u);
    for (int i = 0; i < LAYERS_MOST; i++) {
        ref_hit hit;
        ref_look look;
        ref_bsdf b;
        if (!ref_world_trace(t->world, from, d, HUGE_VAL, flags, &hit)) {
            ref_vec sky = depth ? ref_sky_at(t->sky, d) : ref_sky_seen(t, d);
            sky = ref_through_air(t, sky, d, ref_air_left(t, start, d, HUGE_VAL), 1);
            return ref_add(sum, ref_mul(left, sky));
        }
        ref_world_look(t->world, &hit, v, &look);
        bool blend = (look.flags & MASU_MATERIAL_IS_BLEND) != 0;
        ref_vec color = look.s.emissive;
        double air = ref_air_left(t, start, d, ref_length(ref_sub(hit.p, start))), taken = 1;
        ref_pane pane = {ref_splat(0), 1, 1, 1};
        ref_bsdf_make(&b, &look.s, v, t->physics);
        if (blend) {
            pane = ref_pane_of(&look, &b);
            color = ref_scale(color, pane.soft);
            taken = pane.taken;
        }
        if (!ref_is_unlit(&look.s)) {
            ref_lobes lit = shade(t, &hit, &b, r, depth, blend);
            color = ref_along(color, pane.soft, lit.of[REF_SOFT]);
            color = ref_along(color, pane.mirror, ref_add(lit.of[REF_BASE], lit.of[REF_COAT]));
        }
        sum = ref_add(sum, ref_mul(left, ref_through_air(t, color, d, air, taken)));
        if (!blend) return sum;
        left = ref_mul(left, pane.behind);
        d = ref_pane_scatter(&look, d, r), v = ref_scale(d, -1);
        from = ref_world_leave(t->world, &hit, d);
    }
    return sum;
}
