/*
 * trace.glsl: one ray of a pixel: the march, the normal, the texels of what is hit, and the pixel's ray itself.
 *
 * Two marches. The plain one (Hart 1996) is the baseline of the report: it stops at 0.1 pixel cones and
 * refines twice by the secant. Ours (MASU_RELAXED) takes longer steps that it checks, and finds the
 * surface to 0.002 pixel: with 0.1, rims are thicker by that much, which put up to 0.5 % of the pixels
 * of thin rods on the wrong side and up to 3 % of the depths off by more than 1 %. Neither goes below
 * what fp32 can resolve, or the march never converges.
 *
 * Steps used up: the sample of least f/t stands for the surface if it came within 2 pixels (Keinert et
 * al., "Enhanced Sphere Tracing", STAG 2014, section 3.3), else the ray misses. Never "hit" by
 * default: that draws holes into the sky.
 */
#ifndef MASU_TRACE_GLSL
#define MASU_TRACE_GLSL

#include "shared/counters.h"
#include "shared/sdf_limits.h"
#include "sdf/field.glsl"

/* What an includer does where the next sample, at t, may not be behind this one. */
#ifndef MASU_WENT_BACK
#define MASU_WENT_BACK(t)
#endif

#ifndef MASU_MARCH_STEPS
#define MASU_MARCH_STEPS push.steps
#endif

/* The ray through a place in the picture, pixels, up to a raster depth (0: none) and inside the SDF's bounds. z_scale: distance
 * along the ray per unit of view z; at least 1. */
