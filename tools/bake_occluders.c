/* bake_occluders.c: see bake_occluders.h. That a box lies inside of what the mesh hides is the
 * word of the scene's file, but for meshes that are boxes, which is looked up triangle by triangle. */
#include "bake_occluders.h"

#include "cli.h"

#include <stdlib.h>
#include <string.h>

#define OCCLUDERS(c) MASU_BAKE_ARRAY(c, MASU_BLOB_OCCLUDERS, masu_blob_occluder)

bool masu_bake_add_occluder(masu_bake_content *content, uint32_t mesh, masu_bake_box box) {
    const masu_blob_mesh *m = &MASU_BAKE_MESHES(content)[mesh];
    masu_blob_occluder o = {.mesh = mesh};
    const double low[3] = {box.low.x, box.low.y, box.low.z};
    const double high[3] = {box.high.x, box.high.y, box.high.z};
    for (int k = 0; k < 3; k++) {
        double inset = 1e-5 * fmax(fabs(low[k]), fabs(high[k]));
        double from = fmax(low[k], (double)m->aabb_min[k]) + inset;
        double to = fmin(high[k], (double)m->aabb_max[k]) - inset;
        if (!(from < to)) return false;
        o.low[k] = (float)from;
        o.high[k] = (float)to;
    }
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_OCCLUDERS); i++) {
        if (!memcmp(&OCCLUDERS(content)[i], &o, sizeof o)) return false;
    }
    masu_bake_append(&content->section[MASU_BLOB_OCCLUDERS], &o, sizeof o);
    return true;
}

/* The corner of the mesh's box that a vertex is, bit k: the upper one along axis k; or 8. */
static uint32_t corner_of(const masu_blob_mesh *m, const float *p) {
    uint32_t corner = 0;
    for (uint32_t k = 0; k < 3; k++) {
        if (p[k] == m->aabb_max[k]) {
            corner |= 1u << k;
        } else if (p[k] != m->aabb_min[k]) {
            return 8;
        }
    }
    return corner;
}

bool masu_bake_is_box(const masu_bake_content *content, uint32_t mesh, masu_bake_box *box) {
    const masu_blob_mesh *m = &MASU_BAKE_MESHES(content)[mesh];
    /* Of each face, the corners that its triangles leave out: two that are opposite. */
    uint32_t left_out[6] = {0}, triangles[6] = {0};
    for (uint32_t k = 0; k < 3; k++) {
        if (!(m->aabb_min[k] < m->aabb_max[k])) return false;
    }
    for (uint32_t j = 0; j < m->primitive_count; j++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[m->first_primitive + j];
        for (uint32_t t = 0; t + 2 < p->index_count; t += 3) {
            uint32_t all = 7, none = 0, set = 0;
            for (uint32_t i = 0; i < 3; i++) {
                uint32_t index = MASU_BAKE_INDICES(content)[p->first_index + t + i];
                uint32_t c = corner_of(
                    m, MASU_BAKE_VERTICES(content)[p->first_vertex + index].position);
                if (c == 8) return false;
                all &= c;
                none |= c;
                set |= 1u << c;
            }
            uint32_t face = 6;
            for (uint32_t k = 0; k < 3; k++) {
                if (all >> k & 1u) face = 2 * k + 1;
                if (!(none >> k & 1u)) face = 2 * k;
            }
            if (face == 6 || ++triangles[face] > 2) return false;
            for (uint32_t c = 0; c < 8; c++) {
                if ((c >> (face / 2) & 1u) == (face & 1u) && !(set >> c & 1u))
                    left_out[face] |= 1u << c;
            }
        }
    }
    for (uint32_t face = 0; face < 6; face++) {
        uint32_t opposite = 7u & ~(1u << face / 2), a = 0;
        while (a < 8 && !(left_out[face] >> a & 1u)) a++;
        if (triangles[face] != 2 || left_out[face] != (1u << a | 1u << (a ^ opposite)))
            return false;
    }
    box->low = masu_bake_v3f(m->aabb_min);
    box->high = masu_bake_v3f(m->aabb_max);
    return true;
}

static bool is_opaque(const masu_bake_content *content, const masu_blob_mesh *mesh) {
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        uint32_t material = MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive + i].material;
        if (MASU_BAKE_MATERIALS(content)[material].flags &
            (MASU_MATERIAL_IS_MASK | MASU_MATERIAL_IS_BLEND)) {
            return false;
        }
    }
    return true;
}

void masu_bake_drop_occluders(masu_bake_content *content) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_OCCLUDERS), kept = 0;
    uint32_t warned = MASU_BLOB_NONE;
    for (uint64_t i = 0; i < count; i++) {
        masu_blob_occluder o = OCCLUDERS(content)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[o.mesh];
        if (is_opaque(content, mesh)) {
            OCCLUDERS(content)[kept++] = o;
        } else if (o.mesh != warned) {
            warned = o.mesh;
            masu_cli_warn("the mesh \"%s\" is masked or blended: it is no occluder",
                          masu_bake_name_text(content, mesh->name));
        }
    }
    content->section[MASU_BLOB_OCCLUDERS].bytes = (size_t)kept * sizeof(masu_blob_occluder);
}

static int by_mesh(const void *a, const void *b) {
    const masu_blob_occluder *p = a, *q = b;
    if (p->mesh != q->mesh) return p->mesh < q->mesh ? -1 : 1;
    return memcmp(p, q, sizeof *p);
}

void masu_bake_sort_occluders(masu_bake_content *content) {
    size_t count = (size_t)masu_bake_count(content, MASU_BLOB_OCCLUDERS);
    if (count) qsort(OCCLUDERS(content), count, sizeof(masu_blob_occluder), by_mesh);
}
