/* occlusion.c: the host's part of stage 2 of culling: placed occluders, and the words that
 * shaders/occluders.vert, cull.comp and compact.comp read (masu_shared.h, MASU_CULL_*). They lie
 * behind the lists of stage 1 in the same buffer, one slot per frame in flight: a GPU may then write
 * what it reads next, and a stage has six storage buffers and not more.
 *
 * Nothing is read back. What the GPU remembers from frame to frame is only whether an instance was
 * visible when it was last asked; see cull.comp for why that may be wrong. */
#include "renderer.h"

#include <string.h>

static uint32_t *drawn_words(const masu_renderer *m, uint32_t slot) {
    return (uint32_t *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWN, slot);
}

/* ---- Once per scene -------------------------------------------------------------------------- */

void masu_keep_occluders(masu_renderer *m, const masu_scene_view *v) {
    uint32_t from = 0, first = 0, end = 0;
    for (uint32_t o = 0; o < m->plan.scene.occluders; o++) {
        uint32_t mesh = v->occluders[o].mesh;
        if (!o || mesh != v->occluders[o - 1].mesh) {
            end = masu_scene_mesh_instances(v, m->plan.scene.instances, mesh, from, &first);
            from = end;
        }
        m->occluders[o] = (masu_placed_occluder){first, end - first, v->occluders[o].lods};
    }
    masu_cull_box all = {{0, 0, 0}, {0, 0, 0}};
    for (uint32_t p = 0; p < m->plan.scene.instances; p++) {
        masu_cull_box pair[2] = {all, all};
        for (uint32_t k = 0; k < 3; k++) {
            pair[1].center[k] = m->boxes[k * m->box_stride + p];
            pair[1].half[k] = m->boxes[(3 + k) * m->box_stride + p];
        }
        masu_cull_box both = masu_cull_around(p ? pair : pair + 1, p ? 2 : 1);
        if (both.half[0] <= MASU_CULL_FAR && both.half[1] <= MASU_CULL_FAR &&
            both.half[2] <= MASU_CULL_FAR) {
            all = both;
        }
    }
    m->scene_box = all;
}

/* What stays the same in every frame, in every slot. */
void masu_write_occluders(masu_renderer *m, const masu_scene_view *v) {
    const masu_drawn_plan *d = &m->plan.drawn;
    if (!m->plan.occlusion) return;
    for (uint32_t slot = 0; slot < m->plan.desc.frames_in_flight; slot++) {
        uint32_t *words = drawn_words(m, slot), *header = words + d->header, large = 0;
        memset(header, 0, MASU_CULL_HEADER * sizeof *header);
        header[MASU_CULL_VIEWS] = m->plan.views;
        header[MASU_CULL_INSTANCES] = m->plan.scene.instances;
        header[MASU_CULL_DRAWS] = m->plan.draws;
        header[MASU_CULL_RECEIVERS] = (uint32_t)m->plan.receivers;
        header[MASU_CULL_LISTED] = m->plan.listed;
        header[MASU_CULL_BATCH_COUNT] = m->batch_count;
        header[MASU_CULL_LISTS] = (uint32_t)d->lists;
        header[MASU_CULL_KEPT] = (uint32_t)d->kept;
        header[MASU_CULL_BATCHES] = (uint32_t)d->batches;
        header[MASU_CULL_LARGE] = (uint32_t)d->large;
        header[MASU_CULL_BOXES] = (uint32_t)d->boxes;
        header[MASU_CULL_OCCLUDERS] = (uint32_t)d->occluders;
        header[MASU_CULL_PAIRS] = (uint32_t)d->pairs;
        header[MASU_CULL_PAIR_COUNT] = m->plan.scene.placed_occluders;
        for (uint32_t b = 0; b < m->batch_count; b++) {
            const masu_batch *batch = &m->batches[b];
            uint32_t *to = words + d->batches + 4 * (uint64_t)b;
            to[0] = batch->first_listed;
            to[1] = batch->first_draw;
            to[2] = batch->draw_count;
            to[3] = (uint32_t)batch->triangles;
            if (batch->instance_count > 64) words[d->large + large++] = b;
        }
        for (uint32_t o = 0; o < m->plan.scene.occluders; o++) {
            uint32_t *to = words + d->occluders + 6 * (uint64_t)o;
            memcpy(to, v->occluders[o].low, sizeof v->occluders[o].low);
            memcpy(to + 3, v->occluders[o].high, sizeof v->occluders[o].high);
        }
        for (uint32_t part = 0; part < MASU_ATLAS_PARTS(&m->plan); part++) {
            VkDrawIndirectCommand box = {18, 0, 0, 0};
            memcpy(masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot) +
                       MASU_OCCLUDER_DRAW(&m->plan, part),
                   &box, sizeof box);
        }
    }
}

