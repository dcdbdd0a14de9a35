/* merge.c: merges many small static meshes into one mesh per material and grid cell. A track of
 * 3,900 meshes of 18 triangles then needs hundreds of draws instead of thousands, and each can
 * still be culled. Cells are needed because a mesh that spans the scene is never outside the view.
 * The origin is at the centre of a cell: a model around it that is smaller than a cell becomes one
 * mesh per material.
 *
 * Vertices are copied unchanged, texture coordinates included, except for position and normal,
 * which are transformed to model space. */
#include "bake/mesh/detail.h"
#include "bake/mesh/triangles.h"
#include "bake/scene/piece.h"

#include <stdlib.h>
#include <string.h>

typedef struct bit { /* one triangle on its way */
    uint32_t material;
    int32_t cell[3];
    uint32_t instance, primitive, first_index;
} bit;

static int by_cell(const void *a, const void *b) {
    const bit *p = a, *q = b;
    if (p->material != q->material) return p->material < q->material ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        if (p->cell[k] != q->cell[k]) return p->cell[k] < q->cell[k] ? -1 : 1;
    }
    if (p->instance != q->instance) return p->instance < q->instance ? -1 : 1;
    if (p->primitive != q->primitive) return p->primitive < q->primitive ? -1 : 1;
    return p->first_index < q->first_index ? -1 : p->first_index > q->first_index;
}

static bool same_cell(const bit *a, const bit *b) {
    return a->material == b->material && memcmp(a->cell, b->cell, sizeof a->cell) == 0;
}

static masu_bake_vec3 decoded(const int16_t n[2]) { /* blob.md */
    double x = n[0] / 32767.0, y = n[1] / 32767.0, z = 1 - fabs(x) - fabs(y);
    masu_bake_vec3 v = {x, y, z};
    if (z < 0) {
        v.x = (1 - fabs(y)) * (x >= 0 ? 1 : -1);
        v.y = (1 - fabs(x)) * (y >= 0 ? 1 : -1);
    }
    return v;
}

static bool mirrors(const masu_bake_affine *a) {
    const double *m = a->m;
    masu_bake_vec3 x = {m[0], m[4], m[8]}, y = {m[1], m[5], m[9]}, z = {m[2], m[6], m[10]};
    return masu_bake_dot(x, masu_bake_cross(y, z)) < 0;
}

/* Normals go by the cofactors, which also work where the transform mirrors or flattens. */
static void move_vertex(masu_blob_vertex *v, const masu_bake_affine *a) {
    const double *m = a->m;
    masu_bake_vec3 p = masu_bake_apply(a, masu_bake_v3f(v->position)), n = decoded(v->normal);
    masu_bake_vec3 x = {m[0], m[4], m[8]}, y = {m[1], m[5], m[9]}, z = {m[2], m[6], m[10]};
    masu_bake_vec3 cx = masu_bake_cross(y, z), cy = masu_bake_cross(z, x),
                   cz = masu_bake_cross(x, y);
    masu_bake_vec3 moved = {cx.x * n.x + cy.x * n.y + cz.x * n.z,
                            cx.y * n.x + cy.y * n.y + cz.y * n.z,
                            cx.z * n.x + cy.z * n.y + cz.z * n.z};
    if (mirrors(a)) moved = masu_bake_v3(-moved.x, -moved.y, -moved.z);
    if (!masu_bake_normalize(&moved)) moved = masu_bake_v3(0, 1, 0);
    v->position[0] = (float)p.x + 0.0f;
    v->position[1] = (float)p.y + 0.0f;
    v->position[2] = (float)p.z + 0.0f;
    masu_bake_encode_normal(moved, v->normal);
}

static uint64_t shown_triangles(const masu_bake_content *piece, const masu_blob_mesh *mesh) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        sum += MASU_BAKE_PRIMITIVES(piece)[mesh->first_primitive + i].index_count / 3;
    }
    return sum;
}

