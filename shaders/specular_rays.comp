/*
 * specular_rays.comp: generates one ray for each traced texel: the reflection at a normal that is
 * sampled from the visible normals of its pixel's lobe (brdf/vndf.glsl), with noise that is blue
 * over texels and evenly distributed over frames (noise/sequence.glsl).
 *
 * specular_composite multiplies radiance by the albedo of the lobe, as if all rays had the same
 * weight. They do not: on a wet street at a low angle, rays along the street are reflected several
 * times as strongly as rays up to the sky. So means over frames use a ray weight relative to the
 * ray's own lobe. A ray that would go below the surface has a small weight.
 *
 * With debug.reference (push.accumulate) the ray also stores the weight of its radiance, from the
 * lobes themselves instead of their albedo. A surface with a coat has two lobes, which alternate;
 * the density is that of both together. (The lobe must not be chosen by another number of the same
 * sequence: its steps correlate with the first, so each lobe would be sampled in only one half of
 * its directions.) A mirror reflects all rays in one direction, which has no density: there each
 * ray stands only for its lobe.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/specular_rays.h"
#include "shared/counters.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "brdf/vndf.glsl"
#include "noise/sequence.glsl"
#include "specular/filter.glsl"
#include "specular/guide.glsl"
#include "specular/lobes.glsl"
#include "specular/ray.glsl"
#include "specular/surface.glsl"
#include "specular/tiles.glsl"
#include "trace/scene.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE) uniform usampler2D guide_image;
layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE + 1, rg32ui) uniform writeonly uimage2D
    ray_image;
layout(set = MASU_SET_PASS, binding = MASU_AFTER_SURFACE + 2, rgba32ui) uniform writeonly uimage2D
    hit_image;

uint noise_at(uvec2 texel, uint key)
{
    return masu_trace_noise(masu_noise_index(texel.x, texel.y, key));
}

/* Ray weight of direction l. turn: 0: there is no coat, 1: it is the base's ray, 2: the coat's. */
vec3 worth(masu_surface s, masu_bsdf b, masu_axes f, vec3 v, vec3 l, uint turn)
{
    vec3 base;
    float coat;
    masu_lobes(b, l, base, coat);
    vec3 local = masu_axes_in(f, l);
    vec2 share = vec2(masu_traced_share(s.roughness, push.cutoff),
                      masu_traced_share(s.coat_roughness, push.cutoff));
    float pdf = masu_vndf_pdf(v, local, b.alpha);
#ifdef MASU_SURFACE
    if (turn != 0u) {
        if (masu_own_coats) { /* f has the axes of the ray's own lobe */
            masu_axes base_axes = masu_axes_of(b.n);
            pdf = masu_vndf_pdf(masu_axes_in(base_axes, b.v), masu_axes_in(base_axes, l), b.alpha);
            masu_axes coat_axes = masu_axes_of(b.coat_n);
            local = masu_axes_in(coat_axes, l);
            v = masu_axes_in(coat_axes, b.v);
        }
        vec2 both = 0.5 * vec2(pdf, masu_vndf_pdf(v, local, b.coat_alpha));
        pdf = both.x + both.y;
        if (!(min(b.alpha, b.coat_alpha) > masu_mirror_alpha)) {
            bool of_base = turn == 1u;
            pdf = of_base ? both.x : both.y;
            share *= of_base ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
        }
    }
#endif
    return (base * share.x + coat * share.y) / max(3.14159265 * pdf, 1e-9);
}

/* Ray weight for the ray's own lobe only, relative to the mean weight, the albedo. Luma; 1 if
 * undefined. */
float relative_worth(masu_surface s, masu_bsdf b, masu_vndf_ray r, vec3 l)
{
    vec3 sum = l + b.v;
    float schlick = masu_schlick(0.5 * masu_sqrt(dot(sum, sum)));
    bool coat = s.coat > 0.0;
    vec3 mirrored = coat ? vec3(s.coat * (0.04 + 0.96 * schlick)) : b.f0 + (b.f90 - b.f0) * schlick;
    float mean = masu_luma(coat ? vec3(masu_bsdf_coat(b)) : masu_bsdf_specular(b));
    return mean > 1e-4 ? masu_luma(mirrored) * r.weight / mean : 1.0;
}

void main()
{
    masu_count_begin();
    uvec2 texel = masu_specular_texel();
    if (masu_specular_inside(texel)) {
        masu_guide g = masu_unpack_guide(texelFetch(guide_image, ivec2(texel), 0).rg);
        uvec2 ray = uvec2(0u);
        if (g.there) {
            uvec2 at = masu_guide_place(texel, g.pixel, push.traced_size);
            masu_pixel p = masu_pixel_at(at);
            vec3 n = masu_unpack_normal(p.normal);
            vec3 toward = masu_pixel_ray(at, uvec2(pc.render_width, pc.render_height));
            vec3 v = -masu_normalize(toward, frame.forward.xyz);
            masu_axes f = masu_axes_of(n);
            vec3 v_local = masu_axes_in(f, v);
            uint number = frame.history.x;
            uint word = noise_at(texel, 0u);
            vec2 u = push.traced_size == 1u ? masu_noise2(word, number)
                                            : masu_turn_noise2(word, masu_turn(number));
            float alpha = masu_alpha(masu_traced_roughness(p.surface));
            uint turn = 0u;
            masu_bsdf b = masu_bsdf_make(p.surface, n, v);
            if (push.accumulate != 0u) {
                if (p.surface.coat > 0.0) {
                    turn = 1u + ((number + noise_at(texel, 1u)) & 1u);
                    alpha = turn == 1u ? b.alpha : alpha;
#ifdef MASU_SURFACE
                    if (masu_own_coats && turn == 1u) {
                        n = b.n;
                        f = masu_axes_of(n);
                        v_local = masu_axes_in(f, v);
                    }
#endif
                }
            }
            masu_vndf_ray r = masu_vndf_reflect(v_local, alpha, u);
            vec3 l = masu_axes_out(f, r.l);
            bool above = r.l.z > 0.0;
            /* A direction below the surface is mirrored up. Its weight is 0 in the reference and
             * small in the filters. */
            vec3 kept = above ? l : l - 2.0 * dot(l, n) * n;
            ray.x = masu_pack_direction(kept);
            if (push.accumulate != 0u) {
                uint bits = masu_hash(masu_hash(number) ^ noise_at(texel, 2u));
                ray.y = masu_pack_shared(above ? worth(p.surface, b, f, v_local, l, turn)
                                               : vec3(0.0),
                                         float(bits >> 8) * (1.0 / 16777216.0));
            } else {
                ray.y = masu_pack_drawn(r.pdf, relative_worth(p.surface, b, r, l));
            }
            masu_count(MASU_COUNTER_SPECULAR_RAYS, 1u);
        }
        MASU_STORE_UINT(ray_image, texel, uvec4(ray, 0u, 0u));
        MASU_STORE_UINT(hit_image, texel, uvec4(floatBitsToUint(-1.0), 0u, 0u, 0u));
    }
    masu_count_end();
}
