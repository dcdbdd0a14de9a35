/* cull.c: see cull.h. Boxes are tested four at a time, with SSE2 or with a loop over four lanes
 * that does the same operations in the same order; groups are tested one at a time. No multiply-add
 * is fused (-ffp-contract=off), so both variants give bit-identical results. */
#include "scene/cull.h"

#include "shared/floats.h"

#include <float.h>
#include <math.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#define HAS_SIMD 1
#else
#define HAS_SIMD 0
#endif

#define LANES 4u

/* ---- Boxes ----------------------------------------------------------------------------------- */

/* The next float at or above v >= 0, or the float after that. */
static float round_up(double v) {
    float f = (float)v;
    return (double)f < v ? f + (f * 0x1p-23f + 0x1p-149f) : f;
}

static masu_cull_box box_of(const double low[3], const double high[3]) {
    masu_cull_box box;
    for (uint32_t k = 0; k < 3; k++) {
        box.center[k] = (float)(0.5 * (low[k] + high[k]));
        double c = (double)box.center[k];
        double below = c - low[k], above = high[k] - c;
        box.half[k] = round_up(below > above ? below : above);
        /* Too far away, or NaN: such a box gets infinite extents. */
        if (!(fabsf(box.center[k]) <= FLT_MAX) || !(box.half[k] <= FLT_MAX)) {
            box.center[k] = 0.0f;
            box.half[k] = INFINITY;
        }
    }
    return box;
}

masu_cull_box masu_cull_place(const float rows[12], const float low[3], const float high[3]) {
    double from[3], to[3];
    for (uint32_t i = 0; i < 3; i++) {
        const float *row = rows + 4 * i;
        double c = (double)row[3], h = 0.0, most = fabs((double)row[3]);
        for (uint32_t k = 0; k < 3; k++) {
            double a = (double)row[k], l = (double)low[k], u = (double)high[k];
            c += a * 0.5 * (l + u);
            h += fabs(a) * 0.5 * fabs(u - l);
            most += fabs(a) * (fabs(l) > fabs(u) ? fabs(l) : fabs(u));
        }
        /* rounding of a sum of four products in fp32, and of two subtractions */
        h += 0x1p-21 * most;
        from[i] = c - h;
        to[i] = c + h;
    }
    return box_of(from, to);
}

masu_cull_box masu_cull_widen(const masu_cull_box *box, float scale) {
    masu_cull_box wide = *box;
    for (uint32_t k = 0; k < 3; k++) {
        float c = fabsf(wide.center[k]), h = wide.half[k];
        if (!(c <= MASU_CULL_FAR) || !(h <= MASU_CULL_FAR)) {
            wide.center[k] = 0.0f;
            wide.half[k] = INFINITY;
            continue;
        }
        /* A degenerate box may have low > high: uses the distance of its corners. */
        wide.half[k] =
            round_up(fabs((double)h) + (double)(scale * MASU_CULL_SLACK) * (double)c);
    }
    return wide;
}

int masu_cull_holds(const masu_cull_box *outer, const masu_cull_box *inner) {
    for (uint32_t k = 0; k < 3; k++) {
        double apart = fabs((double)outer->center[k] - (double)inner->center[k]);
        if (!(apart + (double)inner->half[k] <= (double)outer->half[k])) return 0;
    }
    return 1;
}

masu_cull_box masu_cull_around(const masu_cull_box *boxes, uint32_t n) {
    double low[3], high[3];
    for (uint32_t k = 0; k < 3; k++) {
        low[k] = (double)INFINITY;
        high[k] = -(double)INFINITY;
        for (uint32_t i = 0; i < n; i++) {
            double c = (double)boxes[i].center[k], h = (double)boxes[i].half[k];
            if (!(c - h >= low[k])) low[k] = c - h;
            if (!(c + h <= high[k])) high[k] = c + h;
        }
    }
    return box_of(low, high);
}

/* ---- Views ----------------------------------------------------------------------------------- */