ray place_ray(vec2 place, uvec2 size, float raster, out float z_scale)
{
    float near = frame.forward.w;
    vec3 through = masu_place_ray(place, size);
    z_scale = length(through);
    float inverse = 1.0 / z_scale;
    ray r = ray(through * inverse, 2.0 * frame.up.w / float(size.y) * inverse, near * z_scale, frame.sdf_max.w);
    if (raster > 0.0) {
        r.limit = min(r.limit, near / raster * z_scale); /* a tie goes to the raster */
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
    return t > nearest ? min(nearest / t, 1.0) : 1.0; /* a GPU's quotient of a number and itself may be above 1 */
}

#ifdef MASU_SAFE_HINT
float masu_hint_delta = 0.0;
float masu_hint_free = 0.0;
bool masu_hint_open = true;

/* Chains the interval that a sample keeps free on the neighbours' rays; see march_checkerboard.comp. */
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

/* How a march ended. */
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

/* Each step as long as the field allows. */
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

/* Up to two secant steps, at most 16 tolerances ahead and never less than a plain step. A step that leads
 * further from the surface (past a thin part, out of a crease) is not taken. Not before the start: a
 * camera inside a solid sees it at the near plane, as a clipped polygon's inside would. */
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
const float newton_from = 0.3; /* pixels: nearer than this, and then at most so far ahead */
const float newton_reach = 2.0;
const float newton_lands = 0.15; /* its end is believed without a check, of a step of at most: */
const float newton_sure = 1.2;

/* No sample's coordinate exceeds the eye's by more than t: a bound of resolution() of few operations. */
float coarse = 8.0 * ulp * max(abs(eye_hi.x), max(abs(eye_hi.y), abs(eye_hi.z)));

float tolerance(ray r, float t)
{
    return max(0.002 * r.pixel * t, coarse + 8.0 * ulp * t);
}

/* A march between two samples. It asks for the field at t, and is done when t is the hit, or -1. */
struct march_state {
    float t;
    float before_t, before_f; /* the last sample that was right: the ray is free up to their sum */
    float limit;              /* of the ray, or narrower: a sample below 0 */
    float best_t, best_f;     /* sample of least f/t, or where that is 2 pixels */
    float apart;              /* what is further off, at distance 1, is far: two pixels' widths; 1e30 once it is narrowed */
    uint steps;
    bool narrowed, done;
};

march_state march_begin(ray r)
{
    bool any = r.start < r.limit;
    return march_state(any ? r.start : -1.0, r.start, 0.0, r.limit, 1.0, 2.0 * r.pixel,
                       2.0 * r.pixel + 8.0 * ulp, 0u, false, !any);
}

/* The sample that would stand for the surface is looked for in the second half of a ray's steps alone: hardly any ray comes
 * there, and looking takes six operations a sample. */
bool note_best(march_state m)
{
    return 2u * m.steps > MASU_MARCH_STEPS;
}

bool is_sure(float f, float pixel, float reach, float before_f)
{
    return MASU_SDF_ROUGH == 0 && f < newton_lands * pixel && before_f < newton_from * pixel &&
           reach <= newton_sure * pixel;
}

/* The field at m.t is f. Two ways: most samples are further off than two pixels' widths, and there a step is a
 * check, a slope and one division, some 25 operations. Nearer it is 90, all in one piece: neighbours take different
 * branches of it nearly always. No more than one division between a sample and the next point. Wrong turn: the one
 * piece for all samples. A CPU driver runs both ways whatever happens, and was 8 to 20 % faster with it; a
 * GPU's lanes are far off together, and near together.
 *
 * Steps go beyond the field's own distance, checked: a step s from a sample f1 to a sample f2 is right
 * when the two free spheres meet, s <= f1 + f2; else it is taken back and a plain step made. How
 * long to try: on a plane the field falls by a constant slope along the ray, and s = 2 f / (1 -
 * slope) makes the spheres just touch: up to twice the plain step, most where plain steps creep, at
 * grazing angles. The slope is that of the last two samples (Ban and Valasek, "Automatic Step Size
 * Relaxation in Sphere Tracing", Eurographics 2023; the check is Keinert et al. 2014). Wrong turn:
 * smoothing it over earlier ones; not one evaluation less in any scene.
 *
 * In the last third of a pixel the step is Newton's, to where the slope says that the field is 0:
 * half of all evaluations were spent there, since at a grazing angle each checked step takes only a
 * fixed share of what is left. It may end in a surface before the spheres meet, but then it was at
 * most two pixels' widths long: with four, rims at deep zooms were off by twice as much, for the same
 * number of evaluations. Where a step of Newton's, 1.2 pixels long at most, ends within 0.15 of a pixel it is believed
 * as well, and goes on from there: 8 to 12 % of all evaluations were repeated because it was not. But of a fractal
 * (MASU_SDF_ROUGH) what is that near may be anything: three times as many depths were off for it, and the spheres
 * have to meet. Wrong turn: steps of two pixels, or relaxed ones, believed like that. Of thin rods half as many pixels again
 * were on the wrong side. Wrong turn: letting any step end so. A relaxed step across the rim of
 * one ball into the next one lost the first.
 *
 * Newton's step from a sample below 0 leads back between it and the one before, and so it needs no
 * bracket of its own: the sample is the ray's new limit, no further step may pass half of what is
 * left to it, and the value before is halved, so that neither end stays for ever (the Illinois rule
 * of Dowell and Jarratt, BIT 11, 1971). Where the field jumps there is no 0: then what is left becomes
 * smaller than the tolerance. A sample that is near enough from above takes what is left by the last
 * slope, without another look. A camera inside a solid has no sample before: it sees it at the near
 * plane, as a clipped polygon's inside would. A field that is not a number is a miss. */
void march_between(inout march_state m, ray r, float f)
{
    float pixel = r.pixel * m.t;
    float enough = tolerance(r, m.t);
    float free = m.before_t + m.before_f;
    float reach = m.t - m.before_t;
    bool touched = f < enough;
    /* A longer step: newton, as far as the field falls; else relaxed, with a slope of at most 0.9. */
    float fall = m.before_f - f;
    bool newton = f < newton_from * pixel && fall > 0.0;
    float rate = (newton ? reach : 1.9 * reach) /
                 max(newton ? fall : max(reach + fall, 0.1 * reach), 1e-30);
    float longest = touched ? 16.0 * enough : newton_reach * pixel;
    float next = m.t + (newton ? min(f * rate, longest) : f * max(rate, 1.0));
    float most = m.narrowed ? 0.5 * (m.t + m.limit) : m.limit;
    next = next < most ? next : most;
    float end = m.narrowed ? m.t : next;
    /* Where it may end. */
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
    bool missed = gone || (hit && !(end < r.limit)) ||
                  (spent && !(m.best_f < 2.0 * r.pixel * m.best_t));
    m.done = hit || gone || spent;
    bool narrows = meet && through;
    m.limit = narrows ? m.t : m.limit;
    m.narrowed = m.narrowed || narrows;
    m.apart = m.narrowed ? 1e30 : m.apart;
    m.before_t = meet && !through ? m.t : m.before_t;
    m.before_f = meet ? (through ? 0.5 * m.before_f : f) : m.before_f;
    m.t = missed ? -1.0 : hit ? end : spent ? m.best_t : meet ? next : free;
    MASU_WENT_BACK(m.t)
}

/* The same of a ray that has met nothing below 0. Branches that end it early, since most samples need one or two of its
 * questions. */
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
    if (!meet && !spent) {
        m.t = free;
        MASU_WENT_BACK(free)
        return;
    }
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
        bool gone = hit ? !(next < r.limit) : meet && m.t + f >= m.limit;
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
}

