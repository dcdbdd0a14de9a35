/* lod.c: LODs of meshes. For each level several candidates are made; the one with the
 * least error that has few enough triangles is taken:
 *
 *   simplified   meshoptimizer's edge collapses, primitive by primitive
 *   thinned      parts that hang together dropped, the smallest first, the rest simplified: frames,
 *                bars and sills of a facade, which no collapse can remove
 *   clustered    meshoptimizer's "sloppy" form, where the others get stuck; not of what has textures
 *
 * The error is ours, not the simplifier's estimate: a bound of the two-sided distance between the
 * surfaces (surface.c), in the units of the mesh. Places alone: texture coordinates and normals
 * are not judged. A level has the mesh's primitives in the
 * mesh's order, with its materials and vertices; only indices are added. */
#include "bake/mesh/detail.h"
#include "bake/mesh/surface.h"
#include "bake/scene/skin.h"

#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#define SAVES 0.75         /* a level has at most this share of the triangles before it */
#define WORST 0.15         /* and is at most this share of the diagonal wrong */
#define TARGET_ERROR 0.25f /* what the simplifier may do; the judge is above */

static const double shares[3] = {0.5, 0.22, 0.08}; /* of the mesh's triangles, by level */

typedef struct form { /* indices of one level, primitive after primitive */
    uint32_t *indices;
    uint32_t *counts; /* by primitive */
    uint32_t total;
    double error;
} form;

typedef struct source {
    const masu_bake_content *content;
    masu_blob_mesh mesh;
    uint32_t total; /* indices */
    double diagonal;
    masu_bake_vec3 (*triangles)[3];
    uint32_t *part; /* by triangle */
    double *part_size;
    uint32_t parts;
    masu_bake_surface surface;
} source;

static const masu_blob_primitive *primitive_of(const source *s, uint32_t i) {
    return &MASU_BAKE_PRIMITIVES(s->content)[s->mesh.first_primitive + i];
}

static form form_make(const source *s) {
    return (form){.indices = masu_bake_allocate(s->total * sizeof(uint32_t)),
                  .counts = masu_bake_allocate(s->mesh.primitive_count * sizeof(uint32_t)),
                  .error = DBL_MAX};
}

static void form_release(form *f) {
    free(f->indices);
    free(f->counts);
    *f = (form){.error = DBL_MAX};
}

static masu_bake_surface surface_of(const source *s, const form *f) {
    masu_bake_buffer corners = {0};
    const uint32_t *at = f->indices;
    for (uint32_t i = 0; i < s->mesh.primitive_count; i++) {
        uint32_t first = primitive_of(s, i)->first_vertex;
        for (uint32_t k = 0; k < f->counts[i]; k++) {
            masu_bake_vec3 v =
                masu_bake_v3f(MASU_BAKE_VERTICES(s->content)[first + *at++].position);
            masu_bake_append(&corners, &v, sizeof v);
        }
    }
    masu_bake_surface made =
        masu_bake_surface_make((const masu_bake_vec3(*)[3])(void *)corners.data,
                               corners.bytes / (3 * sizeof(masu_bake_vec3)));
    masu_bake_release(&corners);
    return made;
}

/* DBL_MAX: more than `limit`. */
static double measure(const source *s, const form *f, double limit) {
    masu_bake_surface coarse = surface_of(s, f);
    double error = masu_bake_surface_deviation(&s->surface, &coarse, limit);
    if (error < limit) {
        error = fmax(error, masu_bake_surface_deviation(&coarse, &s->surface, limit));
    }
    masu_bake_surface_release(&coarse);
    return error;
}

/* ---- candidates ---- */

/* Clusters join vertices across the seams of texture coordinates. */
static bool has_maps(const source *s) {
    const masu_bake_maps *maps = (const masu_bake_maps *)(const void *)s->content->maps.data;
    for (uint32_t i = 0; i < s->mesh.primitive_count; i++) {
        const masu_bake_maps *m = &maps[primitive_of(s, i)->material];
        for (int k = 0; k < MASU_BAKE_MAPS; k++) {
            if (m->image[k] != MASU_BLOB_NONE) return true;
        }
    }
    return false;
}

