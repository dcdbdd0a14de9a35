/*
 * maps.glsl: the textures of a material, for gbuffer.frag and cascade.frag. The flags are the same
 * for all of a draw, so every branch here is uniform and implicit derivatives are defined.
 *
 * Tangents are not stored: the directions in which u and v grow follow from the derivatives of
 * position and texture coordinate (Schueler, "Followup: Normal Mapping Without Precomputed
 * Tangents", 2013). That saves 8 bytes a vertex, needs no splitting of vertices where a mapping
 * mirrors, and is as precise everywhere: positions are relative to the camera, so that the step
 * from pixel to pixel is some 1e-3 of them or more, whatever the distance. Within one triangle the
 * frame follows the interpolated normal but not an interpolated tangent: on coarse meshes the
 * relief has facets that MikkTSpace's would not have.
 */
#ifndef MASU_MAPS_GLSL
#define MASU_MAPS_GLSL

#include "shared/materials.h"
#include "shared/facing.glsl"

/* Flags of the material, layers of its maps, how much more often than its colour the others repeat:
 * the push constants', or whoever includes this says; and so the bias of mip levels. */
#ifndef MASU_MAPS_FLAGS
#define MASU_MAPS_FLAGS push.flags
#define MASU_MAPS_LAYERS push.layers
#define MASU_MAPS_DETAIL vec2(push.detail_u, push.detail_v)
#endif

#ifndef MASU_MAPS_BIAS
#define MASU_MAPS_BIAS push.mip_bias
#endif

#ifndef MASU_MAPS_TINTS
layout(constant_id = 0) const bool masked = false;
#endif

layout(set = MASU_SET_TEXTURES, binding = 0) uniform sampler2DArray base_map;
layout(set = MASU_SET_TEXTURES, binding = 1) uniform sampler2DArray normal_map;
layout(set = MASU_SET_TEXTURES, binding = 2) uniform sampler2DArray surface_map;
layout(set = MASU_SET_TEXTURES, binding = 3) uniform sampler2DArray emissive_map;
layout(set = MASU_SET_TEXTURES, binding = 4) uniform sampler2DArray occlusion_map;
#ifdef MASU_MAPS_COAT_LAYER
layout(set = MASU_SET_TEXTURES, binding = 5) uniform sampler2DArray coat_map;
#endif

#ifdef MASU_MAPS_LIVE
/* Live textures (desc.reserve.textures), which materials may show. */
layout(set = MASU_SET_TEXTURES, binding = 6) uniform sampler2DArray live_map;
#include "shared/live_textures.glsl"
#endif

/* Where a map is read: of MASU_MAPS_SECOND, where whoever includes this has it, a bit for each
 * slot. */
vec2 masu_map_at(uint slot, vec2 at)
{
#ifdef MASU_MAPS_SECOND
    return (MASU_MAPS_SECOND >> slot & 1u) != 0u ? MASU_MAPS_SECOND_AT : at;
#else
    return at;
#endif
}

float masu_layer(uint slot)
{
    return float(MASU_MAPS_LAYERS >> 8 * slot & 0xFFu);
}

/* A little less: what is exactly as much as it is there, however a GPU divides by 255. */
float masu_cutoff()
{
    return float(MASU_MAPS_FLAGS >> MASU_MAP_CUTOFF_SHIFT & 0xFFu) * (0.999999 / 255.0);
}

/* Base colour and alpha; white where there is no map. */
vec4 masu_base(vec2 at)
{
    if ((MASU_MAPS_FLAGS & MASU_MAP_BASE) == 0u) {
        return vec4(1.0);
    }
    return texture(base_map, vec3(masu_map_at(0u, at), masu_layer(0u)), MASU_MAPS_BIAS);
}

/* Multiplies the factors of `s`; returns alpha. live: the number of a live texture in place of the
 * maps of base colour and emission, 0: none. */
