/* bsdf.c: see bsdf.h. */
#include "lab/reference/bsdf.h"

#include <string.h>

#define SMOOTHEST 0.045 /* as in Masu */
#define SMOOTHEST_WALKED 0.01

/* cosine: with the base's normal; over: with the coat's normal, which determines the coat's
 * reflection and coverage. */
static ref_returned returned(const ref_bsdf *b, ref_albedo base, ref_albedo covered,
                             ref_albedo coat) {
    double c = b->s.coat, through = 1 - c * b->line[0], less = c * b->line[1];
    ref_returned r = {.white = through * base.white - less * covered.covered,
                      .weight = through * base.weight - less * covered.covered_weight,
                      .coat = c * (0.04 * coat.white + 0.96 * coat.weight)};
    if (!ref_ggx_is_cycles()) r.lost = fmax(1 - r.white - r.coat, 0);
    return r;
}

static ref_returned returned_at(const ref_bsdf *b, double cosine, double over) {
    return returned(b, ref_ggx_albedo(b->mean_rough, cosine), ref_ggx_albedo(b->mean_rough, over),
                    ref_ggx_albedo(b->s.coat_roughness, over));
}

/* ---- Sheen: Charlie (Estevez and Kulla 2017), as in KHR_materials_sheen; design mode only ---- */

static double sheen_curve(double x, double alpha) {
    static const double rough[5] = {21.5473, 3.82987, 0.19823, -1.97760, -4.32054};
    static const double smooth[5] = {25.3245, 3.32435, 0.16801, -1.27393, -4.85967};
    double t = (1 - alpha) * (1 - alpha), p[5];
    for (int i = 0; i < 5; i++) p[i] = t * smooth[i] + (1 - t) * rough[i];
    return p[0] / (1 + p[1] * pow(x, p[2])) + p[3] * x + p[4];
}

static double sheen_lambda(double alpha, double cosine) {
    if (cosine < 0.5) return exp(sheen_curve(cosine, alpha));
    return exp(2 * sheen_curve(0.5, alpha) - sheen_curve(1 - cosine, alpha));
}

static double sheen_alpha_of(double roughness) {
    double r = fmax(roughness, 0.07);
    return r * r;
}

/* f times the cosine of l, for a white sheen. */
static double sheen_lobe(double alpha, ref_vec v, ref_vec l) {
    ref_vec h = ref_unit(ref_add(v, l));
    double d = (2 + 1 / alpha) * pow(ref_clamp(1 - h.z * h.z, 0, 1), 0.5 / alpha) / (2 * REF_PI);
    return d / ((1 + sheen_lambda(alpha, v.z) + sheen_lambda(alpha, l.z)) * 4 * v.z);
}

static double sheen_integral(double roughness, double cosine) {
    enum { STEPS = 48 };
    double sum = 0, z = fmax(cosine, 0.01);
    ref_vec v = ref_v(sqrt(1 - z * z), 0, z);
    for (int i = 0; i < STEPS; i++) {
        for (int k = 0; k < STEPS; k++) {
            double u = (i + 0.5) / STEPS, up = u * u, phi = REF_PI * (k + 0.5) / STEPS,
                   flat = sqrt(1 - up * up);
            sum += 2 * u *
                   sheen_lobe(sheen_alpha_of(roughness), v,
                              ref_v(flat * cos(phi), flat * sin(phi), up));
        }
    }
    return fmin(sum / STEPS / STEPS * 2 * REF_PI, 1);
}

/* Cached tables of 64 cosines for the most recent roughnesses; a scene has few of them. */
static double sheen_albedo(double roughness, double cosine) {
    enum { KEPT = 8, COSINES = 64 };
    static _Thread_local double table[KEPT][COSINES + 1], of[KEPT];
    static _Thread_local int count;
    int i = 0;
    while (i < count && i < KEPT && of[i] != roughness) i++;
    if (i == count || i == KEPT) {
        i = count++ % KEPT;
        if (count > KEPT) count = KEPT;
        of[i] = roughness;
        for (int k = 0; k <= COSINES; k++)
            table[i][k] = sheen_integral(roughness, (double)k * k / COSINES / COSINES);
    }
    double at = sqrt(ref_clamp(cosine, 0, 1)) * COSINES;
    int left = at < COSINES - 1 ? (int)at : COSINES - 1;
    return table[i][left] + (at - left) * (table[i][left + 1] - table[i][left]);
}

