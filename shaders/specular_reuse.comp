/*
 * specular_reuse.comp: ray reuse for reflections. A hit of a neighbour's ray is also a sample of
 * this texel's lobe, drawn with another density:
 *
 *   radiance = sum of w_i L_i / sum of w_i,   w_i = lobe(v, l_i) n.l_i / density_i * dw_here /
 * dw_there
 *
 * with l_i from here to that hit (Stachowiak, "Stochastic Screen-Space Reflections", SIGGRAPH
 * 2015). The quotient is biased for few rays and correct in the limit. A sum over a fixed number of
 * rays would be correct on average, but with the noise of all weights. Fresnel and shadowing terms,
 * which lobe(v, l) has in addition to the density of its rays, are the neighbour's: they are stored
 * with its ray (specular/ray.glsl).
 *
 * The four texels of a quad use different points of the spiral, which rotates in each frame, so
 * that neighbours sample what one texel does not. The texel's own ray is always included. A
 * direction that was mirrored up from below the surface (specular_rays) has no meaningful density
 * and is not reused.
 *
 * push.taps: number of neighbours.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_reuse.h"
#include "shared/reflections.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "brdf/vndf.glsl"
#include "noise/sequence.glsl"
#include "specular/filter.glsl"
#include "specular/ray.glsl"
#include "specular/tiles.glsl"
#include "trace/scene.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D ray_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D light_image;
layout(set = MASU_SET_PASS, binding = 3, rgba16f) uniform writeonly image2D reused_image;

/* Smaller densities are invalid: see above. */
const float least_density = 1e-4;
/* Limit of the ratio of densities. One ray that this lobe draws far more often than the neighbour's
 * lobe would be noise. */
const float most_weight = 2.0;
/* Largest radius in texels, for any image size. */
const float widest = 6.0;

struct lobe {
    vec3 point;
    masu_axes f;
    vec3 v; /* local */
    float alpha;
};

/* lobe * n.l / density of a direction; drawn: packed values of its ray (specular/ray.glsl). */
float weight_of(lobe own, vec3 l, uint drawn)
{
    float density = masu_drawn_density(drawn);
    vec3 local = masu_axes_in(own.f, l);
    if (!(local.z > 1e-4) || !(density > least_density)) {
        return 0.0;
    }
    vec3 h = masu_normalize(own.v + local, vec3(0.0, 0.0, 1.0));
    return masu_sane(masu_vndf_density(own.v, h, own.alpha) / density, 0.0, most_weight) *
           masu_drawn_worth(drawn);
}

/* Sum of radiance times weight, and of weights in a. The distance is averaged by its reciprocal:
 * the sky's distance would dominate all others. */
void add(inout vec4 sum, inout float nearness, float weight, vec4 light)
{
    sum += weight * vec4(masu_tamed(light.rgb), 1.0);
    nearness += weight * masu_rcp(max(masu_sane(light.a, 0.0, 65504.0), 1e-4));
}

void neighbour(lobe own, masu_guide g, ivec2 at, float width, inout vec4 sum, inout float nearness)
{
    masu_guide o = masu_unpack_guide(texelFetch(guide_image, at, 0).rg);
    if (!o.there || dot(o.normal, g.normal) < 0.7 || abs(o.roughness - g.roughness) > 0.1) {
        return;
    }
    vec3 from = masu_specular_point(uvec2(at), o);
    if (!masu_same_plane(from - own.point, g.normal, width)) {
        return;
    }
    uvec2 ray = texelFetch(ray_image, at, 0).rg;
    vec4 light = texelFetch(light_image, at, 0);
    float far = masu_sane(light.a, 0.0, 65504.0);
    vec3 there = masu_unpack_direction(ray.x);
    vec3 to = from + there * far - own.point;
    float squared = dot(to, to);
    float jacobian = clamp(far * far / max(squared, 1e-12), 0.1, 10.0);
    vec3 l = masu_normalize(to, there);
    add(sum, nearness, weight_of(own, l, ray.y) * jacobian, light);
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        vec4 light = vec4(0.0);
        if (g.there) {
            light = texelFetch(light_image, ivec2(texel), 0);
            light = vec4(masu_tamed(light.rgb), masu_sane(light.a, 0.0, 65504.0));
        }
        if (g.there && g.roughness > masu_mirror_roughness) {
            lobe own;
            own.point = masu_specular_point(texel, g);
            own.f = masu_axes_of(g.normal);
            own.v =
                masu_vndf_view(masu_axes_in(own.f, -masu_normalize(own.point, frame.forward.xyz)));
            own.alpha = masu_vndf_alpha(masu_alpha(g.roughness));
            float width = masu_texel_width(g);
            uvec2 ray = texelFetch(ray_image, ivec2(texel), 0).rg;
            vec4 sum = vec4(0.0);
            float nearness = 0.0;
            /* A minimum weight, so that there is a result if no other ray fits. */
            add(sum, nearness, max(weight_of(own, masu_unpack_direction(ray.x), ray.y), 1e-3),
                light);
            float curvature = masu_guide_curvature(guide_image, ivec2(texel), g, own.point);
            float radius = clamp(masu_specular_reach(g, own.point, light.a, curvature), 1.5,
                                 widest);
            uint quad = (texel.x & 1u) + 2u * (texel.y & 1u);
            vec2 turn =
                masu_noise2(masu_trace_noise(masu_noise_index(texel.x >> 1, texel.y >> 1, 2u)),
                            frame.history.x);
            ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
            for (uint k = 0u; k < uint(MASU_REUSE_TAPS_MAX); k++) {
                if (k >= push.taps) {
                    break;
                }
                float number = float(4u * k + quad) + turn.y;
                float angle = 6.2831853 * fract(0.38196601 * float(4u * k + quad) + turn.x) -
                              3.1415927;
                float r = radius * sqrt(number / float(4u * push.taps));
                ivec2 at = ivec2(texel) + ivec2(round(r * vec2(cos(angle), sin(angle))));
                if (at == ivec2(texel) || any(lessThan(at, ivec2(0))) ||
                    any(greaterThan(at, last))) {
                    continue;
                }
                neighbour(own, g, at, width, sum, nearness);
            }
            light = vec4(sum.rgb / max(sum.a, 1e-9), sum.a / max(nearness, 1e-9));
        }
        MASU_STORE_HALF(reused_image, texel, light);
    }
    masu_count_end();
}
