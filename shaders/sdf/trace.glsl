/*
 * trace.glsl: the primary ray of a pixel: ray setup, sphere tracing (march), normal and surface of
 * the hit.
 *
 * There are two marches. The plain one (Hart 1996) is the baseline of the report: it stops at 0.1
 * pixel cones and refines twice with the secant method. The relaxed one (MASU_RELAXED) takes longer
 * steps that it checks, and finds the surface to 0.002 pixel. With 0.1 rims are thicker by that
 * amount, which put up to 0.5 % of the pixels of thin rods on the wrong side and gave up to 3 % of
 * the depths an error above 1 %. Neither tolerance goes below the fp32 resolution, or the march
 * never converges.
 *
 * If the steps run out, the sample of least f/t is taken as the surface if it came within 2 pixels
 * (Keinert et al., "Enhanced Sphere Tracing", STAG 2014, section 3.3); else the ray misses. A hit
 * by default would draw holes into the sky.
 */
#ifndef MASU_TRACE_GLSL
#define MASU_TRACE_GLSL

#include "shared/counters.h"
#include "shared/sdf_limits.h"
#include "sdf/field.glsl"

/* Hook for the including file: called when the next sample, at t, may be before this one. */
#ifndef MASU_WENT_BACK
#define MASU_WENT_BACK(t)
#endif

#ifndef MASU_MARCH_STEPS
#define MASU_MARCH_STEPS push.steps
#endif

/* The ray through an image position in pixels. It ends at the raster depth (0: none) and at the
 * bounds of the SDF. z_scale: distance along the ray per unit of view z; at least 1. */
ray place_ray(vec2 place, uvec2 size, float raster, out float z_scale)
{
    float near = frame.forward.w;
    vec3 through = masu_place_ray(place, size);
    z_scale = length(through);
    float inverse = 1.0 / z_scale;
    ray r = ray(through * inverse, 2.0 * frame.up.w / float(size.y) * inverse, near * z_scale,
                frame.sdf_max.w);
    if (raster > 0.0) {
        r.limit = min(r.limit, near / raster * z_scale); /* equal depth: the raster surface wins */
    }
    clip_to_box(r, frame.sdf_min.xyz, frame.sdf_max.xyz);
    return r;
}

ray pixel_ray(uvec2 at, uvec2 size, float raster, out float z_scale)
{
    return place_ray(vec2(at) + 0.5, size, raster, z_scale);
}

/* Reverse-Z depth of a distance along a ray. */
float depth_of(float t, float z_scale)
{
    float nearest = frame.forward.w * z_scale;
    return t > nearest ? min(nearest / t, 1.0) : 1.0; /* x / x may exceed 1 on a GPU */
}

#ifdef MASU_SAFE_HINT
float masu_hint_delta = 0.0;
float masu_hint_free = 0.0;
bool masu_hint_open = true;

/* Extends the interval that is known to be empty on the neighbours' rays; see
 * march_checkerboard.comp. */
void masu_note_hint(float t, float f)
{
    float half_chord = 0.5 * t * masu_hint_delta * masu_hint_delta;
    float across = t * masu_hint_delta;
    float inside = f * f - across * across + half_chord * half_chord;
    float h = inside > 0.0 ? sqrt(inside) - half_chord : -1.0;
    masu_hint_open = masu_hint_open && h > 0.0 && t - h <= masu_hint_free;
    masu_hint_free = masu_hint_open ? max(masu_hint_free, t + h) : masu_hint_free;
}
#else
void masu_note_hint(float t, float f)
{
}
#endif

#ifndef MASU_RELAXED

/* The result of a march. */
struct march_end {
    float t, f;               /* last sample */
    float before_t, before_f; /* the sample before it */
    float best_t;             /* sample of least f/t within 2 pixels, or -1 */
    bool hit, left;
    uint evals;
};

void note_best(inout march_end m, inout float best_ratio, float t, float f)
{
    float ratio = f / max(t, 1e-20);
    m.best_t = ratio < best_ratio ? t : m.best_t;
    best_ratio = min(best_ratio, ratio);
}

