/* occluders.c: see occluders.h. The code proves for each box, triangle by triangle, that it is
 * inside the mesh's opaque surface. Boxes given by the scene file are not tested for the mesh
 * itself, only for its LODs. */
#include "bake/mesh/occluders.h"
#include "bake/mesh/surface.h"
#include "bake/scene/skin.h"

#include "cli/cli.h"

#include <stdlib.h>
#include <string.h>

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
        if (!memcmp(&MASU_BAKE_OCCLUDERS(content)[i], &o, sizeof o)) return false;
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
    /* For each face, the corners that its triangles do not use: two opposite ones. */
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
                uint32_t c =
                    corner_of(m, MASU_BAKE_VERTICES(content)[p->first_vertex + index].position);
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

/* Six times the enclosed volume, for triangles that are counter-clockwise from outside. */
static double volume_of(const masu_bake_content *content, const masu_blob_mesh *mesh) {
    double sum = 0;
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive + i];
        const uint32_t *index = &MASU_BAKE_INDICES(content)[p->first_index];
        for (uint32_t k = 0; k + 3 <= p->index_count; k += 3) {
            masu_bake_vec3 c[3];
            for (uint32_t n = 0; n < 3; n++)
                c[n] = masu_bake_v3f(
                    MASU_BAKE_VERTICES(content)[p->first_vertex + index[k + n]].position);
            sum += masu_bake_dot(c[0], masu_bake_cross(c[1], c[2]));
        }
    }
    return sum;
}

/* A single-sided surface with inward faces occludes nothing, for example a room that the camera
 * looks into. */
static bool is_opaque(const masu_bake_content *content, const masu_blob_mesh *mesh) {
    bool single = false;
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        uint32_t material = MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive + i].material;
        if (MASU_BAKE_MATERIALS(content)[material].flags &
            (MASU_MATERIAL_IS_MASK | MASU_MATERIAL_IS_BLEND)) {
            return false;
        }
        single = single || MASU_BAKE_MATERIALS(content)[material].flags & MASU_MATERIAL_IS_SINGLE;
    }
    return !single || volume_of(content, mesh) > 0;
}

void masu_bake_drop_occluders(masu_bake_content *content) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_OCCLUDERS), kept = 0;
    uint32_t warned = MASU_BLOB_NONE;
    for (uint64_t i = 0; i < count; i++) {
        masu_blob_occluder o = MASU_BAKE_OCCLUDERS(content)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[o.mesh];
        if (is_opaque(content, mesh)) {
            MASU_BAKE_OCCLUDERS(content)[kept++] = o;
        } else if (o.mesh != warned) {
            warned = o.mesh;
            masu_cli_warn("the mesh \"%s\" is alpha-tested, transparent or inside out: it cannot "
                          "be an occluder",
                          masu_bake_name_text(content, mesh->name));
        }
    }
    content->section[MASU_BLOB_OCCLUDERS].bytes = (size_t)kept * sizeof(masu_blob_occluder);
}

/* ---- All meshes ------------------------------------------------------------------------------ */

/* The largest factor by which a placement of each mesh lengthens anything along an axis. */
static double *largest_scales(const masu_bake_content *content) {
    uint64_t meshes = masu_bake_count(content, MASU_BLOB_MESHES);
    double *scales = masu_bake_allocate(meshes * sizeof *scales);
    for (uint64_t i = 0; i < meshes; i++) scales[i] = 0;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(content)[i];
        for (int k = 0; k < 3; k++) {
            masu_bake_vec3 column = masu_bake_v3(
                (double)n->transform[k], (double)n->transform[4 + k], (double)n->transform[8 + k]);
            scales[n->mesh] = fmax(scales[n->mesh], masu_bake_length(column));
        }
    }
    return scales;
}

static void make_one(masu_bake_content *content, uint32_t index, double least,
                     masu_bake_occluder_report *report) {
    const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[index];
    masu_bake_box boxes[MASU_BAKE_BOXES_MAX];
    boxes[0] = (masu_bake_box){masu_bake_v3f(mesh->aabb_min), masu_bake_v3f(mesh->aabb_max)};
    if (!(masu_bake_second_side(&boxes[0]) >= least)) {
        report->too_small++;
        return;
    }
    uint32_t count = 1, added = 0;
    bool whole = masu_bake_is_box(content, index, &boxes[0]);
    if (!whole) {
        masu_bake_buffer corners = {0};
        masu_bake_surface_collect(content, mesh->first_primitive, mesh->primitive_count, &corners);
        count = masu_bake_boxes_inside((const masu_bake_vec3(*)[3])(void *)corners.data,
                                       corners.bytes / (3 * sizeof(masu_bake_vec3)), least, boxes);
        masu_bake_release(&corners);
    }
    for (uint32_t i = 0; i < count; i++) added += masu_bake_add_occluder(content, index, boxes[i]);
    report->whole += added && whole;
    report->inside += added && !whole;
    report->dropped += !added;
}

void masu_bake_make_occluders(masu_bake_content *content, double least,
                              masu_bake_occluder_report *report) {
    uint64_t meshes = masu_bake_count(content, MASU_BLOB_MESHES);
    bool *has = masu_bake_allocate(meshes * sizeof *has);
    memset(has, 0, meshes * sizeof *has);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_OCCLUDERS); i++) {
        has[MASU_BAKE_OCCLUDERS(content)[i].mesh] = true;
    }
    double *scales = largest_scales(content);
    for (uint32_t m = 0; m < meshes; m++) {
        report->given += has[m];
        if (!has[m] && least > 0 && scales[m] > 0 && !masu_bake_is_skinned(content, m))
            make_one(content, m, least / scales[m], report);
    }
    free(scales);
    free(has);
}

void masu_bake_prove_occluders(masu_bake_content *content) {
    uint64_t lods = masu_bake_count(content, MASU_BLOB_LODS);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_OCCLUDERS); i++) {
        masu_blob_occluder *o = &MASU_BAKE_OCCLUDERS(content)[i];
        masu_bake_box box = {masu_bake_v3f(o->low), masu_bake_v3f(o->high)};
        uint32_t primitives = MASU_BAKE_MESHES(content)[o->mesh].primitive_count;
        bool good = true;
        for (uint64_t k = 0; k < lods && good; k++) { /* of one mesh the finer first */
            const masu_blob_lod *l = &MASU_BAKE_ARRAY(content, MASU_BLOB_LODS, masu_blob_lod)[k];
            if (l->mesh != o->mesh) continue;
            masu_bake_buffer corners = {0};
            masu_bake_surface_collect(content, l->first_primitive, primitives, &corners);
            good = masu_bake_is_inside((const masu_bake_vec3(*)[3])(void *)corners.data,
                                       corners.bytes / (3 * sizeof(masu_bake_vec3)), &box);
            masu_bake_release(&corners);
            o->lods += good;
        }
    }
}

static int by_mesh(const void *a, const void *b) {
    const masu_blob_occluder *p = a, *q = b;
    if (p->mesh != q->mesh) return p->mesh < q->mesh ? -1 : 1;
    return memcmp(p, q, sizeof *p);
}

void masu_bake_sort_occluders(masu_bake_content *content) {
    size_t count = (size_t)masu_bake_count(content, MASU_BLOB_OCCLUDERS);
    if (count) qsort(MASU_BAKE_OCCLUDERS(content), count, sizeof(masu_blob_occluder), by_mesh);
}
