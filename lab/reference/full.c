/* full.c: all light paths: a path tracer with next-event estimation and multiple importance
 * sampling (power heuristic); see tracer.h. */
#include "lab/reference/tracer.h"

#include <string.h>

enum { ROULETTE_FROM = 3, STEPS_MOST = 4096 };

static double power(double a, double b) { return a > 0 ? a * a / (a * a + b * b) : 0; }

static ref_vec to_sky(const ref_tracer *t, const ref_hit *hit, ref_vec l) {
    if (!(ref_dot(l, hit->ng) > 0)) return ref_splat(0);
    return ref_unoccluded(t, ref_world_leave(t->world, hit, l), l, HUGE_VAL, 0);
}

/* Visibility of a point on another surface, aimed from the ray's start: otherwise a distant grazing
 * point would occlude itself. */
static ref_vec to_point(const ref_tracer *t, const ref_hit *hit, ref_vec p) {
    ref_vec l = ref_sub(p, hit->p), from = ref_world_leave(t->world, hit, l), to = ref_sub(p, from);
    double d = ref_length(to), far = d * (1 - 1e-5) - 2e-6;
    if (!(ref_dot(l, hit->ng) > 0) || !(far > 0)) return ref_splat(0);
    return ref_unoccluded(t, from, ref_scale(to, 1 / d), far, 0);
}

static void sample_map(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                       ref_lobes *out) {
    double pdf;
    ref_vec l = ref_sky_sample(t->sky, r, &pdf);
    ref_lobes f = ref_bsdf_eval(b, l, r);
    if (!(ref_max(ref_lobes_sum(&f)) > 0)) return;
    double mis = power(pdf, t->bsdf_samples ? ref_bsdf_pdf(b, l) : 0);
    ref_vec sky = ref_scale(ref_mul(to_sky(t, hit, l), ref_sky_at(t->sky, l)), mis / pdf);
    for (int i = 0; i < REF_LOBES; i++) out->of[i] = ref_add(out->of[i], ref_mul(f.of[i], sky));
}

static void sample_emitter(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b,
                           const bool *direct, ref_random *r, ref_lobes *out) {
    const ref_scene *s = t->world->scene;
    double which = ref_draw(r);
    double u = ref_draw(r);
    double v = ref_draw(r);
    uint32_t low = 0, high = s->emitter_count - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (s->emitters[middle].cumulative > which)
            high = middle;
        else
            low = middle + 1;
    }
    uint32_t triangle = s->emitters[low].triangle;
    const ref_triangle *k = &s->triangles[triangle];
    if (u + v > 1) u = 1 - u, v = 1 - v;
    ref_vec a = s->positions[k->vertex[0]];
    ref_vec e1 = ref_sub(s->positions[k->vertex[1]], a),
            e2 = ref_sub(s->positions[k->vertex[2]], a);
    ref_vec p = ref_along(ref_along(a, u, e1), v, e2), n = ref_unit(ref_cross(e1, e2));
    ref_vec to = ref_sub(p, hit->p);
    double d2 = ref_dot(to, to), d = sqrt(d2);
    if (!(d > 0)) return;
    ref_vec l = ref_scale(to, 1 / d);
    double facing = ref_dot(n, l), cosine = fabs(facing);
    if (!(cosine > 1e-9)) return;
    if (s->materials[k->material].flags & MASU_MATERIAL_IS_SINGLE && facing > 0) return;
    if (direct && direct[k->material]) return;
    ref_lobes f = ref_bsdf_eval(b, l, r);
    if (!(ref_max(ref_lobes_sum(&f)) > 0)) return;
    double pdf = s->emitter_pdf[triangle] * d2 / cosine;
    double mis = power(pdf, t->bsdf_samples ? ref_bsdf_pdf(b, l) : 0);
    ref_vec light = ref_mul(to_point(t, hit, p), ref_world_emission(t->world, triangle, u, v));
    light = ref_scale(light, mis / pdf);
    for (int i = 0; i < REF_LOBES; i++) out->of[i] = ref_add(out->of[i], ref_mul(f.of[i], light));
}

