/*
 * specular_shade.comp: the light that comes along the ray of each traced texel: from what it has met, lit as
 * the picture is (light/shade.glsl; the sun past the shadow map, punctual lights, light from everywhere), else the sky.
 * A surface that is seen in another mirrors the sky or the probes itself.
 *
 * The sun's disc is not in it, nor its light in the sky around what mirrors: light.comp adds the sun's
 * highlight exactly.
 *
 * And where in the previous frame the same thing was seen in the same mirror, for specular_temporal: a mirror
 * shows a virtual point as far behind its surface as what is mirrored lies before it. That moves as the
 * mirror image of the thing, and with the mirror.
 *
 * push.accumulate: 1: the reference: light is multiplied by what the ray is worth.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_SURFACE /* any of what is met may have a coat */
#define MASU_PUSH masu_push_specular_shade
#define MASU_SKY_LOOP [[dont_unroll]]
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"
#include "light/shade.glsl"
#include "light/air.glsl"
#ifdef MASU_LIGHTS
#include "light/lights.glsl"
#endif
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
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D velocity_image;
#ifdef MASU_SUN_MAP
#define MASU_AT_SUN_MAP 4
#include "light/sun_map.glsl"
#define MASU_AT_LIGHT 5
#else
#define MASU_AT_LIGHT 4
#endif
layout(set = MASU_SET_PASS, binding = MASU_AT_LIGHT, rgba16f) uniform writeonly image2D light_image;
layout(set = MASU_SET_PASS, binding = MASU_AT_LIGHT + 1, r32ui) uniform writeonly uimage2D motion_image;

/* What a ray has met. */
struct met {
    masu_surface surface;
    vec3 normal; /* unit, towards where the ray comes from */
};

met met_sdf(uvec4 hit)
{
    met m;
    vec4 look = unpackUnorm4x8(hit.w);
    m.surface = masu_plain_surface(look.rgb * look.rgb, look.a);
    m.surface.metallic = masu_unpack_metallic(hit.z);
    if ((masu_unpack_flags(hit.z) & MASU_SURFACE_EMISSIVE) != 0u) {
        m.surface.emissive = look.rgb * look.rgb * masu_emissive_range;
    }
    m.normal = masu_unpack_normal(hit.z);
    return m;
}

#ifdef MASU_TRACE_POLYGONS
met met_polygon(uvec4 hit, vec3 direction, float width)
{
    met m;
    vec2 b = unpackUnorm2x16(hit.w);
    vec3 weights = vec3(1.0 - b.x - b.y, b);
    uvec4 triangle = masu_trace_static[masu_trace_static[0].x + hit.z];
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

    masu_trace_material look = masu_trace_material_at(triangle.w & ~MASU_TRACE_HOLES);
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
                /* As shared/maps.glsl: a trace of light from a neighbouring texel puts out no surface. */
                bool glows = max(texel.r, max(texel.g, texel.b)) >= 0.2;
                m.surface.albedo *= i == 0 ? texel : vec3(1.0);
                m.surface.emissive *= i == 0 ? vec3(1.0) : glows ? texel : vec3(0.0);
            }
        }
    }
#endif
    return m;
}
#endif

/* Where what was met was in the previous frame, minus where it is. */
vec3 met_before(uvec4 hit)
{
#ifdef MASU_TRACE_POLYGONS
    if ((hit.y & MASU_HIT_SDF) == 0u) {
        vec2 b = unpackUnorm2x16(hit.w);
        uvec3 triangle = masu_trace_static[masu_trace_static[0].x + hit.z].xyz;
        vec3 object = uintBitsToFloat(masu_trace_vertices[triangle.x].xyz) * (1.0 - b.x - b.y) +
                      uintBitsToFloat(masu_trace_vertices[triangle.y].xyz) * b.x +
                      uintBitsToFloat(masu_trace_vertices[triangle.z].xyz) * b.y;
        return masu_trace_before(hit.y, vec4(object, 1.0)) - masu_trace_now(hit.y, vec4(object, 1.0));
    }
#endif
    return masu_unpack_sdf_motion(hit.y);
}

/* Radiance of what is met at a point relative to the eye. */
vec3 radiance(met m, vec3 rel, vec3 direction)
{
    if (masu_is_emissive(m.surface)) {
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
        vec3 l;
        vec3 color;
        if (masu_light_reaches(masu_lights[i], rel, l, color)) {
            masu_add_light(lit, m.surface, b, l, color);
        }
    }
#endif
    return lit.diffuse + lit.specular;
}

/* By how many pixels a point behind the mirror has moved: `off` further along the line of sight, `thing`
 * minus where it is in the previous frame. */
