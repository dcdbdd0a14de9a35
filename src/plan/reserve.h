/* reserve.h: what desc.reserve adds to the counts of a scene: places for copies of its models, and for lights.
 *
 * A place holds a copy of any model that moves and has no skin: each is as large as the largest of them in
 * instances, nodes, blended primitives and traced instances. The counts of plan->scene are with all places; those
 * of the blob come first, then the places side by side. So all that is sized by a scene has room for them, and
 * without a reserve nothing changes. What is in which place is src/api_add.c's. */
#ifndef MASU_PLAN_RESERVE_H
#define MASU_PLAN_RESERVE_H

#include "masu.h"
#include "scene/blob_section.h"
#include "scene/scene_data.h"

#define MASU_RESERVE_MODELS_MAX 16384u
#define MASU_RESERVE_LIGHTS_MAX 4096u
#define MASU_RESERVE_PARTS_MAX (1u << 20) /* instances, and nodes, of all places */

typedef struct masu_place_size {
    uint32_t instances, nodes, transparents, traced;
} masu_place_size;

/* All zero where there is none. */
typedef struct masu_reserve_plan {
    uint32_t models, lights;
    masu_place_size place;  /* of one */
    masu_place_size places; /* of all */
    uint32_t occluders;     /* placed ones, of all */
    uint32_t listed, lod_listed; /* words of a view's lists: of meshes themselves, of their LODs */
} masu_reserve_plan;

/* Whether a model can be copied: nothing of it bends. */
int masu_reserve_copies(const masu_scene_view *v, const masu_blob_model *model);

/* Adds to `scene`, which is the blob's so far. Looks at the blob where there are places. */
masu_result masu_reserve_add(const masu_reserve *reserve, masu_scene_data *scene,
                             masu_reserve_plan *out, masu_detail *detail);

#endif
