/*
 * march.comp: sphere tracing of the scene's SDF, limited by the raster depth; the nearer surface
 * wins. A hit becomes texels of the G-buffer, so that every later pass has one path.
 *
 * Not a shader by itself: masu-bake compiles it together with the scene's field (sdf_scene.glsl),
 * which defines
 *     float masu_sdf(vec3 p);                              a bound of the distance at world
 *     position p void masu_sdf_surface(vec3 p, inout masu_surface s);  the surface there
 * and sets MASU_HAS_RASTER (the scene has polygons). Parameters and time come through masu_param(i)
 * and masu_time().
 *
 * Stop: f < 0.1 pixel cones, but never below what fp32 can resolve there: 8 ulp of the largest
 * coordinate involved (the field's own rounding is up to 6.1 ulp; below it a march never
 * converges). Then two refining steps by the secant of the last two samples: at grazing angles f
 * falls slowly along the ray, and a step of f alone leaves depth 1.5e-3 off at the rim of a sphere
 * 150 pixels across, the secant 1.5e-6. Steps used up: the sample of least f/t stands for the
 * surface if it came within 2 pixels (Keinert et al., "Enhanced Sphere Tracing", STAG 2014, section
 * 3.3), else the ray misses. Never "hit" by default: that draws holes into the sky.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#include "shared/store.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#if MASU_HAS_RASTER
layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D raster_depth;
#define MASU_FIRST_WRITE 1
#else
#define MASU_FIRST_WRITE 0
#endif
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE, rgba8)
    uniform writeonly image2D albedo_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE + 1, r32ui)
    uniform writeonly uimage2D normal_image;
layout(set = MASU_SET_PASS, binding = MASU_FIRST_WRITE + 2, r32f)
    uniform writeonly image2D depth_image;

float masu_param(int i)
{
    return frame.sdf_params[i >> 2][i & 3];
}

float masu_time()
{
    return frame.eye_hi.w;
}

#include "sdf_scene.glsl"

const float ulp = 1.1920929e-7; /* 2^-23 */

struct ray {
    vec3 direction; /* unit */
    float pixel;    /* width of a pixel's cone at distance 1 */
    float start, limit;
};

vec3 world_at(vec3 direction, float t)
{
    return frame.eye_hi.xyz + (frame.eye_lo.xyz + direction * t);
}

/* The field as a step that cannot pass through a surface, or a negative number where it is not
 * finite (a miss). */
float step_at(ray r, float t, out bool usable)
{
    float f = masu_sdf(world_at(r.direction, t)) * frame.sdf_min.w;
    usable = masu_finite(f);
    return usable ? f : 0.0;
}

float tolerance(ray r, float t)
{
    vec3 p = abs(world_at(r.direction, t));
    float extent = max(max(p.x, max(p.y, p.z)), t);
    return max(0.1 * r.pixel * t, 8.0 * ulp * extent);
}

/* Entry and exit of the SDF's bounds. A component of the direction that is zero is replaced by a
 * tiny one: the slab is then left at +-1e30 or never entered, and 0 * Inf cannot arise. */
void clip_to_bounds(inout ray r)
{
    vec3 d = mix(r.direction, vec3(1e-12), lessThan(abs(r.direction), vec3(1e-12)));
    vec3 inverse = 1.0 / d;
    vec3 a = (frame.sdf_min.xyz - frame.eye_hi.xyz - frame.eye_lo.xyz) * inverse;
    vec3 b = (frame.sdf_max.xyz - frame.eye_hi.xyz - frame.eye_lo.xyz) * inverse;
    a = clamp(a, vec3(-masu_huge), vec3(masu_huge));
    b = clamp(b, vec3(-masu_huge), vec3(masu_huge));
    vec3 enter = min(a, b);
    vec3 leave = max(a, b);
    r.start = max(r.start, max(enter.x, max(enter.y, enter.z)));
    r.limit = min(r.limit, min(leave.x, min(leave.y, leave.z)));
}

