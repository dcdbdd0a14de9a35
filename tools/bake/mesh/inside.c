/* inside.c: finds boxes inside closed parts of a mesh. A closed part has a winding number at every
 * point off its surface, constant in each region that the surface bounds. If no triangle of the
 * part touches a box, and the winding number at its centre is not 0, the whole box is inside, and
 * each ray from outside hits the part before the box. Boxes grow from a few seeds, face by face,
 * while this holds.
 *
 * Rejected alternatives: surfaces simplified by meshoptimizer. They cut corners outwards as well as
 * inwards, and an offset inwards by their error makes thin walls self-intersect; they pass no test
 * that boxes pass by construction. A mesh's own triangles, if it has few, would help with open
 * walls, but the renderer draws only boxes. */
#include "bake/mesh/occluders.h"
#include "bake/mesh/surface.h"

#include <stdlib.h>
#include <string.h>

#define PART_TRIANGLES 20000u /* larger parts take too long to grow boxes in */
#define MARGIN 1e-4 /* of the part's diagonal, between box and surface: more than floats lose */
#define SEEDS 8     /* triangles to start from */

typedef masu_bake_vec3 vec3;

/* ---- shapes ---- */

static void sides(vec3 size, double out[3]) { /* falling */
    out[0] = fmax(size.x, fmax(size.y, size.z));
    out[2] = fmin(size.x, fmin(size.y, size.z));
    out[1] = fmax(fmin(size.x, size.y), fmin(fmax(size.x, size.y), size.z));
}

double masu_bake_second_side(const masu_bake_box *box) {
    double s[3];
    sides(masu_bake_sub(box->high, box->low), s);
    return s[1];
}

/* Heuristic: a convex body covers on average a quarter of its surface area (Cauchy). The better
 * occluder has the larger surface, not the largest face, which would prefer a thin sheet. */
static double surface_of(const masu_bake_box *box) {
    double s[3];
    sides(masu_bake_sub(box->high, box->low), s);
    return s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
}

/* ---- growing ---- */

typedef struct solid {
    const vec3 (*triangles)[3];
    size_t count;
    masu_bake_box box;
    double margin;
} solid;

static bool clear(const solid *s, const masu_bake_box *box) {
    for (size_t i = 0; i < s->count; i++) {
        if (!masu_bake_box_apart(box, s->triangles[i], s->margin)) return false;
    }
    return true;
}

static bool inside(const solid *s, vec3 p) {
    return fabs(masu_bake_winding(s->triangles, s->count, p)) > 0.5;
}

/* Corners as rounded in the blob, because the renderer draws those. */
static masu_bake_box rounded(const masu_bake_box *b) {
    return (masu_bake_box){
        {(double)(float)b->low.x, (double)(float)b->low.y, (double)(float)b->low.z},
        {(double)(float)b->high.x, (double)(float)b->high.y, (double)(float)b->high.z}};
}

static double *side_of(masu_bake_box *b, int face) {
    vec3 *v = face < 3 ? &b->low : &b->high;
    return face % 3 == 0 ? &v->x : face % 3 == 1 ? &v->y : &v->z;
}

static bool grow(const solid *s, vec3 seed, masu_bake_box *out) {
    vec3 size = masu_bake_sub(s->box.high, s->box.low);
    const double extent[3] = {size.x, size.y, size.z};
    masu_bake_box box = {seed, seed};
    for (int i = 0; i < 6; i++) *side_of(&box, i) += (i < 3 ? -1 : 1) * 4 * s->margin;
    if (!clear(s, &box) || !inside(s, seed)) return false;
    double step[6];
    for (int i = 0; i < 6; i++) step[i] = extent[i % 3] / 24; /* all sides grow alike */
    for (bool more = true; more;) {
        more = false;
        for (int i = 0; i < 6; i++) {
            if (step[i] < extent[i % 3] / 400) continue;
            masu_bake_box larger = box;
            *side_of(&larger, i) += i < 3 ? -step[i] : step[i];
            if (clear(s, &larger))
                box = larger;
            else
                step[i] /= 2;
            more = true;
        }
    }
    *out = rounded(&box);
    return clear(s, out) &&
           inside(s, masu_bake_mad(out->low, masu_bake_sub(out->high, out->low), 0.5));
}

/* The point half way from the centroid of a triangle to the opposite surface, on its inner or outer
 * side. */
static bool half_way(const solid *s, size_t triangle, double side, vec3 *out) {
    const vec3 *t = s->triangles[triangle];
    vec3 e0 = masu_bake_sub(t[1], t[0]), e1 = masu_bake_sub(t[2], t[0]);
    vec3 n = masu_bake_cross(e0, e1),
         p = masu_bake_mad(masu_bake_mad(t[0], e0, 1.0 / 3), e1, 1.0 / 3);
    if (!masu_bake_normalize(&n)) return false;
    n = masu_bake_v3(n.x * side, n.y * side, n.z * side);
    double nearest = DBL_MAX;
    for (size_t i = 0; i < s->count; i++) { /* Moller and Trumbore 1997 */
        const vec3 *o = s->triangles[i];
        vec3 f0 = masu_bake_sub(o[1], o[0]), f1 = masu_bake_sub(o[2], o[0]);
        vec3 h = masu_bake_cross(n, f1), from = masu_bake_sub(p, o[0]);
        double det = masu_bake_dot(f0, h), u = masu_bake_dot(from, h) / det;
        vec3 q = masu_bake_cross(from, f0);
        double v = masu_bake_dot(n, q) / det, along = masu_bake_dot(f1, q) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && along > s->margin) nearest = fmin(nearest, along);
    }
    *out = masu_bake_mad(p, n, nearest / 2);
    return nearest < DBL_MAX;
}

