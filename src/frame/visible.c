/* visible.c: what each view draws. The recordings are static: each has every draw, indirect, and
 * how many instances a draw has, and which, is read from two buffers that are written here for each
 * frame:
 *
 *   draw commands      [view][draw]    VkDrawIndexedIndirectCommand; instanceCount 0: nothing
 *   drawn instances    [view][list]    of each form of a placed mesh those that are kept
 *
 * Each form of a mesh, the mesh itself and its LODs, has draws and a list of its own, with room for all
 * instances: where a list begins is recorded. A kept instance is in one of them. Which, depends on the
 * camera and on where the instance is, and on nothing else: the same in each view and whatever is
 * culled.
 *
 * firstInstance stays 0, since another one would need the feature drawIndirectFirstInstance: a draw
 * finds the start of its list in its push constants. All primitives of a mesh share one list.
 * With stage 2 (occlusion.c) both have a second half, in which the GPU writes what it has left.
 *
 * Kept instances stay in order, so that what is not seen changes nothing: of two surfaces at one
 * depth the same one wins with and without it. */
#include "scene/lod.h"
#include "renderer.h"

#include <math.h>
#include <string.h>

_Static_assert(sizeof(VkDrawIndexedIndirectCommand) == MASU_DRAW_BYTES, "indirect draw");

/* ---- Once per scene -------------------------------------------------------------------------- */

/* A form of a mesh that has instances. */
static masu_batch *keep_batch(masu_renderer *m, const masu_scene_view *v, uint32_t first_primitive,
                              uint32_t primitives, uint32_t first, uint32_t instances) {
    masu_batch *b = &m->batches[m->batch_count];
    *b = (masu_batch){.first_primitive = first_primitive,
                      .draw_count = primitives,
                      .first_instance = first,
                      .instance_count = instances};
    if (m->batch_count) {
        b->first_draw = b[-1].first_draw + b[-1].draw_count;
        b->first_listed = b[-1].first_listed + b[-1].instance_count;
    }
    for (uint32_t p = 0; p < primitives; p++) {
        const masu_blob_primitive *one = &v->primitives[first_primitive + p];
        if (v->materials[one->material].flags & MASU_MATERIAL_IS_BLEND) {
            b->blended++; /* transparents.c draws it */
        } else {
            b->triangles += one->index_count / 3;
        }
    }
    m->batch_count++;
    m->large_count += instances > 64;
    return b;
}

static void keep_batches(masu_renderer *m, const masu_scene_view *v) {
    const masu_scene *scene = &m->plan.scene;
    uint32_t from = 0;
    for (uint32_t mesh = 0; mesh < scene->meshes; mesh++) {
        uint32_t first, first_lod,
            end = masu_scene_mesh_instances(v, scene->instances, mesh, from, &first);
        from = end;
        const masu_blob_mesh *what = &v->meshes[mesh];
        memcpy(m->mesh_bounds[mesh], what->aabb_min, sizeof what->aabb_min);
        memcpy(m->mesh_bounds[mesh] + 3, what->aabb_max, sizeof what->aabb_max);
        if (end == first || !what->primitive_count) continue;
        masu_batch *b =
            keep_batch(m, v, what->first_primitive, what->primitive_count, first, end - first);
        if (!m->plan.lods) continue;
        b->lod_count = masu_scene_mesh_lods(v, scene->lods, mesh, &first_lod);
        b->first_lod = first_lod;
        for (uint32_t l = 0; l < b->lod_count; l++) {
            (void)keep_batch(m, v, v->lods[first_lod + l].first_primitive, what->primitive_count,
                             first, end - first);
        }
    }
    for (uint32_t l = 0; m->plan.lods && l < scene->lods; l++) m->lods[l] = v->lods[l];
}

static void rows_of(const struct masu_instance_data *at, float rows[12]) {
    memcpy(rows, at->row0, sizeof at->row0);
    memcpy(rows + 4, at->row1, sizeof at->row1);
    memcpy(rows + 8, at->row2, sizeof at->row2);
}