/* Distance along the ray of the first surface, or -1. */
float march(ray r, out uint evals)
{
    evals = 0u;
    float t = r.start;
    float before_t = t; /* the sample before, and its field */
    float before_f = 0.0;
    float now_f = 0.0;
    float best_t = -1.0;
    float best_ratio = 2.0 * r.pixel;
    bool hit = false;
    bool left = false; /* the ray has got past its limit, or the field broke */
    for (int i = 0; i < MASU_MARCH_STEPS_MAX; i++) {
        left = left || !(t < r.limit);
        if (hit || left || uint(i) >= pc.index.x) {
            break;
        }
        bool usable;
        float f = step_at(r, t, usable);
        evals++;
        left = !usable;
        hit = usable && f < tolerance(r, t);
        now_f = f;
        if (!hit && usable) {
            before_t = t;
            before_f = f;
            float ratio = f / max(t, 1e-20);
            best_t = ratio < best_ratio ? t : best_t;
            best_ratio = min(best_ratio, ratio);
            t += f;
        }
    }
    left = left || !(t < r.limit);
    if (!hit) {
        if (left) {
            return -1.0;
        }
        masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
        return best_t;
    }
    for (int i = 0; i < 2; i++) {
        /* The secant, at most 16 tolerances ahead and never less than a plain step. A step that
         * leads further from the surface (past a thin part, out of a crease) is not taken. */
        float fall = before_f - now_f;
        float slope = fall > 1e-30 ? (t - before_t) / fall : 1.0;
        float reach = 16.0 * tolerance(r, t);
        /* Not before the start: a camera inside a solid sees it at the near plane, as a clipped
         * polygon's inside would. */
        float next_t = max(t + clamp(now_f * max(slope, 1.0), -reach, reach), r.start);
        bool usable;
        float next_f = step_at(r, next_t, usable);
        evals++;
        if (usable && abs(next_f) < abs(now_f)) {
            before_t = t;
            before_f = now_f;
            t = next_t;
            now_f = next_f;
        }
    }
    return t < r.limit ? t : -1.0;
}

/* Gradient from four samples at the corners of a tetrahedron (I. Quilez, "Normals for an SDF"). The
 * step grows with distance (a quarter of a pixel: with half of one, a sphere 60 pixels across is
 * off by 0.5 degrees) and with the coordinates (64 ulp: the least total of truncation and rounding
 * error). One loop, so that the field is compiled once here and not four times. */
vec3 normal_at(ray r, float t)
{
    vec3 p = world_at(r.direction, t);
    vec3 a = abs(p);
    float h = max(0.25 * r.pixel * t, 64.0 * ulp * max(max(a.x, max(a.y, a.z)), t));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; i++) {
        bvec3 plus = bvec3(i == 1 || i == 3, i >= 2, i == 0 || i == 3);
        vec3 corner = mix(vec3(-1.0), vec3(1.0), plus);
        sum += corner * masu_sdf(p + corner * h);
    }
    return masu_normalize(sum, -r.direction);
}

void main()
{
    masu_count_begin();
    uvec2 at = gl_GlobalInvocationID.xy;
    uvec2 size = uvec2(pc.output_width, pc.output_height);
    if (all(lessThan(at, size))) {
        vec3 through = masu_pixel_ray(at, size);
        float z_scale = length(through); /* distance along the ray per unit of view z; at least 1 */
        float near = frame.forward.w;
        ray r;
        r.direction = through / z_scale;
        r.pixel = 2.0 * frame.up.w / float(size.y) / z_scale;
        r.start = near * z_scale;
        r.limit = frame.sdf_max.w;
        float raster = 0.0;
#if MASU_HAS_RASTER
        raster = texelFetch(raster_depth, ivec2(at), 0).r;
        if (raster > 0.0) {
            r.limit = min(r.limit, near / raster * z_scale); /* a tie goes to the raster */
        }
#endif
        clip_to_bounds(r);
        uint evals;
        float t = march(r, evals);
        float depth = raster;
        if (t >= 0.0) {
            vec3 p = world_at(r.direction, t);
            vec3 n = normal_at(r, t);
            evals += 4u;
            masu_surface s = masu_surface(vec3(0.5), 0.5, vec3(0.0), 0.0);
            masu_sdf_surface(p, s);
            depth = near * z_scale / max(t, near * z_scale);
            masu_count(MASU_COUNTER_SDF_HITS, 1u);
            MASU_STORE_UNORM(albedo_image, at, masu_pack_albedo(s));
            MASU_STORE_UINT(normal_image, at, uvec4(masu_pack_normal(n, s)));
        }
#if !MASU_HAS_RASTER
        if (!(t >= 0.0)) { /* no polygon pass has cleared: what a host reads back is defined too */
            MASU_STORE_UNORM(albedo_image, at, vec4(0.0));
            MASU_STORE_UINT(normal_image, at, uvec4(0u));
        }
#endif
        masu_count(MASU_COUNTER_SDF_EVALS, evals);
        MASU_STORE_R32F(depth_image, at, depth);
    }
    masu_count_end();
}
