/* trace.h: what rays are traced through in a frame: the tree over the instances. Trees over the
 * triangles of meshes are baked (src/scene/blob.h); shaders/trace/bvh.glsl walks through both.
 *
 * ANCHOR. Rays live in a space relative to a point that the caller chooses, near the eye: world
 * minus anchor in double, then rounded. An instance is its inverse and its place in that space, p
 * -> inverse (p - place): differences of near things are exact, so a world a million metres out is
 * as sharp as one at the origin.
 *
 * WHEN IT IS BUILT AGAIN. Instances that move stay where they are in the tree; boxes are made again
 * from the leaves up, all of them: that is one pass over what a frame has to copy anyway. By the
 * surface area heuristic a ray pays in proportion to the areas of the nodes' boxes; when the usual
 * box (masu_trace_tree_fit) has grown to MASU_TRACE_WORSE times what it was when the tree was
 * built, the tree is built again: rays then pay half as much again, and a build costs as much as
 * nine fits (docs/design/09-ray-tracing.md). A crowd that mixes is built again once in some frames,
 * one that stays in order never.
 *
 * Memory is the caller's: masu_trace_top_bytes of it, kept as long as the tree. Nothing here
 * allocates or fails. An instance whose transform is not finite, or has no inverse of a sane size,
 * is left out until it has one. */
#ifndef MASU_TRACE_H
#define MASU_TRACE_H

#include "scene/blob_section.h"
#include "scene/trace_tree.h"

#define MASU_TRACE_WORSE 1.5
/* Inverses with a larger entry, or with none as large as 1 / it, count as none. */
#define MASU_TRACE_STRETCH 1e9

/* An instance as shaders see it: 64 bytes. */
typedef struct masu_trace_record {
    float row
        [3]
        [4]; /* of the inverse, world to object; w: x, y, z of the place, relative to the anchor */
    uint32_t root;     /* of TRACE_NODES */
    uint32_t traced;   /* which of TRACE_INSTANCES it is */
    uint32_t instance; /* which of INSTANCES */
    uint32_t mirrored; /* 1: the transform turns triangles over */
} masu_trace_record;

/* Of a traced instance, what does not change: the box and the root of its mesh's tree. */
typedef struct masu_trace_root {
    masu_trace_box box; /* object space */
    uint32_t node, instance;
} masu_trace_root;

typedef struct masu_trace_top {
    uint32_t count; /* instances, given to make */
    uint32_t live;  /* of them in the tree */
    uint32_t nodes, depth;
    uint32_t builds, fits;   /* so far */
    double size, built_size; /* of the usual box, log2 */
    double anchor[3];
    int dirty, regroup; /* something has moved; something has come or gone */
    struct masu_trace_placed *placed;
    masu_trace_box *boxes;   /* of each instance that is in the tree, in the order of `items` */
    masu_trace_below *below; /* of each node */
    masu_blob_trace_node *tree;
    uint32_t *items; /* instances that are in the tree */
    uint32_t *order, *work;
} masu_trace_top;

/* Most levels of the tree over so many instances: three more than if each of its nodes had four children, at most
 * MASU_TRACE_TOP_DEPTH. */
uint32_t masu_trace_top_levels(uint32_t instances);

/* Host bytes for so many instances. */
uint64_t masu_trace_top_bytes(uint32_t instances);

/* `memory` is 16-byte aligned and has masu_trace_top_bytes(count). All instances are out of the
 * tree until they are placed. */
void masu_trace_top_init(masu_trace_top *top, void *memory, uint32_t count);

/* Of traced instance k of a scene. */
masu_trace_root masu_trace_root_of(const masu_scene_view *view, uint32_t traced);

/* Before an instance is placed first. */
void masu_trace_top_set(masu_trace_top *top, uint32_t traced, const masu_trace_root *root);

/* To be changed, before it is placed anew: what bends has another box. */
masu_trace_root *masu_trace_top_root(masu_trace_top *top, uint32_t traced);

/* Whether an instance of that transform is traced at all. */
int masu_trace_places(const float transform[12]);

/* Rows of the 3x4 matrix from object to world, as the instances' own. 0: it is left out. */
int masu_trace_top_place(masu_trace_top *top, uint32_t traced, const float transform[12]);

typedef enum masu_trace_change {
    MASU_TRACE_SAME = 0,
    MASU_TRACE_FITTED = 1,
    MASU_TRACE_BUILT = 2
} masu_trace_change;

/* Once a frame, after what has moved has been placed: makes the tree right for this anchor, each
 * coordinate finite and within 1e15. */
masu_trace_change masu_trace_top_update(masu_trace_top *top, const double anchor[3]);

/* ---- Buffers: masu_trace_frame[], masu_trace_static[] ---------------------------------------- */

/* Most that a frame takes, and what masu_trace_top_write writes: header, nodes, records. 16-byte
 * aligned. */
uint64_t masu_trace_frame_bytes(uint32_t instances);
void masu_trace_top_write(const masu_trace_top *top, void *frame);

/* Header, TRACE_NODES, TRACE_TRIANGLES: `header` goes to the start, the sections to the offsets. */
typedef struct masu_trace_static {
    uint32_t header[4];
    uint64_t nodes, triangles; /* offsets */
    uint64_t bytes;
} masu_trace_static;
masu_trace_static masu_trace_static_layout(uint32_t nodes, uint32_t triangles);

#endif