static bool cell_of(const masu_bake_content *piece, const masu_blob_primitive *p,
                    const masu_bake_affine *a, double cell, bit *b) {
    masu_bake_vec3 middle = {0, 0, 0};
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t v = p->first_vertex + MASU_BAKE_INDICES(piece)[b->first_index + k];
        masu_bake_vec3 at =
            masu_bake_apply(a, masu_bake_v3f(MASU_BAKE_VERTICES(piece)[v].position));
        middle = masu_bake_mad(middle, at, 1.0 / 3);
    }
    const double c[3] = {middle.x / cell, middle.y / cell, middle.z / cell};
    for (int k = 0; k < 3; k++) {
        if (!(fabs(c[k]) < 1e9)) return false;
        b->cell[k] = (int32_t)floor(c[k] + 0.5);
    }
    return true;
}

/* Everything of the instances that are merged. The other instances go to `left`. */
static const char *take_apart(const masu_bake_content *piece, double cell, masu_bake_buffer *bits,
                              masu_bake_buffer *left) {
    uint64_t meshes = masu_bake_count(piece, MASU_BLOB_MESHES);
    uint64_t instances = masu_bake_count(piece, MASU_BLOB_INSTANCES);
    uint32_t *shown = masu_bake_allocate(meshes * sizeof *shown);
    const char *problem = NULL;
    memset(shown, 0, meshes * sizeof *shown);
    for (uint64_t i = 0; i < instances; i++) shown[MASU_BAKE_INSTANCES(piece)[i].mesh]++;
    for (uint32_t i = 0; i < instances && !problem; i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(piece)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(piece)[n->mesh];
        if (shown[n->mesh] > 1 && shown_triangles(piece, mesh) > MASU_BAKE_MERGE_TRIANGLES) {
            masu_bake_append(left, &i, sizeof i);
            continue;
        }
        masu_bake_affine a = masu_bake_transform(&MASU_BAKE_INSTANCES(piece)[i]);
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            uint32_t at = mesh->first_primitive + j;
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(piece)[at];
            for (uint32_t k = 0; k < p->index_count; k += 3) {
                bit b = {.material = p->material,
                         .instance = i,
                         .primitive = at,
                         .first_index = p->first_index + k};
                if (!cell_of(piece, p, &a, cell, &b)) problem = "cells too small for its size";
                masu_bake_append(bits, &b, sizeof b);
            }
        }
    }
    free(shown);
    return problem;
}

/* ---- putting together ---- */

/* Vertices of the chunk, found again by where they came from; bits are sorted by instance and
 * primitive, so one small table per primitive would do, but chunks are small and this is simple. */
typedef struct seam {
    uint64_t from; /* instance << 32 | vertex */
    uint32_t index;
} seam;

static uint32_t vertex_of(masu_bake_content *out, const masu_bake_content *piece, seam *table,
                          size_t slots, masu_blob_primitive *p, uint32_t instance,
                          uint32_t vertex) {
    uint64_t from = (uint64_t)instance << 32 | vertex;
    size_t slot = (size_t)masu_fnv1a64(&from, sizeof from) & (slots - 1);
    for (; table[slot].index != MASU_BLOB_NONE; slot = (slot + 1) & (slots - 1)) {
        if (table[slot].from == from) return table[slot].index;
    }
    table[slot] = (seam){from, p->vertex_count};
    masu_blob_vertex v = MASU_BAKE_VERTICES(piece)[vertex];
    masu_bake_affine a = masu_bake_transform(&MASU_BAKE_INSTANCES(piece)[instance]);
    move_vertex(&v, &a);
    masu_bake_append(&out->section[MASU_BLOB_VERTICES], &v, sizeof v);
    const float *texcoords = MASU_BAKE_ARRAY(piece, MASU_BLOB_TEXCOORDS, const float);
    masu_bake_append(&out->section[MASU_BLOB_TEXCOORDS], texcoords + 2 * (size_t)vertex,
                     2 * sizeof *texcoords);
    masu_bake_copy_attributes(out, piece, vertex, 1);
    for (int k = 0; k < 3; k++) {
        if (p->vertex_count == 0 || v.position[k] < p->aabb_min[k]) p->aabb_min[k] = v.position[k];
        if (p->vertex_count == 0 || v.position[k] > p->aabb_max[k]) p->aabb_max[k] = v.position[k];
    }
    return p->vertex_count++;
}

