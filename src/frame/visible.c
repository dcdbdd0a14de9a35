/* visible.c: the instances that each view draws. The recordings are static: each contains all draws
 * as indirect draws. The number of instances of each draw, and their indices, are read from two
 * buffers that are written here for each frame:
 *
 *   draw commands      [view][draw]    VkDrawIndexedIndirectCommand; instanceCount 0: nothing
 *   drawn instances    [view][list]    the visible instances of each LOD of a placed mesh
 *
 * Each LOD of a mesh, including the mesh itself, has separate draws and a list with space for all
 * instances: the start of each list is recorded. A visible instance is in one list. The LOD depends
 * only on the camera and the instance's transform: it is the same in each view, with any culling.
 * So all views are culled first, and one pass over the instances then fills their lists.
 *
 * firstInstance is always 0, since other values would need the feature drawIndirectFirstInstance: a
 * draw reads the start of its list from push constants. All primitives of a mesh share one list.
 * With stage 2 (occlusion.c) both buffers have a second half, in which the GPU writes the instances
 * that remain.
 *
 * Visible instances keep their order, so that culling does not change the image: of two surfaces at
 * one depth the same one wins with and without culling. */
#include "frame/visible.h"

#include "device/bind.h"
#include "scene/lod.h"

#include <math.h>
#include <string.h>

_Static_assert(sizeof(VkDrawIndexedIndirectCommand) == MASU_DRAW_BYTES, "indirect draw");

/* ---- Once per scene -------------------------------------------------------------------------- */

void masu_visible_alloc(masu_visible *s, masu_arena *arena, const masu_frame_plan *plan) {
    uint64_t lods = plan->lods ? plan->scene.lods : 0;
    uint32_t instances = plan->scene.instances;
    s->lods = masu_arena_alloc(arena, "LODs", lods, sizeof *s->lods, 4);
    s->levels =
        masu_arena_alloc(arena, "instance LODs", lods ? instances : 0, sizeof *s->levels, 1);
    s->group_states =
        masu_arena_alloc(arena, "group states", (uint64_t)plan->views * plan->scene.groups,
                         sizeof *s->group_states, 1);
    s->marks = masu_arena_alloc(arena, "instance marks", instances, sizeof *s->marks, 1);
}

void masu_visible_copy_scene(masu_visible *s, const masu_frame_plan *plan,
                             const masu_scene_view *v) {
    for (uint32_t l = 0; plan->lods && l < plan->scene.lods; l++) s->lods[l] = v->lods[l];
}

VkDrawIndexedIndirectCommand *masu_draws_write(const masu_draws *draws, const masu_scene_view *v,
                                               const masu_frame_plan *plan,
                                               VkDrawIndexedIndirectCommand *to) {
    uint32_t slots = draws->batch_count - plan->reserve.meshes;
    for (uint32_t b = 0; b < draws->batch_count; b++) {
        const masu_batch *batch = &draws->batches[b];
        if (b >= slots) { /* of a mesh of the host: no triangles yet */
            const masu_mesh_slot s = masu_mesh_slot_of(&plan->desc.reserve, 0, b - slots);
            uint32_t vertex = plan->scene.vertices - plan->scene.host_vertices + s.first_vertex;
            *to++ = (VkDrawIndexedIndirectCommand){0, 0, 3 * s.first_triangle, (int32_t)vertex, 0};
            continue;
        }
        for (uint32_t d = 0; d < batch->draw_count; d++) {
            const masu_blob_primitive *p = &v->primitives[batch->first_primitive + d];
            *to++ = (VkDrawIndexedIndirectCommand){p->index_count, 0, p->first_index,
                                                   (int32_t)p->first_vertex, 0};
        }
    }
    return to;
}

/* All of each command but the count, for every slot and view. */
void masu_visible_write_scene(const masu_device *device, const masu_draws *draws,
                              const masu_scene_view *v) {
    const masu_frame_plan *plan = device->plan;
    if (!draws->batch_count) return;
    for (uint32_t slot = 0; slot < plan->desc.frames_in_flight; slot++) {
        VkDrawIndexedIndirectCommand *to =
            (VkDrawIndexedIndirectCommand *)(void *)masu_buffer_pointer(device, MASU_BUFFER_DRAWS,
                                                                        slot);
        uint32_t lists = plan->views * (plan->occlusion ? 2 : 1);
        for (uint32_t list = 0; list < lists; list++) to = masu_draws_write(draws, v, plan, to);
    }
}

/* ---- Each frame ------------------------------------------------------------------------------ */

_Static_assert(sizeof(struct masu_instance_data) == 12 * sizeof(float), "three rows of four");

/* The LOD of an instance, by a lower bound of the depth of its box in the image: the depth of the
 * nearest corner, or the distance of the box times the cosine of the widest angle, whichever is
 * larger. The latter also handles casters next to or behind the camera. A box that contains the
 * camera has the finest LOD. */
static uint32_t level_of(const masu_visible *s, const masu_lod_view *view,
                         const masu_bounds *bounds, const masu_instances *in,
                         const masu_batch *mesh, uint32_t instance) {
    const float *center = bounds->boxes + masu_bounds_position(bounds, instance);
    const float *extent = center + 3 * bounds->box_stride;
    double depth = 0.0, squared = 0.0;
    const float *rows = (const float *)(const void *)&in->now[instance];
    for (uint32_t k = 0; k < 3; k++, center += bounds->box_stride, extent += bounds->box_stride) {
        double rel = (double)*center - view->eye[k], half = (double)*extent;
        double outside = fabs(rel) - half;
        depth += view->forward[k] * rel - fabs(view->forward[k]) * half;
        if (outside > 0.0) squared += outside * outside;
    }
    double least = sqrt(squared) * view->widest; /* never NaN; depth is, of an infinite box */
    depth = depth > least ? depth : least;
    return masu_lod_choose(s->lods + mesh->first_lod, mesh->lod_count, masu_lod_scale(rows),
                           (float)depth, view->pixels, view->threshold);
}

