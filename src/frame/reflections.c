/* reflections.c: see reflections.h. */
#include "frame/reflections.h"

#include "device/ray_query.h"
#include "scene/trace_scene.h"

#include <math.h>
#include <string.h>

/* ---- Traced instances ------------------------------------------------------------------------ */

void masu_reflections_alloc(masu_reflections *s, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t traced = plan->needs.traced ? plan->scene.trace_instances : 0;
    uint64_t tree = traced && !plan->needs.query ? masu_trace_top_bytes(traced) : 0;
    s->tree_memory = masu_arena_alloc(arena, "traced instances", tree, 1, 16);
    s->traced = masu_arena_alloc(arena, "traced ids", traced, sizeof *s->traced, 4);
    s->bends = NULL;
    if (plan->scene.skins || plan->reserve.meshes)
        s->bends = masu_arena_alloc(arena, "traced skins", traced, sizeof *s->bends, 1);
    s->live =
        masu_arena_alloc(arena, "traced flags", plan->needs.query ? traced : 0, sizeof *s->live, 1);
}

void masu_reflections_copy_scene(masu_reflections *s, const masu_frame_plan *plan,
                                 const masu_scene_view *v) {
    uint32_t count = plan->scene.trace_instances, own = masu_own_traced(plan);
    if (!plan->needs.traced) return;
    for (uint32_t i = 0; i < count; i++)
        s->traced[i] = i < own ? v->trace_instances[i] : MASU_BLOB_NONE;
    for (uint32_t i = 0; i < count && s->bends; i++)
        s->bends[i] = plan->reserve.meshes && i >= masu_mesh_traced(plan);
    for (uint32_t n = 0; n < masu_own_nodes(plan) && plan->scene.skins; n++) {
        for (uint32_t i = 0; i < own && v->model_nodes[n].skin; i++)
            s->bends[i] |= v->trace_instances[i] == v->model_nodes[n].instance;
    }
    if (plan->needs.query) return;
    masu_trace_top_init(&s->tree, s->tree_memory, count);
    for (uint32_t i = 0; i < own; i++) {
        masu_trace_root root = masu_trace_root_of(v, i);
        masu_trace_top_set(&s->tree, i, &root);
    }
}

/* The range of traced instances in a slot: the first, and the end. */
static uint32_t traced_of(const masu_frame_plan *plan, uint32_t place, uint32_t *end) {
    uint32_t first = masu_own_traced(plan) + place * plan->reserve.place.traced;
    *end = plan->needs.traced ? first + plan->reserve.place.traced : first;
    return first;
}

void masu_reflections_copy(masu_reflections *s, const masu_frame_plan *plan, uint32_t place,
                           uint32_t from, uint32_t to) {
    uint32_t end, next = traced_of(plan, place, &end);
    while (next < end && s->traced[next] != MASU_BLOB_NONE) next++;
    for (uint32_t i = 0; i < plan->scene.trace_instances && next < end; i++) {
        if (s->traced[i] != from) continue;
        s->traced[next] = to;
        if (!plan->needs.query) {
            masu_trace_root root = *masu_trace_top_root(&s->tree, i);
            root.instance = to;
            masu_trace_top_set(&s->tree, next, &root);
        }
        return;
    }
}

void masu_reflections_clear(masu_reflections *s, const masu_frame_plan *plan, uint32_t place) {
    uint32_t end, next = traced_of(plan, place, &end);
    for (; next < end; next++) s->traced[next] = MASU_BLOB_NONE;
}

void masu_reflections_set_mesh(masu_reflections *s, const masu_frame_plan *plan, uint32_t slot,
                               uint32_t instance, uint32_t node) {
    uint32_t traced = masu_mesh_traced(plan) + slot;
    if (!plan->needs.traced) return;
    const masu_trace_root root = {.node = node, .instance = instance};
    s->traced[traced] = instance;
    masu_trace_top_set(&s->tree, traced, &root);
}

void masu_reflections_clear_mesh(masu_reflections *s, const masu_frame_plan *plan, uint32_t slot) {
    if (plan->needs.traced) s->traced[masu_mesh_traced(plan) + slot] = MASU_BLOB_NONE;
}

static const double zero[3] = {0, 0, 0};

static int origin_moved(const masu_reflections *s) {
    return memcmp(s->previous_origin, s->origin, sizeof s->origin) != 0;
}

/* Updates the transforms of moved instances, or of all if none has been written yet. With double
 * positions they are relative to the origin, so all are updated when it moves. */
