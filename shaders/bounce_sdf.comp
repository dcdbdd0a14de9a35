/*
 * bounce_sdf.comp: marches the rays of the frame's live probes through the SDF and stores a hit
 * that is closer than the ray's polygon hit. With push.shadow it tests instead whether the SDF
 * blocks the light chosen for a hit. masu-bake compiles it with the scene's SDF for scenes with a
 * live bounce.
 *
 * push.steps: most steps per ray. push.begins: not 0 if no polygons are traced, so that rays have
 * no hit yet.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/bounce_sdf.h"
#include "shared/types.h"
#include "shared/counters.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#define INVOCATIONS (MASU_GROUP * MASU_GROUP)
#define MASU_RELAXED
#define MASU_SDF_NO_FLAT
#include "sdf/reflected.glsl"
#include "specular/ray.glsl"
#define MASU_PROBES_LIVE
#include "light/probes.glsl"
#include "bounce/ray.glsl"

/* Ray width: a millimetre at the origin, and another per metre. Finer detail is invisible in
 * diffuse light. */
#define WIDTH 1e-3
#define SPREAD 1e-3

uvec4 hit_of(reflected m, float t, bool known)
{
    ray r = m.along;
    vec3 p = world_at(r.direction, t);
    uint part = m.part;
    vec3 n;
    if (known) {
        n = masu_normalize(masu_sdf_flat_normal(part), -r.direction);
    } else {
        n = normal_at(r, t, part);
    }
    float away = dot(n, r.direction);
    if (away > 0.0) {
        n = masu_normalize(n - away * r.direction, -r.direction);
    }
    masu_surface s = masu_plain_surface(vec3(0.5), 0.5);
    masu_normal = n;
#ifdef MASU_SDF_PAINTED
    masu_footprint = t * r.pixel;
#endif
    masu_sdf_part_surface(part, p, s);
    vec4 albedo;
    uint normal;
    masu_pack_met(n, s, albedo, normal);
    return uvec4(floatBitsToUint(max(t - m.apex, 0.0)), MASU_HIT_SDF, normal, packUnorm4x8(albedo));
}

void main()
{
    uint i = gl_WorkGroupID.x * uint(INVOCATIONS) + gl_LocalInvocationIndex;
    if (i < masu_bounce.rays.w) {
        masu_bounce_ray ray = masu_bounce_ray_at(i);
        vec3 eye = (frame.eye_hi.xyz - probe_grid.origin.xyz) + frame.eye_lo.xyz;
        uvec4 half_0 = masu_bounce_rays[2u * i];
        vec3 from = masu_probe_place(ray.probe) - eye, direction = masu_bounce_direction(ray);
        float longest = min(frame.trace_anchor.w, frame.sdf_max.w), lift = 0.0;
        bool shadow = push.shadow != 0u;
        vec4 lit = uintBitsToFloat(half_0);
        if (shadow) {
            direction = masu_unpack_direction(masu_bounce_rays[2u * i + 1u].w);
            from = lit.xyz - frame.trace_eye.xyz;
            longest = min(longest, lit.w);
        } else if (push.begins == 0u && lit.x >= 0.0) {
            longest = min(longest, lit.x);
        }
        vec3 a = abs(frame.sdf_eye_hi.xyz + from);
        float far = max(max(a.x, max(a.y, a.z)), length(from));
        lift = WIDTH * 0.5 + 9.6e-7 * far;
        float t = -1.0;
        uvec4 found = uvec4(floatBitsToUint(-1.0), 0u, 0u, 0u);
        if (longest > lift) {
            vec3 begin = shadow ? from + direction * lift : from;
            reflected m = reflected_ray(begin, direction, WIDTH, SPREAD, lift, longest);
            uint evals = 0u;
            t = march_reflected(m, evals);
            bool known = !(t >= 0.0);
            t = known ? m.end : t;
            if (t >= 0.0 && !shadow) {
                found = hit_of(m, t, known);
            }
        }
        if (shadow && t >= 0.0) {
            masu_bounce_rays[2u * i].w = floatBitsToUint(-1.0);
        } else if (!shadow && (t >= 0.0 || push.begins != 0u)) {
            masu_bounce_rays[2u * i] = found;
        }
    }
}
