/* api_mesh.c: the public functions for meshes that the host creates at run time, in the slots of
 * desc.reserve.meshes (src/frame/meshes.h). A mesh is a model with one node and one instance; the
 * functions of models and instances move, show and remove it (api_add.c). */
#include "base/error.h"
#include "renderer.h"

/* After its vertices have changed: its box, and where rays find it. */
static void settle(masu_renderer *m, uint32_t slot) {
    uint32_t instance = masu_mesh_instances(&m->plan) + slot;
    masu_instances_touch(&m->instances, &m->plan, instance);
    masu_bounds_move(&m->bounds, &m->plan, &m->instances, instance);
}

static void set(masu_renderer *m, uint32_t slot, const masu_mesh_data *data) {
    const masu_scene_data *scene = &m->plan.scene;
    masu_meshes_set(&m->meshes, &m->bounds, &m->draws, &m->plan, slot, data);
    if (scene->host_nodes) {
        uint32_t node = scene->trace_nodes - scene->host_nodes +
                        masu_mesh_slot_of(&m->plan.desc.reserve, 1, slot).first_node;
        masu_reflections_set_mesh(&m->reflections, &m->plan, slot,
                                  masu_mesh_instances(&m->plan) + slot, node);
    }
    settle(m, slot);
}

/* A free model of a kind. */
static masu_result find_slot(masu_renderer *m, uint32_t kind, uint32_t *model) {
    const masu_mesh_kind *kinds = m->plan.desc.reserve.meshes;
    uint32_t first = masu_mesh_models(&m->plan);
    if (kind >= MASU_MAX_MESH_KINDS || !m->plan.reserve.meshes || !kinds[kind].meshes) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "kind", 1, 0,
                         "mesh: desc.reserve.meshes[%u] is unused", kind);
    }
    for (uint32_t k = 0; k < kind; k++) first += kinds[k].meshes;
    *model = masu_handle_free(&m->models.handles, first, kinds[kind].meshes);
    if (*model != UINT32_MAX) return MASU_OK;
    return masu_fail(&m->error, MASU_ERROR_LIMIT, "reserve.meshes", kinds[kind].meshes + 1,
                     kinds[kind].meshes, "reserve.meshes[%u]: %u are needed, %u are given", kind,
                     kinds[kind].meshes + 1, kinds[kind].meshes);
}

masu_result masu_mesh_create(masu_renderer *m, uint32_t kind, const masu_mesh_data *data,
                             const float rows[12], masu_model *out, masu_detail *detail) {
    uint32_t model = 0;
    if (out) *out = (masu_model){0};
    if (!m || !data || !rows || !out)
        return masu_finish_null(m, !data ? "data" : rows ? "out" : "rows", detail);
    masu_result result = find_slot(m, kind, &model);
    uint32_t slot = model - masu_mesh_models(&m->plan);
    if (!result) result = masu_meshes_check(&m->meshes, &m->plan, slot, data, &m->error);
    if (!result)
        result = masu_models_move(&m->models, &m->instances, &m->bounds, &m->plan, model, rows,
                                  &m->error);
    if (result) return masu_finish(m, result, detail); /* nothing is visible yet */
    set(m, slot, data);
    masu_handle_turn(&m->models.handles, model);
    masu_handle_turn(&m->instances.handles, masu_mesh_instances(&m->plan) + slot);
    masu_models_show(&m->models, &m->instances, &m->plan, model, 1);
    if (m->plan.needs.picking)
        m->picking.added[model - masu_own_models(&m->plan)] = m->timeline.frame;
    *out = masu_model_at(m, model);
    return MASU_OK;
}

static masu_result find_mesh(masu_renderer *m, masu_model mesh, uint32_t *slot) {
    uint32_t model;
    masu_result result = masu_handle_check(&m->models.handles, "mesh", mesh.id, &model, &m->error);
    if (result) return result;
    if (model >= masu_mesh_models(&m->plan)) {
        *slot = model - masu_mesh_models(&m->plan);
        return MASU_OK;
    }
    return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "mesh", 0, model,
                     "model %u is not a mesh of the host, its vertices cannot be changed", model);
}

masu_result masu_mesh_replace(masu_renderer *m, masu_model mesh, const masu_mesh_data *data,
                              masu_detail *detail) {
    uint32_t slot;
    if (!m || !data) return masu_finish_null(m, "data", detail);
    masu_result result = find_mesh(m, mesh, &slot);
    if (!result) result = masu_meshes_check(&m->meshes, &m->plan, slot, data, &m->error);
    if (result) return masu_finish(m, result, detail);
    set(m, slot, data);
    return MASU_OK;
}

masu_result masu_mesh_deform(masu_renderer *m, masu_model mesh, const float *positions,
                             const float *normals, uint32_t vertex_count, masu_detail *detail) {
    uint32_t slot;
    if (!m || !positions || !normals)
        return masu_finish_null(m, positions ? "normals" : "positions", detail);
    const masu_mesh_data data = {
        .positions = positions, .normals = normals, .vertex_count = vertex_count};
    masu_result result = find_mesh(m, mesh, &slot);
    if (!result) result = masu_meshes_check_vertices(&m->meshes, &m->plan, slot, &data, &m->error);
    if (result) return masu_finish(m, result, detail);
    masu_meshes_set_vertices(&m->meshes, &m->bounds, &m->plan, slot, &data);
    settle(m, slot);
    return MASU_OK;
}

uint64_t masu_mesh_bytes(const masu_renderer *m, uint32_t vertex_count, uint32_t triangle_count) {
    return m ? masu_mesh_upload_of(&m->plan.scene, vertex_count, triangle_count).bytes : 0;
}
