/* instances.c: see instances.h. */
#include "frame/instances.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

void masu_instances_alloc(masu_instances *in, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t count = plan->scene.instances, before = plan->needs.velocity ? count : 0;
    in->now = masu_arena_alloc(arena, "instance transforms", count, sizeof *in->now, 16);
    in->previous = masu_arena_alloc(arena, "previous transforms", before, sizeof *in->previous, 16);
    in->names = masu_arena_alloc(arena, "instance names", count, sizeof *in->names, 8);
    in->meshes = masu_arena_alloc(arena, "instance meshes", count, sizeof *in->meshes, 4);
    in->flags = masu_arena_alloc(arena, "instance flags", count, sizeof *in->flags, 1);
    uint32_t reserve = plan->reserve.places.instances;
    in->low = in->previous_low = NULL;
    memset(in->slot_origin, 0, sizeof in->slot_origin);
    if (plan->desc.double_positions) {
        in->low = masu_arena_alloc(arena, "low positions", count, sizeof *in->low, 4);
        in->previous_low =
            masu_arena_alloc(arena, "previous low positions", count, sizeof *in->low, 4);
    }
    masu_looks_alloc(&in->looks, arena, plan);
    in->of_mesh = NULL;
    if (!reserve) return;
    in->of_mesh =
        masu_arena_alloc(arena, "reserve of meshes", plan->scene.meshes, sizeof *in->of_mesh, 4);
    in->next = masu_arena_alloc(arena, "reserve lists", reserve, sizeof *in->next, 4);
    in->lives = masu_arena_alloc(arena, "reserve instances", reserve, sizeof *in->lives, 4);
}

/* A transform must reach every slot when it is free. With velocities it is written once more,
 * because the slot of the frame that moved it still has a velocity. */
static uint8_t frames_to_write(const masu_frame_plan *plan) {
    return (uint8_t)(plan->desc.frames_in_flight + (plan->needs.velocity ? 1 : 0));
}

int masu_instance_moved(const masu_instances *in, const masu_frame_plan *plan, uint32_t i) {
    return masu_instance_dirty(in, i) == frames_to_write(plan);
}

/* Nothing is anywhere yet. */
static void init_reserve(masu_instances *in, const masu_frame_plan *plan) {
    for (uint32_t mesh = 0; mesh < plan->scene.meshes; mesh++) in->of_mesh[mesh] = MASU_BLOB_NONE;
    for (uint32_t i = in->own; i < plan->scene.instances; i++) {
        memset(&in->now[i], 0, sizeof in->now[i]);
        if (plan->needs.velocity) in->previous[i] = in->now[i];
        in->names[i] = in->meshes[i] = 0;
        if (i >= masu_mesh_instances(plan))
            in->meshes[i] = masu_own_meshes(plan) + i - masu_mesh_instances(plan);
        in->flags[i] = (uint8_t)(MASU_INSTANCE_HIDDEN | frames_to_write(plan));
        in->hidden_count++;
    }
}

void masu_instances_copy_scene(masu_instances *in, const masu_frame_plan *plan,
                               const masu_scene_view *v) {
    in->own = masu_own_instances(plan);
    if (in->low) {
        memset(in->low, 0, plan->scene.instances * sizeof *in->low);
        memset(in->previous_low, 0, plan->scene.instances * sizeof *in->low);
    }
    for (uint32_t i = 0; i < in->own; i++) {
        memcpy(&in->now[i], v->instances[i].transform, sizeof in->now[i]);
        if (plan->needs.velocity) in->previous[i] = in->now[i];
        in->names[i] = masu_scene_name_hash(v, v->instances[i].name);
        in->meshes[i] = v->instances[i].mesh;
        in->flags[i] = frames_to_write(plan);
    }
    in->handles = masu_handles_of(v->hash, MASU_HANDLE_INSTANCE, in->own,
                                  plan->reserve.places.instances, in->lives);
    in->dirty_count = plan->scene.instances;
    in->hidden_count = in->changes = 0;
    masu_looks_init(&in->looks, plan);
    if (plan->reserve.places.instances) init_reserve(in, plan);
}

void masu_instances_add(masu_instances *in, uint32_t instance, uint32_t mesh) {
    in->meshes[instance] = mesh;
    in->next[instance - in->own] = in->of_mesh[mesh];
    in->of_mesh[mesh] = instance;
    masu_handle_turn(&in->handles, instance);
}

void masu_instances_remove(masu_instances *in, const masu_frame_plan *plan, uint32_t instance) {
    uint32_t *link = &in->of_mesh[in->meshes[instance]];
    while (*link != instance) link = &in->next[*link - in->own];
    *link = in->next[instance - in->own];
    masu_instances_show(in, plan, instance, 0);
    masu_handle_turn(&in->handles, instance);
}

static void mark_dirty(masu_instances *in, const masu_frame_plan *plan, uint32_t i) {
    if (!masu_instance_dirty(in, i)) in->dirty_count++;
    in->flags[i] = (uint8_t)((in->flags[i] & ~MASU_INSTANCE_DIRTY) | frames_to_write(plan));
}

void masu_instances_place(masu_instances *in, const masu_frame_plan *plan, uint32_t i,
                          const float rows[12]) {
    in->changes += memcmp(&in->now[i], rows, sizeof in->now[i]) != 0;
    memcpy(&in->now[i], rows, sizeof in->now[i]);
    if (in->low) memset(in->low[i], 0, sizeof in->low[i]);
    mark_dirty(in, plan, i);
}

