/* occlusion.c: the host's part of occlusion culling: placed occluders, and the data that
 * shaders/occluders.vert, cull.comp and compact.comp read (masu_shared.h, MASU_CULL_*). It follows
 * the lists of stage 1 in the same buffer, one slot per frame in flight, because a shader stage is
 * limited to six storage buffers.
 *
 * Nothing is read back. The only GPU state between frames is whether an instance was visible in
 * its last test; cull.comp explains why that may be wrong. */
#include "frame/occlusion.h"

#include "device/bind.h"

#include <string.h>

static uint32_t *drawn_words(const masu_device *device, uint32_t slot) {
    return (uint32_t *)(void *)masu_buffer_pointer(device, MASU_BUFFER_DRAWN, slot);
}

/* ---- Once per scene -------------------------------------------------------------------------- */

void masu_occlusion_alloc(masu_occlusion *o, masu_arena *arena, const masu_frame_plan *plan) {
    o->occluders =
        masu_arena_alloc(arena, "occluders", plan->scene.occluders, sizeof *o->occluders, 4);
}

void masu_occlusion_copy_scene(masu_occlusion *o, const masu_frame_plan *plan,
                               const masu_scene_view *v) {
    uint32_t from = 0, first = 0, end = 0;
    for (uint32_t k = 0; k < plan->scene.occluders; k++) {
        uint32_t mesh = v->occluders[k].mesh;
        if (!k || mesh != v->occluders[k - 1].mesh) {
            end = masu_scene_mesh_instances(v, masu_own_instances(plan), mesh, from, &first);
            from = end;
        }
        o->occluders[k] = (masu_placed_occluder){mesh, first, end - first, v->occluders[k].lods};
    }
}

static void write_header(const masu_frame_plan *plan, uint32_t batches, uint32_t *header) {
    const masu_drawn_plan *d = &plan->drawn;
    memset(header, 0, MASU_CULL_HEADER * sizeof *header);
    header[MASU_CULL_VIEWS] = plan->views;
    header[MASU_CULL_INSTANCES] = plan->scene.instances;
    header[MASU_CULL_DRAWS] = plan->draws;
    header[MASU_CULL_RECEIVERS] = (uint32_t)plan->receiver_mask;
    header[MASU_CULL_LISTED] = plan->listed;
    header[MASU_CULL_BATCH_COUNT] = batches;
    header[MASU_CULL_LISTS] = (uint32_t)d->lists;
    header[MASU_CULL_KEPT] = (uint32_t)d->kept;
    header[MASU_CULL_BATCHES] = (uint32_t)d->batches;
    header[MASU_CULL_LARGE] = (uint32_t)d->large;
    header[MASU_CULL_BOXES] = (uint32_t)d->boxes;
    header[MASU_CULL_OCCLUDERS] = (uint32_t)d->occluders;
    header[MASU_CULL_PAIRS] = (uint32_t)d->pairs;
    header[MASU_CULL_PAIR_COUNT] = plan->scene.placed_occluders;
}

/* Writes batches, the number of large ones, and the boxes of occluders. */
static void write_tables(const masu_frame_plan *plan, const masu_draws *draws,
                         const masu_scene_view *v, uint32_t *words) {
    const masu_drawn_plan *d = &plan->drawn;
    uint32_t large = 0;
    for (uint32_t b = 0; b < draws->batch_count; b++) {
        const masu_batch *batch = &draws->batches[b];
        uint32_t *to = words + d->batches + 4 * (uint64_t)b;
        to[0] = batch->first_listed;
        to[1] = batch->first_draw;
        to[2] = batch->draw_count;
        to[3] = (uint32_t)batch->triangles;
        if (batch->room > 64) words[d->large + large++] = b;
    }
    for (uint32_t o = 0; o < plan->scene.occluders; o++) {
        uint32_t *to = words + d->occluders + 6 * (uint64_t)o;
        memcpy(to, v->occluders[o].low, sizeof v->occluders[o].low);
        memcpy(to + 3, v->occluders[o].high, sizeof v->occluders[o].high);
    }
}

void masu_occlusion_write_scene(const masu_device *device, const masu_draws *draws,
                                const masu_scene_view *v) {
    const masu_frame_plan *plan = device->plan;
    if (!plan->occlusion) return;
    for (uint32_t slot = 0; slot < plan->desc.frames_in_flight; slot++) {
        uint32_t *words = drawn_words(device, slot);
        write_header(plan, draws->batch_count, words + plan->drawn.header);
        write_tables(plan, draws, v, words);
        for (uint32_t part = 0; part < MASU_ATLAS_PARTS(plan); part++) {
            VkDrawIndirectCommand box = {18, 0, 0, 0};
            memcpy(masu_buffer_pointer(device, MASU_BUFFER_DRAWS, slot) +
                       MASU_OCCLUDER_DRAW(plan, part),
                   &box, sizeof box);
        }
    }
}

