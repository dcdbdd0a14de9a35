/*
 * shade.glsl: the light that a surface sends to the camera (masu_shade); for light.comp,
 * transparents.frag and silhouettes.comp.
 *
 *   radiance = sum of lights * f * N.L + ambient
 *   f:        brdf/bsdf.glsl
 *   ambient:  irradiance for the diffuse terms; for the specular ones the sky in the mirror
 *             direction, blurred by the roughness
 */
#ifndef MASU_SHADE_GLSL
#define MASU_SHADE_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "brdf/bsdf.glsl"
#include "brdf/shelf.glsl"
#ifdef MASU_SURFACE
#include "brdf/meso.glsl"
#endif
#include "light/environment.glsl"
#include "light/sky.glsl"
#include "light/ambient.glsl"
#ifdef MASU_PROBES
#include "light/probes.glsl"
#endif

/* On Mali and the Raspberry Pi lights are loaded again instead of kept: 64 registers for
 * each thread, and on Mali twice the threads at 32. Elsewhere that would only be more
 * instructions. */
layout(constant_id = 26) const bool masu_few_registers = false;

/* Light that leaves a surface: diffuse and specular. */
struct masu_lit {
    vec3 diffuse;
    vec3 specular;
    vec3 mirror; /* specular albedo for ambient light; the rest reaches the diffuse layer */
};

/* Adds a light towards l, unit, with the irradiance color * pi on a facing surface. */
void masu_add_light(inout masu_lit lit, masu_surface s, masu_bsdf b, vec3 l, vec3 color)
{
#ifdef MASU_SURFACE
    if (s.shadow >= 0.0) {
        color *= masu_meso_shadow(s.shadow, b.v, l);
    }
#endif
    vec3 specular;
    vec3 diffuse;
    masu_bsdf_parts(b, l, specular, diffuse);
    lit.specular += color * specular;
    lit.diffuse += color * diffuse;
}

/* Ambient light at a point relative to the camera: of the open sky, or of the probes around. If the
 * probes have less light than the open sky, reflections are dimmed by the same ratio: the direction
 * of the missing light is unavailable. */
struct masu_around {
    vec3 irradiance; /* / pi */
    vec3 mirrored;   /* share of the open sky's light */
};

masu_around masu_ambient_at(vec3 rel, vec3 n)
{
#ifdef MASU_PROBES
    vec3 eye = (frame.eye_hi.xyz - probe_grid.origin.xyz) + frame.eye_lo.xyz;
    vec4 probes = masu_probe_light(eye + rel, n);
    masu_around around = masu_around(masu_ambient(n), vec3(1.0));
    vec3 open_sky = max(around.irradiance, vec3(1e-4));
    around.irradiance = mix(around.irradiance, probes.rgb, probes.w);
    around.mirrored = clamp(around.irradiance / open_sky, vec3(0.0), vec3(1.0));
    return around;
#else
    return masu_around(masu_ambient(n), vec3(1.0));
#endif
}

/* The open sky reflected by a surface and its coat; 0 without specular reflection. kept: share of
 * the ambient light that base and coat reflect here; the rest is traced (specular_composite.comp).
 *
 * To be evaluated before masu_bsdf_make: a sky lookup takes as many registers as a bsdf. */
struct masu_mirrored {
    vec3 base;
    vec3 coat;
    float even; /* share of the base's f0 that uses irradiance instead */
    float kept; /* of the base */
};

/* Mips of an environment map are prefiltered for a viewer above the surface. At grazing angles the
 * lobe of a rough surface is closer to the normal, and the part weighted by Schlick's (1 - h.v)^5
 * is about half as rough and close to the mirror direction. One lookup serves both parts, fitted to
 * integrals over six maps: log RMS at N.V 0.15 to 0.4, roughness 0.75 and 1, of white metal 24 and
 * 12 % instead of 62 and 57, of black dielectric 33 and 36 instead of 68, 75. direction: in the
 * mirror direction, out the lookup's, of any length; roughness: out the lookup's. Returns the share
 * of the f0 term that uses irradiance instead. */
float masu_bend_lookup(masu_surface s, vec3 n, vec3 v, inout vec3 direction, inout float roughness)
{
    float r = masu_sane(s.roughness, 0.0, 1.0);
    float c = masu_sane(dot(n, v), 1e-4, 1.0);
    vec3 colors = mix(vec3(masu_brightest_f0(s)), masu_sane(s.albedo, 0.0, 1.0),
                      masu_sane(s.metallic, 0.0, 1.0));
    float f0 = max(colors.r, max(colors.g, colors.b));
    vec2 table = masu_table(uint(MASU_TABLE_LOSS), masu_row_of(r), c);
    float grazing = (1.0 - f0) * table.y;
    float share = grazing * masu_rcp(f0 * (1.0 - table.x) + grazing);
    float r2 = r * r;
    direction = mix(direction, n, r2 * (1.0 + (1.0 - 2.0 * c) * (1.0 - r)) * (1.0 - share));
    roughness = r * (1.0 - 0.5 * share);
    return share * r2;
}

#ifdef MASU_SURFACE
/* The open sky reflected by a surface with a grain: the mean over five normals, at equal steps of
 * the distribution of slopes along the grain (GGX: slope = alpha q / sqrt(1 - q^2)), each with the
 * roughness across the grain. */
