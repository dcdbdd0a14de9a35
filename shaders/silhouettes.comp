/*
 * silhouettes.comp: anti-aliasing of SDF edges. Marches up to three more rays in each pixel that
 * contains an SDF edge. Compiled by masu-bake with the scene's field.
 *
 * A pixel's first sample is its centre. If the pixel or one of its four neighbours is closer than
 * the other's surface would be if it continued, or if two faces join, a second ray is marched on
 * that side. If its colour differs from the centre's, or there are edges on two opposite sides, two
 * more are marched.
 * For edges of any direction, the centre and three rays estimate the coverage with a root mean
 * square error of 0.10 pixels (0.25 with the centre only).
 *
 * light.comp has already run, so hits are shaded here. A hit on the plane of its pixel, or of a
 * neighbour on its side, takes that pixel's colour. Any other hit takes the colour of the pixel
 * with the closest plane, without fog, scaled by the ratio of two simplified light.comp results:
 * that of the hit's surface and normal, and that of the pixel's. They contain sunlight, as far as
 * the pixel is in the sun, and ambient light. So shadows, lamps and reflections are the
 * neighbour's. A hit without a similar neighbour is fully lit by the sun.
 *
 * The host's drawing at a split is part of the colour, not a surface: depths are the scene's.
 *
 * The workgroup shares its rays: pixels are listed, and any invocation marches any ray. The order
 * of the list varies, the result does not.
 *
 * Rays that hit the sky or polygons that no neighbour shows take the centre's colour.
 * push.steps: maximum number of samples of a ray, at most STEPS.
 * push.listed: 0: all parts; 1: the tiles' lists exist; 2: also the relevant terms of blocks of 4x4
 * pixels.
 * push.metered: not 0: automatic exposure. push.peak: the largest output value, relative to white.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "push/silhouettes.h"
#include "shared/counters.h"
#include "shared/sdf_limits.h"
#include "shared/types.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/silhouettes.glsl"
#include "shared/store.glsl"
#include "shared/tone.glsl"
#include "light/air.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(constant_id = 2) const bool foggy = false; /* the scene has fog */

#if MASU_HAS_RASTER
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_IMAGE 1
#else
#define MASU_FIRST_IMAGE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 1) uniform sampler2D albedo_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 2) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 3) uniform sampler2D hdr_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 4, r32ui)
    uniform writeonly uimage2D silhouettes_image;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_EXPOSURE, std430) readonly buffer Exposure
{
    float metered_exposure;
};

#define MASU_RELAXED
#define MASU_MARCH_STEPS uint(MASU_MARCH_STEPS_MAX) /* meet has its own limit */
#define MASU_SDF_ASK
#define MASU_SDF_NO_FLAT
#define MASU_SPAN_BEFORE false
#define MASU_SPAN_TILE own_tile
uint own_tile;
#include "sdf/spans.glsl"
#include "sdf/trace.glsl"

#define INVOCATIONS (MASU_GROUP * MASU_GROUP)
#define RAYS 3
/* Samples of a ray. One ray in twenty passes so close to a surface that it would need more, up to
 * hundreds; it takes the centre's colour. With 80 samples the FLIP error is 0.67 at 480x270 and
 * 0.72 at 1920x1080, with 128 samples 0.65 and 0.68; without a limit 0.64 and 0.66, for 4 % more
 * operations. */
#define STEPS 128

shared uint listed_count, differ_count;
/* Pixels that may have an edge: bits 0 to 5 the index in the group, 6 and 7 the first position, 8
 * whether there are edges on two opposite sides. */
shared uint listed[INVOCATIONS];
shared uint differ[INVOCATIONS];          /* indices into `listed` where the first ray differs */
shared vec3 light[RAYS * INVOCATIONS];    /* colour of each pixel's rays */

uvec2 size;

/* Sample positions within a pixel, and the weight of its centre. The best three for edges of all
 * directions if every second edge is parallel to an axis, as in typical images. */
const float middle_share = 0.206;

vec2 place_of(uint k)
{
    return k == 0u ? vec2(-0.101, 0.372) : k == 1u ? vec2(0.375, -0.105) : vec2(-0.345, -0.325);
}

uint place_towards(vec2 side)
{
    vec3 along = vec3(dot(place_of(0u), side), dot(place_of(1u), side), dot(place_of(2u), side));
    return along.x >= max(along.y, along.z) ? 0u : along.y >= along.z ? 1u : 2u;
}

