/*
 * ao_upsample.comp: upsamples ao.comp's half-resolution texels into the ambient half of the
 * occlusion image. Each pixel averages the 4x4 texels around it, because their pattern of
 * directions repeats every 4x4. A texel contributes if it is in the pixel's plane and has a similar
 * normal.
 *
 * One invocation filters the 2x2 pixels of a texel, which share the same 16 texels. The texels of a
 * workgroup are unpacked once, into shared memory.
 *
 * WEIGHTS. By the distance d of the texel's point from the pixel's plane: (1 - (d /
 * tolerance)^2)^2, and 0 beyond the tolerance, which is half a texel's width at that depth plus a
 * hundredth of the radius. Multiplied by the fourth power of the cosine between the normals.
 * Without the normals, edges between coplanar surfaces (a bolt on its flange) are blurred: the
 * motor's error was 0.078 instead of 0.049. If all 16 weights are about 0, the pixel takes the one
 * texel with the lowest cost (plane distance and angle).
 *
 * If all 16 texels are unoccluded up to quantisation (`open`), the pixel is unoccluded without
 * filtering. If the 16 differ by at most `even`, as in most of an image, the pixel takes their
 * plain mean: its difference from any weighted mean is less than `even`, and usually the texels
 * differ by the pattern only.
 *
 * If the SDF pass wrote its own ambient occlusion, the pixel takes the smaller of the two values. A
 * product would apply the occluders that both detect twice (docs/design/06-ambient-occlusion.md has
 * the errors).
 *
 * push.radius: radius, metres. push.multiplies: not 0 if the occlusion image already contains
 * occlusion. push.size: pixels per texel, 2, or 1 for comparison.
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

/* Along the ray through the pixel's centre, scaled to view z 1: masu_pixel_ray in separate
 * steps. */
vec3 ray_at(ao_lens lens, uvec2 pixel)
{
    vec2 ndc = masu_ndc(vec2(pixel) + 0.5, lens.size);
    return frame.forward.xyz + frame.right.xyz * ndc.x - frame.up.xyz * ndc.y;
}

/* Three steps of ao_texel.glsl's 1023, and rounding. */
const float open = 1.0 - 3.5 / 1023.0;

/* Largest difference between 16 texels that are averaged without plane tests. */
const float even = 0.125;

#define EDGE (MASU_GROUP + 3)

/* Texels of the workgroup and its border: position, visibility (below 0: no surface), and
 * normal. */
shared vec4 texels[EDGE * EDGE];
shared vec3 normals[EDGE * EDGE];

void load_texels(ao_lens lens, uvec2 last)
{
    ivec2 first = ivec2(gl_WorkGroupID.xy) * MASU_GROUP - 1;
    for (int i = 0; i < (EDGE * EDGE + MASU_GROUP * MASU_GROUP - 1) / (MASU_GROUP * MASU_GROUP);
         i++) {
        int n = i * MASU_GROUP * MASU_GROUP + int(gl_LocalInvocationIndex);
        int row = n * (65536 / EDGE + 1) >> 16; /* n / EDGE, exact for these n */
        ivec2 from = first + ivec2(n - row * EDGE, row);
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

/* Visibility of the four pixels of a texel, one per component, from the 16 texels that start at
 * `corner`. */
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
    /* A second pass over the texels, only for the few pixels that match none. */
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
        float lowest = 1.0; /* -1 if a texel is missing; `least` takes that one as 1 */
        float sum = 0.0;
        for (int i = 0; i < 16; i++) {
            float seen = texels[corner + uint((i >> 2) * EDGE + (i & 3))].w;
            lowest = min(lowest, seen);
            least = min(least, abs(seen));
            most = max(most, seen);
            sum += seen;
        }
        vec4 ambient = vec4(1.0);
        if (lowest >= 0.0 && most - least <= even) {
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
