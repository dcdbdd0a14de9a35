/* animation.h: clips of models: keys in time become places of nodes. Clips, channels and keys are copied from the
 * blob; models that are alike share those of the first of their kind.
 *
 * A node's place in a clip is translation times rotation times scale. In between two keys translations and
 * scales are linear and rotations turn evenly, the short way. Several clips at once: the weighted mean of
 * translations and of scales, and of rotations the mean of the quaternions, each on the side of the first,
 * made unit length again. A node without a channel in one of them takes part with its rest; one that no clip
 * of its kind moves is left alone. */
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

/* No part of it has any length where the scene has no clips. */
typedef struct masu_animation {
    masu_clip *clips;
    masu_blob_channel *channels;
    masu_blob_key *keys;
    masu_node_pose *rest;  /* [node of all models], of those that some clip moves */
    uint8_t *moved;        /* [node of all models]: some clip moves it */
    masu_node_pose *poses; /* of the nodes of one model, while it is posed */
    float (*locals)[12];   /* the same: as they were before, in case they must go back */
} masu_animation;

void masu_animation_alloc(masu_animation *a, masu_arena *arena, const masu_frame_plan *plan);
void masu_animation_copy_scene(masu_animation *a, const masu_frame_plan *plan,
                               const masu_scene_view *v);

/* Nodes of a copy rest as those that they are copied of. */
void masu_animation_copy(masu_animation *a, const masu_frame_plan *plan, uint32_t from, uint32_t to,
                         uint32_t nodes);

/* The clips of a kind, that of model `like`: how many, and the first of them. */
uint32_t masu_animation_clips(const masu_animation *a, const masu_frame_plan *plan, uint32_t like,
                              uint32_t *first);

/* Where the nodes of a model are in a clip or several, into poses; count 0 or no weights: at rest. `uses` have been
 * checked: clips exist, times are finite, weights finite and not negative. first_node, nodes: of the model. */
void masu_animation_pose(masu_animation *a, uint32_t first_clip, const masu_clip_use *uses,
                         uint32_t count, uint32_t first_node, uint32_t nodes);

/* The weight of a morph target of the skin at a node, which rests at `rest`, as the same uses have it. */
double masu_animation_weight(const masu_animation *a, uint32_t first_clip, const masu_clip_use *uses,
                             uint32_t count, uint32_t node, uint32_t target, double rest);

/* The matrix of a pose, row by row; and back, without what is neither translation, rotation nor scale. */
void masu_pose_rows(const masu_node_pose *pose, float rows[12]);
masu_node_pose masu_pose_of(const float rows[12]);

#endif
