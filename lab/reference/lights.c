/* lights.c: local lights, sampled by their surface and by the BSDF; see tracer.h.
 *
 * A point or spot light is a sphere of its radius with that radiant intensity. The camera and rays
 * of other bounces do not see these lights: they have no surface in the scene. If a light has one
 * (fitted by masu-bake), full mode samples that surface instead, and in direct mode the light only
 * affects surfaces without traced rays. */
#include "lab/reference/tracer.h"

#include <string.h>

static double window_of(const ref_light *light, double d) {
    double share = d / light->range;
    return share < 1 ? 1 - share * share * share * share : 0;
}

static double cone_of(const ref_light *light, ref_vec l) {
    if (light->outer < 0) return 1;
    double c = -ref_dot(l, light->direction), inner = cos(light->inner), outer = cos(light->outer);
    double x = inner > outer ? ref_clamp((c - outer) / (inner - outer), 0, 1) : c >= outer;
    return x * x;
}

ref_vec ref_light_at(const ref_light *light, ref_vec p, ref_vec *l) {
    ref_vec to = ref_sub(light->position, p);
    double d2 = ref_dot(to, to), d = sqrt(d2);
    *l = d > 0 ? ref_scale(to, 1 / d) : ref_v(0, 1, 0);
    return ref_scale(light->color, window_of(light, d) * cone_of(light, *l) /
                                       fmax(d2, light->radius * light->radius));
}

/* ---- Surfaces of lights ---------------------------------------------------------------------- */

/* A direction from a point to a light's surface, the distance, and the density per solid angle. */
typedef struct to_light {
    ref_vec l;
    double far, pdf;
} to_light;

/* 1 - cos of the half angle of a sphere at a distance; from inside, the hemisphere towards its
 * centre. */
static double cap_of(double r, double d) {
    double s2 = r * r / (d * d);
    return d > r ? s2 / (1 + sqrt(1 - s2)) : 1;
}

static bool sphere_pdf(const ref_light *light, ref_vec to, ref_vec l, to_light *out) {
    double d = ref_length(to), along = ref_dot(l, to), r = light->radius, cap = cap_of(r, d);
    double aside = ref_dot(to, to) - along * along;
    if (!(along > 0) || (d > r && aside > r * r)) return false;
    /* A ray ends before the source: a bulb of that size does not occlude it. */
    double far = d > r ? along - sqrt(fmax(r * r - aside, 0)) - 2e-3 * r : along;
    *out = (to_light){l, fmax(far, 0), 1 / (2 * REF_PI * cap)};
    return true;
}

static bool rectangle_pdf(const ref_light *light, ref_vec to, ref_vec l, to_light *out) {
    ref_vec u = light->direction, v = light->half_axis, n = ref_cross(u, v);
    double facing = ref_dot(l, n), far = ref_dot(to, n) / facing;
    if (!(far > 0) || !(far < HUGE_VAL) || (facing > 0 && !light->two_sided)) return false;
    ref_vec at = ref_sub(ref_scale(l, far), to);
    /* Coordinates along axes that may not be perpendicular. */
    double uu = ref_dot(u, u), uv = ref_dot(u, v), vv = ref_dot(v, v), det = uu * vv - uv * uv;
    double a = (vv * ref_dot(at, u) - uv * ref_dot(at, v)) / det;
    double b = (uu * ref_dot(at, v) - uv * ref_dot(at, u)) / det;
    if (fabs(a) > 1 || fabs(b) > 1) return false;
    *out = (to_light){l, far, far * far / (4 * fabs(facing))};
    return true;
}

static double capsule_area(const ref_light *light) {
    return 4 * REF_PI * light->radius * (light->radius + ref_length(light->direction));
}

/* The closer intersection of a ray with the cylinder or one of the spheres at its ends. */
static bool capsule_pdf(const ref_light *light, ref_vec to, ref_vec l, to_light *out) {
    double half = ref_length(light->direction), r = light->radius, best = HUGE_VAL, side = 0;
    ref_vec e = ref_scale(light->direction, 1 / half);
    double le = ref_dot(l, e), ce = ref_dot(to, e);
    ref_vec across = ref_sub(l, ref_scale(e, le)), center = ref_sub(to, ref_scale(e, ce));
    double a = ref_dot(across, across), b = ref_dot(across, center),
           c = ref_dot(center, center) - r * r;
    double root = b * b - a * c;
    if (root > 0 && a > 1e-14) {
        double t = (b - sqrt(root)) / a;
        if (t > 0 && fabs(t * le - ce) <= half) {
            best = t;
            side = fabs(ref_dot(ref_sub(ref_scale(across, t), center), l)) / r;
        }
    }
    for (int k = -1; k <= 1; k += 2) {
        ref_vec end = ref_along(to, k * half, e);
        double along = ref_dot(l, end), inside = along * along - ref_dot(end, end) + r * r;
        double t = inside > 0 ? along - sqrt(inside) : -1;
        if (t > 0 && t < best && k * (t * le - ce) >= half) {
            best = t;
            side = fabs(ref_dot(ref_sub(ref_scale(l, t), end), l)) / r;
        }
    }
    if (!(best < HUGE_VAL) || !(side > 1e-9)) return false;
    *out = (to_light){l, best, best * best / (capsule_area(light) * side)};
    return true;
}

