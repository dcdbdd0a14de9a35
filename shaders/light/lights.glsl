/*
 * lights.glsl: local lights: points and spots (spheres of their radius), capsules and rectangles:
 * the light that one emits to a surface point, and the list of lights of a pixel. With
 * MASU_LOCAL_SHADOWS including their shadows (light/local_shadow.glsl). Specular light of area
 * lights: light/source.glsl.
 *
 *   light  = color * window * cone / max(d^2, radius^2)
 *   window = 1 - (d / range)^4, 0 from the range on: an inverse square that ends, so that a light
 *            can be culled beyond its range
 *   cone   = t^2, t = (cos(a) - cos(outer)) / (cos(inner) - cos(outer)) clamped to 0..1. Computed
 *            from the versine of the angle a to the axis, 1 - cos(a) = |l + axis|^2 / 2: cosines of
 *            narrow cones have no digits left. Window and cone are defined by
 *            glTF's KHR_lights_punctual
 *   color  is radiant intensity / pi for points and spots, like irradiance / pi for the sun: a
 *            white diffuse surface that faces the light at distance d has the radiance
 *            color / d^2. For capsules and rectangles it is radiance; window and range are
 *            measured from the centre
 *
 * The list of a tile (light_tiles.comp) omits only lights for which masu_light_reaches is false at
 * every surface of the tile, and lists rise: a sum over the list has the same bits as one over all
 * lights. Needs globals.glsl before it. Every result is finite for any input bits.
 */
#ifndef MASU_LIGHTS_GLSL
#define MASU_LIGHTS_GLSL

#include "shared/lights.h"
#include "shared/guard.glsl"
#include "shared/sdf_limits.h"

/* The scene may have rectangles and capsules. */
#ifdef MASU_AREA_LIGHTS
const bool masu_area_lights = true;
#else
layout(constant_id = 17) const bool masu_area_lights = false;
#endif

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_LIGHTS, std430) readonly buffer Lights
{
    uvec4 masu_lights_header; /* x: lights in view, y: uints per tile list; as float bits: z: 1 /
                               * atlas size in texels, w: a step of the camera's subpixel grid at
                               * distance 1, m */
    masu_punctual_light_data masu_lights[];
};

/* Per tile: the number of lights, or MASU_TILE_ALL, then their indices. */
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

/* Offset of the list of a tile. */
uint masu_light_list(uvec2 tile, uvec2 size)
{
    uint columns = (size.x + uint(MASU_TILE) - 1u) / uint(MASU_TILE);
    return (tile.y * columns + tile.x) * masu_lights_header.y;
}

#ifndef MASU_LIGHT_TILES_WRITTEN
/* The lights that a pixel of a tile evaluates: the list of the tile, or all lights. The operations
 * on the lights that reach the pixel, and their order, are the same. */
struct masu_asked {
    uint count;
    uint list; /* MASU_TILE_ALL: all lights */
};

masu_asked masu_lights_asked(uvec2 tile, uvec2 size, bool by_tiles)
{
    uint list = masu_light_list(tile, size);
    uint listed = by_tiles ? masu_light_tiles[list] : MASU_TILE_ALL;
    return listed == MASU_TILE_ALL ? masu_asked(masu_light_count(), MASU_TILE_ALL)
                                   : masu_asked(min(listed, uint(MASU_TILE_LIGHTS_MAX)), list);
}

/* Index of the i-th light. */
uint masu_light_asked(masu_asked asked, uint i)
{
    return asked.list == MASU_TILE_ALL
               ? i
               : min(masu_light_tiles[asked.list + 1u + i], uint(MASU_LOCAL_LIGHTS_MAX) - 1u);
}
#endif

/* View depth of a value of the depth buffer; all passes call this, so that they agree. */
float masu_light_depth(float depth)
{
    precise float z = frame.forward.w * masu_rcp(depth);
    return z;
}

