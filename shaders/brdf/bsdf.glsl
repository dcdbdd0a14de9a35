/*
 * bsdf.glsl: how a surface scatters light: one function for polygons, SDF hits and ray hits.
 *
 *   f = coat + through(v, l) * specular + rest + diffuse
 *
 *   specular  GGX with height-correlated Smith masking (Heitz, JCGT 3-2, 2014), alpha =
 *             roughness^2, Schlick's Fresnel term from f0 to f90
 *   rest      multiple scattering between facets, which the lobe lacks: the product of its losses
 *             for v and for l (Kulla and Conty, "Revisiting Physically Based Shading at
 *             Imageworks", 2017)
 *   diffuse   receives the remaining energy: the product of the remainders for v and for l (Kelemen
 *             and Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", 2001)
 *   coat      the same lobe with f0 = 0.04; only with MASU_SURFACE
 *
 * The function is reciprocal. A white surface returns all light from every direction at every
 * roughness, within the error of the tables (tables.glsl), because the two products return by
 * construction the energy that the lobes lack.
 *
 * Metallic is a blend of two surfaces. A dielectric has f0 = 0.08 * specular and the base colour
 * below; a metal has the base colour as f0 and nothing below. Below an f0 of 0.02, which no real
 * material has, f90 falls too, so that specular 0 and black metals have no grazing reflection.
 *
 * The coat transmits through = 1 - coat * (a + b * max(s(v), s(l))), s(w) = (1 - N.w)^5. The
 * maximum is symmetric, and exact for a mirror, where s(v) = s(l). Since a and b are outside of the
 * integral, one table over N.v and the base's roughness serves all coats. a + b s is at least the
 * coat's reflectance (make_split_sum.c), so that energy is conserved; the difference goes to `rest`
 * and `diffuse`. Rejected: 1 - F(h.v), which needs no extra table but transmits too much if the
 * base is rougher than the coat; the product of both directions' shares, which darkens mirrors.
 *
 * A coat may have a separate normal (masu_own_coats): smooth lacquer over a relief. Its lobe, its
 * transmission and its albedo then use the coat's cosines, the other terms the base's. With equal
 * normals the result is bit-identical. The table of covered light has the base's cosine as its
 * argument but is read with the coat's, and the hemispherical means assume one normal. With 20
 * degrees between the normals, white dielectrics therefore return 0.977 to 0.998 of the light,
 * metals 0.83 to 1.02 (tests/unit/test_brdf.c).
 *
 * Lobes of masu_extra_lobes, one a surface:
 *   colour  f0 of any colour and strength; lower layers get the light left by the brightest channel
 *   sheen   Charlie's distribution and masking (Estevez and Kulla, "Production Friendly Microfacet
 *           Sheen BRDF", 2017) by their fits; lower layers are scaled by the lesser of 1 - E(v), 1
 *           - E(l) (KHR_materials_sheen). E by a fit to its integral: RMS 0.013, worst 0.05 at a
 *   cosine of 0.02 grain   GGX with two alphas (Heitz 2014); albedos are those of the root mean
 *           square of both. Light looked up around the mirror direction is a mean over normals that
 * lean along the grain (masu_fan, shade.glsl)
 *
 * All in fp32, finite for any bit pattern.
 */
#ifndef MASU_BSDF_GLSL
#define MASU_BSDF_GLSL

#include "shared/lookup_tables.h"
#include "brdf/ggx.glsl"
#include "brdf/tables.glsl"
#include "shared/guard.glsl"
#include "shared/pack.glsl"

/* Directional albedo, or its mean over all directions: of a lobe whose Fresnel term is 1 (white) or
 * Schlick's (1 - h.v)^5 (weight), and of the coat. */
struct masu_albedo {
    float white;
    float weight;
    float coat;
};

