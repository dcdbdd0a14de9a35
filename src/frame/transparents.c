/* transparents.c: draws transparent things in the order of their distance with static recordings.
 *
 * The recordings have one slot for each thing of the scene. Slot k draws the k-th farthest. It
 * has one indirect command for each texture set that things use; all commands of a slot except its
 * thing's have instanceCount 0. The vertex shader reads the slot's instance and material from the
 * buffer of drawn instances. Both buffers are written here for each frame:
 *
 *   draw commands      after those of visible.c: [slot][texture set]
 *   drawn instances    after its lists: [slot] instance, material, flags, layers, detail, and
 *                      with depth biases the factor on its depth
 *
 * Things outside the camera's view are culled, and the last slots are empty. The order is by the
 * boxes' centres: for intersecting things, or a large pane and a thing close to it, no order of
 * whole things is correct. Rejected alternative: to sort by the nearest point of the box; a wide
 * pane behind a small one would often be drawn last. */
#include "frame/transparents.h"

#include <math.h>
#include <string.h>

/* Runs of 1, 2, 4, ... are merged from one array to the other. */
masu_back_to_front *masu_sort_back_to_front(masu_back_to_front *entries,
                                            masu_back_to_front *scratch, uint32_t n) {
    masu_back_to_front *from = entries, *to = scratch;
    for (uint32_t run = 1; run < n; run *= 2) {
        for (uint32_t start = 0; start < n; start += 2 * run) {
            uint32_t middle = n - start < run ? n : start + run;
            uint32_t end = n - start < 2 * run ? n : start + 2 * run;
            uint32_t a = start, b = middle;
            for (uint32_t i = start; i < end; i++) {
                int left = a < middle && (b >= end || from[a].key >= from[b].key);
                to[i] = left ? from[a++] : from[b++];
            }
        }
        masu_back_to_front *swap = from;
        from = to;
        to = swap;
    }
    return from;
}

void masu_transparents_alloc(masu_transparents *s, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t count = plan->scene.transparents;
    s->things = masu_arena_alloc(arena, "transparents", count, sizeof *s->things, 4);
    s->nearer = NULL;
    if (plan->scene.depth_biases)
        s->nearer = masu_arena_alloc(arena, "depth biases", count, sizeof *s->nearer, 4);
    s->order =
        masu_arena_alloc(arena, "transparents sorted", 2 * (uint64_t)count, sizeof *s->order, 4);
}

/* Which of the texture sets is a material's. */
static uint32_t column_of(const masu_draws *draws, const masu_blob_material *material) {
    uint32_t i = 0;
    if (!(material->flags & MASU_MATERIAL_HAS_MAPS)) return 0;
    while (i < draws->transparent_set_count && draws->transparent_sets[i] != material->texture_set)
        i++;
    return i;
}

static void copy_primitive(masu_transparent *t, const masu_draws *draws, uint32_t instance,
                           int mirrored, const masu_blob_primitive *p,
                           const masu_blob_material *material) {
    *t = (masu_transparent){
        .draw = {p->index_count, 1, p->first_index, (int32_t)p->first_vertex, 0},
        .instance = instance,
        .material = p->material,
        .flags = material->flags | material->more_layers << MASU_MAP_OCCLUSION_SHIFT,
        .layers = material->layers,
        .detail = {material->detail[0], material->detail[1]},
        .column = column_of(draws, material)};
    if (mirrored) t->flags &= ~(uint32_t)MASU_MATERIAL_IS_SINGLE;
    int flat = 0;
    for (uint32_t k = 0; k < 3; k++) flat |= !(p->aabb_min[k] < p->aabb_max[k]);
    if (!flat) { /* transparents.frag explains it */
        t->flags |= MASU_MAP_FAR_SIDE_FIRST;
        t->draw.instanceCount = 2;
    }
    for (uint32_t k = 0; k < 3; k++) t->center[k] = 0.5f * p->aabb_min[k] + 0.5f * p->aabb_max[k];
}

