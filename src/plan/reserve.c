/* reserve.c: see reserve.h. */
#include "plan/reserve.h"

#include "base/error.h"
#include "scene/scene.h"
#include "scene/trace.h"

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

/* ---- Meshes of the host ---------------------------------------------------------------------- */

masu_mesh_slot masu_mesh_slot_of(const masu_reserve *reserve, int traced, uint32_t slot) {
    masu_mesh_slot out = {0};
    for (uint32_t k = 0; k < MASU_MAX_MESH_KINDS; k++) {
        const masu_mesh_kind *kind = &reserve->meshes[k];
        uint32_t nodes = traced ? masu_trace_tree_nodes(kind->triangles) : 0;
        uint32_t before = slot < kind->meshes ? slot : kind->meshes;
        out.first_vertex += before * kind->vertices;
        out.first_triangle += before * kind->triangles;
        out.first_node += before * nodes;
        if (slot >= kind->meshes) {
            slot -= kind->meshes;
            continue;
        }
        out.kind = k;
        out.vertices = kind->vertices;
        out.triangles = kind->triangles;
        out.nodes = nodes;
        break;
    }
    return out;
}

static uint64_t aligned(uint64_t bytes) { return (bytes + 15) / 16 * 16; }

masu_mesh_upload masu_mesh_upload_of(const masu_scene_data *scene, uint32_t vertices,
                                     uint32_t triangles) {
    masu_mesh_upload out = {.texcoords = vertices * (uint64_t)sizeof(masu_blob_vertex)};
    out.colors = out.texcoords + aligned(scene->texture_arrays ? 8 * (uint64_t)vertices : 0);
    out.triangles = out.colors + aligned(scene->vertex_colors && scene->texture_arrays
                                             ? 4 * (uint64_t)vertices : 0);
    out.nodes = out.triangles + aligned(12 * (uint64_t)triangles);
    out.bytes = out.nodes;
    if (scene->host_nodes)
        out.bytes += masu_trace_tree_nodes(triangles) * (uint64_t)sizeof(masu_blob_trace_node);
    return out;
}

static masu_result check_material(const masu_scene_data *scene, uint32_t kind, uint32_t material,
                                  masu_detail *detail) {
    if (material >= scene->materials) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "reserve.meshes", scene->materials, material,
                         "reserve.meshes[%u].material is %u, the scene has %u", kind, material,
                         scene->materials);
    }
    const masu_blob_material *m = &masu_scene_data_view(scene).materials[material];
    int blended = (m->flags & MASU_MATERIAL_IS_BLEND) != 0;
    if (!blended && m->meso == MASU_BLOB_NONE) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_ARGUMENT, "reserve.meshes", 0, material,
                     "reserve.meshes[%u].material is %u, which %s", kind, material,
                     blended ? "is transparent" : "has mesoscale detail");
}

/* Sums of all kinds. The vertices, and with ray tracing the nodes, have the limits of a blob. */
static masu_result add_meshes(const masu_reserve *reserve, masu_scene_data *scene,
                              masu_reserve_plan *out, masu_detail *detail) {
    uint64_t meshes = 0, vertices = 0, triangles = 0, nodes = 0, most = 0;
    int traced = scene->trace_nodes != 0;
    for (uint32_t k = 0; k < MASU_MAX_MESH_KINDS; k++) {
        const masu_mesh_kind *kind = &reserve->meshes[k];
        if (!kind->meshes) continue;
        masu_result result = check_material(scene, k, kind->material, detail);
        if (result) return result;
        meshes += kind->meshes;
        vertices += kind->meshes * (uint64_t)kind->vertices;
        triangles += kind->meshes * (uint64_t)kind->triangles;
        nodes += kind->meshes * (uint64_t)masu_trace_tree_nodes(kind->triangles);
    }
    if (!meshes) return MASU_OK;
    if (!scene->instances) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "reserve.meshes", 1, 0,
                         "reserve.meshes: the scene has no polygons");
    }
    if (vertices > MASU_MESH_ALL_MAX || triangles > MASU_MESH_ALL_MAX) {
        uint64_t more = vertices > triangles ? vertices : triangles;
        return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.meshes", more, MASU_MESH_ALL_MAX,
                         "reserve.meshes: all slots have %llu %s, the limit is %u",
                         (unsigned long long)more,
                         vertices > triangles ? "vertices" : "triangles", MASU_MESH_ALL_MAX);
    }
    if (traced && scene->trace_nodes + nodes > MASU_TRACE_NODES_MAX) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.meshes", scene->trace_nodes + nodes,
                         MASU_TRACE_NODES_MAX,
                         "reserve.meshes: with them the BVHs have %llu nodes, the limit is %u",
                         (unsigned long long)(scene->trace_nodes + nodes), MASU_TRACE_NODES_MAX);
    }
    out->meshes = scene->host_meshes = (uint32_t)meshes;
    out->listed += out->meshes;
    scene->host_vertices = (uint32_t)vertices;
    scene->host_triangles = (uint32_t)triangles;
    scene->host_nodes = traced ? (uint32_t)nodes : 0;
    for (uint32_t k = 0; k < MASU_MAX_MESH_KINDS; k++) {
        const masu_mesh_kind *kind = &reserve->meshes[k];
        uint64_t bytes = masu_mesh_upload_of(scene, kind->vertices, kind->triangles).bytes;
        uint32_t levels = masu_trace_top_levels(kind->triangles);
        if (kind->meshes && most < bytes) most = bytes;
        if (kind->meshes && traced && scene->trace_levels < levels) scene->trace_levels = levels;
    }
    out->mesh_upload = reserve->mesh_upload ? reserve->mesh_upload : (uint32_t)most;
    if (out->mesh_upload < most) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "reserve.mesh_upload", most,
                         reserve->mesh_upload,
                         "reserve.mesh_upload is %u, the largest slot of reserve.meshes takes %llu",
                         reserve->mesh_upload, (unsigned long long)most);
    }
    if (!scene->skins) scene->first_skinned = scene->vertices;
    scene->skinned_vertices += scene->host_vertices;
    scene->skinned_nodes += scene->host_nodes;
    scene->vertices += scene->host_vertices;
    scene->trace_nodes += scene->host_nodes;
    scene->trace_triangles += scene->host_nodes ? scene->host_triangles : 0;
    scene->meshes += out->meshes;
    scene->draws += out->meshes;
    scene->models += out->meshes;
    out->places.instances += out->meshes;
    out->places.nodes += out->meshes;
    out->places.traced += traced ? out->meshes : 0;
    return MASU_OK;
}

masu_result masu_reserve_add(const masu_reserve *reserve, masu_scene_data *scene,
                             masu_reserve_plan *out, masu_detail *detail) {
    *out = (masu_reserve_plan){.lights = reserve->lights};
    scene->lights += reserve->lights;
    scene->shadow_lights += reserve->lights;
    masu_result result = MASU_OK;
    if (reserve->models && scene->models) result = add_models(reserve->models, scene, out, detail);
    if (result) return result;
    scene->max_instances += out->places.instances;
    result = add_meshes(reserve, scene, out, detail);
    if (result) return result;
    scene->models += out->models;
    scene->model_nodes += out->places.nodes;
    scene->instances += out->places.instances;
    scene->transparents += out->places.transparents;
    scene->trace_instances += out->places.traced;
    scene->placed_occluders += out->occluders;
    return MASU_OK;
}
