/* trace_tree.h: builds BVHs of masu_blob_trace_node: over the triangles of a mesh when a scene is
 * baked, and over the instances in a frame. First the structure, by the surface area heuristic;
 * then the boxes, which can be refitted when items move. No allocation; all memory is the caller's.
 *
 * A node has up to four children because the cost of traversal is in loads: one node of 48 bytes
 * replaces three binary nodes. Child nodes are contiguous, so traversal pushes one 32-bit value for
 * all remaining children of a node instead of one per child. */
#ifndef MASU_TRACE_TREE_H
#define MASU_TRACE_TREE_H

#include "scene/blob.h"

typedef struct masu_trace_box {
    float low[3], high[3]; /* within MASU_TRACE_REACH */
} masu_trace_box;

typedef struct masu_trace_shape {
    uint32_t nodes; /* 0: no items */
    uint32_t depth; /* levels */
} masu_trace_shape;

/* Maximum number of nodes over `items` items. A node over four or more items has four children; a
 * node over fewer items has only leaves. */
static inline uint32_t masu_trace_tree_nodes(uint32_t items) {
    return (uint32_t)(((uint64_t)items * 2 + 2) / 3);
}

/* Builds a tree of at most `levels` levels over the boxes: writes `nodes` without their boxes, and
 * the item at each position to `order`; `work` has the size of `order`. Leaves hold up to `leaf`
 * items, 1 or 2; required: items <= leaf * 4^levels. first_node and first_item are added to the
 * indices in the nodes. Bounded work without recursion: about items * log(items). */
masu_trace_shape masu_trace_tree_shape(const masu_trace_box *boxes, uint32_t items, uint32_t leaf,
                                       uint32_t levels, uint32_t first_node, uint32_t first_item,
                                       uint32_t *order, uint32_t *work,
                                       masu_blob_trace_node *nodes);

/* Summary of the subtree of a node. */
typedef struct masu_trace_below {
    masu_trace_box box;
    float
        /* by the surface area heuristic: expected number of nodes and items that a ray which hits
         * the box visits */
        cost;
} masu_trace_below;

/* Computes the boxes of all nodes from the boxes of the items; the quantised boxes always contain
 * the exact ones. `below` has `count` elements; the first one describes the whole tree. Returns the
 * mean of log2 of the nodes' areas. The sum of the heuristic would be dominated by the largest
 * boxes: with one item far away, the box of the root hides the growth of all others, and a degraded
 * tree would not be noticed. The mean of logarithms measures the factor by which a typical box has
 * grown. If all boxes grow alike, the sum grows by the same factor. */
double masu_trace_tree_fit(masu_blob_trace_node *nodes, uint32_t count, uint32_t first_node,
                           uint32_t first_item, const uint32_t *order, const masu_trace_box *boxes,
                           masu_trace_below *below);

/* The dequantised box of a child: exact in double. */
void masu_trace_tree_child(const masu_blob_trace_node *node, uint32_t slot, double low[3],
                           double high[3]);

#endif
