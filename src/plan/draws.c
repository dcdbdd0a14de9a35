/* draws.c: see draws.h. */
#include "plan/draws.h"

#include "scene/material.h"

void masu_draws_alloc(masu_draws *draws, masu_arena *arena, const masu_frame_plan *plan) {
    uint64_t lods = plan->lods ? plan->scene.lods : 0;
    draws->batches =
        masu_arena_alloc(arena, "batches", plan->scene.meshes + lods, sizeof *draws->batches, 8);
    draws->added = NULL;
    if (plan->reserve.models) {
        draws->added =
            masu_arena_alloc(arena, "reserve draws", plan->scene.meshes, sizeof *draws->added, 4);
    }
    draws->materials = masu_arena_alloc(arena, "draw looks", plan->desc.resizable ? plan->draws : 0,
                                        sizeof *draws->materials, 4);
}

/* Adds the batch of one level of detail of a mesh with instances. */
static masu_batch *add_batch(masu_draws *draws, const masu_frame_plan *plan,
                             const masu_scene_view *v, uint32_t mesh, uint32_t first_primitive,
                             uint32_t first, uint32_t instances) {
    masu_batch *b = &draws->batches[draws->batch_count];
    uint32_t primitives = v->meshes[mesh].primitive_count;
    *b = (masu_batch){.first_primitive = first_primitive,
                      .draw_count = primitives,
                      .mesh = mesh,
                      .material = MASU_BLOB_NONE,
                      .first_instance = first,
                      .instance_count = instances,
                      .room = instances + (draws->added ? draws->added[mesh] : 0)};
    if (draws->batch_count) {
        b->first_draw = b[-1].first_draw + b[-1].draw_count;
        b->first_listed = b[-1].first_listed + b[-1].room;
    }
    for (uint32_t p = 0; p < primitives; p++) {
        const masu_blob_primitive *one = &v->primitives[first_primitive + p];
        if (v->materials[one->material].flags & MASU_MATERIAL_IS_BLEND) {
            b->blended++; /* drawn as transparents */
        } else {
            b->triangles += one->index_count / 3;
        }
    }
    for (uint32_t i = 0; plan->scene.singles && i < instances && !b->mirrored; i++)
        b->mirrored = (uint32_t)masu_is_mirrored(v->instances[first + i].transform);
    draws->batch_count++;
    draws->large_count += b->room > 64;
    return b;
}

int masu_is_mirrored(const float rows[12]) {
    double m[12];
    for (uint32_t k = 0; k < 12; k++) m[k] = (double)rows[k];
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
               m[2] * (m[4] * m[9] - m[5] * m[8]) <
           0.0;
}

/* Per mesh: the maximum number of instances that copies of models can add, of any model. */
static void count_added(masu_draws *draws, const masu_frame_plan *plan, const masu_scene_view *v) {
    for (uint32_t mesh = 0; mesh < plan->scene.meshes; mesh++) draws->added[mesh] = 0;
    for (uint32_t i = 0; i < masu_own_models(plan); i++) {
        const masu_blob_model *model = &v->models[i];
        if (model->like != i || !masu_reserve_copies(v, model)) continue;
        for (uint32_t n = 0; n < model->node_count; n++) {
            uint32_t instance = v->model_nodes[model->first_node + n].instance;
            if (instance != MASU_BLOB_NONE)
                draws->added[v->instances[instance].mesh] += plan->reserve.models;
        }
    }
}

/* A batch for each slot of desc.reserve.meshes, at the end. */
static void add_mesh_slots(masu_draws *draws, const masu_frame_plan *plan) {
    for (uint32_t slot = 0; slot < plan->reserve.meshes; slot++) {
        const masu_mesh_slot s = masu_mesh_slot_of(&plan->desc.reserve, 0, slot);
        masu_batch *b = &draws->batches[draws->batch_count++];
        *b = (masu_batch){.draw_count = 1,
                          .mesh = masu_own_meshes(plan) + slot,
                          .material = plan->desc.reserve.meshes[s.kind].material,
                          .first_instance = masu_mesh_instances(plan) + slot,
                          .instance_count = 1,
                          .room = 1};
        if (draws->batch_count == 1) continue;
        b->first_draw = b[-1].first_draw + b[-1].draw_count;
        b->first_listed = b[-1].first_listed + b[-1].room;
    }
}

