/* check_geometry.c: validates vertices, primitives, meshes, LODs and instances. */
#include "scene/check.h"

static masu_result check_primitive(reader *r, uint64_t i) {
    const masu_blob_primitive *p = &r->view.primitives[i];
    if (p->index_count % 3) return bad(r, "primitives", i, "index count is no multiple of 3");
    if ((uint64_t)p->first_index + p->index_count > r->counts[MASU_BLOB_INDICES]) {
        return bad(r, "primitives", i, "indices lie outside the index section");
    }
    if (p->vertex_count < 1 || p->vertex_count > 0xFFFFFF) {
        return bad(r, "primitives", i, "vertex count is not 1 to 16,777,215");
    }
    if ((uint64_t)p->first_vertex + p->vertex_count > r->counts[MASU_BLOB_VERTICES]) {
        return bad(r, "primitives", i, "vertices lie outside the vertex section");
    }
    if (p->material >= r->counts[MASU_BLOB_MATERIALS]) {
        return bad(r, "primitives", i, "no such material");
    }
    if (!finite_all(p->aabb_min, 3) || !finite_all(p->aabb_max, 3)) {
        return bad(r, "primitives", i, "bounds are not finite");
    }
    if (!(p->rise >= 0.0f) || !finite_all(&p->rise, 1)) {
        return bad(r, "primitives", i, "the rise of its surface is negative or not finite");
    }
    for (uint32_t k = 0; k < p->index_count; k++) {
        uint32_t index = r->view.indices[p->first_index + k];
        if (index >= p->vertex_count) {
            return bad(r, "indices", (uint64_t)p->first_index + k, "points outside its primitive");
        }
        const float *v = r->view.vertices[p->first_vertex + index].position;
        if (!box_holds(p->aabb_min, p->aabb_max, v, v)) {
            return bad(r, "primitives", i, "bounds do not hold its vertices");
        }
    }
    return MASU_OK;
}

static masu_result check_mesh(reader *r, uint64_t i) {
    const masu_blob_mesh *m = &r->view.meshes[i];
    if (!finite_all(m->aabb_min, 3) || !finite_all(m->aabb_max, 3)) {
        return bad(r, "meshes", i, "bounds are not finite");
    }
    for (uint32_t k = 0; k < m->primitive_count; k++) {
        const masu_blob_primitive *p = &r->view.primitives[m->first_primitive + k];
        if (!box_holds(m->aabb_min, m->aabb_max, p->aabb_min, p->aabb_max)) {
            return bad(r, "meshes", i, "bounds do not hold its primitives");
        }
    }
    return name_ok(r, m->name) ? MASU_OK : bad(r, "meshes", i, "name lies outside the names");
}

static masu_result check_lods(reader *r, uint64_t *primitives) {
    const masu_scene_view *v = &r->view;
    uint32_t level = 0;
    if (r->counts[MASU_BLOB_LODS] && r->counts[MASU_BLOB_INSTANCES] > MASU_SECTION_MOST / 4) {
        /* an instance has one list entry per LOD */
        return bad(r, "lods", 0, "are of over 2^29 instances");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_LODS]; i++) {
        const masu_blob_lod *l = &v->lods[i];
        if (l->mesh >= r->counts[MASU_BLOB_MESHES]) return bad(r, "lods", i, "no such mesh");
        const masu_blob_mesh *m = &v->meshes[l->mesh];
        if (i && l->mesh < l[-1].mesh) return bad(r, "lods", i, "not sorted by mesh");
        level = i && l->mesh == l[-1].mesh ? level + 1 : 1;
        if (level > MASU_BLOB_LODS_MAX) return bad(r, "lods", i, "a mesh has more than three");
        if (!(l->error >= 0.0f && l->error <= 1e30f)) {
            return bad(r, "lods", i, "error is negative or not finite");
        }
        if (level > 1 && !(l->error >= l[-1].error)) {
            return bad(r, "lods", i, "error falls from level to level");
        }
        if ((uint64_t)l->first_primitive + m->primitive_count > r->counts[MASU_BLOB_PRIMITIVES]) {
            return bad(r, "lods", i, "primitives lie outside their section");
        }
        *primitives += m->primitive_count;
        if (*primitives > r->counts[MASU_BLOB_PRIMITIVES])
            return bad(r, "lods", i, "shares primitives");
        for (uint32_t p = 0; p < m->primitive_count; p++) {
            const masu_blob_primitive *fine = &v->primitives[m->first_primitive + p];
            const masu_blob_primitive *coarse = &v->primitives[l->first_primitive + p];
            if (coarse->material != fine->material)
                return bad(r, "lods", i, "has another material than its mesh");
            if (coarse->index_count > fine->index_count)
                return bad(r, "lods", i, "has more triangles than its mesh");
            if (!box_holds(m->aabb_min, m->aabb_max, coarse->aabb_min, coarse->aabb_max))
                return bad(r, "lods", i, "reaches out of the bounds of its mesh");
        }
    }
    return MASU_OK;
}

masu_result masu_check_geometry(reader *r) {
    const masu_scene_view *v = &r->view;
    /* Ranges must not overlap: otherwise a small blob could cause quadratic work, here and every
     * frame. */
    uint64_t indices = 0, primitives = 0;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_VERTICES]; i++) {
        if (!finite_all(v->vertices[i].position, 3)) return bad(r, "vertices", i, "is not finite");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_PRIMITIVES]; i++) {
        indices += v->primitives[i].index_count;
        if (indices > r->counts[MASU_BLOB_INDICES])
            return bad(r, "primitives", i, "shares indices");
        masu_result result = check_primitive(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MESHES]; i++) {
        const masu_blob_mesh *m = &v->meshes[i];
        if ((uint64_t)m->first_primitive + m->primitive_count > r->counts[MASU_BLOB_PRIMITIVES]) {
            return bad(r, "meshes", i, "primitives lie outside their section");
        }
        primitives += m->primitive_count;
        if (primitives > r->counts[MASU_BLOB_PRIMITIVES])
            return bad(r, "meshes", i, "shares primitives");
        masu_result result = check_mesh(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_INSTANCES]; i++) {
        const masu_blob_instance *n = &v->instances[i];
        if (!finite_all(n->transform, 12)) return bad(r, "instances", i, "transform is not finite");
        if (n->mesh >= r->counts[MASU_BLOB_MESHES]) return bad(r, "instances", i, "no such mesh");
        if (i && n->mesh < v->instances[i - 1].mesh)
            return bad(r, "instances", i, "not sorted by mesh");
        if (!name_ok(r, n->name)) return bad(r, "instances", i, "name lies outside the names");
        if (n->parent != MASU_BLOB_NONE && n->parent >= r->counts[MASU_BLOB_INSTANCES]) {
            return bad(r, "instances", i, "no such parent");
        }
    }
    return check_lods(r, &primitives);
}