/* `keep` (by part, NULL: all) of the mesh, simplified to about `target` indices. */
static form simplify(const source *s, const bool *keep, double target, bool sloppy) {
    form f = form_make(s);
    uint32_t *kept = masu_bake_allocate(s->total * sizeof *kept), triangle = 0, all = 0;
    uint32_t *counts = masu_bake_allocate(s->mesh.primitive_count * sizeof *counts), *at = kept;
    for (uint32_t i = 0; i < s->mesh.primitive_count; i++) {
        const masu_blob_primitive *p = primitive_of(s, i);
        const uint32_t *from = MASU_BAKE_INDICES(s->content) + p->first_index;
        counts[i] = 0;
        for (uint32_t k = 0; k < p->index_count; k += 3, triangle++) {
            if (keep && !keep[s->part[triangle]]) continue;
            memcpy(at + counts[i], from + k, 3 * sizeof *at);
            counts[i] += 3;
        }
        at += counts[i];
        all += counts[i];
    }
    double share = all ? target / all : 0;
    at = kept;
    for (uint32_t i = 0; i < s->mesh.primitive_count; i++) {
        const masu_blob_primitive *p = primitive_of(s, i);
        const masu_blob_vertex *v = MASU_BAKE_VERTICES(s->content) + p->first_vertex;
        size_t want = (size_t)(counts[i] * share) / 3 * 3;
        uint32_t *to = f.indices + f.total;
        if (share >= 1 || counts[i] == 0) {
            memcpy(to, at, counts[i] * sizeof *to);
            f.counts[i] = counts[i];
        } else if (sloppy) {
            f.counts[i] =
                (uint32_t)meshopt_simplifySloppy(to, at, counts[i], v->position, p->vertex_count,
                                                 sizeof *v, want, TARGET_ERROR, NULL);
        } else {
            f.counts[i] =
                (uint32_t)meshopt_simplify(to, at, counts[i], v->position, p->vertex_count,
                                           sizeof *v, want, TARGET_ERROR, 0, NULL);
        }
        at += counts[i];
        f.total += f.counts[i];
    }
    free(counts);
    free(kept);
    return f;
}

typedef struct sized {
    double size;
    uint32_t part, triangles;
} sized;

static int by_size(const void *a, const void *b) {
    const sized *p = a, *q = b;
    if (p->size != q->size) return p->size < q->size ? -1 : 1;
    return p->part < q->part ? -1 : p->part > q->part;
}

/* The smallest parts dropped until `target` indices are left, or 8/5 of it if the rest is to be
 * simplified. */
static form thin(const source *s, double target, bool simplified) {
    sized *order = masu_bake_allocate(s->parts * sizeof *order);
    bool *keep = masu_bake_allocate(s->parts * sizeof *keep);
    for (uint32_t i = 0; i < s->parts; i++) {
        order[i] = (sized){s->part_size[i], i, 0};
        keep[i] = true;
    }
    for (uint32_t i = 0; i < s->total / 3; i++) order[s->part[i]].triangles++;
    qsort(order, s->parts, sizeof *order, by_size);
    double left = s->total, most = simplified ? target * 1.6 : target;
    for (uint32_t i = 0; i + 1 < s->parts && left > most; i++) {
        keep[order[i].part] = false;
        left -= 3.0 * order[i].triangles;
    }
    form f = simplify(s, keep, target, false);
    free(keep);
    free(order);
    return f;
}

static void consider(const source *s, form *best, form candidate, double most) {
    bool small = candidate.total > 0 && candidate.total <= most;
    if (small) candidate.error = measure(s, &candidate, fmin(best->error, WORST * s->diagonal));
    if (small && candidate.error < best->error) {
        form_release(best);
        *best = candidate;
        return;
    }
    form_release(&candidate);
}

static form level(const source *s, double target, double most) {
    form best = {.error = DBL_MAX};
    consider(s, &best, simplify(s, NULL, target, false), most);
    if (s->parts > 1) {
        consider(s, &best, thin(s, target, false), most);
        consider(s, &best, thin(s, target, true), most);
    }
    if (best.error > WORST * s->diagonal && !has_maps(s))
        consider(s, &best, simplify(s, NULL, target, true), most);
    return best;
}

/* ---- a mesh ---- */