/* Samples an emissive part of the field: its first surface, if not occluded. */
static void sample_field(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                         ref_lobes *out) {
    const ref_field *field = t->world->field;
    ref_vec l = ref_towards_box(field->emitters, field->emitter_count, hit->p, r);
    if (!(ref_dot(l, hit->ng) > 0)) return;
    ref_lobes f = ref_bsdf_eval(b, l, r);
    if (!(ref_max(ref_lobes_sum(&f)) > 0)) return;
    ref_vec from = ref_world_leave(t->world, hit, l);
    double pdf = ref_box_pdf(field->emitters, field->emitter_count, hit->p, l),
           far = ref_field_trace(field, from, l, HUGE_VAL);
    if (!(pdf > 0) || !(far < HUGE_VAL)) return;
    ref_surface s;
    ref_vec p = ref_along(from, far, l);
    ref_field_surface(field, p, ref_field_normal(field, p), &s);
    if (!(ref_max(s.emissive) > 0)) return;
    double mis = power(pdf, t->bsdf_samples ? ref_bsdf_pdf(b, l) : 0);
    ref_vec light = ref_mul(ref_unoccluded(t, from, l, far, REF_RAY_NO_SDF), s.emissive);
    light = ref_scale(light, mis / pdf);
    for (int i = 0; i < REF_LOBES; i++) out->of[i] = ref_add(out->of[i], ref_mul(f.of[i], light));
}

/* Samples a window, for a sky without a map. */
static void sample_window(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                          ref_lobes *out) {
    ref_vec l = ref_towards_box(&t->window, 1, hit->p, r);
    double pdf = ref_box_pdf(&t->window, 1, hit->p, l);
    ref_lobes f = ref_bsdf_eval(b, l, r);
    if (!(pdf > 0) || !(ref_max(ref_lobes_sum(&f)) > 0)) return;
    double mis = power(pdf, t->bsdf_samples ? ref_bsdf_pdf(b, l) : 0);
    ref_vec sky = ref_scale(ref_mul(to_sky(t, hit, l), ref_sky_at(t->sky, l)), mis / pdf);
    for (int i = 0; i < REF_LOBES; i++) out->of[i] = ref_add(out->of[i], ref_mul(f.of[i], sky));
}

static bool field_emits(const ref_tracer *t) {
    return t->world->field && t->world->field->emitter_count && t->light_samples;
}

/* MIS weight of emission hit by a ray scattered at `from`, together with samples of the
 * emitters. */
static double emission_weight(const ref_tracer *t, const ref_hit *hit, ref_vec from, ref_vec d,
                              double travelled, double pdf, bool camera) {
    const ref_scene *s = t->world->scene;
    if (!camera && hit->triangle == REF_SDF && field_emits(t))
        return t->bsdf_samples ? power(pdf, ref_box_pdf(t->world->field->emitters,
                                                        t->world->field->emitter_count, from, d))
                               : 0;
    if (camera || !t->light_samples || hit->triangle == REF_SDF || !s->emitter_count) return 1;
    double cosine = fabs(ref_dot(hit->ng, d));
    double other =
        cosine > 1e-9 ? s->emitter_pdf[hit->triangle] * travelled * travelled / cosine : 0;
    return t->bsdf_samples ? power(pdf, other) : 0;
}

/* White and diffuse, without a mirror. */
static const ref_look patch_look = {
    .s = {.albedo = {1, 1, 1}, .roughness = 1, .occlusion = 1}, .cover = 1, .opacity = 1};