float masu_sample_maps(vec2 at, float live, inout masu_surface s)
{
    float bias = MASU_MAPS_BIAS;
    vec4 base;
#ifdef MASU_MAPS_LIVE
    bool is_live = masu_live_maps && live > 0.0;
    if (is_live) {
        vec2 p = masu_map_at(0u, at);
        base = masu_live_mean(live_map, live - 1.0, vec4(0.0, 0.0, 1.0, 1.0), p, dFdx(p), dFdy(p),
                              MASU_LIVE_WRAP);
        s.emissive *= base.rgb;
    } else {
        base = masu_base(at);
    }
#else
    const bool is_live = false;
    base = masu_base(at);
#endif
    s.albedo *= base.rgb;
    if ((MASU_MAPS_FLAGS & MASU_MAP_SURFACE) != 0u) {
        vec2 surface = texture(surface_map,
                               vec3(masu_map_at(2u, at) * MASU_MAPS_DETAIL, masu_layer(2u)), bias)
                           .rg;
        s.roughness *= surface.r;
        if ((MASU_MAPS_FLAGS & MASU_MAP_METAL) != 0u) {
            s.metallic *= surface.g;
        }
    }
    if (!is_live && (MASU_MAPS_FLAGS & MASU_MAP_EMISSIVE) != 0u) {
        s.emissive *= texture(emissive_map, vec3(masu_map_at(3u, at), masu_layer(3u)), bias).rgb;
    }
    if ((MASU_MAPS_FLAGS & MASU_MAP_OCCLUSION) != 0u) {
        float layer = float(MASU_MAPS_FLAGS >> MASU_MAP_OCCLUSION_SHIFT);
        s.occlusion *=
            texture(occlusion_map, vec3(masu_map_at(4u, at) * MASU_MAPS_DETAIL, layer), bias).r;
    }
#ifdef MASU_MAPS_COAT_LAYER
    if (masu_own_coats && (MASU_MAPS_FLAGS & MASU_MAP_COAT) != 0u) {
        vec2 coat =
            texture(coat_map,
                    vec3(masu_map_at(5u, at) * MASU_MAPS_DETAIL, float(MASU_MAPS_COAT_LAYER)), bias)
                .rg;
        s.coat *= coat.r;
        s.coat_roughness *= coat.g;
    }
    if (masu_extra_lobes != 0u && (MASU_MAPS_FLAGS & MASU_MAP_LOBE) != 0u) {
        masu_scale_lobe(
            s, texture(coat_map,
                       vec3(masu_map_at(5u, at) * MASU_MAPS_DETAIL, float(MASU_MAPS_COAT_LAYER)),
                       bias));
    }
#endif
    return base.a;
}

/* A relief is seen where it faces the viewer. Normals that point away, which near a silhouette some
 * of any map do, would shine there as if seen edge-on; they are turned until they are all but
 * edge-on. Not renormalised. */
vec3 masu_seen_normal(vec3 normal, vec3 rel, vec3 fallback)
{
    float least = (MASU_MAPS_FLAGS & MASU_MAP_NORMAL) == 0u ? 0.0 : 0.1;
    return masu_lean_to_eye(masu_normalize(normal, fallback), rel, least);
}

/* A direction of tangent space, z above 0, in world space, on the side of `normal`; at: the
 * coordinates. */
vec3 masu_from_tangents(vec2 xy, vec3 normal, vec3 rel, vec2 at)
{
    float z = sqrt(max(1.0 - dot(xy, xy), 0.0));
    vec3 dx = dFdx(rel);
    vec3 dy = dFdy(rel);
    vec2 du = vec2(dFdx(at.x), dFdy(at.x));
    vec2 dv = vec2(dFdx(at.y), dFdy(at.y));
    vec3 n = masu_normalize(normal, vec3(0.0, 1.0, 0.0));
    /* The gradients of u and v on the surface, times the area of the pixel's footprint, whose sign
     * says on which side of the surface the normal is. Each is made a unit vector, as bakers of
     * normal maps have it, however the mapping stretches. v grows down the image, +y of the map is
     * up. */
    vec3 right = cross(dy, n);
    vec3 down = cross(n, dx);
    float side = dot(right, dx) < 0.0 ? -1.0 : 1.0;
    vec3 t = (right * du.x + down * du.y) * side;
    vec3 b = (right * dv.x + down * dv.y) * -side;
    /* Of a mapping without extent along u or v that direction is zero, and its lean is left out. */
    return t * (masu_rsqrt(dot(t, t)) * xy.x) + b * (masu_rsqrt(dot(b, b)) * xy.y) + n * z;
}

/* 128 / 255 is zero: an even number of steps has no middle. */
vec2 masu_lean_of_texel(vec2 xy)
{
    return clamp((xy * 255.0 - 128.0) / 127.0, -1.0, 1.0);
}

/* The normal of the map in world space, unnormalised, on the side of `normal`. */
vec3 masu_bend_normal(vec3 normal, vec3 rel, vec2 at)
{
    if ((MASU_MAPS_FLAGS & MASU_MAP_NORMAL) == 0u) {
        return normal;
    }
    at = masu_map_at(1u, at);
    vec2 xy = texture(normal_map, vec3(at * MASU_MAPS_DETAIL, masu_layer(1u)), MASU_MAPS_BIAS).rg;
    return masu_from_tangents(masu_lean_of_texel(xy), normal, rel, at);
}

#ifdef MASU_MAPS_COAT_LAYER
/* ... of the coat's own map, which is in the place of that of emission. */
vec3 masu_bend_coat(vec3 normal, vec3 rel, vec2 at)
{
    at = masu_map_at(3u, at);
    vec2 xy = texture(emissive_map, vec3(at * MASU_MAPS_DETAIL, masu_layer(3u)), MASU_MAPS_BIAS).rg;
    return masu_from_tangents(masu_lean_of_texel(xy), normal, rel, at);
}
#endif

#endif