struct masu_bsdf {
    vec3 n, v;
    float n_v;         /* 1e-4..1 */
    float alpha;
    uint row;
    vec3 f0;
    float f90;
    float matte_f0;    /* of the dielectric's share: f0, */
    float matte_slope; /* f90 - f0, */
    float matte_rest;  /* factor of its `rest` */
    masu_albedo seen;  /* of v */
    vec3 rest;         /* factor of `rest`, for l; times pi */
    vec3 diffuse;      /* factor of `diffuse`, for l; times pi */
    vec3 ambient;      /* of irradiance / pi */
#ifdef MASU_SURFACE
    float coat;
    float coat_alpha;
    uint coat_row;
    vec2 coat_line;    /* a, b */
    vec3 coat_n;
    float coat_n_v;
    float coat_gain;   /* factor of the coat's lobe, 1 */
    vec3 sheen;        /* colour of the sheen; 0 without a sheen, like the next members */
    float sheen_alpha;
    float sheen_bend;  /* of masu_sheen_masking, at a cosine of 0.5 */
    float sheen_v;     /* masking of v */
    float bared;       /* factor of the layers below a sheen, for v; 1 without a sheen */
    vec3 grain;        /* unit; along it alpha is grain_alpha. 0 without one */
    float grain_alpha;
#endif
};

float masu_schlick(float cosine)
{
    float f = clamp(1.0 - cosine, 0.0, 1.0);
    float f2 = f * f;
    return f2 * f2 * f;
}

/* D * G2 / (4 NoL NoV), times pi. */
float masu_ggx(vec3 n, vec3 h, float alpha, float n_l, float n_v)
{
    vec3 sine = cross(n, h);
    float k = masu_ggx_peak(clamp(dot(n, h), 0.0, 1.0), dot(sine, sine), alpha);
    return k * k * 0.5 / masu_ggx_masking(alpha, n_l, n_v);
}

float masu_lost(masu_albedo a)
{
    return max(1.0 - a.white - a.coat, 0.0);
}

/* Reflectance of the dielectric's share above the base colour. */
float masu_matte(masu_bsdf b, masu_albedo a)
{
    return a.coat + b.matte_f0 * a.white + b.matte_slope * a.weight + b.matte_rest * masu_lost(a);
}

/* From the tables' numbers, of a direction or averages. The base's: loss and B, X and XB; of the
 * coat loss and B. */
masu_albedo masu_albedo_from(masu_bsdf b, vec2 base, vec2 covered, vec2 coat)
{
#ifdef MASU_SURFACE
    float through = 1.0 - b.coat * b.coat_line.x, less = b.coat * b.coat_line.y;
    return masu_albedo(through * (1.0 - base.x) - less * covered.x,
                       through * base.y - less * covered.y,
                       b.coat * (0.04 * (1.0 - coat.x) + 0.96 * coat.y));
#else
    return masu_albedo(1.0 - base.x, base.y, 0.0);
#endif
}

/* over: the coat's cosine. */
masu_albedo masu_albedo_of(masu_bsdf b, float cosine, float over)
{
    vec2 base = masu_table(uint(MASU_TABLE_LOSS), b.row, cosine);
    vec2 covered = vec2(0.0), coat = vec2(0.0);
#ifdef MASU_SURFACE
    if (b.coat > 0.0) {
        covered = masu_table(uint(MASU_TABLE_COAT), b.row, over);
        coat = masu_table(uint(MASU_TABLE_LOSS), b.coat_row, over);
    }
#endif
    return masu_albedo_from(b, base, covered, coat);
}

/* Colour of multiple scattering, as a factor of the lost energy (Kulla and Conty). lost: the mean
 * loss. With only the square of f (Hill, "A Multi-Faceted Exploration", part 4, 2018), metals of f
 * 0.5 are up to 8 % darker than random walks between facets. The second factor, which is 1 at f =
 * 1, halves this error. */
vec3 masu_rest_color(vec3 f0, float f90, float lost)
{
    vec3 f = f0 + (f90 - f0) * (1.0 / 21.0);
    return f * f * (1.35 - 0.35 * f) * (1.0 - lost) / (1.0 - f * lost);
}

/* A coloured dielectric reflectance affects only single scattering: the diffuse layer gets the
 * light left by the brightest channel, which is grey (KHR_materials_specular), and so does multiple
 * scattering. */
float masu_most_specular()
{
#ifdef MASU_SURFACE
    return masu_extra_lobes != 0u ? 12.5 : 1.0;
#else
    return 1.0;
#endif
}

/* Reflectance of a dielectric at normal incidence, of the brightest channel, */
float masu_brightest_f0(masu_surface s)
{
    return 0.08 * masu_sane(s.specular, 0.0, masu_most_specular());
}

