/*
 * trace.glsl: one ray of a pixel: the march, the normal, and the pixel's ray itself.
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

#include "sdf/field.glsl"

/* The ray of a pixel, up to a raster depth (0: none) and inside the SDF's bounds. z_scale: distance
 * along the ray per unit of view z; at least 1. */
ray pixel_ray(uvec2 at, uvec2 size, float raster, out float z_scale)
{
    vec3 through = masu_pixel_ray(at, size);
    z_scale = length(through);
    float near = frame.forward.w;
    ray r;
    r.direction = through / z_scale;
    r.pixel = 2.0 * frame.up.w / float(size.y) / z_scale;
    r.start = near * z_scale;
    r.limit = frame.sdf_max.w;
    if (raster > 0.0) {
        r.limit = min(r.limit, near / raster * z_scale); /* a tie goes to the raster */
    }
    clip_to_bounds(r);
    return r;
}

/* Reverse-Z depth of a distance along a ray. */
float depth_of(float t, float z_scale)
{
    float nearest = frame.forward.w * z_scale;
    return nearest / max(t, nearest);
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
        if (m.hit || m.left || uint(i) >= pc.index.x) {
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
const float newton_reach = 4.0;
const uint bracket_steps = 12u;

float tolerance(ray r, float t)
{
    return max(0.002 * r.pixel * t, resolution(r, t));
}

/* A march between two samples. It asks for the field at t, and is done when t is the hit, or -1. */
struct march_state {
    float t;
    float before_t, before_f; /* the sample before; of a bracket: its end above 0 */
    float high_t, high_f;     /* of a bracket: its end below 0; high_t < 0: no bracket yet */
    float slope;              /* of the field along the ray; -1: as on a plane that is met head-on */
    float gap;                /* from before_t to t, if more than is proved free, else 0 */
    float best_t, best_ratio; /* sample of least f/t within 2 pixels, or -1 */
    uint steps;
    bool done;
};

march_state march_begin(ray r)
{
    return march_state(r.start, r.start, 0.0, -1.0, 0.0, -1.0, 0.0, -1.0, 2.0 * r.pixel, 0u, false);
}

/* The field at m.t is f; `usable` is false where it is not a number. No branches: neighbours take different
 * ones nearly always, and then each costs the sum.
 *
 * Steps go beyond the field's own distance, checked: a step s from a sample f1 to a sample f2 is right
 * when the two free spheres meet, s <= f1 + f2; else it is taken back and a plain step made. How
 * long to try: on a plane the field falls by a constant slope along the ray, and s = 2 f / (1 -
 * slope) makes the spheres just touch: up to twice the plain step, most where plain steps creep, at
 * grazing angles. The slope is that of the last samples (Ban and Valasek, "Automatic Step Size
 * Relaxation in Sphere Tracing", Eurographics 2023; the check is Keinert et al. 2014).
 *
 * In the last third of a pixel the step is Newton's, to where the slope says that the field is 0:
 * half of all evaluations were spent there, since at a grazing angle each checked step takes only a
 * fixed share of what is left. It may end in a surface before the spheres meet, but then it was at
 * most four pixels' widths long. Wrong turn: letting any step end so. A relaxed step across the rim of
 * one ball into the next one lost the first.
 *
 * A sample below 0 makes a bracket with the one before: the secant, with the Illinois halving so that
 * neither end stays for ever (Dowell and Jarratt, BIT 11, 1971). A sample that is near enough from
 * above takes what is left by the last slope, without another look. A camera inside a solid has no
 * sample before: it sees it at the near plane, as a clipped polygon's inside would. */
void march_step(inout march_state m, ray r, float f, bool usable)
{
    float pixel = r.pixel * m.t;
    float enough = tolerance(r, m.t);
    float reach = m.t - m.before_t;
    bool touched = f < enough;
    bool narrowing = m.high_t >= 0.0;
    bool meet = narrowing || m.gap <= m.before_f + f || (touched && reach <= newton_reach * pixel);
    /* Where it may end. */
    bool through = f < -enough && reach > 0.0;
    bool hit = usable && (narrowing ? abs(f) < enough : meet && touched && !through);
    bool inside = f < 0.0;
    bool bracket = meet && !hit && (narrowing || through);
    float rate = clamp(reach / max(m.before_f - f, 1e-30), 0.0, 16.0);
    float end = narrowing ? m.t : max(m.t + f * rate, m.before_t);
    /* A longer step. */
    float last = reach > 0.0 ? clamp((f - m.before_f) / reach, -1.0, 0.9) : -1.0;
    float slope = mix(m.slope, last, 0.7);
    float longer = max(1.9 * f / (1.0 - slope), f);
    float root = min(f / max(-last, 1e-6), newton_reach * pixel);
    longer = f < newton_from * pixel && last < 0.0 ? max(longer, root) : longer;
    bool leaves = m.t + f >= r.limit;
    longer = leaves ? f : min(longer, r.limit - m.t);
    /* The best so far. */
    float ratio = f / max(m.t, 1e-20);
    bool better = meet && ratio < m.best_ratio;
    m.best_t = better ? m.t : m.best_t;
    m.best_ratio = better ? ratio : m.best_ratio;
    /* A bracket's ends. */
    float high_t = bracket && inside ? m.t : m.high_t;
    float high_f = bracket ? (inside ? f : 0.5 * m.high_f) : m.high_f;
    float low_t = bracket && inside ? m.before_t : m.t;
    float low_f = bracket && inside ? (narrowing ? 0.5 : 1.0) * m.before_f : f;
    float share = clamp(high_f / min(high_f - low_f, -1e-30), 0.0, 1.0);
    float next = !meet ? m.before_t + m.before_f
                 : bracket ? mix(high_t, low_t, share) : m.t + longer;
    m.gap = meet && !bracket && longer > f ? longer : 0.0;
    m.slope = meet ? slope : -1.0;
    m.before_t = meet ? low_t : m.before_t;
    m.before_f = meet ? low_f : m.before_f;
    m.high_t = high_t;
    m.high_f = high_f;
    m.steps++;
    bool gone = !usable || (!hit && !(m.gap > 0.0) && !(next < r.limit));
    bool spent = !hit && !gone && m.steps >= pc.index.x;
    if (spent) {
        masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
    }
    m.done = hit || gone || spent;
    end = hit ? end : spent ? (narrowing ? m.t : m.best_t) : r.limit;
    m.t = m.done ? (end < r.limit ? end : -1.0) : next;
}

/* Distance along the ray of the first surface, or -1. */
float march(ray r, out uint evals)
{
    march_state m = march_begin(r);
    m.done = !(r.start < r.limit);
    m.t = m.done ? -1.0 : m.t;
    MASU_LOOP for (int i = 0; i < MASU_MARCH_STEPS_MAX; i++) {
        if (m.done) {
            break;
        }
        bool usable;
        float f = step_at(r, m.t, usable);
        march_step(m, r, f, usable);
    }
    evals = m.steps;
    return m.t;
}

#endif

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
    vec3 sum = vec3(0.0);
    MASU_LOOP for (int i = 0; i < 4; i++) {
        bvec3 plus = bvec3(i == 1 || i == 3, i >= 2, i == 0 || i == 3);
        vec3 corner = mix(vec3(-1.0), vec3(1.0), plus);
        sum += corner * masu_sdf_with(p + corner * h, part);
    }
    return masu_normalize(sum, -r.direction);
}

#endif
