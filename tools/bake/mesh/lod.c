/* lod.c: LODs of meshes. For each level it builds several candidates, and selects the one with the
 * lowest error among those with few enough triangles:
 *
 *   simplified   meshoptimizer's edge collapses, primitive by primitive
 *   thinned      the smallest connected parts dropped, the others simplified: frames, bars and
 *                sills of a facade, which no collapse can remove
 *   clustered    meshoptimizer's "sloppy" simplifier, if the others fail; not with textures
 *
 * The error is a bound of the two-sided distance between the surfaces (surface.c), not the
 * simplifier's estimate. Its unit is that of the mesh. It covers the whole mesh and each of its
 * materials: a lamp on a wall could lose its outline while the wall still has a surface there. If a
 * level drops a part of a material, the size of the part is an error too. Texture coordinates and
 * normals are not evaluated. A level has the primitives of the mesh in the same order, with the
 * same materials and vertices; only indices are added. */
#include "bake/mesh/detail.h"
#include "bake/mesh/surface.h"
#include "bake/scene/skin.h"

#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#define SAVES 0.75         /* a level has at most this share of the triangles before it */
#define WORST 0.15         /* and is at most this share of the diagonal wrong */
#define TARGET_ERROR 0.25f /* limit for the simplifier; the error bound above decides */

static const double shares[3] = {0.5, 0.22, 0.08}; /* of the mesh's triangles, by level */

typedef struct form { /* indices of one level, primitive after primitive */
    uint32_t *indices;
    uint32_t *counts; /* by primitive */
    uint32_t total;
    double error;
} form;

/* All geometry of one material, in connected parts. */
typedef struct look {
    uint32_t material;
    masu_bake_surface all;
    masu_bake_surface *parts;
    double *sizes; /* diagonals of the parts' boxes */
    uint32_t part_count;
} look;

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
    look *looks; /* none where all of the mesh is one */
    uint32_t look_count;
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

/* The surface of one material; MASU_BLOB_NONE: of all materials. */
static masu_bake_surface surface_of(const source *s, const form *f, uint32_t material) {
    masu_bake_buffer corners = {0};
    const uint32_t *at = f->indices;
    for (uint32_t i = 0; i < s->mesh.primitive_count; at += f->counts[i++]) {
        const masu_blob_primitive *p = primitive_of(s, i);
        if (material != MASU_BLOB_NONE && p->material != material) continue;
        for (uint32_t k = 0; k < f->counts[i]; k++) {
            masu_bake_vec3 v =
                masu_bake_v3f(MASU_BAKE_VERTICES(s->content)[p->first_vertex + at[k]].position);
            masu_bake_append(&corners, &v, sizeof v);
        }
    }
    masu_bake_surface made =
        masu_bake_surface_make((const masu_bake_vec3(*)[3])(void *)corners.data,
                               corners.bytes / (3 * sizeof(masu_bake_vec3)));
    masu_bake_release(&corners);
    return made;
}

/* A part that was dropped, or is far from the remaining surface of its material, is visible as a
 * spot of another colour, at most as large as the part. */
static double measure_look(const source *s, const look *l, const form *f, double limit) {
    masu_bake_surface coarse = surface_of(s, f, l->material);
    double error = masu_bake_surface_deviation(&coarse, &l->all, limit);
    for (uint32_t i = 0; i < l->part_count && error < limit; i++) {
        double most = fmin(l->sizes[i], limit);
        double moved = masu_bake_surface_deviation(&l->parts[i], &coarse, most);
        error = fmax(error, fmin(moved, l->sizes[i]));
    }
    masu_bake_surface_release(&coarse);
    return error;
}

/* `limit` or more where it is not less. */
static double measure(const source *s, const form *f, double limit) {
    masu_bake_surface coarse = surface_of(s, f, MASU_BLOB_NONE);
    double error = masu_bake_surface_deviation(&s->surface, &coarse, limit);
    if (error < limit) {
        error = fmax(error, masu_bake_surface_deviation(&coarse, &s->surface, limit));
    }
    masu_bake_surface_release(&coarse);
    for (uint32_t i = 0; i < s->look_count && error < limit; i++)
        error = fmax(error, measure_look(s, &s->looks[i], f, limit));
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

/* Drops the smallest parts until `target` indices are left, or 8/5 of `target` if the others are
 * simplified afterwards. */
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

/* The diagonals of the parts' boxes. */
static double *sizes_of_parts(const masu_bake_vec3 (*triangles)[3], uint32_t count,
                              const uint32_t *part, uint32_t parts) {
    double *sizes = masu_bake_allocate(parts * sizeof *sizes);
    masu_bake_box *boxes = masu_bake_allocate(parts * sizeof *boxes);
    for (uint32_t i = 0; i < parts; i++) boxes[i] = masu_bake_box_empty();
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) masu_bake_box_grow(&boxes[part[i]], triangles[i][k]);
    }
    for (uint32_t i = 0; i < parts; i++)
        sizes[i] = masu_bake_length(masu_bake_sub(boxes[i].high, boxes[i].low));
    free(boxes);
    return sizes;
}

