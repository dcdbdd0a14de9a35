/* punctual_lights.c: see punctual_lights.h. Values out of range are rejected before they are
 * stored; nothing else here can fail. */
#include "frame/punctual_lights.h"

#include "base/error.h"
#include "scene/punctual_light.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

void masu_lights_alloc(masu_lights *l, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t count = plan->scene.lights;
    l->states = masu_arena_alloc(arena, "punctual lights", count, sizeof *l->states, 8);
    l->names = masu_arena_alloc(arena, "light names", count, sizeof *l->names, 8);
    l->any_areas = plan->needs.area_lights;
    l->any_surfaces = plan->needs.shared_lights;
    l->lives = masu_arena_alloc(arena, "reserve lights", plan->reserve.lights, sizeof *l->lives, 4);
}

void masu_lights_copy_scene(masu_lights *l, const masu_frame_plan *plan, const masu_scene_view *v) {
    uint32_t own = masu_own_lights(plan);
    l->handles = masu_handles_of(v->hash, MASU_HANDLE_LIGHT, own, plan->reserve.lights, l->lives);
    for (uint32_t i = own; i < plan->scene.lights; i++) {
        memset(&l->states[i], 0, sizeof l->states[i]);
        l->names[i] = 0;
    }
    for (uint32_t i = 0; i < own; i++) {
        l->states[i] = masu_light_state_of(&v->lights[i]);
        l->names[i] = masu_scene_name_hash(v, v->lights[i].name);
    }
}

static double masu_determinant(const float *const rows[3]) {
    double sum = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t i = (k + 1) % 3, j = (k + 2) % 3;
        double minor =
            (double)rows[1][i] * (double)rows[2][j] - (double)rows[1][j] * (double)rows[2][i];
        sum += (double)rows[0][k] * minor;
    }
    return sum;
}

/* World position, direction and the other half axis, from the current transform of the instance
 * that carries the light; of a surface's light the radius too. */
static void carry(const masu_instances *in, masu_punctual_light_state *s, double position[3],
                  double direction[3]) {
    float half_axis[3] = {s->half_axis[0], s->half_axis[1], s->half_axis[2]};
    for (uint32_t k = 0; k < 3; k++) {
        position[k] = s->position[k];
        direction[k] = (double)s->direction[k];
    }
    if (!s->instance.id) return;
    const struct masu_instance_data *to =
        &in->now[s->instance.id - 1]; /* states keep its index + 1 */
    const float *rows[3] = {to->row0, to->row1, to->row2};
    masu_instance_position(in, (uint32_t)s->instance.id - 1, position);
    for (uint32_t k = 0; k < 3; k++) {
        const float *row = rows[k];
        direction[k] = 0.0;
        for (uint32_t j = 0; j < 3; j++) {
            position[k] += (double)row[j] * s->position[j];
            direction[k] += (double)row[j] * (double)s->direction[j];
        }
        s->half_axis[k] = row[0] * half_axis[0] + row[1] * half_axis[1] + row[2] * half_axis[2];
    }
    if (!s->has_surface) return;
    double size = pow(fabs(masu_determinant(rows)), 1.0 / 3.0);
    s->radius = (float)fmin(fmax((double)s->radius * size, 1e-6), 1e9);
}

/* The largest distance from a visible particle's centre, where it is lit, to its edge. */
static float reach_of_particles(const masu_frame_data *f) {
    float reach = 0.0f;
    for (uint32_t i = 0; i < f->desc.particle_count; i++) {
        const masu_particle *p = &f->desc.particles[i];
        if (!(p->flags & MASU_PARTICLE_LIT)) continue;
        float high = p->half_height > 0.0f ? p->half_height : p->half_width;
        reach = fmaxf(reach, p->half_width + high);
    }
    return reach;
}

/* Whether a light is there in this frame; where, if it is. */
static int is_there(const masu_lights *l, const masu_instances *in, uint32_t i,
                    masu_punctual_light_state *state, double position[3], double direction[3]) {
    uint64_t carrier = l->states[i].instance.id;
    if (!masu_handle_lives(&l->handles, i)) return 0;
    if (carrier && masu_instance_hidden(in, (uint32_t)carrier - 1)) return 0;
    *state = l->states[i];
    carry(in, state, position, direction);
    return 1;
}

void masu_lights_cast(masu_lights *l, masu_local_shadows *shadows, const masu_instances *in,
                      const masu_bounds *bounds, masu_frame_data *f) {
    if (!f->plan->needs.local_shadows) return;
    masu_local_shadows_begin(shadows, f);
    for (uint32_t i = 0; i < f->plan->scene.lights; i++) {
        double position[3], direction[3];
        masu_punctual_light_state state;
        if (l->states[i].no_shadow || !is_there(l, in, i, &state, position, direction)) continue;
        masu_local_shadows_offer(shadows, f, i, &state, position, direction);
    }
    l->changes += masu_local_shadows_write(shadows, in, bounds, f) != 0;
}