static void put_together(masu_bake_content *out, const masu_bake_content *piece, const bit *bits,
                         size_t count) {
    size_t slots = 16;
    while (slots < 6 * count) slots *= 2;
    seam *table = masu_bake_allocate(slots * sizeof *table);
    memset(table, 0xFF, slots * sizeof *table);
    masu_blob_primitive p = {.first_index = (uint32_t)masu_bake_count(out, MASU_BLOB_INDICES),
                             .index_count = (uint32_t)(3 * count),
                             .first_vertex = (uint32_t)masu_bake_count(out, MASU_BLOB_VERTICES),
                             .material = bits[0].material};
    for (size_t i = 0; i < count; i++) {
        uint32_t first = MASU_BAKE_PRIMITIVES(piece)[bits[i].primitive].first_vertex;
        masu_bake_affine a = masu_bake_transform(&MASU_BAKE_INSTANCES(piece)[bits[i].instance]);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t corner = mirrors(&a) ? (3 - k) % 3 : k; /* keeps the outside */
            uint32_t from = first + MASU_BAKE_INDICES(piece)[bits[i].first_index + corner];
            uint32_t index = vertex_of(out, piece, table, slots, &p, bits[i].instance, from);
            masu_bake_append(&out->section[MASU_BLOB_INDICES], &index, sizeof index);
        }
    }
    free(table);
    masu_bake_append(&out->section[MASU_BLOB_PRIMITIVES], &p, sizeof p);
    const char *name = masu_bake_name_text(piece, MASU_BAKE_MATERIALS(piece)[p.material].name);
    uint32_t primitive = (uint32_t)masu_bake_count(out, MASU_BLOB_PRIMITIVES) - 1;
    uint32_t mesh = masu_bake_mesh(out, primitive, 1, masu_bake_name(out, name, strlen(name)));
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_instance(out, &identity, mesh, MASU_BLOB_NONE, MASU_BLOB_NONE);
}

/* Copies the instances that were not merged, with their meshes, after the chunks. */
static void keep(masu_bake_content *out, const masu_bake_content *piece, const uint32_t *left,
                 size_t count) {
    if (!count) return;
    uint32_t vertices = (uint32_t)masu_bake_count(out, MASU_BLOB_VERTICES);
    uint32_t indices = (uint32_t)masu_bake_count(out, MASU_BLOB_INDICES);
    masu_bake_append(&out->section[MASU_BLOB_VERTICES], piece->section[MASU_BLOB_VERTICES].data,
                     piece->section[MASU_BLOB_VERTICES].bytes);
    masu_bake_append(&out->section[MASU_BLOB_TEXCOORDS], piece->section[MASU_BLOB_TEXCOORDS].data,
                     piece->section[MASU_BLOB_TEXCOORDS].bytes);
    masu_bake_copy_attributes(out, piece, 0, masu_bake_count(piece, MASU_BLOB_VERTICES));
    masu_bake_append(&out->section[MASU_BLOB_INDICES], piece->section[MASU_BLOB_INDICES].data,
                     piece->section[MASU_BLOB_INDICES].bytes);
    uint64_t meshes = masu_bake_count(piece, MASU_BLOB_MESHES);
    uint32_t *moved = masu_bake_allocate(meshes * sizeof *moved);
    memset(moved, 0xFF, meshes * sizeof *moved);
    for (size_t i = 0; i < count; i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(piece)[left[i]];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(piece)[n->mesh];
        if (moved[n->mesh] == MASU_BLOB_NONE) {
            uint32_t first = (uint32_t)masu_bake_count(out, MASU_BLOB_PRIMITIVES);
            for (uint32_t j = 0; j < mesh->primitive_count; j++) {
                masu_blob_primitive p = MASU_BAKE_PRIMITIVES(piece)[mesh->first_primitive + j];
                p.first_vertex += vertices;
                p.first_index += indices;
                masu_bake_append(&out->section[MASU_BLOB_PRIMITIVES], &p, sizeof p);
            }
            const char *name = masu_bake_name_text(piece, mesh->name);
            moved[n->mesh] = masu_bake_mesh(out, first, mesh->primitive_count,
                                            masu_bake_name(out, name, strlen(name)));
        }
        const char *name = masu_bake_name_text(piece, n->name);
        masu_bake_affine a = masu_bake_transform(&MASU_BAKE_INSTANCES(piece)[left[i]]);
        masu_bake_instance(out, &a, moved[n->mesh], MASU_BLOB_NONE,
                           masu_bake_name(out, name, strlen(name)));
    }
    free(moved);
}