/* patch: the first surface, viewed along d; NULL: the surface hit by a ray. */
static ref_vec walk(const ref_tracer *t, ref_vec from, ref_vec d, const ref_hit *patch,
                    ref_random *r) {
    ref_vec sum = ref_splat(0), left = ref_splat(1), start = from, scattered = from;
    ref_lobes w = {{ref_splat(1), ref_splat(0), ref_splat(0)}};
    bool map = ref_sky_is_map(t->sky) && t->sky_samples, mirror = true;
    const bool window = !map && t->window.cumulative > 0;
    double pdf = 0;
    uint32_t bounce = 0;
    for (uint32_t step = 0; step < STEPS_MOST; step++) {
        ref_hit hit;
        ref_look look;
        ref_bsdf b;
        bool camera = bounce == 0;
        ref_vec all = ref_mul(left, ref_lobes_sum(&w)), v = ref_scale(d, -1);
        bool is_patch = patch && step == 0;
        if (is_patch) {
            hit = *patch;
        } else if (!ref_world_trace(t->world, from, d, HUGE_VAL, REF_RAY_ONE_SIDED, &hit)) {
            double mis = 1, other = 0;
            if (map) other = ref_sky_pdf(t->sky, d);
            if (window) other = ref_box_pdf(&t->window, 1, scattered, d);
            if (!camera && (map || window)) mis = t->bsdf_samples ? power(pdf, other) : 0;
            ref_vec seen = camera ? ref_sky_seen(t, d) : ref_sky_at(t->sky, d);
            ref_vec soft = t->physics ? seen : ref_sky_soft(t->sky, d);
            double air = mirror ? ref_air_left(t, start, d, HUGE_VAL) : 1;
            seen = ref_through_air(t, seen, d, air, 1);
            ref_vec mirrored = ref_mul(ref_add(w.of[REF_BASE], w.of[REF_COAT]), seen);
            ref_vec light = ref_add(mirrored, ref_mul(w.of[REF_SOFT], soft));
            return ref_add(sum, ref_scale(ref_mul(left, light), mis));
        }
        if (is_patch) {
            look = patch_look;
            look.s.normal = look.s.coat_normal = hit.ng;
        } else {
            ref_world_look(t->world, &hit, v, &look);
            if (patch && t->diffuse_hits) look.s.specular = look.s.metallic = look.s.coat = 0;
        }
        double travelled = ref_length(ref_sub(hit.p, start));
        double air = mirror ? ref_air_left(t, start, d, travelled) : 1;
        if (air < 1) {
            sum = ref_add(sum, ref_mul(all, ref_scale(ref_air_color(t, d), 1 - air)));
            left = ref_scale(left, air);
            all = ref_scale(all, air);
        }
        ref_bsdf_make(&b, &look.s, v, t->physics);
        ref_pane pane = {ref_splat(0), 1, 1, 1};
        if (look.flags & MASU_MATERIAL_IS_BLEND) {
            pane = ref_pane_of(&look, &b);
            double through = ref_clamp(ref_max(pane.behind), 0.1, 0.9), u = ref_draw(r);
            if (u < through) {
                left = ref_mul(left, ref_scale(pane.behind, 1 / through));
                d = ref_pane_scatter(&look, d, r);
                from = ref_world_leave(t->world, &hit, d);
                continue;
            }
            all = ref_scale(all, 1 / (1 - through));
            left = ref_scale(left, 1 / (1 - through));
        }
        double seen = emission_weight(t, &hit, scattered, d, travelled, pdf, camera) * pane.soft;
        if (patch && bounce == 1 && t->direct && hit.triangle != REF_SDF &&
            t->direct[t->world->scene->triangles[hit.triangle].material])
            seen = 0;
        sum = ref_add(sum, ref_mul(all, ref_scale(look.s.emissive, seen)));
        if (ref_is_unlit(&look.s)) return sum;
        ref_lobes lit;
        memset(&lit, 0, sizeof lit);
        const bool *direct = is_patch ? t->direct : NULL;
        if (!direct) {
            ref_sun_light(t, &hit, &b, r, &lit);
            ref_local_lights(t, &hit, &b, r, NULL, &lit);
        }
        if (bounce < t->bounces) {
            if (map) sample_map(t, &hit, &b, r, &lit);
            if (window) sample_window(t, &hit, &b, r, &lit);
            if (t->world->scene->emitter_count && t->light_samples)
                sample_emitter(t, &hit, &b, direct, r, &lit);
            if (field_emits(t)) sample_field(t, &hit, &b, r, &lit);
        }
        ref_vec mirrored = ref_scale(ref_add(lit.of[REF_BASE], lit.of[REF_COAT]), pane.mirror);
        sum = ref_add(sum, ref_mul(all, ref_along(mirrored, pane.soft, lit.of[REF_SOFT])));
        if (bounce++ >= t->bounces || !ref_bsdf_sample(&b, r, &d, &w)) return sum;
        pdf = ref_bsdf_pdf(&b, d);
        w.of[REF_BASE] = ref_scale(w.of[REF_BASE], pane.mirror);
        w.of[REF_COAT] = ref_scale(w.of[REF_COAT], pane.mirror);
        w.of[REF_SOFT] = ref_scale(w.of[REF_SOFT], pane.soft);
        mirror = ref_max(w.of[REF_BASE]) + ref_max(w.of[REF_COAT]) > ref_max(w.of[REF_SOFT]);
        left = all;
        ref_vec next = ref_mul(left, ref_lobes_sum(&w));
        if (!(ref_dot(d, hit.ng) > 0) || !(ref_max(next) > 0)) return sum;
        if (bounce >= ROULETTE_FROM) {
            double survive = fmin(ref_max(next), 0.95), u = ref_draw(r);
            if (u >= survive) return sum;
            left = ref_scale(left, 1 / survive);
        }
        scattered = hit.p;
        from = start = ref_world_leave(t->world, &hit, d);
    }
    return sum;
}

ref_vec ref_full(const ref_tracer *t, ref_vec from, ref_vec d, ref_random *r) {
    return walk(t, from, d, NULL, r);
}

ref_vec ref_irradiance(const ref_tracer *t, const ref_hit *at, ref_random *r) {
    return ref_scale(walk(t, at->p, ref_scale(at->ng, -1), at, r), REF_PI);
}