void masu_lights_write(masu_lights *l, const masu_instances *in, const masu_local_shadows *shadows,
                       const masu_frame_data *f) {
    uint32_t lights = f->plan->scene.lights;
    masu_light_header header = {.list_words = MASU_LIGHT_LIST_WORDS(lights)};
    if (!lights) return;
    if (f->plan->local_atlas) header.atlas_texel = 1.0f / (float)f->plan->local_atlas;
    float pixel = 2.0f * f->u.up[3] / (float)masu_frame_rung_plan(f)->render_height;
    header.snap = ldexpf(pixel, -(int)f->device->vk.properties.limits.subPixelPrecisionBits);
    /* Lights outside of the view may light reflected surfaces, and what probes see. */
    int culls = masu_frame_rung(f)->frustum != MASU_OFF && !f->plan->needs.reflections &&
                !f->plan->needs.bounce;
    float reach = culls ? reach_of_particles(f) : 0.0f;
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_LIGHTS);
    struct masu_punctual_light_data *data =
        (struct masu_punctual_light_data *)(void *)(to + sizeof header);
    for (uint32_t i = 0; i < lights; i++) {
        struct masu_punctual_light_data placed;
        double position[3], direction[3];
        masu_punctual_light_state state;
        if (!is_there(l, in, i, &state, position, direction)) continue;
        for (uint32_t k = 0; k < 3; k++) position[k] -= f->eye[k];
        if (!masu_light_place(&state, position, direction, &placed)) continue;
        float bound[4] = {placed.bound[0], placed.bound[1], placed.bound[2],
                          placed.bound[3] + reach};
        if (culls && masu_light_outside(bound, f->u.clip_from_rel)) continue;
        if (f->plan->needs.local_shadows) masu_local_shadows_of(shadows, i, f->eye, &placed);
        data[header.count++] = placed;
    }
    memcpy(to, &header, sizeof header);
    l->slot_count[f->slot] = header.count;
}

/* ---- Changes by the host --------------------------------------------------------------------- */

uint32_t masu_lights_find(const masu_lights *l, const masu_frame_plan *plan, const char *name) {
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < masu_own_lights(plan); i++) {
        if (l->names[i] == hash) return i;
    }
    return UINT32_MAX;
}

masu_punctual_light_state masu_lights_get(const masu_lights *l, const masu_instances *in,
                                          uint32_t light) {
    masu_punctual_light_state state = l->states[light];
    if (state.instance.id)
        state.instance.id = masu_handle_at(&in->handles, (uint32_t)state.instance.id - 1);
    return state;
}

/* Checks a state from the host, and replaces the handle of its instance by an index + 1. */
static masu_result take_state(const masu_lights *l, const masu_instances *in, const char *name,
                              masu_punctual_light_state *state, masu_detail *detail) {
    double value = 0.0;
    const char *wrong = masu_light_state_wrong(state, &value);
    if (wrong) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "light", 0, 0, "%s: %s (%g)", name, wrong,
                         value);
    }
    if (state->shape >= MASU_SHAPE_CAPSULE && !l->any_areas) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "area_lights", 1, 0,
                         "%s: is a capsule or rectangle: desc.area_lights is 0, and the scene has "
                         "none",
                         name);
    }
    if (state->has_surface && !l->any_surfaces) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "area_lights", 1, 0,
                         "%s: has_surface is 1: desc.area_lights is 0, and no light of the scene "
                         "has a surface",
                         name);
    }
    uint64_t id = state->instance.id;
    if (!id) return MASU_OK;
    uint32_t carrier = masu_handle_index(&in->handles, id);
    if (carrier == UINT32_MAX) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "instance", in->handles.count, id,
                         "%s: instance handle %llu is not of this renderer, or was removed", name,
                         (unsigned long long)id);
    }
    state->instance.id = (uint64_t)carrier + 1;
    return MASU_OK;
}

masu_result masu_lights_set(masu_lights *l, const masu_instances *in, uint32_t light,
                            const masu_punctual_light_state *state, masu_detail *detail) {
    masu_punctual_light_state to = *state;
    char name[24];
    snprintf(name, sizeof name, "light %u", light);
    masu_result result = take_state(l, in, name, &to, detail);
    if (result) return result;
    /* Padding at the end may differ in equal states. */
    enum { MEMBERS = offsetof(masu_punctual_light_state, no_shadow) + sizeof(to.no_shadow) };
    _Static_assert(sizeof to - MEMBERS < _Alignof(masu_punctual_light_state),
                   "a member follows `no_shadow`: name the last one");
    l->changes += memcmp(&l->states[light], &to, MEMBERS) != 0;
    l->states[light] = to;
    return MASU_OK;
}

masu_result masu_lights_add(masu_lights *l, const masu_instances *in,
                            const masu_punctual_light_state *state, uint32_t *light,
                            masu_detail *detail) {
    masu_punctual_light_state to = *state;
    masu_result result = take_state(l, in, "the new light", &to, detail);
    if (result) return result;
    *light = masu_handle_free(&l->handles, l->handles.count - l->handles.reserve,
                              l->handles.reserve);
    if (*light == UINT32_MAX) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.lights",
                         l->handles.reserve + (uint64_t)1, l->handles.reserve,
                         "reserve.lights: %u are needed, %u are given", l->handles.reserve + 1,
                         l->handles.reserve);
    }
    l->states[*light] = to;
    masu_handle_turn(&l->handles, *light);
    l->changes++;
    return MASU_OK;
}

void masu_lights_remove(masu_lights *l, uint32_t light) {
    masu_handle_turn(&l->handles, light);
    l->changes++;
}
