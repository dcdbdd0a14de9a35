/* api_add.c: the public functions that add objects to a scene between frames and remove them:
 * copies of models and local lights, in the slots of desc.reserve (src/plan/reserve.h).
 *
 * A copy needs a slot in each module with per-instance data (instances, nodes, transparents, traced
 * instances), and one in the reserve of lights for each of its lights. All slots are checked before
 * any is used. */
#include "base/error.h"
#include "renderer.h"

#include <string.h>

static uint32_t place_of(const masu_renderer *m, uint32_t model) {
    return model - masu_own_models(&m->plan);
}

/* A free slot for a copy; UINT32_MAX: none. */
static uint32_t free_model(const masu_renderer *m) {
    return masu_handle_free(&m->models.handles, masu_own_models(&m->plan), m->plan.reserve.models);
}

/* The instance of a node of a model; UINT32_MAX: none. */
static uint32_t instance_of(const masu_renderer *m, uint32_t model, uint32_t node) {
    return m->models.nodes[m->models.models[model].first_node + node].instance;
}

/* Whether a light exists and is attached to an instance of the model. */
static int carries(const masu_renderer *m, uint32_t model, uint32_t light) {
    uint64_t carrier = m->lights.states[light].instance.id; /* index + 1 */
    return masu_handle_lives(&m->lights.handles, light) && carrier &&
           m->models.of_instance[carrier - 1] == model;
}

/* ---- Models ---------------------------------------------------------------------------------- */

/* Whether the reserve has room for a copy of a model. */
static masu_result check_room(masu_renderer *m, uint32_t like) {
    uint32_t models = m->plan.reserve.models, lights = 0, free = 0;
    if (like >= masu_mesh_models(&m->plan)) {
        return masu_fail(&m->error, MASU_ERROR_LIMIT, "like", 1, 0,
                         "model %u is a mesh of the host, which has no copies: create it again",
                         like);
    }
    if (!models || masu_models_bends(&m->models, &m->plan, like)) {
        return masu_fail(&m->error, MASU_ERROR_LIMIT, "models", 1, 0,
                         "model %u: all of its kind are shown; \"spare\" in its description gives "
                         "the scene more%s",
                         like,
                         models ? ", desc.reserve holds none that bend" : ", desc.reserve too");
    }
    if (free_model(m) == UINT32_MAX) {
        return masu_fail(&m->error, MASU_ERROR_LIMIT, "reserve.models", models + 1, models,
                         "reserve.models: %u are needed, %u are given", models + 1, models);
    }
    for (uint32_t i = 0; i < m->plan.scene.lights; i++) {
        lights += carries(m, like, i) != 0;
        free += !masu_handle_lives(&m->lights.handles, i);
    }
    if (lights <= free) return MASU_OK;
    uint32_t given = m->plan.reserve.lights, needed = given - free + lights;
    return masu_fail(&m->error, MASU_ERROR_LIMIT, "reserve.lights", needed, given,
                     "reserve.lights: with those that model %u carries %u are needed, %u are given",
                     like, needed, given);
}

/* Copies the meshes, shadow and reflection state and lights of instance `from` to `to`. */
static void copy_instance(masu_renderer *m, uint32_t place, uint32_t from, uint32_t to) {
    masu_instances_add(&m->instances, to, m->instances.meshes[from]);
    masu_transparents_copy(&m->transparents, &m->plan, place, from, to);
    masu_reflections_copy(&m->reflections, &m->plan, place, from, to);
    for (uint32_t i = 0, light; i < m->plan.scene.lights; i++) {
        masu_punctual_light_state state = m->lights.states[i];
        if (!masu_handle_lives(&m->lights.handles, i) || state.instance.id != (uint64_t)from + 1)
            continue;
        state.instance.id = masu_handle_at(&m->instances.handles, to);
        /* cannot fail: there is room */
        (void)masu_lights_add(&m->lights, &m->instances, &state, &light, NULL);
    }
}

static masu_result copy_model(masu_renderer *m, uint32_t like, const float rows[12],
                              uint32_t *added) {
    masu_result result = check_room(m, like);
    if (result) return result;
    uint32_t model = free_model(m), place = place_of(m, model);
    uint32_t instance = masu_own_instances(&m->plan) + place * m->plan.reserve.place.instances;
    masu_models_copy(&m->models, &m->plan, place, like);
    result =
        masu_models_move(&m->models, &m->instances, &m->bounds, &m->plan, model, rows, &m->error);
    if (result) return result; /* nothing is visible yet, and the slot remains free */
    masu_placed_model *to = &m->models.models[model];
    for (uint32_t n = 0; n < to->node_count; n++) {
        uint32_t from = instance_of(m, like, n);
        if (from == MASU_BLOB_NONE) continue;
        copy_instance(m, place, from, instance);
        m->models.nodes[to->first_node + n].instance = instance;
        m->models.of_instance[instance++] = model;
    }
    masu_handle_turn(&m->models.handles, model);
    if (m->plan.needs.picking) m->picking.added[place] = m->timeline.frame;
    *added = model;
    return MASU_OK;
}

