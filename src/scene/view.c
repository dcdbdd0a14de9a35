/* view.c: see view.h. */
#include "scene/view.h"

masu_cull_box masu_scene_box(const masu_scene_view *view, uint32_t instance) {
    const masu_blob_instance *n = &view->instances[instance];
    const masu_blob_mesh *mesh = &view->meshes[n->mesh];
    return masu_cull_place(n->transform, mesh->aabb_min, mesh->aabb_max);
}

uint32_t masu_scene_mesh_instances(const masu_scene_view *view, uint32_t instance_count,
                                   uint32_t mesh, uint32_t from, uint32_t *first) {
    while (from < instance_count && view->instances[from].mesh < mesh) from++;
    *first = from;
    while (from < instance_count && view->instances[from].mesh == mesh) from++;
    return from;
}

uint32_t masu_scene_mesh_lods(const masu_scene_view *view, uint32_t lod_count, uint32_t mesh,
                              uint32_t *first) {
    uint32_t low = 0, high = lod_count;
    while (low < high) { /* the first that is not below */
        uint32_t middle = low + (high - low) / 2;
        if (view->lods[middle].mesh < mesh)
            low = middle + 1;
        else
            high = middle;
    }
    *first = low;
    while (high < lod_count && view->lods[high].mesh == mesh) high++;
    return high - low;
}
