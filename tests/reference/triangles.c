/* triangles.c: see triangles.h. */
#include "triangles.h"

#include "scene/scene.h"
#include "reference/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF = 4 };

static void sub(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

/* ---- The scene ------------------------------------------------------------------------------- */

static void place(const float rows[12], const float p[3], double out[3]) {
    for (int k = 0; k < 3; k++) {
        out[k] = (double)rows[4 * k + 3];
        for (int a = 0; a < 3; a++) out[k] += (double)rows[4 * k + a] * (double)p[a];
    }
}

static void gather(const masu_scene *scene, const masu_scene_view *v, masu_ref_triangles *out) {
    for (uint32_t i = 0; i < masu_scene_count(scene, MASU_SCENE_INSTANCE); i++) {
        const masu_blob_mesh *mesh = &v->meshes[v->instances[i].mesh];
        for (uint32_t p = 0; p < mesh->primitive_count; p++) {
            const masu_blob_primitive *prim = &v->primitives[mesh->first_primitive + p];
            for (uint32_t k = 0; k + 2 < prim->index_count; k += 3) {
                masu_ref_triangle *t = &out->triangles[out->count++];
                double *corner[3] = {t->a, t->b, t->c};
                t->instance = i;
                t->primitive = mesh->first_primitive + p;
                for (uint32_t c = 0; c < 3; c++) {
                    uint32_t index = v->indices[prim->first_index + k + c];
                    t->vertex[c] = prim->first_vertex + index;
                    place(v->instances[i].transform,
                          v->vertices[prim->first_vertex + index].position, corner[c]);
                }
            }
        }
    }
}

/* ---- The tree -------------------------------------------------------------------------------- */

static void bound(masu_ref_triangles *s, masu_ref_node *n) {
    for (int k = 0; k < 3; k++) n->low[k] = HUGE_VAL, n->high[k] = -HUGE_VAL;
    for (uint32_t i = n->first; i < n->first + n->count; i++) {
        const masu_ref_triangle *t = &s->triangles[i];
        for (int k = 0; k < 3; k++) {
            n->low[k] = fmin(n->low[k], fmin(t->a[k], fmin(t->b[k], t->c[k])));
            n->high[k] = fmax(n->high[k], fmax(t->a[k], fmax(t->b[k], t->c[k])));
        }
    }
}

#define COMPARE(k)                                                                                 \
    static int compare_##k(const void *a, const void *b) {                                         \
        const masu_ref_triangle *s = a, *t = b;                                                    \
        double d = (s->a[k] + s->b[k] + s->c[k]) - (t->a[k] + t->b[k] + t->c[k]);                  \
        return (d > 0) - (d < 0);                                                                  \
    }
COMPARE(0)
COMPARE(1)
COMPARE(2)

static void split(masu_ref_triangles *s, uint32_t node, uint32_t *nodes) {
    static int (*const compare[3])(const void *, const void *) = {compare_0, compare_1, compare_2};
    masu_ref_node *n = &s->nodes[node];
    bound(s, n);
    if (n->count <= LEAF) return;
    int widest = 0;
    for (int k = 1; k < 3; k++)
        if (n->high[k] - n->low[k] > n->high[widest] - n->low[widest]) widest = k;
    qsort(&s->triangles[n->first], n->count, sizeof *s->triangles, compare[widest]);
    uint32_t half = n->count / 2, child = *nodes;
    *nodes += 2;
    s->nodes[child] = (masu_ref_node){.first = n->first, .count = half};
    s->nodes[child + 1] = (masu_ref_node){.first = n->first + half, .count = n->count - half};
    n->first = child;
    n->count = 0;
    split(s, child, nodes);
    split(s, child + 1, nodes);
}

int masu_ref_triangles_open(const masu_scene *scene, masu_ref_triangles *out) {
    masu_scene_view v = masu_scene_view_of(scene);
    memset(out, 0, sizeof *out);
    out->triangles = malloc((size_t)(masu_scene_triangles(scene) + 1) * sizeof *out->triangles);
    out->nodes = malloc((size_t)(2 * masu_scene_triangles(scene) + 1) * sizeof *out->nodes);
    if (!out->triangles || !out->nodes) {
        masu_ref_triangles_close(out);
        return 0;
    }
    gather(scene, &v, out);
    uint32_t nodes = 1;
    out->nodes[0] = (masu_ref_node){.first = 0, .count = out->count};
    split(out, 0, &nodes);
    return 1;
}

