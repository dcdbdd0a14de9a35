/*
 * silhouettes.comp: where between two pixels what the SDF shows ends. Compiled by masu-bake with the scene's field.
 *
 * A pixel beside which the SDF is nearer than its own surface goes on would take no edge for what it is: its ray has
 * passed the nearer thing, by less than a pixel. The field knows by how much. Along the pixel's ray, from the
 * neighbour's depth on, the place is looked for where the field's gradient is across the ray; from there the surface
 * lies at f / |gradient| along the gradient. That point in the picture, relative to the pixel's centre, is the nearest of
 * the silhouette, and the silhouette a straight line through it. tonemap.comp blends the pixels on both sides by
 * what the line covers of them (shared/silhouettes.glsl).
 *
 * It takes up to PAIRS pairs of samples and four more at the pixels behind a silhouette, which are some 2 to 8 of 100, and nothing but depths
 * and a normal of all others. Wrong turn: to note near misses while marching. It is state of every ray in flight, for
 * few of them; and cones, lists and boxes would all have to be wider by a pixel.
 *
 * push.listed: 0: all parts; 1: the tiles' lists are there; 2: and what matters to blocks of 4x4 pixels.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define MASU_PUSH masu_push_silhouettes
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/silhouettes.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#if MASU_HAS_RASTER
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_IMAGE 1
#else
#define MASU_FIRST_IMAGE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 1) uniform usampler2D normal_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_IMAGE + 2, r32ui) uniform writeonly uimage2D silhouettes_image;

#define MASU_SDF_ASK
#define MASU_SDF_NO_FLAT
#define MASU_SPAN_BEFORE true
#define MASU_SPAN_TILE own_tile
uint own_tile;
#include "sdf/spans.glsl"

#define PAIRS 6

uvec2 size;

/* Whether it is not a polygon that is there. */
bool sdf_shows(ivec2 at, float depth)
{
#if MASU_HAS_RASTER
    return depth != texelFetch(raster_depth, at, 0).r;
#else
    return true;
#endif
}

/* A pixel's surface as a plane: of it 1/z, as depth is, is affine in the picture. */
struct plane {
    float depth;
    vec2 slope; /* a pixel to the right, a pixel down */
    vec3 normal;
};

plane plane_at(ivec2 at, float depth, vec3 through)
{
    vec3 n = masu_unpack_normal(texelFetch(normal_image, at, 0).r);
    float facing = dot(n, through);
    vec2 slope = 2.0 / vec2(size) * vec2(dot(n, frame.right.xyz), -dot(n, frame.up.xyz));
    return plane(depth, facing < -1e-6 ? depth / facing * slope : vec2(0.0), n);
}

float scene_depth(ivec2 at)
{
    bool outside = any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(size)));
    return outside ? 0.0 : texelFetch(depth_image, at, 0).r;
}

/* Where two faces meet that both can be seen: the line through the pixel on which their planes do. */
uint crease_at(ivec2 at, bool own_sdf, plane own, vec4 depths, vec4 going_on)
{
    float enough = 0.5 * frame.up.w / float(size.y);
    vec4 off = abs(depths - going_on);
    bvec4 bends = bvec4(off.x > enough * depths.x && depths.x > 0.0, off.y > enough * depths.y && depths.y > 0.0,
                        off.z > enough * depths.z && depths.z > 0.0, off.w > enough * depths.w && depths.w > 0.0);
    if (!any(bends)) {
        return 0u;
    }
    vec2 line = vec2(0.0);
    uint beside = 0u;
    float least = 0.75;
    MASU_LOOP for (int k = 0; k < 4; k++) {
        ivec2 way = masu_beside(k);
        if (bends[k] && (own_sdf || sdf_shows(at + way, depths[k]))) {
            plane other = plane_at(at + way, depths[k], masu_pixel_ray(uvec2(at + way), size));
            vec2 across = other.slope - own.slope;
            float difference = depths[k] - dot(other.slope, vec2(way)) - own.depth;
            vec2 to = -difference * across * masu_rcp(dot(across, across));
            float far = length(to);
            float along = dot(to, vec2(way));
            bool here = along > 0.0 && dot(to, to) < along && far < least && dot(other.normal, own.normal) < 0.8;
            line = here ? to : line;
            least = here ? far : least;
            beside |= here ? 1u << k : 0u;
        }
    }
    return masu_pack_silhouette(line, beside);
}

