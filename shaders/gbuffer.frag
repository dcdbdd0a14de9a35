/*
 * gbuffer.frag: the material of a polygon into the G-buffer. index.x is the draw's material. With
 * MASU_MOTION (gbuffer_velocity) its velocity too. With MASU_TEXTURES the material's maps: index.z
 * its flags, index.w the layers of its maps, 8 bits each; param.x the bias of mip levels.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/pack.glsl"

#ifdef MASU_MOTION
#include "shared/globals.glsl"
#include "shared/motion.glsl"
layout(location = 2) in vec3 in_before;
layout(location = 2) out vec4 out_velocity;
#else
layout(push_constant) uniform Push
{
    masu_push pc;
};
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MATERIALS, std430) readonly buffer Materials
{
    masu_material_data materials[];
};

#ifdef MASU_TEXTURES
#include "shared/maps.glsl"
layout(location = 3) in vec2 in_texcoord;
#endif

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec3 in_rel;

layout(location = 0) out vec4 out_albedo;
layout(location = 1) out uint out_normal;

void main()
{
    masu_material_data m = materials[pc.index.x];
    masu_surface s;
    s.albedo = m.base_color.rgb;
    s.roughness = m.base_color.w;
    s.emissive = m.emissive.rgb;
    s.metallic = m.emissive.w;
#ifdef MASU_TEXTURES
    /* Everything that takes derivatives comes before the discard. */
    float alpha = masu_sample_maps(in_texcoord, s);
    vec3 bent = masu_bend_normal(in_normal, in_rel, in_texcoord);
    if (masked && !(alpha >= masu_cutoff())) {
        discard;
    }
#endif
    /* Two-sided: the normal is turned to the viewer, whichever way the triangle was wound. */
    vec3 n = masu_normalize(in_normal, masu_normalize(-in_rel, vec3(0.0, 1.0, 0.0)));
#ifdef MASU_TEXTURES
    /* A face seen from behind is the same relief from below: all of its normal turns. */
    n = masu_seen_normal(dot(n, in_rel) > 0.0 ? -bent : bent, in_rel, n);
#else
    n = dot(n, in_rel) > 0.0 ? -n : n;
#endif
    out_albedo = masu_pack_albedo(s);
    out_normal = masu_pack_normal(n, s);
#ifdef MASU_MOTION
    out_velocity = masu_velocity(vec4(in_rel, 1.0), vec4(in_before, 1.0),
                                 vec2(pc.output_width, pc.output_height));
#endif
}