/* ---- Each frame ------------------------------------------------------------------------------ */

void masu_occlusion_write_boxes(const masu_bounds *bounds, const masu_instances *in,
                                const masu_frame_data *f) {
    int all = masu_instances_rebased(in, f);
    if (!f->plan->occlusion || !(in->dirty_count || all)) return;
    uint32_t *to = drawn_words(f->device, f->slot) + f->plan->drawn.boxes;
    for (uint32_t i = 0; i < f->plan->scene.instances; i++) {
        float box[6];
        if (!masu_instance_dirty(in, i) && !all) continue;
        masu_bounds_of(bounds, i, box);
        for (uint32_t k = 0; k < 3; k++) box[k] = (float)((double)box[k] - f->origin[k]);
        memcpy(to + 6 * (uint64_t)i, box, sizeof box);
    }
}

/* Whether an instance occludes in the views of `marks`, at its current LOD. A fading one does
 * not in the camera's view, the first. */
static int occludes(const masu_visible *s, const masu_instances *in, const masu_frame_plan *plan,
                    uint32_t marks, uint32_t lods, uint32_t i) {
    if (!(s->marks[i] & marks) || (plan->lods && s->levels[i] > lods)) return 0;
    return !(marks & 1u) || !masu_look_fades(&in->looks, i);
}

/* Writes occluders that any view of `marks` keeps and that are in its range. */
static uint32_t write_pairs(const masu_occlusion *o, const masu_visible *s,
                            const masu_instances *in, const masu_frame_plan *plan, uint32_t marks,
                            uint32_t *to) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < plan->scene.occluders; k++) {
        const masu_placed_occluder *p = &o->occluders[k];
        for (uint32_t i = 0; i < p->instance_count; i++) {
            if (!occludes(s, in, plan, marks, p->lods, p->first_instance + i)) continue;
            to[2 * (uint64_t)n] = k;
            to[2 * (uint64_t)n++ + 1] = p->first_instance + i;
        }
        for (uint32_t i = masu_instances_added(in, p->mesh); i != MASU_BLOB_NONE;
             i = masu_instances_next(in, i)) {
            if (!occludes(s, in, plan, marks, p->lods, i)) continue;
            to[2 * (uint64_t)n] = k;
            to[2 * (uint64_t)n++ + 1] = i;
        }
    }
    return n;
}

/* For each view, the number of instances that stage 1 has kept, then these. The list is never read:
 * upload memory may be write-combined. */
static void write_kept(const masu_visible *s, const masu_frame_plan *plan, uint32_t *to) {
    uint64_t stride = (uint64_t)plan->scene.instances + 1;
    uint32_t counts[MASU_MAX_VIEWS] = {0}, all = (1u << plan->views) - 1u;
    for (uint32_t i = 0; i < plan->scene.instances; i++) {
        uint32_t marks = s->marks[i] & all;
        for (uint32_t *kept = to, *count = counts; marks; marks >>= 1, kept += stride, count++) {
            if (marks & 1u) kept[++*count] = i;
        }
    }
    for (uint32_t view = 0; view < plan->views; view++) to[view * stride] = counts[view];
}

void masu_occlusion_write(masu_occlusion *o, masu_visible *s, const masu_instances *in,
                          const masu_views *views, const masu_frame_data *f) {
    const masu_frame_plan *plan = f->plan;
    const masu_drawn_plan *d = &plan->drawn;
    if (!masu_has_pass(&masu_frame_rung_plan(f)->active, MASU_PASS_CULL)) return;
    uint32_t *words = drawn_words(f->device, f->slot), *header = words + d->header;
    masu_occlusion_view stage2[MASU_MAX_VIEWS];
    memcpy(stage2, views->stage2, sizeof stage2);
    header[MASU_CULL_CUT] = f->cut != 0;
    for (uint32_t view = 0; view < plan->views; view++) {
        stage2[view].turn = o->turns[view];
        if (masu_view_draws(f, view)) o->turns[view] = (o->turns[view] + 1) % 5;
    }
    memcpy(header + MASU_CULL_HEADER, stage2, plan->views * sizeof *stage2);
    for (uint32_t part = 0; part < MASU_ATLAS_PARTS(plan); part++) {
        uint64_t pairs = 2 * (uint64_t)part * plan->scene.placed_occluders;
        uint32_t n = write_pairs(o, s, in, plan, part ? ~1u : 1u, words + d->pairs + pairs);
        unsigned char *draw =
            masu_frame_slot(f, MASU_BUFFER_DRAWS) + MASU_OCCLUDER_DRAW(plan, part);
        memcpy(draw + offsetof(VkDrawIndirectCommand, instanceCount), &n, sizeof n);
        s->slot_views[f->slot][part].occluders = n;
    }
    write_kept(s, plan, words + d->kept);
}
