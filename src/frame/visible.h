/* visible.h: which instances each view of a frame draws, and as which LOD. */
#ifndef MASU_VISIBLE_H
#define MASU_VISIBLE_H

#include "frame/cameras.h"

typedef struct masu_visible {
    masu_blob_lod *lods; /* [plan->scene.lods], if the plan has any */
    uint8_t *levels;     /* [instance]: 0, or the LOD of its last draw; only with LODs */
    uint32_t levels_chosen; /* LODs chosen in the last frame: at most one per instance */
    uint8_t *group_states; /* [view][group] */
    uint8_t *marks;        /* [instance]: a bit per view that stage 1 has kept it for */
    masu_view_stats slot_views[MASU_MAX_FLIGHT][MASU_MAX_VIEWS];
} masu_visible;

void masu_visible_alloc(masu_visible *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_visible_copy_scene(masu_visible *s, const masu_frame_plan *plan,
                             const masu_scene_view *v);
/* Writes a command for each draw of a view, without its instance count; returns the end. */
VkDrawIndexedIndirectCommand *masu_draws_write(const masu_draws *draws, const masu_scene_view *v,
                                               const masu_frame_plan *plan,
                                               VkDrawIndexedIndirectCommand *to);
/* Writes the constant part of the draw commands to all slots. */
void masu_visible_write_scene(const masu_device *device, const masu_draws *draws,
                              const masu_scene_view *v);

/* Writes each view's visible instances to the slot; after the views are set. */
void masu_visible_write(masu_visible *s, const masu_bounds *bounds, const masu_instances *in,
                        const masu_views *views, const masu_frame_data *f);

#endif
