/*
 * decals.comp: paints the base colour, metallic and roughness of decal boxes into the G-buffer
 * before lighting. An indirect dispatch covers the part of the image that contains decals
 * (src/frame/decals.c). Each workgroup first finds the decals that may touch its 8x8 pixels, one
 * bit each. Each pixel with a surface then applies these in bit order, which is the order of the
 * frame's array. Paint is mixed in linear colour. Pixels that no decal touches are not written.
 *
 * Paint also covers emission. Surfaces that only emit (masu_is_unlit) remain unchanged.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/decals.h"
#include "shared/materials.h"
#include "shared/sprites.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;
#ifdef MASU_LIVE_TEXTURES
#include "shared/live_textures.glsl"
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2DArray textures_image;
#define FIRST_WRITE 2
#define DECAL_VEC4S MASU_TEXTURED_DECAL_VEC4S
#else
#define FIRST_WRITE 1
#define DECAL_VEC4S MASU_DECAL_VEC4S
#endif
layout(set = MASU_SET_PASS, binding = FIRST_WRITE, rgba8) uniform image2D albedo_image;
layout(set = MASU_SET_PASS, binding = FIRST_WRITE + 1, r32ui) uniform uimage2D normal_image;
/* Defined only at pixels that emit. */
layout(set = MASU_SET_PASS, binding = FIRST_WRITE + 2, rgba16f) uniform image2D hdr_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SPRITES, std430) readonly buffer Sprites
{
    vec4 sprites[];
};

#define INVOCATIONS (MASU_GROUP * MASU_GROUP)
#define WORDS (MASU_DECALS_MAX / 32)
shared uint touched[WORDS];

const float dielectric = 0.04; /* reflectance at normal incidence */

/* Weight of a decal at a point relative to the camera, for a surface with the normal n. */
float painted(uint at, vec3 rel, vec3 n, vec4 look)
{
    vec4 row0 = sprites[at], row1 = sprites[at + 1u], row2 = sprites[at + 2u],
         axis = sprites[at + 5u];
    vec4 place = sprites[at + 6u];
    vec3 p = vec3(dot(row0.xyz, rel) + row0.w, dot(row1.xyz, rel) + row1.w,
                  dot(row2.xyz, rel) + row2.w);
    bool round_one = (floatBitsToUint(look.w) & MASU_SPRITE_ROUND) != 0u;
    float far = round_one ? masu_sqrt(dot(p.xy, p.xy)) : max(abs(p.x), abs(p.y));
    float rest = 1.0 - far;
    if (!(rest >= 0.0 && abs(p.z) <= 1.0)) {
        return 0.0;
    }
    float edge = rest >= look.z ? 1.0 : rest / max(look.z, masu_tiny);
    return edge * clamp((dot(axis.xyz, n) - place.z) * place.w, 0.0, 1.0);
}

/* Mixes paint into a surface linearly in reflected light: diffuse albedo, a (1-m), and reflectance
 * at normal incidence, a m + 0.04 (1-m). Metallic is weighted by albedo, which mixes the diffuse
 * part exactly: black paint on metal remains metal until it is nearly black. The albedo absorbs the
 * remaining difference, so that the sum of both parts is exact. */
void cover(inout masu_surface s, vec3 paint, float metallic, float share)
{
    float own = (1.0 - share) * (masu_brightest(s.albedo) + 1.0 / 256.0);
    float other = share * (masu_brightest(paint) + 1.0 / 256.0);
    float before = mix(s.metallic, metallic, share);
    s.metallic = (s.metallic * own + metallic * other) / (own + other);
    s.albedo = mix(s.albedo, paint, share) + dielectric * (s.metallic - before);
    s.emissive *= 1.0 - share;
}

#ifdef MASU_LIVE_TEXTURES
/* Hit of a neighbouring pixel's ray on the plane of the surface, relative to the point; clamped at
 * grazing angles. */
vec3 to_neighbour(vec3 ray, vec3 rel, vec3 n)
{
    float away = dot(n, rel), towards = dot(n, ray);
    float far = abs(towards) > 0.02 * masu_sqrt(dot(ray, ray))
                    ? clamp(away / towards, 0.0, masu_huge)
                    : 0.0;
    return far > 0.0 ? ray * far - rel : vec3(0.0);
}

/* Colour and opacity of a decal at a point, times those of its texture. dx, dy: to neighbouring
 * pixels. */
vec4 textured(uint at, vec4 color, vec3 rel, vec3 dx, vec3 dy)
{
    uint number = floatBitsToUint(sprites[at + 8u].x);
    if (number == 0u) {
        return color;
    }
    vec4 row0 = sprites[at], row1 = sprites[at + 1u];
    vec2 p = vec2(dot(row0.xyz, rel) + row0.w, dot(row1.xyz, rel) + row1.w);
    vec2 px = vec2(dot(row0.xyz, dx), dot(row1.xyz, dx)),
         py = vec2(dot(row0.xyz, dy), dot(row1.xyz, dy));
    const vec2 half_box = vec2(0.5, -0.5);
    return color * masu_live_mean(textures_image, float(number) - 1.0, sprites[at + 7u],
                                  p * half_box + 0.5, px * half_box, py * half_box,
                                  MASU_LIVE_CLAMP);
}
#endif

