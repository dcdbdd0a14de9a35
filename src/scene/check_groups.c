/* check_groups.c: validates the culling data: groups of instances, their bounds, and occluders. */
#include "scene/check.h"

#include <string.h>

/* Groups and their items are in breadth-first order: the children of group 0, then those of group
 * 1, ... This order implies that each group has one parent and is not its own ancestor, without a
 * mark per group. */
static masu_result check_group(reader *r, uint64_t i, uint64_t *next_child, uint64_t *next_item) {
    const masu_scene_view *v = &r->view;
    const masu_blob_group *g = &v->groups[i];
    if (i >= *next_child) return bad(r, "groups", i, "is a child of no group before it");
    if (g->child_count && (g->first_child != *next_child ||
                           *next_child + g->child_count > r->counts[MASU_BLOB_GROUPS])) {
        return bad(r, "groups", i, "children are not the next in breadth-first order");
    }
    if (g->item_count && (g->first_item != *next_item ||
                          *next_item + g->item_count > r->counts[MASU_BLOB_GROUP_ITEMS])) {
        return bad(r, "groups", i, "items are not the next of the items");
    }
    masu_cull_box box;
    memcpy(box.center, g->center, sizeof box.center);
    memcpy(box.half, g->half, sizeof box.half);
    if (!within(g->center, 3, -MASU_CULL_FAR, MASU_CULL_FAR) ||
        !within(g->half, 3, 0.0f, MASU_CULL_FAR)) {
        return bad(r, "groups", i, "bounds are out of range");
    }
    for (uint32_t k = 0; k < g->child_count; k++) {
        const masu_blob_group *child = &v->groups[g->first_child + k];
        masu_cull_box inner;
        memcpy(inner.center, child->center, sizeof inner.center);
        memcpy(inner.half, child->half, sizeof inner.half);
        if (!masu_cull_holds(&box, &inner)) {
            return bad(r, "groups", i, "bounds do not hold its children");
        }
    }
    for (uint32_t k = 0; k < g->item_count; k++) {
        uint32_t item = v->group_items[g->first_item + k];
        if (item >= r->counts[MASU_BLOB_INSTANCES] || v->instances[item].group != i) {
            return bad(r, "group items", (uint64_t)g->first_item + k,
                       "is no instance of its group");
        }
        if (k && item <= v->group_items[g->first_item + k - 1]) {
            return bad(r, "group items", (uint64_t)g->first_item + k, "does not rise");
        }
        masu_cull_box inner = masu_scene_box(v, item);
        inner = masu_cull_widen(&inner, 1.0f);
        if (!masu_cull_holds(&box, &inner)) {
            return bad(r, "groups", i, "bounds do not hold its instances");
        }
    }
    *next_child += g->child_count;
    *next_item += g->item_count;
    return name_ok(r, g->name) ? MASU_OK : bad(r, "groups", i, "name lies outside the names");
}

masu_result masu_check_groups(reader *r) {
    uint64_t groups = r->counts[MASU_BLOB_GROUPS], items = r->counts[MASU_BLOB_GROUP_ITEMS];
    if (!groups != !items) return bad(r, "groups", 0, "are there without items, or items alone");
    uint64_t next_child = 1, next_item = 0, level_end = 1, levels = 1, grouped = 0;
    for (uint64_t i = 0; i < groups; i++) {
        if (i == level_end) {
            level_end = next_child;
            if (++levels > MASU_CULL_DEPTH) return bad(r, "groups", i, "is below 64 levels");
        }
        masu_result result = check_group(r, i, &next_child, &next_item);
        if (result) return result;
    }
    if (groups && (next_child != groups || next_item != items)) {
        return bad(r, "group items", next_item, "belongs to no group");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_INSTANCES]; i++) {
        if (r->view.instances[i].group == MASU_BLOB_NONE) continue;
        if (++grouped > items) return bad(r, "instances", i, "its group does not know it");
    }
    return MASU_OK;
}

/* *pairs: number of pairs of an occluder and an instance of its mesh. */
masu_result masu_check_occluders(reader *r, uint64_t *pairs) {
    const masu_scene_view *v = &r->view;
    uint32_t from = 0, first = 0, end = 0, of_mesh = 0;
    *pairs = 0;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_OCCLUDERS]; i++) {
        const masu_blob_occluder *o = &v->occluders[i];
        if (o->mesh >= r->counts[MASU_BLOB_MESHES]) return bad(r, "occluders", i, "no such mesh");
        if (i && o->mesh < o[-1].mesh) return bad(r, "occluders", i, "not sorted by mesh");
        const masu_blob_mesh *mesh = &v->meshes[o->mesh];
        if (!box_holds(mesh->aabb_min, mesh->aabb_max, o->low, o->high) ||
            !box_holds(o->low, o->high, o->high, o->low)) {
            return bad(r, "occluders", i, "is no box inside of its mesh");
        }
        if (o->lods > MASU_BLOB_LODS_MAX) return bad(r, "occluders", i, "knows more than 3 LODs");
        if (!i || o->mesh != o[-1].mesh) {
            end = masu_scene_mesh_instances(v, (uint32_t)r->counts[MASU_BLOB_INSTANCES], o->mesh,
                                            from, &first);
            from = end;
            of_mesh = 0;
        }
        if (++of_mesh > MASU_BLOB_OCCLUDERS_MAX)
            return bad(r, "occluders", i, "over 64 in one mesh");
        *pairs += end - first;
        if (*pairs > MASU_SECTION_MOST)
            return bad(r, "occluders", i, "makes over 2^31 - 1 placed occluders");
    }
    return MASU_OK;
}
