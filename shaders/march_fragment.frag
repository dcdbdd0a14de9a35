/*
 * march_fragment.frag: for comparison: march_plain.comp as a fragment shader, which on some drivers
 * is the better baseline. Scenes without polygons only; counts nothing. Compiled by masu-bake with
 * --variants.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/march_fragment.h"
#include "shared/globals.glsl"
#include "shared/pack.glsl"

layout(location = 0) out vec4 out_albedo;
layout(location = 1) out uint out_normal;
layout(location = 2) out float out_depth;

void masu_count(uint counter, uint n)
{
}

#include "sdf/trace.glsl"

void main()
{
    uvec2 at = uvec2(gl_FragCoord.xy);
    float z_scale;
    uint evals;
    ray r = pixel_ray(at, uvec2(pc.output_width, pc.output_height), 0.0, z_scale);
    float t = march(r, evals);
    if (!(t >= 0.0)) {
        discard;
    }
    texels_at(r, t, false, 0u, out_albedo, out_normal);
    out_depth = masu_sane(depth_of(t, z_scale), 0.0, 1.0);
}
