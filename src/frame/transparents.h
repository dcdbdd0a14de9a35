/* transparents.h: transparent surfaces: one thing for each primitive of a transparent material
 * and each instance of its mesh, drawn separately, the farthest first. transparents.c explains
 * the method. */
#ifndef MASU_TRANSPARENTS_H
#define MASU_TRANSPARENTS_H

#include "frame/visible.h"

typedef struct masu_transparent {
    VkDrawIndexedIndirectCommand draw;
    uint32_t instance; /* MASU_BLOB_NONE: a free slot of the reserve */
    uint32_t material, flags, layers;
    float detail[2];
    uint32_t column; /* which of the texture sets */
    float center[3]; /* of its box, object space */
} masu_transparent;

typedef struct masu_back_to_front {
    float key; /* sorted by falling key; no NaN */
    uint32_t thing;
} masu_back_to_front;

/* Stable sort by falling key. `scratch` has space for n entries too. Returns the array of the
 * two that holds the result. n log2 n steps for any keys. */
masu_back_to_front *masu_sort_back_to_front(masu_back_to_front *entries,
                                            masu_back_to_front *scratch, uint32_t n);

typedef struct masu_transparents {
    masu_transparent *things;             /* [plan->scene.transparents] */
    float *nearer; /* [thing]: factor on its depth; NULL if no material has a depth bias */
    masu_back_to_front *order;            /* twice as many */
    const masu_back_to_front *sorted; /* in one half of `order`: those drawn by the current frame */
    uint32_t slot_count[MASU_MAX_FLIGHT]; /* drawn */
} masu_transparents;

void masu_transparents_alloc(masu_transparents *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_transparents_copy_scene(masu_transparents *s, const masu_frame_plan *plan,
                                  const masu_draws *draws, const masu_scene_view *v);
/* Copies the things of one instance to another, in a slot of the reserve. */
void masu_transparents_copy(masu_transparents *s, const masu_frame_plan *plan, uint32_t place,
                            uint32_t from, uint32_t to);
void masu_transparents_clear(masu_transparents *s, const masu_frame_plan *plan, uint32_t place);
/* Writes the sorted things to the slot; after masu_visible_write, which finds those visible to
 * the camera. */
void masu_transparents_write(masu_transparents *s, const masu_instances *in,
                             const masu_visible *visible, const masu_frame_data *f);

#endif
