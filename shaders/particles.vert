/*
 * particles.vert: six vertices of a quad that faces the eye, of MASU_BIND_SPRITES: masu_shared.h has its layout,
 * src/frame/particles.c writes it anew for each frame, sorted. All of a quad has the view depth of its middle. With
 * MASU_SUN_MAP the sun's shadow map is looked at there, too, and with MASU_LIGHTS all points and spots in view: once for
 * each vertex, where each pixel of each of many layers would do so.
 *
 * Light is scattered evenly by what is thin. Irradiance of a light from l, its mean over all n of max(n.l, 0), is a
 * quarter of what a facing surface gets: a sun of irradiance pi * sun_color leaves a quarter of sun_color.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/particles.h"
#include "shared/sprites.h"
#include "shared/types.h"
#include "shared/globals.glsl"
#include "shared/guard.glsl"
#ifdef MASU_SUN_MAP
#define MASU_AT_SUN_MAP 1
#include "light/sun_map.glsl"
#define MASU_AT_LOCAL_SHADOWS 2
#else
#define MASU_AT_LOCAL_SHADOWS 1
#endif
#ifdef MASU_LIGHTS
#include "light/lights.glsl"
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SPRITES, std430) readonly buffer Sprites
{
    vec4 sprites[];
};

#ifdef MASU_LIGHTS
/* What a facing white surface would send of all of them; of a rectangle or a capsule as of a sphere that looks as large. */
vec3 light_at(vec3 rel)
{
    vec3 sum = vec3(0.0);
    uint lights = masu_light_count();
    for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX); i++) {
        if (i >= lights) {
            break;
        }
        vec3 l;
        vec3 color;
        if (masu_light_reaches(masu_lights[i], rel, l, color)) {
            if (masu_area_lights && masu_light_kind(masu_lights[i]) != MASU_KIND_POINT) {
                color *= masu_light_size(masu_lights[i], masu_lights[i].position.xyz - rel);
            }
#ifdef MASU_LOCAL_SHADOWS
            color *= masu_light_seen(masu_lights[i], rel, l);
#endif
            sum += color;
        }
    }
    return sum;
}
#endif

layout(location = 0) out vec2 out_place; /* in the quad, -1..1 */
layout(location = 1) out vec3 out_rel;
layout(location = 2) flat out vec4 out_color; /* light that it sends; opacity */
layout(location = 3) flat out vec4 out_more;  /* edge, 1 or 0: it hides or adds; view depth; m over which it is soft */

void main()
{
    uint at = push.first + uint(MASU_PARTICLE_VEC4S) * (uint(gl_VertexIndex) / 6u);
    uint k = uint(gl_VertexIndex) % 6u;
    uint corner = k < 3u ? k : 6u - k; /* 0 1 2, 3 2 1 */
    vec4 middle = sprites[at], shape = sprites[at + 1u], color = sprites[at + 2u], more = sprites[at + 3u];
    uint flags = floatBitsToUint(more.x);
    vec2 place = vec2((corner & 1u) != 0u ? 1.0 : -1.0, corner > 1u ? 1.0 : -1.0);
    vec2 flat_place = place * shape.xy;
    vec2 turned = vec2(shape.z * flat_place.x - shape.w * flat_place.y,
                       shape.w * flat_place.x + shape.z * flat_place.y);
    vec3 right = frame.right.xyz / max(frame.right.w, masu_tiny);
    vec3 up = frame.up.xyz / max(frame.up.w, masu_tiny);
    vec3 rel = middle.xyz + right * turned.x + up * turned.y;
    float depth = dot(middle.xyz, frame.forward.xyz);
    vec3 light = vec3(1.0);
    if ((flags & MASU_SPRITE_LIT) != 0u) {
        float seen = 1.0;
#ifdef MASU_SUN_MAP
        seen = masu_sun_seen(middle.xyz, frame.sun_direction.xyz, depth);
#endif
        light = frame.sun_color.rgb * (0.25 * seen) + frame.ambient.rgb;
#ifdef MASU_LIGHTS
        light += 0.25 * light_at(middle.xyz);
#endif
    }
    out_place = place;
    out_rel = rel;
    out_color = vec4(color.rgb * light, color.w);
    out_more = vec4(more.y, (flags & MASU_SPRITE_ADDITIVE) != 0u ? 0.0 : 1.0, depth, middle.w);
    gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
}