void masu_cull_add_plane(masu_cull_view *view, const double n[3], double d) {
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (view->count == MASU_CULL_PLANES || !(length > 0.0) || !(length <= DBL_MAX)) return;
    double distance = d / length;
    if (!(fabs(distance) <= (double)MASU_CULL_FAR)) return;
    masu_cull_plane *p = &view->planes[view->count++];
    for (uint32_t k = 0; k < 3; k++) {
        p->n[k] = (float)(n[k] / length);
        p->a[k] = fabsf(p->n[k]);
    }
    p->d = (float)distance;
    p->slack[0] = MASU_CULL_SLACK * fabsf(p->d);
    p->slack[1] = 4.0f * p->slack[0];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void masu_cull_camera(masu_cull_view *view, const float clip_from_rel[16], const double eye[3],
                      float near_distance) {
    view->count = 0;
    for (uint32_t plane = 0; plane < 5; plane++) {
        double n[3];
        for (uint32_t k = 0; k < 3; k++) {
            double side = plane < 4 ? (double)clip_from_rel[4 * k + plane / 2] : 0.0;
            n[k] = (double)clip_from_rel[4 * k + 3] + (plane % 2 ? -side : side);
        }
        masu_cull_add_plane(view, n, -dot(n, eye) - (plane < 4 ? 0.0 : (double)near_distance));
    }
}

/* ---- Groups ---------------------------------------------------------------------------------- */

static float signed_distance(const masu_cull_plane *p, const float c[3]) {
    return ((p->n[0] * c[0] + p->n[1] * c[1]) + p->n[2] * c[2]) + p->d;
}

static float radius(const masu_cull_plane *p, const float h[3], uint32_t kind) {
    return ((p->a[0] * h[0] + p->a[1] * h[1]) + p->a[2] * h[2]) + p->slack[kind];
}

#define ALL_OUT 0x80u

/* Returns 0 if the group is inside of plane p, its bit if it intersects it, ALL_OUT if it is
 * outside. */
static inline uint32_t test_plane(const masu_cull_node *node, const masu_cull_view *view,
                                  uint32_t p) {
    float m = signed_distance(&view->planes[p], node->box.center);
    float r = radius(&view->planes[p], node->box.half, 1);
    if (m + r < 0.0f) return ALL_OUT;
    return m - r >= 0.0f ? 0 : 1u << p;
}

/* Returns the planes of `mask` that intersect the group, or ALL_OUT. *last: the plane to test
 * first, before the others in order; set to the plane that rejected the group. */
static uint32_t test_node(const masu_cull_node *node, const masu_cull_view *view, uint32_t mask,
                          uint8_t *last, uint64_t *tests) {
    uint32_t first = *last & 7u, cut = 0, left = mask & ~(1u << first);
    if (left != mask) {
        ++*tests;
        cut = test_plane(node, view, first);
        if (cut == ALL_OUT) return ALL_OUT;
    }
    for (uint32_t p = 0; left; p++, left >>= 1) {
        if (!(left & 1u)) continue;
        ++*tests;
        uint32_t found = test_plane(node, view, p);
        if (found == ALL_OUT) {
            *last = (uint8_t)p;
            return ALL_OUT;
        }
        cut |= found;
    }
    return cut;
}

/* ---- Boxes, four at a time ------------------------------------------------------------------- */

/* Bit l: box `at` + l is outside the plane. */
static uint32_t outside_plain(const masu_cull_set *set, uint32_t at, const masu_cull_plane *p) {
    uint32_t out = 0;
    for (uint32_t l = 0; l < LANES; l++) {
        float c[3], h[3];
        for (uint32_t k = 0; k < 3; k++) {
            c[k] = set->boxes[k][at + l];
            h[k] = set->boxes[3 + k][at + l];
        }
        if (signed_distance(p, c) + radius(p, h, 0) < 0.0f) out |= 1u << l;
    }
    return out;
}

#if HAS_SIMD
static __m128 scaled(const float *v, float by) {
    return _mm_mul_ps(_mm_set1_ps(by), _mm_loadu_ps(v));
}

static uint32_t outside_simd(const masu_cull_set *set, uint32_t at, const masu_cull_plane *p) {
    const float *const *b = set->boxes;
    __m128 m = _mm_add_ps(scaled(b[0] + at, p->n[0]), scaled(b[1] + at, p->n[1]));
    m = _mm_add_ps(_mm_add_ps(m, scaled(b[2] + at, p->n[2])), _mm_set1_ps(p->d));
    __m128 r = _mm_add_ps(scaled(b[3] + at, p->a[0]), scaled(b[4] + at, p->a[1]));
    r = _mm_add_ps(_mm_add_ps(r, scaled(b[5] + at, p->a[2])), _mm_set1_ps(p->slack[0]));
    return (uint32_t)_mm_movemask_ps(_mm_cmplt_ps(_mm_add_ps(m, r), _mm_setzero_ps()));
}
#else
#define outside_simd outside_plain
#endif

static void mark(const masu_cull_set *set, uint32_t at, uint32_t kept, uint8_t *marks,
                 uint8_t bit) {
    for (; kept; kept >>= 1, at++) {
        if (kept & 1u) marks[set->items[at]] |= bit;
    }
}

/* Sets the bit for the boxes that no plane of `mask` rejects. The bits of the others are clear. */
static inline void test_items(const masu_cull_set *set, const masu_cull_view *view, uint32_t first,
                              uint32_t count, uint32_t mask, uint8_t *marks, uint8_t bit,
                              uint64_t *tests, int simd) {
    for (uint32_t at = first, end = first + count; at < end; at += LANES) {
        uint32_t lanes = end - at < LANES ? end - at : LANES;
        uint32_t kept = (1u << lanes) - 1u;
        const masu_cull_plane *plane = view->planes;
        for (uint32_t left = mask; left && kept; left >>= 1, plane++) {
            if (!(left & 1u)) continue;
            /* Boxes that are rejected already need no work in a lane, but are counted as
             * tested, because the SIMD variant tests all four. */
            *tests += lanes;
            kept &= ~(simd ? outside_simd(set, at, plane) : outside_plain(set, at, plane));
        }
        mark(set, at, kept, marks, bit);
    }
}

/* ---- Traversal ------------------------------------------------------------------------------- */

typedef struct level {
    uint32_t next, end, mask; /* siblings still to visit, planes that intersect their parent */
} level;

static inline void walk(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state,
                        uint8_t *marks, uint8_t bit, masu_cull_counts *counts, int simd) {
    level stack[MASU_CULL_DEPTH];
    uint32_t depth = 0, all = (1u << view->count) - 1u;
    uint64_t tests = 0, nodes = 0;
    if (set->node_count) stack[depth++] = (level){0, 1, all};
    while (depth) {
        level *top = &stack[depth - 1];
        if (top->next == top->end) {
            depth--;
            continue;
        }
        uint32_t i = top->next++, mask = top->mask;
        const masu_cull_node *node = &set->nodes[i];
        nodes++;
        if (mask) mask = test_node(node, view, mask, &state[i], &tests);
        if (mask == ALL_OUT) continue;
        test_items(set, view, node->first_item, node->item_count, mask, marks, bit, &tests, simd);
        if (node->child_count && depth < MASU_CULL_DEPTH) {
            stack[depth++] =
                (level){node->first_child, node->first_child + node->child_count, mask};
        }
    }
    test_items(set, view, set->tree_count, set->count - set->tree_count, all, marks, bit, &tests,
               simd);
    for (uint32_t i = 0; i < set->moved_count; i++) {
        uint8_t *stale = &marks[set->items[set->moved[i]]]; /* what the hierarchy has found */
        *stale = (uint8_t)(*stale & ~(uint32_t)bit);
        test_items(set, view, set->moved[i], 1, all, marks, bit, &tests, simd);
    }
    counts->nodes += nodes;
    counts->plane_tests += tests;
}

static void clear(const masu_cull_set *set, uint8_t *marks, uint8_t bit) {
    uint64_t others = ~(0x0101010101010101u * (uint64_t)bit), eight;
    uint32_t i = 0;
    for (; i + 8 <= set->count; i += 8) {
        memcpy(&eight, marks + i, sizeof eight);
        eight &= others;
        memcpy(marks + i, &eight, sizeof eight);
    }
    for (; i < set->count; i++) marks[i] = (uint8_t)(marks[i] & ~(uint32_t)bit);
}

void masu_cull(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state, uint8_t *marks,
               uint8_t bit, masu_cull_counts *counts) {
    clear(set, marks, bit);
    walk(set, view, state, marks, bit, counts, HAS_SIMD);
}

void masu_cull_plain(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state,
                     uint8_t *marks, uint8_t bit, masu_cull_counts *counts) {
    clear(set, marks, bit);
    walk(set, view, state, marks, bit, counts, 0);
}
