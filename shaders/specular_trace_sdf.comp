/*
 * specular_trace_sdf.comp: intersects the ray of each traced texel with the SDF, up to the polygon
 * that it has hit. Compiled by masu-bake with the scene's field for scenes with reflections. With
 * MASU_MOTION, if the field changes, it also writes the motion of the point since the previous
 * frame, as far as its part is translated, rotated or scaled as a whole (sdf_velocity.comp, step
 * 1).
 *
 * push.steps: maximum number of steps of a ray.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/specular_trace_sdf.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D ray_image;
layout(set = MASU_SET_PASS, binding = 2, rgba32ui) uniform uimage2D hit_image;

#define INVOCATIONS (MASU_GROUP * MASU_GROUP)
#define MASU_RELAXED
#define MASU_SDF_NO_FLAT
#include "sdf/reflected.glsl"
#include "specular/origin.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"

#ifdef MASU_MOTION
/* Position of p in the previous frame by the root transform of the part, minus p. */
vec3 moved(uint part, vec3 p)
{
    vec3 own = masu_sdf_root(part, p, false);
    vec3 places[2];
    MASU_LOOP for (int i = 0; i < 2; i++) {
        masu_before = i == 1;
        places[i] = masu_sdf_root(part, own, true);
    }
    masu_before = false;
    return places[1] - places[0];
}
#else
vec3 moved(uint part, vec3 p)
{
    return vec3(0.0);
}
#endif

uvec4 hit_of(reflected m, float t, bool known, inout uint evals)
{
    ray r = m.along;
    vec3 p = world_at(r.direction, t);
    uint part = m.part;
    vec3 n;
    if (known) {
        n = masu_normalize(masu_sdf_flat_normal(part), -r.direction);
    } else {
        n = normal_at(r, t, part);
        evals += 4u;
    }
    /* A ray that starts inside or grazes a surface may get a normal that points away: tilt it until
     * it is perpendicular. */
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
    return uvec4(floatBitsToUint(max(t - m.apex, 0.0)), masu_pack_sdf_motion(moved(part, p)),
                 normal, packUnorm4x8(albedo));
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        if (g.there) {
            vec3 point = masu_specular_point(texel, g);
            vec3 direction = masu_unpack_direction(texelFetch(ray_image, ivec2(texel), 0).r);
            float polygon = uintBitsToFloat(imageLoad(hit_image, ivec2(texel)).r);
            float longest = min(frame.trace_anchor.w, frame.sdf_max.w);
            longest = polygon >= 0.0 ? min(longest, polygon) : longest;
            vec3 a = abs(frame.sdf_eye_hi.xyz + point);
            float far = max(max(a.x, max(a.y, a.z)), length(point));
            float width = masu_specular_width(g);
            float lift = 0.125 * width + 9.6e-7 * far;
            float spread = frame.up.w * 2.0 / float(pc.render_height);
            reflected m = reflected_ray(point + g.normal * lift, direction, width, spread, lift,
                                        longest);
            uint evals = MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT ? 1u : 0u;
            float t = march_reflected(m, evals);
            bool known = !(t >= 0.0);
            t = known ? m.end : t;
            if (t >= 0.0) {
                MASU_STORE_UINT(hit_image, texel, hit_of(m, t, known, evals));
                masu_count(MASU_COUNTER_SPECULAR_SDF_HITS, 1u);
            }
            masu_count(MASU_COUNTER_SPECULAR_EVALS, evals);
        }
    }
    masu_count_end();
}