const float normal_step = 0.25; /* pixels */

float tolerance(ray r, float t)
{
    return max(0.1 * r.pixel * t, resolution(r, t));
}

/* Plain sphere tracing: each step is as long as the field allows. */
march_end walk(ray r)
{
    march_end m = march_end(r.start, 0.0, r.start, 0.0, -1.0, false, false, 0u);
    float best_ratio = 2.0 * r.pixel;
    MASU_LOOP for (int i = 0; i < MASU_MARCH_STEPS_MAX; i++) {
        m.left = m.left || !(m.t < r.limit);
        if (m.hit || m.left || uint(i) >= push.steps) {
            break;
        }
        bool usable;
        float f = step_at(r, m.t, usable);
        m.evals++;
        m.left = !usable;
        m.hit = usable && f < tolerance(r, m.t);
        m.f = f;
        if (!m.hit && usable) {
            note_best(m, best_ratio, m.t, f);
            m.before_t = m.t;
            m.before_f = f;
            m.t += f;
        }
    }
    m.left = m.left || !(m.t < r.limit);
    return m;
}

/* Up to two secant steps, at most 16 tolerances ahead and never less than a plain step. A step that
 * ends further from the surface (past a thin part, out of a crease) is rejected. Never before the
 * start: a camera inside a solid sees the solid at the near plane, like the inside of a clipped
 * polygon. */
void refine(ray r, inout march_end m)
{
    MASU_LOOP for (int i = 0; i < 2; i++) {
        if (abs(m.f) < max(0.01 * r.pixel * m.t, resolution(r, m.t))) {
            break;
        }
        float fall = m.before_f - m.f;
        float rate = fall > 1e-30 ? (m.t - m.before_t) / fall : 1.0;
        float reach = 16.0 * tolerance(r, m.t);
        float next_t = max(m.t + clamp(m.f * max(rate, 1.0), -reach, reach), r.start);
        bool usable;
        float next_f = step_at(r, next_t, usable);
        m.evals++;
        if (usable && abs(next_f) < abs(m.f)) {
            m.before_t = m.t;
            m.before_f = m.f;
            m.t = next_t;
            m.f = next_f;
        }
    }
}

/* Distance along the ray of the first surface, or -1. */
float march(ray r, out uint evals)
{
    march_end m = walk(r);
    if (m.hit) {
        refine(r, m);
    } else if (!m.left) {
        masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
        m.t = m.best_t;
    }
    evals = m.evals;
    return (m.hit || !m.left) && m.t < r.limit ? m.t : -1.0;
}

#else

const float normal_step = 0.02;
const float newton_from = 0.3; /* pixels: use Newton's method below this distance */
const float newton_reach = 2.0; /* pixels: longest Newton step */
const float newton_lands = 0.15; /* pixels: a Newton step that ends this close is accepted
                                  * unchecked, */
const float newton_sure = 1.2; /* if it was at most this long, pixels */

/* No coordinate of a sample exceeds the camera's by more than t: a cheap bound of resolution(). */
float coarse = frame.sdf_eye_hi.w;

float tolerance(ray r, float t)
{
    return max(0.002 * r.pixel * t, coarse + 8.0 * ulp * t);
}

/* The state of a march between two samples. The caller evaluates the field at t until done; then t
 * is the hit, or -1. */
struct march_state {
    float t;
    float before_t, before_f; /* the last accepted sample: the ray is free up to their sum */
    float limit;              /* end of the ray, or of the bracket: a sample below 0 */
    float best_t, best_f;     /* sample of least f/t; at first 2 pixels */
    uint steps;
    bool narrowed, done;
};

march_state march_begin(ray r)
{
    bool any = r.start < r.limit;
    return march_state(any ? r.start : -1.0, r.start, 0.0, r.limit, 1.0, 2.0 * r.pixel, 0u, false,
                       !any);
}

/* The fallback sample is tracked only in the second half of the step budget: hardly any ray needs
 * that many steps, and tracking costs six operations per sample. */
bool note_best(march_state m)
{
    return 2u * m.steps > MASU_MARCH_STEPS;
}