/* Display-linear colour, 0 to 1 of the largest output value. Brighter values are clamped. */
vec3 shown(vec3 hdr)
{
    float most = max(push.peak, 1.0);
    float exposure = push.metered != 0u ? metered_exposure : frame.sun_direction.w;
    return min(masu_shown(hdr, exposure, most) / most, 1.0);
}

/* ---- The G-buffer pixels --------------------------------------------------------------------- */

/* Right, left, below, above. */
ivec2 beside(int k)
{
    int way = 1 - 2 * (k & 1);
    return k < 2 ? ivec2(way, 0) : ivec2(0, way);
}

bool is_inside(ivec2 at)
{
    return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(size)));
}

float depth_at(ivec2 at)
{
    return texelFetch(depth_image, at, 0).r;
}

float raster_at(ivec2 at)
{
#if MASU_HAS_RASTER
    return texelFetch(raster_depth, at, 0).r;
#else
    return 0.0;
#endif
}

/* A pixel and the plane of its surface. 1/z, and so the depth, is affine in screen space. */
struct pixel {
    float depth; /* 0: the sky */
    bool sdf;
    vec2 slope; /* depth change one pixel to the right, one pixel down */
    vec3 normal;
};

pixel pixel_at(ivec2 at)
{
    pixel p = pixel(depth_at(at), false, vec2(0.0), vec3(0.0));
    if (p.depth > 0.0) {
        p.sdf = p.depth != raster_at(at);
        p.normal = masu_unpack_normal(texelFetch(normal_image, at, 0).r);
        float facing = dot(p.normal, masu_pixel_ray(uvec2(at), size));
        vec2 slope = 2.0 / vec2(size) *
                     vec2(dot(p.normal, frame.right.xyz), -dot(p.normal, frame.up.xyz));
        p.slope = facing < -1e-6 ? p.depth / facing * slope : vec2(0.0);
    }
    return p;
}

/* Whether the depths of a pixel and its neighbours are on a plane, as most are. The tolerance is
 * half of the threshold for an edge. */
bool is_flat(ivec2 at)
{
    ivec2 low = max(at - 1, ivec2(0));
    ivec2 high = min(at + 1, ivec2(size) - 1);
    float own = depth_at(at);
    vec2 before = vec2(depth_at(ivec2(low.x, at.y)), depth_at(ivec2(at.x, low.y)));
    vec2 after = vec2(depth_at(ivec2(high.x, at.y)), depth_at(ivec2(at.x, high.y)));
    vec2 bend = abs(before + after - 2.0 * own);
    return max(bend.x, bend.y) <= 0.25 * frame.up.w / float(size.y) * own;
}

/* Whether two visible faces join within the pixel, or right next to it. */
bool is_crease(pixel own, pixel other, vec2 way)
{
    vec2 across = other.slope - own.slope;
    float difference = other.depth - dot(other.slope, way) - own.depth;
    vec2 to = -difference * across * masu_rcp(dot(across, across));
    float along = dot(to, way);
    return (own.sdf || other.sdf) && dot(other.normal, own.normal) < 0.8 && along > 0.0 &&
           dot(to, to) < min(along, 0.5);
}

/* Whether a surface ends within the pixel or right next to it; `side`: towards which sides;
 * `between`: on two opposite sides. */
bool has_edge(ivec2 at, out vec2 side, out bool between)
{
    side = vec2(0.0);
    between = false;
    if (is_flat(at)) {
        return false;
    }
    pixel own = pixel_at(at);
    /* Closer by two pixel widths than the other pixel, and than its surface if it continued. */
    float gap = 1.0 + 4.0 * frame.up.w / float(size.y);
    bool edge = false;
    MASU_LOOP for (int k = 0; k < 4; k++) {
        ivec2 to = at + beside(k);
        vec2 way = vec2(beside(k));
        if (!is_inside(to)) {
            continue;
        }
        float other = depth_at(to);
        float going_on = own.depth + dot(own.slope, way);
        bool before = own.sdf && min(own.depth, going_on) > other * gap;
        bool behind = other > max(own.depth, going_on) * gap && other != raster_at(to);
        bool bends = own.depth > 0.0 && other > 0.0 &&
                     abs(other - going_on) > 0.125 * (gap - 1.0) * other;
        if (before || behind || (bends && is_crease(own, pixel_at(to), way))) {
            between = between || dot(side, way) < 0.0;
            side = mix(side, way, notEqual(way, vec2(0.0)));
            edge = true;
        }
    }
    return edge;
}

