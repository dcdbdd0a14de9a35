/* trace_tree.h: trees of boxes that rays walk through (masu_blob_trace_node): over the triangles of
 * a mesh when a scene is baked, over the instances in each frame. Shape first, by the surface area
 * heuristic; then boxes, which can be made again when things have moved. Nothing here allocates;
 * all memory is the caller's.
 *
 * A node has up to four children because a walk pays for what it loads: one node of 48 bytes says
 * as much as three of two children. Children are side by side, so that the walk keeps a word for
 * all that are left of a node rather than one for each. */
#ifndef MASU_TRACE_TREE_H
#define MASU_TRACE_TREE_H

#include "scene/blob.h"

typedef struct masu_trace_box {
    float low[3], high[3]; /* within MASU_TRACE_REACH */
} masu_trace_box;

typedef struct masu_trace_shape {
    uint32_t nodes; /* 0: there are no items */
    uint32_t depth; /* levels */
} masu_trace_shape;

/* Most nodes over so many items. A node of four items or more has four children; one of fewer has
 * leaves alone. */
static inline uint32_t masu_trace_tree_nodes(uint32_t items) {
    return (uint32_t)(((uint64_t)items * 2 + 2) / 3);
}

/* Boxes in, a tree of at most `levels` levels out: `nodes` without their boxes, and in `order`
 * which item comes in which place; `work` has as many words as `order`. Leaves hold up to `leaf`
 * items, 1 or 2; they must fit: items <= leaf * 4^levels. first_node and first_item are added to
 * what nodes refer to. Bounded work, no recursion: about items * log(items). */
masu_trace_shape masu_trace_tree_shape(const masu_trace_box *boxes, uint32_t items, uint32_t leaf,
                                       uint32_t levels, uint32_t first_node, uint32_t first_item,
                                       uint32_t *order, uint32_t *work,
                                       masu_blob_trace_node *nodes);

/* What is below a node. */
typedef struct masu_trace_below {
    masu_trace_box box;
    float
        cost; /* by the surface area heuristic: how many nodes and items a ray that meets the box is
                   expected to look at */
} masu_trace_below;

/* Boxes of all nodes, from those of the items; quantised ones hold the boxes for sure. `below` has
 * room for `count`; the first is of everything. Returns the mean of the binary logarithms of the
 * nodes' areas. In the sum of the heuristic the largest boxes rule: where one item is far away, all
 * else is nothing next to the box of all, and a tree that has got mixed up would not show. A mean
 * of logarithms says by what factor the usual box has grown; where all grow alike, so does the
 * sum. */
double masu_trace_tree_fit(masu_blob_trace_node *nodes, uint32_t count, uint32_t first_node,
                           uint32_t first_item, const uint32_t *order, const masu_trace_box *boxes,
                           masu_trace_below *below);

/* What a node says of a child: exact in double. */
void masu_trace_tree_child(const masu_blob_trace_node *node, uint32_t slot, double low[3],
                           double high[3]);

#endif
