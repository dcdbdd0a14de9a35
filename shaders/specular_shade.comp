/*
 * specular_shade.comp: radiance along the ray of each traced texel. Hits are lit like the main view
 * (light/shade.glsl: the sun with its shadow map, punctual lights, ambient light); misses return
 * the sky. A surface in a reflection reflects the sky or the probes.
 *
 * The sun's disc and the sun's light in the sky around the reflecting surface are not included:
 * light.comp adds the sun's highlight exactly.
 *
 * push.accumulate: 1: the reference: radiance is multiplied by the ray weight.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_SURFACE /* any hit may have a coat */
#define MASU_LOCAL_SHADOWS_FOUR /* four taps, not nine: fewer registers, as MASU_SHELVED */
#define MASU_SHELVED
#include "push/specular_shade.h"
#include "shared/lights.h"
#include "shared/trace.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/shade.glsl"
#include "light/air.glsl"
#ifndef MASU_NO_POLYGONS /* rays can hit only the SDF */
#define MASU_TRACE_POLYGONS
#include "trace/scene.glsl"
#include "trace/texels.glsl"
#endif
#include "specular/filter.glsl"
#include "specular/origin.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"
#include "trace/met.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(constant_id = 2) const bool foggy = false; /* the scene has fog */

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D ray_image;
layout(set = MASU_SET_PASS, binding = 2) uniform usampler2D hit_image;
#ifdef MASU_SUN_MAP
#define MASU_AT_SUN_MAP 3
#include "light/sun_map.glsl"
#define MASU_AT_LOCAL_SHADOWS 4
#else
#define MASU_AT_LOCAL_SHADOWS 3
#endif
#ifdef MASU_LOCAL_SHADOWS
#define MASU_AT_LIGHT (MASU_AT_LOCAL_SHADOWS + 1)
#else
#define MASU_AT_LIGHT MASU_AT_LOCAL_SHADOWS
#endif
#ifdef MASU_LIGHTS
#include "light/lights.glsl"
#endif
layout(set = MASU_SET_PASS, binding = MASU_AT_LIGHT, rgba16f) uniform writeonly image2D light_image;

/* Radiance of a hit at a point relative to the camera. */
vec3 radiance(met m, vec3 rel, vec3 direction)
{
    if (masu_is_unlit(m.surface)) {
        return m.surface.emissive;
    }
    /* Each step leaves few values for the next: fewer registers. */
    vec2 seen = vec2(1.0);
#ifdef MASU_SUN_MAP
    /* Towards the sun, but not frame.sun_direction, which would stay in registers until the sun is
     * shaded. */
    if (dot(m.normal, shadow.row2[0].xyz) > 0.0) {
        seen.x = masu_sun_seen(rel, m.normal, dot(rel, frame.forward.xyz));
    }
#endif
#ifdef MASU_LIGHTS
    masu_around around = masu_ambient_first(m.surface, rel, masu_base_normal(m.surface, m.normal));
#else
    masu_around around = masu_ambient_at(rel, masu_base_normal(m.surface, m.normal));
#endif
    masu_mirrored sky = masu_mirrored_sky(m.surface, m.normal, -direction, vec2(1.0));
    masu_bsdf b = masu_bsdf_make(m.surface, m.normal, -direction);
    masu_lit lit = masu_shade(m.surface, b, around, seen, sky);
#ifdef MASU_LIGHTS
    masu_light_sum sum = masu_light_sum(lit.diffuse + lit.specular + m.surface.emissive);
    masu_shelved_bsdf shelf = masu_shelve(b);
    uint lights = masu_light_count();
    for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX); i++) {
        if (i >= lights) {
            break;
        }
        masu_add_local_light(sum, m.surface, b, shelf, i, rel, m.normal, vec3(0.0));
    }
    return sum.light;
#else
    return lit.diffuse + lit.specular + m.surface.emissive;
#endif
}

/* Radiance that a hit sends back along the ray from a point, without the air between. */
vec3 hit_light(uvec4 hit, masu_guide g, vec3 point, vec3 direction, float t)
{
    vec3 rel = masu_specular_origin(point, g) - frame.trace_eye.xyz + direction * t;
    met m;
#ifdef MASU_TRACE_POLYGONS
    if ((hit.y & MASU_HIT_SDF) == 0u) {
        /* Width of the lobe at the hit: half of the lobe is within its roughness squared. */
        float width = masu_specular_width(g) +
                      t * (g.roughness * g.roughness + frame.up.w * 2.0 / float(pc.render_height));
        m = met_polygon(hit, direction, width);
    } else
#endif
    {
        m = met_sdf(hit);
    }
#ifdef MASU_LIGHTS
    if (masu_shared_lights && push.accumulate == 0u &&
        any(greaterThan(m.surface.emissive, vec3(0.0)))) {
        vec3 eye = -masu_normalize(point, g.normal);
        m.surface.emissive *= masu_met_share(rel, point, g.normal, eye, g.roughness);
    }
#endif
    return radiance(m, rel, direction);
}

vec4 light_of(uvec2 texel, masu_guide g)
{
    uvec4 hit = texelFetch(hit_image, ivec2(texel), 0);
    vec3 point = masu_specular_point(texel, g);
    vec3 direction = masu_unpack_direction(texelFetch(ray_image, ivec2(texel), 0).r);
    float t = masu_met_at(hit);
    float air = foggy ? masu_air_depth_from(point, direction, t) : 0.0;
    vec4 light;
    if (t >= 0.0) {
        light = vec4(hit_light(hit, g, point, direction, t), t);
        light.rgb = masu_seen_along(light.rgb, false, vec4(0.0, 0.0, 0.0, 1.0), direction, foggy,
                                    air);
    } else {
        light = vec4(vec3(0.0), frame.trace_anchor.w);
        light.rgb = masu_seen_along(light.rgb, true, vec4(0.0, 0.0, 0.0, 1.0), direction, foggy,
                                    air);
    }
    if (push.accumulate != 0u) {
        light.rgb *= masu_unpack_shared(texelFetch(ray_image, ivec2(texel), 0).g);
    }
    return light;
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        vec4 light = g.there ? light_of(texel, g) : vec4(0.0);
        MASU_STORE_HALF(light_image, texel, light);
    }
    masu_count_end();
}
