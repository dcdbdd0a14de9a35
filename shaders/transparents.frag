/*
 * transparents.frag: colour that a transparent surface adds to the lit image; alpha is the share of
 * the background that it removes. Blending: source + (1 - alpha) * destination.
 *
 * Light that passes because of the material's opacity is neither scattered nor mirrored, so opacity
 * does not weaken reflections: clear glass reflects like black glass and transmits what it does
 * not reflect. The alpha of a map is different: it is the share of the pixel that the surface
 * covers. Additive surfaces add their scattered light and remove nothing.
 *
 * Coloured glass (MASU_MAP_TINTED) transmits its base colour, but blending has one alpha for all
 * channels. So it is drawn an extra time before, by a multiplying pipeline (`tints`): it multiplies
 * the image by the hue, then alpha removes the loss of the brightest channel. Both sides of a ball
 * tint the image before either adds its light; the far side's light is tinted here. Fog between the
 * camera and the glass is tinted too.
 *
 * Rough glass shows a blurred copy of the lit image without transparent surfaces (masu_behind)
 * instead of the blended destination. Both sides of a closed object are assumed to be equally
 * rough.
 *
 * Glass with a thickness shows that copy at the point where the refracted ray leaves the volume
 * (refracted). Only front sides do; the far side is drawn as thin glass.
 *
 * A closed object is drawn twice, first its sides that face away from the camera, then those that
 * face it, so a ball is correct for any order of its triangles. The normals decide, not the
 * winding, which is wrong in some files and inverted by negative scales. Each fragment is drawn
 * once.
 *
 * The depth image has the depths of polygons and the SDF; there is no depth attachment.
 * Permutations: MASU_TEXTURES: the material's maps; MASU_SUN_MAP: the sun's shadow map;
 * MASU_LIGHTS: point and spot lights by the tiles' lists, which then begin at the near plane
 * (light_tiles.comp). Lights use the position from the depth, as the lists do: interpolation across
 * a large triangle is less exact. MASU_LOCAL_SHADOWS: shadows of these lights, with four taps; nine
 * need 16 more registers.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_SURFACE /* any material may have a coat */
#include "push/transparents.h"
#define MASU_MAPS_TINTS
#include "shared/materials.h"
#include "shared/globals.glsl"
#include "shared/facing.glsl"
#include "shared/pack.glsl"
#include "shared/look.glsl"
#include "light/air.glsl"
#include "light/background.glsl"
#include "light/shade.glsl"

#ifdef MASU_SUN_MAP
#define MASU_AT_SUN_MAP 1
#include "light/sun_map.glsl"
#define MASU_AT_LOCAL_SHADOWS 2
#else
#define MASU_AT_LOCAL_SHADOWS 1
#endif
#ifdef MASU_LIGHTS
#define MASU_LOCAL_SHADOWS_FOUR
#define MASU_LIGHTS_APART
#include "light/lights.glsl"
#endif

layout(constant_id = 0) const bool tints = false;
layout(constant_id = 12) const uint tinted_glass = 0u; /* MASU_TINTS_*; 0: no tinted glass */
const bool any_tints = tinted_glass != 0u;
const bool any_rough = (tinted_glass & MASU_TINTS_ROUGH) != 0u;
const bool any_refracted = (tinted_glass & MASU_TINTS_REFRACTED) != 0u;
layout(constant_id = 23) const bool masu_live_maps = false;
layout(constant_id = 2) const bool foggy = false; /* the scene has fog */

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D depth_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_MATERIALS, std430) readonly buffer Materials
{
    masu_material_data materials[];
};

#ifdef MASU_LOCAL_SHADOWS
#define MASU_AT_BACKGROUND (MASU_AT_LOCAL_SHADOWS + 1)
#else
#define MASU_AT_BACKGROUND MASU_AT_LOCAL_SHADOWS
#endif
/* Bound if any_rough or any_refracted. */
layout(set = MASU_SET_PASS, binding = MASU_AT_BACKGROUND) uniform sampler2D background_image;

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec3 in_rel;
/* Material, flags, layers; instance index, scale: transparents.vert. */
layout(location = 2) flat in uvec4 in_thing;

