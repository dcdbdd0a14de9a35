/* blob_section.c: see blob_section.h. */
#include "scene/blob_section.h"

#include <string.h>

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

uint32_t masu_scene_range(const uint32_t *numbers, size_t stride, uint32_t count, uint32_t wanted,
                          uint32_t *first) {
#define NUMBER(i) (*(const uint32_t *)(const void *)((const char *)numbers + (i) * stride))
    uint32_t low = 0, high = count;
    while (low < high) { /* lower bound: the first that is not less */
        uint32_t middle = low + (high - low) / 2;
        if (NUMBER(middle) < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    *first = low;
    while (high < count && NUMBER(high) == wanted) high++;
    return high - low;
#undef NUMBER
}

uint64_t masu_scene_name_hash(const masu_scene_view *view, uint32_t name) {
    if (name == MASU_BLOB_NONE) return 0;
    return masu_fnv1a64(view->names + name, strlen(view->names + name));
}

uint32_t masu_scene_mesh_lods(const masu_scene_view *view, uint32_t lod_count, uint32_t mesh,
                              uint32_t *first) {
    *first = 0;
    if (!lod_count) return 0;
    return masu_scene_range(&view->lods->mesh, sizeof *view->lods, lod_count, mesh, first);
}
