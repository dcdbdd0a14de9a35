/* bounds.h: world-space boxes of instances and of their culling groups, for culling, shadows and
 * LODs. Positions are indices into the order of src/scene/cull.h. */
#ifndef MASU_BOUNDS_H
#define MASU_BOUNDS_H

#include "frame/instances.h"
#include "scene/cull.h"

/* in positions: the instance has moved, so the tree's bounds do not include it */
#define MASU_BOX_MOVED 0x80000000u
#define MASU_BOX_PADDING 3u        /* floats that SIMD may read behind the last box */

typedef struct masu_bounds {
    masu_cull_node *groups;
    float *boxes; /* [6][box_stride] */
    uint64_t box_stride;
    uint32_t *items;     /* [position]: instance */
    uint32_t *positions; /* [instance] */
    uint32_t *moved;     /* positions */
    uint32_t moved_count;
    float (*meshes)[6];    /* low, high */
    masu_cull_box initial; /* around all instances at their initial transforms */
    double swept[2][3];    /* around every position of every instance so far */
} masu_bounds;

void masu_bounds_alloc(masu_bounds *b, masu_arena *arena, const masu_frame_plan *plan);
void masu_bounds_copy_scene(masu_bounds *b, const masu_frame_plan *plan, const masu_instances *in,
                            const masu_scene_view *v);
/* After a transform has changed. */
void masu_bounds_move(masu_bounds *b, const masu_frame_plan *plan, const masu_instances *in,
                      uint32_t instance);

/* Index of an instance's box. */
static inline uint32_t masu_bounds_position(const masu_bounds *b, uint32_t instance) {
    return b->positions[instance] & ~MASU_BOX_MOVED;
}

/* Middle and half size of an instance's box. */
void masu_bounds_of(const masu_bounds *b, uint32_t instance, float box[6]);
/* As masu_cull takes them. */
masu_cull_set masu_bounds_set(const masu_bounds *b, const masu_scene_data *scene);

#endif
