/* surface.c: see surface.h. The tree is a plain one of boxes, halved by count along the
 * longest side; node i's children follow it, the second at `second`. */
#include "bake/mesh/surface.h"

#include <stdlib.h>
#include <string.h>

#define LEAF 4
#define CUTS 5    /* a triangle is cut at most this often, to 4^5 pieces */
#define SLACK 1.1 /* the bound may be a tenth too large */

typedef masu_bake_vec3 vec3;

struct masu_bake_surface_node {
    masu_bake_box box;
    uint32_t first, count; /* count 0: inner */
    uint32_t second;
};

typedef struct masu_bake_surface_node node;

/* ---- the tree ---- */

static double component(vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

typedef struct entry {
    vec3 t[3];
    double key;
} entry;

static int by_key(const void *a, const void *b) {
    double x = ((const entry *)a)->key, y = ((const entry *)b)->key;
    return x < y ? -1 : x > y;
}

static uint32_t build(masu_bake_surface *s, entry *entries, uint32_t first, uint32_t count,
                      uint32_t *used) {
    uint32_t at = (*used)++;
    node n = {.box = masu_bake_box_empty(), .first = first};
    for (uint32_t i = first; i < first + count; i++) {
        for (int k = 0; k < 3; k++) masu_bake_box_grow(&n.box, entries[i].t[k]);
    }
    if (count <= LEAF) {
        n.count = count;
        s->nodes[at] = n;
        return at;
    }
    vec3 size = masu_bake_sub(n.box.high, n.box.low);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    for (uint32_t i = first; i < first + count; i++) {
        const vec3 *t = entries[i].t;
        entries[i].key = component(t[0], axis) + component(t[1], axis) + component(t[2], axis);
    }
    qsort(entries + first, count, sizeof *entries, by_key);
    build(s, entries, first, count / 2, used);
    n.second = build(s, entries, first + count / 2, count - count / 2, used);
    s->nodes[at] = n;
    return at;
}

masu_bake_surface masu_bake_surface_make(const vec3 (*triangles)[3], size_t count) {
    masu_bake_surface s = {.count = count};
    entry *entries = masu_bake_allocate(count * sizeof *entries);
    for (size_t i = 0; i < count; i++) {
        memcpy(entries[i].t, triangles[i], sizeof entries[i].t);
        entries[i].key = 0;
    }
    s.nodes = masu_bake_allocate((2 * count + 1) * sizeof *s.nodes);
    s.triangles = masu_bake_allocate(count * sizeof *s.triangles);
    uint32_t used = 0;
    if (count) build(&s, entries, 0, (uint32_t)count, &used);
    for (size_t i = 0; i < count; i++) memcpy(s.triangles[i], entries[i].t, sizeof entries[i].t);
    free(entries);
    return s;
}

void masu_bake_surface_release(masu_bake_surface *surface) {
    free(surface->triangles);
    free(surface->nodes);
    *surface = (masu_bake_surface){0};
}

void masu_bake_surface_collect(const masu_bake_content *content, uint32_t first, uint32_t count,
                               masu_bake_buffer *out) {
    for (uint32_t i = first; i < first + count; i++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[i];
        for (uint32_t k = 0; k < p->index_count; k++) {
            uint32_t v = p->first_vertex + MASU_BAKE_INDICES(content)[p->first_index + k];
            vec3 at = masu_bake_v3f(MASU_BAKE_VERTICES(content)[v].position);
            masu_bake_append(out, &at, sizeof at);
        }
    }
}

/* ---- distances ---- */

static double square(vec3 v) { return masu_bake_dot(v, v); }
static double larger(double a, double b) { return a > b ? a : b; } /* fmax is a call */

static double segment_square(vec3 a, vec3 b, vec3 p) {
    vec3 d = masu_bake_sub(b, a);
    double length = square(d), s = masu_bake_dot(masu_bake_sub(p, a), d);
    s = length > 0 ? s / length : 0;
    return square(masu_bake_sub(p, masu_bake_mad(a, d, s < 0 ? 0 : s > 1 ? 1 : s)));
}

/* By the region of the triangle's plane that p is over (Ericson 2005, 5.1.5): most points are
 * nearest to a corner and are done after a few products. */
static double triangle_square(const vec3 t[3], vec3 p) {
    vec3 e0 = masu_bake_sub(t[1], t[0]), e1 = masu_bake_sub(t[2], t[0]);
    vec3 p0 = masu_bake_sub(p, t[0]), p1 = masu_bake_sub(p, t[1]), p2 = masu_bake_sub(p, t[2]);
    double a0 = masu_bake_dot(e0, p0), b0 = masu_bake_dot(e1, p0);
    if (a0 <= 0 && b0 <= 0) return square(p0);
    double a1 = masu_bake_dot(e0, p1), b1 = masu_bake_dot(e1, p1);
    if (a1 >= 0 && b1 <= a1) return square(p1);
    double a2 = masu_bake_dot(e0, p2), b2 = masu_bake_dot(e1, p2);
    if (b2 >= 0 && a2 <= b2) return square(p2);
    double w2 = a0 * b1 - a1 * b0, w1 = a2 * b0 - a0 * b2, w0 = a1 * b2 - a2 * b1;
    double sum = w0 + w1 + w2;
    if (w0 > 0 && w1 > 0 && w2 > 0 && sum > 0) {
        vec3 q = masu_bake_mad(masu_bake_mad(t[0], e0, w1 / sum), e1, w2 / sum);
        return square(masu_bake_sub(p, q));
    }
    double best = segment_square(t[0], t[1], p), other = segment_square(t[1], t[2], p);
    best = other < best ? other : best;
    other = segment_square(t[2], t[0], p);
    return other < best ? other : best;
}

double masu_bake_triangle_distance(const vec3 t[3], vec3 p) { return sqrt(triangle_square(t, p)); }

static double box_square(const masu_bake_box *b, vec3 p) {
    double x = larger(larger(b->low.x - p.x, p.x - b->high.x), 0);
    double y = larger(larger(b->low.y - p.y, p.y - b->high.y), 0);
    double z = larger(larger(b->low.z - p.z, p.z - b->high.z), 0);
    return x * x + y * y + z * z;
}

double masu_bake_surface_distance(const masu_bake_surface *s, vec3 p, size_t *which) {
    double best = DBL_MAX;
    uint32_t stack[64], depth = 0; /* halving by count: 2^32 triangles are 31 deep */
    if (!s->count) return DBL_MAX;
    if (which) best = triangle_square((const vec3 *)s->triangles[*which], p);
    stack[depth++] = 0;
    while (depth) {
        const node *n = &s->nodes[stack[--depth]];
        if (box_square(&n->box, p) >= best) continue;
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            double d = triangle_square((const vec3 *)s->triangles[i], p);
            if (d >= best) continue;
            best = d;
            if (which) *which = i;
        }
        if (n->count) continue;
        uint32_t near = (uint32_t)(n - s->nodes) + 1, far = n->second;
        if (box_square(&s->nodes[far].box, p) < box_square(&s->nodes[near].box, p)) {
            uint32_t other = near;
            near = far;
            far = other;
        }
        stack[depth++] = far;
        stack[depth++] = near;
    }
    return sqrt(best);
}

