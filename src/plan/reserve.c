/* reserve.c: see reserve.h. */
#include "plan/reserve.h"

#include "base/error.h"
#include "scene/scene.h"

/* 0 or 1: whether an instance is in the sorted TRACE_INSTANCES. */
static uint32_t traced(const masu_scene_view *v, uint32_t count, uint32_t instance) {
    uint32_t first;
    return count ? masu_scene_range(v->trace_instances, sizeof(uint32_t), count, instance, &first)
                 : 0;
}

static uint32_t blended(const masu_scene_view *v, const masu_blob_mesh *mesh) {
    uint32_t count = 0;
    for (uint32_t p = 0; p < mesh->primitive_count; p++) {
        const masu_blob_primitive *one = &v->primitives[mesh->first_primitive + p];
        count += (v->materials[one->material].flags & MASU_MATERIAL_IS_BLEND) != 0;
    }
    return count;
}

int masu_reserve_copies(const masu_scene_view *v, const masu_blob_model *model) {
    for (uint32_t n = 0; n < model->node_count; n++) {
        if (v->model_nodes[model->first_node + n].skin) return 0;
    }
    return 1;
}

/* Sizes of a copy of a model. Adds the list entries of its instances to `lists`: of meshes, of
 * LODs. */
static void size_of(const masu_scene_data *scene, const masu_scene_view *v,
                    const masu_blob_model *model, masu_place_size *size, uint32_t *occluders,
                    uint64_t lists[2]) {
    uint32_t first;
    *size = (masu_place_size){.nodes = model->node_count};
    *occluders = 0;
    for (uint32_t n = 0; n < model->node_count; n++) {
        const masu_blob_model_node *node = &v->model_nodes[model->first_node + n];
        if (node->instance == MASU_BLOB_NONE) continue;
        uint32_t mesh = v->instances[node->instance].mesh;
        size->instances++;
        size->transparents += blended(v, &v->meshes[mesh]);
        size->traced += traced(v, scene->trace_instances, node->instance);
        if (scene->occluders) {
            *occluders += masu_scene_range(&v->occluders->mesh, sizeof *v->occluders,
                                           scene->occluders, mesh, &first);
        }
        lists[0]++;
        if (scene->lods) lists[1] += masu_scene_mesh_lods(v, scene->lods, mesh, &first);
    }
}

static void grow(uint32_t *most, uint32_t with) {
    if (*most < with) *most = with;
}

static masu_result too_many(const char *what, uint64_t needed, uint64_t most, masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.models", needed, most,
                     "reserve.models: the copies have %llu %s, the limit is %llu",
                     (unsigned long long)needed, what, (unsigned long long)most);
}

static masu_result add_models(uint32_t models, masu_scene_data *scene, masu_reserve_plan *out,
                              masu_detail *detail) {
    const masu_scene_view v = masu_scene_data_view(scene);
    masu_place_size *place = &out->place;
    uint32_t most_occluders = 0, any = 0;
    uint64_t lists[2] = {0, 0};
    for (uint32_t i = 0; i < scene->models; i++) {
        masu_place_size size;
        uint32_t occluders;
        if (v.models[i].like != i || !masu_reserve_copies(&v, &v.models[i])) continue;
        size_of(scene, &v, &v.models[i], &size, &occluders, lists);
        any = 1;
        grow(&place->instances, size.instances);
        grow(&place->nodes, size.nodes);
        grow(&place->transparents, size.transparents);
        grow(&place->traced, size.traced);
        grow(&most_occluders, occluders);
    }
    if (!any) return MASU_OK;
    const uint64_t sizes[] = {(uint64_t)models * place->instances,
                              (uint64_t)models * place->nodes,
                              models * lists[0],
                              models * lists[1],
                              (uint64_t)models * place->transparents,
                              (uint64_t)models * most_occluders};
    static const char *const whats[] = {"instances",          "nodes",
                                        "entries in lists",   "entries in lists of LODs",
                                        "blended primitives", "occluders"};
    for (uint32_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        if (sizes[i] > MASU_RESERVE_PARTS_MAX)
            return too_many(whats[i], sizes[i], MASU_RESERVE_PARTS_MAX, detail);
    }
    out->models = models;
    out->places = (masu_place_size){models * place->instances, models * place->nodes,
                                    models * place->transparents, models * place->traced};
    out->occluders = models * most_occluders;
    out->listed = (uint32_t)(models * lists[0]);
    out->lod_listed = (uint32_t)(models * lists[1]);
    return MASU_OK;
}

masu_result masu_reserve_add(const masu_reserve *reserve, masu_scene_data *scene,
                             masu_reserve_plan *out, masu_detail *detail) {
    *out = (masu_reserve_plan){.lights = reserve->lights};
    scene->lights += reserve->lights;
    scene->shadow_lights += reserve->lights;
    if (!reserve->models || !scene->models) return MASU_OK;
    masu_result result = add_models(reserve->models, scene, out, detail);
    if (result) return result;
    scene->models += out->models;
    scene->model_nodes += out->places.nodes;
    scene->instances += out->places.instances;
    scene->max_instances += out->places.instances;
    scene->transparents += out->places.transparents;
    scene->trace_instances += out->places.traced;
    scene->placed_occluders += out->occluders;
    return MASU_OK;
}
