/* models.c: see models.h. */
#include "frame/models.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

void masu_models_alloc(masu_models *s, masu_arena *arena, const masu_frame_plan *plan) {
    const masu_scene_data *scene = &plan->scene;
    s->models = masu_arena_alloc(arena, "models", scene->models, sizeof *s->models, 8);
    s->nodes = masu_arena_alloc(arena, "model nodes", scene->model_nodes, sizeof *s->nodes, 8);
    s->of_instance =
        masu_arena_alloc(arena, "models of instances", scene->models ? scene->instances : 0,
                         sizeof *s->of_instance, 4);
    s->lives = masu_arena_alloc(arena, "reserve models",
                                plan->reserve.models + plan->reserve.meshes, sizeof *s->lives, 4);
    s->offsets = NULL;
    if (plan->desc.double_positions)
        s->offsets =
            masu_arena_alloc(arena, "model positions", scene->models, sizeof *s->offsets, 8);
    masu_animation_alloc(&s->animation, arena, plan);
    masu_skins_alloc(&s->skins, arena, plan);
}

static void multiply(const float a[12], const float b[12], float out[12]) {
    for (uint32_t i = 0; i < 12; i += 4) {
        for (uint32_t j = 0; j < 4; j++) {
            double sum = j == 3 ? (double)a[i + 3] : 0.0;
            for (uint32_t k = 0; k < 3; k++) sum += (double)a[i + k] * (double)b[4 * k + j];
            out[i + j] = (float)sum;
        }
    }
}

/* Computes the transforms of nodes from the model's transform, then the joints. 0: one is not
 * finite. */
static int place(masu_models *s, const masu_frame_plan *plan, uint32_t model) {
    const masu_placed_model *m = &s->models[model];
    int finite = 1;
    for (uint32_t n = m->first_node; n < m->first_node + m->node_count; n++) {
        masu_node *node = &s->nodes[n];
        const float *above =
            node->parent == MASU_BLOB_NONE ? m->rows : s->nodes[node->parent].world;
        multiply(above, node->local, node->world);
        for (uint32_t k = 0; k < 12; k++) finite &= isfinite(node->world[k]) != 0;
    }
    return finite & masu_skins_pose(&s->skins, plan, model, s->nodes, m->first_node, m->node_count);
}

void masu_models_copy_scene(masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                            const masu_scene_view *v) {
    const masu_scene_data *scene = &plan->scene;
    s->handles = masu_handles_of(v->hash, MASU_HANDLE_MODEL, masu_own_models(plan),
                                 plan->reserve.models + plan->reserve.meshes, s->lives);
    for (uint32_t i = 0; scene->models && i < scene->instances; i++)
        s->of_instance[i] = MASU_BLOB_NONE;
    for (uint32_t n = 0; n < masu_own_nodes(plan); n++) {
        const masu_blob_model_node *from = &v->model_nodes[n];
        masu_node *to = &s->nodes[n];
        *to = (masu_node){.name = masu_scene_name_hash(v, from->name),
                          .parent = from->parent,
                          .instance = from->instance};
        memcpy(to->local, from->local, sizeof to->local);
    }
    if (s->offsets) memset(s->offsets, 0, scene->models * sizeof *s->offsets);
    masu_animation_copy_scene(&s->animation, plan, v);
    masu_skins_copy_scene(&s->skins, plan, v);
    for (uint32_t i = 0; i < masu_own_models(plan); i++) {
        const masu_blob_model *from = &v->models[i];
        masu_placed_model *to = &s->models[i];
        *to = (masu_placed_model){.name = masu_scene_name_hash(v, from->name),
                                  .first_node = from->first_node,
                                  .node_count = from->node_count,
                                  .like = from->like,
                                  .shown = 1};
        memcpy(to->rows, from->transform, sizeof to->rows);
        for (uint32_t n = to->first_node; n < to->first_node + to->node_count; n++) {
            if (s->nodes[n].instance != MASU_BLOB_NONE) s->of_instance[s->nodes[n].instance] = i;
        }
        /* equals the instances' initial transforms; checked when the scene was bound */
        (void)place(s, plan, i);
        if (from->flags & MASU_MODEL_HIDDEN) masu_models_show(s, in, plan, i, 0);
    }
    for (uint32_t i = masu_own_models(plan); i < scene->models; i++)
        s->models[i] = (masu_placed_model){.like = MASU_BLOB_NONE};
    uint32_t first_node = scene->model_nodes - plan->reserve.meshes;
    for (uint32_t k = 0; k < plan->reserve.meshes; k++) { /* a node without a transform each */
        masu_node *node = &s->nodes[first_node + k];
        uint32_t instance = masu_mesh_instances(plan) + k;
        s->models[masu_mesh_models(plan) + k] = (masu_placed_model){
            .first_node = first_node + k, .node_count = 1, .like = MASU_BLOB_NONE};
        *node = (masu_node){.local = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                            .parent = MASU_BLOB_NONE,
                            .instance = instance};
        s->of_instance[instance] = masu_mesh_models(plan) + k;
    }
}