const uint MASU_KIND_POINT = 0u;
const uint MASU_KIND_CAPSULE = 1u;
const uint MASU_KIND_RECTANGLE = 2u;

uint masu_light_kind(masu_punctual_light_data light)
{
    return uint(clamp(light.cone.w, 0.0, 7.0)) & 3u;
}

/* Whether the light's surface is also part of the scene, where rays may hit it. */
bool masu_light_is_shared(masu_punctual_light_data light)
{
    return (uint(clamp(light.cone.w, 0.0, 7.0)) & uint(MASU_LIGHT_SHARED)) != 0u;
}

/* l: unit vector towards the centre of the light. strength: factor of the light's colour:
 * irradiance / pi on a surface that faces a point or spot, radiance for other kinds. False: no
 * light arrives; l and strength are not to be used. rel: the point, relative to the camera. */
bool masu_light_arrives(masu_punctual_light_data light, vec3 rel, out vec3 l, out float strength)
{
    vec3 to = light.position.xyz - rel;
    float squared = dot(to, to);
    float share = squared * light.position.w;
    l = vec3(0.0, 1.0, 0.0);
    strength = 0.0;
    if (!(share < 1.0)) {
        return false; /* or NaN */
    }
    l = to * masu_rsqrt(squared);
    vec3 chord = l + light.axis.xyz;
    float t = clamp((light.axis.w - 0.5 * dot(chord, chord)) * light.cone.x, 0.0, 1.0);
    float window = 1.0 - share * share;
    strength = window * (t * t) / max(squared, light.color.w);
    if (masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT) {
        strength = window;
    }
    return strength > 0.0 &&
           masu_finite((abs(light.color.r) + abs(light.color.g) + abs(light.color.b)) * strength);
}

/* masu_light_arrives(), times the colour. */
bool masu_light_reaches(masu_punctual_light_data light, vec3 rel, out vec3 l, out vec3 color)
{
    float strength;
    bool arrives = masu_light_arrives(light, rel, l, strength);
    color = light.color.rgb * strength;
    return arrives;
}

vec3 masu_unit(vec3 v)
{
    return v * masu_rsqrt_sure(max(dot(v, v), 1e-30));
}

/* Half axes of a rectangle, or of the rectangle that stands for a capsule at a point; `to`: from
 * the point to the centre. The sign of v makes the side that faces the point the front. False: a
 * one-sided rectangle faces away. */
bool masu_light_axes(masu_punctual_light_data light, vec3 to, out vec3 u, out vec3 v)
{
    u = light.axis.xyz;
    v = light.cone.xyz;
    if (masu_light_kind(light) == MASU_KIND_CAPSULE) {
        float radius = masu_sqrt(light.color.w);
        v = masu_unit(cross(to, u)) * radius;
        u += masu_unit(cross(v, to)) * (0.78539816 * radius);
    }
    bool behind = dot(cross(u, v), to) > 0.0;
    v = behind ? -v : v;
    return !behind || light.color.w > 0.0;
}

/* Angular size of a light, as the squared sine of a sphere's angular radius. u, v: from
 * masu_light_axes(). */
float masu_light_size(masu_punctual_light_data light, vec3 to, vec3 u, vec3 v)
{
    float squared = max(dot(to, to), masu_tiny), area = light.color.w;
    if (masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT) {
        area = 1.2732395 * abs(dot(cross(u, v), to)) * masu_rsqrt_sure(squared); /* 4 / pi */
    }
    return min(area / squared, 0.9999);
}

#ifdef MASU_LOCAL_SHADOWS
#include "light/local_shadow.glsl"
#endif

#ifdef MASU_SHADE_GLSL
#include "light/source.glsl"

/* The specular light of some area lights is split between rays that hit them and the analytic
 * lobe. */
layout(constant_id = 18) const bool masu_shared_lights = false;

/* Squared distance between a point, relative to the camera, and the core of a light that has a
 * surface in the scene: below 1 within the baker's fit plus a rounding margin. */
