/* visible.c: what each view draws. The recordings are static: each has every draw, indirect, and
 * how many instances a draw has, and which, is read from two buffers that are written here for each
 * frame:
 *
 *   draw commands      [view][draw]      VkDrawIndexedIndirectCommand; instanceCount 0: nothing
 *   drawn instances    [view][instance]  of each placed mesh those that are kept, from its first on
 *
 * firstInstance stays 0, since another one would need the feature drawIndirectFirstInstance: a draw
 * finds the start of its list in its push constants. All primitives of a mesh share one list.
 * With stage 2 (occlusion.c) both have a second half, in which the GPU writes what it has left.
 *
 * Kept instances stay in order, so that what is not seen changes nothing: of two surfaces at one
 * depth the same one wins with and without it. */
#include "renderer.h"

#include <string.h>

_Static_assert(sizeof(VkDrawIndexedIndirectCommand) == MASU_DRAW_BYTES, "indirect draw");

/* ---- Once per scene -------------------------------------------------------------------------- */

static void keep_batches(masu_renderer *m, const masu_scene_view *v) {
    uint32_t from = 0, draws = 0;
    for (uint32_t mesh = 0; mesh < m->plan.scene.meshes; mesh++) {
        uint32_t first,
            end = masu_scene_mesh_instances(v, m->plan.scene.instances, mesh, from, &first);
        from = end;
        const masu_blob_mesh *what = &v->meshes[mesh];
        memcpy(m->mesh_bounds[mesh], what->aabb_min, sizeof what->aabb_min);
        memcpy(m->mesh_bounds[mesh] + 3, what->aabb_max, sizeof what->aabb_max);
        if (end == first || !what->primitive_count) continue;
        masu_batch *b = &m->batches[m->batch_count++];
        m->large_count += end - first > 64;
        *b = (masu_batch){.first_primitive = what->first_primitive,
                          .first_draw = draws,
                          .draw_count = what->primitive_count,
                          .first_instance = first,
                          .instance_count = end - first};
        for (uint32_t p = 0; p < what->primitive_count; p++) {
            b->triangles += v->primitives[what->first_primitive + p].index_count / 3;
        }
        draws += what->primitive_count;
    }
}

static void set_box(masu_renderer *m, uint32_t position, uint32_t instance) {
    const float *bounds = m->mesh_bounds[m->instance_meshes[instance]];
    const struct masu_instance_data *at = &m->instances[instance];
    float rows[12];
    memcpy(rows, at->row0, sizeof at->row0);
    memcpy(rows + 4, at->row1, sizeof at->row1);
    memcpy(rows + 8, at->row2, sizeof at->row2);
    masu_cull_box box = masu_cull_place(rows, bounds, bounds + 3);
    box = masu_cull_widen(&box, 1.0f);
    for (uint32_t k = 0; k < 3; k++) {
        m->boxes[k * m->box_stride + position] = box.center[k];
        m->boxes[(3 + k) * m->box_stride + position] = box.half[k];
    }
    if (m->plan.needs.shadow) masu_note_caster(m, &box);
}

void masu_keep_visible(masu_renderer *m, const masu_scene_view *v) {
    const masu_scene *scene = &m->plan.scene;
    m->box_stride = (uint64_t)scene->instances + MASU_BOX_PADDING;
    for (uint32_t k = 0; k < 3; k++) m->casters[0][k] = 1e30, m->casters[1][k] = -1e30;
    keep_batches(m, v);
    for (uint32_t g = 0; g < scene->groups; g++) {
        const masu_blob_group *from = &v->groups[g];
        masu_cull_box box;
        memcpy(box.center, from->center, sizeof box.center);
        memcpy(box.half, from->half, sizeof box.half);
        m->groups[g] = (masu_cull_node){masu_cull_widen(&box, 4.0f), from->first_child,
                                        from->child_count, from->first_item, from->item_count};
    }
    uint32_t behind = scene->group_items;
    for (uint32_t p = 0; p < scene->group_items; p++) m->box_items[p] = v->group_items[p];
    for (uint32_t i = 0; i < scene->instances; i++) {
        m->instance_meshes[i] = v->instances[i].mesh;
        if (v->instances[i].group == MASU_BLOB_NONE) m->box_items[behind++] = i;
    }
    for (uint32_t p = 0; p < scene->instances; p++) {
        m->box_positions[m->box_items[p]] = p;
        set_box(m, p, m->box_items[p]);
    }
}