/* and of each channel. */
vec3 masu_dielectric_f0(masu_surface s, float f0)
{
#ifdef MASU_SURFACE
    if (masu_has_lobe(s, MASU_LOBE_COLORED)) {
        return f0 * masu_lobe_hue(s.lobe >> 8 & 2047u);
    }
#endif
    return vec3(f0);
}

#ifdef MASU_SURFACE
/* ---- Sheen. The curve of masking, its fit for alpha 0 and 1 blended by (1 - alpha)^2 ---- */
float masu_sheen_curve(float x, float alpha)
{
    float t = 1.0 - alpha;
    t *= t;
    float a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), c = mix(0.19823, 0.16801, t);
    float d = mix(-1.97760, -1.27393, t), e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * masu_pow(x, c)) + d * x + e;
}

float masu_sheen_masking(masu_bsdf b, float cosine)
{
    bool low = cosine < 0.5;
    float curve = masu_sheen_curve(low ? cosine : 1.0 - cosine, b.sheen_alpha);
    return masu_exp2(1.44269504 * (low ? curve : 2.0 * b.sheen_bend - curve));
}

/* Directional albedo. */
float masu_sheen_albedo(float alpha, float cosine)
{
    float c = clamp(cosine, 0.0, 1.0), x = 1.0 / max(sqrt(alpha), 0.2);
    vec4 at = vec4(1.0, sqrt(c), c, c * c * c);
    vec4 k0 = vec4(0.1516, -0.3499, -0.5952, 0.2420), k1 = vec4(-0.1311, -0.7139, 0.0290, -0.2316);
    vec4 k2 = vec4(0.0312, 0.1164, -0.1814, -0.1540);
    return min(masu_exp2(1.44269504 * dot(k0 + (k1 + k2 * x) * x, at)), 1.0);
}

/* f * N.L * pi; sine2: of the half vector. */
vec3 masu_sheen(masu_bsdf b, float sine2, float n_l)
{
    float power = 1.0 / b.sheen_alpha;
    float d = (2.0 + power) * 0.5 * masu_pow(clamp(sine2, 0.0, 1.0), 0.5 * power);
    return b.sheen * (d * 0.25 / ((1.0 + b.sheen_v + masu_sheen_masking(b, n_l)) * b.n_v));
}

float masu_bared(masu_bsdf b, float cosine)
{
    return 1.0 -
           max(b.sheen.r, max(b.sheen.g, b.sheen.b)) * masu_sheen_albedo(b.sheen_alpha, cosine);
}

/* ---- Grain ---- */

/* As masu_ggx. */
float masu_ggx_grain(masu_bsdf b, vec3 h, vec3 l, float n_l)
{
    vec3 across = cross(b.n, b.grain);
    vec2 alpha = vec2(b.grain_alpha, b.alpha);
    vec2 at = vec2(dot(h, b.grain), dot(h, across)) / alpha;
    vec3 to_l = vec3(alpha * vec2(dot(l, b.grain), dot(l, across)), n_l);
    vec3 to_v = vec3(alpha * vec2(dot(b.v, b.grain), dot(b.v, across)), b.n_v);
    float n_h = clamp(dot(b.n, h), 0.0, 1.0), d = dot(at, at) + n_h * n_h;
    return 0.5 /
           max(alpha.x * alpha.y * d * d * (n_l * length(to_v) + b.n_v * length(to_l)), 1e-12);
}

/* alpha along the grain. */
float masu_grain_alpha(masu_surface s)
{
    float strength = float(s.lobe & 127u) / 127.0;
    return mix(masu_alpha(masu_sane(s.roughness, 0.0, 1.0)), 1.0, strength * strength);
}
#endif

/* The normal below a coat that has its own, n. */
vec3 masu_base_normal(masu_surface s, vec3 n)
{
#ifdef MASU_SURFACE
    if (masu_own_coats) {
        return masu_below(n, s.lean);
    }
#endif
    return n;
}