/* ---- Ray intersection ------------------------------------------------------------------------ */

/* Depth of the polygons at a position within a pixel. The slope is the smaller difference to a
 * neighbour, because across their own edge the neighbour is another surface. 0 if both are
 * large. */
float raster_within(ivec2 at, vec2 place)
{
    float depth = raster_at(at);
    if (depth > 0.0) {
        ivec2 low = max(at - 1, ivec2(0));
        ivec2 high = min(at + 1, ivec2(size) - 1);
        vec2 before = depth - vec2(raster_at(ivec2(low.x, at.y)), raster_at(ivec2(at.x, low.y)));
        vec2 after = vec2(raster_at(ivec2(high.x, at.y)), raster_at(ivec2(at.x, high.y))) - depth;
        bvec2 earlier = lessThan(abs(before), abs(after));
        earlier = bvec2(low.x < at.x && (earlier.x || high.x == at.x),
                        low.y < at.y && (earlier.y || high.y == at.y));
        vec2 slope = mix(after, before, earlier);
        slope = mix(slope, vec2(0.0), greaterThan(abs(slope), vec2(0.1 * depth)));
        depth += dot(place, slope);
    }
    return depth;
}

/* Intersection of a ray and the SDF. */
struct met {
    float t;        /* -1: no hit */
    int half_space; /* index of the half-space that was hit; -1: none */
    bool done;      /* false: the ray ran out of samples */
};

/* r: within the SDF's bounds. A half-space may end the ray before the distance that the cone of the
 * pixel's block guarantees, because the cone is free of the listed parts only. Without spans (one
 * part, or another march) rays start at the box around the listed parts. */
met meet(ivec2 at, ray r, bool any_listed)
{
    uint part;
    float end = masu_sdf_flat(eye_hi + eye_lo, r.direction, r.start, part);
    masu_count(MASU_COUNTER_SDF_EVALS, MASU_SDF_PART_COUNT > MASU_SDF_LISTED_COUNT ? 1u : 0u);
    bool ends = end <= r.limit && end < 1e30;
    float farthest = min(r.limit, end);
    vec3 low, high;
    masu_listed_box(low, high);
    clip_to_box(r, low, high);
    r.limit = any_listed ? min(r.limit * (1.0 + newton_reach * r.pixel), farthest) : r.start;
#if MASU_SDF_BLOCK_WORDS > 0
    if (push.listed == 2u) {
        r.start = max(r.start, uintBitsToFloat(masu_tiles[span_word(uvec2(at), size)]));
        span_begin(uvec2(at), size, r.start);
    }
#endif
    march_state m = march_begin(r);
    MASU_LOOP for (uint i = 0u; i < uint(STEPS); i++) {
        if (m.done || i >= push.steps) {
            break;
        }
        if (push.listed == 2u) {
            span_follow(m.t, size);
        }
        march_step(m, r, field_at(r, m.t));
    }
    masu_count(MASU_COUNTER_SDF_EVALS, m.steps);
    bool listed = m.t >= 0.0;
    return met(listed ? m.t : ends ? end : -1.0, !listed && ends ? int(part) : -1, m.done);
}

/* ---- Shading of a hit ------------------------------------------------------------------------ */

/* Which of a pixel and its neighbours on the position's sides shows the hit at `depth` (0: the sky;
 * sdf: a hit of the SDF): the first whose plane matches, else the one with the closest plane.
 * off: distance to the plane in pixel widths; 1e30 if none has the same kind of surface. */
ivec2 like_at(ivec2 at, vec2 place, float depth, bool sdf, float width, out float off)
{
    ivec2 like = at;
    off = 1e30;
    MASU_LOOP for (int k = 0; k < 3; k++) {
        ivec2 way = k == 0   ? ivec2(0)
                    : k == 1 ? ivec2(place.x > 0.0 ? 1 : -1, 0)
                             : ivec2(0, place.y > 0.0 ? 1 : -1);
        if (!is_inside(at + way)) {
            continue;
        }
        pixel other = pixel_at(at + way);
        float there = other.depth + dot(other.slope, place - vec2(way));
        float widths = abs(there - depth) * masu_rcp(max(there, depth)) / width;
        if (other.sdf == sdf && (depth > 0.0) == (other.depth > 0.0) && widths < off) {
            off = widths;
            like = at + way;
        }
        if (off < 0.05) {
            break;
        }
    }
    return like;
}