/* The intersection of a direction from a point with a light; `to`: from the point to its centre. */
static bool meets(const ref_light *light, ref_vec to, ref_vec l, to_light *out) {
    if (light->type == MASU_LIGHT_CAPSULE) return capsule_pdf(light, to, l, out);
    if (light->type == MASU_LIGHT_RECTANGLE) return rectangle_pdf(light, to, l, out);
    return sphere_pdf(light, to, l, out);
}

static bool draw(const ref_light *light, ref_vec to, ref_random *r, to_light *out) {
    double u = ref_draw(r), v = ref_draw(r), d = ref_length(to);
    if (!(d > 0)) return false;
    if (light->type == MASU_LIGHT_RECTANGLE) {
        ref_vec at =
            ref_along(ref_along(to, 2 * u - 1, light->direction), 2 * v - 1, light->half_axis);
        return rectangle_pdf(light, to, ref_unit(at), out);
    }
    if (light->type == MASU_LIGHT_CAPSULE) {
        double half = ref_length(light->direction), radius = light->radius;
        double part = ref_draw(r) * (radius + half), z = 2 * u - 1, flat = sqrt(1 - z * z);
        ref_frame f = ref_frame_of(ref_scale(light->direction, 1 / half));
        ref_vec at = ref_v(flat * cos(2 * REF_PI * v), flat * sin(2 * REF_PI * v), z);
        if (part < half) at = ref_v(cos(2 * REF_PI * v), sin(2 * REF_PI * v), z * half / radius);
        else at.z += (z > 0 ? half : -half) / radius;
        ref_vec point = ref_add(to, ref_scale(ref_from(&f, at), radius));
        to_light seen;
        /* A point on the far side is rejected: its direction hits the near side. */
        if (!capsule_pdf(light, to, ref_unit(point), &seen)) return false;
        if (seen.far < ref_length(point) * (1 - 1e-6) - 1e-9) return false;
        *out = seen;
        return true;
    }
    ref_frame f = ref_frame_of(ref_scale(to, 1 / d));
    double q = u * cap_of(light->radius, d), flat = sqrt(fmax(q * (2 - q), 0));
    ref_vec l = ref_from(&f, ref_v(flat * cos(2 * REF_PI * v), flat * sin(2 * REF_PI * v), 1 - q));
    return sphere_pdf(light, to, l, out);
}

/* ---- Light ----------------------------------------------------------------------------------- */

/* Adds f, times a light's radiance along a direction. */
static void add_seen(const ref_tracer *t, const ref_hit *hit, const ref_lobes *f, ref_vec radiance,
                     const to_light *to, const double share[2], ref_lobes *out) {
    ref_vec seen = ref_light_visible(t, hit, to->l, to->far * (1 - 1e-6), t->physics);
    ref_lobes kept = *f;
    if (share) {
        for (int k = 0; k < 2; k++) kept.of[k] = ref_scale(kept.of[k], 1 - share[k]);
    }
    ref_add_lobes(out, &kept, ref_mul(seen, radiance));
}

static void add_point(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b,
                      const ref_light *light, ref_random *r, ref_lobes *out) {
    ref_vec l, color = ref_light_at(light, hit->p, &l);
    ref_lobes f = ref_bsdf_eval(b, l, r);
    to_light to = {l, fmax(ref_length(ref_sub(light->position, hit->p)) - light->radius, 0), 1};
    if (ref_max(ref_lobes_sum(&f)) > 0)
        add_seen(t, hit, &f, ref_scale(color, REF_PI), &to, NULL, out);
}

void ref_local_lights(const ref_tracer *t, const ref_hit *hit, const ref_bsdf *b, ref_random *r,
                      const double share[2], ref_lobes *out) {
    const ref_scene *s = t->world->scene;
    for (uint32_t i = 0; i < s->light_count; i++) {
        const ref_light *light = &s->lights[i];
        ref_vec to = ref_sub(light->position, hit->p), radiance = light->color;
        double d = ref_length(to), radius = light->radius;
        double kept = window_of(light, d) * cone_of(light, ref_scale(to, d > 0 ? 1 / d : 0));
        bool point = light->type <= MASU_LIGHT_SPOT;
        if (!(kept > 0) || !(ref_max(radiance) > 0) || (light->surface && t->full)) continue;
        if (point && radius < 1e-4 * d) {
            add_point(t, hit, b, light, r, out);
            continue;
        }
        radiance = ref_scale(radiance, kept / (point ? radius * radius : 1));
        to_light drawn;
        ref_vec l;
        ref_lobes f;
        if (draw(light, to, r, &drawn)) {
            f = ref_bsdf_eval(b, drawn.l, r);
            double other = t->bsdf_samples ? ref_bsdf_pdf(b, drawn.l) : 0;
            if (ref_max(ref_lobes_sum(&f)) > 0)
                add_seen(t, hit, &f, ref_scale(radiance, 1 / (drawn.pdf + other)), &drawn,
                         light->surface ? share : NULL, out);
        }
        if (t->bsdf_samples && ref_bsdf_sample(b, r, &l, &f) && meets(light, to, l, &drawn)) {
            double own = ref_bsdf_pdf(b, l);
            add_seen(t, hit, &f, ref_scale(radiance, own / (own + drawn.pdf)), &drawn,
                     light->surface ? share : NULL, out);
        }
    }
}