/* n: the normal, unit, a coat's where it has its own; v: towards the viewer, unit. */
masu_bsdf masu_bsdf_make(masu_surface s, vec3 n, vec3 v)
{
    masu_bsdf b;
    float roughness = masu_sane(s.roughness, 0.0, 1.0);
    float metallic = masu_sane(s.metallic, 0.0, 1.0);
    float f0 = masu_brightest_f0(s);
    vec3 albedo = masu_sane(s.albedo, 0.0, 1.0);
    b.n = n;
    b.v = v;
    b.n_v = masu_sane(dot(n, v), 1e-4, 1.0);
    float over = b.n_v;
#ifdef MASU_SURFACE
    b.coat_n = n;
    b.coat_n_v = over;
    b.coat_gain = 1.0;
    if (masu_own_coats) {
        b.n = masu_below(n, s.lean);
        b.n_v = masu_sane(dot(b.n, v), 1e-4, 1.0);
    }
#endif
    b.alpha = masu_alpha(roughness);
    b.row = masu_row_of(roughness);

    float metal_f90 = min(50.0 * max(albedo.r, max(albedo.g, albedo.b)), 1.0);
    float matte_f90 = min(50.0 * f0, 1.0);
#ifdef MASU_SURFACE
    matte_f90 = max(min(matte_f90, masu_sane(s.edge, 0.0, 1.0)), f0);
#endif
#ifdef MASU_SURFACE
    b.sheen = b.grain = vec3(0.0);
    b.sheen_alpha = b.bared = b.grain_alpha = 1.0;
    b.sheen_bend = b.sheen_v = 0.0;
    if (masu_has_lobe(s, MASU_LOBE_GRAIN)) {
        b.grain = masu_grain(s, b.n);
        b.grain_alpha = masu_grain_alpha(s);
        b.row = masu_row_of(sqrt(sqrt(0.5 * (b.alpha * b.alpha + b.grain_alpha * b.grain_alpha))));
    }
    if (masu_has_lobe(s, MASU_LOBE_SHEEN)) {
        b.sheen = masu_lobe_hue(s.lobe >> 10 & 2047u) * masu_lobe_root(s.lobe >> 5, 31u);
        float rough = max(float(s.lobe & 31u) / 31.0, 0.07);
        b.sheen_alpha = rough * rough;
        b.sheen_bend = masu_sheen_curve(0.5, b.sheen_alpha);
        b.sheen_v = masu_sheen_masking(b, b.n_v);
        b.bared = masu_bared(b, b.n_v);
    }
#endif
    b.matte_f0 = f0;
    b.matte_slope = matte_f90 - f0;

    vec2 base = masu_table_averages(uint(MASU_TABLE_AVERAGE), 2u, b.row, 0u);
    vec2 covered = vec2(0.0), coat = vec2(0.0);
#ifdef MASU_SURFACE
    b.coat = masu_sane(s.coat, 0.0, 1.0);
    float coat_roughness = masu_sane(s.coat_roughness, 0.0, 1.0);
    b.coat_alpha = masu_alpha(coat_roughness);
    b.coat_row = masu_row_of(coat_roughness);
    b.coat_line = vec2(0.0);
    if (b.coat > 0.0) {
        covered = masu_table_averages(uint(MASU_TABLE_COAT_AVERAGE), 4u, b.row, 0u);
        b.coat_line = masu_table_averages(uint(MASU_TABLE_COAT_AVERAGE), 4u, b.coat_row, 2u);
        coat = masu_table_averages(uint(MASU_TABLE_AVERAGE), 2u, b.coat_row, 0u);
    }
#endif
    float matte_rest = masu_rest_color(vec3(f0), matte_f90, base.x).r;
    b.matte_rest = matte_rest;
    masu_albedo all = masu_albedo_from(b, base, covered, coat);
    b.seen = masu_albedo_of(b, b.n_v, over);

    /* After the tables, so that albedo and metallic are all that is kept during their lookups. */
    b.f0 = mix(masu_dielectric_f0(s, f0), albedo, metallic);
    b.f90 = mix(matte_f90, metal_f90, metallic);
    float lost = masu_lost(b.seen);
    vec3 rest = mix(vec3(matte_rest), masu_rest_color(albedo, metal_f90, base.x), metallic) * lost;
    vec3 below = albedo * ((1.0 - metallic) * (1.0 - masu_matte(b, b.seen)));
    b.rest = rest / max(masu_lost(all), 1e-6);
    b.diffuse = below / max(1.0 - masu_matte(b, all), 1e-6);
    b.ambient = max(rest + below, vec3(0.0));
#ifdef MASU_SURFACE
    if (masu_has_lobe(s, MASU_LOBE_SHEEN)) {
        b.ambient = b.ambient * b.bared + b.sheen * masu_sheen_albedo(b.sheen_alpha, b.n_v);
    }
#endif
    return b;
}