void masu_transparents_copy_scene(masu_transparents *s, const masu_frame_plan *plan,
                                  const masu_draws *draws, const masu_scene_view *v) {
    masu_transparent *next = s->things;
    if (!plan->needs.transparents) return;
    for (uint32_t i = 0; i < masu_own_instances(plan); i++) {
        const masu_blob_mesh *mesh = &v->meshes[v->instances[i].mesh];
        for (uint32_t k = 0; k < mesh->primitive_count; k++) {
            const masu_blob_primitive *p = &v->primitives[mesh->first_primitive + k];
            const masu_blob_material *material = &v->materials[p->material];
            if (!(material->flags & MASU_MATERIAL_IS_BLEND)) continue;
            if (s->nearer) s->nearer[next - s->things] = 1.0f + material->depth_bias;
            copy_primitive(next++, draws, i, masu_is_mirrored(v->instances[i].transform), p,
                           material);
        }
    }
    masu_transparent *end = s->things + plan->scene.transparents;
    for (; next < end; next++) *next = (masu_transparent){.instance = MASU_BLOB_NONE};
}

void masu_transparents_copy(masu_transparents *s, const masu_frame_plan *plan, uint32_t place,
                            uint32_t from, uint32_t to) {
    masu_transparent *next = s->things + masu_own_transparents(plan) +
                             (uint64_t)place * plan->reserve.place.transparents;
    masu_transparent *end = next + plan->reserve.place.transparents;
    if (!plan->needs.transparents) return;
    while (next < end && next->instance != MASU_BLOB_NONE) next++;
    for (uint32_t i = 0; i < plan->scene.transparents && next < end; i++) {
        if (s->things[i].instance != from) continue;
        *next = s->things[i];
        if (s->nearer) s->nearer[next - s->things] = s->nearer[i];
        (next++)->instance = to;
    }
}

void masu_transparents_clear(masu_transparents *s, const masu_frame_plan *plan, uint32_t place) {
    uint32_t each = plan->needs.transparents ? plan->reserve.place.transparents : 0;
    masu_transparent *first = s->things + masu_own_transparents(plan) + (uint64_t)place * each;
    for (uint32_t i = 0; i < each; i++) first[i].instance = MASU_BLOB_NONE;
}

/* Squared distance from the camera to the centre of a thing's box: finite, since both are
 * finite. */
static float distance_of(const masu_transparent *t, const masu_instances *in, const double eye[3]) {
    const struct masu_instance_data *at = &in->now[t->instance];
    const float *rows[3] = {at->row0, at->row1, at->row2};
    double square = 0.0, position[3];
    masu_instance_position(in, t->instance, position);
    for (uint32_t k = 0; k < 3; k++) {
        double d = position[k] - eye[k];
        for (uint32_t j = 0; j < 3; j++) d += (double)rows[k][j] * (double)t->center[j];
        square += d * d;
    }
    return (float)fmin(square, 3e38);
}

void masu_transparents_write(masu_transparents *s, const masu_instances *in,
                             const masu_visible *visible, const masu_frame_data *f) {
    uint32_t count = f->draws->transparent_count, seen = 0;
    s->slot_count[f->slot] = 0;
    if (!count) return;
    for (uint32_t i = 0; i < count; i++) {
        const masu_transparent *t = &s->things[i];
        if (t->instance == MASU_BLOB_NONE || !(visible->marks[t->instance] & 1u)) continue;
        s->order[seen++] = (masu_back_to_front){distance_of(t, in, f->eye), i};
    }
    const masu_back_to_front *order = masu_sort_back_to_front(s->order, s->order + count, seen);
    /* Never read: upload memory may be write-combined. */
    VkDrawIndexedIndirectCommand *draws =
        (VkDrawIndexedIndirectCommand *)(void *)(masu_frame_slot(f, MASU_BUFFER_DRAWS) +
                                                 f->plan->transparent_draws * MASU_DRAW_BYTES);
    uint32_t *words =
        (uint32_t *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWN) + f->plan->drawn.transparents;
    uint32_t columns = f->plan->scene.transparent_sets;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t number = k < seen ? order[k].thing : 0;
        const masu_transparent *t = &s->things[number];
        for (uint32_t c = 0; c < columns; c++) {
            VkDrawIndexedIndirectCommand draw = t->draw;
            draw.instanceCount = k < seen && c == t->column ? t->draw.instanceCount : 0;
            *draws++ = draw;
        }
        uint32_t thing[MASU_TRANSPARENT_WORDS_MAX] = {t->instance, t->material, t->flags,
                                                      t->layers};
        memcpy(thing + 4, t->detail, sizeof t->detail);
        if (s->nearer) memcpy(thing + 6, &s->nearer[number], sizeof *s->nearer);
        memcpy(words, thing, masu_transparent_words(f->plan) * sizeof *words);
        words += masu_transparent_words(f->plan);
    }
    s->sorted = order;
    s->slot_count[f->slot] = seen;
}