float masu_light_within(masu_punctual_light_data light, vec3 rel)
{
    vec3 from = rel - light.position.xyz;
    float radius2 = light.color.w;
    if (masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT) {
        vec3 u = light.axis.xyz, v = light.cone.xyz;
        from -= u * clamp(dot(from, u) * masu_rcp(dot(u, u)), -1.0, 1.0);
        if (masu_light_kind(light) == MASU_KIND_RECTANGLE) {
            from -= v * clamp(dot(from, v) * masu_rcp(dot(v, v)), -1.0, 1.0);
            radius2 = light.axis.w * light.axis.w;
        }
    }
    return dot(from, from) * masu_rcp(1.1 * radius2 + 1e-7);
}

/* Height of a light above the horizon plane of the point, before horizon clipping: at 0 or less it
 * lights nothing. to: the centre of the light. */
float masu_light_height(masu_punctual_light_data light, vec3 to, vec3 n)
{
    uint kind = masu_area_lights ? masu_light_kind(light) : MASU_KIND_POINT;
    float height = dot(n, to) + (kind == MASU_KIND_RECTANGLE ? abs(dot(n, light.cone.xyz))
                                                             : masu_sqrt(light.color.w));
    return kind == MASU_KIND_POINT ? height : height + abs(dot(n, light.axis.xyz));
}

/* A sum over lights: diffuse and specular together, which takes fewer registers, unless
 * MASU_LIGHTS_APART is defined. */
struct masu_light_sum {
    vec3 light; /* or only the diffuse and transmitted light, */
#ifdef MASU_LIGHTS_APART
    vec3 mirrored;
#endif
};

void masu_sum_mirrored(inout masu_light_sum sum, vec3 mirrored)
{
#ifdef MASU_LIGHTS_APART
    sum.mirrored += mirrored;
#else
    sum.light += mirrored;
#endif
}

/* Adds the light of one local light at a surface point relative to the camera. n: the normal of the
 * surface itself; traced: share of the specular light of base and coat that is traced; z: 1 if rays
 * find everything they can hit, 0 if they share it with the lobe. False: no light arrives.
 *
 * Shadows come first: they keep only one value alive, and a point in shadow skips the rest. */
#ifdef MASU_SHELVED
bool masu_add_local_light(inout masu_light_sum sum, masu_surface s, masu_bsdf b,
                          masu_shelved_bsdf shelf, uint number, vec3 rel, vec3 n, vec3 traced)
#else
bool masu_add_local_light(inout masu_light_sum sum, masu_surface s, masu_bsdf b, uint number,
                          vec3 rel, vec3 n, vec3 traced)
