/* materials.c: see materials.h. Values out of range are rejected before anything changes;
 * nothing else here can fail. */
#include "frame/materials.h"

#include "base/error.h"
#include "scene/trace_scene.h"

#include <math.h>
#include <string.h>

void masu_materials_alloc(masu_materials *s, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t count = plan->desc.mutable_materials ? plan->scene.materials : 0;
    memset(s, 0, sizeof *s);
    if (!count) return;
    s->now = masu_arena_alloc(arena, "live materials", count, sizeof *s->now, 16);
    s->traced = masu_arena_alloc(arena, "live traced materials", plan->needs.traced ? count : 0,
                                 sizeof *s->traced, 4);
    s->flags = masu_arena_alloc(arena, "material flags", count, sizeof *s->flags, 4);
    s->names = masu_arena_alloc(arena, "material names", count, sizeof *s->names, 8);
}

/* As for a material whose factors are 1: only the maps' influence remains. */
static masu_material_traced traced_of(const masu_frame_plan *plan, const masu_scene_view *v,
                                      uint64_t i) {
    masu_blob_material unit = v->materials[i];
    unit.roughness = unit.metallic = 1.0f;
    const struct masu_trace_material of = masu_trace_material_of(&plan->scene, v, &unit);
    masu_material_traced out = {of.base_color[3], of.emissive[3], {0, 0, 0, 0}};
    memcpy(out.maps, of.maps, sizeof out.maps);
    return out;
}

void masu_materials_copy_scene(masu_materials *s, const masu_frame_plan *plan,
                               const masu_scene_view *v) {
    uint32_t count = plan->desc.mutable_materials ? plan->scene.materials : 0;
    s->handles = masu_handles_of(v->hash, MASU_HANDLE_MATERIAL, count, 0, NULL);
    for (uint32_t i = 0; i < count; i++) {
        s->now[i] = masu_material_data_of(&v->materials[i]);
        s->flags[i] = v->materials[i].flags;
        s->names[i] = masu_scene_name_hash(v, v->materials[i].name);
        if (plan->needs.traced) s->traced[i] = traced_of(plan, v, i);
    }
}

/* ---- Changes by the host --------------------------------------------------------------------- */

uint32_t masu_materials_find(const masu_materials *s, const char *name) {
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < s->handles.count; i++) {
        if (s->names[i] == hash) return i;
    }
    return UINT32_MAX;
}

static masu_material_mode mode_of(uint32_t flags) {
    if (flags & MASU_MATERIAL_IS_BLEND)
        return flags & MASU_MATERIAL_IS_ADDITIVE ? MASU_MATERIAL_ADDITIVE : MASU_MATERIAL_BLENDED;
    return flags & MASU_MATERIAL_IS_MASK ? MASU_MATERIAL_MASKED : MASU_MATERIAL_OPAQUE;
}

/* For a lobe (masu_lobe_code), which is not changed. */
static float specular_in(float given) {
    uint32_t code = given < 0.0f ? (uint32_t)-given - 1u : 0;
    float root = (float)(code & 255u) / 255.0f;
    if (!code) return given;
    return code >> 21 == MASU_LOBE_COLORED ? 12.5f * root * root
           : code >> 21 == MASU_LOBE_GRAIN ? (float)(code >> 14 & 127u) / 127.0f
                                           : 0.5f;
}

/* The number of the live texture that a material shows, which is kept with its opacity. */
static uint32_t texture_in(float opacity) { return (uint32_t)(0.5f * opacity); }

masu_material_state masu_materials_get(const masu_materials *s, uint32_t material) {
    const struct masu_material_data *now = &s->now[material];
    uint32_t cutoff = s->flags[material] >> MASU_MATERIAL_CUTOFF_SHIFT & 255u;
    masu_material_state state = {.roughness = now->base_color[3],
                                 .metallic = fmaxf(now->emissive[3], 0.0f), /* below 0: refracts */
                                 .specular = specular_in(now->more[0]),
                                 .coat = now->more[1],
                                 .coat_roughness = now->more[2],
                                 .opacity = now->more[3] - 2.0f * (float)texture_in(now->more[3]),
                                 .texture = texture_in(now->more[3]),
                                 .mode = mode_of(s->flags[material]),
                                 .cutoff = (float)cutoff / 255.0f};
    memcpy(state.base_color, now->base_color, sizeof state.base_color);
    memcpy(state.emissive, now->emissive, sizeof state.emissive);
    return state;
}

typedef struct factor {
    const char *name;
    const float *at;
    uint32_t count;
    float most;
} factor;

