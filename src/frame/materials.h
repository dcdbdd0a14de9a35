/* materials.h: factors of materials that the host changes while frames go on: its truth, copied to a slot that has not
 * seen the last change. At the top of each frame the device copies the slot to where shaders read materials, and to
 * where rays do: frames in flight each have their own. All of it is of no length without
 * desc.mutable_materials.
 *
 * What pipelines and recordings know of a material, its flags, maps and cut-off, stays as the scene has it. */
#ifndef MASU_MATERIALS_H
#define MASU_MATERIALS_H

#include "frame/frame_data.h"
#include "frame/handles.h"
#include "scene/material.h"
#include "scene/blob_section.h"

/* What a ray finds besides the factors. */
typedef struct masu_material_traced {
    float roughness, metallic; /* of the maps: factors are times it */
    uint32_t maps[4];
} masu_material_traced;

typedef struct masu_materials {
    struct masu_material_data *now;
    masu_material_traced *traced; /* of no length where nothing is traced */
    uint32_t *flags;              /* masu_blob_material_flags */
    uint64_t *names;              /* FNV-1a 64 of the name, 0: none */
    masu_handles handles;
    uint32_t changes; /* how often one was set */
    uint32_t slot_changes[MASU_MAX_FLIGHT]; /* 1 + as of which the slot is; 0: nothing is in it */
} masu_materials;

void masu_materials_alloc(masu_materials *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_materials_copy_scene(masu_materials *s, const masu_frame_plan *plan,
                               const masu_scene_view *v);

/* masu_material_find, _get and _set of the public header. */
/* UINT32_MAX: there is none. */
uint32_t masu_materials_find(const masu_materials *s, const char *name);
masu_material_state masu_materials_get(const masu_materials *s, uint32_t material);
masu_result masu_materials_set(masu_materials *s, const masu_frame_plan *plan, uint32_t material,
                               const masu_material_state *state, masu_detail *detail);

/* All of them to the slot, where one has changed. */
void masu_materials_write(masu_materials *s, const masu_frame_data *f);

#endif