#endif
{
    masu_punctual_light_data light = masu_lights[number];
    vec3 l;
    float strength;
    if (!masu_light_arrives(light, rel, l, strength)) {
        return false;
    }
    vec3 to = light.position.xyz - rel;
    float height = masu_light_height(light, to, b.n);
#ifdef MASU_SURFACE
    if (masu_own_coats) {
        height = max(height, masu_light_height(light, to, b.coat_n));
    }
#endif
    if (!(height > 0.0)) {
        return false;
    }
#ifdef MASU_LOCAL_SHADOWS
    strength *= masu_light_seen(light, rel, n);
    if (!(strength > 0.0)) {
        return false;
    }
    /* Recomputed, in another form so that the compiler does not merge them: kept alive, they would
     * take six registers during the atlas reads. */
    if (masu_few_registers) {
        /* the same light; compilers must not see that */
        light = masu_lights[min(number, masu_light_count() - 1u)];
    }
    to = -(rel - light.position.xyz);
    l = to * masu_rsqrt(dot(to, to));
#endif
    vec3 u = vec3(0.0), v = vec3(0.0);
    bool area = masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT;
    if (area && !masu_light_axes(light, to, u, v)) {
        return false;
    }
    float size = masu_light_size(light, to, u, v);
    vec2 kept = vec2(1.0);
    if (masu_shared_lights && masu_light_is_shared(light)) {
        if (masu_light_within(light, rel) < 1.0) {
            return false; /* the light's surface itself */
        }
#ifdef MASU_SURFACE
        bool any_traced = traced.x + traced.y > 0.0;
#else
        bool any_traced = traced.x > 0.0;
#endif
        if (any_traced) {
            kept -= traced.xy * max(masu_ray_shares(s, b, l, size), traced.z);
        }
    }
    vec3 form = vec3(0.0);
    if (area) {
        form = masu_rectangle(b, to, u, v);
        if (masu_few_registers) {
            light = masu_lights[min(number, masu_lights_header.x)]; /* as above */
            to = -(rel - light.position.xyz);
            l = to * masu_rsqrt(dot(to, to));
        }
    }
#ifdef MASU_SHELVED
    masu_unshelve(shelf, b);
#endif
    vec3 color = light.color.rgb * strength;
    bool directed = true;
    if (area) {
        vec3 mirrored = color *
                        masu_sane(masu_bsdf_specular(b) * (form.y * kept.x), 0.0, masu_huge);
#ifdef MASU_SURFACE
        mirrored *= s.shadow >= 0.0 ? masu_meso_shadow(s.shadow, b.v, l) : 1.0;
#endif
        masu_sum_mirrored(sum, mirrored);
#ifdef MASU_SURFACE
        directed = b.coat > 0.0 || s.shadow >= 0.0;
#else
        directed = b.f90 < 0.0; /* always false; a constant would let the compiler keep more
                                 * registers */
#endif
        if (!directed) {
            /* Multiple scattering and diffuse light, which do not depend on the direction. */
            masu_albedo lit = masu_albedo_of(b, clamp(form.z, 0.01, 1.0), 0.0);
            color *= form.x;
            sum.light += color * masu_sane(b.diffuse * (1.0 - masu_matte(b, lit)), 0.0, masu_huge);
            masu_sum_mirrored(sum, color * masu_sane(b.rest * masu_lost(lit), 0.0, masu_huge));
        } else {
            masu_flatten(b, l, color, form, size, kept);
        }
    } else {
        masu_spread(b, l, color, size, kept);
    }
    if (directed) {
        masu_lit lit;
        lit.diffuse = vec3(0.0);
        lit.specular = vec3(0.0);
        masu_add_light(lit, s, b, l, color);
        sum.light += lit.diffuse;
        masu_sum_mirrored(sum, lit.specular);
    }
    return true;
}

/* Share of the emission at a ray's hit `met` that the surface at `rel` reflects: 1 unless the hit
 * is on a local light's surface. n, v, roughness: the lobe of the ray. */
float masu_met_share(vec3 met, vec3 rel, vec3 n, vec3 v, float roughness)
{
    uint lights = masu_light_count();
    float nearest = 1.0, share = 1.0;
    for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX); i++) {
        if (i >= lights) {
            break;
        }
        masu_punctual_light_data light = masu_lights[i];
        vec3 to = light.position.xyz - rel;
        float within = masu_light_is_shared(light) ? masu_light_within(light, met) : 1.0;
        float far = dot(to, to) * light.position.w;
        if (within < nearest && far < 1.0) {
            nearest = within;
            vec3 l = masu_normalize(to, n), half_u = vec3(0.0), half_v = vec3(0.0);
            if (masu_area_lights && masu_light_kind(light) != MASU_KIND_POINT) {
                masu_light_axes(light, to, half_u, half_v);
            }
            /* If the range window removes the analytic lobe, the rays take over; a slight dimming
             * is lost, which is not noise. */
            float dimmed = far * far;
            dimmed *= dimmed * (3.0 - 2.0 * dimmed);
            share = masu_ray_share(n, v, l, roughness, masu_light_size(light, to, half_u, half_v));
            share = 1.0 - (1.0 - share) * (1.0 - dimmed);
        }
    }
    return share;
}
#endif

#endif