/* The vector from a ray to the surface where they are nearest, seen from t on; 0: they meet, or the ray leaves first.
 * Pairs of samples tell whether the field falls or rises along the ray: ever longer steps until it rises, then secants
 * between the last two, of which an end that stays counts half (Illinois). The last four samples are the gradient. */
vec3 to_surface(ray r, inout float t)
{
    float low_t = t;
    float low_slope = 0.0;
    float high_t = r.limit;
    float high_slope = -1.0;
    float step = 4.0 * r.pixel * t;
    int side = 0;
    int final = -1; /* the first sample of the last four */
    float before = 0.0;
    float h = 0.0;
    vec3 sum = vec3(0.0);
    float mean = 0.0;
    uint evals = 0u;
    MASU_LOOP for (int i = 0; i < 2 * PAIRS + 4; i++) {
        int k = final < 0 ? i & 1 : i - final;
        vec3 p = world_at(r.direction, t);
        vec3 a = abs(p);
        h = max(0.1 * r.pixel * t, 64.0 * ulp * max(max(a.x, max(a.y, a.z)), t));
        vec3 corner = mix(vec3(-1.0), vec3(1.0), bvec3(k == 1 || k == 3, k >= 2, k == 0 || k == 3));
        vec3 offset = final < 0 ? (k == 0 ? -r.direction : r.direction) : corner;
        if (push.listed == 2u) {
            span_follow(t, size);
        }
        float f = masu_sdf(p + offset * h);
        evals++;
        sum = k == 0 ? corner * f : sum + corner * f;
        mean = k == 0 ? f : mean + f;
        if (final >= 0) {
            if (k == 3) {
                break;
            }
        } else if (k == 0) {
            before = f;
        } else {
            float slope = 0.5 * (f - before) / h; /* up to the field's L */
            bool rises = slope > 0.0;
            if (rises) {
                high_slope = slope;
                low_slope *= side == 1 ? 0.5 : 1.0;
                high_t = t;
            } else {
                low_slope = slope;
                high_slope *= side == -1 && high_slope > 0.0 ? 0.5 : 1.0;
                low_t = t;
            }
            side = rises ? 1 : -1;
            bool between = high_slope > 0.0;
            float next = between && low_slope < 0.0 ? low_t + (high_t - low_t) * low_slope / (low_slope - high_slope)
                       : rises ? t - step : t + step;
            step *= 4.0;
            bool close = abs(next - t) * abs(slope) < 0.04 * r.pixel * t;
            if (((rises || between) && close) || !masu_finite(next) || i >= 2 * PAIRS - 1 || next >= r.limit) {
                final = i + 1;
            }
            t = clamp(masu_finite(next) ? next : t, r.start, r.limit);
            MASU_WENT_BACK(t)
        }
    }
    masu_count(MASU_COUNTER_SDF_EVALS, evals);
    float slope = masu_rcp(length(sum));
    float distance = mean * h * slope;
    vec3 n = sum * slope;
    float slant = dot(n, r.direction);
    bool found = abs(slant) < 0.3 && distance > 0.0 && distance < 2.0 * r.pixel * t && t < r.limit;
    return found ? -distance * (n - slant * r.direction) : vec3(0.0);
}

/* Where something in front ends, seen from a pixel beside it. `front`: a bit for each neighbour that is in front; the depth of
 * the nearest of them. */
