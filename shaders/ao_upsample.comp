/*
 * ao_upsample.comp: the ambient half of the occlusion image, from ao.comp's texels at half size. Each
 * pixel takes the mean of 4x4 of them, which is what their pattern of directions repeats in, as far
 * as they lie in its own plane and face its way.
 *
 * One invocation works on the 2x2 pixels of a texel: all four look at the same 16, and a group's texels
 * are unpacked once, in shared memory.
 *
 * WEIGHTS. By the distance of the texel's point from the pixel's plane: (1 - (d / tolerance)^2)^2, 0
 * beyond the tolerance of half a texel's width there and a hundredth of the radius; by the fourth
 * power of the normals' cosine. Without the latter, edges at which a plane goes on (a bolt on its
 * flange) smear: the motor's error was 0.078 instead of 0.049. Where all 16 are something else, the
 * nearest to the plane is taken alone.
 *
 * Out in the open, where all 16 are seen but for so little that no picture shows it (open), none of that is asked: all
 * arrives. Nor where the 16 differ by no more than `even`, which is most of a picture: their plain mean is less far than
 * that from any weighting of them, and mostly they differ by the pattern alone.
 *
 * Where the SDF has an ambient occlusion of its own, the lesser of the two counts: what both see they
 * would count twice as a product (docs/design/06-ambient-occlusion.md has the errors).
 *
 * push.radius: radius, metres. push.multiplies: not 0: the occlusion image holds something already;
 * push.size: pixels per texel, 2, or 1 for comparison.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/ao_upsample.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"
#include "light/ao_texel.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = 2) uniform usampler2D ao_image;
layout(set = MASU_SET_PASS, binding = 3, r32ui) uniform uimage2D occlusion_image;

/* Along the ray through the middle of a pixel, as long as makes its view z 1: masu_pixel_ray in steps. */
vec3 ray_at(ao_lens lens, uvec2 pixel)
{
    vec2 ndc = masu_ndc(vec2(pixel) + 0.5, lens.size);
    return frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
}

/* Three steps of ao_texel.glsl's 1023 and what rounds. */
const float open = 1.0 - 3.5 / 1023.0;

/* The most by which 16 texels differ that are averaged without a look at planes. */
const float even = 0.125;

#define EDGE (MASU_GROUP + 3)

/* What the texels of the group and around it say: where they are and how much is seen (below 0:
 * nothing is there), and their normals. */
shared vec4 texels[EDGE * EDGE];
shared vec3 normals[EDGE * EDGE];

void load_texels(ao_lens lens, uvec2 last)
{
    ivec2 first = ivec2(gl_WorkGroupID.xy) * MASU_GROUP - 1;
    for (int i = 0; i < (EDGE * EDGE + MASU_GROUP * MASU_GROUP - 1) / (MASU_GROUP * MASU_GROUP); i++) {
        int n = i * MASU_GROUP * MASU_GROUP + int(gl_LocalInvocationIndex);
        ivec2 from = first + ivec2(n % EDGE, n / EDGE);
        if (n < EDGE * EDGE) {
            bool inside = all(greaterThanEqual(from, ivec2(0))) &&
                          all(lessThan(from, ivec2(pc.output_width, pc.output_height)));
            from = inside ? from : ivec2(0);
            uint word = texelFetch(ao_image, from, 0).r;
            uvec2 pixel = min(uvec2(from) * push.size, last);
            float z = ao_view_z(ao_unpack_depth(word));
            bool there = inside && z < ao_farthest;
            texels[n] = vec4(ray_at(lens, pixel) * z, there ? ao_unpack_seen(word) : -1.0);
            normals[n] = masu_unpack_normal(texelFetch(normal_image, ivec2(pixel), 0).r);
        }
    }
    barrier();
}

