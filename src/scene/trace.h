/* trace.h: the top-level BVH over the instances of a frame. The BVHs over the triangles of meshes
 * are baked (src/scene/blob.h). shaders/trace/bvh.glsl traverses both.
 *
 * FLOATING ORIGIN (`anchor`). Rays are relative to a point near the camera that the caller chooses:
 * world minus anchor in double, then rounded. An instance is its inverse and its position in that
 * space, p -> inverse (p - position). Differences of close positions are exact, so a world a
 * million metres from the origin is as precise as one at the origin.
 *
 * REBUILDS. When instances move, the tree keeps its structure and all boxes are refitted bottom-up,
 * in one pass over data that a frame has to copy anyway. By the surface area heuristic the cost of
 * a ray is proportional to the surface areas of the nodes' boxes. When the geometric mean of the
 * areas (masu_trace_tree_fit) has grown by MASU_TRACE_WORSE since the build, the tree is rebuilt.
 * Rays then cost half as much again, and a build costs as much as nine refits
 * (docs/design/09-ray-tracing.md). A crowd whose members mix is rebuilt every few frames; a crowd
 * in formation never is.
 *
 * Memory is the caller's: masu_trace_top_bytes, for the lifetime of the tree. No allocation, no
 * failure. An instance whose transform is not finite, or has no inverse within MASU_TRACE_STRETCH,
 * is omitted until it has one. */
#ifndef MASU_TRACE_H
#define MASU_TRACE_H

#include "scene/blob_section.h"
#include "scene/trace_tree.h"

#define MASU_TRACE_WORSE 1.5
/* A transform is rejected if its inverse has an entry above this value, or no entry of at least 1 /
 * this value. */
#define MASU_TRACE_STRETCH 1e9

/* An instance in the layout of the shaders: 64 bytes. */
typedef struct masu_trace_record {
    float row[3]
             /* rows of the inverse, world to object; w: x, y, z of the position, relative to the
         * anchor */
             [4];
    uint32_t root;     /* index into TRACE_NODES */
    uint32_t traced;   /* index into TRACE_INSTANCES */
    uint32_t instance; /* index into INSTANCES */
    uint32_t mirrored; /* 1: the transform reverses the winding of triangles */
} masu_trace_record;

/* Constant data of a traced instance: the box and the root of its mesh's BVH. */
typedef struct masu_trace_root {
    masu_trace_box box; /* object space */
    uint32_t node, instance;
} masu_trace_root;

typedef struct masu_trace_top {
    uint32_t count; /* instances; 0 to count - 1 */
    uint32_t live;  /* instances in the tree */
    uint32_t nodes, depth;
    uint32_t builds, fits;   /* since initialisation */
    double size, built_size; /* mean log2 of the box areas */
    double anchor[3];
    int dirty, regroup; /* an instance has moved; one was added or removed */
    struct masu_trace_placed *placed;
    masu_trace_box *boxes;   /* per instance in the tree, in the order of `items` */
    masu_trace_below *below; /* per node */
    masu_blob_trace_node *tree;
    uint32_t *items; /* instances in the tree */
    uint32_t *order, *work;
} masu_trace_top;

/* Maximum depth of the tree over so many instances: three more than with four children in each
 * node, at most MASU_TRACE_TOP_DEPTH. */
uint32_t masu_trace_top_levels(uint32_t instances);

/* Host bytes for `instances` instances. */
uint64_t masu_trace_top_bytes(uint32_t instances);

/* `memory` is 16-byte aligned and has masu_trace_top_bytes(count) bytes. No instance is in the tree
 * before its first masu_trace_top_place. */
void masu_trace_top_init(masu_trace_top *top, void *memory, uint32_t count);

/* The constant data of traced instance `traced` of a scene. */
masu_trace_root masu_trace_root_of(const masu_scene_view *view, uint32_t traced);

/* Call before the first masu_trace_top_place of the instance. */
void masu_trace_top_set(masu_trace_top *top, uint32_t traced, const masu_trace_root *root);

/* For changes, before the instance is placed again: a skinned mesh has a new box in every frame. */
masu_trace_root *masu_trace_top_root(masu_trace_top *top, uint32_t traced);

/* Whether an instance with this transform can be traced. */
int masu_trace_places(const float transform[12]);

/* Moves an instance. transform: rows of the 3x4 matrix from object to world space. Returns 0 if the
 * instance cannot be traced; it is then not in the tree. */
int masu_trace_top_place(masu_trace_top *top, uint32_t traced, const float transform[12]);

typedef enum masu_trace_change {
    MASU_TRACE_SAME = 0,
    MASU_TRACE_FITTED = 1,
    MASU_TRACE_BUILT = 2
} masu_trace_change;

/* Once per frame, after all moved instances have been placed: refits or rebuilds the tree for this
 * anchor, whose coordinates are finite and within 1e15. */
masu_trace_change masu_trace_top_update(masu_trace_top *top, const double anchor[3]);

/* ---- Buffers: masu_trace_frame[], masu_trace_static[] ---------------------------------------- */

/* Maximum bytes per frame that masu_trace_top_write writes: header, nodes, records. 16-byte
 * aligned. */
uint64_t masu_trace_frame_bytes(uint32_t instances);
void masu_trace_top_write(const masu_trace_top *top, void *frame);

/* Layout of header, TRACE_NODES and TRACE_TRIANGLES: the header is at offset 0. */
typedef struct masu_trace_static {
    uint32_t header[4];
    uint64_t nodes, triangles; /* byte offsets */
    uint64_t bytes;
} masu_trace_static;
masu_trace_static masu_trace_static_layout(uint32_t nodes, uint32_t triangles);

#endif