bool is_sure(float f, float pixel, float reach, float before_f)
{
    return MASU_SDF_ROUGH == 0 && f < newton_lands * pixel && before_f < newton_from * pixel &&
           reach <= newton_sure * pixel;
}

/* Advances the march: the field at m.t is f. Most samples are further than two pixel widths from
 * the surface; there (march_far) a step is a check, a slope and one division, some 25 operations.
 * Closer samples need 90, without branches: neighbours nearly always take different ones. There is
 * at most one division between a sample and the next point. Rejected: the branchless code for all
 * samples. A CPU driver executes both sides anyway and was 8 to 20 % faster with it, but the lanes
 * of a GPU are mostly far from the surface together, or close together.
 *
 * Over-relaxation: steps exceed the distance of the field, and are checked. A step s from a sample
 * f1 to a sample f2 is valid if the two free spheres touch, s <= f1 + f2; else it is undone and a
 * plain step is made. On a plane the field falls with a constant slope along the ray, and s = 2 f /
 * (1 - slope) makes the spheres just touch: up to twice the plain step, most at grazing angles,
 * where plain steps are slowest. The slope is estimated from the last two samples (Ban and Valasek,
 * "Automatic Step Size Relaxation in Sphere Tracing", Eurographics 2023; the check is from Keinert
 * et al. 2014). Rejected: smoothing the slope over earlier samples; it saved no evaluation in any
 * scene.
 *
 * In the last third of a pixel the step is Newton's, to the estimated zero of the field: half of
 * all evaluations were spent there, since at a grazing angle each checked step covers only a fixed
 * share of the remaining distance. The step may pass into a surface before the spheres touch, but
 * then it was at most two pixel widths long: with four, rims at deep zooms had twice the error for
 * the same number of evaluations. A Newton step of at most 1.2 pixels that ends within 0.15 pixel
 * is accepted unchecked and the march continues from there: without this 8 to 12 % of all
 * evaluations were repetitions. For a fractal (MASU_SDF_ROUGH) a value that small proves nothing:
 * three times as many depths had an error, so the spheres must touch. Rejected: accepting steps of
 * two pixels, or relaxed ones, like that; 50 % more pixels of thin rods were on the wrong side.
 * Rejected: accepting any step like that; a relaxed step across the rim of one ball into the next
 * one missed the first.
 *
 * A Newton step from a sample below 0 leads back between it and the one before, so it needs no
 * separate bracket: the sample becomes the ray's limit, no step may pass half of the remaining
 * interval, and the value before is halved, so that neither end is stuck (the Illinois rule of
 * Dowell and Jarratt, BIT 11, 1971). If the field jumps there is no zero; then the interval shrinks
 * below the tolerance. A sample that is close enough from above takes the final step by the last
 * slope, without another evaluation. A camera inside a solid has no earlier sample: it sees the
 * solid at the near plane, like the inside of a clipped polygon. A field that is not a number is a
 * miss. */