static void set_box(masu_renderer *m, uint32_t position, uint32_t instance) {
    const float *bounds = m->mesh_bounds[m->instance_meshes[instance]];
    float rows[12];
    rows_of(&m->instances[instance], rows);
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
        VkDrawIndexedIndirectCommand *to =
            (VkDrawIndexedIndirectCommand *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot);
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
    if (position >= m->plan.scene.group_items || m->box_positions[instance] & MASU_BOX_MOVED)
        return;
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

/* By the least depth that a point of the box can have in the picture: not below that of its nearest
 * corner, nor below its distance times the cosine of the widest angle. The latter also serves what is
 * beside or behind the camera and casts a shadow. What the camera is in is drawn as it is. */
static uint32_t level_of(const masu_renderer *m, const masu_batch *mesh, uint32_t instance) {
    const masu_lod_view *view = &m->lod_view;
    uint32_t position = m->box_positions[instance] & ~MASU_BOX_MOVED;
    double depth = 0.0, squared = 0.0;
    float rows[12];
    for (uint32_t k = 0; k < 3; k++) {
        double rel = (double)m->boxes[k * m->box_stride + position] - view->eye[k];
        double half = (double)m->boxes[(3 + k) * m->box_stride + position];
        double outside = fmax(fabs(rel) - half, 0.0);
        depth += view->forward[k] * rel - fabs(view->forward[k]) * half;
        squared += outside * outside;
    }
    depth = fmax(depth, sqrt(squared) * view->widest);
    rows_of(&m->instances[instance], rows);
    return masu_lod_choose(m->lods + mesh->first_lod, mesh->lod_count, masu_lod_scale(rows),
                           (float)depth, view->pixels, view->threshold);
}

void masu_write_visible(masu_renderer *m, uint32_t slot, uint32_t view, int culls) {
    const masu_scene *scene = &m->plan.scene;
    masu_view_stats *counts = &m->slot_views[slot][view];
    uint8_t bit = (uint8_t)(1u << view);
    memset(counts, 0, sizeof *counts);
    if (!scene->instances) return;
    if (!masu_view_draws(m, view)) {
        for (uint32_t i = 0; i < scene->instances; i++) m->marks[i] &= (uint8_t)~bit;
    } else if (culls) {
        masu_cull_set set = box_set(m);
        masu_cull_counts c = {0, 0};
        masu_cull(&set, &m->view_planes[view], m->group_states + (uint64_t)view * scene->groups,
                  m->marks, bit, &c);
        counts->groups = c.nodes;
        counts->plane_tests = c.plane_tests;
    } else {
        for (uint32_t i = 0; i < scene->instances; i++) m->marks[i] |= bit;
    }
    /* Never read: upload memory may be write-combined. */
    VkDrawIndexedIndirectCommand *draws =
        (VkDrawIndexedIndirectCommand *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot) +
        (uint64_t)view * m->plan.draws;
    uint32_t *ids = (uint32_t *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWN, slot) +
                    (uint64_t)view * m->plan.listed;
    for (uint32_t b = 0, forms; b < m->batch_count; b += forms) {
        const masu_batch *mesh = &m->batches[b];
        uint32_t kept[1 + MASU_BLOB_LODS_MAX] = {0};
        uint32_t end = mesh->first_instance + mesh->instance_count;
        forms = 1 + mesh->lod_count;
        for (uint32_t i = mesh->first_instance; i < end; i++) {
            if (!(m->marks[i] & bit)) continue;
            uint32_t level = 0;
            if (m->plan.lods) m->levels[i] = (uint8_t)(level = level_of(m, mesh, i));
            ids[mesh[level].first_listed + kept[level]++] = i;
        }
        for (uint32_t level = 0; level < forms; level++) {
            const masu_batch *batch = &mesh[level];
            for (uint32_t d = 0; d < batch->draw_count; d++) {
                draws[batch->first_draw + d].instanceCount = kept[level];
            }
            counts->instances += kept[level];
            counts->triangles += kept[level] * batch->triangles;
            counts->draws += kept[level] ? batch->draw_count - batch->blended : 0;
        }
    }
}
