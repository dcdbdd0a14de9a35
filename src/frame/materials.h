/* materials.h: material factors that the host changes at run time. The host's copy is authoritative
 * and is written to each slot that lacks the last change. At the start of each frame the device
 * copies the slot to the buffers that shaders and rays read, so frames in flight have separate
 * copies. Empty without desc.mutable_materials.
 *
 * Flags, maps and the alpha cut-off, which pipelines and recordings depend on, keep the scene's
 * values. */
#ifndef MASU_MATERIALS_H
#define MASU_MATERIALS_H

#include "frame/frame_data.h"
#include "frame/handles.h"
#include "scene/material.h"
#include "scene/blob_section.h"

/* Material data of rays that is not a factor. */
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

/* Writes all materials to the slot if one has changed. */
void masu_materials_write(masu_materials *s, const masu_frame_data *f);

#endif