/* The best box in one closed part. Seeds: the centre, the centres of the octants, and points behind
 * some triangles, because a ring does not contain its own centre. */
static bool box_in(const solid *s, masu_bake_box *best) {
    bool found = false;
    vec3 size = masu_bake_sub(s->box.high, s->box.low);
    for (int i = 0; i < 9 + 2 * SEEDS; i++) {
        vec3 seed;
        if (i < 9) {
            double f[3];
            for (int k = 0; k < 3; k++) f[k] = i == 0 ? 0.5 : (i - 1) >> k & 1 ? 0.75 : 0.25;
            seed = masu_bake_v3(s->box.low.x + size.x * f[0], s->box.low.y + size.y * f[1],
                                s->box.low.z + size.z * f[2]);
        } else {
            size_t at = s->count * (size_t)((i - 9) / 2) / SEEDS;
            if (!half_way(s, at, i & 1 ? 1 : -1, &seed)) continue;
        }
        masu_bake_box box;
        if (grow(s, seed, &box) && (!found || surface_of(&box) > surface_of(best))) {
            *best = box;
            found = true;
        }
        if (found && surface_of(best) > 0.7 * surface_of(&s->box)) break; /* hardly better */
    }
    return found;
}

/* ---- parts of a mesh ---- */

typedef struct parts {
    vec3 (*triangles)[3]; /* sorted by part */
    size_t *first;        /* by part, and the end */
    bool *closed;
    uint32_t count;
} parts;

static parts split(const vec3 (*triangles)[3], size_t count) {
    uint32_t *part = masu_bake_allocate(count * sizeof *part);
    parts p = {.triangles = masu_bake_allocate(count * sizeof *p.triangles),
               .first = masu_bake_allocate((count + 2) * sizeof *p.first),
               .closed = masu_bake_allocate(count * sizeof *p.closed)};
    p.count = masu_bake_surface_parts(triangles, count, part, p.closed);
    memset(p.first, 0, (count + 2) * sizeof *p.first);
    for (size_t i = 0; i < count; i++) p.first[part[i] + 2]++;
    for (uint32_t i = 0; i < p.count; i++) p.first[i + 2] += p.first[i + 1];
    for (size_t i = 0; i < count; i++) {
        memcpy(p.triangles[p.first[part[i] + 1]++], triangles[i], sizeof p.triangles[0]);
    }
    free(part);
    return p;
}

static void release(parts *p) {
    free(p->triangles);
    free(p->first);
    free(p->closed);
}

static solid solid_of(const parts *p, uint32_t i) {
    solid s = {.triangles = (const vec3(*)[3])(p->triangles + p->first[i]),
               .count = p->first[i + 1] - p->first[i],
               .box = masu_bake_box_empty()};
    for (size_t k = 0; k < s.count; k++) {
        for (int c = 0; c < 3; c++) masu_bake_box_grow(&s.box, s.triangles[k][c]);
    }
    s.margin = MARGIN * masu_bake_length(masu_bake_sub(s.box.high, s.box.low));
    return s;
}

/* ---- the mesh ---- */

uint32_t masu_bake_boxes_inside(const vec3 (*triangles)[3], size_t count, double least,
                                masu_bake_box best[MASU_BAKE_BOXES_MAX]) {
    uint32_t found = 0;
    parts p = split(triangles, count);
    for (uint32_t i = 0; i < p.count; i++) {
        solid s = solid_of(&p, i);
        masu_bake_box box;
        if (!p.closed[i] || s.count > PART_TRIANGLES || !(masu_bake_second_side(&s.box) >= least))
            continue;
        if (!box_in(&s, &box) || !(masu_bake_second_side(&box) >= least)) continue;
        uint32_t at = found < MASU_BAKE_BOXES_MAX ? found++ : MASU_BAKE_BOXES_MAX;
        for (; at > 0 && surface_of(&best[at - 1]) < surface_of(&box); at--) {
            if (at < MASU_BAKE_BOXES_MAX) best[at] = best[at - 1];
        }
        if (at < MASU_BAKE_BOXES_MAX) best[at] = box;
    }
    release(&p);
    return found;
}

bool masu_bake_is_inside(const vec3 (*triangles)[3], size_t count, const masu_bake_box *box) {
    parts p = split(triangles, count);
    vec3 middle = masu_bake_mad(box->low, masu_bake_sub(box->high, box->low), 0.5);
    bool good = false;
    for (uint32_t i = 0; i < p.count && !good; i++) {
        solid s = solid_of(&p, i);
        s.margin *= 0.01; /* the box was added with more margin */
        good = p.closed[i] && clear(&s, box) && inside(&s, middle);
    }
    release(&p);
    return good;
}