void masu_models_copy(masu_models *s, const masu_frame_plan *plan, uint32_t place, uint32_t like) {
    const masu_placed_model *from = &s->models[like];
    masu_placed_model *to = &s->models[masu_own_models(plan) + place];
    uint32_t first = masu_own_nodes(plan) + place * plan->reserve.place.nodes;
    *to = (masu_placed_model){
        .first_node = first, .node_count = from->node_count, .like = from->like};
    memcpy(to->rows, from->rows, sizeof to->rows);
    for (uint32_t n = 0; n < from->node_count; n++) {
        masu_node *node = &s->nodes[first + n];
        *node = s->nodes[from->first_node + n];
        if (node->parent != MASU_BLOB_NONE) node->parent += first - from->first_node;
        node->instance = MASU_BLOB_NONE;
    }
    masu_animation_copy(&s->animation, plan, from->first_node, first, from->node_count);
}

int masu_models_bends(const masu_models *s, const masu_frame_plan *plan, uint32_t model) {
    uint32_t first;
    return masu_skins_of(&s->skins, plan, model, &first) != 0;
}

uint32_t masu_models_find(const masu_models *s, const masu_frame_plan *plan, const char *name) {
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < masu_own_models(plan); i++) {
        if (s->models[i].name == hash) return i;
    }
    return UINT32_MAX;
}

uint32_t masu_models_node(const masu_models *s, uint32_t model, const char *name) {
    const masu_placed_model *m = &s->models[model];
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < m->node_count; i++) {
        if (s->nodes[m->first_node + i].name == hash) return i;
    }
    return UINT32_MAX;
}

/* The instances of a model go where its nodes are. */
static void settle(masu_models *s, masu_instances *in, masu_bounds *b, const masu_frame_plan *plan,
                   uint32_t model) {
    const masu_placed_model *m = &s->models[model];
    for (uint32_t n = m->first_node; n < m->first_node + m->node_count; n++) {
        const masu_node *node = &s->nodes[n];
        if (node->instance == MASU_BLOB_NONE) continue;
        if (s->offsets)
            masu_instances_place_at(in, plan, node->instance, node->world, s->offsets[model]);
        else
            masu_instances_place(in, plan, node->instance, node->world);
        masu_bounds_move(b, plan, in, node->instance);
    }
    masu_skins_settle(&s->skins, in, b, plan, model);
}

/* Replaces 12 floats of a model by `rows` and moves its instances; puts them back where that
 * fails. */
static masu_result replace(masu_models *s, masu_instances *in, masu_bounds *b,
                           const masu_frame_plan *plan, uint32_t model, float *where,
                           const float rows[12], masu_detail *detail) {
    float before[12];
    for (uint32_t k = 0; k < 12; k++) {
        if (isfinite(rows[k])) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rows", 12, k,
                         "model %u: rows[%u] is %g, not finite", model, k, (double)rows[k]);
    }
    memcpy(before, where, sizeof before);
    memcpy(where, rows, sizeof before);
    if (!place(s, plan, model)) {
        memcpy(where, before, sizeof before);
        (void)place(s, plan, model);
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rows", 0, 0,
                         "model %u: with these rows a node of it is beyond what a float holds",
                         model);
    }
    settle(s, in, b, plan, model);
    return MASU_OK;
}