masu_result masu_model_add(masu_renderer *m, masu_model like, const float rows[12], masu_model *out,
                           masu_detail *detail) {
    uint32_t i;
    if (out) *out = (masu_model){0};
    if (!m || !rows || !out) return masu_finish_null(m, rows ? "out" : "rows", detail);
    masu_result result = masu_handle_check(&m->models.handles, "model", like.id, &i, &m->error);
    if (result) return masu_finish(m, result, detail);
    uint32_t added = masu_models_spare(&m->models, &m->plan, i);
    if (added == UINT32_MAX) result = copy_model(m, i, rows, &added);
    if (!result) { /* a second time for a copy, which has instances now */
        result = masu_models_move(&m->models, &m->instances, &m->bounds, &m->plan, added, rows,
                                  &m->error);
    }
    if (result) return masu_finish(m, result, detail);
    const masu_look plain = {.flags = 0};
    if (m->plan.needs.looks)
        masu_models_set_look(&m->models, &m->instances, &m->plan, added, &plain);
    masu_models_show(&m->models, &m->instances, &m->plan, added, 1);
    *out = masu_model_at(m, added);
    return MASU_OK;
}

/* Removes the lights of a removed instance: reserve lights are freed, lights of the scene are
 * switched off. */
static void drop_lights(masu_renderer *m, uint32_t model) {
    for (uint32_t i = 0; i < m->plan.scene.lights; i++) {
        if (!carries(m, model, i)) continue;
        masu_punctual_light_state *state = &m->lights.states[i];
        memset(state->color, 0, sizeof state->color);
        state->instance.id = 0;
        if (i >= masu_own_lights(&m->plan)) masu_lights_remove(&m->lights, i);
    }
}

masu_result masu_model_remove(masu_renderer *m, masu_model model, masu_detail *detail) {
    uint32_t i;
    if (!m) return masu_fail_null(detail, "renderer");
    masu_result result = masu_handle_check(&m->models.handles, "model", model.id, &i, &m->error);
    if (result) return masu_finish(m, result, detail);
    if (i < masu_own_models(&m->plan)) { /* slots of the scene's own models are never freed */
        masu_models_show(&m->models, &m->instances, &m->plan, i, 0);
        return MASU_OK;
    }
    drop_lights(m, i);
    if (i >= masu_mesh_models(&m->plan)) {
        masu_meshes_remove(&m->meshes, &m->models, &m->instances, &m->reflections, &m->plan, i);
        return MASU_OK;
    }
    masu_placed_model *gone = &m->models.models[i];
    for (uint32_t n = 0; n < gone->node_count; n++) {
        uint32_t instance = instance_of(m, i, n);
        if (instance == MASU_BLOB_NONE) continue;
        masu_instances_remove(&m->instances, &m->plan, instance);
        m->models.of_instance[instance] = MASU_BLOB_NONE;
    }
    masu_transparents_clear(&m->transparents, &m->plan, place_of(m, i));
    masu_reflections_clear(&m->reflections, &m->plan, place_of(m, i));
    *gone = (masu_placed_model){.like = MASU_BLOB_NONE};
    masu_handle_turn(&m->models.handles, i);
    return MASU_OK;
}

/* ---- Lights ---------------------------------------------------------------------------------- */

masu_result masu_punctual_light_add(masu_renderer *m, const masu_punctual_light_state *state,
                                    masu_punctual_light *out, masu_detail *detail) {
    uint32_t light;
    if (out) *out = (masu_punctual_light){0};
    if (!m || !state || !out) return masu_finish_null(m, state ? "out" : "state", detail);
    masu_result result = masu_lights_add(&m->lights, &m->instances, state, &light, &m->error);
    if (!result) *out = masu_punctual_light_at(m, light);
    return masu_finish(m, result, detail);
}

masu_result masu_punctual_light_remove(masu_renderer *m, masu_punctual_light light,
                                       masu_detail *detail) {
    uint32_t i;
    if (!m) return masu_fail_null(detail, "renderer");
    masu_result result = masu_handle_check(&m->lights.handles, "light", light.id, &i, &m->error);
    if (!result && i < masu_own_lights(&m->plan)) {
        result =
            masu_fail(&m->error, MASU_ERROR_ARGUMENT, "light", 0, i,
                      "light %u is part of the scene and cannot be removed: set its color to 0", i);
    }
    if (result) return masu_finish(m, result, detail);
    masu_lights_remove(&m->lights, i);
    return MASU_OK;
}