/* What arrives at the four pixels of a texel, each component one of them, by the 16 texels from `corner` on. */
vec4 filtered(uvec2 texel, uvec2 last, uint corner)
{
    ao_lens lens = ao_lens_of(last + 1u);
    vec4 plane_x, plane_y, plane_z, plane_w, tolerance;
    vec4 there;
    for (int k = 0; k < 4; k++) {
        uvec2 at = min(texel * push.size + uvec2(k & 1, k >> 1), last);
        uint packed = texelFetch(normal_image, ivec2(at), 0).r;
        float z = ao_view_z(texelFetch(depth_image, ivec2(at), 0).r);
        vec3 normal = masu_unpack_normal(packed);
        bool lit = !masu_is_unlit_texel(packed);
        plane_x[k] = normal.x;
        plane_y[k] = normal.y;
        plane_z[k] = normal.z;
        plane_w[k] = dot(ray_at(lens, at) * z, normal);
        tolerance[k] = 0.5 * float(push.size) * lens.scale.y * z + 0.01 * push.radius;
        there[k] = z < ao_farthest && lit ? 1.0 : 0.0;
    }
    vec4 sharp = 1.0 / (tolerance * tolerance);
    vec4 sum = vec4(0.0);
    vec4 weights = vec4(0.0);
    for (int i = 0; i < 16; i++) {
        vec4 place = texels[corner + uint((i >> 2) * EDGE + (i & 3))];
        vec3 normal = normals[corner + uint((i >> 2) * EDGE + (i & 3))];
        if (place.w < 0.0) {
            continue;
        }
        float seen = place.w;
        vec4 off = plane_x * place.x + plane_y * place.y + plane_z * place.z - plane_w;
        vec4 facing = max(plane_x * normal.x + plane_y * normal.y + plane_z * normal.z, 0.0);
        vec4 root = max(1.0 - off * off * sharp, 0.0) * (facing * facing);
        vec4 weight = root * root;
        sum += weight * seen;
        weights += weight;
    }
    bvec4 trusted = greaterThan(weights, vec4(1e-3));
    vec4 ambient = sum / max(weights, 1e-3);
    /* Few pixels are alone: only for them the texels are gone through once more. */
    if (any(greaterThan(there * vec4(not(trusted)), vec4(0.0)))) {
        vec4 nearest = vec4(1e30);
        vec4 fallback = vec4(1.0);
        for (int i = 0; i < 16; i++) {
            vec4 place = texels[corner + uint((i >> 2) * EDGE + (i & 3))];
            vec3 normal = normals[corner + uint((i >> 2) * EDGE + (i & 3))];
            if (place.w < 0.0) {
                continue;
            }
            vec4 off = abs(plane_x * place.x + plane_y * place.y + plane_z * place.z - plane_w);
            vec4 facing = max(plane_x * normal.x + plane_y * normal.y + plane_z * normal.z, 0.0);
            vec4 cost = off + 4.0 * tolerance * (1.0 - facing * facing);
            fallback = mix(fallback, vec4(place.w), lessThan(cost, nearest));
            nearest = min(nearest, cost);
        }
        ambient = mix(fallback, ambient, trusted);
    }
    return mix(vec4(1.0), ambient, greaterThan(there, vec4(0.0)));
}

void main()
{
    masu_count_begin();
    uvec2 texel = gl_GlobalInvocationID.xy;
    uvec2 last = uvec2(pc.render_width, pc.render_height) - 1u;
    load_texels(ao_lens_of(last + 1u), last);
    if (all(lessThan(texel, uvec2(pc.output_width, pc.output_height)))) {
        uint corner = gl_LocalInvocationID.y * EDGE + gl_LocalInvocationID.x;
        float least = 1.0;
        float most = 0.0;
        float sum = 0.0;
        bool all_there = true;
        for (int i = 0; i < 16; i++) {
            float seen = texels[corner + uint((i >> 2) * EDGE + (i & 3))].w;
            all_there = all_there && seen >= 0.0;
            least = min(least, seen < 0.0 ? 1.0 : seen);
            most = max(most, seen);
            sum += seen;
        }
        vec4 ambient = vec4(1.0);
        if (all_there && most - least <= even) {
            ambient = vec4(sum * (1.0 / 16.0));
        } else if (!(least > open)) {
            ambient = filtered(texel, last, corner);
        }
        for (int k = 0; k < 4; k++) {
            uvec2 at = texel * push.size + uvec2(k & 1, k >> 1);
            if (uint(k) >= push.size * push.size || any(greaterThan(at, last))) {
                continue;
            }
            vec2 kept = vec2(1.0);
            if (push.multiplies != 0u) {
                kept = unpackUnorm2x16(imageLoad(occlusion_image, ivec2(at)).r);
            }
            kept.y = min(kept.y, masu_sane(ambient[k], 0.0, 1.0));
            MASU_STORE_UINT(occlusion_image, at, uvec4(packUnorm2x16(kept)));
        }
    }
    masu_count_end();
}
