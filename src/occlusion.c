/* occlusion.c: the host's part of stage 2 of culling: views, placed occluders, and the words that
 * shaders/occluders.vert, cull.comp and compact.comp read (masu_shared.h, MASU_CULL_*). They lie
 * behind the lists of stage 1 in the same buffer, one slot per frame in flight: a GPU may then write
 * what it reads next, and a device needs no more than four storage buffers in a stage.
 *
 * Nothing is read back. What the GPU remembers from frame to frame is only whether an instance was
 * visible when it was last asked; see cull.comp for why that may be wrong. */
#include "renderer.h"

#include <math.h>
#include <string.h>

static uint32_t *drawn_words(const masu_renderer *m, uint32_t slot) {
    return (uint32_t *)(void *)masu_buffer_pointer(m, MASU_BUFFER_DRAWN, slot);
}

/* ---- Views ----------------------------------------------------------------------------------- */

VkRect2D masu_atlas_part(uint32_t part) {
    if (part) return (VkRect2D){{0, MASU_ATLAS_CAMERA_HEIGHT}, {MASU_ATLAS_SUN, MASU_ATLAS_SUN}};
    return (VkRect2D){{0, 0}, {MASU_ATLAS_CAMERA_WIDTH, MASU_ATLAS_CAMERA_HEIGHT}};
}

/* A box along the sun's direction, which is its last axis. It reaches from the centre `half` across it,
 * `behind` away from the sun and `ahead` towards it: how far that is may be more than the position
 * of a middle could bear. */
typedef struct sun_box {
    double axis[3][3], center[3], half[2], behind, ahead;
} sun_box;

static double along(const double axis[3], const double p[3]) {
    return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
}

/* All of the scene as it was baked. */
static sun_box around_scene(const masu_renderer *m, const float sun[3]) {
    sun_box b;
    double towards[3], half[3] = {1e-6, 1e-6, 1e-6};
    for (uint32_t i = 0; i < 3; i++) towards[i] = (double)sun[i];
    masu_shadow_axes(towards, b.axis);
    for (uint32_t i = 0; i < 3; i++) {
        b.center[i] = (double)m->scene_box.center[i];
        for (uint32_t j = 0; j < 3; j++)
            half[i] += fabs(b.axis[i][j]) * 1.001 * (double)m->scene_box.half[j];
    }
    b.half[0] = half[0];
    b.half[1] = half[1];
    b.behind = b.ahead = half[2];
    return b;
}

static sun_box around_cascade(const masu_cascade *c) {
    sun_box b;
    memcpy(b.axis, c->axis, sizeof b.axis);
    memcpy(b.center, c->center, sizeof b.center);
    b.half[0] = b.half[1] = c->half;
    b.behind = c->behind;
    b.ahead = c->ahead;
    return b;
}

/* The least box around two of the same axes. */
static sun_box around_both(const sun_box *a, const sun_box *b) {
    sun_box both = *a;
    double apart[3];
    for (uint32_t i = 0; i < 3; i++) apart[i] = b->center[i] - a->center[i];
    for (uint32_t i = 0; i < 2; i++) {
        double at = along(a->axis[i], apart);
        double low = fmin(-a->half[i], at - b->half[i]), high = fmax(a->half[i], at + b->half[i]);
        both.half[i] = 0.5 * (high - low);
        for (uint32_t k = 0; k < 3; k++) both.center[k] += a->axis[i][k] * 0.5 * (high + low);
    }
    both.behind = fmax(a->behind, b->behind - along(a->axis[2], apart));
    both.ahead = fmax(a->ahead, b->ahead + along(a->axis[2], apart));
    return both;
}

/* Its planes, but for the one on the side of the sun: nothing there may be left out. */
static void set_planes(const sun_box *b, masu_cull_view *view) {
    view->count = 0;
    for (uint32_t plane = 0; plane < 5; plane++) {
        double n[3], sign = plane % 2 ? -1.0 : 1.0, reach = plane < 4 ? b->half[plane / 2] : b->behind;
        for (uint32_t k = 0; k < 3; k++) n[k] = sign * b->axis[plane / 2][k];
        masu_cull_add_plane(view, n, reach - along(n, b->center));
    }
}

/* Depth is 1 at the side of the sun. */
static void look_from_sun(const sun_box *b, const double eye[3], masu_stage2_view *v) {
    for (uint32_t row = 0; row < 3; row++) {
        double scale = 1.0 / (row == 2 ? b->behind + b->ahead : b->half[row]);
        double offset = row == 2 ? b->behind * scale : 0.0;
        for (uint32_t i = 0; i < 3; i++) {
            v->clip[4 * i + row] = (float)(scale * b->axis[row][i]);
            offset += scale * b->axis[row][i] * (eye[i] - b->center[i]);
        }
        v->clip[12 + row] = (float)offset;
    }
    v->clip[15] = 1.0f;
    for (uint32_t i = 0; i < 3; i++) v->eye[i] = (float)b->axis[2][i];
    v->blind = -1.0f;
}

static void set_atlas(masu_stage2_view *v, uint32_t part) {
    VkRect2D area = masu_atlas_part(part);
    v->atlas[0] = (float)area.offset.x;
    v->atlas[1] = (float)area.offset.y;
    v->atlas[2] = (float)area.extent.width;
    v->atlas[3] = (float)area.extent.height;
}