static void add_batches(masu_draws *draws, const masu_frame_plan *plan, const masu_scene_view *v) {
    const masu_scene_data *scene = &plan->scene;
    uint32_t from = 0;
    for (uint32_t mesh = 0; mesh < masu_own_meshes(plan); mesh++) {
        uint32_t first, first_lod,
            end = masu_scene_mesh_instances(v, masu_own_instances(plan), mesh, from, &first);
        from = end;
        const masu_blob_mesh *what = &v->meshes[mesh];
        if (end == first || !what->primitive_count) continue;
        masu_batch *b = add_batch(draws, plan, v, mesh, what->first_primitive, first, end - first);
        if (!plan->lods) continue;
        b->lod_count = masu_scene_mesh_lods(v, scene->lods, mesh, &first_lod);
        b->first_lod = first_lod;
        for (uint32_t l = 0; l < b->lod_count; l++) {
            (void)add_batch(draws, plan, v, mesh, v->lods[first_lod + l].first_primitive, first,
                            end - first);
        }
    }
    add_mesh_slots(draws, plan);
}

/* Adds a transparent item, and its texture set to the list of sets. */
static void add_transparent(masu_draws *draws, const masu_blob_material *material) {
    uint32_t i = 0;
    draws->transparent_count++;
    if (!(material->flags & MASU_MATERIAL_HAS_MAPS)) return;
    while (i < draws->transparent_set_count && draws->transparent_sets[i] != material->texture_set)
        i++;
    if (i == draws->transparent_set_count && i < MASU_TRANSPARENT_SETS_MAX)
        draws->transparent_sets[draws->transparent_set_count++] = material->texture_set;
}

static void add_transparents(masu_draws *draws, const masu_frame_plan *plan,
                             const masu_scene_view *v) {
    for (uint32_t i = 0; i < masu_own_instances(plan); i++) {
        const masu_blob_mesh *mesh = &v->meshes[v->instances[i].mesh];
        for (uint32_t p = 0; p < mesh->primitive_count; p++) {
            const masu_blob_material *material =
                &v->materials[v->primitives[mesh->first_primitive + p].material];
            if (material->flags & MASU_MATERIAL_IS_BLEND) add_transparent(draws, material);
        }
    }
    draws->transparent_count += plan->reserve.places.transparents;
}

masu_draw_material masu_draw_material_of(const masu_scene_view *v, const masu_batch *batch,
                                         uint32_t draw) {
    int own = batch->material == MASU_BLOB_NONE;
    const masu_blob_primitive *primitive =
        own ? &v->primitives[batch->first_primitive + draw] : NULL;
    uint32_t number = own ? primitive->material : batch->material;
    const masu_blob_material *of = &v->materials[number];
    int meso = of->meso != MASU_BLOB_NONE;
    return (masu_draw_material){
        .material = number,
        .flags = of->flags,
        .emits = (uint32_t)masu_material_emits(of),
        .texture_set = of->texture_set,
        .layers = of->layers,
        .more_layers = of->more_layers,
        .detail = {of->detail[0], of->detail[1]},
        .rise = own ? primitive->rise : 0.0f,
        .meso = meso ? (uint32_t)(v->material_count + 2 * (uint64_t)of->meso) : 0,
        .depth_bias = of->depth_bias};
}

void masu_draws_build(masu_draws *draws, const masu_frame_plan *plan, const masu_scene_view *v) {
    if (draws->added) count_added(draws, plan, v);
    add_batches(draws, plan, v);
    for (uint32_t b = 0; plan->desc.resizable && b < draws->batch_count; b++) {
        const masu_batch *batch = &draws->batches[b];
        for (uint32_t d = 0; d < batch->draw_count; d++)
            draws->materials[batch->first_draw + d] =
                masu_draw_material_of(v, batch, d);
    }
    if (plan->needs.transparents) add_transparents(draws, plan, v);
}

VkRect2D masu_atlas_part(uint32_t part) {
    if (part) return (VkRect2D){{0, MASU_ATLAS_CAMERA_HEIGHT}, {MASU_ATLAS_SUN, MASU_ATLAS_SUN}};
    return (VkRect2D){{0, 0}, {MASU_ATLAS_CAMERA_WIDTH, MASU_ATLAS_CAMERA_HEIGHT}};
}
