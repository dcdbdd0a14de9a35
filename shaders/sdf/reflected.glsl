/*
 * reflected.glsl: SDF rays that leave a surface: the parts that they can hit, the march. Start at
 * march_reflected().
 *
 * CONE. march_step expects a cone whose width is 0 at the camera. A reflected ray starts one pixel
 * wide at the surface, so distances are measured from the apex that its cone has behind the
 * surface: for a flat mirror the mirror image of the camera. world_at then counts from the apex,
 * whose position replaces the camera's. Rejected: a cone that grows with a share of the lobe,
 * although nobody sees to 1/500 pixel where the ray of a rough surface ends. The last steps are
 * Newton's, so it saved no evaluation (shares of 0, 0.05 and 1 of the width of half the light,
 * roughness 0.3: 12.7, 13.2, 16.7 per ray of parts300), and a wider cone touches more parts
 * (evaluations times parts: 44, 51, 353).
 *
 * LEAVING. A ray starts at a lift above its surface, 1/8 pixel plus the fp32 resolution; the march
 * would stop at 1/500. While the surface is within twice that tolerance (a crease, a field much
 * flatter than a distance) the ray advances by one lift per step, at most LEAVE_STEPS: half a
 * pixel. A ray that is still inside a solid then has hit it there.
 *
 * STEP LIMIT. The sample of least f/t is taken as the surface as in trace.glsl, but only after the
 * field has begun to fall: before, the least is always at the start, and the surface would hit
 * itself.
 *
 * PARTS. Rays of neighbouring pixels diverge at a rough or curved surface, so a shared list of a
 * block holds many parts that a single ray cannot hit. Each ray makes its own list: the parts whose
 * bounding sphere its cone touches before its end, as bits if the scene has few, else as numbers in
 * shared memory. That costs as much as one sample of all parts. A full list is filtered again for
 * the closer half of the ray (parts outside it are dropped for good), and the rest of the ray
 * becomes another piece. The last of PIECES pieces, and a piece that is still full after HALVINGS,
 * evaluates all parts. Rejected: all parts at once if a list is full: 0.4 % of the rays over 4096
 * balls in rows did, and made 84 % of all evaluations. Omitting a part makes steps longer, never
 * wrong.
 *
 * Defined before: MASU_RELAXED, MASU_SDF_NO_FLAT; INVOCATIONS of a workgroup.
 */
#ifndef MASU_REFLECTED_GLSL
#define MASU_REFLECTED_GLSL

#include "shared/sdf_limits.h"

#define MOST_LISTED 30
#define MASU_OWN_PARTS (INVOCATIONS * MOST_LISTED / 2)
#define MASU_OWN_PARTS_HALVES
#define MASU_MARCH_STEPS min(push.steps, uint(MASU_REFLECTED_STEPS_MAX))
#include "sdf/trace.glsl"

#define LEAVE_STEPS 4
#define PIECES 8
#define HALVINGS 6

struct reflected {
    ray along;   /* start and limit are from the apex */
    float apex;  /* distance from the apex to the ray's origin */
    float lift;
    float end;   /* hit of the nearest half-space, or -1 */
    uint part;   /* number of the half-space */
};

/* `from`: the lifted start relative to the camera, where the cone is `width` wide, growing by
 * `spread`. */
reflected reflected_ray(vec3 from, vec3 direction, float width, float spread, float lift,
                        float longest)
{
    reflected m;
    m.apex = clamp(width / max(spread, 1e-6), 0.0, 1e9);
    m.lift = lift;
    eye_lo = frame.sdf_eye_lo.xyz + (from - direction * m.apex);
    vec3 a = abs(frame.sdf_eye_hi.xyz), b = abs(from);
    coarse = 8.0 * ulp * (max(a.x, max(a.y, a.z)) + max(b.x, max(b.y, b.z)));
    m.along = ray(direction, max(spread, 1e-6), m.apex, m.apex + longest);
    clip_to_box(m.along, frame.sdf_min.xyz, frame.sdf_max.xyz);
    float end = masu_sdf_flat(world_at(direction, m.apex), direction, m.along.start - m.apex,
                              m.part) +
                m.apex;
    bool ends = end < m.along.limit;
    m.end = ends ? end : -1.0;
    vec3 low, high;
    masu_listed_box(low, high);
    float farthest = ends ? end : m.along.limit;
    clip_to_box(m.along, low, high);
    /* As in march.comp: a hit on the very side of the box may be found slightly behind it. */
    m.along.limit = min(m.along.limit * (1.0 + newton_reach * m.along.pixel), farthest);
    return m;
}

