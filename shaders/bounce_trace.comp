/*
 * bounce_trace.comp: traces the rays of the frame's live probes against polygons and stores the
 * closest hit. With push.shadow it tests instead whether a polygon blocks the light that
 * bounce_shade.comp has chosen for a hit.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/bounce_trace.h"
#include "shared/types.h"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#define MASU_TRACE_POLYGONS
#include "trace/scene.glsl"
#define MASU_TRACE_LANES 64
#include "trace/texels.glsl"
#include "trace/bvh.glsl"
#include "specular/ray.glsl"
#define MASU_PROBES_LIVE
#include "light/probes.glsl"
#include "bounce/ray.glsl"

layout(local_size_x = 64) in;

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < masu_bounce.rays.x * 64u && i < masu_bounce.rays.w) {
        masu_bounce_ray ray = masu_bounce_ray_at(i);
        vec3 origin = masu_probe_place(ray.probe) +
                      (probe_grid.origin.xyz - frame.trace_anchor.xyz);
        vec3 direction = vec3(0.0);
        float far = frame.trace_anchor.w;
        bool shadow = push.shadow != 0u;
        if (shadow) {
            vec4 lit = uintBitsToFloat(masu_bounce_rays[2u * i]);
            origin = lit.xyz;
            far = lit.w;
            direction = masu_unpack_direction(masu_bounce_rays[2u * i + 1u].w);
        } else {
            direction = masu_bounce_direction(ray);
        }
        masu_ray_hit hit = masu_trace_walk(origin, direction, 0.0, far, shadow);
        if (!shadow) {
            vec2 b = masu_sane(vec4(hit.barycentrics, 0.0, 0.0), 0.0, 1.0).xy;
            masu_bounce_rays[2u * i] =
                uvec4(floatBitsToUint(hit.t), hit.instance, hit.triangle, packUnorm2x16(b));
        } else if (hit.t >= 0.0) {
            masu_bounce_rays[2u * i].w = floatBitsToUint(-1.0);
        }
    }
}