/* Stage 1: sets the bit of a view in the marks of its visible instances. */
static void mark(masu_visible *s, const masu_bounds *bounds, const masu_instances *in,
                 const masu_views *views, const masu_frame_data *f, uint32_t view) {
    const masu_scene_data *scene = &f->plan->scene;
    masu_view_stats *counts = &s->slot_views[f->slot][view];
    uint8_t bit = (uint8_t)(1u << view);
    if (!masu_view_draws(f, view)) {
        for (uint32_t i = 0; i < scene->instances; i++) s->marks[i] &= (uint8_t)~bit;
    } else if (masu_frame_rung(f)->frustum != MASU_OFF) {
        masu_cull_set set = masu_bounds_set(bounds, scene);
        masu_cull_counts c = {0, 0};
        masu_cull(&set, &views->planes[view], s->group_states + (uint64_t)view * scene->groups,
                  s->marks, bit, &c);
        counts->groups = c.nodes;
        counts->plane_tests = c.plane_tests;
    } else {
        for (uint32_t i = 0; i < scene->instances; i++) s->marks[i] |= bit;
    }
    for (uint32_t i = 0; in->hidden_count && i < scene->instances; i++) {
        if (masu_instance_hidden(in, i)) s->marks[i] &= (uint8_t)~bit;
    }
    for (uint32_t i = 0; in->looks.given && i < scene->instances; i++) {
        if (view ? masu_look_shadowless(&in->looks, i)
                 : masu_look_unseen(&in->looks, i, f->desc.viewport))
            s->marks[i] &= (uint8_t)~bit;
    }
}

#define FORMS (1 + MASU_BLOB_LODS_MAX)

/* The lists of one mesh in all views. */
typedef struct lister {
    masu_visible *s;
    const masu_bounds *bounds;
    const masu_instances *in;
    const masu_views *views;
    const masu_frame_data *f;
    const masu_batch *mesh; /* followed by its LODs */
    uint32_t *ids;   /* [view][listed] */
    uint64_t listed; /* ids per view */
    uint32_t kept[MASU_MAX_VIEWS][FORMS]; /* lengths of the lists */
} lister;

/* Appends an instance to the list of each view that it is marked for. Its LOD does not depend on
 * the view: it is chosen once. */
static void list_one(lister *l, uint32_t i) {
    uint32_t marks = l->s->marks[i] & ((1u << l->f->plan->views) - 1u), level = 0;
    if (!marks) return;
    if (l->mesh->lod_count) {
        level = level_of(l->s, &l->views->lod, l->bounds, l->in, l->mesh, i);
        l->s->levels_chosen++;
    }
    if (l->f->plan->lods) l->s->levels[i] = (uint8_t)level;
    uint32_t *to = l->ids + l->mesh[level].first_listed, *kept = &l->kept[0][level];
    for (uint64_t listed = l->listed; marks; marks >>= 1, to += listed, kept += FORMS) {
        if (marks & 1u) to[(*kept)++] = i;
    }
}

/* The counts of the forms of a mesh in a view: its draw commands, which are never read (upload
 * memory may be write-combined), and the statistics. */
static void write_counts(const lister *l, uint32_t view, VkDrawIndexedIndirectCommand *draws) {
    masu_view_stats *counts = &l->s->slot_views[l->f->slot][view];
    for (uint32_t level = 0; level < 1 + l->mesh->lod_count; level++) {
        const masu_batch *batch = &l->mesh[level];
        uint32_t kept = l->kept[view][level];
        for (uint32_t d = 0; d < batch->draw_count; d++) {
            draws[batch->first_draw + d].instanceCount = kept;
        }
        counts->instances += kept;
        counts->triangles += kept * batch->triangles;
        counts->draws += kept ? batch->draw_count - batch->blended : 0;
    }
}

/* All marked instances, in one pass over the instances of each mesh. */
static void list(masu_visible *s, const masu_bounds *bounds, const masu_instances *in,
                 const masu_views *views, const masu_frame_data *f) {
    VkDrawIndexedIndirectCommand *draws =
        (VkDrawIndexedIndirectCommand *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWS);
    uint32_t *ids = (uint32_t *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWN);
    s->levels_chosen = 0;
    for (uint32_t b = 0; b < f->draws->batch_count; b += 1 + f->draws->batches[b].lod_count) {
        const masu_batch *mesh = &f->draws->batches[b];
        lister l = {s, bounds, in, views, f, mesh, ids, f->plan->listed, {{0}}};
        for (uint32_t i = 0; i < mesh->instance_count; i++) list_one(&l, mesh->first_instance + i);
        for (uint32_t i = masu_instances_added(in, mesh->mesh); i != MASU_BLOB_NONE;
             i = masu_instances_next(in, i))
            list_one(&l, i);
        for (uint32_t view = 0; view < f->plan->views; view++)
            write_counts(&l, view, draws + (uint64_t)view * f->plan->draws);
    }
}

void masu_visible_write(masu_visible *s, const masu_bounds *bounds, const masu_instances *in,
                        const masu_views *views, const masu_frame_data *f) {
    memset(s->slot_views[f->slot], 0, f->plan->views * sizeof *s->slot_views[f->slot]);
    if (!f->plan->scene.instances) return;
    for (uint32_t view = 0; view < f->plan->views; view++) mark(s, bounds, in, views, f, view);
    list(s, bounds, in, views, f);
}