static void look_at_parts(source *s) {
    uint32_t count = s->total / 3;
    bool *closed = masu_bake_allocate(count * sizeof *closed);
    s->part = masu_bake_allocate(count * sizeof *s->part);
    s->parts =
        masu_bake_surface_parts((const masu_bake_vec3(*)[3])s->triangles, count, s->part, closed);
    s->part_size = masu_bake_allocate(s->parts * sizeof *s->part_size);
    masu_bake_box *boxes = masu_bake_allocate(s->parts * sizeof *boxes);
    for (uint32_t i = 0; i < s->parts; i++) boxes[i] = masu_bake_box_empty();
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) masu_bake_box_grow(&boxes[s->part[i]], s->triangles[i][k]);
    }
    for (uint32_t i = 0; i < s->parts; i++) {
        s->part_size[i] = masu_bake_length(masu_bake_sub(boxes[i].high, boxes[i].low));
    }
    free(boxes);
    free(closed);
}

static void store(masu_bake_content *content, const source *s, uint32_t mesh, const form *f) {
    masu_blob_lod lod = {
        .mesh = mesh, .first_primitive = (uint32_t)masu_bake_count(content, MASU_BLOB_PRIMITIVES)};
    /* Rounded up: the bound stays one. An exact form still has an error of a float's step. */
    lod.error = nextafterf((float)f->error, INFINITY);
    const uint32_t *at = f->indices;
    for (uint32_t i = 0; i < s->mesh.primitive_count; i++) {
        masu_blob_primitive p = *primitive_of(s, i);
        p.first_index = (uint32_t)masu_bake_count(content, MASU_BLOB_INDICES);
        p.index_count = f->counts[i];
        masu_bake_append(&content->section[MASU_BLOB_INDICES], at, f->counts[i] * sizeof *at);
        masu_bake_append(&content->section[MASU_BLOB_PRIMITIVES], &p, sizeof p);
        at += f->counts[i];
    }
    masu_bake_append(&content->section[MASU_BLOB_LODS], &lod, sizeof lod);
}

static void make_levels(masu_bake_content *content, source *s, uint32_t mesh, uint32_t levels,
                        masu_bake_lod_report *report) {
    uint32_t before = s->total, made = 0;
    double error = 0;
    for (uint32_t i = 0; i < levels; i++) {
        form f = level(s, shares[i] * s->total, SAVES * before);
        f.error = f.indices ? fmax(f.error, error) : DBL_MAX; /* rises with the level */
        if (f.error <= WORST * s->diagonal) {
            store(content, s, mesh, &f);
            before = f.total;
            error = f.error;
            made++;
        } else {
            report->refused++;
        }
        form_release(&f);
    }
    report->levels += made;
    report->meshes += made > 0;
}

void masu_bake_make_lods(masu_bake_content *content, uint32_t levels,
                         masu_bake_lod_report *report) {
    uint64_t meshes = masu_bake_count(content, MASU_BLOB_MESHES);
    for (uint32_t m = 0; m < meshes && levels; m++) {
        if (masu_bake_is_skinned(content, m)) continue;
        source s = {.content = content, .mesh = MASU_BAKE_MESHES(content)[m]};
        masu_bake_buffer corners = {0};
        masu_bake_surface_collect(content, s.mesh.first_primitive, s.mesh.primitive_count,
                                  &corners);
        s.total = (uint32_t)(corners.bytes / sizeof(masu_bake_vec3));
        if (s.total / 3 < MASU_BAKE_LOD_TRIANGLES) {
            report->too_small++;
            masu_bake_release(&corners);
            continue;
        }
        s.triangles = (masu_bake_vec3(*)[3])(void *)corners.data;
        s.surface = masu_bake_surface_make((const masu_bake_vec3(*)[3])s.triangles, s.total / 3);
        s.diagonal = masu_bake_length(
            masu_bake_sub(masu_bake_v3f(s.mesh.aabb_max), masu_bake_v3f(s.mesh.aabb_min)));
        look_at_parts(&s);
        make_levels(content, &s, m, levels, report);
        masu_bake_surface_release(&s.surface);
        free(s.part_size);
        free(s.part);
        masu_bake_release(&corners);
    }
}