vec3 masu_fan(masu_surface s, vec3 n, vec3 v)
{
    vec3 grain = masu_grain(s, n) * masu_grain_alpha(s), sum = vec3(0.0);
    float weights = 0.0;
    [[dont_unroll]] for (int i = 0; i < 5; i++) {
        float q = 0.4 * float(i) - 0.8;
        vec3 h = masu_normalize(n + grain * (q * masu_rsqrt(1.0 - q * q)), n);
        vec3 l = reflect(-v, h);
        float weight = dot(n, l) > 0.0 ? max(dot(v, h), 0.0) : 0.0;
        sum += weight * masu_ambient_mirror(l, s.roughness);
        weights += weight;
    }
    return weights > 1e-4 ? sum / weights : masu_ambient_mirror(reflect(-v, n), s.roughness);
}
#endif

masu_mirrored masu_mirrored_sky(masu_surface s, vec3 n, vec3 v, vec2 kept)
{
    masu_mirrored m = masu_mirrored(vec3(0.0), vec3(0.0), 0.0, kept.x);
    vec3 normal = n;
#ifdef MASU_SURFACE
    if (masu_own_coats) {
        normal = masu_below(n, s.lean);
    }
#endif
    vec3 mirrored = reflect(-v, normal);
    float roughness = s.roughness;
    if (masu_has_environment) {
        m.even = masu_bend_lookup(s, normal, v, mirrored, roughness);
    }
#ifdef MASU_SURFACE
    /* In a loop, so that the sky code is compiled only once. */
    float part = kept.x;
    [[dont_unroll]] for (int i = 0; i < 2; i++) {
        m.coat = vec3(0.0);
        if (part > 0.0) {
            m.coat = part * masu_ambient_mirror(mirrored, roughness);
        }
        m.base = i == 0 ? m.coat : m.base;
        part = s.coat > 0.0 ? kept.y : 0.0;
        mirrored = reflect(-v, n);
        roughness = s.coat_roughness;
    }
    if (masu_has_lobe(s, MASU_LOBE_GRAIN) && kept.x > 0.0) {
        m.base = kept.x * masu_fan(s, normal, v);
    }
#else
    if (kept.x > 0.0) {
        m.base = kept.x * masu_ambient_mirror(mirrored, roughness);
    }
#endif
    return m;
}

#ifdef MASU_LIGHTS
#ifdef MASU_PROBES
/* A surface as half floats, while a lookup of probes needs its registers. */
struct masu_shelved_look {
    uvec2 albedo, emissive;
    uint metallic;
#ifdef MASU_SURFACE
    uint coat;
#endif
};

masu_shelved_look masu_shelve(masu_surface s)
{
    masu_shelved_look p;
    p.albedo = masu_pack_halves(vec4(s.albedo, s.roughness));
    p.emissive = masu_pack_halves(vec4(s.emissive, s.specular));
    p.metallic = packHalf2x16(vec2(s.metallic, 0.0));
#ifdef MASU_SURFACE
    p.coat = packHalf2x16(vec2(s.coat, s.coat_roughness));
#endif
    return p;
}

void masu_unshelve(masu_shelved_look p, inout masu_surface s)
{
    vec4 v = masu_unpack_halves(p.albedo);
    s.albedo = v.xyz;
    s.roughness = v.w;
    v = masu_unpack_halves(p.emissive);
    s.emissive = v.xyz;
    s.specular = v.w;
    s.metallic = unpackHalf2x16(p.metallic).x;
#ifdef MASU_SURFACE
    vec2 coat = unpackHalf2x16(p.coat);
    s.coat = coat.x;
    s.coat_roughness = coat.y;
#endif
}
#endif

/* Ambient light at a point relative to the camera. Called before masu_bsdf_make, since the probe
 * lookup needs the most registers. n: the normal of the base layer. With probes, s is rounded to
 * half floats. */
masu_around masu_ambient_first(inout masu_surface s, vec3 rel, vec3 n)
{
#ifdef MASU_PROBES
    masu_shelved_look look = masu_shelve(s);
    masu_around around = masu_ambient_at(rel, n);
    masu_unshelve(look, s);
    return around;
#else
    return masu_ambient_at(rel, n);
#endif
}
#endif

/* Only the ambient light. b: of s; around: computed before b (masu_ambient_at needs many
 * registers); seen: visibility of the ambient light; sky: from masu_mirrored_sky. */
masu_lit masu_shade_around(masu_surface s, masu_bsdf b, masu_around around, float seen,
                           masu_mirrored sky)
{
    vec3 ambient = around.mirrored * (seen * s.occlusion);
    masu_lit lit = masu_lit(masu_bsdf_diffuse(b) * around.irradiance * (seen * s.occlusion),
                            vec3(0.0), masu_bsdf_specular(b));
    lit.specular = lit.mirror * sky.base * ambient;
    if (masu_has_environment) {
        vec3 even = sky.kept * around.irradiance - sky.base * around.mirrored;
        lit.specular += b.f0 * (b.seen.white * sky.even * seen * s.occlusion) * even;
    }
#ifdef MASU_SURFACE
    if (s.coat > 0.0) {
        float coat = masu_bsdf_coat(b);
        lit.mirror += coat;
        lit.specular += coat * sky.coat * ambient;
    }
#endif
    return lit;
}

/* Ambient light plus the sun; seen: visibility of the sun and of the ambient light. */
masu_lit masu_shade(masu_surface s, masu_bsdf b, masu_around around, vec2 seen, masu_mirrored sky)
{
    masu_lit lit = masu_shade_around(s, b, around, seen.y, sky);
    masu_add_light(lit, s, b, frame.sun_direction.xyz, frame.sun_color.rgb * seen.x);
    return lit;
}

#endif
