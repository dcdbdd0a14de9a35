/*
 * light.comp: deferred lighting of polygon and SDF hits: sun, ambient light, and the sky where
 * depth is 0. Variants: MASU_OCCLUSION (light_occluded) scales sun and ambient light by the
 * occlusion image, MASU_PROBES takes ambient light from light probes, MASU_LIGHTS adds local
 * lights, MASU_LOCAL_SHADOWS their shadows, and MASU_SURFACE materials with more than albedo,
 * roughness and metallic.
 *
 * Materials are in light/shade.glsl. Absorption and in-scattering of the air (light/air.glsl) apply
 * only in scenes with fog. The part of the specular reflection that is traced is not added here.
 *
 * push.light_tiles: not 0 if there are tile lists of lights. push.cutoff: roughness from which
 * reflections are not traced. push.accumulate: not 0 with debug.reference.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/light.h"
#include "shared/counters.h"
#include "shared/lights.h"
#include "shared/materials.h"
#include "shared/sdf_limits.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/shade.glsl"
#include "light/air.glsl"
#include "specular/guide.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(constant_id = 2) const bool foggy = false; /* the scene has fog */
layout(constant_id = 4) const bool reflections = false; /* some traced: cutoff, accumulate */

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D albedo_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D depth_image;
/* The optional images of a variant follow those three. */
#ifdef MASU_OCCLUSION
#define MASU_AT_SURFACE 4
layout(set = MASU_SET_PASS, binding = 3) uniform usampler2D occlusion_image;
#else
#define MASU_AT_SURFACE 3
#endif
#ifdef MASU_SURFACE
#define MASU_AT_LOCAL_SHADOWS (MASU_AT_SURFACE + 1)
layout(set = MASU_SET_PASS, binding = MASU_AT_SURFACE) uniform sampler2D surface_image;
#else
#define MASU_AT_LOCAL_SHADOWS MASU_AT_SURFACE
#endif
#ifdef MASU_LOCAL_SHADOWS
#define MASU_AT_HDR (MASU_AT_LOCAL_SHADOWS + 1)
#else
#define MASU_AT_HDR MASU_AT_LOCAL_SHADOWS
#endif
#ifdef MASU_LIGHTS
#include "light/lights.glsl"
#endif
layout(set = MASU_SET_PASS, binding = MASU_AT_HDR, rgba16f) uniform image2D hdr_image;

/* Visibility of the sun (x) and of the ambient light (y). */
vec2 arriving(uvec2 at)
{
#ifdef MASU_OCCLUSION
    return unpackUnorm2x16(texelFetch(occlusion_image, ivec2(at), 0).r);
#else
    return vec2(1.0);
#endif
}

#ifdef MASU_LOCAL_SHADOWS
/* loaded after the ambient light, which leaves no registers for it */
const bool emission_late = true;
#else
const bool emission_late = false;
#endif

vec3 load_emission(ivec2 at, uint normal)
{
    /* elsewhere hdr is undefined */
    return masu_has_emission(normal) ? imageLoad(hdr_image, at).rgb : vec3(0.0);
}

/* The surface that the G-buffer stores at a pixel. */
masu_surface surface_at(ivec2 at, vec4 albedo, uint normal)
{
    masu_surface s = masu_unpack_look(albedo, normal);
    if (!masu_emission_packed && !emission_late) {
        s.emissive = load_emission(at, normal);
    }
#ifdef MASU_SURFACE
    if ((masu_unpack_flags(normal) & MASU_SURFACE_MORE) != 0u) {
        masu_unpack_surface(texelFetch(surface_image, at, 0), s);
    }
#endif
    return s;
}

vec3 emission(ivec2 at, masu_surface s, uint normal)
{
    return !masu_emission_packed && emission_late ? load_emission(at, normal) : s.emissive;
}

#ifdef MASU_LOCAL_SHADOWS
layout(constant_id = 16) const bool reliefs = false; /* normals may be from normal maps */

/* The smaller depth difference to the two neighbours: it does not cross an edge. */
float depth_step(ivec2 before, ivec2 after, float depth)
{
    float low = depth - texelFetch(depth_image, before, 0).r;
    float high = texelFetch(depth_image, after, 0).r - depth;
    return abs(low) < abs(high) ? low : high;
}

/* The geometric normal, from depth, which is affine across a plane: the G-buffer's may be from a
 * normal map. Depth of SDF surfaces is less smooth: if the two normals differ strongly, the
 * G-buffer's is used. */
