/*
 * specular_rays.comp: one ray for each traced texel, drawn where its pixel's lobe of visible normals
 * reflects to (brdf/vndf.glsl), by noise that is blue over texels and even over frames
 * (noise/sequence.glsl).
 *
 * What a ray brings is multiplied by the albedo of its lobe (specular_composite), as if all rays were worth the same. They are
 * not: of a wet street that is seen at a low angle those that go on along it are mirrored by several times as much as those that
 * go up to the sky. So means over frames weigh each ray by what it is worth to its own lobe; one that would go below the surface
 * is worth little.
 *
 * With debug.reference (push.accumulate) also what the ray's radiance is worth, by the lobes themselves and not
 * their albedo: a surface with a coat has two, which take turns; the density is that of both. (Of the same
 * sequence another number must not choose: its steps are those of the first, and each lobe would be asked
 * in one and the same half of its directions.) A mirror's rays all go one way, which has no density: there
 * each ray stands for its own lobe alone.
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

/* What a ray towards l is worth. turn: 0: there is no coat, 1: it is the base's ray, 2: the coat's. */
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
        if (masu_own_coats) { /* f is the ray's own lobe's */
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

/* The same of a lobe of its own, relative to the mean of that: to albedo. Luma; 1 where it is not known. */
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
            vec2 u = push.traced_size == 1u ? masu_noise2(word, number) : masu_turn_noise2(word, masu_turn(number));
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
            /* What would go below the surface is mirrored back up; it is worth nothing to the reference,
             * and to the filters little. */
            vec3 kept = above ? l : l - 2.0 * dot(l, n) * n;
            ray.x = masu_pack_direction(kept);
            if (push.accumulate != 0u) {
                uint bits = masu_hash(masu_hash(number) ^ noise_at(texel, 2u));
                ray.y = masu_pack_shared(above ? worth(p.surface, b, f, v_local, l, turn) : vec3(0.0),
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
