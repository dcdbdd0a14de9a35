/*
 * gbuffer.frag: writes the material of a polygon to the G-buffer. push.material is the draw's
 * material. MASU_MOTION (gbuffer_velocity) adds its velocity, MASU_SURFACE the surface image.
 * MASU_TEXTURES samples the material's maps:
 * push.flags: their flags. push.layers: their layers, 8 bits each. push.coat_layer: the layer of
 * the coat's map; with MASU_ATTRIBUTES bits 8 and up select the maps with the second texture
 * coordinates.
 * push.mip_bias: bias of mip levels. push.mip_moving: added for moving surfaces, at least 0.
 * push.nearer: factor on depth of a depth bias. push.detail_*: scale of texture coordinates of all
 * maps except base colour and emissive.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/gbuffer.h"
#include "shared/materials.h"
#include "shared/facing.glsl"
#include "shared/pack.glsl"
#include "shared/look.glsl"

#ifdef MASU_SURFACE
layout(location = 2) out vec4 out_surface;
#define MASU_VELOCITY_LOCATION 3
#else
#define MASU_VELOCITY_LOCATION 2
#endif
#ifdef MASU_MOTION
#define MASU_HDR_LOCATION (MASU_VELOCITY_LOCATION + 1)
#else
#define MASU_HDR_LOCATION MASU_VELOCITY_LOCATION
#endif

#ifdef MASU_MOTION
#include "shared/globals.glsl"
#include "shared/motion.glsl"
layout(location = 2) in vec3 in_before;
layout(location = MASU_VELOCITY_LOCATION) out vec4 out_velocity;
#else
#include "shared/push.glsl"
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MATERIALS, std430) readonly buffer Materials
{
    masu_material_data materials[];
};

#ifdef MASU_TEXTURES
#ifdef MASU_ATTRIBUTES
layout(location = 4) in vec2 in_second;
layout(location = 5) in vec4 in_color;
#define MASU_MAPS_SECOND (push.coat_layer >> 8)
#define MASU_MAPS_SECOND_AT in_second
#endif
#ifdef MASU_SURFACE
#ifdef MASU_ATTRIBUTES
#define MASU_MAPS_COAT_LAYER (push.coat_layer & 0xFFu)
#else
#define MASU_MAPS_COAT_LAYER push.coat_layer
#endif
#endif
#ifdef MASU_MOTION
float mip_bias;
#define MASU_MAPS_BIAS mip_bias
const float share_per_pixel = 0.12; /* of push.mip_moving */
const float most_shares = 2.3;
#endif
#define MASU_MAPS_LIVE
layout(constant_id = 23) const bool masu_live_maps = false;
#include "shared/maps.glsl"
layout(location = 3) in vec2 in_texcoord;
#endif

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec3 in_rel;

layout(location = 0) out vec4 out_albedo;
layout(location = 1) out uint out_normal;
#ifndef MASU_NO_EMISSION /* attached only for emitting materials, ignored otherwise */
layout(location = MASU_HDR_LOCATION) out vec4 out_hdr;
#endif

#ifdef MASU_SURFACE
#include "brdf/meso.glsl"
/* Applies the curves of the material's mesoscale relief. They are stored behind the materials. */
vec3 show_relief(vec3 normal, vec3 n, inout masu_surface s)
{
    uint at = push.meso;
    masu_material_data low = materials[at];
    masu_material_data high = materials[at + 1u];
    masu_meso_curves curves = masu_meso_curves(low.base_color, low.emissive, low.more,
                                               high.base_color, high.emissive, high.more);
    vec3 view = masu_normalize(-in_rel, n);
    masu_meso_surface m =
        masu_meso_surface(normal, s.albedo, s.roughness, s.occlusion, 1.0, 1.0);
    masu_meso_bend(curves, view, abs(dot(view, n)), m);
    s.albedo = m.color;
    s.roughness = m.roughness;
    s.occlusion = m.occlusion;
    s.specular *= m.specular;
    s.edge = m.specular;
    s.shadow = m.shadow;
    return m.normal;
}
#endif

