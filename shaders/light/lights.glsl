/*
 * lights.glsl: punctual lights, point and spot: what reaches a surface point of one of them, and which
 * of them a pixel has to ask. With MASU_LOCAL_SHADOWS, as far as nothing is in between (light/local_shadow.glsl).
 *
 *   reaches = color * window * cone / max(d^2, radius^2)
 *   window  = 1 - (d / range)^4, 0 from the range on: an inverse square that ends, so that a light
 *             is culled beyond its range
 *   cone    = t^2, t = (cos(a) - cos(outer)) / (cos(inner) - cos(outer)) clamped to 0..1. Of the
 *             angle a to the axis its versine 1 - cos(a) = |l + axis|^2 / 2 is compared: cosines of
 *             narrow cones have no digits left. Window and cone are those of glTF's
 *             KHR_lights_punctual
 *   color   is radiant intensity / pi, as the sun's is irradiance / pi: a white matt surface that
 *             faces the light at distance d has the radiance color / d^2
 *
 * A tile's list (light_tiles.comp) leaves out only lights for which masu_light_reaches is false at
 * every surface of the tile, and lists rise: a sum over the list has the same bits as one over all.
 * Needs globals.glsl before it. Everything is finite for any bits.
 */
#ifndef MASU_LIGHTS_GLSL
#define MASU_LIGHTS_GLSL

#include "shared/lights.h"
#include "shared/guard.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LIGHTS, std430) readonly buffer Lights
{
    uvec4 masu_lights_header; /* x lights in view, y words of a tile's list, z 1 / texels of the atlas, float bits */
    masu_punctual_light_data masu_lights[];
};

/* Words: of each tile how many lights, or MASU_TILE_ALL, then their numbers. */
#ifdef MASU_LIGHT_TILES_WRITTEN
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LIGHT_TILES, std430) writeonly buffer LightTiles
#else
layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LIGHT_TILES, std430) readonly buffer LightTiles
#endif
{
    uint masu_light_tiles[];
};

uint masu_light_count()
{
    return min(masu_lights_header.x, uint(MASU_LOCAL_LIGHTS_MAX));
}

/* First word of the list of the tile that a pixel lies in. */
uint masu_light_list(uvec2 tile, uvec2 size)
{
    uint columns = (size.x + uint(MASU_TILE) - 1u) / uint(MASU_TILE);
    return (tile.y * columns + tile.x) * masu_lights_header.y;
}

#ifndef MASU_LIGHT_TILES_WRITTEN
/* Which lights a pixel asks: those of its tile's list, or all of them: the same operations in the same order on the
 * lights that reach it. */
struct masu_asked {
    uint count;
    uint list;
    bool all_lights;
};

masu_asked masu_lights_asked(uvec2 at, uvec2 size, bool by_tiles)
{
    uint list = masu_light_list(at / uint(MASU_TILE), size);
    uint listed = by_tiles ? masu_light_tiles[list] : MASU_TILE_ALL;
    bool all_lights = listed == MASU_TILE_ALL;
    return masu_asked(all_lights ? masu_light_count() : min(listed, uint(MASU_TILE_LIGHTS_MAX)), list, all_lights);
}

/* The i-th of them. */
uint masu_light_asked(masu_asked asked, uint i)
{
    return asked.all_lights ? i : min(masu_light_tiles[asked.list + 1u + i], uint(MASU_LOCAL_LIGHTS_MAX) - 1u);
}
#endif

/* View depth of what the depth image says; all passes ask here, so that they agree. */
float masu_light_depth(float depth)
{
    precise float z = frame.forward.w * masu_rcp(depth);
    return z;
}

/* l: unit vector towards the light. False: nothing arrives, and the other two are not to be used.
 * rel: the point, relative to the eye. */
bool masu_light_reaches(masu_punctual_light_data light, vec3 rel, out vec3 l, out vec3 color)
{
    vec3 to = light.position.xyz - rel;
    float squared = dot(to, to);
    float share = squared * light.position.w;
    l = vec3(0.0, 1.0, 0.0);
    color = vec3(0.0);
    if (!(share < 1.0)) {
        return false; /* NaN too */
    }
    l = to * masu_rsqrt(squared);
    vec3 chord = l + light.axis.xyz;
    float t = clamp((light.axis.w - 0.5 * dot(chord, chord)) * light.cone.x, 0.0, 1.0);
    float window = 1.0 - share * share;
    float strength = window * (t * t) / max(squared, light.color.w);
    color = light.color.rgb * strength;
    return strength > 0.0 && masu_finite(color);
}

#ifdef MASU_LOCAL_SHADOWS
#include "light/local_shadow.glsl"
#endif

#ifdef MASU_SHADE_GLSL
/* Adds what a light contributes at a surface point relative to the eye. n: the normal of the surface itself.
 * False: nothing arrives. */
bool masu_add_local_light(inout masu_lit lit, masu_surface s, masu_bsdf b, uint light, vec3 rel, vec3 n)
{
    vec3 l;
    vec3 color;
    bool reaches = masu_light_reaches(masu_lights[light], rel, l, color);
    if (reaches) {
#ifdef MASU_LOCAL_SHADOWS
        color *= masu_light_seen(masu_lights[light], rel, n);
#endif
        masu_add_light(lit, s, b, l, color);
    }
    return reaches;
}
#endif

#endif
