/* occlusion.h: the host's part of occlusion culling, whose occluders are placed meshes. */
#ifndef MASU_OCCLUSION_H
#define MASU_OCCLUSION_H

#include "frame/visible.h"

/* An occluder, its mesh, the instances of that, and how many LODs hide it too. */
typedef struct masu_placed_occluder {
    uint32_t mesh, first_instance, instance_count, lods;
} masu_placed_occluder;

typedef struct masu_occlusion {
    masu_placed_occluder *occluders; /* [plan->scene.occluders] */
    uint32_t turns[MASU_MAX_VIEWS];  /* frames that have drawn the view, modulo 5 */
} masu_occlusion;

void masu_occlusion_alloc(masu_occlusion *o, masu_arena *arena, const masu_frame_plan *plan);
void masu_occlusion_copy_scene(masu_occlusion *o, const masu_frame_plan *plan,
                               const masu_scene_view *v);
/* Writes the data that is equal in every frame to all slots. */
void masu_occlusion_write_scene(const masu_device *device, const masu_draws *draws,
                                const masu_scene_view *v);

/* Boxes of dirty instances to the slot: before masu_instances_write. */
void masu_occlusion_write_boxes(const masu_bounds *bounds, const masu_instances *in,
                                const masu_frame_data *f);
/* Writes the inputs of stage 2, if the frame's rung has it; after masu_visible_write, to whose
 * counts it adds those of occluders. */
void masu_occlusion_write(masu_occlusion *o, masu_visible *s, const masu_instances *in,
                          const masu_views *views, const masu_frame_data *f);

#endif
