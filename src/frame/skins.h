/* skins.h: skinned meshes: joint matrices of each frame, and the bounds of the deformed vertices.
 * As for instances, the host's copy is authoritative: matrices are written to each slot that lacks
 * the last change, next to those of the previous frame. The pass `skin` deforms the vertices.
 *
 * A joint matrix transforms rest vertices to the object space of the instance that shows them. As
 * in glTF, the transform of the node with the skin has no effect: the skin follows its joints.
 *
 * BOX. A skinned vertex is a weighted mean of its positions by each joint, so it is inside the
 * hull of the joints' boxes, which the baker computes. Morph targets enlarge these by their own
 * boxes times their weights. */
#ifndef MASU_SKINS_H
#define MASU_SKINS_H

#include "frame/animation.h"
#include "frame/bounds.h"
#include "frame/instances.h"
#include "frame/nodes.h"

typedef struct masu_skin {
    uint32_t model, node, instance;
    uint32_t first_vertex, vertex_count, first_skin_vertex;
    uint32_t first_joint, joint_count; /* of `joints` */
    uint32_t first_matrix;             /* of `now` and `previous` */
    uint32_t first_tree_node, tree_nodes; /* of TRACE_NODES */
    uint32_t first_box;                /* of MASU_BUFFER_SKIN_TREES */
    uint32_t first_target, target_count, first_delta; /* of `targets`; of MORPH_DELTAS */
    uint32_t first_weight;             /* of `weights` and `before` */
} masu_skin;

/* Offsets that a morph target adds to rest vertices, times its weight. */
typedef struct masu_morph {
    float low[3], high[3], rest; /* bounds of its offsets; its rest weight */
    uint32_t driven;             /* flag: some clip changes its weight */
    uint64_t name;
} masu_morph;

typedef struct masu_skins {
    masu_skin *skins; /* by model */
    masu_blob_joint *joints;
    float (*now)[12];
    float (*previous)[12]; /* of no length where nothing reads velocities */
    double (*inside)[12];  /* from nodes of one model to it, while it is posed */
    masu_morph *targets;   /* these three of no length where nothing morphs */
    float *weights;
    float *before;         /* in the previous frame; as `previous` */
} masu_skins;

void masu_skins_alloc(masu_skins *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_skins_copy_scene(masu_skins *s, const masu_frame_plan *plan, const masu_scene_view *v);

/* The skins of a model: their number and first index. */
uint32_t masu_skins_of(const masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                       uint32_t *first);

/* Sets the weights of animated targets only; rest weights if count or all weights are 0. uses:
 * as for masu_animation_pose. */
void masu_skins_play(masu_skins *s, const masu_animation *a, const masu_frame_plan *plan,
                     uint32_t model, uint32_t first_node, uint32_t first_clip,
                     const masu_clip_use *uses, uint32_t count);
/* Sets the weight of all targets of that name. How many there are. */
uint32_t masu_skins_set(masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                        const char *name, float weight);

/* After nodes of a model have moved: finds the matrices of its joints. 0: one is not finite;
 * they are to be found again once the nodes are back. */
int masu_skins_pose(masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                    const masu_node *nodes, uint32_t first_node, uint32_t node_count);
/* Then updates instances and bounds. */
void masu_skins_settle(masu_skins *s, masu_instances *in, masu_bounds *b,
                       const masu_frame_plan *plan, uint32_t model);

/* Those whose instances are dirty to the slot: before the instances themselves. */
void masu_skins_write(masu_skins *s, const masu_instances *in, const masu_frame_data *f);

#endif