uint silhouette_at(uvec2 at, vec3 through, float depth, uint front, float nearest)
{
    float z_scale = length(through);
    float near = frame.forward.w * z_scale;
    ray r = ray(through / z_scale, 2.0 * frame.up.w / float(size.y) / z_scale, near, frame.sdf_max.w);
    /* What ends at the very side of the bounds is missed outside of them. */
    float wide = 4.0 * r.pixel * near / nearest;
    clip_to_box(r, frame.sdf_min.xyz - wide, frame.sdf_max.xyz + wide);
    r.limit = depth > 0.0 ? min(r.limit, near / depth) : r.limit;
    float t = near / nearest;
    if (!(r.start <= t && t < r.limit)) {
        return 0u;
    }
    /* What the pixel's own ray can meet or pass, not its neighbour's: that is what was looked for. */
    own_tile = masu_tile_of(at, size);
    if (push.listed != 0u) {
        masu_use_tile(own_tile, size);
    }
    if (push.listed == 2u) {
        span_prepare(size);
        span_begin(at, size, t);
    }
    vec3 across = to_surface(r, t);
    if (across == vec3(0.0)) {
        return 0u; /* wrong turn: to go on, with a line through the centre whose direction is rounding */
    }
    /* In the picture, in pixels from the pixel's centre. */
    vec3 rel = r.direction * t + across;
    vec2 ndc = vec2(dot(rel, frame.right.xyz) / dot(frame.right.xyz, frame.right.xyz),
                    -dot(rel, frame.up.xyz) / dot(frame.up.xyz, frame.up.xyz));
    ndc /= dot(rel, frame.forward.xyz);
    vec2 line = 0.5 * vec2(size) * (ndc - masu_ndc(vec2(at) + 0.5, vec2(size)));
    return masu_pack_silhouette(line, front);
}

/* A neighbour is in front, and where it ends was not found: it bends into what the pixel shows, as a ball's lower rim on the
 * ground, or the search ended elsewhere. Somewhere between the two it ends; of such pixels it covers a tenth in the
 * median, a fifth where it is in front on two sides (docs/design/40-silhouettes.md). */
uint somewhere(uint front)
{
    vec4 is = vec4(uvec4(front) >> uvec4(0u, 1u, 2u, 3u) & 1u);
    vec2 way = vec2(is.x - is.y, is.z - is.w);
    float far = way.x != 0.0 && way.y != 0.0 ? 0.2 : 0.4;
    return masu_pack_silhouette(far * way * masu_rcp(length(way)), front);
}

uint line_at(uvec2 at)
{
    float depth = texelFetch(depth_image, ivec2(at), 0).r;
    vec3 through = masu_pixel_ray(at, size);
    vec4 depths;
    plane own = plane(0.0, vec2(0.0), vec3(0.0));
    if (depth > 0.0) {
        own = plane_at(ivec2(at), depth, through);
    }
    /* Nearer than the pixel, and than its surface would be, if it went on there, by two pixels' widths. */
    vec4 going_on = vec4(depth) + vec4(own.slope.x, -own.slope.x, own.slope.y, -own.slope.y);
    float gap = 1.0 + 4.0 * frame.up.w / float(size.y);
    uint front = 0u;
    float nearest = 0.0;
    for (int k = 0; k < 4; k++) {
        ivec2 to = ivec2(at) + masu_beside(k);
        depths[k] = scene_depth(to);
        if (depths[k] > max(going_on[k], depth) * gap && sdf_shows(to, depths[k])) {
            front |= 1u << k;
            nearest = max(nearest, depths[k]);
        }
    }
    uint line = 0u;
    if (depth > 0.0) {
        line = crease_at(ivec2(at), sdf_shows(ivec2(at), depth), own, depths, going_on);
    }
    if (front != 0u) {
        uint before = silhouette_at(at, through, depth, front, nearest);
        line = before != 0u ? before : line != 0u ? line : somewhere(front);
    }
    return line;
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        MASU_STORE_SAFE(silhouettes_image, at, uvec4(line_at(at)));
    }
    masu_count_end();
}