/* Bounds of the largest distance during the search: at least `lower`, reached at some corner, and
 * at most `upper` for all triangles processed so far. */
typedef struct search {
    const masu_bake_surface *to;
    double lower, upper, limit;
} search;

static void deviation(search *s, const vec3 t[3], size_t hint, int cuts) {
    double seen = 0, bound = DBL_MAX;
    size_t nearest[3];
    for (int i = 0; i < 3; i++) {
        nearest[i] = i ? nearest[i - 1] : hint; /* a good first guess ends most of the search */
        seen = fmax(seen, masu_bake_surface_distance(s->to, t[i], &nearest[i]));
    }
    s->lower = fmax(s->lower, seen);
    for (int i = 0; i < 3; i++) {
        const vec3 *one = (const vec3 *)s->to->triangles[nearest[i]];
        double most = 0;
        for (int k = 0; k < 3; k++) most = fmax(most, masu_bake_triangle_distance(one, t[k]));
        bound = fmin(bound, most);
    }
    /* The distance function has Lipschitz constant 1, so no point is farther from the closest
     * corner than the longest edge / sqrt(3). */
    double edge = 0;
    for (int i = 0; i < 3; i++) {
        edge = fmax(edge, masu_bake_length(masu_bake_sub(t[(i + 1) % 3], t[i])));
    }
    bound = fmin(bound, seen + edge * 0.57735026919);
    if (bound <= s->lower * SLACK || cuts == 0 || s->lower > s->limit) {
        s->upper = fmax(s->upper, bound);
        return;
    }
    vec3 m[3];
    for (int i = 0; i < 3; i++) {
        m[i] = masu_bake_mad(t[i], masu_bake_sub(t[(i + 1) % 3], t[i]), 0.5);
    }
    const vec3 parts[4][3] = {
        {t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}};
    for (int i = 0; i < 4; i++) deviation(s, parts[i], nearest[0], cuts - 1);
}

