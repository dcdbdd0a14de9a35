/*
 * particles.vert: six vertices of a quad that faces the camera, from MASU_BIND_SPRITES.
 * masu_shared.h has the layout; src/frame/particles.c writes the sprites for each frame, sorted.
 * All of a quad has the view depth of its centre. MASU_SUN_MAP samples the sun's shadow map there,
 * and MASU_LIGHTS evaluates all visible point and spot lights: once per vertex, instead of per
 * pixel of each of many layers.
 *
 * Thin media scatter light evenly. Irradiance of a light from l, the mean of max(n.l, 0) over all
 * n, is a quarter of that of a facing surface: a sun of irradiance pi * sun_color gives a quarter
 * of sun_color.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/particles.h"
#include "shared/sprites.h"
#include "shared/types.h"
#include "shared/globals.glsl"
#include "shared/guard.glsl"
#ifdef MASU_LIVE_TEXTURES
#define FIRST_MAP 2
#define PARTICLE_VEC4S MASU_TEXTURED_PARTICLE_VEC4S
#else
#define FIRST_MAP 1
#define PARTICLE_VEC4S MASU_PARTICLE_VEC4S
#endif
#ifdef MASU_SUN_MAP
#define MASU_AT_SUN_MAP FIRST_MAP
#include "light/sun_map.glsl"
#define MASU_AT_LOCAL_SHADOWS (FIRST_MAP + 1)
#else
#define MASU_AT_LOCAL_SHADOWS FIRST_MAP
#endif
#ifdef MASU_LIGHTS
#include "light/lights.glsl"
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SPRITES, std430) readonly buffer Sprites
{
    vec4 sprites[];
};

#ifdef MASU_LIGHTS
/* Radiance of a facing white surface in all lights. Rectangles and capsules are treated as spheres
 * of the same apparent size. */
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
                vec3 to = masu_lights[i].position.xyz - rel, u, v;
                bool facing = masu_light_axes(masu_lights[i], to, u, v);
                color *= facing ? masu_light_size(masu_lights[i], to, u, v) : 0.0;
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
#ifdef MASU_LIVE_TEXTURES
layout(location = 2) out vec4 out_color; /* radiance; opacity; not flat, for trails */
layout(location = 4) out vec2 out_at;    /* in the cell, 0..1; larger along a trail */
layout(location = 5) flat out vec4 out_cell;
/* First corner of the second cell, its share; texture, below 0 for a trail. */
layout(location = 6) flat out vec4 out_next;
#else
layout(location = 2) flat out vec4 out_color; /* radiance; opacity */
#endif
/* Edge; 1 blended or 0 additive; view depth; fade distance in m. */
layout(location = 3) flat out vec4 out_more;

void main()
{
    uint at = push.first + uint(PARTICLE_VEC4S) * (uint(gl_VertexIndex) / 6u);
    uint k = uint(gl_VertexIndex) % 6u;
    uint corner = k < 3u ? k : 6u - k; /* 0 1 2, 3 2 1 */
    vec4 middle = sprites[at], shape = sprites[at + 1u], color = sprites[at + 2u],
         more = sprites[at + 3u];
    uint flags = floatBitsToUint(more.x);
    vec2 place = vec2((corner & 1u) != 0u ? 1.0 : -1.0, corner > 1u ? 1.0 : -1.0);
    vec2 flat_place = place * shape.xy;
    vec2 turned = vec2(shape.z * flat_place.x - shape.w * flat_place.y,
                       shape.w * flat_place.x + shape.z * flat_place.y);
    vec3 right = frame.right.xyz / max(frame.right.w, masu_tiny);
    vec3 up = frame.up.xyz / max(frame.up.w, masu_tiny);
    vec3 rel = middle.xyz + right * turned.x + up * turned.y;
#ifdef MASU_LIVE_TEXTURES
    vec4 cell = sprites[at + 4u], next = sprites[at + 5u];
    float number = float(floatBitsToUint(more.z));
    out_at = vec2(0.5, -0.5) * place + 0.5;
    out_next = vec4(next.xy, more.w, number);
    if ((flags & MASU_SPRITE_SEGMENT) != 0u) {
        bool end = place.x > 0.0;
        vec4 far_side = sprites[at + 6u];
        middle.xyz = end ? shape.xyz : middle.xyz;
        rel = middle.xyz + (end ? far_side.xyz : next.xyz) * place.y;
        color = end ? sprites[at + 7u] : color;
        out_at.x = end ? more.y : shape.w;
        out_next = vec4(0.0, 0.0, 0.0, -number);
        more.y = next.w;
        place.x = 0.0;
    }
    /* Textured sprites have full opacity at any distance from the centre. */
    place = number > 0.0 ? vec2(0.0) : place;
    out_cell = cell;
#endif
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