/* light.comp's result for a surface without lamps, probes and emission: `around` from ambient
 * light, `sun` from the sun. */
void light_up(masu_surface s, uint normal, vec3 v, out vec3 around, out vec3 sun)
{
    around = vec3(0.0);
    sun = vec3(0.0);
    if (!masu_is_unlit_texel(normal)) {
        vec3 n = masu_unpack_normal(normal);
        masu_mirrored sky = masu_mirrored_sky(s, n, v, vec2(1.0));
        masu_bsdf b = masu_bsdf_make(s, n, v);
        masu_lit lit = masu_shade_around(s, b, masu_ambient_at(vec3(0.0), b.n), 1.0, sky);
        around = lit.diffuse + lit.specular;
        lit = masu_lit(vec3(0.0), vec3(0.0), vec3(0.0));
        masu_add_light(lit, s, b, frame.sun_direction.xyz, frame.sun_color.rgb);
        sun = lit.diffuse + lit.specular;
    }
}

/* Colour of a hit at t in the light of pixel `like`; with full sun if no pixel has the same kind
 * of surface (!found). The loop, first for that pixel, avoids compiling the lighting twice.
 * The pixel's emission is not stored: if it emits, the hit's emission is assumed. */
vec3 lit_like(ivec2 like, bool found, vec3 direction, float t, uint met_albedo, uint met_normal)
{
    vec3 hdr = texelFetch(hdr_image, like, 0).rgb;
    vec3 air = vec3(0.0);
    float left = 1.0; /* transmittance of the air */
    if (foggy) {
        float far = frame.forward.w * masu_rcp(depth_at(like) * dot(direction, frame.forward.xyz));
        float left_there = masu_fog_left(masu_air_depth(direction, far));
        air = masu_air_color(direction);
        hdr = max(hdr - air * (1.0 - left_there), 0.0) / max(left_there, 1e-3);
        left = masu_fog_left(masu_air_depth(direction, t));
    }
    if (found && masu_has_emission(texelFetch(normal_image, like, 0).r)) {
        hdr = max(hdr - masu_unpack_met(unpackUnorm4x8(met_albedo), met_normal).emissive, 0.0);
    }
    vec3 here = vec3(0.0), there = vec3(0.0);
    float seen = 1.0;
    MASU_LOOP for (int k = 0; k < 2; k++) {
        bool first = k == 0 && found;
        /* Read and unpacked in the loop: both surfaces would take 16 registers. */
        ivec2 from = first ? like : ivec2(0);
        uint normal = texelFetch(normal_image, from, 0).r;
        vec4 albedo = texelFetch(albedo_image, from, 0);
        normal = first ? normal : met_normal;
        albedo = first ? albedo : unpackUnorm4x8(met_albedo);
        masu_surface s = masu_unpack_met(albedo, normal);
        if (first) {
            s = masu_unpack_look(albedo, normal);
        }
        vec3 around, sun;
        light_up(s, normal, -direction, around, sun);
        if (first) {
            /* Sun visibility, from the pixel's light without and with sun. 1 if it faces away. */
            float more = masu_luminance(sun);
            float without = masu_luminance(around);
            seen = more > 0.05 * without ? clamp((masu_luminance(hdr) - without) / more, 0.0, 1.0)
                                         : 1.0;
        }
        here = around + seen * sun;
        there = first ? here : there;
    }
    /* Without any light to compare, as at night with lamps only, the ratio is 1. */
    here = found ? hdr * clamp((here + 1e-6) / (there + 1e-6), 0.125, 8.0) : here;
    here += masu_unpack_met(unpackUnorm4x8(met_albedo), met_normal).emissive;
    return here * left + air * (1.0 - left);
}

