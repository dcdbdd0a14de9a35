/* transparents.h: what is seen through: one thing for each primitive of a blended material and each
 * instance of its mesh, drawn one by one, the farthest first. transparents.c says how. */
#ifndef MASU_TRANSPARENTS_H
#define MASU_TRANSPARENTS_H

#include "frame/visible.h"

typedef struct masu_transparent {
    VkDrawIndexedIndirectCommand draw;
    uint32_t instance; /* MASU_BLOB_NONE: there is none, in a place of the reserve */
    uint32_t material, flags, layers;
    float detail[2];
    uint32_t column; /* which of the texture sets */
    float center[3]; /* of its box, object space */
} masu_transparent;

typedef struct masu_back_to_front {
    float key; /* the larger comes first; no NaN */
    uint32_t thing;
} masu_back_to_front;

/* Sorts by falling key; equal keys stay as they are. `scratch` has room for n too. Which of the two
 * arrays holds the result is returned. n log2 n steps, whatever the keys. */
masu_back_to_front *masu_sort_back_to_front(masu_back_to_front *entries,
                                            masu_back_to_front *scratch, uint32_t n);

typedef struct masu_transparents {
    masu_transparent *things;             /* plan->scene.transparents of them */
    float *nearer; /* [thing]: factor on its depth; NULL if no material has a depth bias */
    masu_back_to_front *order;            /* twice as many */
    const masu_back_to_front *sorted;     /* in one half of it: those drawn by the frame at hand */
    uint32_t slot_count[MASU_MAX_FLIGHT]; /* drawn */
} masu_transparents;

void masu_transparents_alloc(masu_transparents *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_transparents_copy_scene(masu_transparents *s, const masu_frame_plan *plan,
                                  const masu_draws *draws, const masu_scene_view *v);
/* Into a place of the reserve: what one instance shows, as of another. */
void masu_transparents_copy(masu_transparents *s, const masu_frame_plan *plan, uint32_t place,
                            uint32_t from, uint32_t to);
void masu_transparents_clear(masu_transparents *s, const masu_frame_plan *plan, uint32_t place);
/* Sorted to the slot; after masu_visible_write, which says what the camera sees. */
void masu_transparents_write(masu_transparents *s, const masu_instances *in,
                             const masu_visible *visible, const masu_frame_data *f);

#endif