void main()
{
    masu_material_data m = materials[push.material];
    masu_surface s = masu_plain_surface(m.base_color.rgb, m.base_color.w);
    s.emissive = m.emissive.rgb;
    s.metallic = m.emissive.w;
    masu_take_specular(s, m.more.x);
    s.coat = m.more.y;
    s.coat_roughness = m.more.z;
#ifdef MASU_MOTION
    out_velocity = masu_velocity(vec4(in_rel, 1.0), vec4(in_before, 1.0),
                                 vec2(pc.output_width, pc.output_height));
#endif
#ifdef MASU_TEXTURES
#ifdef MASU_MOTION
    float speed = length(out_velocity.xy + frame.shifts.zw);
    mip_bias = min(push.mip_bias + push.mip_moving * min(share_per_pixel * speed, most_shares),
                   max(push.mip_bias, 0.0));
#endif
    /* Derivatives must precede the discard. */
    float alpha = masu_sample_maps(in_texcoord, floor(0.5 * m.more.w), s);
#ifdef MASU_ATTRIBUTES
    masu_tint(s, in_color.rgb);
#endif
    vec3 bent = masu_bend_normal(in_normal, in_rel, in_texcoord);
#ifdef MASU_SURFACE
    bool coat_bends = masu_own_coats && (push.flags & MASU_MAP_COAT_RELIEF) != 0u;
    vec3 bent_coat = in_normal, grain = vec3(0.0);
    if (coat_bends) {
        bent_coat = masu_bend_coat(in_normal, in_rel, in_texcoord);
    }
    if (masu_has_lobe(s, MASU_LOBE_GRAIN)) {
        float angle = float(s.lobe >> 7 & 127u) * (3.14159265 / 128.0);
        grain = masu_from_tangents(vec2(cos(angle), sin(angle)), in_normal, in_rel, in_texcoord);
    }
#endif
#endif
    masu_take_look(s);
    if (masu_faded(uvec2(gl_FragCoord.xy))) {
        discard;
    }
    /* Two-sided: the normal faces the camera for any winding of the triangle. */
    vec3 n = masu_normalize(in_normal, vec3(0.0, 1.0, 0.0));
    bool away = masu_seen_from_below(n, in_rel);
#ifdef MASU_TEXTURES
    if (masked && !(alpha >= masu_cutoff())) {
        discard;
    }
    /* The back of a face has the same relief from below: the whole normal is negated. */
    bent = away ? -bent : bent;
#ifdef MASU_SURFACE
    /* The normal without the relief. */
    vec3 even = masu_normalize(masu_lean_to_eye(away ? -n : n, in_rel, 0.0), n);
    if (coat_bends) {
        even = masu_normalize(masu_seen_normal(away ? -bent_coat : bent_coat, in_rel, n), n);
    }
#endif
#ifdef MASU_SURFACE
    if (push.meso > 0u) {
        bent = show_relief(bent, n, s);
    }
#endif
    n = masu_seen_normal(bent, in_rel, n);
#else
    n = masu_lean_to_eye(away ? -n : n, in_rel, 0.0);
#ifdef MASU_SURFACE
    if (push.meso > 0u) {
        n = masu_normalize(n, vec3(0.0, 1.0, 0.0));
        n = masu_normalize(show_relief(n, n, s), n);
    }
#endif
#endif
#if defined(MASU_TEXTURES) && defined(MASU_SURFACE)
    /* A coat that rounds to 0 in the texel is ignored. */
    const uint own = MASU_MAP_COAT_SMOOTH | MASU_MAP_BASE_SMOOTH;
    bool two = masu_own_coats && (push.flags & own) != 0u && s.coat * 15.0 >= 0.5;
    bool base_is_even = (push.flags & MASU_MAP_BASE_SMOOTH) != 0u;
    vec3 below = base_is_even ? even : n;
    if (masu_own_coats && (push.flags & own) != 0u) {
        n = two != base_is_even ? even : n;
    }
#endif
    masu_pack_texels(n, s, out_albedo, out_normal);
#ifndef MASU_NO_EMISSION
    out_hdr = vec4(masu_emitted(s), 1.0);
#endif
#if defined(MASU_TEXTURES) && defined(MASU_SURFACE)
    if (two) {
        s.lean = masu_lean_of(masu_unpack_normal(out_normal), masu_normalize(below, even));
    }
#endif
#if defined(MASU_TEXTURES) && defined(MASU_SURFACE)
    if (masu_has_lobe(s, MASU_LOBE_GRAIN)) {
        masu_turn_grain(s, masu_unpack_normal(out_normal), grain);
    }
#endif
#ifdef MASU_SURFACE
    out_normal |= MASU_SURFACE_MORE << 30;
    out_surface = masu_pack_surface(s);
#endif
}