static void place(masu_reflections *s, const masu_instances *in, const masu_bounds *b,
                  const masu_frame_data *f) {
    int all = !s->versions || (in->low && origin_moved(s));
    if (!in->dirty_count && !all) return;
    for (uint32_t i = 0; i < f->plan->scene.trace_instances; i++) {
        uint32_t instance = s->traced[i];
        int none = instance == MASU_BLOB_NONE;
        if (!none && !masu_instance_dirty(in, instance) && !all) continue;
        float rows[12] = {0}; /* not traced: hidden instances have no transform */
        if (!none && !masu_instance_hidden(in, instance) &&
            !masu_look_untraced(&in->looks, instance))
            masu_instance_rows_from(&in->now[instance], in->low ? in->low[instance] : NULL,
                                    in->low ? s->origin : zero, rows);
        if (!none && s->bends && s->bends[i]) { /* its box changes */
            masu_trace_root *root = masu_trace_top_root(&s->tree, i);
            memcpy(root->box.low, b->meshes[in->meshes[instance]], sizeof root->box.low);
            memcpy(root->box.high, b->meshes[in->meshes[instance]] + 3, sizeof root->box.high);
        }
        if (f->plan->needs.query)
            s->live[i] = (uint8_t)masu_trace_places(rows);
        else
            /* instances without an inverse are not traced */
            (void)masu_trace_top_place(&s->tree, i, rows);
    }
}

/* Whether what instances are measured from, or the tree over them, has changed. */
static int update(masu_reflections *s, const masu_instances *in, const masu_frame_data *f) {
    int moved = origin_moved(s);
    memcpy(s->previous_origin, s->origin, sizeof s->origin);
    if (!f->plan->needs.query)
        return masu_trace_top_update(&s->tree, in->low ? zero : s->origin) != MASU_TRACE_SAME;
    return moved;
}

static void rows_of(const struct masu_instance_data *from, const float *low,
                    const double origin[3], float to[3][4]) {
    float rows[12];
    masu_instance_rows_from(from, low, origin, rows);
    memcpy(to, rows, sizeof rows);
}

/* All of a slot, where anything has changed since it was written last: a frame in which nothing
 * moves writes nothing. */
void masu_reflections_write_instances(masu_reflections *s, const masu_instances *in,
                                      const masu_bounds *b, const masu_frame_data *f) {
    const masu_frame_plan *plan = f->plan;
    if (!plan->needs.traced) return;
    place(s, in, b, f);
    int changed = update(s, in, f);
    /* An instance that has moved is stationary one frame later, which changes its previous
     * transform. */
    if (changed || in->dirty_count || s->looks != in->looks.changes || !s->versions) s->versions++;
    s->looks = in->looks.changes;
    if (s->slot_version[f->slot] == s->versions) return;
    s->slot_version[f->slot] = s->versions;
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_TRACE_FRAME);
    uint64_t at = masu_trace_rows_at(&plan->scene, plan->needs.query);
    uint32_t header[4] = {0, 0, plan->scene.trace_instances, (uint32_t)(at / 16)};
    if (plan->needs.query)
        memcpy(to, header, sizeof header);
    else
        masu_trace_top_write(&s->tree, to);
    memcpy(to + 12, &header[3], 4);
    for (uint32_t i = 0; i < plan->scene.trace_instances; i++) {
        uint32_t instance = s->traced[i];
        /* of the reserve: not looked at */
        if (instance == MASU_BLOB_NONE) instance = masu_own_instances(plan);
        const struct masu_instance_data *now = &in->now[instance];
        const struct masu_instance_data *before =
            plan->needs.velocity ? &in->previous[instance] : now;
        const float *low = in->low ? in->low[instance] : NULL;
        float both[2][3][4];
        rows_of(now, low, s->origin, both[0]);
        int comes = f->cut || in->flags[instance] & MASU_INSTANCE_COMES;
        if (low && !comes && plan->needs.velocity) low = in->previous_low[instance];
        rows_of(comes ? now : before, low, s->origin, both[1]);
        memcpy(to + at + i * sizeof both, both, sizeof both);
        if (plan->needs.looks) {
            float look[4 * MASU_TRACE_LOOK_ROWS];
            masu_look_rows(&in->looks.now[instance], look);
            memcpy(to + at + plan->scene.trace_instances * sizeof both + i * sizeof look, look,
                   sizeof look);
        }
        if (plan->needs.query) {
            masu_ray_write_instance(f->device, f->slot, i, in->meshes[instance], s->live[i],
                                    both[0]);
        }
    }
}

/* ---- The frame ------------------------------------------------------------------------------- */

void masu_reflections_read(masu_reflections *s, masu_frame_data *f) {
    struct masu_frame_uniforms *u = &f->u;
    if (!f->plan->needs.reflections && !f->plan->needs.bounce) return;
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    masu_far_origin(f->eye, s->origin);
    for (uint32_t k = 0; k < 3; k++) {
        u->trace_anchor[k] = (float)s->origin[k];
        u->trace_eye[k] = (float)(f->eye[k] - s->origin[k]);
    }
    u->trace_anchor[3] = f->plan->scene.trace_distance;
    if (!f->cut && s->history) {
        u->history[1] = s->history_size[0];
        u->history[2] = s->history_size[1];
    }
    if (!s->full_history) u->history[3] |= MASU_HISTORY_NO_FINE;
    /* The history is valid if the previous frame stored it. */
    s->full_history = masu_has_pass(&rp->active, MASU_PASS_SPECULAR_KEEP_FINE);
    s->history = masu_has_pass(&rp->active, MASU_PASS_SPECULAR_KEEP) ||
                 masu_has_pass(&rp->active, MASU_PASS_SPECULAR_ACCUMULATE);
    s->history_size[0] = rp->render_width;
    s->history_size[1] = rp->render_height;
}