#ifdef MASU_TEXTURES
layout(location = 3) in vec2 in_texcoord;
layout(location = 4) flat in vec2 in_detail;
#ifdef MASU_ATTRIBUTES
layout(location = 5) in vec4 in_color;
#endif
#define MASU_MAPS_FLAGS in_thing.y
#define MASU_MAPS_LAYERS in_thing.z
#define MASU_MAPS_DETAIL in_detail
#define MASU_MAPS_LIVE
#include "shared/maps.glsl"
#endif

layout(location = 0) out vec4 out_color;

/* Sums of many layers must not exceed the range of half floats. */
const float brightest = 4096.0;

#ifdef MASU_LIGHTS
/* n: the geometric normal. */
void add_lights(inout masu_lit lit, masu_surface s, masu_bsdf b, vec3 n)
{
    uvec2 at = uvec2(gl_FragCoord.xy);
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    vec3 rel = masu_pixel_ray(at, size) * masu_light_depth(gl_FragCoord.z);
    masu_light_sum sum = masu_light_sum(lit.diffuse, lit.specular);
    masu_asked asked = masu_lights_asked(at / uint(MASU_TILE), size, push.light_tiles != 0u);
    for (uint i = 0u; i < uint(MASU_LOCAL_LIGHTS_MAX); i++) {
        if (i >= asked.count) {
            break;
        }
        masu_add_local_light(sum, s, b, masu_light_asked(asked, i), rel, n, vec3(0.0));
    }
    lit.diffuse = sum.light;
    lit.specular = sum.mirrored;
}
#endif

const uint largest = any_refracted ? 0u : 1u; /* level of the background */

/* One level of the background around a pixel; in alpha masu_background_depth. */
vec4 background_level(uint level, vec2 pixel)
{
    uvec2 tiles = masu_background_tiles(uvec2(pc.output_width, pc.output_height));
    vec2 size = vec2(tiles * (MASU_BACKGROUND_TILE >> level));
    vec2 at = clamp(pixel / float(1u << level), vec2(0.5), size - 0.5);
    vec2 whole = vec2(textureSize(background_image, 0));
    return textureLod(background_image,
                      (vec2(masu_background_at(level, largest, tiles)) + at) / whole, 0.0);
}

vec4 background(vec2 pixel, float apart)
{
    float level = clamp(masu_log2(max(apart, 1.0)), float(largest), float(MASU_BACKGROUND_LEVELS));
    uint low = min(uint(level), MASU_BACKGROUND_LEVELS - 1u);
    return mix(background_level(low, pixel), background_level(low + 1u, pixel), level - float(low));
}

/* Background through glass with two equal sides whose lobe has this alpha: each ray leaves like its
 * reflection by a facet, on the other side (KHR_materials_transmission). A facet of slope
 * t = alpha sqrt(u / (1 - u)) deflects a ray by twice its angle; the gap behind the glass converts
 * this to pixels. TAPS rays with evenly spaced u on a spiral each sample the level whose texel
 * spacing is that of the taps. The gap is averaged: a blur radius that follows the depth per pixel
 * would show edges. radius: of the circle that half of the rays hit, in pixels. */
#define TAPS 12
const float spread = 2.0 * 0.7 * 0.5117; /* 0.7 sqrt(pi / TAPS): larger values blur twice */
vec3 masu_behind(vec2 pixel, float alpha, out float radius)
{
    float reach = 0.5 * float(pc.output_height) * masu_rcp(length(frame.up.xyz)), gap = 1.0;
    for (int i = 0; i < 2; i++) {
        float depth = masu_background_depth(background(pixel, 2.0 * alpha * reach * gap).a);
        gap = masu_sane(1.0 - depth * masu_rcp(gl_FragCoord.z), 0.0, 1.0);
    }
    reach *= gap;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < TAPS; i++) {
        float u = (float(i) + 0.5) / float(TAPS);
        float t = alpha * sqrt(u / (1.0 - u));
        float bent = 2.0 * t / (1.0 + t * t);
        float turn = float(i) * 2.39996323;
        float apart = spread * reach * alpha / ((1.0 - u) * (1.0 + t * t));
        sum += background(pixel + reach * bent * vec2(cos(turn), sin(turn)), apart).rgb;
    }
    radius = reach * 2.0 * alpha;
    return sum / float(TAPS);
}