/* Colour of a ray through a position in a pixel. */
vec3 radiance_at(ivec2 at, vec2 place)
{
    float raster = raster_within(at, place);
    float z_scale;
    ray r = place_ray(vec2(at) + 0.5 + place, size, raster, z_scale);
    /* Recomputed for each ray: values shared by rays would occupy too many registers in shading. */
    span_begin_none();
    masu_list_bits = uint[](0xFFFFFFFFu, 0xFFFFFFFFu);
    own_tile = masu_tile_of(gl_WorkGroupID.xy * uint(MASU_GROUP), size);
    bool any_listed = push.listed == 0u || masu_use_tile(own_tile, size);
    met m = meet(at, r, any_listed);
    bool sdf = m.t >= 0.0;
    float off;
    ivec2 like = like_at(at, place, sdf ? depth_of(m.t, z_scale) : raster, sdf, r.pixel, off);
    if (!m.done) {
        like = at;
    }
    vec3 color;
    if (!sdf || !m.done || off < 0.05) {
        color = texelFetch(hdr_image, like, 0).rgb;
    } else {
        if (push.listed == 2u && m.half_space < 0) {
            span_begin(uvec2(at), size, m.t);
        }
        vec4 albedo;
        uint normal;
        vec3 n;
        masu_surface s = surface_met(r, m.t, m.half_space >= 0, uint(max(m.half_space, 0)), n);
        masu_pack_met(n, s, albedo, normal);
        color = lit_like(like, off < 1e30, r.direction, m.t, packUnorm4x8(albedo), normal);
    }
    return color;
}

/* ---- The workgroup --------------------------------------------------------------------------- */

/* Pixel of an entry of the list. From shared memory each time, since it would take registers. */
ivec2 pixel_of(uint entry)
{
    uint own = listed[entry] & uint(INVOCATIONS - 1);
    return ivec2(gl_WorkGroupID.xy * uint(MASU_GROUP)) +
           ivec2(own & uint(MASU_GROUP - 1), own / uint(MASU_GROUP));
}

/* Marches ray `next` of 3 for an entry of the list. */
void march_one(uint entry, uint next)
{
    vec2 place = place_of(((listed[entry] >> 6 & 3u) + next) % uint(RAYS));
    light[entry * uint(RAYS) + next] = shown(radiance_at(pixel_of(entry), place));
}

#if MASU_GROUP != 8
#error "numbers in a group have 6 bits"
#endif

vec3 middle_of(uint entry)
{
    return shown(texelFetch(hdr_image, pixel_of(entry), 0).rgb);
}

/* The texel of the invocation's pixel; entry: its index in the list, INVOCATIONS if not listed. */
uint march_edges(uint entry)
{
    /* First one ray per entry, then two more for entries that differ. The loop avoids compiling a
     * ray more than once. */
    MASU_LOOP for (uint k = 0u; k < 3u; k++) {
        uint i = gl_LocalInvocationIndex + (max(k, 1u) - 1u) * uint(INVOCATIONS);
        if (i < (k == 0u ? listed_count : 2u * differ_count)) {
            march_one(k == 0u ? i : differ[i >> 1], k == 0u ? 0u : 1u + (i & 1u));
        }
        if (k == 0u) {
            barrier();
            if (entry < uint(INVOCATIONS)) {
                bool between = (listed[entry] >> 8) != 0u;
                if (between || masu_edge_differs(light[entry * uint(RAYS)], middle_of(entry))) {
                    differ[atomicAdd(differ_count, 1u)] = entry;
                } else {
                    entry = uint(INVOCATIONS);
                }
            }
            barrier();
        }
    }
    barrier();
    if (entry == uint(INVOCATIONS)) {
        return 0u;
    }
    vec3 rays = light[entry * uint(RAYS)] + light[entry * uint(RAYS) + 1u] +
                light[entry * uint(RAYS) + 2u];
    vec3 middle = middle_of(entry);
    vec3 mean = mix(rays * (1.0 / float(RAYS)), middle, middle_share);
    return masu_edge_differs(mean, middle) ? masu_pack_edge(mean) : 0u;
}

void main()
{
    masu_count_begin();
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    size = uvec2(pc.output_width, pc.output_height);
    if (gl_LocalInvocationIndex == 0u) {
        listed_count = 0u;
        differ_count = 0u;
    }
    barrier();
    uint entry = uint(INVOCATIONS);
    vec2 side;
    bool between;
    if (is_inside(at) && has_edge(at, side, between)) {
        entry = atomicAdd(listed_count, 1u);
        listed[entry] = gl_LocalInvocationIndex | place_towards(side) << 6 | uint(between) << 8;
    }
    barrier();
    uint word = 0u;
    if (listed_count > 0u) {
        word = march_edges(entry);
    }
    if (is_inside(at)) {
        MASU_STORE_SAFE(silhouettes_image, at, uvec4(word));
    }
    masu_count_end();
}
