/* visible.h: which instances each view of a frame draws, and as which LOD. */
#ifndef MASU_VISIBLE_H
#define MASU_VISIBLE_H

#include "frame/cameras.h"

typedef struct masu_visible {
    masu_blob_lod *lods; /* plan->scene.lods, where the plan has any */
    uint8_t *levels;     /* [instance]: 0, or the LOD that it was last drawn as; with LODs alone */
    uint32_t levels_chosen; /* in the last frame: at most one per instance, in however many views */
    uint8_t *group_states; /* [view][group] */
    uint8_t *marks;        /* [instance]: a bit per view that stage 1 has kept it for */
    masu_view_stats slot_views[MASU_MAX_FLIGHT][MASU_MAX_VIEWS];
} masu_visible;

void masu_visible_alloc(masu_visible *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_visible_copy_scene(masu_visible *s, const masu_frame_plan *plan,
                             const masu_scene_view *v);
/* A command for each draw of a view, but for how many instances it has; returns what follows. */
VkDrawIndexedIndirectCommand *masu_draws_write(const masu_draws *draws, const masu_scene_view *v,
                                               const masu_frame_plan *plan,
                                               VkDrawIndexedIndirectCommand *to);
/* What does not change of the draw commands, to all slots. */
void masu_visible_write_scene(const masu_device *device, const masu_draws *draws,
                              const masu_scene_view *v);

/* What each view draws to the slot; after the views are set. */
void masu_visible_write(masu_visible *s, const masu_bounds *bounds, const masu_instances *in,
                        const masu_views *views, const masu_frame_data *f);

#endif
