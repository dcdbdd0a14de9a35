/*
 * trace.glsl: one ray of a pixel: the march, the normal, and the pixel's ray itself.
 *
 * Stop: f < 0.1 pixel cones, but never below what fp32 can resolve there: 8 ulp of the largest
 * coordinate involved (the field's own rounding is up to 6.1 ulp; below it a march never
 * converges). Then up to two refining steps by the secant of the last two samples, while f is above
 * 0.01 pixel: at grazing angles f falls slowly along the ray, and a step of f alone leaves depth
 * 1.5e-3 off at the rim of a sphere 150 pixels across, the secant 5.9e-5. Steps used up: the sample of least f/t stands for the
 * surface if it came within 2 pixels (Keinert et al., "Enhanced Sphere Tracing", STAG 2014, section
 * 3.3), else the ray misses. Never "hit" by default: that draws holes into the sky.
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
    r.rounding = rounding_at_eye();
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

#define NEWTON_NEAR 0.3
#define NEWTON_FAR 4.0
#ifdef MASU_RELAXED
#define REFINE 3
#define ENOUGH 0.005
#define REACH (r.pixel * m.t)
#define NORMAL_STEP 0.02
#else
#define REFINE 2
#define ENOUGH 0.01
#define REACH tolerance(r, m.t)
#define NORMAL_STEP 0.25
#endif

#ifndef MASU_RELAXED

float tolerance(ray r, float t)
{
    return max(0.1 * r.pixel * t, resolution(r, t));
}

/* Hart 1996: each step as long as the field allows. */
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

#else

float tolerance(ray r, float t)
{
    return max(0.002 * r.pixel * t, resolution(r, t));
}

/* Steps beyond the field's own distance, checked: a step s from a sample f1 to a sample f2 is right
 * when the two free spheres meet, s <= f1 + f2; else it is taken back and a plain step made. How
 * long to try: on a plane the field falls by a constant slope along the ray, and s = 2 f / (1 -
 * slope) makes the spheres just touch: up to twice the plain step, most where plain steps creep, at
 * grazing angles. The slope is that of the last samples (Ban and Valasek, "Automatic Step Size
 * Relaxation in Sphere Tracing", Eurographics 2023; the check is Keinert et al. 2014).
 *
 * Within a pixel of the surface the step is Newton's, to where the slope says that the field is 0: the
 * last pixel costs most of a march otherwise, since at a grazing angle each checked step takes only a
 * fixed share of what is left. It goes past what is proved free, by a few pixels' widths at most, and
 * stands only where the field is then 0 or below, or the spheres meet after all. */
march_end walk(ray r)
{
    march_end m = march_end(r.start, 0.0, r.start, 0.0, -1.0, false, false, 0u);
    float best_ratio = 2.0 * r.pixel;
    float slope = -1.0; /* of plain steps */
    float reach = 0.0;  /* from before_t to t, as tried */
    bool sure = true;   /* the way from before_t to t is free whatever f turns out to be */
    MASU_LOOP for (int i = 0; i < MASU_MARCH_STEPS_MAX; i++) {
        m.left = m.left || (sure && !(m.t < r.limit));
        if (m.hit || m.left || uint(i) >= pc.index.x) {
            break;
        }
        bool usable;
        float f = step_at(r, m.t, usable);
        m.evals++;
        m.left = !usable;
        bool touched = f < tolerance(r, m.t);
        bool leap = touched && reach <= NEWTON_FAR * r.pixel * m.t;
        bool apart = usable && !sure && !leap && reach > m.before_f + f;
        if (apart) {
            m.t = m.before_t + m.before_f;
            reach = m.before_f;
            sure = true;
            slope = -1.0;
        } else if (usable) {
            m.f = f;
            m.hit = touched && m.t < r.limit;
            m.left = !(m.t < r.limit);
            if (!m.hit && !m.left) {
                note_best(m, best_ratio, m.t, f);
                masu_note_hint(m.t, f);
                float raw = reach > 0.0 ? clamp((f - m.before_f) / reach, -1.0, 0.9) : -1.0;
                slope = mix(slope, raw, 0.7);
                float plain = f;
                reach = max(1.9 * f / (1.0 - slope), plain);
                float pixel = r.pixel * m.t;
                bool close = f < NEWTON_NEAR * pixel && raw < 0.0;
                reach = close ? max(reach, min(f / max(-raw, 1e-6), NEWTON_FAR * pixel)) : reach;
                m.before_t = m.t;
                m.before_f = f;
                sure = !(reach > plain);
                /* Not past the limit unless a plain step already is: the end is checked as well. */
                reach = sure || m.t + plain >= r.limit ? plain : min(reach, r.limit - m.t);
                sure = sure || m.t + plain >= r.limit;
                m.t += reach;
            }
        }
    }
    m.left = m.left || (sure && !(m.t < r.limit));
    return m;
}

