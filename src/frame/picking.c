/* picking.c: see picking.h. */
#include "frame/picking.h"

#include "base/error.h"
#include "device/bind.h"

#include <string.h>

#define MARK 0x80u /* in the marks of visible.h, which have a bit for each view */
_Static_assert(MASU_MAX_VIEWS <= 7, "marks have a bit for the picked pixel");

void masu_picking_alloc(masu_picking *p, masu_arena *arena, const masu_frame_plan *plan) {
    p->group_states =
        masu_arena_alloc(arena, "group states of the picked pixel",
                         plan->needs.picking ? plan->scene.groups : 0, sizeof *p->group_states, 1);
    p->added =
        masu_arena_alloc(arena, "first frames of copies",
                         plan->needs.picking ? plan->reserve.models + plan->reserve.meshes : 0,
                         sizeof *p->added, 8);
}

static unsigned char *draws_of(const masu_device *device, uint32_t slot) {
    return masu_buffer_pointer(device, MASU_BUFFER_DRAWS, slot) +
           device->plan->pick_draws * MASU_DRAW_BYTES;
}

void masu_picking_write_scene(const masu_device *device, const masu_draws *draws,
                              const masu_scene_view *v) {
    const masu_frame_plan *plan = device->plan;
    if (!plan->needs.picking || !draws->batch_count) return;
    for (uint32_t slot = 0; slot < plan->desc.frames_in_flight; slot++)
        masu_draws_write(draws, v, plan,
                         (VkDrawIndexedIndirectCommand *)(void *)draws_of(device, slot));
}

masu_result masu_picking_read(masu_frame_data *f, masu_detail *detail) {
    const masu_frame_desc *d = &f->desc;
    const VkExtent2D shown = f->plan->desc.output;
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    if (!d->pick) return MASU_OK;
    if (!f->plan->needs.picking) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "pick", 1, 0,
                         "pick is set, needed is desc.picking");
    }
    if (d->pick_x >= shown.width || d->pick_y >= shown.height) {
        return masu_fail(
            detail, MASU_ERROR_ARGUMENT, "pick_x", shown.width, d->pick_x,
            "pick_x, pick_y is %u, %u, allowed are pixels of the output, which is %ux%u", d->pick_x,
            d->pick_y, shown.width, shown.height);
    }
    /* The render pixel that contains the centre of the output pixel. */
    uint64_t x = (2 * (uint64_t)d->pick_x + 1) * rp->render_width / (2 * (uint64_t)shown.width);
    uint64_t y = (2 * (uint64_t)d->pick_y + 1) * rp->render_height / (2 * (uint64_t)shown.height);
    f->u.temporal[3] = (uint32_t)x | (uint32_t)y << 16;
    return MASU_OK;
}

/* The pyramid of the block of 2x2 pixels and a pixel around it: pick.vert's matrix, halved
 * across. */
static void set_pixel_view(masu_cull_view *view, const masu_frame_data *f) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    const float *from = f->u.clip_from_rel;
    const double half[2] = {0.5 * (double)rp->render_width, 0.5 * (double)rp->render_height};
    const uint32_t pixel[2] = {f->u.temporal[3] & 0xFFFFu, f->u.temporal[3] >> 16};
    float clip[16];
    memcpy(clip, from, sizeof clip);
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < 2; i++) {
            double middle = (double)(pixel[i] & ~1u) + 1.0;
            clip[4 * k + i] = (float)(0.5 * ((double)from[4 * k + i] * half[i] +
                                             (double)from[4 * k + 3] * (half[i] - middle)));
        }
    }
    masu_cull_camera(view, clip, f->eye, f->u.forward[3]);
}

static void list_one(const masu_visible *visible, const masu_instances *in,
                     const masu_frame_data *f, const masu_batch *mesh, uint32_t i, uint32_t *ids,
                     uint32_t *kept) {
    if ((visible->marks[i] & (MARK | 1u)) != (MARK | 1u)) return;
    if (masu_look_unpicked(&in->looks, i, f->desc.pick_mask)) return;
    uint32_t level = f->plan->lods ? visible->levels[i] : 0;
    ids[mesh[level].first_listed + kept[level]++] = i;
}

/* Those near the pixel, into the lists and counts of their forms; without: no counts. */
static void list(const masu_visible *visible, const masu_instances *in, const masu_frame_data *f) {
    VkDrawIndexedIndirectCommand *draws =
        (VkDrawIndexedIndirectCommand *)(void *)draws_of(f->device, f->slot);
    uint32_t *ids =
        (uint32_t *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWN) + f->plan->drawn.picks;
    for (uint32_t b = 0, forms; b < f->draws->batch_count; b += forms) {
        const masu_batch *mesh = &f->draws->batches[b];
        uint32_t kept[1 + MASU_BLOB_LODS_MAX] = {0};
        uint32_t end = mesh->first_instance + mesh->instance_count;
        forms = 1 + mesh->lod_count;
        for (uint32_t i = mesh->first_instance; f->desc.pick && i < end; i++)
            list_one(visible, in, f, mesh, i, ids, kept);
        for (uint32_t i = masu_instances_added(in, mesh->mesh); f->desc.pick && i != MASU_BLOB_NONE;
             i = masu_instances_next(in, i))
            list_one(visible, in, f, mesh, i, ids, kept);
        for (uint32_t level = 0; level < forms; level++) {
            const masu_batch *batch = &mesh[level];
            for (uint32_t d = 0; d < batch->draw_count; d++)
                draws[batch->first_draw + d].instanceCount = kept[level];
        }
    }
}

void masu_picking_write(masu_picking *p, masu_visible *visible, const masu_bounds *bounds,
                        const masu_instances *in, const masu_frame_data *f) {
    if (!f->plan->needs.picking) return;
    masu_picking_slot *slot = &p->slots[f->slot];
    *slot = (masu_picking_slot){f->desc.pick != 0, f->desc.pick_x, f->desc.pick_y, {0, 0, 0}};
    memcpy(slot->eye, f->eye, sizeof slot->eye);
    if (!f->plan->scene.instances) return;
    if (f->desc.pick) {
        masu_cull_view view;
        masu_cull_set set = masu_bounds_set(bounds, &f->plan->scene);
        masu_cull_counts counts = {0, 0};
        set_pixel_view(&view, f);
        masu_cull(&set, &view, p->group_states, visible->marks, MARK, &counts);
    }
    list(visible, in, f);
}