/* The pixel at which the refracted ray leaves a volume (KHR_materials_volume). This fragment's
 * pixel if a surface in front of the glass covers that one, or if the exit is behind the camera.
 * The offset is added to the clip position of the fragment's pixel, so that a thickness of 0
 * changes nothing. volume: thickness, -index of refraction. */
vec2 refracted(vec3 direction, vec3 n, vec2 volume)
{
    vec2 size = vec2(pc.output_width, pc.output_height);
    vec3 inside = refract(direction, n, -masu_rcp(volume.y)) *
                  (volume.x * unpackHalf2x16(in_thing.w).y);
    vec4 offset = frame.clip_from_rel * vec4(inside, 0.0);
    float w = frame.forward.w * masu_rcp(gl_FragCoord.z);
    vec2 ndc = ((gl_FragCoord.xy / size * 2.0 - 1.0) * w + offset.xy) * masu_rcp(w + offset.w);
    vec2 at = vec2(masu_sane(ndc.x, -1.0, 1.0), masu_sane(ndc.y, -1.0, 1.0)) * 0.5 + 0.5;
    vec2 pixel = clamp(at * size, vec2(0.5), size - 0.5);
    bool behind = texelFetch(depth_image, ivec2(pixel), 0).r <= gl_FragCoord.z;
    return behind && w + offset.w > 0.0 ? pixel : gl_FragCoord.xy;
}