#endif

/* Distance along the ray of the first surface, or -1. */
float march(ray r, out uint evals)
{
    march_end m = walk(r);
    evals = m.evals;
    if (!m.hit) {
        if (m.left) {
            return -1.0;
        }
        masu_count(MASU_COUNTER_SDF_UNCONVERGED, 1u);
        return m.best_t;
    }
#ifdef MASU_RELAXED
    /* Below 0 the surface lies between the last two samples: the secant, with the Illinois halving
     * (Dowell and Jarratt 1971) so that neither end stays. */
    float low = m.before_t;
    float low_f = m.before_f;
    float high = m.t;
    float high_f = m.f;
    MASU_LOOP for (int i = 0; i < 12; i++) {
        if (!(m.f < -max(0.005 * r.pixel * m.t, resolution(r, m.t))) || !(low < high)) {
            break;
        }
        float t = high - (high - low) * high_f / min(high_f - low_f, -1e-30);
        t = clamp(t, low, high);
        bool usable;
        float f = step_at(r, t, usable);
        evals++;
        low_f = f < 0.0 ? 0.5 * low_f : f;
        high_f = f < 0.0 ? f : 0.5 * high_f;
        low = f < 0.0 ? low : t;
        high = f < 0.0 ? t : high;
        m.t = t;
        m.f = f < 0.0 ? f : 0.0;
        if (f > tolerance(r, t)) { m.f = -1e30; }
    }
#else
    MASU_LOOP for (int i = 0; i < REFINE; i++) {
        float enough = max(ENOUGH * r.pixel * m.t, resolution(r, m.t));
        if (abs(m.f) < enough) {
            break;
        }
        /* The secant, at most 16 tolerances ahead and never less than a plain step. A step that
         * leads further from the surface (past a thin part, out of a crease) is not taken. Not
         * before the start: a camera inside a solid sees it at the near plane, as a clipped
         * polygon's inside would. */
        float fall = m.before_f - m.f;
        float rate = fall > 1e-30 ? (m.t - m.before_t) / fall : 1.0;
        float reach = 16.0 * REACH;
        float next_t = max(m.t + clamp(m.f * max(rate, 1.0), -reach, reach), r.start);
        bool usable;
        float next_f = step_at(r, next_t, usable);
        evals++;
        if (usable && abs(next_f) < abs(m.f)) {
            m.before_t = m.t;
            m.before_f = m.f;
            m.t = next_t;
            m.f = next_f;
        }
    }
#endif
    return m.t < r.limit ? m.t : -1.0;
}

/* Gradient from four samples at the corners of a tetrahedron (I. Quilez, "Normals for an SDF"). The
 * step grows with distance (a quarter of a pixel: with half of one, a sphere 60 pixels across is
 * off by 0.5 degrees) and with the coordinates (64 ulp: the least total of truncation and rounding
 * error). One loop, so that the field is compiled once here and not four times. */
vec3 normal_at(ray r, float t)
{
    vec3 p = world_at(r.direction, t);
    vec3 a = abs(p);
    float h = max(NORMAL_STEP * r.pixel * t, 64.0 * ulp * max(max(a.x, max(a.y, a.z)), t));
    vec3 sum = vec3(0.0);
    MASU_LOOP for (int i = 0; i < 4; i++) {
        bvec3 plus = bvec3(i == 1 || i == 3, i >= 2, i == 0 || i == 3);
        vec3 corner = mix(vec3(-1.0), vec3(1.0), plus);
        sum += corner * masu_sdf(p + corner * h);
    }
    return masu_normalize(sum, -r.direction);
}

#endif