/* Cosines of light from l, unit, to the base and to its coat; false: it reaches neither. */
bool masu_bsdf_lit(masu_bsdf b, vec3 l, out float n_l, out float over)
{
    n_l = masu_sane(dot(b.n, l), 0.0, 1.0);
    over = n_l;
#ifdef MASU_SURFACE
    if (masu_own_coats) {
        over = masu_sane(dot(b.coat_n, l), 0.0, 1.0);
    }
#endif
    return n_l > 0.0 || over > 0.0;
}

/* f * N.L * pi for light from l, unit: specular light, including multiple scattering, and diffuse
 * light. */
void masu_bsdf_parts(masu_bsdf b, vec3 l, out vec3 mirrored, out vec3 below)
{
    mirrored = vec3(0.0);
    below = vec3(0.0);
    float n_l, over;
    if (!masu_bsdf_lit(b, l, n_l, over)) {
        return;
    }
    vec3 sum = l + b.v;
    vec3 h = masu_normalize(sum, b.n);
    /* h.v is half of the length of l + v, and bit-identical if l and v are exchanged. */
    float s = masu_schlick(0.5 * sqrt(dot(sum, sum)));
    vec3 specular = (b.f0 + (b.f90 - b.f0) * s) * masu_ggx(b.n, h, b.alpha, n_l, b.n_v);
#ifdef MASU_SURFACE
    if ((masu_extra_lobes >> MASU_LOBE_GRAIN & 1u) != 0u && dot(b.grain, b.grain) > 0.0) {
        specular = (b.f0 + (b.f90 - b.f0) * s) * masu_ggx_grain(b, h, l, n_l);
    }
    float top = 0.0;
    if (b.coat > 0.0) {
        float steep = masu_schlick(min(over, b.coat_n_v));
        specular *= max(1.0 - b.coat * (b.coat_line.x + b.coat_line.y * steep), 0.0);
        float lobe = b.coat_gain * b.coat * (0.04 + 0.96 * s) *
                     masu_ggx(b.coat_n, h, b.coat_alpha, over, b.coat_n_v);
        if (masu_own_coats) {
            top = lobe * over;
        } else {
            specular += lobe;
        }
    }
#endif
    masu_albedo lit = masu_albedo_of(b, n_l, over);
    mirrored = (specular + b.rest * masu_lost(lit)) * n_l;
#ifdef MASU_SURFACE
    if (masu_own_coats) {
        mirrored += top;
    }
#endif
    mirrored = masu_sane(mirrored, 0.0, masu_huge);
    below = masu_sane(b.diffuse * ((1.0 - masu_matte(b, lit)) * n_l), 0.0, masu_huge);
#ifdef MASU_SURFACE
    if ((masu_extra_lobes >> MASU_LOBE_SHEEN & 1u) != 0u && b.bared < 1.0) {
        float bared = min(b.bared, masu_bared(b, n_l));
        vec3 sine = cross(b.n, h);
        mirrored *= bared;
        below = below * bared + masu_sane(masu_sheen(b, dot(sine, sine), n_l), 0.0, masu_huge);
    }
#endif
}

/* Both together. */
vec3 masu_bsdf_eval(masu_bsdf b, vec3 l)
{
    vec3 mirrored;
    vec3 below;
    masu_bsdf_parts(b, l, mirrored, below);
    return mirrored + below;
}

/* Factors of ambient light: of irradiance / pi, */
vec3 masu_bsdf_diffuse(masu_bsdf b)
{
    return b.ambient;
}

/* of radiance prefiltered by the surface's roughness around the mirror direction, */
vec3 masu_bsdf_specular(masu_bsdf b)
{
    vec3 mirrored = b.f0 * b.seen.white + (b.f90 - b.f0) * b.seen.weight;
#ifdef MASU_SURFACE
    if ((masu_extra_lobes >> MASU_LOBE_SHEEN & 1u) != 0u) {
        mirrored *= b.bared;
    }
#endif
    return mirrored;
}

/* and of radiance prefiltered by the coat's roughness. Their sum is 1 for a white surface. */
float masu_bsdf_coat(masu_bsdf b)
{
    return b.seen.coat;
}

#endif
