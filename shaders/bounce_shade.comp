/*
 * bounce_shade.comp: the diffuse light that leaves each hit of the frame's live probe rays. It is
 * the sum of emission, the indirect light of the surrounding live probes (so that light bounces
 * repeatedly), and one light. This light is chosen by a hash of the ray, in proportion to each
 * light's unshadowed contribution, and divided by its probability. A separate shadow ray tests it,
 * so that no light leaks through walls, whether or not the light has a shadow map.
 *
 * Baked probes already contain sky and sun with all bounces: both are then omitted here.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#ifndef MASU_NO_POLYGONS
#define MASU_SURFACE /* polygons may have lobes */
#endif
#include "shared/lights.h"
#include "shared/trace.h"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "light/shade.glsl"
#define MASU_PROBES_LIVE
#include "light/probes.glsl"
#ifdef MASU_LIGHTS
#include "light/lights.glsl"
#endif
#ifndef MASU_NO_POLYGONS
#define MASU_TRACE_POLYGONS
#include "trace/scene.glsl"
#include "trace/texels.glsl"
#endif
#include "specular/ray.glsl"
#include "trace/met.glsl"
#include "bounce/ray.glsl"

layout(local_size_x = 64) in;

/* Directional albedo, diffuse and specular, for incident light at the given cosine to the normal;
 * by reciprocity also for uniform incident light that leaves at that cosine. Probes store only
 * low-frequency light, so the specular part is spread over the hemisphere like the diffuse part.
 * Otherwise wet asphalt of albedo 0.045 would reflect a third. */
vec3 reflectance(masu_surface s, float cosine)
{
    uint row = masu_row_of(masu_sane(s.roughness, 0.0, 1.0));
    vec2 t = masu_table(uint(MASU_TABLE_LOSS), row, clamp(cosine, 0.0, 1.0));
    vec3 albedo = clamp(s.albedo, vec3(0.0), vec3(1.0));
    float f0 = masu_brightest_f0(s), f90 = min(50.0 * f0, 1.0);
    float matte = f0 * (1.0 - t.x) + (f90 - f0) * t.y;
    vec3 mirrored = vec3(matte);
#ifdef MASU_SURFACE
    /* The colour, and multiple scattering, which is significant for an f0 above 0.08. */
    if (masu_extra_lobes != 0u) {
        float lost = masu_table_averages(uint(MASU_TABLE_AVERAGE), 2u, row, 0u).x;
        float rest = masu_rest_color(vec3(f0), f90, lost).r * t.x;
        vec3 colors = masu_dielectric_f0(s, f0);
        matte += rest;
        mirrored = colors * (1.0 - t.x) + (f90 - colors) * t.y + rest;
    }
#endif
    /* Metals: energy lost by single scattering is reflected again, tinted once more. */
    vec3 metal = albedo * (1.0 - t.x + t.x * albedo) + (1.0 - albedo) * t.y;
    return mix(albedo * (1.0 - matte) + mirrored, metal, masu_sane(s.metallic, 0.0, 1.0));
}

/* The light chosen among those offered so far. */
struct chosen {
    vec3 color;  /* its contribution, irradiance / pi */
    vec3 l;
    float far;   /* its distance */
    float weight; /* its weight */
    float total; /* sum of weights */
};

/* Reservoir sampling: each light replaces the chosen one with probability weight / sum so far. */
void ask(inout chosen c, vec3 l, float far, vec3 color, float chance)
{
    float weight = dot(color, vec3(0.2126, 0.7152, 0.0722));
    if (weight > 0.0) {
        c.total += weight;
        if (chance * c.total < weight) {
            c.color = color;
            c.l = l;
            c.far = far;
            c.weight = weight;
        }
    }
}

#ifdef MASU_LIGHTS
/* Offers a light, for a point relative to the camera. Capsules and rectangles are sampled at one
 * point, which two random numbers choose. Shadow rays end before the bulb around a lamp and before
 * a light's own surface. */
void ask_light(inout chosen c, masu_punctual_light_data light, vec3 rel, vec3 n, uvec3 hash)
{
    vec3 l;
    vec3 color;
    if (!masu_light_reaches(light, rel, l, color)) {
        return;
    }
    vec3 to = light.position.xyz - rel;
    float margin = max(1.1 * masu_sqrt(light.color.w) + 0.02, 0.05); /* the bulb may be as large */
    if (masu_light_is_shared(light) && masu_light_within(light, rel) < 1.0) {
        return; /* the light's own surface */
    }
    if (masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT) {
        vec3 u, v;
        if (!masu_light_axes(light, to, u, v)) {
            return;
        }
        float cosine;
        vec3 form = masu_form_factor(to, u, v);
        color *= masu_above(form, dot(form, n), cosine);
        to += (2.0 * masu_bounce_unit(hash.y) - 1.0) * u +
              (2.0 * masu_bounce_unit(hash.z) - 1.0) * v;
        l = masu_normalize(to, n);
        float thick = masu_light_kind(light) == MASU_KIND_CAPSULE ? masu_sqrt(light.color.w)
                                                                  : light.axis.w;
        float facing = abs(dot(masu_normalize(cross(u, v), l), l));
        margin = 1.1 * thick / max(facing, 0.1) + 0.02;
    } else {
        color *= max(dot(n, l), 0.0);
    }
    ask(c, l, max(masu_sqrt(dot(to, to)) - margin, 0.0), color, masu_bounce_unit(hash.x));
}