/* The part of each triangle; returns how many there are. */
static uint32_t find_parts(const masu_bake_vec3 (*triangles)[3], uint32_t count, uint32_t **part,
                           double **sizes) {
    bool *closed = masu_bake_allocate(count * sizeof *closed);
    *part = masu_bake_allocate(count * sizeof **part);
    uint32_t parts = masu_bake_surface_parts(triangles, count, *part, closed);
    *sizes = sizes_of_parts(triangles, count, *part, parts);
    free(closed);
    return parts;
}

static void look_at_parts(source *s) {
    s->parts = find_parts((const masu_bake_vec3(*)[3])s->triangles, s->total / 3, &s->part,
                          &s->part_size);
}

/* ---- materials ---- */

typedef struct numbered {
    uint32_t part, triangle;
} numbered;

static int by_part(const void *a, const void *b) {
    const numbered *p = a, *q = b;
    if (p->part != q->part) return p->part < q->part ? -1 : 1;
    return p->triangle < q->triangle ? -1 : p->triangle > q->triangle;
}

static look look_make(uint32_t material, const masu_bake_vec3 (*triangles)[3], uint32_t count) {
    look l = {.material = material, .all = masu_bake_surface_make(triangles, count)};
    uint32_t *part;
    l.part_count = find_parts(triangles, count, &part, &l.sizes);
    l.parts = masu_bake_allocate(l.part_count * sizeof *l.parts);
    numbered *order = masu_bake_allocate(count * sizeof *order);
    masu_bake_vec3(*sorted)[3] = masu_bake_allocate(count * sizeof *sorted);
    for (uint32_t i = 0; i < count; i++) order[i] = (numbered){part[i], i};
    qsort(order, count, sizeof *order, by_part);
    for (uint32_t i = 0; i < count; i++)
        memcpy(sorted[i], triangles[order[i].triangle], sizeof sorted[i]);
    for (uint32_t i = 0, next; i < count; i = next) {
        for (next = i; next < count && order[next].part == order[i].part;) next++;
        l.parts[order[i].part] = masu_bake_surface_make(
            (const masu_bake_vec3(*)[3])(void *)(sorted + i), next - i);
    }
    free(sorted);
    free(order);
    free(part);
    return l;
}

static void look_release(look *l) {
    for (uint32_t i = 0; i < l->part_count; i++) masu_bake_surface_release(&l->parts[i]);
    free(l->parts);
    free(l->sizes);
    masu_bake_surface_release(&l->all);
}

static bool is_first_of_material(const source *s, uint32_t primitive) {
    for (uint32_t i = 0; i < primitive; i++) {
        if (primitive_of(s, i)->material == primitive_of(s, primitive)->material) return false;
    }
    return true;
}

static void look_at_materials(source *s) {
    uint32_t count = s->mesh.primitive_count, materials = 0;
    for (uint32_t i = 0; i < count; i++) materials += is_first_of_material(s, i);
    if (materials < 2) return;
    s->looks = masu_bake_allocate(materials * sizeof *s->looks);
    for (uint32_t i = 0; i < count; i++) {
        if (!is_first_of_material(s, i)) continue;
        uint32_t material = primitive_of(s, i)->material;
        masu_bake_buffer corners = {0};
        for (uint32_t k = i; k < count; k++) {
            if (primitive_of(s, k)->material == material)
                masu_bake_surface_collect(s->content, s->mesh.first_primitive + k, 1, &corners);
        }
        uint32_t triangles = (uint32_t)(corners.bytes / (3 * sizeof(masu_bake_vec3)));
        if (triangles)
            s->looks[s->look_count++] = look_make(
                material, (const masu_bake_vec3(*)[3])(void *)corners.data, triangles);
        masu_bake_release(&corners);
    }
}

static void store(masu_bake_content *content, const source *s, uint32_t mesh, const form *f) {
    masu_blob_lod lod = {
        .mesh = mesh, .first_primitive = (uint32_t)masu_bake_count(content, MASU_BLOB_PRIMITIVES)};
    /* Rounded up, so that it remains a bound. An exact candidate still has an error of one fp32
     * step. */
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
        look_at_materials(&s);
        make_levels(content, &s, m, levels, report);
        for (uint32_t i = 0; i < s.look_count; i++) look_release(&s.looks[i]);
        free(s.looks);
        masu_bake_surface_release(&s.surface);
        free(s.part_size);
        free(s.part);
        masu_bake_release(&corners);
    }
}