/* ---- Grain: GGX with two alphas; x of the frame is along it ---------------------------------- */

static ref_vec stretched(const ref_bsdf *b, ref_vec w) {
    return ref_v(b->along * w.x, b->alpha * w.y, w.z);
}

static double grain_lambda(const ref_bsdf *b, ref_vec w) {
    double x = b->along * w.x, y = b->alpha * w.y;
    return (sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1) / 2;
}

static double grain_density(const ref_bsdf *b, ref_vec h) {
    double x = h.x / b->along, y = h.y / b->alpha, d = x * x + y * y + h.z * h.z;
    return 1 / (REF_PI * b->along * b->alpha * d * d);
}

static double grain_lobe(const ref_bsdf *b, ref_vec l) {
    ref_vec h = ref_unit(ref_add(b->v, l));
    double masking = 1 / (1 + grain_lambda(b, b->v) + grain_lambda(b, l));
    return grain_density(b, h) * masking / (4 * b->v.z);
}

static double grain_pdf(const ref_bsdf *b, ref_vec l) {
    ref_vec h = ref_unit(ref_add(b->v, l));
    return grain_density(b, h) / (1 + grain_lambda(b, b->v)) / (4 * b->v.z);
}

/* In the space in which the distribution has alpha 1. */
static ref_vec grain_normal(const ref_bsdf *b, double u1, double u2) {
    ref_vec n = ref_ggx_normal(1, ref_unit(stretched(b, b->v)), u1, u2);
    return ref_unit(stretched(b, n));
}

static void make_lobes(ref_bsdf *b) {
    b->bared = 1;
    b->sheen_most = ref_max(b->s.sheen);
    if (b->sheen_most > 0) {
        b->sheen_alpha = sheen_alpha_of(b->s.sheen_roughness);
        b->bared = 1 - b->sheen_most * sheen_albedo(b->s.sheen_roughness, b->v.z);
    }
    b->grained = b->s.anisotropy > 0;
    if (!b->grained) return;
    b->along = b->alpha + (1 - b->alpha) * b->s.anisotropy * b->s.anisotropy;
    b->mean_rough = pow((b->along * b->along + b->alpha * b->alpha) / 2, 0.25);
}

/* Light that leaves after several bounces, as a factor of the lost energy. */
static double rest_of(double f0, double f90, double white) {
    double f = f0 + (f90 - f0) / 21;
    return f * f * (1.35 - 0.35 * f) * white / (1 - f * (1 - white));
}

/* Fraction of the light that the dielectric's layers reflect before the colour below. */
static double matte(const ref_bsdf *b, const ref_returned *r) {
    double f0 = b->matte.f0.x;
    return r->coat + f0 * r->white + (b->matte.f90 - f0) * r->weight + b->matte_rest * r->lost;
}

static double below(const ref_bsdf *b, const ref_returned *r) { return fmax(1 - matte(b, r), 0); }

