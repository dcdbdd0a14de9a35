/*
 * specular_shade.comp: the light that comes along the ray of each traced texel: from what it has met, lit as
 * the picture is (light/shade.glsl; the sun past the shadow map, punctual lights, light from everywhere), else the sky.
 * A surface that is seen in another mirrors the sky or the probes itself.
 *
 * The sun's disc is not in it, nor its light in the sky around what mirrors: light.comp adds the sun's
 * highlight exactly.
 *
 * push.accumulate: 1: the reference: light is multiplied by what the ray is worth.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_SURFACE /* any of what is met may have a coat */
#include "push/specular_shade.h"
#include "shared/lights.h"
#include "shared/trace.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/shade.glsl"
#include "light/air.glsl"
#ifndef MASU_NO_POLYGONS /* rays meet nothing but the SDF */
#define MASU_TRACE_POLYGONS
#include "trace/scene.glsl"
#include "trace/texels.glsl"
#endif
#include "specular/filter.glsl"
#include "specular/origin.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"

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

/* What a ray has met. */
struct met {
    masu_surface surface;
    vec3 normal; /* unit, towards where the ray comes from */
};

met met_sdf(uvec4 hit)
{
    met m;
    m.surface = masu_unpack_met(unpackUnorm4x8(hit.w), hit.z);
    m.normal = masu_unpack_normal(hit.z);
    return m;
}

#ifdef MASU_TRACE_POLYGONS
met met_polygon(uvec4 hit, vec3 direction, float width)
{
    met m;
    vec2 b = unpackUnorm2x16(hit.w);
    vec3 weights = vec3(1.0 - b.x - b.y, b);
    uvec4 triangle = masu_trace_triangle(hit.z);
    hit.y = masu_trace_instance(hit.y);
    vec3 p0 = uintBitsToFloat(masu_trace_vertices[triangle.x].xyz);
    vec3 p1 = uintBitsToFloat(masu_trace_vertices[triangle.y].xyz);
    vec3 p2 = uintBitsToFloat(masu_trace_vertices[triangle.z].xyz);
    vec3 normal = masu_trace_vertex_normal(triangle.x) * weights.x +
                  masu_trace_vertex_normal(triangle.y) * weights.y +
                  masu_trace_vertex_normal(triangle.z) * weights.z;
    vec3 flat_normal = masu_normalize(masu_trace_upright(hit.y, cross(p1 - p0, p2 - p0)), -direction);
    m.normal = masu_normalize(masu_trace_upright(hit.y, normal), flat_normal);
    m.normal = dot(flat_normal, direction) > 0.0 ? -m.normal : m.normal;
    /* As the raster's: a normal that points away is turned until it does not. */
    float away = dot(m.normal, direction);
    if (away > 0.0) {
        m.normal = masu_normalize(m.normal - away * direction, -direction);
    }

    masu_trace_material look = masu_trace_material_at(triangle.w & MASU_TRACE_MATERIAL);
    m.surface = masu_plain_surface(look.base_color.rgb, look.base_color.w);
    m.surface.emissive = look.emissive.rgb;
    m.surface.metallic = look.emissive.w;
    m.surface.specular = look.more.x;
    m.surface.coat = look.more.y;
    m.surface.coat_roughness = look.more.z;
#ifdef MASU_TRACE_TEXTURES
    if (look.maps.x != MASU_TRACE_NONE || look.maps.y != MASU_TRACE_NONE) {
        vec2 uv = masu_trace_uv(triangle.xyz, b);
        vec2 u1 = masu_trace_texcoords[triangle.y] - masu_trace_texcoords[triangle.x];
        vec2 u2 = masu_trace_texcoords[triangle.z] - masu_trace_texcoords[triangle.x];
        vec3 w1 = masu_trace_now(hit.y, vec4(p1 - p0, 0.0));
        vec3 w2 = masu_trace_now(hit.y, vec4(p2 - p0, 0.0));
        float across = length(cross(w1, w2)), wide = abs(u1.x * u2.y - u1.y * u2.x);
        float density = masu_sqrt(wide * masu_rcp(across)); /* of texture coordinates per metre */
        float lod = masu_log2(max(width, 1e-9) * density /
                              max(masu_sqrt(abs(dot(flat_normal, direction))), 0.1));
        /* In a loop: the code for a look would stand here twice. */
        [[dont_unroll]] for (int i = 0; i < 2; i++) {
            uint map = i == 0 ? look.maps.x : look.maps.y;
            if (map != MASU_TRACE_NONE) {
                vec3 texel = masu_trace_sized(map, uv, lod, look.maps.w).rgb;
                m.surface.albedo *= i == 0 ? texel : vec3(1.0);
                m.surface.emissive *= i == 0 ? vec3(1.0) : texel;
            }
        }
    }
#endif
    return m;
}
#endif

/* Radiance of what is met at a point relative to the eye. */
vec3 radiance(met m, vec3 rel, vec3 direction)
{
    if (masu_is_unlit(m.surface)) {
        return m.surface.emissive;
    }
    masu_mirrored sky = masu_mirrored_sky(m.surface, m.normal, -direction, vec2(1.0));
    vec2 seen = vec2(1.0);
#ifdef MASU_SUN_MAP
    if (dot(m.normal, frame.sun_direction.xyz) > 0.0) {
        seen.x = masu_sun_seen(rel, m.normal, dot(rel, frame.forward.xyz));
    }
#endif
    masu_bsdf b = masu_bsdf_make(m.surface, m.normal, -direction);
    masu_lit lit = masu_shade(m.surface, b, rel, seen, sky);
#ifdef MASU_LIGHTS
    uint lights = masu_light_count();
    for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX); i++) {
        if (i >= lights) {
            break;
        }
        masu_add_local_light(lit, m.surface, b, i, rel, m.normal);
    }
#endif
    return lit.diffuse + lit.specular + m.surface.emissive;
}

vec4 light_of(uvec2 texel, masu_guide g)
{
    uvec4 hit = texelFetch(hit_image, ivec2(texel), 0);
    uvec2 ray = texelFetch(ray_image, ivec2(texel), 0).rg;
    vec3 point = masu_specular_point(texel, g);
    vec3 direction = masu_unpack_direction(ray.x);
    float t = masu_met_at(hit);
    vec3 light = vec3(0.0);
    float air = foggy ? masu_air_depth_from(point, direction, t) : 0.0;
    if (t >= 0.0) {
        vec3 rel = masu_specular_origin(point, g) - frame.trace_eye.xyz + direction * t;
        met m;
#ifdef MASU_TRACE_POLYGONS
        if ((hit.y & MASU_HIT_SDF) == 0u) {
            /* As wide as the lobe has become: half of it lies within its roughness squared. */
            float width = masu_specular_width(g) + t * (g.roughness * g.roughness + frame.up.w * 2.0 / float(pc.render_height));
            m = met_polygon(hit, direction, width);
        } else
#endif
        {
            m = met_sdf(hit);
        }
        light = radiance(m, rel, direction);
    }
    light = masu_seen_along(light, !(t >= 0.0), direction, foggy, air);
    if (push.accumulate != 0u) {
        light *= masu_unpack_shared(ray.y);
    }
    return vec4(light, t >= 0.0 ? t : frame.trace_anchor.w);
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
