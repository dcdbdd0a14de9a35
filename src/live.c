/* live.c: the public functions that ask and change the instances and models of a scene between frames. What
 * they change is the host's truth in src/frame/; masu_frame carries it to the GPU. */
#include "base/error.h"
#include "renderer.h"

#include <string.h>

static masu_result missing(masu_renderer *m, const char *what) {
    if (!m) return MASU_ERROR_ARGUMENT;
    return masu_fail(&m->error, MASU_ERROR_ARGUMENT, what, 1, 0, "%s is NULL", what);
}

/* ---- Instances ------------------------------------------------------------------------------- */

static masu_result check_instance(masu_renderer *m, masu_instance instance, uint32_t *index) {
    uint32_t count = m->plan.scene.instances;
    *index = instance.id - 1;
    if (instance.id && instance.id <= count) return MASU_OK;
    return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "instance", count, instance.id,
                     "instance handle %u: the scene has handles 1 to %u", instance.id, count);
}

masu_instance masu_instance_at(const masu_renderer *m, uint32_t index) {
    if (!m || index >= m->plan.scene.instances) return (masu_instance){0};
    return (masu_instance){index + 1};
}

masu_result masu_instance_get(masu_renderer *m, masu_instance instance, masu_instance_state *out) {
    uint32_t i;
    if (!m || !out) return missing(m, "out");
    masu_result result = check_instance(m, instance, &i);
    if (result) return result;
    float box[6];
    *out = (masu_instance_state){.index = i,
                                 .mesh = m->instances.meshes[i],
                                 .shown = !masu_instance_hidden(&m->instances, i)};
    masu_instance_rows(&m->instances.now[i], out->rows);
    masu_bounds_of(&m->bounds, i, box);
    for (uint32_t k = 0; k < 3; k++) {
        out->box_low[k] = box[k] - box[3 + k];
        out->box_high[k] = box[k] + box[3 + k];
    }
    if (m->plan.scene.models && m->models.of_instance[i] != MASU_BLOB_NONE)
        out->model = masu_model_at(m, m->models.of_instance[i]);
    return MASU_OK;
}

masu_result masu_instance_show(masu_renderer *m, masu_instance instance, uint32_t shown) {
    uint32_t i;
    if (!m) return MASU_ERROR_ARGUMENT;
    masu_result result = check_instance(m, instance, &i);
    if (!result) masu_instances_show(&m->instances, &m->plan, i, shown != 0);
    return result;
}

/* ---- Models ---------------------------------------------------------------------------------- */

static masu_result check_model(masu_renderer *m, masu_model model, uint32_t *index) {
    uint32_t count = m->plan.scene.models;
    *index = model.id - 1;
    if (model.id && model.id <= count) return MASU_OK;
    return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "model", count, model.id,
                     "model handle %u: the scene has handles 1 to %u", model.id, count);
}

masu_model masu_model_find(const masu_renderer *m, const char *name) {
    if (!m || !name || !*name) return (masu_model){0};
    return masu_model_at(m, masu_models_find(&m->models, &m->plan, name));
}

masu_model masu_model_at(const masu_renderer *m, uint32_t index) {
    if (!m || index >= m->plan.scene.models) return (masu_model){0};
    return (masu_model){index + 1};
}

masu_result masu_model_get(masu_renderer *m, masu_model model, masu_model_state *out) {
    uint32_t i;
    if (!m || !out) return missing(m, "out");
    masu_result result = check_model(m, model, &i);
    if (result) return result;
    const masu_placed_model *of = &m->models.models[i];
    *out = (masu_model_state){.index = i, .shown = of->shown, .nodes = of->node_count};
    memcpy(out->rows, of->rows, sizeof out->rows);
    masu_models_box(&m->models, &m->bounds, i, out->box_low, out->box_high);
    return MASU_OK;
}

masu_result masu_model_set_transform(masu_renderer *m, masu_model model, const float rows[12]) {
    uint32_t i;
    if (!m || !rows) return missing(m, "rows");
    masu_result result = check_model(m, model, &i);
    if (result) return result;
    return masu_models_move(&m->models, &m->instances, &m->bounds, &m->plan, i, rows, &m->error);
}

masu_result masu_model_show(masu_renderer *m, masu_model model, uint32_t shown) {
    uint32_t i;
    if (!m) return MASU_ERROR_ARGUMENT;
    masu_result result = check_model(m, model, &i);
    if (!result) masu_models_show(&m->models, &m->instances, &m->plan, i, shown != 0);
    return result;
}

masu_result masu_model_add(masu_renderer *m, masu_model like, const float rows[12],
                           masu_model *out) {
    uint32_t i;
    if (out) *out = (masu_model){0};
    if (!m || !rows || !out) return missing(m, rows ? "out" : "rows");
    masu_result result = check_model(m, like, &i);
    if (result) return result;
    uint32_t spare = masu_models_spare(&m->models, &m->plan, i);
    if (spare == UINT32_MAX) {
        return masu_fail(&m->error, MASU_ERROR_LIMIT, "models", 1, 0,
                         "model %u: all of its kind are shown; \"spare\" in its description gives "
                         "the scene more",
                         like.id);
    }
    result = masu_models_move(&m->models, &m->instances, &m->bounds, &m->plan, spare, rows,
                              &m->error);
    if (result) return result;
    masu_models_show(&m->models, &m->instances, &m->plan, spare, 1);
    *out = masu_model_at(m, spare);
    return MASU_OK;
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

uint32_t masu_model_node_find(const masu_renderer *m, masu_model model, const char *name) {
    if (!m || !name || !*name || !model.id || model.id > m->plan.scene.models)
        return MASU_NODE_NONE;
    return masu_models_node(&m->models, model.id - 1, name);
}

masu_result masu_model_node_get(masu_renderer *m, masu_model model, uint32_t node,
                                masu_node_state *out) {
    uint32_t i;
    if (!m || !out) return missing(m, "out");
    masu_result result = check_model(m, model, &i);
    if (!result) result = masu_models_check_node(&m->models, i, node, &m->error);
    if (result) return result;
    uint32_t first = m->models.models[i].first_node;
    const masu_node *of = &m->models.nodes[first + node];
    *out = (masu_node_state){.parent = of->parent == MASU_BLOB_NONE ? MASU_NODE_NONE
                                                                    : of->parent - first};
    if (of->instance != MASU_BLOB_NONE) out->instance = masu_instance_at(m, of->instance);
    memcpy(out->rows, of->local, sizeof out->rows);
    memcpy(out->world, of->world, sizeof out->world);
    return MASU_OK;
}

masu_result masu_model_node_set(masu_renderer *m, masu_model model, uint32_t node,
                                const float rows[12]) {
    uint32_t i;
    if (!m || !rows) return missing(m, "rows");
    masu_result result = check_model(m, model, &i);
    if (!result) result = masu_models_check_node(&m->models, i, node, &m->error);
    if (result) return result;
    return masu_models_move_node(&m->models, &m->instances, &m->bounds, &m->plan, i, node, rows,
                                 &m->error);
}
