/* reserve.h: adds desc.reserve to the counts of a scene: slots for copies of its models, for meshes
 * of the host, and lights.
 *
 * A slot can hold a copy of any model without skins, so its size in instances, nodes, transparent
 * primitives and traced instances is the maximum over these models. The counts of plan->scene
 * include all slots: first the elements of the blob, then the slots in order. Everything sized by
 * the scene therefore has room for the copies, and nothing changes without a reserve. src/api_add.c
 * manages the contents of slots.
 *
 * A mesh of the host is a mesh with one instance, a model with one node, and a draw: the last ones
 * of each. src/api_mesh.c manages them. */
#ifndef MASU_PLAN_RESERVE_H
#define MASU_PLAN_RESERVE_H

#include "masu.h"
#include "scene/blob_section.h"
#include "scene/scene_data.h"

#define MASU_RESERVE_MODELS_MAX 16384u
#define MASU_RESERVE_LIGHTS_MAX 4096u
#define MASU_RESERVE_MESHES_MAX 1024u
#define MASU_MESH_VERTICES_MAX (1u << 20)
#define MASU_MESH_TRIANGLES_MAX (1u << 18)
#define MASU_MESH_UPLOAD_MAX (1u << 30)
#define MASU_MESH_ALL_MAX (1u << 24) /* vertices, and triangles, of all slots */
/* limit for the instances, and for the nodes, of all slots */
#define MASU_RESERVE_PARTS_MAX (1u << 20)

typedef struct masu_place_size {
    uint32_t instances, nodes, transparents, traced;
} masu_place_size;

/* All 0 without a reserve. */
typedef struct masu_reserve_plan {
    uint32_t models, lights, meshes; /* slots */
    masu_place_size place;       /* size of one slot of a model */
    masu_place_size places;      /* size of all slots, of models and of meshes */
    uint32_t occluders;          /* placed occluders of all slots */
    uint32_t listed, lod_listed; /* entries in a view's lists: of meshes, of LODs */
    uint32_t mesh_upload;        /* bytes per frame */
} masu_reserve_plan;

/* A slot of desc.reserve.meshes: its capacities, and where it is in the buffers. */
typedef struct masu_mesh_slot {
    uint32_t kind;
    uint32_t vertices, triangles, nodes; /* nodes: 0 if rays do not trace it */
    /* Counted from those of the scene, among those of all slots. */
    uint32_t first_vertex, first_triangle, first_node;
} masu_mesh_slot;
masu_mesh_slot masu_mesh_slot_of(const masu_reserve *reserve, int traced, uint32_t slot);

/* Bytes of an upload: vertices, triangles and nodes of a mesh, each part a multiple of 16. */
typedef struct masu_mesh_upload {
    uint64_t texcoords, colors, triangles, nodes, bytes; /* offsets; vertices are first */
} masu_mesh_upload;
masu_mesh_upload masu_mesh_upload_of(const masu_scene_data *scene, uint32_t vertices,
                                     uint32_t triangles);

/* Whether a model can be copied: it has no skins. */
int masu_reserve_copies(const masu_scene_view *v, const masu_blob_model *model);

/* Adds the reserve to `scene`, which has the counts of the blob. Reads the blob if there are
 * slots. */
masu_result masu_reserve_add(const masu_reserve *reserve, masu_scene_data *scene,
                             masu_reserve_plan *out, masu_detail *detail);

#endif