const char *masu_bake_merge(masu_bake_content *piece, double cell) {
    masu_bake_buffer bits = {0}, left = {0};
    const char *problem = take_apart(piece, cell, &bits, &left);
    if (!problem) {
        masu_bake_content out = {0};
        bit *b = (bit *)(void *)bits.data;
        size_t count = bits.bytes / sizeof *b;
        if (count) qsort(b, count, sizeof *b, by_cell);
        for (size_t i = 0, next; i < count; i = next) {
            for (next = i + 1; next < count && same_cell(&b[i], &b[next]); next++) continue;
            put_together(&out, piece, b + i, next - i);
        }
        keep(&out, piece, (const uint32_t *)(void *)left.data, left.bytes / sizeof(uint32_t));
        masu_bake_detach_lights(piece);
        for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_LIGHTS); i++) {
            masu_blob_light light = MASU_BAKE_LIGHTS(piece)[i];
            const char *name = masu_bake_name_text(piece, light.name);
            light.name = masu_bake_name(&out, name, strlen(name));
            masu_bake_append(&out.section[MASU_BLOB_LIGHTS], &light, sizeof light);
        }
        /* Materials keep their numbers, so their bytes are unchanged; their names change. */
        for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_MATERIALS); i++) {
            masu_blob_material m = MASU_BAKE_MATERIALS(piece)[i];
            const char *name = masu_bake_name_text(piece, m.name);
            m.name = masu_bake_name(&out, name, strlen(name));
            masu_bake_append(&out.section[MASU_BLOB_MATERIALS], &m, sizeof m);
        }
        for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
            bool ours = kind == MASU_BLOB_VERTICES || kind == MASU_BLOB_TEXCOORDS ||
                        kind == MASU_BLOB_COLORS || kind == MASU_BLOB_TEXCOORDS_1 ||
                        kind == MASU_BLOB_INDICES || kind == MASU_BLOB_PRIMITIVES ||
                        kind == MASU_BLOB_MESHES || kind == MASU_BLOB_INSTANCES ||
                        kind == MASU_BLOB_MATERIALS || kind == MASU_BLOB_NAMES ||
                        kind == MASU_BLOB_LIGHTS;
            if (ours) continue; /* other sections of a piece are unchanged */
            out.section[kind] = piece->section[kind];
            piece->section[kind] = (masu_bake_buffer){0};
        }
        masu_bake_buffer *const kept[][2] = {{&out.maps, &piece->maps},
                                             {&out.images, &piece->images},
                                             {&out.image_text, &piece->image_text},
                                             {&out.image_data, &piece->image_data},
                                             {&out.cameras, &piece->cameras}};
        for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
            *kept[i][0] = *kept[i][1];
            *kept[i][1] = (masu_bake_buffer){0};
        }
        masu_bake_content_release(piece);
        *piece = out;
    }
    masu_bake_release(&bits);
    masu_bake_release(&left);
    return problem;
}