/* Whether a point relative to the camera is on the surface of a light, whose emission is added as
 * that light. */
bool is_of_light(vec3 rel)
{
    uint lights = masu_light_count();
    for (uint k = 0u; k < uint(MASU_LOCAL_LIGHTS_MAX); k++) {
        if (k >= lights) {
            break;
        }
        if (masu_light_is_shared(masu_lights[k]) && masu_light_within(masu_lights[k], rel) < 1.0) {
            return true;
        }
    }
    return false;
}
#endif

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < masu_bounce.rays.x * 64u && i < masu_bounce.rays.w) {
        masu_bounce_ray ray = masu_bounce_ray_at(i);
        vec3 direction = masu_bounce_direction(ray);
        vec3 place = masu_probe_place(ray.probe);
        uvec4 hit = masu_bounce_rays[2u * i];
        float t = masu_met_at(hit);
        bool unlit = probe_grid.counts.w == 0u; /* nothing is baked */
        vec3 sum = vec3(0.0), added = vec3(0.0);
        chosen c = chosen(vec3(0.0), vec3(0.0, 1.0, 0.0), -1.0, 1.0, 0.0);
        vec3 from = place + direction * max(t, 0.0);
        vec3 lifted = from;
        if (t >= 0.0) {
            met m;
#ifdef MASU_TRACE_POLYGONS
            if ((hit.y & MASU_HIT_SDF) == 0u) {
                /* Footprint: the spacing of a set's rays. */
                m = met_polygon(hit, direction, t * masu_rsqrt(float(masu_bounce_each())) * 3.0);
            } else
#endif
            {
                m = met_sdf(hit);
            }
            vec3 eye = (frame.eye_hi.xyz - probe_grid.origin.xyz) + frame.eye_lo.xyz;
            sum = min(m.surface.emissive, vec3(MASU_BOUNCE_EMISSION));
#ifdef MASU_LIGHTS
            if (max(sum.r, max(sum.g, sum.b)) > 0.0 && is_of_light(from - eye)) {
                sum = vec3(0.0);
            }
#endif
            if (!masu_is_unlit(m.surface)) {
                vec3 n = m.normal;
                /* Before the lights: it needs the most registers. */
                vec4 live = masu_probe_light(from, n);
                sum += reflectance(m.surface, -dot(n, direction)) *
                       (live.rgb * live.w + (unlit ? masu_ambient(n) * (1.0 - live.w) : vec3(0.0)));
                vec3 far = abs(from + probe_grid.origin.xyz);
                lifted += n *
                          (4e-6 * (max(far.x, max(far.y, far.z)) + t) + 2e-3 * probe_grid.origin.w);
                uint seed = (ray.probe * MASU_BOUNCE_SETS + ray.set) * MASU_BOUNCE_RAYS_MAX +
                            ray.number;
                if (unlit) {
                    vec3 l = frame.sun_direction.xyz;
                    ask(c, l, frame.trace_anchor.w, frame.sun_color.rgb * max(dot(n, l), 0.0), 0.0);
                }
#ifdef MASU_LIGHTS
                uint lights = masu_light_count();
                for (uint k = 0u; k < uint(MASU_LOCAL_LIGHTS_MAX); k++) {
                    if (k >= lights) {
                        break;
                    }
                    ask_light(c, masu_lights[k], lifted - eye, n,
                              masu_bounce_hash(uvec3(seed, k, 0x626F756Eu)));
                }
#endif
                added = reflectance(m.surface, dot(n, c.l)) * c.color * (c.total / c.weight);
            }
        } else if (unlit) {
            sum = masu_sky(direction);
        }
        sum = masu_sane(sum, 0.0, 65504.0);
        added = masu_sane(added, 0.0, 65504.0);
        vec3 at = lifted + (probe_grid.origin.xyz - frame.trace_anchor.xyz);
        masu_bounce_rays[2u * i] = uvec4(floatBitsToUint(at),
                                         floatBitsToUint(c.total > 0.0 ? c.far : -1.0));
        masu_bounce_rays[2u * i + 1u] = uvec4(packHalf2x16(sum.rg),
                                              packHalf2x16(vec2(sum.b, added.r)),
                                              packHalf2x16(added.gb), masu_pack_direction(c.l));
    }
}