masu_result masu_models_move(masu_models *s, masu_instances *in, masu_bounds *b,
                             const masu_frame_plan *plan, uint32_t model, const float rows[12],
                             masu_detail *detail) {
    double before[3];
    if (!s->offsets) return replace(s, in, b, plan, model, s->models[model].rows, rows, detail);
    memcpy(before, s->offsets[model], sizeof before);
    memset(s->offsets[model], 0, sizeof before);
    masu_result result = replace(s, in, b, plan, model, s->models[model].rows, rows, detail);
    if (result) memcpy(s->offsets[model], before, sizeof before);
    return result;
}

/* Nodes are placed relative to the position, so that their translations are exact in float. */
masu_result masu_models_set_position(masu_models *s, masu_instances *in, masu_bounds *b,
                                     const masu_frame_plan *plan, uint32_t model,
                                     const double position[3], masu_detail *detail) {
    float rows[12];
    double before[3];
    masu_result result = masu_position_check(plan, position, detail);
    if (result) return result;
    memcpy(rows, s->models[model].rows, sizeof rows);
    rows[3] = rows[7] = rows[11] = 0.0f;
    memcpy(before, s->offsets[model], sizeof before);
    memcpy(s->offsets[model], position, sizeof before);
    result = replace(s, in, b, plan, model, s->models[model].rows, rows, detail);
    if (result) memcpy(s->offsets[model], before, sizeof before);
    return result;
}

double masu_models_offset(const masu_models *s, uint32_t model, uint32_t axis) {
    return s->offsets ? s->offsets[model][axis] : 0.0;
}

masu_result masu_models_check_node(const masu_models *s, uint32_t model, uint32_t node,
                                   masu_detail *detail) {
    uint32_t count = s->models[model].node_count;
    if (node < count) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_ARGUMENT, "node", count - 1, node,
                     "model %u: node %u does not exist, the last one is %u", model, node,
                     count - 1);
}

masu_result masu_models_move_node(masu_models *s, masu_instances *in, masu_bounds *b,
                                  const masu_frame_plan *plan, uint32_t model, uint32_t node,
                                  const float rows[12], masu_detail *detail) {
    float *local = s->nodes[s->models[model].first_node + node].local;
    return replace(s, in, b, plan, model, local, rows, detail);
}

/* ---- Clips ----------------------------------------------------------------------------------- */

static masu_result check_uses(uint32_t model, uint32_t clips, const masu_clip_use *uses,
                              uint32_t count, masu_detail *detail) {
    if (count > MASU_MAX_CLIP_USES) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "count", MASU_MAX_CLIP_USES, count,
                         "model %u: %u clips at once, at most %u", model + 1, count,
                         MASU_MAX_CLIP_USES);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (uses[i].clip >= clips) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "clip", clips, uses[i].clip,
                             "model %u: uses[%u].clip is %u, it has %u clips", model + 1, i,
                             uses[i].clip, clips);
        }
        if (!isfinite(uses[i].time)) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "time", 0, i,
                             "model %u: uses[%u].time is not finite", model + 1, i);
        }
        if (!(uses[i].weight >= 0.0f && isfinite(uses[i].weight))) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "weight", 0, i,
                             "model %u: uses[%u].weight is %g, not 0 or more", model + 1, i,
                             (double)uses[i].weight);
        }
    }
    return MASU_OK;
}

/* Saves the transforms of animated nodes, or restores them if `back`. */
static void swap(masu_models *s, uint32_t model, int back) {
    const masu_placed_model *m = &s->models[model];
    for (uint32_t n = 0; n < m->node_count; n++) {
        float *local = s->nodes[m->first_node + n].local, *kept = s->animation.locals[n];
        memcpy(back ? local : kept, back ? kept : local, sizeof s->nodes[0].local);
    }
}