/* ---- Each frame ------------------------------------------------------------------------------ */

void masu_write_box(masu_renderer *m, uint32_t slot, uint32_t instance) {
    if (!m->plan.occlusion) return;
    uint32_t position = m->box_positions[instance] & ~MASU_BOX_MOVED;
    float box[6];
    for (uint32_t k = 0; k < 6; k++) box[k] = m->boxes[k * m->box_stride + position];
    memcpy(drawn_words(m, slot) + m->plan.drawn.boxes + 6 * (uint64_t)instance, box, sizeof box);
}

/* Occluders that any view of `marks` keeps, and that lie in what it draws. Those of hidden instances
 * too: what they hide is hidden anyway. */
static uint32_t write_pairs(masu_renderer *m, uint32_t marks, uint32_t *to) {
    uint32_t n = 0;
    for (uint32_t o = 0; o < m->plan.scene.occluders; o++) {
        const masu_placed_occluder *p = &m->occluders[o];
        for (uint32_t i = 0; i < p->instance_count; i++) {
            if (!(m->marks[p->first_instance + i] & marks)) continue;
            if (m->plan.lods && m->levels[p->first_instance + i] > p->lods) continue;
            to[2 * (uint64_t)n] = o;
            to[2 * (uint64_t)n++ + 1] = p->first_instance + i;
        }
    }
    return n;
}

void masu_write_stage2(masu_renderer *m, uint32_t slot, int cut) {
    const masu_drawn_plan *d = &m->plan.drawn;
    uint32_t *words = drawn_words(m, slot), *header = words + d->header;
    header[MASU_CULL_CUT] = cut != 0;
    for (uint32_t view = 0; view < m->plan.views; view++) {
        m->stage2[view].turn = m->turns[view];
        if (masu_view_draws(m, view)) m->turns[view] = (m->turns[view] + 1) % 5;
    }
    memcpy(header + MASU_CULL_HEADER, m->stage2, m->plan.views * sizeof *m->stage2);
    for (uint32_t part = 0; part < MASU_ATLAS_PARTS(&m->plan); part++) {
        uint64_t pairs = 2 * (uint64_t)part * m->plan.scene.placed_occluders;
        uint32_t n = write_pairs(m, part ? ~1u : 1u, words + d->pairs + pairs);
        unsigned char *draw =
            masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot) + MASU_OCCLUDER_DRAW(&m->plan, part);
        memcpy(draw + offsetof(VkDrawIndirectCommand, instanceCount), &n, sizeof n);
        m->slot_views[slot][part].occluders = n;
    }
    for (uint32_t view = 0; view < m->plan.views; view++) {
        /* All that stage 1 has kept, one after the other. */
        uint32_t *kept = words + d->kept + view * ((uint64_t)m->plan.scene.instances + 1),
                 count = 0;
        for (uint32_t i = 0; i < m->plan.scene.instances; i++) {
            if (m->marks[i] >> view & 1u) kept[++count] = i;
        }
        kept[0] = count;
    }
}