double masu_bake_surface_deviation(const masu_bake_surface *from, const masu_bake_surface *to,
                                   double limit) {
    if (!from->count) return 0;
    if (!to->count) return DBL_MAX;
    search s = {.to = to, .limit = limit};
    size_t *nearest = masu_bake_allocate(from->count * sizeof *nearest), hint = 0;
    /* All corners first: most triangles then have a bound below the worst corner. */
    for (size_t i = 0; i < from->count && s.lower <= limit; i++) {
        for (int k = 0; k < 3; k++) {
            s.lower = fmax(s.lower, masu_bake_surface_distance(to, from->triangles[i][k], &hint));
        }
        nearest[i] = hint;
    }
    for (size_t i = 0; i < from->count && s.lower <= limit; i++) {
        deviation(&s, (const vec3 *)from->triangles[i], nearest[i], CUTS);
    }
    free(nearest);
    return s.lower > limit ? DBL_MAX : fmax(s.lower, s.upper);
}

/* ---- parts ---- */

typedef struct corner {
    vec3 at;
    size_t index; /* 3 * triangle + corner */
} corner;

static int by_place(const void *a, const void *b) {
    const corner *p = a, *q = b;
    if (p->at.x != q->at.x) return p->at.x < q->at.x ? -1 : 1;
    if (p->at.y != q->at.y) return p->at.y < q->at.y ? -1 : 1;
    if (p->at.z != q->at.z) return p->at.z < q->at.z ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

typedef struct edge {
    size_t low, high; /* corners' numbers */
    size_t triangle;
    int way;
} edge;

static int by_ends(const void *a, const void *b) {
    const edge *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return 0;
}

static size_t root_of(size_t *parent, size_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

/* Corners at equal positions get equal numbers. */
static size_t *number_corners(const vec3 (*triangles)[3], size_t count) {
    corner *corners = masu_bake_allocate(3 * count * sizeof *corners);
    size_t *number = masu_bake_allocate(3 * count * sizeof *number);
    for (size_t i = 0; i < 3 * count; i++) {
        corners[i] = (corner){triangles[i / 3][i % 3], i};
    }
    qsort(corners, 3 * count, sizeof *corners, by_place);
    for (size_t i = 0; i < 3 * count; i++) {
        bool same = i > 0 && corners[i].at.x == corners[i - 1].at.x &&
                    corners[i].at.y == corners[i - 1].at.y &&
                    corners[i].at.z == corners[i - 1].at.z;
        number[corners[i].index] = same ? number[corners[i - 1].index] : corners[i].index;
    }
    free(corners);
    return number;
}

uint32_t masu_bake_surface_parts(const vec3 (*triangles)[3], size_t count, uint32_t *part,
                                 bool *closed) {
    if (!count) return 0;
    size_t *number = number_corners(triangles, count);
    size_t *parent = masu_bake_allocate(3 * count * sizeof *parent);
    edge *edges = masu_bake_allocate(3 * count * sizeof *edges);
    for (size_t i = 0; i < 3 * count; i++) parent[i] = i;
    for (size_t i = 0; i < 3 * count; i++) {
        size_t a = number[i], b = number[i - i % 3 + (i + 1) % 3];
        parent[root_of(parent, a)] = root_of(parent, b);
        edges[i] = a < b ? (edge){a, b, i / 3, 1} : (edge){b, a, i / 3, -1};
    }
    uint32_t parts = 0, *of_root = masu_bake_allocate(3 * count * sizeof *of_root);
    memset(of_root, 0xFF, 3 * count * sizeof *of_root);
    for (size_t i = 0; i < count; i++) {
        size_t root = root_of(parent, number[3 * i]);
        if (of_root[root] == MASU_BLOB_NONE) {
            closed[parts] = true;
            of_root[root] = parts++;
        }
        part[i] = of_root[root];
    }
    qsort(edges, 3 * count, sizeof *edges, by_ends);
    for (size_t i = 0, next; i < 3 * count; i = next) {
        int sum = 0;
        for (next = i; next < 3 * count && by_ends(&edges[i], &edges[next]) == 0; next++) {
            if (edges[next].low != edges[next].high) sum += edges[next].way;
        }
        if (sum) closed[part[edges[i].triangle]] = false;
    }
    free(of_root);
    free(edges);
    free(parent);
    free(number);
    return parts;
}

/* The sum of the solid angles (Van Oosterom and Strackee 1983) over the whole sphere's. */
double masu_bake_winding(const vec3 (*triangles)[3], size_t count, vec3 p) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        vec3 v[3];
        double l[3];
        for (int k = 0; k < 3; k++) {
            v[k] = masu_bake_sub(triangles[i][k], p);
            l[k] = masu_bake_length(v[k]);
        }
        double above = masu_bake_dot(v[0], masu_bake_cross(v[1], v[2]));
        double below = l[0] * l[1] * l[2] + masu_bake_dot(v[0], v[1]) * l[2] +
                       masu_bake_dot(v[1], v[2]) * l[0] + masu_bake_dot(v[2], v[0]) * l[1];
        sum += 2 * atan2(above, below);
    }
    return sum / (4 * MASU_BAKE_PI);
}