/* The sun's views share one part of the atlas, a square around all that this frame draws. Cascades
 * lie inside of each other, so that what hides something in the part hides it in each of them; but a
 * cascade moves surfaces away from the sun, and so a mesh may be a little behind its occluder. */
static void set_suns(masu_renderer *m, const float sun[3], const double eye[3], float step) {
    sun_box boxes[MASU_CASCADES_MAX], all;
    uint32_t suns = m->plan.views - 1, any = 0;
    for (uint32_t k = 0; k < suns; k++) {
        if (m->plan.needs.shadow && !(m->drawn >> k & 1u)) continue;
        boxes[k] = m->plan.needs.shadow ? around_cascade(&m->cascades[k]) : around_scene(m, sun);
        set_planes(&boxes[k], &m->view_planes[1 + k]);
        all = any ? around_both(&all, &boxes[k]) : boxes[k];
        any = 1;
    }
    if (!any || !m->plan.occlusion) return;
    all.half[0] = all.half[1] = fmax(all.half[0], all.half[1]);
    masu_stage2_view shared = m->stage2[1];
    set_atlas(&shared, 1);
    look_from_sun(&all, eye, &shared);
    for (uint32_t k = 0; k < suns; k++) {
        double texel = 2.0 * all.half[0] / MASU_ATLAS_SUN;
        double drawn = m->plan.needs.shadow ? 2.0 * m->cascades[k].half / m->cascades[k].size : texel;
        double bias = m->plan.needs.shadow ? MASU_SHADOW_BIAS_MOST * drawn : 0.0;
        shared.margin = (float)((double)step * drawn / texel);
        shared.bias = (float)(bias / (all.behind + all.ahead) + 2e-6);
        m->stage2[1 + k] = shared;
    }
}

/* Lengths of one at depth one, in pixels: of the two axes the one of more. */
static void set_lods(masu_renderer *m, const struct masu_frame_uniforms *u, const double eye[3],
                     uint32_t rung) {
    const masu_rung_plan *rp = &m->plan.rungs[rung];
    float x = 0.5f * (float)rp->render_width / u->right[3];
    float y = 0.5f * (float)rp->render_height / u->up[3];
    m->lod_view.pixels = x > y ? x : y;
    m->lod_view.widest = 1.0 / sqrt(1.0 + (double)u->right[3] * (double)u->right[3] +
                                    (double)u->up[3] * (double)u->up[3]);
    m->lod_view.threshold = m->plan.desc.rungs[rung].lod_error;
    for (uint32_t k = 0; k < 3; k++) {
        m->lod_view.eye[k] = eye[k];
        m->lod_view.forward[k] = (double)u->forward[k];
    }
}

void masu_set_views(masu_renderer *m, const struct masu_frame_uniforms *u, const double eye[3],
                    uint32_t rung) {
    set_lods(m, u, eye, rung);
    masu_cull_camera(&m->view_planes[0], u->clip_from_rel, eye, u->forward[3]);
    memset(m->stage2, 0, sizeof m->stage2);
    /* How far the raster may move an edge, in its own texels. */
    float step = ldexpf(1.0f, -(int)m->vk.properties.limits.subPixelPrecisionBits);
    set_suns(m, u->sun_direction, eye, step);
    masu_stage2_view *v = &m->stage2[0];
    set_atlas(v, 0);
    memcpy(v->clip, u->clip_from_rel, sizeof v->clip);
    float across = v->atlas[2] / (float)m->plan.rungs[rung].render_width;
    float down = v->atlas[3] / (float)m->plan.rungs[rung].render_height;
    v->margin = step * (across > down ? across : down);
    v->eye[3] = 1.0f;
    v->near_distance = u->forward[3];
    v->blind = 1.001f * u->forward[3] *
               sqrtf(1.0f + u->right[3] * u->right[3] + u->up[3] * u->up[3]);
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
    header[MASU_CULL_FRAME] = (uint32_t)(m->frame % 5);
    header[MASU_CULL_CUT] = cut != 0;
    memcpy(header + MASU_CULL_HEADER, m->stage2, m->plan.views * sizeof *m->stage2);
    for (uint32_t part = 0; part < MASU_ATLAS_PARTS(&m->plan); part++) {
        uint64_t pairs = 2 * (uint64_t)part * m->plan.scene.placed_occluders;
        uint32_t n = write_pairs(m, part ? ~1u : 1u, words + d->pairs + pairs);
        unsigned char *draw = masu_buffer_pointer(m, MASU_BUFFER_DRAWS, slot) +
                              MASU_OCCLUDER_DRAW(&m->plan, part);
        memcpy(draw + offsetof(VkDrawIndirectCommand, instanceCount), &n, sizeof n);
        m->slot_views[slot][part].occluders = n;
    }
    for (uint32_t view = 0; view < m->plan.views; view++) {
        /* All that stage 1 has kept, one after the other. */
        uint32_t *kept = words + d->kept + view * ((uint64_t)m->plan.scene.instances + 1), count = 0;
        for (uint32_t i = 0; i < m->plan.scene.instances; i++) {
            if (m->marks[i] >> view & 1u) kept[++count] = i;
        }
        kept[0] = count;
    }
}