masu_result masu_models_animate(masu_models *s, masu_instances *in, masu_bounds *b,
                                const masu_frame_plan *plan, uint32_t model,
                                const masu_clip_use *uses, uint32_t count, masu_detail *detail) {
    const masu_placed_model *m = &s->models[model];
    uint32_t first, clips = masu_animation_clips(&s->animation, plan, m->like, &first);
    masu_result result = check_uses(model, clips, uses, count, detail);
    if (result || !clips) return result;
    masu_animation_pose(&s->animation, first, uses, count, m->first_node, m->node_count);
    swap(s, model, 0);
    for (uint32_t n = 0; n < m->node_count; n++) {
        if (s->animation.moved[m->first_node + n])
            masu_pose_rows(&s->animation.poses[n], s->nodes[m->first_node + n].local);
    }
    if (!place(s, plan, model)) {
        swap(s, model, 1);
        (void)place(s, plan, model);
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "uses", 0, 0,
                         "model %u: in this pose a node of it is beyond what a float holds",
                         model + 1);
    }
    masu_skins_play(&s->skins, &s->animation, plan, model, m->first_node, first, uses, count);
    settle(s, in, b, plan, model);
    return MASU_OK;
}

masu_result masu_models_morph(masu_models *s, masu_instances *in, masu_bounds *b,
                              const masu_frame_plan *plan, uint32_t model, const char *name,
                              float weight, masu_detail *detail) {
    if (!(fabsf(weight) <= MASU_MORPH_WEIGHT_MAX))
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "weight", 1000000, 0,
                         "model %u: the weight of \"%s\" is %g, not within 1e6 of 0", model + 1,
                         name, (double)weight);
    if (!masu_skins_set(&s->skins, plan, model, name, weight))
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "name", 1, 0,
                         "model %u: it has no morph target \"%s\"", model + 1, name);
    masu_skins_settle(&s->skins, in, b, plan, model);
    return MASU_OK;
}

void masu_models_set_look(const masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                          uint32_t model, const masu_look *look) {
    const masu_placed_model *m = &s->models[model];
    for (uint32_t n = m->first_node; n < m->first_node + m->node_count; n++) {
        if (s->nodes[n].instance != MASU_BLOB_NONE)
            masu_instances_set_look(in, plan, s->nodes[n].instance, look);
    }
}

void masu_models_show(masu_models *s, masu_instances *in, const masu_frame_plan *plan,
                      uint32_t model, int shown) {
    masu_placed_model *m = &s->models[model];
    m->shown = shown != 0;
    for (uint32_t n = m->first_node; n < m->first_node + m->node_count; n++) {
        if (s->nodes[n].instance != MASU_BLOB_NONE)
            masu_instances_show(in, plan, s->nodes[n].instance, shown);
    }
}

uint32_t masu_models_spare(const masu_models *s, const masu_frame_plan *plan, uint32_t like) {
    for (uint32_t i = 0; i < masu_own_models(plan); i++) {
        if (s->models[i].like == s->models[like].like && !s->models[i].shown) return i;
    }
    return UINT32_MAX;
}

void masu_models_box(const masu_models *s, const masu_bounds *b, uint32_t model, float low[3],
                     float high[3]) {
    const masu_placed_model *m = &s->models[model];
    int any = 0;
    for (uint32_t k = 0; k < 3; k++)
        low[k] = high[k] =
            (float)((double)m->rows[4 * k + 3] + masu_models_offset(s, model, k));
    for (uint32_t n = m->first_node; n < m->first_node + m->node_count; n++) {
        float box[6];
        if (s->nodes[n].instance == MASU_BLOB_NONE) continue;
        masu_bounds_of(b, s->nodes[n].instance, box);
        for (uint32_t k = 0; k < 3; k++) {
            low[k] = any ? fminf(low[k], box[k] - box[3 + k]) : box[k] - box[3 + k];
            high[k] = any ? fmaxf(high[k], box[k] + box[3 + k]) : box[k] + box[3 + k];
        }
        any = 1;
    }
}
