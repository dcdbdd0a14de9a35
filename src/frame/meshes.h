/* meshes.h: meshes that the host creates at run time, in the slots of desc.reserve.meshes
 * (src/plan/reserve.h).
 *
 * UPLOAD. A call converts the mesh into `staging`. The next frame copies it to its slot of
 * MASU_BUFFER_MESH_UPLOAD, with a job for each changed mesh (shaders/shared/meshes.h). The passes
 * mesh_* copy it to the buffers that draws and rays read. So no frame in flight reads memory that
 * the host writes, and a frame without changes has no jobs.
 *
 * BVH. The call also builds the BVH of a new mesh and sorts the triangles by it. The pass
 * skin_trace refits the BVH to moved vertices, as for skins, in the next frame whose rung
 * traces. */
#ifndef MASU_MESHES_H
#define MASU_MESHES_H

#include "frame/models.h"
#include "frame/reflections.h"
#include "plan/draws.h"

typedef enum masu_mesh_change {
    MASU_MESH_SAME = 0,
    MASU_MESH_MOVED, /* vertices */
    MASU_MESH_NEW    /* vertices and triangles */
} masu_mesh_change;

typedef struct masu_host_mesh {
    uint32_t vertices, triangles, nodes;
    masu_mesh_change change;     /* not yet uploaded; the data is in `staging` at these offsets: */
    uint64_t vertices_at;        /* bytes */
    masu_mesh_upload at;         /* relative to shape_at, without vertices */
    uint64_t shape_at;
    int has_texcoords, has_colors;
    int settles; /* it moved in the last frame: previous positions are to become the present ones */
    int stale;   /* its BVH is to be refitted */
    uint32_t due; /* frames that still write its number of triangles to their draws */
} masu_host_mesh;

typedef struct masu_meshes {
    masu_host_mesh *meshes; /* [slot] */
    unsigned char *staging;
    uint64_t used; /* bytes of `staging` */
    /* Scratch memory of a build, for the largest slot; without ray tracing of no length. */
    masu_trace_box *boxes;
    uint32_t *order, *work;
    masu_trace_below *below;
    uint32_t words[MASU_MAX_MESH_KINDS]; /* masu_trace_word_of of the material */
} masu_meshes;

void masu_meshes_alloc(masu_meshes *s, masu_arena *arena, const masu_frame_plan *plan);
void masu_meshes_copy_scene(masu_meshes *s, const masu_frame_plan *plan, const masu_scene_view *v);

/* Whether a mesh fits into a slot and into the next frame. Changes nothing. */
masu_result masu_meshes_check(const masu_meshes *s, const masu_frame_plan *plan, uint32_t slot,
                              const masu_mesh_data *data, masu_detail *detail);
/* The same for new positions and normals of its vertices. */
masu_result masu_meshes_check_vertices(const masu_meshes *s, const masu_frame_plan *plan,
                                       uint32_t slot, const masu_mesh_data *data,
                                       masu_detail *detail);

/* The data has been checked; writes the mesh's box to `bounds`. */
void masu_meshes_set(masu_meshes *s, masu_bounds *b, masu_draws *draws, const masu_frame_plan *plan,
                     uint32_t slot, const masu_mesh_data *data);
void masu_meshes_set_vertices(masu_meshes *s, masu_bounds *b, const masu_frame_plan *plan,
                              uint32_t slot, const masu_mesh_data *data);

/* The mesh that is `model` is removed, and its slot is free. */
void masu_meshes_remove(masu_meshes *s, masu_models *models, masu_instances *in,
                        masu_reflections *r, const masu_frame_plan *plan, uint32_t model);

/* Jobs and data to the slot of the frame. Cannot fail. */
void masu_meshes_write(masu_meshes *s, const masu_frame_data *f);

#endif