/* Whether the ray, widened to the hit tolerance of its march, comes near a sphere. */
bool can_meet(ray r, vec4 sphere)
{
    vec3 c = sphere.xyz - eye_hi - eye_lo;
    float t = clamp(dot(c, r.direction), r.start, r.limit);
    vec3 off = c - r.direction * t;
    vec3 a = abs(eye_hi);
    /* The centre of a touched sphere is within t + radius of the apex. */
    float slack = 128.0 * ulp * (sphere.w + max(a.x, max(a.y, a.z)) + t);
    float reach = sphere.w + newton_reach * r.pixel * (t + sphere.w) + slack;
    return !(sphere.w >= 0.0) || !(dot(off, off) > reach * reach); /* negated: unbounded, or not a
                                                                    * number */
}

/* Selects the parts for a piece of the ray from its start on: the whole ray if its list holds the
 * parts, else half as often as needed. False: no parts. */
bool use_parts_on(inout ray r, bool last)
{
#if MASU_SDF_LISTED_COUNT == 0
    return false;
#else
    if (!(r.start < r.limit)) {
        return false;
    }
    if (MASU_SDF_LISTED_COUNT == 1) {
        return true;
    }
    uint count = 0u;
#if MASU_SDF_MASKED
    for (int w = 0; w < MASU_LIST_WORDS; w++) {
        masu_list_bits[w] = 0u;
    }
    for (uint part = 0u; part < uint(MASU_SDF_LISTED_COUNT); part++) {
        if (can_meet(r, masu_sdf_bounds(part))) {
            masu_list_bits[part >> 5] |= 1u << (part & 31u);
            count++;
        }
    }
#else
    masu_list_first = gl_LocalInvocationIndex * uint(MOST_LISTED);
    masu_list_count = 0u; /* masu_part_at() reads the list */
    bool fits = true;
    for (uint part = 0u; part < uint(MASU_SDF_LISTED_COUNT); part++) {
        if (!can_meet(r, masu_sdf_bounds(part))) {
            continue;
        }
        for (int h = 0; h < HALVINGS; h++) {
            if (count < uint(MOST_LISTED) || last) {
                break;
            }
            r.limit = 0.5 * (r.start + r.limit);
            count = 0u;
            for (uint i = 0u; i < uint(MOST_LISTED); i++) {
                uint other = masu_part_at(i);
                if (can_meet(r, masu_sdf_bounds(other))) {
                    masu_own_part_write(masu_list_first + count, other);
                    count++;
                }
            }
        }
        if (can_meet(r, masu_sdf_bounds(part))) {
            fits = fits && count < uint(MOST_LISTED);
            if (fits) {
                masu_own_part_write(masu_list_first + count, part);
            }
            count++;
        }
        count = min(count, uint(MOST_LISTED));
    }
    masu_list_count = fits ? count : MASU_TILE_ALL;
#endif
    return count != 0u;
#endif
}

/* Distance from the apex to the first hit with the listed parts, or -1. */
float march_listed(reflected m, ray r, inout uint evals)
{
    march_state s = march_begin(r);
    bool leaving = r.start == m.apex, falls = r.start > m.apex;
    float before = 0.0;
    MASU_LOOP for (int i = 0; i < MASU_REFLECTED_STEPS_MAX + LEAVE_STEPS; i++) {
        if (s.done) {
            break;
        }
        float f = field_at(r, s.t);
        evals++;
        leaving = leaving && i < LEAVE_STEPS && f < 2.0 * tolerance(r, s.t);
        if (leaving) {
            s.t += m.lift;
            s.before_t = s.t;
            s.done = !(s.t < r.limit);
            s.t = s.done ? -1.0 : s.t;
        } else {
            falls = falls || f < before;
            before = f;
            if (!falls) {
                s.best_t = 1.0;
                s.best_f = 2.0 * r.pixel;
            }
            march_step(s, r, f);
            bool spent = s.done && s.steps >= MASU_MARCH_STEPS;
            s.t = spent && !falls ? -1.0 : s.t;
        }
    }
    return s.done ? s.t : -1.0;
}

/* Distance from the apex to the first hit with any part, or -1. */
float march_reflected(reflected m, inout uint evals)
{
    ray r = m.along;
    float t = -1.0;
    MASU_LOOP for (int i = 0; i < (MASU_SDF_MASKED != 0 ? 1 : PIECES); i++) {
        if (t >= 0.0 || !(r.start < m.along.limit)) {
            break;
        }
        r.limit = m.along.limit;
        if (use_parts_on(r, i == PIECES - 1)) {
            t = march_listed(m, r, evals);
        }
        r.start = r.limit;
    }
    return t;
}

#endif
