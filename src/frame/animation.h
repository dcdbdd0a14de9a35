/* animation.h: animation clips of models: evaluates keyframes into transforms of nodes. Clips,
 * channels and keys are copied from the blob; pooled copies share the clips of their first model.
 *
 * A node's transform in a clip is translation times rotation times scale. Between two keys,
 * translations and scales are interpolated linearly, and rotations spherically along the short
 * arc. Several clips are blended by weighted means of translations and scales, and by the
 * normalized mean of the quaternions, each in the hemisphere of the first. A node without a
 * channel in a clip contributes its rest pose; a node without any channel is not changed. */
#ifndef MASU_ANIMATION_H
#define MASU_ANIMATION_H

#include "base/arena.h"
#include "plan/plan.h"
#include "scene/blob_section.h"

/* Translation, rotation (x, y, z, w), scale. */
typedef struct masu_node_pose {
    double translation[3], rotation[4], scale[3];
} masu_node_pose;

typedef struct masu_clip {
    uint64_t name; /* FNV-1a 64, 0: none */
    uint32_t model, first_channel, channel_count;
    float duration;
} masu_clip;

/* All arrays are empty if the scene has no clips. */
typedef struct masu_animation {
    masu_clip *clips;
    masu_blob_channel *channels;
    masu_blob_key *keys;
    masu_node_pose *rest;  /* [node of all models], of nodes that a clip moves */
    uint8_t *moved;        /* [node of all models]: some clip moves it */
    masu_node_pose *poses; /* of the nodes of one model, while it is posed */
    /* the same nodes: their previous matrices, restored if a pose is not finite */
    float (*locals)[12];
} masu_animation;

void masu_animation_alloc(masu_animation *a, masu_arena *arena, const masu_frame_plan *plan);
void masu_animation_copy_scene(masu_animation *a, const masu_frame_plan *plan,
                               const masu_scene_view *v);

/* Nodes of a copy rest as those that they are copied of. */
void masu_animation_copy(masu_animation *a, const masu_frame_plan *plan, uint32_t from, uint32_t to,
                         uint32_t nodes);

/* The clips of a model and its pooled copies, of which `like` is the first: their number and
 * first index. */
uint32_t masu_animation_clips(const masu_animation *a, const masu_frame_plan *plan, uint32_t like,
                              uint32_t *first);

/* Evaluates the blended pose of a model's nodes into `poses`; the rest pose if count or all
 * weights are 0. `uses` have been checked: clips exist, times are finite, weights finite and not
 * negative. first_node, nodes: the model's range of nodes. */
void masu_animation_pose(masu_animation *a, uint32_t first_clip, const masu_clip_use *uses,
                         uint32_t count, uint32_t first_node, uint32_t nodes);

/* The blended weight of a morph target of the skin at a node; `rest` is its rest weight. */
double masu_animation_weight(const masu_animation *a, uint32_t first_clip,
                             const masu_clip_use *uses, uint32_t count, uint32_t node,
                             uint32_t target, double rest);

/* Converts a pose to a row-major matrix and back; shear is dropped. */
void masu_pose_rows(const masu_node_pose *pose, float rows[12]);
masu_node_pose masu_pose_of(const float rows[12]);

#endif