void march_between(inout march_state m, ray r, float f)
{
    float pixel = r.pixel * m.t;
    float enough = tolerance(r, m.t);
    float free = m.before_t + m.before_f;
    float reach = m.t - m.before_t;
    bool touched = f < enough;
    /* A longer step: Newton's, to the estimated zero; else relaxed, with a slope of at most 0.9. */
    float fall = m.before_f - f;
    bool newton = f < newton_from * pixel && fall > 0.0;
    float rate = (newton ? reach : 1.9 * reach) /
                 max(newton ? fall : max(reach + fall, 0.1 * reach), 1e-30);
    float longest = touched ? 16.0 * enough : newton_reach * pixel;
    float next = m.t + (newton ? min(f * rate, longest) : f * max(rate, 1.0));
    float most = m.narrowed ? 0.5 * (m.t + m.limit) : m.limit;
    next = next < most ? next : most;
    float end = m.narrowed ? m.t : next;
    /* Whether the march may end here. */
    bool meet = m.narrowed || m.t <= free || m.t - f <= free ||
                (touched && reach <= newton_reach * pixel) || is_sure(f, pixel, reach, m.before_f);
    bool through = reach > 0.0 && f < -enough;
    bool nothing_left = m.narrowed && m.limit - m.before_t < enough;
    bool usable = masu_finite(f);
    bool hit = usable && meet && (nothing_left || (touched && !through));
    bool leaves = !m.narrowed && m.t + f >= m.limit;
    bool gone = !usable || (meet && !hit && leaves);
    if (meet) {
        masu_note_hint(m.t, f);
    }
    bool better = meet && note_best(m) && f * m.best_t < m.best_f * m.t;
    m.best_t = better ? m.t : m.best_t;
    m.best_f = better ? f : m.best_f;
    bool spent = !hit && !gone && m.steps >= MASU_MARCH_STEPS;
    if (spent) {
        masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
    }
    bool missed = gone || (hit && !m.narrowed && !(end < m.limit)) ||
                  (spent && !(m.best_f < 2.0 * r.pixel * m.best_t));
    m.done = hit || gone || spent;
    bool narrows = meet && through;
    m.limit = narrows ? m.t : m.limit;
    m.narrowed = m.narrowed || narrows;
    m.before_t = meet && !through ? m.t : m.before_t;
    m.before_f = meet ? (through ? 0.5 * m.before_f : f) : m.before_f;
    m.t = missed ? -1.0 : hit ? end : spent ? m.best_t : meet ? next : free;
    MASU_WENT_BACK(m.t)
}

/* march_between() for a ray without a sample below 0. Conditions, since most samples need only one
 * or two of the checks. */
void march_near(inout march_state m, ray r, float f)
{
    float pixel = r.pixel * m.t;
    float enough = tolerance(r, m.t);
    float free = m.before_t + m.before_f;
    float reach = m.t - m.before_t;
    bool touched = f < enough;
    bool meet = m.t - max(f, 0.0) <= free;
    if (!meet) {
        meet = (touched && reach <= newton_reach * pixel) || is_sure(f, pixel, reach, m.before_f);
    }
    bool spent = m.steps >= MASU_MARCH_STEPS;
    if (meet || spent) {
        if (meet) {
            masu_note_hint(m.t, f);
        }
        float fall = m.before_f - f;
        bool newton = f < newton_from * pixel && fall > 0.0;
        float rate = (newton ? reach : 1.9 * reach) /
                     max(newton ? fall : max(reach + fall, 0.1 * reach), 1e-30);
        float longest = touched ? 16.0 * enough : newton_reach * pixel;
        float next = min(m.t + (newton ? min(f * rate, longest) : f * max(rate, 1.0)), m.limit);
        if (note_best(m)) {
            bool better = meet && f * m.best_t < m.best_f * m.t;
            m.best_t = better ? m.t : m.best_t;
            m.best_f = better ? f : m.best_f;
        }
        bool hit = touched && meet;
        if (hit || spent || (meet && m.t + f >= m.limit)) {
            bool gone = hit ? !(next < m.limit) : meet && m.t + f >= m.limit;
            if (spent && !hit && !gone) {
                masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
                gone = !(m.best_f < 2.0 * r.pixel * m.best_t);
                next = m.best_t;
            }
            m.done = true;
            next = gone ? -1.0 : next;
        }
        m.before_t = m.t;
        m.before_f = f;
        m.t = next;
    } else {
        m.t = free;
        MASU_WENT_BACK(free)
    }
}

/* At two pixel widths or more: no candidate for the fallback sample, and nothing to bracket. */
void march_far(inout march_state m, float f)
{
    float free = m.before_t + m.before_f;
    if (m.t - f > free) {
        m.t = free;
        MASU_WENT_BACK(free)
    } else {
        masu_note_hint(m.t, f);
        float reach = m.t - m.before_t;
        float rate = 1.9 * reach / max(max(reach + (m.before_f - f), 0.1 * reach), 1e-30);
        m.before_t = m.t;
        m.before_f = f;
        m.done = m.t + f >= m.limit;
        m.t = m.done ? -1.0 : min(m.t + f * max(rate, 1.0), m.limit);
    }
}