/* All of each command but the count, for every slot and view. */
void masu_write_commands(masu_renderer *m, const masu_scene_view *v) {
    if (!m->batch_count) return;
    for (uint32_t slot = 0; slot < m->plan.desc.frames_in_flight; slot++) {
        VkDrawIndexedIndirectCommand *to = (VkDrawIndexedIndirectCommand *)(void *)
            masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot);
        uint32_t lists = m->plan.views * (m->plan.occlusion ? 2 : 1);
        for (uint32_t list = 0; list < lists; list++) {
            for (uint32_t b = 0; b < m->batch_count; b++) {
                const masu_batch *batch = &m->batches[b];
                for (uint32_t d = 0; d < batch->draw_count; d++) {
                    const masu_blob_primitive *p = &v->primitives[batch->first_primitive + d];
                    *to++ = (VkDrawIndexedIndirectCommand){p->index_count, 0, p->first_index,
                                                           (int32_t)p->first_vertex, 0};
                }
            }
        }
    }
}

/* ---- Moving ---------------------------------------------------------------------------------- */

/* Once it has moved, an instance is tested by itself: groups keep the boxes they were baked with. */
void masu_move_box(masu_renderer *m, uint32_t instance) {
    uint32_t position = m->box_positions[instance] & ~MASU_BOX_MOVED;
    set_box(m, position, instance);
    if (position >= m->plan.scene.group_items || m->box_positions[instance] & MASU_BOX_MOVED) return;
    m->box_positions[instance] |= MASU_BOX_MOVED;
    m->moved[m->moved_count++] = position;
}

/* ---- Each frame ------------------------------------------------------------------------------ */

static masu_cull_set box_set(const masu_renderer *m) {
    masu_cull_set set = {.nodes = m->groups,
                         .node_count = m->plan.scene.groups,
                         .items = m->box_items,
                         .tree_count = m->plan.scene.group_items,
                         .count = m->plan.scene.instances,
                         .moved = m->moved,
                         .moved_count = m->moved_count};
    for (uint32_t k = 0; k < 6; k++) set.boxes[k] = m->boxes + k * m->box_stride;
    return set;
}

void masu_write_visible(masu_renderer *m, uint32_t slot, uint32_t view, int culls) {
    const masu_scene *scene = &m->plan.scene;
    int idle = view && m->plan.needs.shadow && !(m->drawn >> (view - 1) & 1u);
    masu_view_stats *counts = &m->slot_views[slot][view];
    uint8_t bit = (uint8_t)(1u << view);
    memset(counts, 0, sizeof *counts);
    if (!scene->instances) return;
    if (idle) { /* a cascade that this frame does not draw */
        for (uint32_t i = 0; i < scene->instances; i++) m->marks[i] &= (uint8_t)~bit;
    } else if (culls) {
        masu_cull_set set = box_set(m);
        masu_cull_counts c = {0, 0};
        masu_cull(&set, &m->view_planes[view], m->group_states + (uint64_t)view * scene->groups, m->marks, bit,
                  &c);
        counts->groups = c.nodes;
        counts->plane_tests = c.plane_tests;
    } else {
        for (uint32_t i = 0; i < scene->instances; i++) m->marks[i] |= bit;
    }
    /* Written in rising addresses and never read: upload memory may be write-combined. */
    VkDrawIndexedIndirectCommand *draws =
        (VkDrawIndexedIndirectCommand *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot) +
        (uint64_t)view * scene->draws;
    uint32_t *ids = (uint32_t *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWN, slot) +
                    (uint64_t)view * scene->instances;
    for (uint32_t b = 0; b < m->batch_count; b++) {
        const masu_batch *batch = &m->batches[b];
        uint32_t kept = 0, end = batch->first_instance + batch->instance_count;
        for (uint32_t i = batch->first_instance; i < end; i++) {
            if (m->marks[i] & bit) ids[batch->first_instance + kept++] = i;
        }
        for (uint32_t d = 0; d < batch->draw_count; d++) {
            draws[batch->first_draw + d].instanceCount = kept;
        }
        counts->instances += kept;
        counts->triangles += kept * batch->triangles;
        counts->draws += kept ? batch->draw_count : 0;
    }
}