void ref_bsdf_make(ref_bsdf *b, const ref_surface *s, ref_vec v, bool walk) {
    memset(b, 0, sizeof *b);
    b->walk = walk && !ref_ggx_is_cycles();
    b->s = *s;
    b->s.roughness = ref_clamp(s->roughness, b->walk ? SMOOTHEST_WALKED : SMOOTHEST, 1);
    b->s.coat_roughness = ref_clamp(s->coat_roughness, b->walk ? SMOOTHEST_WALKED : SMOOTHEST, 1);
    b->base = ref_frame_of(s->normal);
    if (s->anisotropy > 0) {
        ref_vec along = ref_along(s->grain, -ref_dot(s->grain, s->normal), s->normal);
        if (ref_dot(along, along) > 1e-12)
            b->base =
                (ref_frame){ref_unit(along), ref_cross(s->normal, ref_unit(along)), s->normal};
    }
    b->over = ref_frame_of(s->coat_normal);
    b->v = ref_to(&b->base, v);
    b->v.z = ref_clamp(b->v.z, 1e-4, 1);
    b->v_over = ref_to(&b->over, v);
    b->v_over.z = ref_clamp(b->v_over.z, 1e-4, 1);
    b->alpha = b->s.roughness * b->s.roughness;
    b->coat_alpha = b->s.coat_roughness * b->s.coat_roughness;
    if (s->coat > 0) ref_ggx_coat_line(b->s.coat_roughness, &b->line[0], &b->line[1]);
    b->mean_rough = b->s.roughness;
    make_lobes(b);
    double f0 = 0.08 * ref_clamp(s->specular, 0, 12.5), m = ref_clamp(s->metallic, 0, 1);
    b->matte = (ref_fresnel){ref_splat(f0), fmin(50 * f0, 1)};
    b->metal = (ref_fresnel){s->albedo, fmin(50 * ref_max(s->albedo), 1)};
    b->mixed = (ref_fresnel){
        ref_mix(ref_scale(ref_max(s->hue) > 0 ? s->hue : ref_splat(1), f0), b->metal.f0, m),
        b->matte.f90 + m * (b->metal.f90 - b->matte.f90)};
    ref_albedo average = ref_ggx_average(b->mean_rough);
    b->matte_rest = rest_of(f0, b->matte.f90, average.white);
    ref_vec a = s->albedo;
    ref_vec metal_rest =
        ref_v(rest_of(a.x, b->metal.f90, average.white), rest_of(a.y, b->metal.f90, average.white),
              rest_of(a.z, b->metal.f90, average.white));
    b->rest_color = ref_mix(ref_splat(b->matte_rest), metal_rest, m);
    b->all = returned(b, average, average, ref_ggx_average(b->s.coat_roughness));
    b->seen = returned_at(b, b->v.z, b->v_over.z);
    ref_lobes albedo = ref_bsdf_albedo(b);
    double sum = 0;
    for (int i = 0; i < REF_LOBES; i++) {
        b->pick[i] = ref_luminance(albedo.of[i]);
        if (b->walk && i == REF_BASE) b->pick[i] += ref_luminance(b->rest_color) * b->seen.lost;
        sum += b->pick[i];
    }
    /* Every existing lobe gets some probability: an estimated albedo may be too low. */
    for (int i = 0; i < REF_LOBES; i++) {
        bool there = i == REF_BASE || (i == REF_COAT ? s->coat > 0 : true);
        b->pick[i] = sum > 0 ? 0.9 * b->pick[i] / sum : 0;
        if (there) b->pick[i] += 0.1 / (s->coat > 0 ? 3 : 2);
    }
    if (!(sum > 0)) {
        b->pick[REF_BASE] = b->pick[REF_SOFT] = 0.5;
        b->pick[REF_COAT] = 0;
    }
    double all = b->pick[0] + b->pick[1] + b->pick[2];
    for (int i = 0; i < REF_LOBES; i++) b->pick[i] /= all;
}

ref_lobes ref_bsdf_albedo(const ref_bsdf *b) {
    ref_lobes out;
    const ref_returned *s = &b->seen;
    out.of[REF_BASE] =
        ref_add(ref_scale(b->mixed.f0, s->white - s->weight), ref_splat(b->mixed.f90 * s->weight));
    out.of[REF_COAT] = ref_splat(s->coat);
    ref_vec diffuse = ref_scale(b->s.albedo, (1 - ref_clamp(b->s.metallic, 0, 1)) * below(b, s));
    out.of[REF_SOFT] = ref_add(diffuse, ref_scale(b->rest_color, s->lost));
    for (int i = 0; i < REF_LOBES; i++) out.of[i] = ref_scale(out.of[i], b->bared);
    if (b->sheen_most > 0)
        out.of[REF_SOFT] =
            ref_add(out.of[REF_SOFT], ref_scale(b->s.sheen, (1 - b->bared) / b->sheen_most));
    return out;
}

static double through_coat(const ref_bsdf *b, double l_over) {
    double steep = ref_schlick(fmin(l_over, b->v_over.z));
    return fmax(1 - b->s.coat * (b->line[0] + b->line[1] * steep), 0);
}

static ref_vec mirror_of(const ref_bsdf *b, ref_vec l) {
    ref_vec h = ref_unit(ref_add(b->v, l));
    ref_vec f = ref_fresnel_at(&b->mixed, ref_dot(b->v, h));
    return ref_scale(f, b->grained ? grain_lobe(b, l) : ref_ggx_lobe(b->alpha, b->v, l));
}