/* Only for a march that is not done. */
void march_step(inout march_state m, ray r, float f)
{
    m.steps++;
    m.done = false; /* known: else it takes a register while the caller evaluates the field */
    float apart = 2.0 * r.pixel + 8.0 * ulp; /* threshold of march_far at distance 1 */
    if (!m.narrowed && f > m.t * apart + coarse && m.steps < MASU_MARCH_STEPS) {
        march_far(m, f);
    } else if (!m.narrowed && f >= -tolerance(r, m.t)) {
        march_near(m, r, f);
    } else {
        march_between(m, r, f);
    }
}

/* Distance along the ray of the first surface, or -1. */
float march(ray r, out uint evals)
{
    march_state m = march_begin(r);
    MASU_LOOP for (int i = 0; i < MASU_MARCH_STEPS_MAX; i++) {
        if (m.done) {
            break;
        }
        march_step(m, r, field_at(r, m.t));
    }
    evals = m.steps;
    return m.t;
}

#endif

/* masu_normalize(), faster for common lengths: half the operations. One return: with two, ANV keeps
 * registers for the result from one turn of the caller's loop to the next. */
vec3 unit_or(vec3 v, vec3 fallback)
{
    float squared = dot(v, v);
    bool plain = squared > masu_tiny && squared < masu_huge;
    vec3 unit = v * masu_rsqrt_sure(plain ? squared : 1.0);
    if (!plain) {
        unit = masu_normalize(v, fallback);
    }
    return unit;
}

/* Gradient from four samples at the corners of a tetrahedron (I. Quilez, "Normals for an SDF"). The
 * step grows with distance (0.02 pixel; a quarter, as in the plain march, rounds every edge of a
 * city: FLIP 0.013 against 0.002) and with the coordinates (64 ulp: the least sum of truncation and
 * rounding error). A loop compiles the field once here instead of four times; it computes point and
 * step each time, to keep no registers for them. `part`: the closest one. */
vec3 normal_at(ray r, float t, out uint part)
{
    vec4 f = vec4(0.0);
    MASU_LOOP for (int i = 0; i < 4; i++) {
        vec3 p = world_at(r.direction, t);
        vec3 a = abs(p);
        float h = max(normal_step * r.pixel * t, 64.0 * ulp * max(max(a.x, max(a.y, a.z)), t));
#ifdef MASU_SDF_KEEP
        /* The first sample selects the terms for the other three. */
        masu_keeping = MASU_SDF_BLOCK_WORDS > 0 && MASU_CHOOSING && i == 0;
        masu_margin = masu_keeping ? field_margin(r, t, 3.0 * h) : 0.0;
#endif
        bvec3 ahead = equal(ivec3(i), ivec3(0, 1, 2));
        p += mix(vec3(-h), vec3(h), i == 3 ? bvec3(true) : ahead);
        f = vec4(f.yzw, masu_sdf_with(p, part));
#ifdef MASU_SDF_KEEP
        if (masu_keeping) {
            masu_list_bits = masu_kept;
        }
#endif
    }
#ifdef MASU_SDF_KEEP
    masu_keeping = false;
    masu_margin = 0.0;
#endif
    vec3 sum = f.xyz - f.yzx + (f.w - f.zxy);
    return unit_or(sum, -r.direction);
}

/* The surface of a hit, and its normal. `known`: the hit is on half-space `part`. */
masu_surface surface_met(ray r, float t, bool known, uint part, out vec3 n)
{
    vec3 p = world_at(r.direction, t);
    masu_surface s = masu_plain_surface(vec3(0.5), 0.5);
    if (known) {
        n = unit_or(masu_sdf_flat_normal(part), -r.direction);
    } else {
        n = normal_at(r, t, part);
        masu_count(MASU_COUNTER_SDF_EVALS, 4u);
    }
    masu_normal = n;
#ifdef MASU_SDF_PAINTED
    masu_footprint = t * r.pixel;
#endif
    masu_sdf_part_surface(part, p, s);
    return s;
}

#endif