vec4 image_moved(vec3 point, vec3 along, float off, vec3 thing, vec3 eyes, vec2 size)
{
    vec3 behind = point + along * off;
    return masu_velocity(vec4(behind, 1.0), vec4(behind + thing - eyes, 1.0), size);
}

/* Pixels by which what is seen in the mirror has moved; all bits: there is no telling.
 *
 * A convex mirror shows it nearer to its surface and smaller: 1/image = 1/far + 2/r for the plane that holds
 * view and normal with r cos instead of r, for the one across it r / cos (Coddington's equations). The
 * image moves less by as much, and the rest of its way with the surface. */
uint motion(uvec2 texel, masu_guide g, vec3 point, float far, vec3 before)
{
    uvec2 at = masu_guide_place(texel, g.pixel, push.traced_size);
    vec2 size = vec2(pc.render_width, pc.render_height);
    vec4 moved = texelFetch(velocity_image, ivec2(at), 0);
    if (!(moved.w > 0.0)) {
        return masu_unmoved;
    }
    /* Where the surface was, seen from the eye of then and of now. */
    vec3 eyes = (previous.eye_hi.xyz - frame.eye_hi.xyz) + (previous.eye_lo.xyz - frame.eye_lo.xyz);
    float z = frame.forward.w * masu_rcp(g.depth) * (1.0 + moved.z);
    vec2 ndc = (vec2(at) + 0.5 + moved.xy) / size * 2.0 - 1.0 + previous.jitter.xy;
    vec3 was = (previous.forward.xyz + previous.right.xyz * ndc.x - previous.up.xyz * ndc.y) * z;
    vec3 shift = was + eyes - point;
    vec3 along = masu_normalize(point, frame.forward.xyz);
    vec3 thing = before - 2.0 * g.normal * dot(before - shift, g.normal);
    float curvature = masu_guide_curvature(guide_image, ivec2(texel), g, point);
    float cosine = clamp(-dot(along, g.normal), 0.1, 1.0);
    float image = masu_image_far(far, curvature / cosine);
    vec4 velocity = image_moved(point, along, image, mix(shift, thing, image / max(far, 1e-9)), eyes, size);
    if (!(velocity.w > 0.0)) {
        return masu_unmoved;
    }
    vec3 aside = g.normal + along * cosine;
    vec2 lean = vec2(dot(aside, frame.right.xyz) / frame.right.w, -dot(aside, frame.up.xyz) / frame.up.w);
    float steep = dot(lean, lean);
    if (curvature > 0.0 && steep > 1e-6) {
        image = masu_image_far(far, curvature * cosine);
        vec4 across = image_moved(point, along, image, mix(shift, thing, image / max(far, 1e-9)), eyes, size);
        if (!(across.w > 0.0)) {
            return masu_unmoved;
        }
        velocity.xy = across.xy + lean * (dot(lean, velocity.xy - across.xy) / steep);
    }
    return packHalf2x16(clamp(velocity.xy, vec2(-60000.0), vec2(60000.0)));
}

/* How far the ray went; negative: it met nothing. */
float met_at(uvec4 hit)
{
    return masu_sane(uintBitsToFloat(hit.x), -1.0, frame.trace_anchor.w);
}

vec4 light_of(uvec2 texel, masu_guide g)
{
    uvec4 hit = texelFetch(hit_image, ivec2(texel), 0);
    uvec2 ray = texelFetch(ray_image, ivec2(texel), 0).rg;
    vec3 point = masu_specular_point(texel, g);
    vec3 direction = masu_unpack_direction(ray.x);
    float t = met_at(hit);
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

uint motion_of(uvec2 texel, masu_guide g)
{
    uvec4 hit = texelFetch(hit_image, ivec2(texel), 0);
    float t = met_at(hit);
    bool there = t >= 0.0;
    return motion(texel, g, masu_specular_point(texel, g), there ? t : frame.trace_anchor.w,
                  there ? met_before(hit) : vec3(0.0));
}

/* Motion and light one after the other, and in a loop, so that each reads anew what it needs: what one keeps for the
 * other would be 40 registers, and half of the waves. */
void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        [[dont_unroll]] for (int turn = 0; turn < 2; turn++) {
            masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
            if (turn == 0) {
                uint moved = g.there && push.accumulate == 0u ? motion_of(texel, g) : masu_unmoved;
                MASU_STORE_UINT(motion_image, texel, uvec4(moved));
            } else {
                vec4 light = g.there ? light_of(texel, g) : vec4(0.0);
                MASU_STORE_HALF(light_image, texel, light);
            }
        }
    }
    masu_count_end();
}
