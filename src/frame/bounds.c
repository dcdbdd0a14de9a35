/* bounds.c: see bounds.h. */
#include "frame/bounds.h"

#include <math.h>
#include <string.h>

void masu_bounds_alloc(masu_bounds *b, masu_arena *arena, const masu_frame_plan *plan) {
    const masu_scene_data *s = &plan->scene;
    b->meshes = masu_arena_alloc(arena, "mesh bounds", s->meshes, sizeof *b->meshes, 4);
    b->groups = masu_arena_alloc(arena, "groups", s->groups, sizeof *b->groups, 4);
    b->boxes = masu_arena_alloc(arena, "boxes", 6 * ((uint64_t)s->instances + MASU_BOX_PADDING),
                                sizeof *b->boxes, 16);
    b->items = masu_arena_alloc(arena, "box owners", s->instances, sizeof *b->items, 4);
    b->positions = masu_arena_alloc(arena, "box positions", s->instances, sizeof *b->positions, 4);
    b->moved = masu_arena_alloc(arena, "moved boxes", s->instances, sizeof *b->moved, 4);
}

/* It only grows: where an instance was it may come again, and a smaller one would gain nothing
 * but a depth scale of the shadow map that changes. */
static void sweep(masu_bounds *b, const masu_cull_box *box) {
    for (uint32_t k = 0; k < 3; k++) {
        double low = (double)box->center[k] - (double)box->half[k];
        double high = (double)box->center[k] + (double)box->half[k];
        b->swept[0][k] = fmin(b->swept[0][k], fmax(low, -1e30));
        b->swept[1][k] = fmax(b->swept[1][k], fmin(high, 1e30));
    }
}

static void set_box(masu_bounds *b, const masu_instances *in, uint32_t position,
                    uint32_t instance) {
    const float *bounds = b->meshes[in->meshes[instance]];
    float rows[12];
    masu_instance_rows(&in->now[instance], rows);
    masu_cull_box box = masu_cull_place(rows, bounds, bounds + 3);
    box = masu_cull_widen(&box, 1.0f);
    for (uint32_t k = 0; k < 3; k++) {
        b->boxes[k * b->box_stride + position] = box.center[k];
        b->boxes[(3 + k) * b->box_stride + position] = box.half[k];
    }
    sweep(b, &box);
}

/* Without boxes that are too far away to be culled. */
static masu_cull_box around_all(const masu_bounds *b, uint32_t instances) {
    masu_cull_box all = {{0, 0, 0}, {0, 0, 0}};
    for (uint32_t p = 0; p < instances; p++) {
        masu_cull_box pair[2] = {all, all};
        for (uint32_t k = 0; k < 3; k++) {
            pair[1].center[k] = b->boxes[k * b->box_stride + p];
            pair[1].half[k] = b->boxes[(3 + k) * b->box_stride + p];
        }
        masu_cull_box both = masu_cull_around(p ? pair : pair + 1, p ? 2 : 1);
        if (both.half[0] <= MASU_CULL_FAR && both.half[1] <= MASU_CULL_FAR &&
            both.half[2] <= MASU_CULL_FAR) {
            all = both;
        }
    }
    return all;
}

void masu_bounds_copy_scene(masu_bounds *b, const masu_frame_plan *plan, const masu_instances *in,
                            const masu_scene_view *v) {
    const masu_scene_data *scene = &plan->scene;
    b->box_stride = (uint64_t)scene->instances + MASU_BOX_PADDING;
    for (uint32_t k = 0; k < 3; k++) b->swept[0][k] = 1e30, b->swept[1][k] = -1e30;
    memset(b->meshes, 0, scene->meshes * sizeof *b->meshes);
    for (uint32_t mesh = 0; mesh < masu_own_meshes(plan); mesh++) {
        memcpy(b->meshes[mesh], v->meshes[mesh].aabb_min, sizeof v->meshes[mesh].aabb_min);
        memcpy(b->meshes[mesh] + 3, v->meshes[mesh].aabb_max, sizeof v->meshes[mesh].aabb_max);
    }
    for (uint32_t g = 0; g < scene->groups; g++) {
        const masu_blob_group *from = &v->groups[g];
        masu_cull_box box;
        memcpy(box.center, from->center, sizeof box.center);
        memcpy(box.half, from->half, sizeof box.half);
        b->groups[g] = (masu_cull_node){masu_cull_widen(&box, 4.0f), from->first_child,
                                        from->child_count, from->first_item, from->item_count};
    }
    uint32_t behind = scene->group_items;
    for (uint32_t p = 0; p < scene->group_items; p++) b->items[p] = v->group_items[p];
    for (uint32_t i = 0; i < in->own; i++) {
        if (v->instances[i].group == MASU_BLOB_NONE) b->items[behind++] = i;
    }
    for (uint32_t p = 0; p < in->own; p++) {
        b->positions[b->items[p]] = p;
        set_box(b, in, p, b->items[p]);
    }
    b->initial = around_all(b, in->own);
    /* of the reserve: a point, until it is added */
    for (uint32_t p = in->own; p < scene->instances; p++) {
        b->items[p] = b->positions[p] = p;
        for (uint32_t k = 0; k < 6; k++) b->boxes[k * b->box_stride + p] = 0.0f;
    }
}

/* Once it has moved, an instance is tested by itself: groups keep the boxes they were baked
 * with. */
void masu_bounds_move(masu_bounds *b, const masu_frame_plan *plan, const masu_instances *in,
                      uint32_t instance) {
    uint32_t position = masu_bounds_position(b, instance);
    set_box(b, in, position, instance);
    if (position >= plan->scene.group_items || b->positions[instance] & MASU_BOX_MOVED) return;
    b->positions[instance] |= MASU_BOX_MOVED;
    b->moved[b->moved_count++] = position;
}

void masu_bounds_of(const masu_bounds *b, uint32_t instance, float box[6]) {
    uint32_t position = masu_bounds_position(b, instance);
    for (uint32_t k = 0; k < 6; k++) box[k] = b->boxes[k * b->box_stride + position];
}

masu_cull_set masu_bounds_set(const masu_bounds *b, const masu_scene_data *scene) {
    masu_cull_set set = {.nodes = b->groups,
                         .node_count = scene->groups,
                         .items = b->items,
                         .tree_count = scene->group_items,
                         .count = scene->instances,
                         .moved = b->moved,
                         .moved_count = b->moved_count};
    for (uint32_t k = 0; k < 6; k++) set.boxes[k] = b->boxes + k * b->box_stride;
    return set;
}
