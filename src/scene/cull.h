/* cull.h: view frustum culling of boxes: the n/p-vertex test of Assarsson and Moller (2000) over a
 * hierarchy of groups.
 *
 * A box has a centre c and half extents h; a plane keeps n.x + d >= 0. With m = n.c + d and r =
 * |n|.h, the box is outside if m + r < 0, and inside if m - r >= 0. Members of a group are not
 * tested against planes that the group is inside of (plane masking). A group that is outside
 * rejects all members. Each group stores the plane that rejected it last and tests that plane
 * first.
 *
 * CONSERVATIVE. No box is culled that exact arithmetic would keep. Because floats are rounded, r is
 * widened by MASU_CULL_SLACK * (|n|.|c| + |d|): the first part is added to the stored half extents
 * (masu_cull_widen), the second to the plane. |n.c| would be too small in place of |n|.|c|: far
 * from the origin, products of a million cancel to one and leave their rounding errors. Boxes that
 * are not finite or beyond MASU_CULL_FAR get infinite half extents, and all comparisons keep a box
 * if an operand is NaN.
 *
 * SAME RESULT AS WITHOUT GROUPS. A group's box contains its members' widened boxes, and is tested
 * with four times the slack. Therefore a group that is outside has no member that would be kept
 * separately, and a plane that a group is inside of would reject no member. Tests compare the sets.
 *
 * No allocation, no state, no Vulkan; all memory is the caller's. */
#ifndef MASU_CULL_H
#define MASU_CULL_H

#include <stdint.h>

#define MASU_CULL_SLACK 0x1p-20f /* 8 * 2^-23 */
#define MASU_CULL_FAR 1e30f
#define MASU_CULL_PLANES 7u
#define MASU_CULL_DEPTH 64u /* maximum depth of the hierarchy */
#define MASU_CULL_LEAF 16u  /* maximum number of boxes that masu-bake puts into one group */

typedef struct masu_cull_box {
    float center[3], half[3];
} masu_cull_box;

typedef struct masu_cull_plane {
    float n[3], d;
    float a[3];     /* |n| */
    float slack[2]; /* slack of the plane: for boxes, for groups */
} masu_cull_plane;

/* Five planes, for a camera without a far plane or for a cascade's box; in general any convex set
 * of up to seven. */
typedef struct masu_cull_view {
    uint32_t count;
    masu_cull_plane planes[MASU_CULL_PLANES];
} masu_cull_view;

/* A group. Members are child groups, boxes, or both. Children follow their parent in the array and
 * are contiguous. Group 0 is the root. */
typedef struct masu_cull_node {
    masu_cull_box box;
    uint32_t first_child, child_count;
    uint32_t first_item, item_count; /* range of box positions */
} masu_cull_node;

/* Boxes as a structure of arrays. A position is an index into the arrays; the boxes of a group are
 * contiguous. Each array must be readable for three floats beyond its end. */
typedef struct masu_cull_set {
    const masu_cull_node *nodes;
    uint32_t node_count;
    const float *boxes[6]; /* centre x y z, half extents x y z; widened */
    const uint32_t *items; /* by position: index into `marks` */
    uint32_t tree_count;   /* number of positions in the hierarchy */
    uint32_t count;        /* all positions; those from tree_count on are tested one by one */
    /* Positions whose boxes have changed since the hierarchy was built. They are tested one by one,
     * and the result of the hierarchy is ignored for them. */
    const uint32_t *moved;
    uint32_t moved_count;
} masu_cull_set;

typedef struct masu_cull_counts {
    uint64_t nodes;       /* groups visited */
    uint64_t plane_tests; /* box-plane tests, of groups and boxes */
} masu_cull_counts;

/* World-space box of a box under a 3x4 matrix (rows), rounded outwards and enlarged by the fp32
 * rounding of the vertex transform on the GPU. */
masu_cull_box masu_cull_place(const float rows[12], const float low[3], const float high[3]);

/* Adds the box's share of the slack to the half extents. `scale`: 1 for boxes, 4 for groups. */
masu_cull_box masu_cull_widen(const masu_cull_box *box, float scale);

/* Whether `outer` contains `inner`. */
int masu_cull_holds(const masu_cull_box *outer, const masu_cull_box *inner);

/* Bounding box of n > 0 boxes, rounded outwards. Infinite if one of the boxes is infinite. */
masu_cull_box masu_cull_around(const masu_cull_box *boxes, uint32_t n);

/* Adds a plane; the normal may have any length. A plane that is not finite or has a zero normal is
 * ignored, since it could not reject anything. */
void masu_cull_add_plane(masu_cull_view *view, const double n[3], double d);

/* Sets the five planes of a projection with w = forward.rel, |x| <= w, |y| <= w, w >= near.
 * clip_from_rel: columns, as on the GPU; rel = world - eye. */
void masu_cull_camera(masu_cull_view *view, const float clip_from_rel[16], const double eye[3],
                      float near_distance);

/* Sets `bit` in marks[item] for every box that may be visible in the view, and clears it for the
 * others. `state`: one byte per group, initially 0, kept from frame to frame, one array per view.
 * Counts are added to *counts. masu_cull uses SIMD if the target supports it; both variants give
 * the same marks, states and counts. */
void masu_cull(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state, uint8_t *marks,
               uint8_t bit, masu_cull_counts *counts);
void masu_cull_plain(const masu_cull_set *set, const masu_cull_view *view, uint8_t *state,
                     uint8_t *marks, uint8_t bit, masu_cull_counts *counts);

#endif