void masu_ref_triangles_close(masu_ref_triangles *t) {
    free(t->triangles);
    free(t->nodes);
    memset(t, 0, sizeof *t);
}

/* ---- Rays ------------------------------------------------------------------------------------ */

/* Moller and Trumbore, JGT 2-1, 1997. */
static double meet(const masu_ref_triangle *t, const double from[3], const double d[3]) {
    double e[3], f[3], p[3], q[3], s[3];
    sub(t->b, t->a, e);
    sub(t->c, t->a, f);
    cross3(d, f, p);
    double det = dot3(e, p);
    if (det == 0) return -1;
    sub(from, t->a, s);
    double u = dot3(s, p) / det;
    if (!(u >= 0 && u <= 1)) return -1;
    cross3(s, e, q);
    double v = dot3(d, q) / det;
    if (!(v >= 0 && u + v <= 1)) return -1;
    return dot3(f, q) / det;
}

static int passes(const masu_ref_node *n, const double from[3], const double d[3], double low,
                  double high) {
    for (int k = 0; k < 3; k++) {
        if (d[k] == 0) {
            if (from[k] < n->low[k] || from[k] > n->high[k]) return 0;
            continue;
        }
        double a = (n->low[k] - from[k]) / d[k], b = (n->high[k] - from[k]) / d[k];
        low = fmax(low, fmin(a, b) - 1e-9 * fabs(fmin(a, b)));
        high = fmin(high, fmax(a, b) + 1e-9 * fabs(fmax(a, b)));
    }
    return low <= high;
}

static int64_t nearest_hit(const masu_ref_triangles *s, const double from[3], const double d[3],
                           double nearest, double farthest, int64_t skip, double *t) {
    uint32_t stack[128], depth = 0;
    int64_t found = -1;
    if (!s->count) return -1;
    stack[depth++] = 0;
    while (depth) {
        const masu_ref_node *n = &s->nodes[stack[--depth]];
        if (!passes(n, from, d, nearest, farthest)) continue;
        if (!n->count) {
            stack[depth++] = n->first;
            stack[depth++] = n->first + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            if ((int64_t)i == skip) continue;
            double at = meet(&s->triangles[i], from, d);
            if (!(at > nearest && at < farthest)) continue;
            farthest = at;
            found = i;
        }
    }
    *t = farthest;
    return found;
}

int64_t masu_ref_hit(const masu_ref_triangles *scene, const double from[3],
                     const double direction[3], double nearest, double farthest, double *t) {
    return nearest_hit(scene, from, direction, nearest, farthest, -1, t);
}

int masu_ref_normal(const masu_ref_triangle *triangle, const double towards[3], double out[3]) {
    double e[3], f[3];
    sub(triangle->b, triangle->a, e);
    sub(triangle->c, triangle->a, f);
    cross3(e, f, out);
    double length = sqrt(dot3(out, out));
    if (!(length > 0)) return 0;
    double sign = dot3(out, towards) < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) out[k] *= sign / length;
    return 1;
}

double masu_ref_sun_share(const masu_ref_triangles *scene, const double point[3], uint32_t skip,
                          const double sun[3], double tangent, int rays) {
    double u[3], v[3], t;
    int least = fabs(sun[0]) < fabs(sun[1]) ? 0 : 1, free_rays = 0;
    if (fabs(sun[2]) < fabs(sun[least])) least = 2;
    double axis[3] = {least == 0, least == 1, least == 2};
    cross3(sun, axis, u);
    double length = sqrt(dot3(u, u));
    for (int k = 0; k < 3; k++) u[k] /= length;
    cross3(sun, u, v);
    /* Neighbours in the same plane do not occlude. */
    double off = 1e-9 * fmax(1, fmax(fabs(point[0]), fmax(fabs(point[1]), fabs(point[2]))));
    for (int i = 0; i < rays; i++) {
        double r = rays == 1 ? 0 : tangent * sqrt((i + 0.5) / rays), a = 2.399963229728653 * i,
               d[3];
        for (int k = 0; k < 3; k++) d[k] = sun[k] + r * (u[k] * cos(a) + v[k] * sin(a));
        free_rays += nearest_hit(scene, point, d, off, HUGE_VAL, skip, &t) < 0;
    }
    return (double)free_rays / rays;
}