/* ---- apart ---- */

/* Separated along this axis (of any length) by more than `margin`? */
static bool separates(vec3 axis, const vec3 *a, int n, const vec3 *b, int m, double margin) {
    double length = masu_bake_length(axis);
    if (!(length > 0)) return false;
    double low_a = DBL_MAX, high_a = -DBL_MAX, low_b = DBL_MAX, high_b = -DBL_MAX;
    for (int i = 0; i < n; i++) {
        double d = masu_bake_dot(axis, a[i]);
        low_a = fmin(low_a, d);
        high_a = fmax(high_a, d);
    }
    for (int i = 0; i < m; i++) {
        double d = masu_bake_dot(axis, b[i]);
        low_b = fmin(low_b, d);
        high_b = fmax(high_b, d);
    }
    return fmax(low_b - high_a, low_a - high_b) > margin * length;
}

bool masu_bake_box_apart(const masu_bake_box *box, const vec3 t[3], double margin) {
    static const vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    vec3 corners[8];
    for (int i = 0; i < 8; i++) {
        corners[i] =
            masu_bake_v3(i & 1 ? box->high.x : box->low.x, i & 2 ? box->high.y : box->low.y,
                         i & 4 ? box->high.z : box->low.z);
    }
    for (int i = 0; i < 3; i++) {
        if (separates(axes[i], corners, 8, t, 3, margin)) return true;
    }
    vec3 edges[3];
    for (int i = 0; i < 3; i++) edges[i] = masu_bake_sub(t[(i + 1) % 3], t[i]);
    if (separates(masu_bake_cross(edges[0], edges[1]), corners, 8, t, 3, margin)) return true;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            if (separates(masu_bake_cross(edges[i], axes[k]), corners, 8, t, 3, margin))
                return true;
        }
    }
    return false;
}
