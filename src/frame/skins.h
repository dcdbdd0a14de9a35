/* skins.h: meshes that joints bend: where their joints are, in each frame, and the box around what they move. The
 * host's truth as that of instances: matrices are written to a slot while it has not seen the last change, and
 * those of the previous frame beside them. The pass `skin` does the rest.
 *
 * A joint's matrix takes rest vertices to the object space of the instance that shows them: the node that shows
 * a skin may be anywhere, as glTF has it, and the skin stays where its joints are.
 *
 * BOX. A vertex is a weighted mean of where its joints put it, so it lies in the hull of the boxes of what each
 * joint moves, and those are known since the scene was baked. Morph targets widen these by their own boxes times
 * their weights. */
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

/* What a morph target adds to rest vertices, times its weight. */
typedef struct masu_morph {
    float low[3], high[3], rest; /* around its deltas; its weight at rest */
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

/* The skins of a model: how many, and the first of them. */
uint32_t masu_skins_of(const masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                       uint32_t *first);

/* The weights of targets that clips change, and no others: count 0 or no weights: at rest. uses: as of
 * masu_animation_pose. */
void masu_skins_play(masu_skins *s, const masu_animation *a, const masu_frame_plan *plan, uint32_t model,
                     uint32_t first_node, uint32_t first_clip, const masu_clip_use *uses, uint32_t count);
/* Sets the weight of all targets of that name. How many there are. */
uint32_t masu_skins_set(masu_skins *s, const masu_frame_plan *plan, uint32_t model, const char *name,
                        float weight);

/* After nodes of a model have moved: finds the matrices of its joints. 0: one is not finite; they are to be found
 * again once the nodes are back. */
int masu_skins_pose(masu_skins *s, const masu_frame_plan *plan, uint32_t model,
                    const masu_node *nodes, uint32_t first_node, uint32_t node_count);
/* And then tells instances and bounds. */
void masu_skins_settle(masu_skins *s, masu_instances *in, masu_bounds *b,
                       const masu_frame_plan *plan, uint32_t model);

/* Those whose instances are dirty to the slot: before the instances themselves. */
void masu_skins_write(masu_skins *s, const masu_instances *in, const masu_frame_data *f);

#endif