vec3 flat_normal(ivec2 at, ivec2 size, float depth, vec3 n)
{
    float x = depth_step(ivec2(max(at.x - 1, 0), at.y), ivec2(min(at.x + 1, size.x - 1), at.y),
                         depth);
    float y = depth_step(ivec2(at.x, max(at.y - 1, 0)), ivec2(at.x, min(at.y + 1, size.y - 1)),
                         depth);
    vec2 tangent = vec2(frame.right.w, frame.up.w);
    vec2 slope = vec2(x, -y) * vec2(size) * 0.5 / tangent;
    vec2 ray = masu_ndc(vec2(at) + 0.5, vec2(size)) * vec2(1.0, -1.0) * tangent;
    vec3 view = vec3(slope, depth - dot(slope, ray));
    vec3 normal = -(frame.right.xyz * (view.x / tangent.x) + frame.up.xyz * (view.y / tangent.y) +
                    frame.forward.xyz * view.z);
    normal = masu_normalize(normal, n);
    return dot(normal, n) > 0.7 ? normal : n;
}
#endif

#ifdef MASU_LIGHTS
/* Adds the local lights. rel: the point relative to the camera. n: the geometric normal. */
void add_lights(inout vec3 color, masu_surface s, masu_bsdf b, uvec2 at, vec3 rel, vec3 n,
                vec3 traced)
{
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    /* From the workgroup's number: light loads are then uniform, not into registers of each
     * lane. */
    uvec2 tile = gl_WorkGroupID.xy / uint(MASU_TILE / MASU_GROUP);
    masu_asked asked = masu_lights_asked(tile, size, push.light_tiles != 0u);
    masu_light_sum sum = masu_light_sum(color);
    uint reached = 0u;
    for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX); i++) {
        if (i >= asked.count) {
            break;
        }
        reached += masu_add_local_light(sum, s, b, masu_light_asked(asked, i), rel, n, traced) ? 1u
                                                                                               : 0u;
    }
    color = sum.light;
    masu_count(MASU_COUNTER_LIGHT_TESTS, asked.count);
    masu_count(MASU_COUNTER_LIGHT_SHADED, reached);
}
#endif

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    if (all(lessThan(at, uvec2(pc.output_width, pc.output_height)))) {
        vec3 ray = masu_pixel_ray(at, uvec2(pc.output_width, pc.output_height));
        vec3 direction = masu_normalize(ray, frame.forward.xyz);
        float depth = texelFetch(depth_image, ivec2(at), 0).r;
        vec3 color;
        if (!(depth > 0.0)) {
            float air = foggy ? masu_air_depth_sky(direction) : 0.0;
            color = masu_seen_along(masu_sun_disc(direction), true, frame.background, direction,
                                    foggy, air);
        } else {
            vec4 albedo = texelFetch(albedo_image, ivec2(at), 0);
            uint normal = texelFetch(normal_image, ivec2(at), 0).r;
            masu_surface s = surface_at(ivec2(at), albedo, normal);
            if (masu_is_unlit_texel(normal)) {
                color = emission(ivec2(at), s, normal);
            } else {
                vec3 rel = ray * (frame.forward.w * masu_rcp(depth));
                vec2 kept = vec2(1.0);
                if (reflections) {
                    kept = masu_kept_mirrors(s, push.cutoff, push.accumulate != 0u);
                }
                vec3 n = masu_unpack_normal(normal);
#ifdef MASU_LIGHTS
                masu_around around = masu_ambient_first(s, rel, masu_base_normal(s, n));
#else
                masu_around around = masu_ambient_at(rel, masu_base_normal(s, n));
#endif
                masu_mirrored sky = masu_mirrored_sky(s, n, -direction, kept);
                masu_bsdf b = masu_bsdf_make(s, n, -direction);
                masu_lit lit = masu_shade(s, b, around, arriving(at), sky);
                color = lit.diffuse + lit.specular + emission(ivec2(at), s, normal);
#ifdef MASU_LIGHTS
#ifdef MASU_LOCAL_SHADOWS
                if (reliefs) {
                    n = flat_normal(ivec2(at), ivec2(pc.output_width, pc.output_height), depth, n);
                }
#endif
                vec3 traced = vec3(1.0 - kept, push.accumulate != 0u ? 1.0 : 0.0);
                add_lights(color, s, b, at, ray * masu_light_depth(depth), n, traced);
#endif
            }
            float air = 0.0;
            if (foggy) {
                float far = frame.forward.w * masu_rcp(depth) * length(ray);
                air = masu_air_depth(direction, far);
            }
            color = masu_seen_along(color, false, frame.background, direction, foggy, air);
        }
        MASU_STORE_HALF(hdr_image, at, vec4(color, 1.0));
    }
    masu_count_end();
}
