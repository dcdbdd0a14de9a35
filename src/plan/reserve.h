/* reserve.h: adds desc.reserve to the counts of a scene: slots for copies of its models, and
 * lights.
 *
 * A slot can hold a copy of any model without skins, so its size in instances, nodes, transparent
 * primitives and traced instances is the maximum over these models. The counts of plan->scene
 * include all slots: first the elements of the blob, then the slots in order. Everything sized by
 * the scene therefore has room for the copies, and nothing changes without a reserve. src/api_add.c
 * manages the contents of slots. */
#ifndef MASU_PLAN_RESERVE_H
#define MASU_PLAN_RESERVE_H

#include "masu.h"
#include "scene/blob_section.h"
#include "scene/scene_data.h"

#define MASU_RESERVE_MODELS_MAX 16384u
#define MASU_RESERVE_LIGHTS_MAX 4096u
/* limit for the instances, and for the nodes, of all slots */
#define MASU_RESERVE_PARTS_MAX (1u << 20)

typedef struct masu_place_size {
    uint32_t instances, nodes, transparents, traced;
} masu_place_size;

/* All 0 without a reserve. */
typedef struct masu_reserve_plan {
    uint32_t models, lights;
    masu_place_size place;       /* size of one slot */
    masu_place_size places;      /* size of all slots */
    uint32_t occluders;          /* placed occluders of all slots */
    uint32_t listed, lod_listed; /* entries in a view's lists: of meshes, of LODs */
} masu_reserve_plan;

/* Whether a model can be copied: it has no skins. */
int masu_reserve_copies(const masu_scene_view *v, const masu_blob_model *model);

/* Adds the reserve to `scene`, which has the counts of the blob. Reads the blob if there are
 * slots. */
masu_result masu_reserve_add(const masu_reserve *reserve, masu_scene_data *scene,
                             masu_reserve_plan *out, masu_detail *detail);

#endif