ref_lobes ref_bsdf_eval(const ref_bsdf *b, ref_vec light, ref_random *r) {
    ref_lobes out;
    if (b->walk) return ref_layers_eval(b, light, r);
    memset(&out, 0, sizeof out);
    ref_vec l = ref_to(&b->base, light), over = ref_to(&b->over, light);
    if (b->s.coat > 0 && over.z > 0) {
        ref_vec h = ref_unit(ref_add(b->v_over, over));
        double f = 0.04 + 0.96 * ref_schlick(ref_dot(b->v_over, h));
        out.of[REF_COAT] = ref_splat(b->s.coat * f * ref_ggx_lobe(b->coat_alpha, b->v_over, over));
    }
    if (!(l.z > 0)) return out;
    double open = b->s.coat > 0 ? through_coat(b, ref_clamp(over.z, 0, 1)) : 1;
    out.of[REF_BASE] = ref_scale(mirror_of(b, l), open);
    ref_returned lit = returned_at(b, l.z, ref_clamp(over.z, 0, 1));
    double diffuse = (1 - ref_clamp(b->s.metallic, 0, 1)) * below(b, &b->seen) * below(b, &lit) /
                     fmax(below(b, &b->all), 1e-6);
    double rest = b->seen.lost * lit.lost / fmax(b->all.lost, 1e-6);
    ref_vec soft = ref_along(ref_scale(b->s.albedo, diffuse), rest, b->rest_color);
    out.of[REF_SOFT] = ref_scale(soft, l.z / REF_PI);
    if (b->sheen_most > 0) {
        double bared = fmin(b->bared, 1 - b->sheen_most * sheen_albedo(b->s.sheen_roughness, l.z));
        for (int i = 0; i < REF_LOBES; i++) out.of[i] = ref_scale(out.of[i], bared);
        out.of[REF_SOFT] =
            ref_along(out.of[REF_SOFT], sheen_lobe(b->sheen_alpha, b->v, l), b->s.sheen);
    }
    return out;
}

double ref_bsdf_pdf(const ref_bsdf *b, ref_vec light) {
    ref_vec l = ref_to(&b->base, light), over = ref_to(&b->over, light);
    double pdf = 0;
    if (l.z > 0)
        pdf += b->pick[REF_BASE] * (b->grained ? grain_pdf(b, l) : ref_ggx_pdf(b->alpha, b->v, l));
    if (over.z > 0 && b->pick[REF_COAT] > 0)
        pdf += b->pick[REF_COAT] * ref_ggx_pdf(b->coat_alpha, b->v_over, over);
    if (l.z > 0) pdf += b->pick[REF_SOFT] * l.z / REF_PI;
    return pdf;
}

/* Half vectors that reflect v below the horizon contribute nothing: these samples are lost. */
bool ref_bsdf_sample(const ref_bsdf *b, ref_random *r, ref_vec *l, ref_lobes *weight) {
    double which = ref_draw(r);
    double u1 = ref_draw(r);
    double u2 = ref_draw(r);
    ref_vec w;
    if (which < b->pick[REF_BASE]) {
        ref_vec n = b->grained ? grain_normal(b, u1, u2) : ref_ggx_normal(b->alpha, b->v, u1, u2);
        w = ref_reflect(b->v, n);
        *l = ref_from(&b->base, w);
    } else if (which < b->pick[REF_BASE] + b->pick[REF_COAT]) {
        ref_vec n = ref_ggx_normal(b->coat_alpha, b->v_over, u1, u2);
        w = ref_reflect(b->v_over, n);
        *l = ref_from(&b->over, w);
    } else {
        w = ref_cosine_sample(u1, u2);
        *l = ref_from(&b->base, w);
    }
    if (!(w.z > 0)) return false;
    double pdf = ref_bsdf_pdf(b, *l);
    if (!(pdf > 0)) return false;
    *weight = ref_bsdf_eval(b, *l, r);
    for (int i = 0; i < REF_LOBES; i++) weight->of[i] = ref_scale(weight->of[i], 1 / pdf);
    return true;
}
