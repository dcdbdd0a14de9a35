/* layers.c: the physics mode of bsdf.h. Light walks between the facets of a layer (ggx.h) until it
 * leaves, or enters the layer at a facet with the probability 1 - F, without refraction. Below a
 * dielectric is a Lambertian base, below a coat the complete base with its facets. A layer reflects
 * equally from inside and outside. All values are estimates by one walk; their means are
 * reciprocal, and a white surface reflects all light. */
#include "lab/reference/bsdf.h"

#include <string.h>

enum { ECHOES_MOST = 64 };
#define FAINT 1e-4
static const ref_fresnel lacquer = {{0.04, 0.04, 0.04}, 1};

/* Fraction of the light along w that enters a layer without colour. */
static double entered(double alpha, const ref_fresnel *f, ref_vec w, ref_random *r) {
    ref_vec l, weight;
    return ref_walk_sample(alpha, f, w, r, &l, &weight) ? 1 - weight.x : 1;
}

/* Light through the dielectric to the base colour and out again, with reflections between the two;
 * times l.z. The base is Lambertian, so both directions are one factor. */
static ref_vec below(const ref_bsdf *b, ref_vec v, ref_vec l, ref_random *r) {
    double in = entered(b->alpha, &b->matte, l, r);
    double out = entered(b->alpha, &b->matte, v, r);
    ref_vec sum = ref_splat(0), weight = ref_scale(b->s.albedo, in * out * l.z / REF_PI);
    for (int i = 0; i < ECHOES_MOST && ref_max(weight) > FAINT * ref_max(sum); i++) {
        sum = ref_add(sum, weight);
        double u1 = ref_draw(r);
        double u2 = ref_draw(r);
        double back = 1 - entered(b->alpha, &b->matte, ref_cosine_sample(u1, u2), r);
        weight = ref_scale(ref_mul(weight, b->s.albedo), back);
    }
    return sum;
}

static void base_eval(const ref_bsdf *b, ref_vec v, ref_vec l, ref_vec weight, ref_random *r,
                      ref_lobes *out) {
    double m = ref_clamp(b->s.metallic, 0, 1);
    if (!(v.z > 0) || !(l.z > 0)) return;
    ref_vec h = ref_unit(ref_add(v, l));
    ref_vec mirror =
        ref_scale(ref_fresnel_at(&b->mixed, ref_dot(v, h)), ref_ggx_lobe(b->alpha, v, l));
    bool metal = ref_draw(r) < m; /* a walk remains within metal or dielectric */
    mirror = ref_add(mirror, ref_walk_multiple(b->alpha, metal ? &b->metal : &b->matte, v, l, r));
    out->of[REF_BASE] = ref_add(out->of[REF_BASE], ref_mul(weight, mirror));
    if (m >= 1) return;
    ref_vec soft = ref_scale(below(b, v, l, r), 1 - m);
    out->of[REF_SOFT] = ref_add(out->of[REF_SOFT], ref_mul(weight, soft));
}

/* A direction in which light from v leaves the base, and its weight. */
static bool base_sample(const ref_bsdf *b, ref_vec v, ref_random *r, ref_vec *l, ref_vec *weight) {
    if (ref_draw(r) < ref_clamp(b->s.metallic, 0, 1))
        return ref_walk_sample(b->alpha, &b->metal, v, r, l, weight);
    if (!ref_walk_sample(b->alpha, &b->matte, v, r, l, weight)) return false;
    double mirrored = weight->x;
    *weight = ref_splat(1);
    if (ref_draw(r) < mirrored) return true;
    for (int i = 0; i < ECHOES_MOST; i++) {
        double u1 = ref_draw(r);
        double u2 = ref_draw(r);
        *weight = ref_mul(*weight, b->s.albedo);
        *l = ref_cosine_sample(u1, u2);
        double out = entered(b->alpha, &b->matte, *l, r);
        if (ref_draw(r) < out) return true;
        if (!(ref_max(*weight) > FAINT)) return false;
    }
    return false;
}

ref_lobes ref_layers_eval(const ref_bsdf *b, ref_vec light, ref_random *r) {
    ref_lobes out;
    memset(&out, 0, sizeof out);
    ref_vec l = ref_to(&b->base, light), over = ref_to(&b->over, light), d = b->v;
    double coat = b->s.coat;
    if (!(coat > 0)) {
        base_eval(b, d, l, ref_splat(1), r, &out);
        return out;
    }
    if (over.z > 0) {
        ref_vec h = ref_unit(ref_add(b->v_over, over));
        ref_vec once = ref_scale(ref_fresnel_at(&lacquer, ref_dot(b->v_over, h)),
                                 ref_ggx_lobe(b->coat_alpha, b->v_over, over));
        ref_vec more = ref_walk_multiple(b->coat_alpha, &lacquer, b->v_over, over, r);
        out.of[REF_COAT] = ref_scale(ref_add(once, more), coat);
    }
    over.z = fmax(over.z, 1e-4);
    double in = 1 - coat * (1 - entered(b->coat_alpha, &lacquer, ref_unit(over), r));
    ref_vec weight =
        ref_splat(in * (1 - coat * (1 - entered(b->coat_alpha, &lacquer, b->v_over, r))));
    for (int i = 0; i < ECHOES_MOST && ref_max(weight) > FAINT; i++) {
        ref_vec next, part;
        base_eval(b, d, l, weight, r, &out);
        if (!base_sample(b, d, r, &next, &part)) break;
        weight = ref_scale(ref_mul(weight, part), coat);
        ref_vec up = ref_to(&b->over, ref_from(&b->base, next));
        if (!(up.z > 0) || !ref_walk_sample(b->coat_alpha, &lacquer, up, r, &next, &part)) break;
        weight = ref_mul(weight, part);
        d = ref_to(&b->base, ref_from(&b->over, next));
        if (!(d.z > 0)) break;
    }
    return out;
}

bool ref_layers_sample(const ref_bsdf *b, ref_random *r, ref_vec *l, ref_vec *weight) {
    ref_vec part, next, d = b->v;
    double coat = b->s.coat;
    *weight = ref_splat(1);
    if (coat > 0) {
        if (!ref_walk_sample(b->coat_alpha, &lacquer, b->v_over, r, &next, &part)) return false;
        *l = ref_from(&b->over, next);
        if (ref_draw(r) < coat * part.x) return true;
    }
    for (int i = 0; i < ECHOES_MOST; i++) {
        if (!base_sample(b, d, r, &next, &part)) return false;
        *weight = ref_mul(*weight, part);
        *l = ref_from(&b->base, next);
        ref_vec up = ref_to(&b->over, *l);
        if (!(coat > 0) || !(up.z > 0)) return true;
        if (!ref_walk_sample(b->coat_alpha, &lacquer, up, r, &next, &part)) return false;
        if (ref_draw(r) >= coat * part.x) return true;
        d = ref_to(&b->base, ref_from(&b->over, next));
        if (!(d.z > 0)) return false;
    }
    return false;
}