static masu_result check_factors(uint32_t material, const masu_material_state *s, int lobe,
                                 masu_detail *detail) {
    const factor factors[] = {{"base_color", s->base_color, 3, 1.0f},
                              {"opacity", &s->opacity, 1, 1.0f},
                              {"roughness", &s->roughness, 1, 1.0f},
                              {"metallic", &s->metallic, 1, 1.0f},
                              {"emissive", s->emissive, 3, 1e9f},
                              {"specular", &s->specular, 1, lobe ? 12.5f : 1.0f},
                              {"coat", &s->coat, 1, 1.0f},
                              {"coat_roughness", &s->coat_roughness, 1, 1.0f}};
    for (uint32_t i = 0; i < sizeof factors / sizeof *factors; i++) {
        const factor *f = &factors[i];
        for (uint32_t k = 0; k < f->count; k++) {
            if (f->at[k] >= 0.0f && f->at[k] <= f->most) continue;
            return masu_fail(detail, MASU_ERROR_ARGUMENT, f->name, 0, k,
                             "material %u: %s is %g, allowed are 0 to %g", material, f->name,
                             (double)f->at[k], (double)f->most);
        }
    }
    return MASU_OK;
}

static masu_result fixed(uint32_t material, const char *what, const char *why,
                         masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, material,
                     "material %u: %s cannot be changed: %s", material, what, why);
}

static masu_result check_texture(const masu_materials *s, const masu_frame_plan *plan, uint32_t i,
                                 uint32_t texture, masu_detail *detail) {
    if (!texture) return MASU_OK;
    if (texture > plan->desc.reserve.textures) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "texture", texture, plan->desc.reserve.textures,
                         "material %u: texture is %u, desc.reserve.textures is %u", i, texture,
                         plan->desc.reserve.textures);
    }
    if (s->flags[i] & MASU_MAP_BASE) return MASU_OK;
    return fixed(i, "texture", "it has no base-colour map", detail);
}

/* Rejects changes that would require another pass, pipeline or image. */
static masu_result check_fixed(const masu_materials *s, const masu_frame_plan *plan, uint32_t i,
                               const masu_material_state *to, masu_detail *detail) {
    const masu_material_state now = masu_materials_get(s, i);
    int blends = (s->flags[i] & MASU_MATERIAL_IS_BLEND) != 0;
    if (to->mode != now.mode)
        return fixed(i, "mode", "another pass or pipeline draws what is of another", detail);
    if (!(fabsf(to->cutoff - now.cutoff) < 0.5f / 255.0f))
        return fixed(i, "cutoff", "recordings hold it", detail);
    if (!blends && to->opacity != now.opacity)
        return fixed(i, "opacity", "the material is not blended", detail);
    if (s->now[i].emissive[3] < 0.0f && to->metallic > 0.0f)
        return fixed(i, "metallic", "the material refracts", detail);
    if (to->coat > 0.0f && !plan->scene.coats)
        return fixed(i, "coat", "the scene has no material with one, and no tables for it", detail);
    if (s->now[i].more[0] < 0.0f) {
        const char *why =
            "the material has a sheen, an anisotropy, or a reflectance with a colour or above 0.08";
        if (to->specular != now.specular) return fixed(i, "specular", why, detail);
        if (to->coat > 0.0f) return fixed(i, "coat", why, detail);
    }
    if (blends || plan->needs.surface) return MASU_OK;
    if (to->specular != now.specular)
        return fixed(i, "specular", "the scene has no image for it: no material has one but 0.5",
                     detail);
    return to->coat > 0.0f ? fixed(i, "coat", "the scene has no image for it", detail) : MASU_OK;
}

masu_result masu_materials_set(masu_materials *s, const masu_frame_plan *plan, uint32_t material,
                               const masu_material_state *state, masu_detail *detail) {
    int lobe = s->now[material].more[0] < 0.0f;
    float volume = s->now[material].emissive[3];
    masu_result result = check_factors(material, state, lobe, detail);
    if (!result) result = check_fixed(s, plan, material, state, detail);
    if (!result) result = check_texture(s, plan, material, state->texture, detail);
    if (result) return result;
    struct masu_material_data to = {
        {state->base_color[0], state->base_color[1], state->base_color[2], state->roughness},
        {state->emissive[0], state->emissive[1], state->emissive[2],
         volume < 0.0f ? volume : state->metallic},
        {lobe ? s->now[material].more[0] : state->specular, state->coat, state->coat_roughness,
         state->opacity + 2.0f * (float)state->texture}};
    s->changes += memcmp(&s->now[material], &to, sizeof to) != 0;
    s->now[material] = to;
    return MASU_OK;
}

/* ---- The frame ------------------------------------------------------------------------------- */

void masu_materials_write(masu_materials *s, const masu_frame_data *f) {
    uint32_t count = s->handles.count;
    if (!count || s->slot_changes[f->slot] == 1 + s->changes) return;
    s->slot_changes[f->slot] = 1 + s->changes;
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_LIVE_MATERIALS);
    memcpy(to, s->now, count * sizeof *s->now);
    to += count * sizeof *s->now;
    for (uint32_t i = 0; i < count && f->plan->needs.traced; i++) {
        struct masu_trace_material m;
        memcpy(&m, &s->now[i], sizeof s->now[i]);
        memcpy(m.maps, s->traced[i].maps, sizeof m.maps);
        m.base_color[3] *= s->traced[i].roughness;
        m.emissive[3] *= s->traced[i].metallic;
        memcpy(to + i * sizeof m, &m, sizeof m);
    }
}