/* Two pixels' widths and more away: nothing that could stand for the surface, nothing to narrow down. */
void march_far(inout march_state m, float f)
{
    float free = m.before_t + m.before_f;
    if (m.t - f > free) {
        m.t = free;
        MASU_WENT_BACK(free)
        return;
    }
    masu_note_hint(m.t, f);
    float reach = m.t - m.before_t;
    float rate = 1.9 * reach / max(max(reach + (m.before_f - f), 0.1 * reach), 1e-30);
    m.before_t = m.t;
    m.before_f = f;
    m.done = m.t + f >= m.limit;
    m.t = m.done ? -1.0 : min(m.t + f * max(rate, 1.0), m.limit);
}

void march_step(inout march_state m, ray r, float f)
{
    m.steps++;
    if (f > m.t * m.apart + coarse && m.steps < MASU_MARCH_STEPS) {
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

/* masu_normalize, of what mostly is neither tiny nor huge: half its operations. */
vec3 unit_or(vec3 v, vec3 fallback)
{
    float squared = dot(v, v);
    if (squared > masu_tiny && squared < masu_huge) {
        return v * masu_rsqrt_sure(squared);
    }
    return masu_normalize(v, fallback);
}

/* Gradient from four samples at the corners of a tetrahedron (I. Quilez, "Normals for an SDF"). The
 * step grows with distance (0.02 pixel: a quarter of one, as the plain march takes, rounds every edge of
 * a city; FLIP 0.013 against 0.002) and with the coordinates (64 ulp: the least total of truncation and rounding
 * error). One loop, so that the field is compiled once here and not four times; `part` is the
 * nearest one. */
vec3 normal_at(ray r, float t, out uint part)
{
    vec3 p = world_at(r.direction, t);
    vec3 a = abs(p);
    float h = max(normal_step * r.pixel * t, 64.0 * ulp * max(max(a.x, max(a.y, a.z)), t));
    vec3 corner = vec3(h, -h, -h);
    vec4 f = vec4(0.0);
#ifdef MASU_SDF_KEEP
    masu_keeping = MASU_SDF_BLOCK_WORDS > 0 && MASU_CHOOSING;
    masu_margin = masu_keeping ? field_margin(r, t, 3.0 * h) : 0.0;
#endif
    MASU_LOOP for (int i = 0; i < 4; i++) {
        f = vec4(f.yzw, masu_sdf_with(p + corner, part));
        corner = i == 2 ? vec3(h) : corner.zxy;
#ifdef MASU_SDF_KEEP
        /* The first one tells what matters to the other three. */
        if (masu_keeping) {
            masu_list_bits = masu_kept;
            masu_margin = 0.0;
            masu_keeping = false;
        }
#endif
    }
    vec3 sum = f.xyz - f.yzx + (f.w - f.zxy);
    return unit_or(sum, -r.direction);
}

/* The surface of a hit, and its normal; `known`: of half-space `part`. */
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
