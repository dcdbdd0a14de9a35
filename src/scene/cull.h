/* cull.h: which boxes a view can see: the n/p-vertex test of Assarsson and Moller (2000) over a tree
 * of groups.
 *
 * A box is a centre c and half extents h; a plane keeps n.x + d >= 0. With m = n.c + d and
 * r = |n|.h the box is outside when m + r < 0, wholly inside when m - r >= 0. What a group is wholly
 * inside of is not asked of its members (plane masking), a group outside takes its members with it,
 * and each group remembers the plane that rejected it last and asks that one first.
 *
 * CONSERVATIVE. Nothing is culled that exact arithmetic would keep. Floats round, so r is widened by
 * MASU_CULL_SLACK * (|n|.|c| + |d|): its first part is in the stored half extents (masu_cull_widen),
 * its second in the plane. |n.c| in place of |n|.|c| would not do: far from the origin, products of
 * a million cancel to one and leave their rounding behind. Boxes that are not finite or beyond
 * MASU_CULL_FAR get infinite half extents, and every comparison is written so that NaN keeps.
 *
 * THE SAME SET AS ONE BY ONE. A group's box holds its members' widened boxes, and is itself tested
 * with four times the slack: a group that is outside then has no member that a test of its own would
 * have kept, and a plane that a group is inside of would have rejected none. Tests compare the sets.
 *
 * Nothing here allocates, keeps or knows anything of Vulkan; all memory is the caller's. */
#ifndef MASU_CULL_H
#define MASU_CULL_H

#include <stdint.h>

#define MASU_CULL_SLACK 0x1p-20f /* 8 * 2^-23 */
#define MASU_CULL_FAR 1e30f
#define MASU_CULL_PLANES 7u
#define MASU_CULL_DEPTH 64u /* most levels of a tree */
#define MASU_CULL_LEAF 16u  /* most boxes that masu-bake puts into one group */

typedef struct masu_cull_box {
    float center[3], half[3];
} masu_cull_box;

typedef struct masu_cull_plane {
    float n[3], d;
    float a[3];     /* |n| */
    float slack[2]; /* to r: of boxes, of groups */
} masu_cull_plane;

/* Five planes for a camera without a far plane or the box of a cascade; any convex set of up
 * to seven. */
typedef struct masu_cull_view {
    uint32_t count;
    masu_cull_plane planes[MASU_CULL_PLANES];
} masu_cull_view;

/* A group: members are child groups, boxes, or both. Children come behind their parent in the
 * array, and side by side. Group 0 is the root. */
typedef struct masu_cull_node {
    masu_cull_box box;
    uint32_t first_child, child_count;
    uint32_t first_item, item_count; /* positions of boxes */
} masu_cull_node;

/* Boxes as six arrays, in an order in which the boxes of a group are neighbours; a position is an
 * index to them. The arrays are readable for three floats beyond the last. */
typedef struct masu_cull_set {
    const masu_cull_node *nodes;
    uint32_t node_count;
    const float *boxes[6]; /* center x y z, half x y z; widened */
    const uint32_t *items; /* of each position: which mark is its own */
    uint32_t tree_count;   /* positions that the tree has */
    uint32_t count;        /* all; those from tree_count on are tested one by one */
    /* Positions whose boxes have changed since the tree was made: tested one by one as well, and
     * whatever the tree says of them does not count. */
    const uint32_t *moved;
    uint32_t moved_count;
} masu_cull_set;

typedef struct masu_cull_counts {
    uint64_t nodes;       /* groups looked at */
    uint64_t plane_tests; /* of groups and of boxes, a plane each */
} masu_cull_counts;

/* The world box of a box under a 3x4 matrix (rows), rounded outwards, and grown by what fp32 can
 * make of its points on the GPU. */
masu_cull_box masu_cull_place(const float rows[12], const float low[3], const float high[3]);

/* The box that is tested: half extents with their share of the slack. `scale`: 1 for boxes, 4 for
 * groups. */
masu_cull_box masu_cull_widen(const masu_cull_box *box, float scale);

/* Whether every point of `inner` is in `outer`. */
int masu_cull_holds(const masu_cull_box *outer, const masu_cull_box *inner);

/* Smallest box around n boxes, rounded outwards; n > 0. Infinite where one of them is. */
masu_cull_box masu_cull_around(const masu_cull_box *boxes, uint32_t n);

/* Adds a plane of any length of normal. One that is not finite, or has no normal, is left out: it
 * would reject nothing. */
void masu_cull_add_plane(masu_cull_view *view, const double n[3], double d);

/* The five planes of a projection with w = forward.rel, |x| <= w, |y| <= w, w >= near: columns of
 * clip_from_rel as the GPU has them, rel = world - eye. */
void masu_cull_camera(masu_cull_view *view, const float clip_from_rel[16], const double eye[3],
                      float near_distance);

/* Sets `bit` in marks[item] of every box that the view may see, and clears it in the others'.
 * `state`: a byte per group, zero at first, kept from frame to frame; a view of its own each.
 * Counts are added to. The two forms give the same marks, states and counts; masu_cull has SIMD
 * where the target does. */
void masu_cull(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state, uint8_t *marks,
               uint8_t bit, masu_cull_counts *counts);
void masu_cull_plain(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state,
                     uint8_t *marks, uint8_t bit, masu_cull_counts *counts);

#endif