void masu_instances_place_at(masu_instances *in, const masu_frame_plan *plan, uint32_t i,
                             const float rows[12], const double offset[3]) {
    float placed[12], low[3];
    memcpy(placed, rows, sizeof placed);
    for (uint32_t k = 0; k < 3; k++) {
        masu_split_double(offset[k] + (double)rows[4 * k + 3], &placed[4 * k + 3], &low[k]);
    }
    in->changes += memcmp(in->low[i], low, sizeof low) != 0;
    masu_instances_place(in, plan, i, placed);
    memcpy(in->low[i], low, sizeof low);
}

void masu_instances_touch(masu_instances *in, const masu_frame_plan *plan, uint32_t i) {
    in->changes++;
    mark_dirty(in, plan, i);
}

void masu_instances_show(masu_instances *in, const masu_frame_plan *plan, uint32_t i, int shown) {
    if (!masu_instance_hidden(in, i) == (shown != 0)) return;
    in->flags[i] ^= MASU_INSTANCE_HIDDEN;
    if (shown)
        in->flags[i] |= MASU_INSTANCE_COMES, in->hidden_count--;
    else
        in->hidden_count++;
    in->changes++;
    mark_dirty(in, plan, i);
}

void masu_instances_set_look(masu_instances *in, const masu_frame_plan *plan, uint32_t i,
                             const masu_look *look) {
    if (masu_looks_set(&in->looks, plan, i, look)) masu_instances_touch(in, plan, i);
}

uint32_t masu_instances_find(const masu_instances *in, const masu_frame_plan *plan,
                             const char *name) {
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < plan->scene.instances; i++) {
        if (in->names[i] == hash) return i;
    }
    return UINT32_MAX;
}

masu_result masu_instances_set(masu_instances *in, const masu_frame_plan *plan, uint32_t instance,
                               const float rows[12], masu_detail *detail) {
    for (uint32_t k = 0; k < 12; k++) {
        if (isfinite(rows[k])) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rows", 12, k,
                         "instance %u: rows[%u] is %g, not finite", instance, k, (double)rows[k]);
    }
    masu_instances_place(in, plan, instance, rows);
    return MASU_OK;
}

masu_result masu_position_check(const masu_frame_plan *plan, const double position[3],
                                masu_detail *detail) {
    if (!plan->desc.double_positions)
        return masu_fail(detail, MASU_ERROR_STATE, "double_positions", 1, 0,
                         "positions cannot be set: desc.double_positions is 0");
    for (uint32_t k = 0; k < 3; k++) {
        if (fabs(position[k]) <= 1e15) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "position", 3, k,
                         "position[%u] is %g, not within -1e15..1e15 m", k, position[k]);
    }
    return MASU_OK;
}

void masu_instance_rows(const struct masu_instance_data *at, float rows[12]) {
    memcpy(rows, at->row0, sizeof at->row0);
    memcpy(rows + 4, at->row1, sizeof at->row1);
    memcpy(rows + 8, at->row2, sizeof at->row2);
}

void masu_instance_position(const masu_instances *in, uint32_t i, double position[3]) {
    const float *rows[3] = {in->now[i].row0, in->now[i].row1, in->now[i].row2};
    for (uint32_t k = 0; k < 3; k++)
        position[k] = (double)rows[k][3] + (in->low ? (double)in->low[i][k] : 0.0);
}

void masu_instance_rows_from(const struct masu_instance_data *at, const float *low,
                             const double origin[3], float rows[12]) {
    masu_instance_rows(at, rows);
    for (uint32_t k = 0; k < 3; k++)
        rows[4 * k + 3] =
            (float)(((double)rows[4 * k + 3] - origin[k]) + (low ? (double)low[k] : 0.0));
}

int masu_instances_rebased(const masu_instances *in, const masu_frame_data *f) {
    return memcmp(in->slot_origin[f->slot], f->origin, sizeof f->origin) != 0;
}

/* Into a slot, relative to its origin. */
static void write_rows(struct masu_instance_data *to, const struct masu_instance_data *from,
                       const float *low, const masu_frame_data *f) {
    float rows[12];
    masu_instance_rows_from(from, low, f->origin, rows);
    memcpy(to, rows, sizeof rows);
}

void masu_instances_write(masu_instances *in, const masu_frame_data *f) {
    masu_looks_write(&in->looks, f);
    int all = masu_instances_rebased(in, f);
    if (!in->dirty_count && !all) return;
    memcpy(in->slot_origin[f->slot], f->origin, sizeof f->origin);
    unsigned char *at = masu_frame_slot(f, MASU_BUFFER_INSTANCES);
    struct masu_instance_data *to = (struct masu_instance_data *)(void *)at;
    struct masu_instance_data *before =
        (struct masu_instance_data *)(void *)(at +
                                              f->plan->buffers[MASU_BUFFER_INSTANCES].stride / 2);
    for (uint32_t i = 0; i < f->plan->scene.instances; i++) {
        if (!masu_instance_dirty(in, i) && !all) continue;
        const float *low = in->low ? in->low[i] : NULL;
        write_rows(&to[i], &in->now[i], low, f);
        if (f->plan->needs.velocity) {
            int comes = f->cut || in->flags[i] & MASU_INSTANCE_COMES;
            write_rows(&before[i], comes ? &in->now[i] : &in->previous[i],
                       comes || !low ? low : in->previous_low[i], f);
            in->previous[i] = in->now[i];
            if (low) memcpy(in->previous_low[i], low, sizeof in->low[i]);
        }
        if (!masu_instance_dirty(in, i)) continue;
        in->flags[i] = (uint8_t)((in->flags[i] & ~MASU_INSTANCE_COMES) - 1);
        if (!masu_instance_dirty(in, i)) in->dirty_count--;
    }
}