void paint(ivec2 at, uvec2 size, uint words)
{
    float depth = texelFetch(depth_image, at, 0).r;
    if (!(depth > masu_tiny)) {
        return;
    }
    uint packed_normal = imageLoad(normal_image, at).r;
    if (masu_is_unlit_texel(packed_normal)) {
        return;
    }
    vec3 rel = masu_pixel_ray(uvec2(at), size) * (frame.forward.w / depth);
    vec3 n = masu_unpack_normal(packed_normal);
    masu_surface s = masu_unpack_look(imageLoad(albedo_image, at), packed_normal);
    if (!masu_emission_packed && masu_has_emission(packed_normal)) {
        s.emissive = imageLoad(hdr_image, at).rgb;
    }
#ifdef MASU_LIVE_TEXTURES
    vec3 dx = to_neighbour(masu_pixel_ray(uvec2(at) + uvec2(1u, 0u), size), rel, n);
    vec3 dy = to_neighbour(masu_pixel_ray(uvec2(at) + uvec2(0u, 1u), size), rel, n);
#endif
    bool changed = false;
    for (uint w = 0u; w < uint(WORDS); w++) {
        if (w >= words) {
            break;
        }
        uint left = touched[w];
        for (uint k = 0u; k < 32u && left != 0u; k++) {
            uint bit = uint(findLSB(left));
            left &= left - 1u;
            uint decal = push.first + uint(DECAL_VEC4S) * (32u * w + bit);
            vec4 color = sprites[decal + 3u], look = sprites[decal + 4u];
            float share = masu_sane(color.w * painted(decal, rel, n, look), 0.0, 1.0);
#ifdef MASU_LIVE_TEXTURES
            if (share > 0.0) {
                float opacity = max(color.w, masu_tiny);
                color = textured(decal, color, rel, dx, dy);
                share = masu_sane(share * (color.w / opacity), 0.0, 1.0);
            }
#endif
            if (share > 0.0) {
                changed = true;
                if ((floatBitsToUint(look.w) & MASU_SPRITE_KEEP_COLOR) == 0u) {
                    cover(s, color.rgb, look.y >= 0.0 ? look.y : s.metallic, share);
                }
#ifdef MASU_LIVE_TEXTURES
                s.emissive += color.rgb * (share * sprites[decal + 8u].y);
#endif
                s.roughness = mix(s.roughness, look.x >= 0.0 ? look.x : s.roughness, share);
            }
        }
    }
    if (changed) {
        /* The texel stores metallic in 16 steps. Soft edges would have rings if the albedo did not
         * correct for the rounding. */
        float steps = floor(masu_sane_unit(s.metallic) * 15.0 + 0.5) / 15.0;
        s.albedo += dielectric * (steps - s.metallic);
        s.metallic = steps;
        uint kept = packed_normal & (0x3FFFFFFu | MASU_SURFACE_MORE << 30);
        uint look;
        vec4 albedo;
        masu_pack_look(s, albedo, look);
        MASU_STORE_UNORM(albedo_image, at, albedo);
        MASU_STORE_UINT(normal_image, at, kept | look);
        if (!masu_emission_packed && masu_has_emission(look)) {
            MASU_STORE_HALF(hdr_image, at, vec4(masu_emitted(s), 1.0));
        }
    }
}

void main()
{
    masu_count_begin();
    uint count = min(floatBitsToUint(sprites[MASU_SPRITE_DISPATCH].w), uint(MASU_DECALS_MAX));
    uint words = (count + 31u) / 32u;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    uvec2 first = floatBitsToUint(sprites[MASU_SPRITE_PLACE].xy) +
                  uint(MASU_GROUP) * gl_WorkGroupID.xy;
    uvec2 last = first + uint(MASU_GROUP - 1);
    uint lane = gl_LocalInvocationIndex;
    if (lane < words) {
        touched[lane] = 0u;
    }
    barrier();
    for (uint k = 0u; k < uint(MASU_DECALS_MAX / INVOCATIONS); k++) {
        uint i = k * uint(INVOCATIONS) + lane;
        if (i >= count) {
            break;
        }
        uvec2 ends = floatBitsToUint(sprites[push.first + uint(DECAL_VEC4S) * i + 6u].xy);
        uvec2 low = uvec2(ends.x & 0xFFFFu, ends.x >> 16),
              high = uvec2(ends.y & 0xFFFFu, ends.y >> 16);
        if (all(lessThanEqual(low, last)) && all(greaterThanEqual(high, first))) {
            atomicOr(touched[i >> 5], 1u << (i & 31u));
        }
    }
    barrier();
    uvec2 at = first + gl_LocalInvocationID.xy;
    if (all(lessThan(at, size))) {
        paint(ivec2(at), size, words);
    }
    masu_count_end();
}