void main()
{
    masu_material_data m = materials[in_thing.x];
    masu_surface s = masu_plain_surface(m.base_color.rgb, m.base_color.w);
    s.emissive = m.emissive.rgb;
    s.metallic = m.emissive.w;
    bool refracts = any_refracted && m.emissive.w < 0.0;
    if (refracts) {
        s.metallic = 0.0;
    }
    masu_take_specular(s, m.more.x);
    s.coat = m.more.y;
    s.coat_roughness = m.more.z;
    float opacity = masu_live_maps ? m.more.w - 2.0 * floor(0.5 * m.more.w) : m.more.w;
    float cover = 1.0;
    vec3 direction = masu_normalize(in_rel, frame.forward.xyz);
    vec3 n = masu_normalize(in_normal, -direction);
    bool away = masu_seen_from_below(n, in_rel);
#ifdef MASU_LIGHTS
    vec3 skin = n;
#endif
    bool twice = (in_thing.y & MASU_MAP_FAR_SIDE_FIRST) != 0u;
    bool first = (any_refracted ? in_thing.w & 1u : in_thing.w) == 0u;
    bool elsewhere = twice && away != first;
#ifdef MASU_TEXTURES
    /* Derivatives must precede the discard. */
    cover = masu_sample_maps(in_texcoord, floor(0.5 * m.more.w), s);
    if ((tinted_glass & MASU_TINTS_MAPPED) != 0u && (in_thing.y & MASU_MAP_TRANSMISSION) != 0u) {
        opacity = 1.0 - (1.0 - opacity) * cover;
        cover = 1.0;
    }
#ifdef MASU_ATTRIBUTES
    masu_tint(s, in_color.rgb);
    cover *= in_color.a;
#endif
    vec3 bent = masu_bend_normal(in_normal, in_rel, in_texcoord);
    vec3 even = masu_normalize(masu_lean_to_eye(away ? -n : n, in_rel, 0.0), n);
    n = masu_normalize(masu_seen_normal(away ? -bent : bent, in_rel, n), -direction);
    if (masu_own_coats && s.coat > 0.0 &&
        (in_thing.y & (MASU_MAP_COAT_SMOOTH | MASU_MAP_BASE_SMOOTH)) != 0u) {
        bool coat_is_even = (in_thing.y & MASU_MAP_COAT_SMOOTH) != 0u;
        vec3 below = coat_is_even ? n : even;
        n = coat_is_even ? even : n;
        s.lean = masu_lean_of(n, below);
    }
#else
    n = masu_normalize(masu_lean_to_eye(away ? -n : n, in_rel, 0.0), -direction);
#endif
    masu_take_look(s);
    cover *= 1.0 - masu_fade();
    float nearest = texelFetch(depth_image, ivec2(gl_FragCoord.xy), 0).r;
    bool back = (in_thing.y & MASU_MAP_SINGLE) != 0u && !gl_FrontFacing;
    if (elsewhere || back || !(gl_FragCoord.z >= nearest)) {
        discard;
    }
    vec3 hue = vec3(1.0); /* of transmitted light; its brightest channel is 1 */
    float through = 1.0 - opacity;
    if (any_tints && (in_thing.y & MASU_MAP_TINTED) != 0u) {
        vec3 base = masu_sane(s.albedo, 0.0, 1.0);
        float most = masu_brightest(base);
        hue = base / max(most, 1e-6);
        through *= most;
    }
    if (tints) {
        out_color = vec4(mix(vec3(1.0), hue, masu_sane(cover, 0.0, 1.0)), 1.0);
        return;
    }
    vec2 seen = vec2(1.0);
#ifdef MASU_SUN_MAP
    if (masu_finite(in_rel) && dot(n, frame.sun_direction.xyz) > 0.0) {
        seen.x = masu_sun_seen(in_rel, n, dot(in_rel, frame.forward.xyz));
    }
#endif
    bool additive = (in_thing.y & MASU_MAP_ADDITIVE) != 0u;
    vec3 color, behind = vec3(0.0);
    float taken = opacity, surface = opacity; /* opacity with and without the blur */
    if (masu_is_unlit(s)) {
        color = s.emissive * opacity;
    } else {
        masu_around around = masu_ambient_at(in_rel, masu_base_normal(s, n));
        masu_mirrored sky = masu_mirrored_sky(s, n, -direction, vec2(1.0));
        masu_bsdf b = masu_bsdf_make(s, n, -direction);
        masu_lit lit = masu_shade(s, b, around, seen, sky);
        float mirrored = clamp(dot(lit.mirror, vec3(1.0 / 3.0)), 0.0, 1.0);
        surface = taken = 1.0 - through * (1.0 - mirrored);
        bool rough = any_rough && (in_thing.y & MASU_MAP_TINTED) != 0u &&
                     s.roughness > MASU_SHARP_GLASS;
        refracts = refracts && !away;
        if (rough || refracts) {
            vec2 pixel = gl_FragCoord.xy;
            float shown = 0.0; /* share of the background that is drawn here instead of blended */
            if (refracts) {
                pixel = refracted(direction, n, unpackHalf2x16(floatBitsToUint(m.emissive.w)));
                behind = background_level(0u, pixel).rgb;
                shown = 1.0;
            }
            if (rough) {
                float alpha = masu_sane(s.roughness * s.roughness, 0.0, 1.0) *
                              (twice ? 1.41421356 : 1.0);
                float radius;
                vec3 blurred = masu_behind(pixel, alpha, radius);
                float share = smoothstep(1.0, 3.0, radius); /* finest level: may be half size */
                behind = refracts ? mix(behind, blurred, share) : blurred * share;
                shown = max(shown, share);
            }
            vec3 passes = hue * (1.0 - taken);
            bool both = twice && (in_thing.y & MASU_MAP_SINGLE) == 0u; /* both sides are drawn */
            behind *= (both ? passes * passes : passes) * cover;
            taken = 1.0 - (1.0 - taken) * (1.0 - shown);
        }
        lit.diffuse += s.emissive;
#ifdef MASU_LIGHTS
        /* Last, when few values are live: fewer registers in the loop. */
        add_lights(lit, s, b, away ? -skin : skin);
#endif
        color = lit.diffuse * opacity + (additive ? vec3(0.0) : lit.specular);
    }
    color *= cover;
    if (any_tints && twice && away) {
        color *= hue;
    }
    taken = additive ? 0.0 : taken * cover;
    if (foggy) {
        float own = additive ? 0.0 : surface * cover;
        color = masu_through_air(color, direction, masu_air_depth(direction, length(in_rel)), own);
    }
    color += behind; /* contains the fog in front of it */
    out_color = vec4(masu_sane(color, 0.0, brightest), masu_sane(taken, 0.0, 1.0));
}
